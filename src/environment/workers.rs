//! Threads of our own, as many as wanted: results never depend on how many.

use std::sync::Arc;

use bevy::prelude::*;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use thiserror::Error;

use crate::limits;

/// Why there are no such workers.
#[derive(Debug, Error)]
pub enum WorkersError {
    /// More than [`limits::THREADS`].
    #[error("{wanted} threads are more than the {} allowed", limits::THREADS)]
    TooMany {
        /// Threads asked for.
        wanted: usize,
    },
    /// The system gave no threads.
    #[error("the system gave no {wanted} threads")]
    Refused {
        /// Threads asked for.
        wanted: usize,
        /// What it said.
        source: ThreadPoolBuildError,
    },
}

/// The threads that sense, a resource. The global pools cannot be resized; this one is replaced.
/// A clone works with the same threads.
#[derive(Resource, Debug, Clone, Reflect)]
#[reflect(Resource, Default)]
pub struct Workers {
    /// None: the calling thread does the work.
    #[reflect(ignore)]
    pool: Option<Arc<ThreadPool>>,
}

impl Default for Workers {
    /// A thread for each core; if the system gives none, the calling thread does the work.
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from).min(limits::THREADS);
        Self::new(cores).unwrap_or(Self { pool: None })
    }
}

impl Workers {
    /// `threads` threads; 1 works on the calling thread, 0 takes one for each core.
    ///
    /// # Errors
    /// More than [`limits::THREADS`], or the system gives none.
    pub fn new(threads: usize) -> Result<Self, WorkersError> {
        match threads {
            0 => Ok(Self::default()),
            1 => Ok(Self { pool: None }),
            wanted if wanted > limits::THREADS => Err(WorkersError::TooMany { wanted }),
            wanted => ThreadPoolBuilder::new()
                .num_threads(wanted)
                .thread_name(|i| format!("burgeon worker {i}"))
                .build()
                .map(|pool| Self { pool: Some(Arc::new(pool)) })
                .map_err(|source| WorkersError::Refused { wanted, source }),
        }
    }

    /// How many threads work.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, |pool| pool.current_num_threads())
    }

    /// `task(0)` to `task(n - 1)`, results by index.
    pub fn map<T: Send>(&self, n: usize, task: impl Fn(usize) -> T + Sync) -> Vec<T> {
        match &self.pool {
            None => (0..n).map(task).collect(),
            Some(pool) => pool.install(|| (0..n).into_par_iter().map(&task).collect()),
        }
    }

    /// Does both, on two threads if there are two.
    pub fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        match &self.pool {
            None => {
                one();
                other();
            }
            Some(pool) => {
                pool.join(one, other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_by_index_on_any_number_of_threads() {
        for threads in [0, 1, 2, 5] {
            let workers = Workers::new(threads).unwrap();
            assert!(threads == 0 || workers.threads() == threads);
            assert_eq!(workers.map(1000, |i| i * i), (0..1000).map(|i| i * i).collect::<Vec<_>>());
            assert!(workers.map(0, |i| i).is_empty());
            let (mut one, mut other) = (0, 0);
            workers.both(|| one = 1, || other = 2);
            assert_eq!((one, other), (1, 2));
        }
        assert!(matches!(Workers::new(100_000), Err(WorkersError::TooMany { wanted: 100_000 })));
    }
}
