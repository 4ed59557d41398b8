//! A fit under way: its state, what it has done, who is told of it, and how a checkpoint keeps it.

pub(super) mod checkpoint;
pub(super) mod finish;
pub(super) mod history;
pub(super) mod progress;
pub(super) mod session;
