//! Loops on all cores: what a function makes of many items, in the items' order.
//!
#![doc = include_str!("../README.md")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// An item before and after its turn.
enum Slot<I, T> {
    Waits(I),
    IsTaken,
    IsDone(T),
}

/// What `of` makes of each item, in the items' order, whichever thread made it.
///
/// All items are collected first. Each takes a lock twice: its work should be much longer than that.
///
/// # Panics
/// If `of` does. Other items may still be begun before the caller sees it.
///
/// ```
/// let lengths = haptical_parallel::map(["a", "bcd"], str::len);
/// assert_eq!(lengths, [1, 3]);
/// let mut sums = [1, 2];
/// let before = haptical_parallel::map(&mut sums, |sum| std::mem::replace(sum, 10 * *sum));
/// assert_eq!((before, sums), (vec![1, 2], [10, 20]));
/// ```
pub fn map<I: Send, T: Send>(
    items: impl IntoIterator<Item = I>,
    of: impl Fn(I) -> T + Sync,
) -> Vec<T> {
    let slots: Vec<Mutex<Slot<I, T>>> = items
        .into_iter()
        .map(|item| Mutex::new(Slot::Waits(item)))
        .collect();
    let put = |place: usize, slot| {
        // no lock is held while `of` runs, so none is ever poisoned
        let mut held = slots[place].lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::replace(&mut *held, slot)
    };
    each(slots.len(), &|place| {
        if let Slot::Waits(item) = put(place, Slot::IsTaken) {
            put(place, Slot::IsDone(of(item)));
        }
    });
    let done = slots
        .into_iter()
        .map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner));
    done.filter_map(|slot| match slot {
        Slot::IsDone(made) => Some(made),
        Slot::Waits(_) | Slot::IsTaken => None,
    })
    .collect()
}

/// Whether `is` holds of one of the items. A thread that has seen that it does of one begins no other.
///
/// # Panics
/// As [`map`].
///
/// ```
/// assert!(haptical_parallel::any([1, 4, 9], |number| number > 8));
/// assert!(!haptical_parallel::any([1, 4, 9], |number| number > 9));
/// ```
pub fn any<I: Send>(items: impl IntoIterator<Item = I>, is: impl Fn(I) -> bool + Sync) -> bool {
    let holds = AtomicBool::new(false);
    map(items, |item| {
        if !holds.load(Ordering::Relaxed) && is(item) {
            holds.store(true, Ordering::Relaxed);
        }
    });
    holds.into_inner()
}

/// The one loop of rayon. Never inlined: a crate that calls [`map`] does not compile it again.
#[inline(never)]
fn each(count: usize, of: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(of);
}
