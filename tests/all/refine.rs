//! `refine`: drawings are taken up where they were left, foreign files stay as they are under the strokes,
//! and what cannot be refined is refused.

use std::collections::BTreeSet;

use crate::support::{Place, assert_refused, assert_says, committed};
use strokefit::svg;

/// The cat in 8 colours, traced with the `vtracer` crate 0.6.5 at its defaults, but for speckles of 16 px,
/// no decimals and a layer difference of 48.
const TRACED: &str = include_str!("../data/chelsea-traced.svg");

const NAMESPACE: &str = "xmlns=\"http://www.w3.org/2000/svg\"";

/// A folder with a sample as `in.png`.
fn with_sample(name: &str) -> Place {
    let place = Place::new();
    let sample = std::fs::read(committed(&format!("samples/{name}.png")));
    place.file("in.png", sample.unwrap());
    place
}

/// A folder with the coffee.
fn with_coffee() -> Place {
    with_sample("coffee-300")
}

/// A folder with the cat, and what another program traced of it.
fn traced() -> Place {
    let place = with_sample("chelsea-cat");
    place.file("traced.svg", TRACED);
    place
}

/// Draws or refines as a draft, by the words of a command; returns the fidelity in dB.
#[track_caller]
fn draft(place: &Place, words: &str) -> f64 {
    place.done(&format!("{words} -q --preset draft --report r.json"));
    let report = place.report("r.json");
    report["fidelity"]["psnr_db"].as_f64().unwrap()
}

fn layers(place: &Place, name: &str) -> Vec<usize> {
    let scene = svg::read(&place.text(name)).unwrap();
    scene.stages.iter().map(|stage| stage.marks.len()).collect()
}

fn strokes(place: &Place, name: &str) -> usize {
    layers(place, name).iter().sum()
}

/// The text before and after what was put into it, which is returned.
#[track_caller]
fn put_into<'a>(base: &str, refined: &'a str) -> &'a str {
    let (head, tail) = base.split_at(base.rfind("</").unwrap());
    assert!(refined.starts_with(head) && refined.ends_with(tail));
    &refined[head.len()..refined.len() - tail.len()]
}

#[test]
fn strokes_with_a_plus_count_beyond_those_of_the_base() {
    let place = with_coffee();
    draft(&place, "fit in.png --strokes +60 -o base.svg");
    assert_eq!(strokes(&place, "base.svg"), 60);
    draft(&place, "refine base.svg in.png --strokes +40 -o more.svg");
    assert_eq!(strokes(&place, "more.svg"), 100);
    // As many in all as there are is no change, which is said with what would be one.
    let full = place.said("refine base.svg in.png --strokes 60 -o full.svg", 0);
    assert_eq!(strokes(&place, "full.svg"), 60);
    assert_says(&full, &["hint:", "--strokes +60"]);
    let place = traced();
    draft(&place, "refine traced.svg in.png --strokes +20 -o a.svg");
    draft(&place, "refine a.svg in.png --strokes +10 -o b.svg");
    let more = place.text("b.svg");
    assert_eq!(put_into(TRACED, &more).matches("<path").count(), 30);
}

#[test]
fn a_drawing_in_two_goes_is_as_good_as_one_in_one_go() {
    let place = with_coffee();
    let whole = draft(&place, "fit in.png --strokes 300 -o whole.svg");
    draft(&place, "fit in.png --strokes 150 -o half.svg");
    let both = draft(&place, "refine half.svg in.png --strokes 300 -o both.svg");
    assert!(both > whole - 0.3, "{both} dB in two goes, {whole} in one");
    assert_eq!(strokes(&place, "both.svg"), 300);
    assert_eq!(place.report("r.json")["base"]["strokes"], 150);
    // Nor is one of too many strokes, shortened, worse than one of as few from the start.
    let few = draft(&place, "fit in.png --strokes 60 -o few.svg");
    let shortened = draft(&place, "refine whole.svg in.png --strokes 60 -o a.svg");
    assert!(
        shortened > few - 0.5,
        "{shortened} dB of 300 strokes, {few}"
    );
    assert_eq!(strokes(&place, "a.svg"), 60);
    assert_eq!(place.report("r.json")["stop"], "strokes");
    // Other pens do not keep a base from being shortened.
    let pens = "refine whole.svg in.png --strokes 60 --pens 3,8 -o b.svg";
    draft(&place, pens);
    assert_eq!(strokes(&place, "b.svg"), 60);
}

