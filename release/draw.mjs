// Draws a picture with the npm package, for `release/try`: node draw.mjs PICTURE.png DRAWING.svg

import { readFileSync, writeFileSync } from "node:fs";
import { fitPng } from "strokefit";

const [picture, drawing] = process.argv.slice(2);
const { svg } = await fitPng(readFileSync(picture), { strokes: 300, preset: "draft" });
writeFileSync(drawing, svg);
