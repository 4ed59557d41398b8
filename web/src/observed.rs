//! The observer that tells a JavaScript function of progress.

use std::cell::RefCell;
use std::ops::ControlFlow;

use strokefit::fit::{Observer, Progress};
use strokefit::report::SceneRecord;
use strokefit::scene::Scene;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// A function that is told of progress, and returns whether the fit is to go on.
    #[wasm_bindgen(js_name = Function)]
    pub type Watcher;

    /// `scene` returns the drawing so far as JSON, during the call only.
    #[wasm_bindgen(method, catch)]
    #[allow(
        clippy::too_many_arguments,
        reason = "an object of them would be built at every iteration"
    )]
    fn call(
        this: &Watcher,
        nobody: &JsValue,
        done: f64,
        stage: usize,
        stages: usize,
        polishing: bool,
        strokes: usize,
        psnr_db: f64,
        is_trial: bool,
        scene: &dyn Fn() -> String,
    ) -> Result<bool, JsValue>;
}

thread_local! {
    // Observers have to be `Send`, which no value of JavaScript is: the fit, which stays on this thread, finds it here.
    static WATCHER: RefCell<Option<Watcher>> = const { RefCell::new(None) };
    static THROWN: RefCell<Option<JsValue>> = const { RefCell::new(None) };
}

/// Tells the watcher, as long as it lives.
pub(crate) struct Observed(());

impl Observed {
    pub(crate) fn new(watcher: Option<Watcher>) -> Self {
        THROWN.set(None);
        WATCHER.set(watcher);
        Self(())
    }

    /// Exception of the watcher, which stopped the fit.
    pub(crate) fn thrown(&self) -> Option<JsValue> {
        THROWN.take()
    }
}

impl Drop for Observed {
    fn drop(&mut self) {
        WATCHER.set(None);
    }
}

impl Observer for Observed {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        let goes_on =
            WATCHER.with_borrow(|watcher| watcher.as_ref().map(|watcher| tell(watcher, progress)));
        match goes_on {
            None | Some(Ok(true)) => ControlFlow::Continue(()),
            Some(Ok(false)) => ControlFlow::Break(()),
            Some(Err(thrown)) => {
                THROWN.set(Some(thrown));
                ControlFlow::Break(())
            }
        }
    }
}

fn tell(watcher: &Watcher, progress: &Progress<'_>) -> Result<bool, JsValue> {
    watcher.call(
        &JsValue::NULL,
        progress.done,
        progress.stage,
        progress.stages,
        progress.polishing,
        progress.strokes,
        progress.psnr_db,
        progress.is_trial,
        &|| scene_json(&progress.scene()),
    )
}

/// A drawing for canvases. It is plain numbers and text, which JSON can always say.
pub(crate) fn scene_json(scene: &Scene) -> String {
    serde_json::to_string(&SceneRecord::from(scene)).unwrap_or_default()
}
