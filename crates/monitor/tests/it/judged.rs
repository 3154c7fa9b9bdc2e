//! What is an alarm, and what is none.

use haptical_monitor::{Event, Monitor, MonitorError, Phase, Settings, Shape};

use crate::streams::{Noise, settings, watching};

/// Rows until an alarm; none within `most`.
fn rows_until_alarm(
    monitor: &mut Monitor,
    most: usize,
    mut row: impl FnMut(usize) -> f64,
) -> Option<usize> {
    (0..most).find(|&k| monitor.push(k as f64, &[row(k)]).unwrap() == Some(Event::Alarm))
}

/// In 25 hours each a false alarm has a probability of at most 1/4 by the stated rate: of 24 streams seven or more are alarms
/// with a probability of 0.4 at worst, twelve with 0.004. Blocks that forget the memory alarm in all.
#[test]
fn false_alarms_are_as_rare_as_stated() {
    let mut alarms = 0;
    for seed in 0..24 {
        let mut noise = Noise::new(seed, 0.8);
        let mut monitor = watching(settings(1), &mut noise);
        let found = rows_until_alarm(&mut monitor, 90_000, |_| noise.next());
        alarms += usize::from(found.is_some());
    }
    assert!(alarms <= 6, "{alarms} alarms");
}

#[test]
fn a_mean_that_moves_and_a_size_that_grows_are_alarms() {
    for (shift, factor) in [(1.0, 1.0), (-1.0, 1.0), (0.0, 2.0)] {
        let mut noise = Noise::new(5, 0.0);
        let mut monitor = watching(settings(1), &mut noise);
        let calm = rows_until_alarm(&mut monitor, 4000, |_| noise.next());
        assert_eq!(calm, None);
        let found = rows_until_alarm(&mut monitor, 4000, |_| factor * noise.next() + shift);
        let rows = found.unwrap_or_else(|| panic!("{shift}, {factor}: no alarm"));
        assert!(rows < 200, "{rows}");
        assert_eq!(monitor.phase(), Phase::Alarmed);
        // a few blocks say little of how far
        for row in 0..800 {
            monitor
                .push(f64::from(row), &[factor * noise.next() + shift])
                .unwrap();
        }
        let (change, _, _) = monitor.change(0.0).unwrap();
        let shifts = monitor.shifts(change.first);
        let moved = shifts[0].mean_since - shifts[0].mean_before;
        assert!(
            (moved - shift).abs() < 1.5 * shifts[0].half_width,
            "{moved}"
        );
        let grown = shifts[0].rms_since / shifts[0].rms_before;
        assert!(factor == 1.0 || grown > 1.6, "{grown}");
    }
}

#[test]
fn the_change_is_placed_and_its_shape_told() {
    for (shape, seed) in [(Shape::Step, 3), (Shape::Ramp, 4)] {
        let mut noise = Noise::new(seed, 0.0);
        let mut monitor = watching(settings(1), &mut noise);
        let start = 8000;
        let found = rows_until_alarm(&mut monitor, 60_000, |row| {
            let since = row.saturating_sub(start) as f64;
            noise.next()
                + match shape {
                    Shape::Step => f64::from(u8::from(row >= start)),
                    Shape::Ramp => since / 5000.0,
                }
        });
        // more rows tell more
        let alarm = found.unwrap();
        for row in alarm + 1..alarm + 2000 {
            let since = (row - start) as f64;
            let moved = if shape == Shape::Step {
                1.0
            } else {
                since / 5000.0
            };
            monitor.push(row as f64, &[noise.next() + moved]).unwrap();
        }
        let (change, [from, first, to], _) = monitor.change(0.0).unwrap();
        assert_eq!(change.shape, shape);
        assert!(from <= 8000.0 && 8000.0 <= to, "{from} {to}");
        assert!(
            (first - 8000.0).abs() < if shape == Shape::Step { 50.0 } else { 1200.0 },
            "{first}"
        );
        assert!(!change.may_be_older);
        // what may have hidden for a minute began up to a minute earlier, and not before the first row that was judged
        let (_, [hidden, _, end], _) = monitor.change(60.0).unwrap();
        assert_eq!([hidden, end], [from - 60.0, to]);
        let (_, [oldest, ..], _) = monitor.change(1e9).unwrap();
        assert!((0.0..4000.0).contains(&oldest), "{oldest}");
    }
}

