//! The report as a self-contained HTML page with its plots, pictures and drawings.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::super::table::escaped;
use super::tables::NOTE;
use super::{ParetoReport, charts, pictures};
use crate::report::Table;
use strokefit::Result;

/// A drawing to be shown.
#[derive(Debug, Clone)]
pub struct Exhibit {
    /// The picture it is of.
    pub picture: String,
    /// Text beneath.
    pub caption: String,
    /// The file as resvg draws it, as PNG.
    pub drawn: Vec<u8>,
    /// Where and how far it is from the picture, as PNG; empty for the picture itself.
    pub difference: Vec<u8>,
    /// The SVG itself; empty where it is too long for a page.
    pub svg: String,
}

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;margin:2rem auto;max-width:84rem;padding:0 1rem;color:#222}\
h1,h2,h3{line-height:1.2}table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}\
td,th{padding:.2rem .6rem;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}\
.plots,.exhibits{display:flex;flex-wrap:wrap;gap:1rem}.plots svg{max-width:100%;height:auto}\
figure{margin:0;width:19rem}figure img{width:100%;display:block;image-rendering:auto}\
figcaption{font-size:13px;margin:.2rem 0 .8rem}td:first-child,.wide td{white-space:nowrap}.wide{overflow-x:auto}";

/// The page of `report` with its `exhibits`.
///
/// # Errors
/// [`ErrorKind::Picture`](strokefit::ErrorKind::Picture) when a plot cannot be drawn.
pub fn page(report: &ParetoReport, exhibits: &[Exhibit]) -> Result<String> {
    let mut body = format!("<h1>Cost against error</h1>\n<p>{}</p>\n", escaped(NOTE));
    body += &tables(&report.quoted());
    for picture in pictures(&report.entries) {
        body += &section(report, picture, exhibits)?;
    }
    let details = tables(&report.details());
    body += &format!("<div class=\"wide\">\n{details}</div>\n");
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>strokefit: cost against error</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    ))
}

fn tables(titled: &[(&str, Table)]) -> String {
    let html = |(title, table): &(&str, Table)| {
        let (title, table) = (escaped(title), table.html());
        format!("<h2>{title}</h2>\n{table}")
    };
    titled.iter().map(html).collect()
}

fn section(report: &ParetoReport, picture: &str, exhibits: &[Exhibit]) -> Result<String> {
    let mut text = format!("<h2>{}</h2>\n<div class=\"plots\">\n", escaped(picture));
    for (_, chart) in charts(&report.entries, picture)? {
        text += &chart;
    }
    text += "</div>\n<div class=\"exhibits\">\n";
    for exhibit in exhibits.iter().filter(|e| e.picture == picture) {
        text += &figure(exhibit);
    }
    text += "</div>\n";
    Ok(text)
}

fn figure(exhibit: &Exhibit) -> String {
    let Exhibit {
        caption,
        drawn,
        difference,
        svg,
        ..
    } = exhibit;
    let caption = escaped(caption);
    let svg = if svg.is_empty() {
        String::new()
    } else {
        let image = image("svg+xml", svg.as_bytes(), "the SVG itself");
        format!("<details><summary>the SVG itself</summary>{image}</details>")
    };
    let difference = if difference.is_empty() {
        String::new()
    } else {
        let image = image("png", difference, "difference");
        format!("{image}<figcaption>difference</figcaption>")
    };
    let drawn = image("png", drawn, &caption);
    format!("<figure>{drawn}<figcaption>{caption}</figcaption>{difference}{svg}</figure>\n")
}

fn image(kind: &str, bytes: &[u8], alt: &str) -> String {
    let data = STANDARD.encode(bytes);
    format!("<img loading=\"lazy\" alt=\"{alt}\" src=\"data:image/{kind};base64,{data}\">")
}

#[cfg(test)]
mod tests {
    use super::super::{OWN, drawing};
    use super::*;

    #[test]
    fn a_page_needs_nothing_else() {
        let entries = vec![drawing(OWN, "draft 100 <b> seed 0", 0.5, 900, 30.0)];
        let exhibit = Exhibit {
            picture: "cat".into(),
            caption: "draft <b>".into(),
            drawn: vec![1, 2, 3],
            difference: vec![4],
            svg: "<svg/>".into(),
        };
        let page = page(&ParetoReport::new(entries), &[exhibit]).unwrap();
        assert!(page.contains("data:image/png;base64,AQID") && page.contains("<svg"));
        assert!(!page.contains("<b>"), "markup of names is shown as it is");
        let outside = page.match_indices("=\"http").count() - page.matches("xmlns=\"http").count();
        assert_eq!(outside, 0, "refers to something else");
    }
}
