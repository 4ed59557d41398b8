//! Chromium and browsers made of it, which draw with Skia.

use std::ffi::OsString;
use std::fs;
use std::io;

use super::{DrawRequest, Engine, Job, SVG, process};

pub(super) const ENGINE: Engine = Engine {
    name: "chromium",
    install: "apt-get install chromium, or https://www.google.com/chrome",
    programs: &[
        "chromium-headless-shell",
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ],
    arguments,
    failure: Some(UNREADABLE),
    keeps_home: false,
    has_margin: true,
};

/// The line that the page writes to the browser's log when the drawing cannot be shown.
const UNREADABLE: &str = "strokefit: the drawing cannot be shown";

/// Margin by which the window is made larger than the picture, px. Windows cannot be narrower than 500 px, and some
/// versions count the invisible window's frame as part of its size.
const MARGIN: usize = 500;

/// The drawing is shown as `<img>`: it is scaled to the picture, and scripts and references in it
/// are dead.
fn arguments(job: &Job<'_>) -> io::Result<Vec<OsString>> {
    let html = job.folder.join("page.html");
    fs::write(&html, page(job.request))?;
    let flag = |name: &str, value: OsString| {
        let mut flag = OsString::from(name);
        flag.push(value);
        flag
    };
    let DrawRequest { width, height, .. } = job.request;
    let mut arguments = vec![
        flag("--screenshot=", job.png().into()),
        flag("--user-data-dir=", job.folder.join("profile").into()),
        format!("--window-size={},{}", width + MARGIN, height + MARGIN).into(),
    ];
    arguments.extend(FLAGS.map(OsString::from));
    // Chromium refuses to start as root with its sandbox.
    if process::is_root() {
        arguments.push("--no-sandbox".into());
    }
    arguments.push(flag("file://", html.into()));
    Ok(arguments)
}

const FLAGS: [&str; 14] = [
    "--headless",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
    "--force-color-profile=srgb",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-sync",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--enable-logging=stderr",
    "--log-level=0",
];

fn page(request: DrawRequest<'_>) -> String {
    let DrawRequest { width, height, .. } = request;
    format!(
        "<!doctype html><meta charset=\"utf-8\"><title>drawing</title>\
         <style>html,body{{margin:0;background:#fff}}\
         img{{display:block;width:{width}px;height:{height}px}}</style>\
         <img src=\"{SVG}\" onerror=\"console.error('{UNREADABLE}')\">\n"
    )
}
