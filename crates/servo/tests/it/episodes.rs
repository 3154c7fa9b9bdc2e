//! Faults of a recording of many episodes: simulated servos that stick, droop and read in counts, sound and with each fault.

use std::ops::Range;

use haptical_servo::{
    EpisodeFinding, EpisodeLog, EpisodeReport, Fault, JointColumns, RowFaultKind, Side, Use,
    examine_episodes,
};

use crate::servo::{Log, Servo, motion};

const EPISODES: usize = 14;
const EPISODE_S: f64 = 9.0;

/// A recording of two joints.
struct Recording {
    time_s: Vec<f64>,
    position: [Vec<f64>; 2],
    command: [Vec<f64>; 2],
    episodes: Vec<Range<usize>>,
}

fn servo(seed: u64) -> Servo {
    Servo {
        rad_per_s: Some(25.0 + (seed % 4) as f64),
        damping: 0.7 + 0.1 * (seed % 5) as f64,
        friction_rad: 0.002 * (seed % 8) as f64,
        droop_rad: 0.01 * (seed % 3) as f64,
        delay_s: 0.02,
        ..Servo::default()
    }
}

impl Recording {
    /// Both joints' servos may differ from episode to episode.
    fn new(seed: u64, of: impl Fn(usize, usize) -> Servo) -> Self {
        let mut all = Self {
            time_s: Vec::new(),
            position: Default::default(),
            command: Default::default(),
            episodes: Vec::new(),
        };
        for episode in 0..EPISODES {
            let logs: [Log; 2] = std::array::from_fn(|joint| {
                let motion = motion(1000 * seed + 10 * episode as u64 + joint as u64);
                of(episode, joint).log(&|time_s| motion(time_s) + 0.4 * joint as f64, EPISODE_S)
            });
            let start = all.time_s.len();
            all.time_s.extend(&logs[0].time_s);
            all.episodes.push(start..all.time_s.len());
            for (joint, log) in logs.into_iter().enumerate() {
                all.position[joint].extend(log.response);
                all.command[joint].extend(log.command);
            }
        }
        all
    }

    fn sound(seed: u64) -> Self {
        Self::new(seed, |_, joint| servo(seed + joint as u64))
    }

    /// The first joint's servo is another one from an episode on.
    fn changed(seed: u64, since: usize, change: impl Fn(&mut Servo)) -> Self {
        Self::new(seed, |episode, joint| {
            let mut own = servo(seed + joint as u64);
            if joint == 0 && episode >= since {
                change(&mut own);
            }
            own
        })
    }

    fn examined(&self) -> EpisodeReport {
        self.examined_as(&[])
    }

    fn examined_as(&self, described_rows: &[usize]) -> EpisodeReport {
        let joints: Vec<JointColumns<'_>> = (self.position.iter().zip(&self.command))
            .map(|(position, command)| JointColumns {
                position,
                command: Some(command),
            })
            .collect();
        examine_episodes(&EpisodeLog {
            time_s: &self.time_s,
            episodes: &self.episodes,
            joints: &joints,
            described_rows,
            least_offset: 1.5_f64.to_radians(),
        })
    }
}

/// The only finding of the first joint; the second has none.
fn only(report: &EpisodeReport) -> &EpisodeFinding {
    let [first, second] = &report.joints[..] else {
        panic!("two joints")
    };
    assert!(second.findings.is_empty(), "{:?}", second.findings);
    assert_eq!(first.findings.len(), 1, "{:?}", first.findings);
    &first.findings[0]
}

#[test]
fn sound_recordings_have_no_finding() {
    for seed in 0..40 {
        let report = Recording::sound(seed).examined();
        let found: Vec<_> = report
            .joints
            .iter()
            .flat_map(|joint| &joint.findings)
            .collect();
        assert!(report.is_sound(), "{seed}: {found:?} {:?}", report.rows);
        assert!(
            report
                .episodes
                .iter()
                .all(|episode| episode.verdict == Use::Use)
        );
    }
}

#[test]
fn an_offset_is_sized_and_placed_and_its_side_is_known() {
    for (seed, size, since) in [
        (0, 0.0524, 4),
        (1, -0.0524, 11),
        (2, 0.297, 7),
        (3, -0.297, 12),
        (4, 0.297, 1),
    ] {
        let report = Recording::changed(seed, since, |servo| servo.offset_rad += size).examined();
        let found = only(&report);
        let Fault::Offset {
            size: measured,
            sd,
            side,
        } = found.fault
        else {
            panic!("{found:?}")
        };
        assert!(
            (measured - size).abs() < 0.01 && sd < 0.01,
            "{seed}: {measured} +- {sd}"
        );
        assert_eq!(
            (found.since, found.until),
            (since, None),
            "{seed}: {found:?} {:?}",
            report.joints[0].levels
        );
        assert!(found.probability > 0.95);
        // motions scatter by tenths of a radian: only a large offset shows which column moved
        assert_ne!(side, Some(Side::Command));
        // one episode without it at the beginning does not make all others wrong
        let verdict = if since < 3 { Use::Look } else { Use::LeaveOut };
        assert_eq!(report.episodes[since].verdict, verdict);
        assert_eq!(report.episodes[since - 1].verdict, Use::Use);
    }
}

