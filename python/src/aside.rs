//! Work on a thread of its own, while the caller's thread answers to Python.

use std::any::Any;
use std::ops::ControlFlow;
use std::sync::mpsc::{self, RecvTimeoutError, SyncSender};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use strokefit::fit::{CancelToken, Observer, Progress};

use crate::failure::Failure;

/// Time between the caller's looks for signals: Ctrl-C is answered within this time.
const POLL: Duration = Duration::from_millis(50);

/// The stack of the thread, bytes: as much as a program's first thread has on Linux.
const STACK: usize = 8 << 20;

/// Done (0..1), strokes, fidelity (dB).
type Step = (f64, usize, f64);

enum Message<T> {
    Step(Step),
    End(Result<T, Failure>),
}

/// Does `work` on another thread without Python's lock, and calls `progress` on this one.
///
/// Where a signal's handler or `progress` raises, this returns at once: the thread is told to stop, and what it
/// still finishes is dropped. It never touches a Python object.
pub(crate) fn aside<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&mut (dyn Observer + Send)) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    // One step at most waits to be told: a slow `progress` sees fewer, and the work never waits.
    let (sender, mut receiver) = mpsc::sync_channel(1);
    let left = Left::default();
    let watch = Watch {
        steps: progress.is_some().then(|| sender.clone()),
        left: left.0.clone(),
    };
    thread::Builder::new()
        .name("strokefit".into())
        .stack_size(STACK)
        .spawn(move || run(work, watch, &sender))?;
    loop {
        let message;
        (message, receiver) = py.detach(move || (receiver.recv_timeout(POLL), receiver));
        match message {
            Ok(Message::Step(step)) => {
                if let Some(progress) = progress {
                    progress.call1(step)?;
                }
            }
            Ok(Message::End(outcome)) => return Ok(outcome?),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::Panic("a thread ended without a word".into()).into());
            }
        }
        py.check_signals()?;
    }
}

fn run<T: Send>(
    work: impl FnOnce(&mut (dyn Observer + Send)) -> Result<T, Failure>,
    mut watch: Watch<T>,
    sender: &SyncSender<Message<T>>,
) {
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(&mut watch)));
    let outcome = outcome.unwrap_or_else(|panic| Err(Failure::Panic(words(&*panic))));
    // Nobody listens any more where the caller has left.
    let _ = sender.send(Message::End(outcome));
}

/// Text of a panic.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref().cloned())
        .unwrap_or_default()
}

/// Tells the thread that its caller has left.
#[derive(Default)]
struct Left(CancelToken);

impl Drop for Left {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

/// Passes on how a fit goes, and stops it when the caller has left.
struct Watch<T> {
    steps: Option<SyncSender<Message<T>>>,
    left: CancelToken,
}

impl<T: Send> Observer for Watch<T> {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        if let Some(steps) = &self.steps {
            let step = (progress.done, progress.strokes, progress.psnr_db);
            let _ = steps.try_send(Message::Step(step));
        }
        match self.left.is_cancelled() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}
