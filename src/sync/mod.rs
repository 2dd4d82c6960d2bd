//! Between threads: a one-place mailbox where the newest value wins, a wish for long work to be given up, and work on
//! frames shared by two cores.
//!
//! A mailbox's slow reader skips values and its fast writer never waits. The lock is held for a move, never across a
//! call.

mod halves;

use std::sync::{
    Arc, Condvar, Mutex, PoisonError,
    atomic::{AtomicBool, Ordering},
};

pub use halves::{both, each, halves, listed, pooled, side_by_side};

/// A wish for long work to be given up, shared by clones.
#[derive(Clone, Debug, Default)]
pub struct Hurry(Arc<AtomicBool>);

impl Hurry {
    /// Wishes that what looks at this is given up.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Takes the wish back.
    pub fn lower(&self) {
        self.0.store(false, Ordering::Relaxed);
    }

    /// Tells whether somebody wishes it.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A place for one value, shared by clones.
#[derive(Debug)]
pub struct Mailbox<T> {
    inner: Arc<(Mutex<State<T>>, Condvar)>,
}

#[derive(Debug)]
struct State<T> {
    value: Option<T>,
    closed: bool,
}

impl<T> Clone for Mailbox<T> {
    fn clone(&self) -> Self {
        Self { inner: Arc::clone(&self.inner) }
    }
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self { inner: Arc::new((Mutex::new(State { value: None, closed: false }), Condvar::new())) }
    }
}

impl<T> Mailbox<T> {
    /// Puts a value in and returns the one it replaced, if that was never taken.
    pub fn put(&self, value: T) -> Option<T> {
        let (state, changed) = &*self.inner;
        let old = state.lock().unwrap_or_else(PoisonError::into_inner).value.replace(value);
        changed.notify_one();
        old
    }

    /// Takes the value, if there is one.
    pub fn take(&self) -> Option<T> {
        self.inner.0.lock().unwrap_or_else(PoisonError::into_inner).value.take()
    }

    /// Waits for a value; none once the mailbox is closed and empty.
    pub fn wait(&self) -> Option<T> {
        let (state, changed) = &*self.inner;
        let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if let Some(value) = state.value.take() {
                return Some(value);
            }
            if state.closed {
                return None;
            }
            state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Closes the mailbox: waiting readers get what is left, then none.
    pub fn close(&self) {
        let (state, changed) = &*self.inner;
        state.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newest_value_wins() {
        let mailbox = Mailbox::default();
        assert_eq!(mailbox.put(1), None);
        assert_eq!(mailbox.put(2), Some(1));
        assert_eq!(mailbox.take(), Some(2));
        assert_eq!(mailbox.take(), None);
    }

    #[test]
    fn closing_wakes_the_reader_after_the_last_value() {
        let mailbox = Mailbox::default();
        let reader = std::thread::spawn({
            let mailbox = mailbox.clone();
            move || (mailbox.wait(), mailbox.wait())
        });
        mailbox.put(7);
        mailbox.close();
        let (first, second) = reader.join().expect("reader does not panic");
        assert_eq!(first.or(second), Some(7));
    }
}
