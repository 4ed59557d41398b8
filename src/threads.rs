//! Worker threads, where the platform has them.

use std::io;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::error::{Error, ErrorKind, Result};

/// Who does the work of one fit.
#[derive(Debug)]
pub(crate) enum Workers {
    /// Threads of its own.
    Pool(ThreadPool),
    /// Whoever asks: the platform starts no threads, as WebAssembly does not.
    Caller,
}

impl Workers {
    /// So many threads; as many as there are cores when 0.
    ///
    /// # Errors
    /// [`ErrorKind::Config`] when the system does not start so many.
    pub(crate) fn new(threads: usize) -> Result<Self> {
        match ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => Ok(Self::Pool(pool)),
            Err(cause) if is_unsupported(&cause) => Ok(Self::Caller),
            Err(cause) => {
                let message = format!("cannot start {threads} worker threads: ask for fewer");
                Err(Error::new(ErrorKind::Config, message).caused_by(cause))
            }
        }
    }

    /// Runs `work`, which finds these workers as rayon's current ones.
    pub(crate) fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match self {
            Self::Pool(pool) => pool.install(work),
            Self::Caller => work(),
        }
    }
}

/// Whether the platform has no threads at all.
fn is_unsupported(error: &ThreadPoolBuildError) -> bool {
    let cause = std::error::Error::source(error).and_then(|cause| cause.downcast_ref());
    cause.is_some_and(|cause: &io::Error| cause.kind() == io::ErrorKind::Unsupported)
}
