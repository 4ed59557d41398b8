//! The page to watch a drawing with, as browsers and others meet it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{self, Place, STROKEFIT, Words, assert_says, installed, of_strokes, within};
use serde_json::Value;
use strokefit::fit::Fitter;
use strokefit::image::Image;
use strokefit::verify;

/// Picture that is drawn.
fn sample() -> Image {
    support::sample("coffee-300")
}

/// The program with a page, in a folder of its own.
struct Program {
    child: Child,
    stderr: BufReader<ChildStderr>,
    /// Host and port, and the path of the page.
    host: String,
    root: String,
}

impl Program {
    fn start(place: &Place, args: &str) -> Self {
        let mut child = place
            .command(STROKEFIT)
            .args(args.words())
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        stderr.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("see http://").expect(&line);
        let (host, root) = address.split_at(address.find('/').unwrap());
        Self {
            child,
            stderr,
            host: host.into(),
            root: root.into(),
        }
    }

    /// Sends a head, and returns status and body of the answer.
    fn send(&self, head: &str) -> (u16, Vec<u8>) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.write_all(head.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let status = str::from_utf8(&answer[9..12]).unwrap().parse().unwrap();
        (status, answer[end + 4..].to_vec())
    }

    fn ask(&self, method: &str, name: &str) -> (u16, Vec<u8>) {
        let Self { host, root, .. } = self;
        self.send(&format!(
            "{method} {root}{name} HTTP/1.1\r\nHost: {host}\r\n\r\n"
        ))
    }

    fn get(&self, name: &str) -> (u16, Vec<u8>) {
        self.ask("GET", name)
    }

    fn post(&self, name: &str) -> u16 {
        self.ask("POST", name).0
    }

    fn state(&self) -> Value {
        serde_json::from_slice(&self.get("state").1).unwrap()
    }

