//! Work on many frames, on two cores.
//!
//! Threads wait in a pool: to wake one costs a fraction of what starting it does, and where none is free the caller
//! does all the work itself. What is split and where depends on the number of frames alone, unless the values are the
//! same however they are split, so that results depend neither on the machine nor on how busy it is.

use std::ops::Range;

use rayon::prelude::*;

/// Fewer frames are not worth another thread.
const WORTH_A_THREAD: usize = 2048;

/// Does a long piece of work among the pool's threads, where all it splits off is at hand.
pub fn pooled<T: Send>(n_frames: usize, work: impl FnOnce() -> T + Send) -> T {
    if n_frames < WORTH_A_THREAD { work() } else { rayon::scope(|_| work()) }
}

/// Does two pieces of work on frames side by side, where there are many.
pub fn both<A: Send, B: Send>(
    n_frames: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if n_frames < WORTH_A_THREAD { (first(), second()) } else { rayon::join(first, second) }
}

/// Does work on frames, on two cores where there are many: `work` gets the first half, and the second half with
/// `overlap` frames before it. Returns what it made, in order. Groups of up to eight frames stay whole.
pub fn halves<T: Send>(n_frames: usize, overlap: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    if n_frames < WORTH_A_THREAD {
        return vec![work(0..n_frames)];
    }
    let middle = n_frames / 2 / 8 * 8;
    let (first, second) = rayon::join(|| work(0..middle), || work(middle - overlap..n_frames));
    vec![first, second]
}

/// Makes a list by halves: `work` makes the values of some frames, one each, the same in whatever range they are. Where
/// there is one core it is made at once, for the halves need not be joined.
pub fn listed<T: Send, I: Iterator<Item = T>>(n_frames: usize, work: impl Fn(Range<usize>) -> I + Sync) -> Vec<T> {
    if rayon::current_num_threads() == 1 {
        let mut list = Vec::with_capacity(n_frames);
        list.extend(work(0..n_frames));
        return list;
    }
    let parts = halves(n_frames, 0, |range| {
        // The first part takes the other up.
        let mut list = Vec::with_capacity(if range.start == 0 { n_frames } else { range.len() });
        list.extend(work(range));
        list
    });
    let mut parts = parts.into_iter();
    let mut all = parts.next().unwrap_or_default();
    parts.for_each(|part| all.extend(part));
    all
}

/// Makes something of each of a few things that are `n_frames` long, side by side where that is many.
pub fn each<A: Sync, T: Send>(things: &[A], n_frames: usize, make: impl Fn(usize, &A) -> T + Sync) -> Vec<T> {
    if n_frames < WORTH_A_THREAD {
        return things.iter().enumerate().map(|(idx, thing)| make(idx, thing)).collect();
    }
    things.par_iter().enumerate().with_max_len(1).map(|(idx, thing)| make(idx, thing)).collect()
}

/// Makes something of each of a few things, side by side; each is worth a thread.
pub fn side_by_side<A: Sync, T: Send>(things: &[A], make: impl Fn(&A) -> T + Sync) -> Vec<T> {
    things.par_iter().with_max_len(1).map(&make).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_cover_every_frame_once_but_for_the_overlap() {
        for n in [0, 1, WORTH_A_THREAD - 1, WORTH_A_THREAD, WORTH_A_THREAD + 1] {
            assert_eq!(listed(n, |range| range), (0..n).collect::<Vec<_>>());
            let parts = halves(n, 3, |range| range);
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (0, n));
            assert!(parts.windows(2).all(|pair| pair[1].start + 3 == pair[0].end));
        }
    }

    #[test]
    fn each_thing_is_made_once_in_order() {
        for n_frames in [1, WORTH_A_THREAD] {
            for n in 0..6 {
                let things: Vec<usize> = (0..n).map(|i| 10 * i).collect();
                let made = each(&things, n_frames, |idx, thing| (idx, *thing));
                assert_eq!(made, (0..n).map(|i| (i, 10 * i)).collect::<Vec<_>>());
            }
            assert_eq!(pooled(n_frames, || both(n_frames, || 1, || "two")), (1, "two"));
        }
    }
}
