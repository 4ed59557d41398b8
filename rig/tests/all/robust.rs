//! `strokefit-rig robust`: pictures are damaged, drawn, and compared with the clean ones.

use std::fs;

use crate::bench::{bench, lines, sample};
use crate::support::place::Place;

#[test]
fn damaged_pictures_are_drawn_beside_clean_ones() {
    let place = Place::new();
    let zap = sample("icons/zap.svg");
    let damages = "clean,aliased,jpeg50,noise8";
    let args = [
        "robust", &zap, "-o", "out", "--side", "96", "--damage", damages,
    ];
    let output = bench(&place, &args);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let lines = lines(&output);
    assert_eq!(lines.len(), 4, "{lines:?}");
    assert!(
        lines[0].starts_with("zap at 96 px: 1 elements of 1, "),
        "{lines:?}"
    );
    assert!(lines[1].contains("left out stairs"), "{lines:?}");
    assert!(
        lines[2].contains("left out traces of compression"),
        "{lines:?}"
    );
    assert!(lines[3].contains("left out noise"), "{lines:?}");
    for name in [
        "robust.csv",
        "robust.json",
        "robust.md",
        "robust.png",
        "zap-96.svg",
        "zap-96-noise8.svg",
    ] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
    let summary = fs::read_to_string(place.path("out/robust.md")).unwrap();
    assert!(
        summary.contains("| noise 8 | strokefit | 1 | 1 | "),
        "{summary}"
    );
}

#[test]
fn a_short_run_takes_a_few_files_of_a_folder_with_all_damages() {
    let place = Place::new();
    fs::create_dir(place.path("art")).unwrap();
    for name in ["a", "b", "c", "d"] {
        let bar = r##"<svg xmlns="http://www.w3.org/2000/svg" width="96" height="96"><path d="M8 8h40v30h-40z" fill="#2060c0"/></svg>"##;
        fs::write(place.path(&format!("art/{name}.svg")), bar).unwrap();
    }
    fs::write(place.path("art/notes.txt"), "no picture").unwrap();
    let output = bench(&place, &["robust", "art", "-o", "out", "--short"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let lines = lines(&output);
    assert_eq!(lines.len(), 2 * 12, "{lines:?}");
    assert!(lines[12].starts_with("c at 96 px: "), "{lines:?}");
}
