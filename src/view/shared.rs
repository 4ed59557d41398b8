//! The state that fit and server share: the drawing so far from the fit, requests from the page.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::fit::Progress;
use crate::scene::Scene;
use crate::svg::{self, WriteOptions};

/// A page that has not asked for this long counts as closed or hidden.
const LOOKING: Duration = Duration::from_secs(3);
/// Least time between two copies of the drawing.
const BETWEEN_LOOKS: Duration = Duration::from_millis(250);

/// Points that are kept at most.
const CAPACITY: usize = 1000;

/// One moment of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Point {
    /// Since the start, s.
    pub(super) time_s: f64,
    pub(super) strokes: usize,
    /// As the observer was told; `null` in JSON when there is no error.
    pub(super) psnr_db: f64,
}

/// Evenly spaced points; the spacing doubles when there are too many.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    points: Vec<Point>,
    /// Every so many points one is kept, less one.
    skipped: usize,
    /// Number of points that were offered.
    seen: usize,
}

impl Curve {
    pub(super) fn push(&mut self, point: Point) {
        if self.seen.is_multiple_of(self.skipped + 1) {
            self.points.push(point);
        }
        self.seen += 1;
        if self.points.len() > CAPACITY {
            let mut even = [true, false].into_iter().cycle();
            self.points.retain(|_| even.next().unwrap_or(true));
            self.skipped = 2 * self.skipped + 1;
        }
    }

    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }
}

/// Wish of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wish {
    /// End the fit now.
    Stop,
    /// Add this many strokes when the fit is over.
    More(usize),
    /// Nothing more: the program may end.
    Leave,
}

/// Numbers of a fit under way.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Numbers {
    /// Fraction of the fit.
    pub(super) done: f64,
    pub(super) stage: usize,
    pub(super) stages: usize,
    pub(super) polishing: bool,
    pub(super) settling: bool,
    pub(super) last: Point,
}

/// A drawing, numbered so that a page knows whether it has it.
#[derive(Debug, Clone)]
pub(super) struct Shown {
    pub(super) version: u64,
    pub(super) scene: Arc<Scene>,
}

/// Picture that is drawn.
#[derive(Debug, Default)]
pub(super) struct Picture {
    /// From 1.
    pub(super) number: u64,
    pub(super) title: String,
    /// A PNG.
    pub(super) target: Option<Vec<u8>>,
}

/// All that the page shows, at one moment.
#[derive(Clone, Default)]
pub(super) struct State {
    pub(super) picture: Arc<Picture>,
    pub(super) numbers: Option<Numbers>,
    pub(super) curve: Curve,
    pub(super) shown: Option<Shown>,
    /// The file, once it is finished.
    pub(super) file: Option<Arc<str>>,
    /// True if more strokes can be had.
    pub(super) grows: bool,
    /// The strokes that are to be added when the fit is over.
    pub(super) more: Option<usize>,
}

pub(super) struct Shared {
    inside: Mutex<Inside>,
    changed: Condvar,
}

struct Inside {
    state: State,
    /// When the drawing was begun.
    began: Instant,
    /// The number of the drawing that was shown last.
    version: u64,
    /// When a page last asked.
    asked: Option<Instant>,
    /// When the fit was last looked at.
    looked: Option<Instant>,
    stop: bool,
    leave: bool,
}

impl Shared {
    pub(super) fn new() -> Self {
        Self {
            inside: Mutex::new(Inside {
                state: State::default(),
                began: Instant::now(),
                version: 0,
                asked: None,
                looked: None,
                stop: false,
                leave: false,
            }),
            changed: Condvar::new(),
        }
    }

    /// Turns to another drawing.
    pub(super) fn begin(&self, title: &str, target: Option<Vec<u8>>) {
        let mut inside = self.lock();
        let picture = Picture {
            number: inside.state.picture.number + 1,
            title: title.to_owned(),
            target,
        };
        inside.state = State {
            picture: Arc::new(picture),
            grows: inside.state.grows,
            // Asked for before the fit began.
            more: inside.state.more,
            ..State::default()
        };
        inside.began = Instant::now();
        inside.stop = false;
    }

    /// Offers more strokes, or not.
    pub(super) fn offer_more(&self, offered: bool) {
        self.lock().state.grows = offered;
    }

