"""Compares a drawing for a plotter, as vpype reads it, with the report of its fit: `plotter.py DRAWING.svg REPORT.json`."""

import json
import sys

import vpype

#: How far vpype's chords may be from a curve, px of 1/96 inch.
CHORD = 0.01


def main(drawing: str, report: str) -> None:
    with open(report, encoding="utf-8") as file:
        said = json.load(file)
    document = vpype.read_multilayer_svg(drawing, quantization=CHORD, simplify=False)
    page_width, _ = document.page_size
    picture_px = said["input"]["width"] / page_width
    layers = [document.layers[index] for index in sorted(document.layers)]
    assert len(layers) == len(said["travel"]["layers"]), (len(layers), said["travel"])
    for lines, told in zip(layers, said["travel"]["layers"]):
        assert len(lines) == told["strokes"], (len(lines), told)
        same("length", lines.length() * picture_px, told["drawn_px"])
        same("travel", lines.pen_up_length()[0] * picture_px, told["after_px"])
        assert told["after_px"] <= told["before_px"], told
    print(f"{len(layers)} layers, {said['strokes']} strokes, travel {said['travel']['before_px']:.0f} px as fitted, "
          f"{said['travel']['after_px']:.0f} px as written: vpype agrees")


def same(what: str, read_px: float, told_px: float) -> None:
    """Fails where more than rounding and a px of chords lie between what is read and what is told."""
    assert abs(read_px - told_px) <= 0.005 * told_px + 1.0, (what, read_px, told_px)


if __name__ == "__main__":
    main(*sys.argv[1:])