/// Noise with a memory, behind references of an hour, and a change that follows the posture or is the same at each: the interval holds the
/// instant on nine of ten days. Blocks taken for independent beside a reference taken for exact hold it on 79 to 90 %.
#[test]
fn the_interval_holds_a_change_in_noise_with_a_memory() {
    let start = 10_000_u32;
    for (memory, follows) in [(0.9, true), (0.98, false), (0.98, true)] {
        let mut places = Vec::new();
        for seed in 0..80 {
            let mut noise = Noise::new(seed, memory);
            let hour = Settings {
                reference_rows: 3600,
                ..settings(1)
            };
            let mut monitor = watching(hour, &mut noise);
            let begins = 1e3 * seed as f64;
            let alarm = rows_until_alarm(&mut monitor, 40_000, |row| {
                let course = [0.0613, 0.0177].map(|rate| (rate * (begins + row as f64)).sin());
                let size = if follows { course.iter().sum() } else { 1.0 };
                noise.next() + if row < start as usize { 0.0 } else { size }
            });
            if alarm.is_some_and(|row| row >= start as usize) {
                // half of the longer swing: for so long a change may be small
                let hidden = if follows { 180.0 } else { 0.0 };
                let (_, [from, _, to], _) = monitor.change(hidden).unwrap();
                places.push((from..=to).contains(&f64::from(start)));
            }
        }
        let held = places.iter().filter(|holds| **holds).count();
        assert!(places.len() > 60, "{memory}: {} alarms", places.len());
        let share = held as f64 / places.len() as f64;
        assert!(share >= 0.9, "{memory} {follows}: {share}");
    }
}

/// Readings count as 8 standard deviations at most; how far they moved is told all the same, also by how much in a pose or another.
#[test]
fn a_large_shift_is_told_with_its_size() {
    for (size, swing) in [(50.0, 0.0), (-300.0, 0.0), (20.0, 30.0)] {
        let mut noise = Noise::new(13, 0.0);
        let mut monitor = watching(settings(1), &mut noise);
        for row in 0..2000 {
            // by the posture of long moves
            let moved = size + swing * (f64::from(row) / 150.0).sin();
            monitor
                .push(f64::from(row), &[noise.next() + moved])
                .unwrap();
        }
        assert_eq!(monitor.phase(), Phase::Alarmed);
        let (change, _, _) = monitor.change(0.0).unwrap();
        let shift = monitor.shifts(monitor.whole_since(&change).0)[0];
        let moved = shift.mean_since - shift.mean_before;
        assert!((moved - size).abs() < 1.5 * shift.half_width, "{shift:?}");
        assert!((moved - size).abs() < 0.2 * size.abs(), "{shift:?}");
        assert!(shift.rms_since > 0.9 * size.abs(), "{shift:?}");
        // the last turn of the swing, whatever the length of a block
        let turn = (150.0 * std::f64::consts::TAU).round() as usize;
        let blocks = turn / monitor.reference().unwrap().block_rows;
        let state = monitor.state(0, blocks).unwrap();
        assert!(
            (state.shift - size).abs() < 0.3 * size.abs().max(swing),
            "{state:?}"
        );
    }
}

/// An alarm at the first block, of which only a part is another: the interval of the shift and that of the time hold the truth.
#[test]
fn the_first_alarm_says_no_more_than_it_knows() {
    for seed in 20..40 {
        let mut noise = Noise::new(seed, 0.0);
        let mut monitor = watching(settings(1), &mut noise);
        let start = 300 + 3 * seed;
        let alarm = rows_until_alarm(&mut monitor, 4000, |row| {
            noise.next() + if row as u64 >= start { 30.0 } else { 0.0 }
        });
        let (change, [from, _, to], _) = monitor.change(0.0).unwrap();
        let shift = monitor.shifts(monitor.whole_since(&change).0)[0];
        let moved = shift.mean_since - shift.mean_before;
        assert!(
            (moved - 30.0).abs() < shift.half_width + 4.0,
            "{alarm:?} {shift:?}"
        );
        assert!(
            from <= start as f64 && start as f64 <= to,
            "{start}: {from} {to}"
        );
    }
}