#[test]
fn an_offset_that_ends_says_when() {
    let between = |episode: usize| (5..9).contains(&episode);
    let recording = Recording::new(7, |episode, joint| {
        let mut own = servo(joint as u64);
        own.offset_rad = if joint == 0 && between(episode) {
            0.1
        } else {
            0.0
        };
        own
    });
    let report = recording.examined();
    let found = only(&report);
    assert_eq!((found.since, found.until), (5, Some(8)), "{found:?}");
    let verdicts: Vec<bool> = report
        .episodes
        .iter()
        .map(|episode| episode.verdict == Use::LeaveOut)
        .collect();
    assert_eq!(verdicts, (0..EPISODES).map(between).collect::<Vec<_>>());
}

#[test]
fn gains_and_delays_are_told_from_offsets() {
    for (seed, gain) in [(0, 1.5), (1, 4.0), (2, 0.5)] {
        let report = Recording::changed(seed, 6, |servo| servo.gain = gain).examined();
        let found = only(&report);
        let Fault::Gain { factor, sd } = found.fault else {
            panic!("{found:?}")
        };
        assert!(
            (factor / gain - 1.0).abs() < 0.05 && sd < 0.1 * gain,
            "{factor} +- {sd}"
        );
        assert_eq!(found.since, 6);
    }
    for (seed, delay_s) in [(3, 0.04), (4, 0.02), (5, 0.06)] {
        let report = Recording::changed(seed, 8, |servo| servo.delay_s += delay_s).examined();
        assert_eq!(report.joints[0].findings.len(), 1, "{seed}");
        let found = only(&report);
        let Fault::Latency {
            delay_s: measured,
            sd_s,
        } = found.fault
        else {
            panic!("{found:?}")
        };
        assert!(
            (measured - delay_s).abs() < 3.0 * sd_s,
            "{measured} +- {sd_s} of {delay_s}"
        );
        assert_eq!(found.since, 8);
        assert_eq!(report.episodes[8].verdict, Use::Look);
    }
}

#[test]
fn dead_swapped_and_clipped_joints_are_named() {
    let mut dead = Recording::sound(1);
    for rows in &dead.episodes[9..] {
        dead.position[0][rows.clone()].fill(0.25);
    }
    let report = dead.examined();
    assert_eq!(
        (&only(&report).fault, only(&report).since),
        (&Fault::Dead { at: 0.25 }, 9)
    );

    let mut swapped = Recording::sound(2);
    let [first, second] = &mut swapped.position;
    for rows in &swapped.episodes[3..] {
        first[rows.clone()].swap_with_slice(&mut second[rows.clone()]);
    }
    let report = swapped.examined();
    for (joint, with) in [(0, 1), (1, 0)] {
        let [found] = &report.joints[joint].findings[..] else {
            panic!("{:?}", report.joints[joint].findings)
        };
        assert_eq!(
            (&found.fault, found.since, found.until),
            (&Fault::Swapped { with }, 3, None)
        );
    }

    let mut clipped = Recording::sound(3);
    for rows in &clipped.episodes[5..] {
        clipped.position[0][rows.clone()]
            .iter_mut()
            .for_each(|value| *value = value.min(0.1));
    }
    let report = clipped.examined();
    let found = only(&report);
    assert!(
        matches!(found.fault, Fault::Clipped { at, is_upper: true, .. } if at == 0.1),
        "{found:?}"
    );
    assert_eq!(found.since, 5);
}

#[test]
fn rows_that_are_lost_or_repeated_are_counted() {
    let cut = |rows: Range<usize>, in_times: bool| {
        let mut recording = Recording::sound(5);
        let start = recording.episodes[4].start;
        let gone = start + rows.start..start + rows.end;
        for column in recording.position.iter_mut().chain(&mut recording.command) {
            column.drain(gone.clone());
        }
        let step = recording.time_s[1] - recording.time_s[0];
        recording.time_s.drain(gone.clone());
        recording.episodes[4].end -= gone.len();
        for episode in &mut recording.episodes[5..] {
            *episode = episode.start - gone.len()..episode.end - gone.len();
        }
        if !in_times {
            for (row, time) in recording.time_s[recording.episodes[4].clone()]
                .iter_mut()
                .enumerate()
            {
                *time = row as f64 * step;
            }
        }
        recording
    };
    let [whole] = [Recording::sound(5).episodes[0].len()];
    let by_times = cut(210..230, true).examined();
    let [found] = &by_times.rows[..] else {
        panic!("{:?}", by_times.rows)
    };
    assert_eq!(
        (found.kind, found.episode, found.rows, found.of),
        (RowFaultKind::Lost, 4, 20, whole)
    );
    assert!((found.first_s.unwrap() - 209.0 * 0.02).abs() < 1e-9);

    // the times were made anew: the description knows, or all columns jump
    let by_description = cut(210..230, false).examined_as(&[whole; EPISODES]);
    assert_eq!(
        (by_description.rows[0].kind, by_description.rows[0].rows),
        (RowFaultKind::Short, 20)
    );
    let jumps = (60..400).step_by(40).filter(|start| {
        let report = cut(*start..start + 20, false).examined();
        let is_it = |fault: &haptical_servo::RowFault| {
            (fault.kind, fault.episode) == (RowFaultKind::Jump, 4)
        };
        assert!(report.rows.iter().all(is_it), "{:?}", report.rows);
        !report.rows.is_empty()
    });
    // where the motion comes back to where it was nothing shows
    let found = jumps.count();
    assert!(found >= 5, "{found} of 9");

    let mut repeated = Recording::sound(6);
    let rows = repeated.episodes[2].clone();
    for start in rows.clone().skip(10).step_by(12).take(30) {
        for column in &mut repeated.position {
            let value = column[start];
            column[start..(start + 4).min(rows.end)].fill(value);
        }
    }
    let report = repeated.examined();
    let [found] = &report.rows[..] else {
        panic!("{:?}", report.rows)
    };
    assert_eq!((found.kind, found.episode), (RowFaultKind::Repeated, 2));
    assert!((40..=90).contains(&found.rows), "{}", found.rows);
}

