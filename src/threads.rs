//! Worker threads, where the platform has them.

use std::io;
use std::sync::{Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use crate::error::{Error, ErrorKind, Result};

/// Who does the work of one fit.
#[derive(Debug)]
pub enum Workers {
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
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match self {
            Self::Pool(pool) => pool.install(work),
            Self::Caller => work(),
        }
    }
}

/// Scratch of each worker of rayon's current ones.
#[derive(Debug)]
pub(crate) struct PerWorker<T>(Vec<Mutex<T>>);

impl<T> PerWorker<T> {
    /// Scratch that `make` makes, once for each worker.
    pub(crate) fn new(make: impl Fn() -> T) -> Self {
        let workers = 0..rayon::current_num_threads();
        Self(workers.map(|_| Mutex::new(make())).collect())
    }

    /// Runs `work` with the scratch of this worker.
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        // A worker never waits here: no other has its index. A panic elsewhere leaves only stale
        // numbers behind, which all work overwrites, so a poisoned lock is as good as another.
        let index = rayon::current_thread_index().unwrap_or(0) % self.0.len();
        work(&mut self.0[index].lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// True if the platform has no threads at all.
fn is_unsupported(error: &ThreadPoolBuildError) -> bool {
    let cause = std::error::Error::source(error).and_then(|cause| cause.downcast_ref());
    cause.is_some_and(|cause: &io::Error| cause.kind() == io::ErrorKind::Unsupported)
}
