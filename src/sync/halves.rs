//! Work on many frames, on two cores.

use std::{ops::Range, panic::resume_unwind, thread};

/// Fewer frames are not worth another thread.
const WORTH_A_THREAD: usize = 2048;

/// Does work on frames, on two cores where there are many: `work` gets the first half, and the second half with
/// `overlap` frames before it. Returns what it made, in order. Halves depend on the number of frames alone, so that
/// results do not depend on the machine.
pub fn halves<T: Send>(n_frames: usize, overlap: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    if n_frames < WORTH_A_THREAD {
        return vec![work(0..n_frames)];
    }
    let middle = n_frames / 2;
    thread::scope(|scope| {
        let second = scope.spawn(|| work(middle - overlap..n_frames));
        let first = work(0..middle);
        vec![first, second.join().unwrap_or_else(|panic| resume_unwind(panic))]
    })
}

/// Makes a list by halves: `work` makes the values of some frames, one each.
pub fn listed<T: Send>(n_frames: usize, work: impl Fn(Range<usize>) -> Vec<T> + Sync) -> Vec<T> {
    let mut parts = halves(n_frames, 0, work).into_iter();
    let mut all = parts.next().unwrap_or_default();
    parts.for_each(|part| all.extend(part));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_cover_every_frame_once_but_for_the_overlap() {
        for n in [0, 1, WORTH_A_THREAD - 1, WORTH_A_THREAD, WORTH_A_THREAD + 1] {
            assert_eq!(listed(n, |range| range.collect()), (0..n).collect::<Vec<_>>());
            let parts = halves(n, 3, |range| range);
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, n));
            assert!(parts.windows(2).all(|pair| pair[1].start + 3 == pair[0].end));
        }
    }
}