#[test]
fn wild_readings_and_gaps_are_no_alarm() {
    let mut noise = Noise::new(8, 0.0);
    let mut monitor = watching(settings(1), &mut noise);
    let found = rows_until_alarm(&mut monitor, 20_000, |row| match row % 2000 {
        0 => 1e6,
        1..=900 => f64::NAN,
        _ => noise.next(),
    });
    assert_eq!(found, None);
    assert_eq!(monitor.clipped(), 10);
}

#[test]
fn a_shift_within_the_tolerance_does_not_count() {
    let run = |tolerance: f64, shift: f64| {
        let mut noise = Noise::new(9, 0.0);
        let own = Settings {
            tolerances: vec![tolerance],
            ..settings(1)
        };
        let mut monitor = watching(own, &mut noise);
        rows_until_alarm(&mut monitor, 20_000, |_| noise.next() + shift).is_some()
    };
    assert!(run(0.0, 0.5) && run(0.5, 1.0));
    assert!(!run(0.5, 0.5) && !run(0.5, -0.5));
}

/// A position whose third axis is never read is judged by the two others.
#[test]
fn a_component_without_readings_is_left_aside() {
    let mut noise = Noise::new(10, 0.0);
    let mut monitor = Monitor::new(settings(3)).unwrap();
    monitor.set_rows_between_false_alarms(3.6e5).unwrap();
    let mut alarm = false;
    for row in 0..8000_i32 {
        let moved = if row < 5000 { 0.0 } else { 2.0 };
        let values = [noise.next(), noise.next() + moved, f64::NAN];
        alarm |= monitor.push(f64::from(row), &values).unwrap() == Some(Event::Alarm);
        assert!(!alarm || row >= 5000);
    }
    assert!(alarm);
    assert_eq!(monitor.shifts(0)[0].component, 1);
    assert!(monitor.shifts(0)[0].share > 0.99);
    assert!(monitor.state(2, 8).is_none());
}

#[test]
fn a_sensor_that_stood_still_may_read_another_count() {
    let mut monitor = Monitor::new(Settings {
        floors: vec![1.0],
        ..settings(1)
    })
    .unwrap();
    monitor.set_rows_between_false_alarms(3.6e5).unwrap();
    let found = rows_until_alarm(
        &mut monitor,
        20_000,
        |row| if row < 8000 { 0.0 } else { 0.6 },
    );
    assert_eq!((found, monitor.phase()), (None, Phase::Watching));
}

#[test]
fn settings_and_rows_out_of_range_are_refused() {
    let bad = [
        Settings {
            floors: vec![],
            tolerances: vec![],
            ..settings(1)
        },
        Settings {
            tolerances: vec![],
            ..settings(1)
        },
        Settings {
            floors: vec![f64::NAN],
            ..settings(1)
        },
        Settings {
            tolerances: vec![-1.0],
            ..settings(1)
        },
        Settings {
            miss: 0.0,
            ..settings(1)
        },
    ];
    for own in bad {
        assert!(matches!(
            Monitor::new(own),
            Err(MonitorError::OutOfRange { .. })
        ));
    }
    let mut monitor = Monitor::new(settings(2)).unwrap();
    assert!(monitor.set_rows_between_false_alarms(0.0).is_err());
    let refused = monitor.push(0.0, &[1.0]).unwrap_err();
    assert_eq!(refused, MonitorError::Width { got: 1, wanted: 2 });
}

/// Noise of standard deviation 1 at 1 kHz, and an error that follows the posture: it stays alike for seconds, far longer than any
/// block of a few rows, and within the tolerance.
fn following(seed: u64, size: f64) -> impl FnMut() -> f64 {
    let (mut noise, mut posture) = (Noise::new(seed, 0.0), Noise::new(seed + 1000, 0.9995));
    move || noise.next() + size * posture.next().clamp(-2.0, 2.0)
}