    /// Locks the state. A thread that panicked while it held the lock left only whole values behind, so a
    /// poisoned lock is used as it is.
    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes note of a fit's progress, and copies its drawing if a page wants to see it now. Returns whether
    /// the fit is to go on.
    pub(super) fn note(&self, progress: &Progress<'_>) -> bool {
        let now = Instant::now();
        let mut inside = self.lock();
        let last = Point {
            time_s: (now - inside.began).as_secs_f64(),
            strokes: progress.strokes,
            psnr_db: progress.psnr_db,
        };
        inside.state.curve.push(last);
        inside.state.numbers = Some(Numbers {
            done: progress.done,
            stage: progress.stage,
            stages: progress.stages,
            polishing: progress.polishing,
            settling: progress.settling,
            last,
        });
        if inside.wants_look(now) {
            inside.looked = Some(now);
            inside.show(progress.scene());
        }
        !inside.stop
    }

    /// Shows a finished drawing.
    pub(super) fn finish(&self, scene: Scene, file: String) {
        let mut inside = self.lock();
        inside.show(scene);
        inside.state.file = Some(file.into());
    }

    /// Returns the state to a page that asks, and notes the time.
    pub(super) fn asked(&self) -> State {
        let mut inside = self.lock();
        inside.asked = Some(Instant::now());
        inside.state.clone()
    }

    /// The target as a PNG.
    pub(super) fn target(&self) -> Option<Vec<u8>> {
        self.asked().picture.target.clone()
    }

    /// The file, or what it would be now.
    pub(super) fn svg(&self) -> Option<Arc<str>> {
        let State { shown, file, .. } = self.asked();
        let unfinished = |shown: Shown| svg::write(&shown.scene, &WriteOptions::default()).into();
        file.or_else(|| shown.map(unfinished))
    }

    pub(super) fn wish(&self, wish: Wish) {
        let mut inside = self.lock();
        match wish {
            Wish::Stop => inside.stop = true,
            Wish::More(strokes) => inside.state.more = Some(strokes),
            Wish::Leave => inside.leave = true,
        }
        self.changed.notify_all();
    }

    /// Waits until the page asks for more strokes, and returns how many; or until it asks for nothing more or
    /// has not been heard of for `patience`.
    pub(super) fn wait(&self, patience: Duration) -> Option<usize> {
        let start = Instant::now();
        let mut inside = self.lock();
        while inside.state.more.is_none() && !inside.leave {
            let last = inside.asked.map_or(start, |asked| asked.max(start));
            let left = patience
                .checked_sub(last.elapsed())
                .filter(|left| !left.is_zero())?;
            let woken = self.changed.wait_timeout(inside, left);
            inside = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
        inside.state.more.take()
    }
}

impl Inside {
    fn wants_look(&self, now: Instant) -> bool {
        let within = |then: Option<Instant>, span| then.is_some_and(|then| now - then < span);
        within(self.asked, LOOKING) && !within(self.looked, BETWEEN_LOOKS)
    }

    fn show(&mut self, scene: Scene) {
        self.version += 1;
        self.state.shown = Some(Shown {
            version: self.version,
            scene: Arc::new(scene),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_ends_when_no_page_is_heard_of() {
        let shared = Shared::new();
        assert_eq!(shared.wait(Duration::from_millis(5)), None);
        shared.asked();
        assert_eq!(shared.wait(Duration::from_millis(5)), None);
    }

    #[test]
    fn waiting_ends_when_the_page_is_done() {
        let shared = Shared::new();
        std::thread::scope(|threads| {
            threads.spawn(|| shared.wish(Wish::Leave));
            assert_eq!(shared.wait(Duration::from_secs(3600)), None);
        });
    }

    #[test]
    fn more_strokes_are_wanted_once() {
        let shared = Shared::new();
        shared.wish(Wish::More(7));
        assert_eq!(shared.wait(Duration::from_secs(3600)), Some(7));
        assert_eq!(shared.wait(Duration::from_millis(5)), None);
    }

    #[test]
    fn the_file_is_what_is_shown_until_there_is_one() {
        let shared = Shared::new();
        assert!(shared.svg().is_none());
        shared.lock().show(Scene::empty(3, 2, None));
        assert!(shared.svg().unwrap().contains("viewBox=\"0 0 3 2\""));
        shared.finish(Scene::empty(3, 2, None), "the file".into());
        assert_eq!(&*shared.svg().unwrap(), "the file");
    }

    #[test]
    fn a_long_fit_leaves_evenly_spaced_points() {
        let mut curve = Curve::default();
        for strokes in 0..100_000 {
            curve.push(Point {
                time_s: 0.0,
                strokes,
                psnr_db: 0.0,
            });
        }
        let strokes: Vec<usize> = curve.points().iter().map(|p| p.strokes).collect();
        assert!((CAPACITY / 2..=CAPACITY).contains(&strokes.len()));
        let step = strokes[1] - strokes[0];
        assert!(strokes.windows(2).all(|w| w[1] - w[0] == step));
        assert!(strokes[0] == 0 && 100_000 - strokes[strokes.len() - 1] <= step);
    }
}