/// Without polish the first stages of a plan are the same whether or not others follow: the stages that are
/// there are not planned again, and the drawing ends as good as the whole one.
#[test]
fn the_stages_that_are_missing_are_added() {
    let place = with_coffee();
    let whole = draft(&place, "fit in.png --no-polish --strokes 200 -o whole.svg");
    let counts = layers(&place, "whole.svg");
    let first: usize = counts[..5].iter().sum();
    let options = format!("--no-polish --stages 5 --strokes {first}");
    draft(&place, &format!("fit in.png {options} -o first.svg"));
    let refine = "refine first.svg in.png --no-polish --strokes 200 -o both.svg";
    let both = draft(&place, refine);
    assert!(
        (both - whole).abs() < 0.3,
        "{both} dB in two goes, {whole} in one"
    );
    let both = layers(&place, "both.svg");
    assert_eq!(both.len(), counts.len(), "{both:?} for {counts:?}");
    assert_eq!(both[..5], layers(&place, "first.svg"));
}

#[test]
fn a_layer_that_nothing_is_seen_of_goes_and_the_others_are_numbered_on() {
    let place = with_coffee();
    let head = format!(r#"<svg {NAMESPACE} width="300" height="200" viewBox="0 0 300 200">"#);
    let paths = ["M9 9L40 90", "M-90 9L-40 90", "M200 9L9 190"];
    let layer = |(k, d): (usize, &str)| {
        let id = k + 1;
        format!(
            r##"<g id="stage-{id}" fill="none" stroke-linecap="round"><path d="{d}" stroke="#999999" stroke-width="5"/></g>"##
        )
    };
    let body: String = paths.into_iter().enumerate().map(layer).collect();
    place.file("three.svg", format!("{head}{body}</svg>"));
    draft(&place, "refine three.svg in.png --psnr 1 -o two.svg");
    assert_eq!(layers(&place, "two.svg"), [1, 1]);
    assert!(!place.text("two.svg").contains("M-90 9"));
    let report = place.report("r.json");
    let records = report["stages"].as_array().unwrap().iter();
    let records: Vec<_> = records.map(|s| (&s["index"], &s["strokes"])).collect();
    assert_eq!(
        format!("{records:?}"),
        "[(Number(1), Number(1)), (Number(2), Number(1))]"
    );
    assert_eq!(report["dropped"], 1);
    assert_eq!(report["dropped_for"]["off_page"], 1);
}

#[test]
fn a_base_that_meets_a_budget_is_written_as_it_is() {
    let place = traced();
    draft(&place, "fit in.png --strokes 80 -o own.svg");
    draft(&place, "refine traced.svg in.png --strokes 20 -o laid.svg");
    for (base, budget) in [
        ("own.svg", "--strokes 80"),
        ("own.svg", "--psnr 20"),
        ("laid.svg", "--strokes 20"),
        ("traced.svg", "--psnr 15"),
    ] {
        draft(
            &place,
            &format!("refine {base} in.png {budget} -o again.svg"),
        );
        assert!(
            place.text("again.svg") == place.text(base),
            "{base} {budget:?}"
        );
    }
}

/// Fitting anew what a budget leaves little room for may end worse than it began.
#[test]
fn a_base_that_is_better_than_its_refinement_is_kept() {
    let place = with_sample("rocket-320");
    for seed in ["0", "1", "2"] {
        let within = format!("in.png --bytes 3000 --seed {seed}");
        let base = draft(&place, &format!("fit {within} -o a.svg"));
        let refined = draft(&place, &format!("refine a.svg {within} -o b.svg"));
        assert!(
            refined >= base,
            "seed {seed}: {base:.2} dB, then {refined:.2}"
        );
        // The base is translucent, and stays only where it may.
        draft(&place, &format!("refine a.svg {within} --opaque -o c.svg"));
        assert!(!place.text("c.svg").contains("opacity"));
    }
}

#[test]
fn a_traced_picture_gains_and_stays_as_it_is() {
    let place = traced();
    let before = draft(&place, "refine traced.svg in.png --psnr 1 -o same.svg");
    let after = draft(&place, "refine traced.svg in.png --strokes 200 -o a.svg");
    assert!(after > before + 3.0, "from {before} to {after} dB");
    let refined = place.text("a.svg");
    assert_eq!(put_into(TRACED, &refined).matches("<path").count(), 200);
    let record = place.report("r.json");
    assert_eq!(
        (&record["base"]["elements"], &record["base"]["strokes"]),
        (&59.into(), &0.into())
    );
    assert!(record["agreement"]["psnr_db"].as_f64().unwrap() > 40.0);
    // Strokes that were laid on it are taken up again.
    let refine = "refine traced.svg in.png --strokes 100 -o first.svg";
    draft(&place, refine);
    let refine = "refine first.svg in.png --strokes 200 -o second.svg";
    let twice = draft(&place, refine);
    assert_eq!(place.report("r.json")["base"]["strokes"], 100);
    let second = place.text("second.svg");
    assert_eq!(put_into(TRACED, &second).matches("<path").count(), 200);
    assert!(
        twice > after - 0.3,
        "{twice} dB in two goes, {after} in one"
    );
}

#[test]
fn a_frozen_drawing_stays_as_it_is_and_stays_a_drawing() {
    let place = with_coffee();
    let before = draft(&place, "fit in.png --strokes 60 -o own.svg");
    let refine = "refine own.svg in.png --freeze-base --strokes 60 -o more.svg";
    let after = draft(&place, refine);
    put_into(&place.text("own.svg"), &place.text("more.svg"));
    assert_eq!(strokes(&place, "more.svg"), 120);
    assert!(after > before, "from {before} to {after} dB");
}

/// Another prefix, other units, a viewBox, and properties that strokes would inherit.
#[test]
fn the_root_does_not_change_the_strokes() {
    let place = Place::of_picture(60, 40);
    let root = "<s:svg xmlns:s=\"http://www.w3.org/2000/svg\" width=\"30mm\" height=\"20mm\" \
                viewBox=\"-5 7 30 20\" stroke-opacity=\"0.2\" stroke-dasharray=\"1 2\" fill=\"red\" \
                shape-rendering=\"crispEdges\" stroke-linecap=\"butt\">";
    let base = format!(
        "{root}<s:style>svg{{stroke:blue;stroke-width:9}}</s:style>\
         <s:rect x=\"-5\" y=\"7\" width=\"30\" height=\"20\" fill=\"#888\"/><s:g id=\"stage-3\"/></s:svg>"
    );
    place.file("base.svg", &base);
    let db = draft(&place, "refine base.svg in.png --strokes 30 -o out.svg");
    let refined = place.text("out.svg");
    let layers = put_into(&base, &refined);
    assert!(
        layers.contains("<g id=\"stage-4\"") && !layers.contains("stage-3"),
        "{layers}"
    );
    let agreement = &place.report("r.json")["agreement"]["psnr_db"];
    assert!(
        db > 25.0 && agreement.as_f64().unwrap() > 36.0,
        "{db} {agreement}"
    );
}

#[test]
fn what_is_passed_through_and_what_cannot_be_seen_is_said() {
    let place = Place::of_picture(30, 20);
    let base = format!(
        "<svg {NAMESPACE} viewBox=\"0 0 30 20\"><text>a</text><image href=\"/etc/hostname\"/><g/></svg>"
    );
    place.file("base.svg", base);
    let said = place.said("refine base.svg in.png -o out.svg --strokes 3", 0);
    assert_says(&said, &["keeping 3 elements", "fonts", "other files"]);
}

/// Parts that are clear in both stay clear, and no background is drawn.
#[test]
fn transparency_is_kept() {
    let place = with_sample("noto-gem");
    draft(&place, "fit in.png --strokes 40 -o own.svg");
    draft(&place, "refine own.svg in.png --strokes 60 -o more.svg");
    let alpha = &place.report("r.json")["alpha"];
    assert!(alpha["black_db"].as_f64().unwrap() > 25.0, "{alpha}");
    assert!(!place.text("more.svg").contains("<rect"));
}

#[test]
fn what_cannot_be_refined_is_refused() {
    let place = Place::of_picture(30, 20);
    let svg = |root: &str, inside: &str| format!("<svg {NAMESPACE} {root}>{inside}</svg>");
    let of_page = |inside: &str| svg(r#"width="30" height="20""#, inside);
    let on_root = |attribute: &str| svg(&format!(r#"width="30" height="20" {attribute}"#), "<g/>");
    let sized =
        |[width, height]: [&str; 2]| svg(&format!(r#"width="{width}" height="{height}""#), "");
    let nested = "<g>".repeat(3000) + &"</g>".repeat(3000);
    let bomb = r#"<!DOCTYPE svg [<!ENTITY a "haha"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&c;">]>"#;
    for (text, words) in [
        (String::new(), "empty"),
        ("this is no SVG".into(), "no <svg>"),
        ("<html></html>".into(), "<html>"),
        (of_page("<g>").replace("</svg>", ""), "ends before </g>"),
        (of_page("<g>"), "not well-formed"),
        (of_page("").replace("http:", "https:"), "namespace"),
        (sized(["30", "30"]), "aspect ratio"),
        (sized(["30furlong", "20furlong"]), "viewBox"),
        (sized(["100%", "100%"]), "viewBox"),
        (on_root(r#"opacity="0.5""#), "root element"),
        (on_root(r#"display="none""#), "root element"),
        (of_page("<style>path{fill:red}</style>"), "style sheet"),
        (of_page(&nested), "nested"),
        (bomb.to_owned() + &of_page("<text>&c;</text>"), "entity"),
        (of_page("<text>&x;</text>"), "entity"),
    ] {
        place.file("base.svg", text);
        let refine = "refine base.svg in.png -o out.svg";
        assert_refused(&place, refine, 1, &["base.svg", words]);
    }
    place.file("base.svg", svg(r#"viewBox="0 0 30 20""#, ""));
    for (refine, words) in [
        ("- - -o out.svg", "standard input"),
        ("base.svg in.png -o base.svg", "overwritten"),
        (
            "base.svg in.png -o out.svg --background none",
            "--background",
        ),
    ] {
        assert_refused(&place, &format!("refine {refine}"), 2, &[words]);
    }
}

/// The colours of the strokes of a text, and of its background.
fn colors(text: &str) -> BTreeSet<&str> {
    let after = |word: &'static str| {
        let rests = text.split(word).skip(1);
        rests.filter_map(|rest| rest.split('"').next())
    };
    let ground = "<rect width=\"300\" height=\"200\" fill=\"";
    after("stroke=\"").chain(after(ground)).collect()
}

#[test]
fn the_strokes_of_a_base_get_the_few_colours_too() {
    let place = with_coffee();
    draft(&place, "fit in.png --strokes 80 -o base.svg");
    // Also where no stroke is to be added.
    for (strokes, form) in [("120", "plain"), ("80", "plain"), ("120", "smallest")] {
        let options = format!("--colors 5 --strokes {strokes} --form {form} --opaque");
        draft(
            &place,
            &format!("refine base.svg in.png {options} -o few.svg"),
        );
        let few = place.text("few.svg");
        assert_eq!(colors(&few).len(), 5, "{strokes} strokes, {form}");
        // In five colours, some strokes are hidden by others of their colour.
        let hidden = place.report("r.json")["dropped"].as_u64().unwrap();
        let drawn = svg::read(&few).unwrap().len() as u64;
        assert_eq!((drawn + hidden).to_string(), strokes);
        assert!(hidden < drawn / 4, "{hidden}");
    }
    // A drawing that has few colours already is left as it is.
    let strokes = svg::read(&place.text("few.svg")).unwrap().len();
    let options = format!("--colors 5 --strokes {strokes} --form smallest");
    draft(
        &place,
        &format!("refine few.svg in.png {options} -o again.svg"),
    );
    assert_eq!(place.text("again.svg"), place.text("few.svg"));
}

#[test]
fn only_what_is_laid_on_a_document_gets_few_colours() {
    let place = traced();
    let options = "--palette #1f130b,#e4caba --strokes 40";
    draft(
        &place,
        &format!("refine traced.svg in.png {options} -o laid.svg"),
    );
    let laid = place.text("laid.svg");
    assert_eq!(
        colors(put_into(TRACED, &laid)),
        ["#1f130b", "#e4caba"].into()
    );
}

#[test]
fn a_clear_drawing_keeps_few_colours() {
    let place = with_sample("noto-gem");
    draft(&place, "fit in.png --colors 4 --strokes 60 -o clear.svg");
    assert_eq!(colors(&place.text("clear.svg")).len(), 4);
    let refine = "refine clear.svg in.png --colors 4 --strokes 90 -o more.svg";
    draft(&place, refine);
    let more = place.text("more.svg");
    assert_eq!(colors(&more).len(), 4);
    assert!(!more.contains("<rect"));
    let options = "--palette #29b6f6,#ffffff --strokes 60";
    draft(&place, &format!("fit in.png {options} -o given.svg"));
    assert_eq!(
        colors(&place.text("given.svg")),
        ["#29b6f6", "#ffffff"].into()
    );
}

#[test]
fn a_base_whose_background_is_not_in_the_palette_is_refused() {
    let place = with_coffee();
    let options = "--background #a95327 --strokes 20";
    draft(&place, &format!("fit in.png {options} -o base.svg"));
    let refine = "refine base.svg in.png -q -o few.svg --palette #ffffff,#000000";
    let words = ["the background #a95327 is not in the palette: add it"];
    assert_refused(&place, refine, 2, &words);
    let options = "--palette #ffffff,#a95327 --strokes 30";
    draft(
        &place,
        &format!("refine base.svg in.png {options} -o few.svg"),
    );
    assert_eq!(
        colors(&place.text("few.svg")),
        ["#a95327", "#ffffff"].into()
    );
}