/// Blocks of 8 rows are hardly correlated with their neighbours, but with hundreds of blocks together: taken for independent they are false
/// alarms, asked for independence beyond the tolerance there is never a reference.
#[test]
fn an_error_that_follows_the_posture_is_no_alarm_at_any_rate_of_rows() {
    let mut alarms = 0;
    for seed in 0..8 {
        let mut next = following(seed, 0.05);
        let own = Settings {
            tolerances: vec![0.1],
            reference_rows: 300_000,
            ..settings(1)
        };
        let mut monitor = Monitor::new(own).unwrap();
        // one in a thousand hours at 1 kHz
        monitor.set_rows_between_false_alarms(3.6e9).unwrap();
        let mut is_alarmed = false;
        for row in 0..1_200_000_u32 {
            is_alarmed |= monitor.push(f64::from(row), &[next()]).unwrap() == Some(Event::Alarm);
        }
        assert_ne!(monitor.phase(), Phase::Reference, "{seed}: no reference");
        alarms += usize::from(is_alarmed);
        // what is beyond the tolerance is an alarm within seconds
        let moved = rows_until_alarm(&mut monitor, 20_000, |_| next() + 0.5);
        assert!(is_alarmed || moved.is_some(), "{seed}: a shift is not seen");
    }
    assert_eq!(alarms, 0);
}

/// Rows of five components, each with an error that follows the posture for about `memory` rows, as large as the noise of blocks that long.
fn five_following(seed: u64, memory: f64) -> impl FnMut(f64) -> Vec<f64> {
    let each = |k: u64| {
        let posture = Noise::new(5 * seed + k + 1000, 1.0 - memory.recip());
        (Noise::new(5 * seed + k, 0.0), posture)
    };
    let mut streams: Vec<(Noise, Noise)> = (0..5).map(each).collect();
    let size = memory.sqrt().recip();
    move |shift| {
        let own = streams.iter_mut();
        let mut row: Vec<f64> = own
            .map(|(noise, posture)| noise.next() + size * posture.next())
            .collect();
        row[3] += shift;
        row
    }
}

/// Ten minutes at 10 Hz, 100 Hz and 1 kHz of an arm whose postures stay alike for two thirds of a second: no block is as good as independent
/// of its neighbours in all ten features, and each is a reference, to the row that was asked for.
#[test]
fn ten_minutes_are_a_reference_at_any_rate_of_rows() {
    for (rate_hz, seeds) in [(10_u32, 0..6), (100, 0..6), (1000, 0..2)] {
        let (rows, memory) = (600 * rate_hz, f64::from(rate_hz) / 1.5);
        for seed in seeds {
            let mut next = five_following(seed, memory);
            let mut monitor = Monitor::new(Settings {
                reference_rows: rows as usize,
                ..settings(5)
            })
            .unwrap();
            monitor.hold_reference();
            monitor
                .set_rows_between_false_alarms(3.6e6 * f64::from(rate_hz))
                .unwrap();
            for row in 0..rows {
                monitor.push(f64::from(row), &next(0.0)).unwrap();
            }
            let found = monitor.end_reference().unwrap();
            assert_eq!(found, Some(Event::Referenced), "{rate_hz} Hz, {seed}");
            let block_s = monitor.reference().unwrap().block_rows as f64 / f64::from(rate_hz);
            assert!(block_s < 10.0, "{rate_hz} Hz, {seed}: {block_s} s");
            for row in 0..rows {
                let event = monitor.push(f64::from(row), &next(0.0)).unwrap();
                assert_ne!(event, Some(Event::Alarm), "{rate_hz} Hz, {seed}");
            }
            // three times as large as the error that follows the posture
            let shift = 3.0 / memory.sqrt();
            let seen =
                (0..rows).find(|_| monitor.push(0.0, &next(shift)).unwrap() == Some(Event::Alarm));
            assert!(seen.is_some_and(|row| row < 60 * rate_hz), "{seen:?}");
            assert_eq!(monitor.shifts(0)[0].component, 3);
        }
    }
}

