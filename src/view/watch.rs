//! The observer that passes a fit's progress on to the page.

use std::ops::ControlFlow;

use super::shared::Shared;
use crate::fit::{Observer, Progress};

/// Reports a fit to the page and to another observer; either may stop it.
pub struct Watched<'a> {
    shared: &'a Shared,
    inner: &'a mut (dyn Observer + Send),
}

impl<'a> Watched<'a> {
    pub(super) fn new(shared: &'a Shared, inner: &'a mut (dyn Observer + Send)) -> Self {
        Self { shared, inner }
    }
}

impl Observer for Watched<'_> {
    fn observe(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        self.inner.observe(progress)?;
        if self.shared.note(progress) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}
