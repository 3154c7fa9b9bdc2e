//! Which readings are none, and what is said of them.

use haptical_judge::Check;

use super::*;
use crate::answer::{ChannelGap, Floor, Gap, Provenance};
use crate::noise::NoiseSource;

/// Torque of a joint in motion with noise of 0.02, made up without a generator of its own.
fn torque(rows: usize) -> Vec<f64> {
    let noise = |row: usize| 0.02 * (7.0 * (row as f64).powi(2)).sin();
    let of = |row: usize| 3.0 * (0.02 * row as f64).cos() + noise(row);
    (0..rows).map(of).collect()
}

fn found(column: &[f64]) -> (Vec<f64>, Vec<Dropouts>) {
    let angles: Vec<f64> = (0..column.len()).map(|row| 0.01 * row as f64).collect();
    found_at(column, &angles)
}

fn found_at(column: &[f64], angles: &[f64]) -> (Vec<f64>, Vec<Dropouts>) {
    let rows = 0..column.len();
    let read = Some(column.to_vec());
    let found = taken_out(Some(&read), &[rows], Some(angles), ("torque1", Some(0)));
    found.unwrap_or_else(|| (column.to_vec(), Vec::new()))
}

#[test]
fn moments_at_zero_and_single_wild_torques_are_told_and_left_out() {
    let sound = torque(1200);
    let mut lost = sound.clone();
    for row in (40..1200).step_by(37) {
        lost[row] = 0.0;
        lost[row + 1] = 0.0;
    }
    let (left, dropouts) = found(&lost);
    assert_eq!(dropouts.len(), 1);
    assert_eq!(dropouts[0].kind, Kind::Value(0.0));
    // also where the torque itself is about zero
    assert_eq!(dropouts[0].rows.len(), 64);
    let is_mended = |row: &usize| (left[*row] - sound[*row]).abs() < 0.2;
    assert!(dropouts[0].rows.iter().all(is_mended));
    assert!(
        (dropouts[0].off_rms - 0.5).abs() < 0.15,
        "{}",
        dropouts[0].off_rms
    );

    let mut wild = sound.clone();
    for row in (40..1200).step_by(61) {
        wild[row] = -wild[row];
    }
    let (_, spikes) = found(&wild);
    assert_eq!(spikes.len(), 1);
    assert!(spikes[0].kind == Kind::Wild && spikes[0].rows.len() > 12);
    assert!(spikes[0].rows.iter().all(|row| row % 61 == 40));
}

/// Where friction changes sides at the top of a wave, one reading may lie alone.
#[test]
fn a_corner_of_a_torque_without_noise_is_no_wild_reading() {
    let corners = |size: f64| {
        let mut column: Vec<f64> = (0..1200)
            .map(|row| 3.0 * (0.02 * f64::from(row)).cos())
            .collect();
        for row in (40..1200).step_by(61) {
            column[row] += size;
        }
        found(&column).1.len()
    };
    assert_eq!(corners(0.1), 0);
    assert_eq!(corners(1.0), 1);
}

/// At 100 rows a second friction steps from one reading to the next, on a torque that goes up to the step and on behind it.
#[test]
fn friction_that_changes_sides_is_no_wild_reading() {
    let friction = |row: usize| {
        let phase = 0.1 * row as f64;
        let noise = 0.02 * (7.0 * (row as f64).powi(2)).sin();
        2.0 * phase.sin() - 0.8 * (phase + 0.3).sin().signum() + noise
    };
    let stepping: Vec<f64> = (0..4000).map(friction).collect();
    assert!(found(&stepping).1.is_empty());
}

/// A gear with play knocks where its load changes sides, or where the joint turns round.
#[test]
fn knocks_are_no_wild_readings() {
    let load = |row: usize| 3.0 * (0.02 * row as f64).cos();
    let at = |is_knock: fn(f64, f64) -> bool| {
        let mut column = torque(3000);
        let rows = (1..3000).filter(|row| is_knock(load(row - 1), load(*row)));
        let rows: Vec<usize> = rows.collect();
        rows.iter().for_each(|row| column[*row] += 2.0);
        let turned = |sum: &mut f64, row: usize| {
            *sum += load(row + 20).abs();
            Some(*sum)
        };
        let angles: Vec<f64> = (0..3000).scan(0.0, turned).collect();
        found_at(&column, &angles).1.len()
    };
    assert_eq!(at(|before, now| before * now <= 0.0), 0);
    assert_eq!(at(|before, now| (before > 2.0) != (now > 2.0)), 1);
}