/// What is refused says how many rows are needed, about: who records as many as are said has a reference soon, and not a longer one than
/// ten times what the noise takes.
#[test]
fn a_refused_reference_says_how_long_it_must_be() {
    for seed in 0..12 {
        let mut rows = 2000;
        let mut refusals = 0;
        loop {
            let mut noise = Noise::new(seed + 100 * refusals, 0.98);
            let mut monitor = Monitor::new(settings(1)).unwrap();
            monitor.hold_reference();
            for row in 0..rows {
                monitor.push(row as f64, &[noise.next()]).unwrap();
            }
            if monitor.end_reference().unwrap().is_some() {
                break;
            }
            refusals += 1;
            assert!(refusals < 4, "{seed}: {rows}");
            assert!(monitor.is_refused() && monitor.wanted_reference_rows() > rows);
            rows = monitor.wanted_reference_rows();
        }
        assert!(refusals > 0 && rows < 10 * 8192, "{seed}: {rows}");
    }
}

/// A joint that turns back shows one error of rounding for many rows: most blocks know nothing of it, a few are all of it. Blocks
/// must be so long that the reference itself is no alarm.
#[test]
fn readings_that_stay_alike_for_a_while_make_longer_blocks() {
    let mut alarms = 0;
    for seed in 30..42 {
        let mut noise = Noise::new(seed, 0.0);
        let (mut row, mut held) = (0_u64, 0.0);
        // uniform, held for 24 rows of each 2000
        let mut next = move || {
            row += 1;
            let fresh = (12_345.678 * noise.next()).rem_euclid(2.0) - 1.0;
            if row % 2000 == 1 {
                held = fresh;
            }
            if (1..=24).contains(&(row % 2000)) {
                held
            } else {
                fresh
            }
        };
        let own = Settings {
            reference_rows: 60_000,
            ..settings(1)
        };
        let mut monitor = Monitor::new(own).unwrap();
        monitor.set_rows_between_false_alarms(3.6e7).unwrap();
        let mut is_alarmed = false;
        for row in 0..400_000_u32 {
            is_alarmed |= monitor.push(f64::from(row), &[next()]).unwrap() == Some(Event::Alarm);
        }
        assert_ne!(monitor.phase(), Phase::Reference, "{seed}: no reference");
        alarms += usize::from(is_alarmed);
    }
    // one in 100 hours of 100 rows a second is stated; each stream has less than one
    assert_eq!(alarms, 0);
}

/// A channel that is read at every twentieth row is judged as one that is read at each.
#[test]
fn a_channel_that_is_read_seldom_is_judged() {
    let mut noise = Noise::new(14, 0.0);
    let mut monitor = Monitor::new(Settings {
        reference_rows: 20_000,
        ..settings(2)
    })
    .unwrap();
    monitor.set_rows_between_false_alarms(3.6e6).unwrap();
    let mut found = None;
    for row in 0..80_000_u32 {
        let moved = if row < 60_000 { 0.0 } else { 2.0 };
        let seldom = if row % 20 == 0 {
            noise.next() + moved
        } else {
            f64::NAN
        };
        if monitor
            .push(f64::from(row), &[noise.next(), seldom])
            .unwrap()
            == Some(Event::Alarm)
        {
            found = Some(row);
        }
    }
    assert!(
        found.is_some_and(|row| (60_000..64_000).contains(&row)),
        "{found:?}"
    );
    assert_eq!(monitor.shifts(0)[0].component, 1);
}

#[test]
fn blocks_without_a_reading_are_not_judged() {
    let mut noise = Noise::new(15, 0.0);
    let mut monitor = watching(settings(1), &mut noise);
    for row in 0..5000 {
        monitor.push(f64::from(row), &[f64::NAN]).unwrap();
    }
    assert_eq!(monitor.blocks_judged(), 0);
    for row in 0..5000 {
        monitor.push(f64::from(row), &[noise.next()]).unwrap();
    }
    assert!(monitor.blocks_judged() > 0);
}
