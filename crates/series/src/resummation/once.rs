//! What is made once and kept.

use lindstedt_algebra::Stop;
use std::sync::{Mutex, PoisonError};

/// A value that is made when it is first asked for, without a lock: two threads may both make it. What was broken
/// off is not kept.
pub(super) struct Once<K, T>(Mutex<Vec<(K, T)>>);

impl<K: PartialEq, T: Clone> Once<K, T> {
    pub fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    pub fn get(&self, key: K, stop: &Stop, make: impl FnOnce() -> T) -> T {
        let list = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = list().iter().find(|(of, _)| *of == key) {
            return known.clone();
        }
        let made = make();
        if !stop.asked() {
            list().push((key, made.clone()));
        }
        made
    }
}
