//! Memory does not grow with the rows.

use haptical_monitor::{Event, Monitor, Phase};

use crate::streams::{Noise, settings, watching};

/// Ten minutes at 1 kHz: judging a row takes no memory at all.
#[test]
fn a_row_that_is_judged_allocates_nothing() {
    let mut noise = Noise::new(1, 0.0);
    let mut monitor = watching(settings(1), &mut noise);
    let held = monitor.numbers_held();
    let used = allocation_counter::measure(|| {
        for row in 0..600_000 {
            let _ = monitor.push(f64::from(row), &[noise.next()]);
        }
    });
    assert_eq!(used.count_total, 0);
    assert_eq!(monitor.numbers_held(), held);
    assert!(monitor.blocks_judged() > 5000, "the ring has gone round");
}

/// A walk is never independent from block to block: the reference waits, in bounded memory.
#[test]
fn a_reference_that_never_settles_stays_bounded() {
    let mut noise = Noise::new(2, 0.0);
    let mut monitor = Monitor::new(settings(1)).unwrap();
    let mut walk = 0.0;
    let mut most = 0;
    for row in 0..200_000 {
        walk += noise.next();
        assert_ne!(
            monitor.push(f64::from(row), &[walk]).unwrap(),
            Some(Event::Referenced)
        );
        most = most.max(monitor.numbers_held());
    }
    assert_eq!(monitor.phase(), Phase::Reference);
    // 4096 blocks with two features, a mark of two numbers, and a median with two more
    assert!(most < 53_000, "{most}");
}