#[test]
fn each_channel_with_dropouts_has_its_gap_and_no_other() {
    let device = Device::from_toml("[[joint]]\n", "device.toml")
        .unwrap()
        .device;
    let channel = |number: usize| {
        let channel = Channel::Output { joint: number };
        let floor = Floor::new(channel, 0.02, 1000.0, NoiseSource::Motion);
        let name = format!("torque{}", number + 1);
        ChannelGap::fitted(name, Some(number), [0.019; 2], &floor, "N m")
    };
    let gap = Gap::new(Verdict::NoGap, None, (0..3).map(channel).collect());
    let clear = Diagnosis::of_causes(
        Verdict::NoGap,
        gap,
        Vec::new(),
        device,
        Provenance::default(),
    );
    let lost = |joint: usize, rows: usize| Dropouts {
        channel: format!("torque{}", joint + 1),
        joint: Some(joint),
        rows: (0..rows).collect(),
        readings: 64,
        kind: Kind::Value(0.0),
        off_rms: 0.5,
    };
    let dropouts = [lost(0, 4), lost(2, 12)];
    let mut found = clear.clone();
    name_dropouts(&dropouts, &mut found);
    assert_eq!((found.verdict, found.causes.len()), (Verdict::Named, 2));
    let gaps = found
        .gap
        .channels
        .iter()
        .map(|gap| (gap.has_gap, gap.share_of_gap));
    assert_eq!(
        gaps.collect::<Vec<_>>(),
        [(true, 0.25), (false, 0.0), (true, 0.75)]
    );
    assert_eq!(found.place.unwrap().channel, "torque3");

    // an answer that is not admitted stays what it is
    let mut barred = clear;
    barred.admission.enough = Check::no("2 s", "record 10 s");
    name_dropouts(&dropouts, &mut barred);
    assert_eq!(barred.verdict, Verdict::NoGap);
    assert!(barred.gap.channels.iter().all(|gap| !gap.has_gap));
}

#[test]
fn steps_limits_and_rests_are_no_dropouts() {
    let sound = torque(1200);
    assert_eq!(found(&sound).1, []);
    // friction that changes sides, a drive at its limit, a joint that rests
    let friction = |(row, item): (usize, &f64)| item + if row / 100 % 2 == 0 { 1.0 } else { -1.0 };
    let reversing: Vec<f64> = sound.iter().enumerate().map(friction).collect();
    assert_eq!(found(&reversing).1, []);
    let limited: Vec<f64> = sound.iter().map(|item| item.clamp(-2.0, 2.0)).collect();
    assert_eq!(found(&limited).1, []);
    let resting = sound.iter().enumerate();
    let resting: Vec<f64> = resting
        .map(|(row, item)| if row / 100 % 3 == 0 { 0.0 } else { *item })
        .collect();
    assert_eq!(found(&resting).1, []);
}

/// Up to four in a row, among them small ones where the torque is about zero.
#[test]
fn signs_that_flip_for_moments_are_wild_to_the_last() {
    let sound = torque(3000);
    let mut flipped = sound.clone();
    for row in (40..2950).step_by(61) {
        for row in row..row + 1 + row % 4 {
            flipped[row] = -flipped[row];
        }
    }
    // two moments with one reading between them
    for row in [500, 501, 502, 504, 505, 506] {
        flipped[row] = -sound[row];
    }
    let (left, dropouts) = found(&flipped);
    assert_eq!((dropouts.len(), dropouts[0].kind), (1, Kind::Wild));
    let off = left
        .iter()
        .zip(&sound)
        .map(|(left, sound)| (left - sound).abs());
    let most = off.fold(0.0, f64::max);
    // of up to 6
    assert!(most < 0.4, "{most}");
}

#[test]
fn torques_that_are_held_are_told_where_the_joint_moves() {
    let mut held = torque(2000);
    for row in (40..2000).step_by(23) {
        held[row] = held[row - 1];
    }
    let (_, dropouts) = found(&held);
    assert_eq!((dropouts.len(), dropouts[0].kind), (1, Kind::Held));
    assert!(dropouts[0].rows.iter().all(|row| row % 23 == 17));
    // at rest, or in steps as coarse as the noise, the same reading twice says nothing
    assert_eq!(found_at(&held, &[0.3; 2000]).1, []);
    let steps: Vec<f64> = torque(2000)
        .iter()
        .map(|t| (t / 0.05).round() * 0.05)
        .collect();
    assert_eq!(found(&steps).1, []);
}

/// A current sensor that reads nothing below a size does so where the torque is small, and nowhere else.
#[test]
fn a_dead_band_is_no_dropout() {
    let sound = torque(3000).into_iter();
    let dead: Vec<f64> = sound.map(|t| if t.abs() < 0.4 { 0.0 } else { t }).collect();
    assert_eq!(found(&dead).1, []);
}

/// Three knocks after which the arm rings, as a heavy robot's does where its brakes open.
#[test]
fn ringing_is_no_wild_reading() {
    let mut ringing = torque(2500);
    for first in [686, 1247, 1842] {
        for row in 0..40 {
            let time = row as f64;
            ringing[first + row] += 30.0 * (-0.08 * time).exp() * (0.52 * time).sin();
        }
    }
    assert_eq!(found(&ringing).1, []);
}
