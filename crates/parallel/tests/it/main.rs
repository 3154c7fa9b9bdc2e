//! Tests of the parallel map.
#![allow(
    clippy::panic,
    reason = "clippy.toml allows it in test functions; closures are meant too"
)]

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use haptical_parallel::{any, map};

#[test]
fn results_are_in_the_order_of_the_items() {
    // the first items take longest, so that later ones are done before them
    let made = map(0..200_u64, |item| {
        let rounds = (200 - item) * 1000;
        (item, (0..rounds).fold(item, |a, b| a.wrapping_mul(31) ^ b))
    });
    let places: Vec<u64> = made.iter().map(|(item, _)| *item).collect();
    assert_eq!(places, (0..200).collect::<Vec<_>>());
}

#[test]
fn every_item_has_its_turn_once() {
    let turns: Vec<AtomicUsize> = (0..1000).map(|_| AtomicUsize::new(0)).collect();
    let made = map(&turns, |turn| turn.fetch_add(1, Ordering::Relaxed));
    assert_eq!(made.len(), 1000);
    assert!(turns.iter().all(|turn| turn.load(Ordering::Relaxed) == 1));
}

#[test]
fn a_map_within_a_map_ends() {
    let sums = map(0..50_usize, |row| {
        map(0..50, |column| row * column).iter().sum::<usize>()
    });
    assert_eq!(sums[49], 49 * 49 * 50 / 2);
}

#[test]
fn no_item_is_begun_after_one_that_holds() {
    let begun = AtomicUsize::new(0);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let holds = one.expect("a pool of one").install(|| {
        any(0..100, |item| {
            begun.fetch_add(1, Ordering::Relaxed);
            item == 3
        })
    });
    assert!(holds);
    assert_eq!(begun.into_inner(), 4);
    assert!(!any(0..100, |item| item == 100));
}

#[test]
fn nothing_has_no_results() {
    assert!(map(Vec::<u8>::new(), |item| item).is_empty());
}

#[test]
fn several_threads_take_part() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build();
    let seen = Mutex::new(BTreeSet::new());
    pool.expect("a pool of four").install(|| {
        map(0..64, |_| {
            std::thread::sleep(std::time::Duration::from_millis(2));
            let mut seen = seen.lock().expect("no thread panics");
            seen.insert(rayon::current_thread_index());
        })
    });
    let seen = seen.into_inner().expect("no thread panics");
    assert!(seen.len() > 1, "{seen:?}");
}

#[test]
fn a_panic_of_an_item_is_the_callers() {
    let made = std::panic::catch_unwind(|| {
        map(0..20, |item| {
            assert!(item != 7, "the seventh");
        })
    });
    let said = made.expect_err("the seventh panics");
    assert_eq!(said.downcast_ref::<&str>(), Some(&"the seventh"));
    // the threads go on
    assert_eq!(map(0..3, |item| 2 * item), [0, 2, 4]);
}