#[test]
fn what_cannot_be_looked_for_is_said() {
    let recording = Recording::sound(0);
    let columns = |command| {
        [JointColumns {
            position: &recording.position[0],
            command,
        }]
    };
    let of = |joints: &[JointColumns<'_>], episodes: &[Range<usize>]| {
        examine_episodes(&EpisodeLog {
            time_s: &recording.time_s,
            episodes,
            joints,
            described_rows: &[],
            least_offset: 0.026,
        })
    };
    let without = of(&columns(None), &recording.episodes);
    assert!(
        without.joints[0].not_tested[0].contains("no command"),
        "{:?}",
        without.joints[0].not_tested
    );
    let few = of(
        &columns(Some(&recording.command[0])),
        &recording.episodes[..3],
    );
    assert!(
        few.joints[0].not_tested[0].contains("needs 6 episodes"),
        "{:?}",
        few.joints[0].not_tested
    );
}

/// Of a change it is not the first side that is right, but the one that is nearer to none.
#[test]
fn what_was_wrong_at_first_and_mended_is_wrong_at_first() {
    let early = |change: &dyn Fn(&mut Servo)| {
        let recording = Recording::new(3, |episode, joint| {
            let mut own_servo = servo(joint as u64);
            if joint == 0 && episode < 5 {
                change(&mut own_servo);
            }
            own_servo
        });
        recording.examined()
    };
    let offset = early(&|servo| servo.offset_rad = 0.2);
    let found = only(&offset);
    assert!(
        matches!(found.fault, Fault::Offset { size, .. } if (size - 0.2).abs() < 0.02),
        "{found:?}"
    );
    assert_eq!((found.since, found.until), (0, Some(4)));
    assert_eq!(
        (offset.episodes[4].verdict, offset.episodes[5].verdict),
        (Use::LeaveOut, Use::Use)
    );
    let gain = early(&|servo| servo.gain = 2.0);
    let found = only(&gain);
    assert!(
        matches!(found.fault, Fault::Gain { factor, .. } if (factor - 2.0).abs() < 0.1),
        "{found:?}"
    );
    assert_eq!((found.since, found.until), (0, Some(4)));
}

#[test]
fn the_answer_of_all_episodes_is_measured() {
    let of = |servo: &Servo| {
        let report = Recording::new(9, |_, _| servo.clone()).examined();
        let joint = &report.joints[0];
        joint.answer_s.unwrap()
    };
    let late_s = of(&Servo {
        delay_s: 0.06,
        ..Servo::default()
    });
    assert!((late_s - 0.06).abs() < 0.003, "{late_s}");
    // 2 zeta / omega of a loop of the second order
    let lag_s = of(&Servo {
        rad_per_s: Some(40.0),
        damping: 1.0,
        ..Servo::default()
    });
    assert!((lag_s - 0.05).abs() < 0.01, "{lag_s}");
}

/// A command that is no position of the joint is compared with nothing, and that is said.
#[test]
fn a_command_that_is_no_position_leads_to_no_finding() {
    for sign in [-1.0, 0.0] {
        let mut recording = Recording::sound(4);
        let [first, _] = &mut recording.command;
        for rows in &recording.episodes {
            let positions = first[rows.clone()].to_vec();
            for (row, value) in first[rows.clone()].iter_mut().enumerate() {
                // turned round, or a velocity
                *value = if sign < 0.0 {
                    sign * positions[row]
                } else {
                    50.0 * (positions[row] - positions[row.saturating_sub(1)])
                };
            }
        }
        let report = recording.examined();
        let joint = &report.joints[0];
        assert!(joint.findings.is_empty(), "{:?}", joint.findings);
        assert!(
            !joint.follows && !joint.not_tested.is_empty() && joint.answer_s.is_none(),
            "{sign}"
        );
    }
}