    /// The first state that is as wanted.
    #[track_caller]
    fn state_with(&self, wanted: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            let state = self.state();
            if wanted(&state) {
                return state;
            }
            let is_late = start.elapsed() > Duration::from_secs(120);
            assert!(!is_late, "never: {state:.300}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Says that the page is done, and returns the exit status.
    fn finish(mut self) -> Option<i32> {
        self.post("done");
        let mut rest = String::new();
        self.stderr.read_to_string(&mut rest).unwrap();
        self.child.wait().unwrap().code()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A folder with a drawing `a.svg` of the sample.
fn drawn() -> Place {
    let place = Place::new();
    place.done("fit @samples/coffee-300.png -q -o a.svg --strokes 80 --preset draft");
    place
}

/// A fit of the sample to `a.svg`, with the words of a line as options.
fn fitting(place: &Place, options: &str) -> Program {
    Program::start(
        place,
        &format!("fit @samples/coffee-300.png -o a.svg {options}"),
    )
}

fn strokes(state: &Value) -> usize {
    let stages = state["scene"]["stages"].as_array().unwrap().iter();
    stages.map(|stage| stage.as_array().unwrap().len()).sum()
}

#[test]
fn the_page_needs_nothing_from_elsewhere() {
    let place = drawn();
    let program = Program::start(&place, "view a.svg @samples/coffee-300.png");
    let scripts = [
        "page", "viewer", "chart", "choice", "describe", "edits", "lens", "palette", "picture",
        "swatches",
    ];
    let scripts = scripts.map(|script| format!("{script}.js"));
    for name in scripts.iter().map(String::as_str).chain(["", "page.css"]) {
        let (status, body) = program.get(name);
        assert_eq!(status, 200, "{name}");
        // The namespace of SVG is a name; nothing is there.
        let text = String::from_utf8(body).unwrap();
        let text = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!text.contains("//cdn") && !text.contains("http:") && !text.contains("https:"));
    }
    assert!(program.get("target.png").1.starts_with(b"\x89PNG"));
    assert_eq!(program.get("other").0, 404);
    assert_eq!(program.finish(), Some(0));
}

#[test]
fn a_file_is_shown_stroke_by_stroke_and_given_back() {
    let place = drawn();
    let program = Program::start(&place, "view a.svg");
    let state = program.state();
    assert_eq!(strokes(&state), 80);
    assert_eq!(
        (&state["finished"], &state["has_target"]),
        (&true.into(), &false.into())
    );
    // Who has a drawing does not get it again.
    assert!(
        serde_json::from_slice::<Value>(&program.get("state?seen=1").1).unwrap()["scene"].is_null()
    );
    assert_eq!(program.get("drawing.svg").1, place.bytes("a.svg"));
    assert_eq!(program.get("target.png").0, 404);
    assert_eq!(program.finish(), Some(0));
}

#[test]
fn only_who_was_told_the_address_gets_an_answer() {
    let place = drawn();
    let program = Program::start(&place, "view a.svg");
    let Program { host, root, .. } = &program;
    let zeros = "0".repeat(32);
    for (request, status) in [
        (format!("GET / HTTP/1.1\r\nHost: {host}"), 404),
        (format!("GET /{zeros}/ HTTP/1.1\r\nHost: {host}"), 404),
        // A name of somebody else's that resolves to this machine, and no name at all.
        (format!("GET {root} HTTP/1.1\r\nHost: evil.example"), 421),
        (format!("GET {root} HTTP/1.1\r\nX: y"), 421),
        // A foreign page that somehow knows the address.
        (
            format!("POST {root}done HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example"),
            404,
        ),
        (format!("DELETE {root} HTTP/1.1\r\nHost: {host}"), 405),
        ("nonsense".into(), 400),
    ] {
        let got = program.send(&format!("{request}\r\n\r\n")).0;
        assert_eq!(got, status, "{request}");
    }
    assert_eq!(program.get("").0, 200);
    assert_eq!(program.finish(), Some(0));
}

#[test]
fn a_fit_is_seen_to_grow_and_can_be_stopped() {
    let place = Place::new();
    let options = "--strokes 3000 --preset best --view --report r.json";
    let program = fitting(&place, options);
    let seen = program.state_with(|state| state["version"].as_u64() >= Some(3));
    assert_eq!(seen["finished"], false);
    assert!(strokes(&seen) > 0 && !seen["curve"].as_array().unwrap().is_empty());
    assert!(program.get("drawing.svg").1.starts_with(b"<svg"));
    assert_eq!(program.post("stop"), 200);
    let end = program.state_with(|state| state["finished"] == true);
    let file = program.get("drawing.svg").1;
    assert_eq!(program.finish(), Some(0));
    assert_eq!(file, place.bytes("a.svg"));
    let report = place.report("r.json");
    assert_eq!(report["stop"], "interrupted");
    assert_eq!(report["strokes"], strokes(&end));
}

#[test]
fn strokes_can_be_added_while_it_runs_and_after() {
    let place = Place::new();
    let program = fitting(&place, "--strokes 60 --preset draft --view");
    assert_eq!(program.post("more?strokes=0"), 400);
    assert_eq!(program.post("more?strokes=many"), 400);
    assert_eq!(program.post("more?strokes=40"), 200);
    let seen = |count| move |state: &Value| state["finished"] == true && strokes(state) == count;
    program.state_with(seen(100));
    assert_eq!(program.post("more?strokes=20"), 200);
    program.state_with(seen(120));
    let file = program.get("drawing.svg").1;
    assert_eq!(program.finish(), Some(0));
    assert_eq!(file, place.bytes("a.svg"));
}

#[test]
fn watching_changes_no_byte() {
    let place = Place::new();
    let fit = "fit @samples/coffee-300.png -q --strokes 300 -o";
    place.done(&format!("{fit} a.svg"));
    let program = Program::start(&place, &format!("{fit} b.svg --view"));
    program.state_with(|state| state["finished"] == true);
    assert_eq!(program.finish(), Some(0));
    assert!(place.bytes("a.svg") == place.bytes("b.svg"));
}

#[test]
fn nobody_looks_at_a_fit_that_nobody_watches() {
    let picture = sample();
    let viewer = strokefit::view::Viewer::open().unwrap();
    viewer.begin("", Some(&picture)).unwrap();
    let mut nobody = ();
    let mut observer = viewer.watch(&mut nobody);
    let fitter = Fitter::new(within(of_strokes(50))).observer(&mut observer);
    let fit = fitter.fit(&picture).unwrap();
    viewer.show(&fit.scene, "<svg/>");
    let address = viewer.address();
    let (host, root) = address["http://".len()..].split_once('/').unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET /{root}state HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    // The finished drawing is the first that was shown, although every iteration was noted.
    assert_says(&answer, &["\"version\":1,", "\"time_s\""]);
}

/// The page as Chromium has it after its script has run; `None` without Chromium.
fn page(program: &Program, hash: &str) -> Option<String> {
    let (_, chromium) = installed("chromium")?;
    let address = format!("http://{}{}#{hash}", program.host, program.root);
    // Chromium counts virtual time, and on a busy machine now and then ends before the script does.
    let mut tries = (0..5).map(|_| dump(&chromium, &address));
    let ready = tries.find(|dom| dom.contains("data-ready=\"true\""));
    Some(ready.expect("the page never was ready"))
}

fn dump(chromium: &Path, address: &str) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(chromium)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .args(["--virtual-time-budget=8000", "--window-size=1400,900"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(address)
        .stderr(Stdio::null())
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// The text of the element `id`.
fn text<'a>(dom: &'a str, id: &str) -> &'a str {
    let at = dom.find(&format!("id=\"{id}\"")).expect(id);
    let start = at + dom[at..].find('>').unwrap() + 1;
    &dom[start..start + dom[start..].find('<').unwrap()]
}

#[test]
fn chromium_shows_strokes_stages_and_fidelity() {
    let place = drawn();
    let svg = place.text("a.svg");
    let program = Program::start(&place, "view a.svg @samples/coffee-300.png");
    let Some(dom) = page(&program, "") else {
        return;
    };
    assert_eq!(text(&dom, "shown-count"), "80 of 80");
    let shown = text(&dom, "shown-db").split(' ').next().unwrap();
    let shown: f64 = shown.parse().unwrap();
    let db = verify::fidelity(&svg, &sample()).unwrap().psnr_db;
    assert!((shown - db).abs() < 0.7, "{shown} is not {db}");

    let dom = page(&program, "shown=30&hidden=1&stroke=12").unwrap();
    assert_eq!(text(&dom, "shown-count"), "30 of 80");
    assert!(dom.contains("12 of 80, stage"), "{dom}");
    let first = svg.find("Stage 1: ").map(|at| &svg[at + 9..]).unwrap();
    let hidden: usize = first.split(' ').next().unwrap().parse().unwrap();
    let seen = format!("{} strokes", 30 - hidden);
    assert_eq!(text(&dom, "shown-label"), seen);

    // Single strokes are left out, and the picture that is asked for is the large one.
    let dom = page(&program, "veiled=3,5&gone=7&large=residual&stroke=3").unwrap();
    assert_eq!(text(&dom, "shown-label"), "77 strokes");
    assert!(dom.contains(r#"id="residual-panel" class="large""#));
    assert_eq!(text(&dom, "restore"), "bring back 3");
    let dom = page(&program, "stroke=12&alone=12").unwrap();
    assert_eq!(text(&dom, "shown-label"), "1 stroke");
    assert!(dom.contains(r#"id="drawing-panel" class="large""#));
    assert!(text(&dom, "shown-db").ends_with(" dB as drawn here"));
    assert_eq!(program.finish(), Some(0));
}

#[test]
fn an_svg_by_another_program_is_called_so() {
    let place = Place::new();
    let said = place.said("view @tests/data/chelsea-traced.svg", 1);
    let words = ["no drawing by strokefit", "hint: strokefit check"];
    assert_says(&said, &words);
}

#[test]
fn a_drawing_and_a_picture_of_another_shape_are_refused() {
    let place = drawn();
    place.picture("square.png", 20, 20);
    assert_says(&place.said("view a.svg square.png", 1), &["aspect"]);
}
