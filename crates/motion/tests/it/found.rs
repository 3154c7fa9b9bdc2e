//! What is found on an arm of another hand's equations.

use haptical_motion::{Examined, examine};

use super::arm::{Truth, device, recording, second_recording};

fn examined(truth: Truth, seed: u64) -> Examined {
    examined_beside(truth, truth, seed)
}

/// With a second recording of the same arm to which something else was done.
fn examined_beside(truth: Truth, of_second: Truth, seed: u64) -> Examined {
    let second = second_recording(of_second, seed);
    examine(&device(), &recording(truth, seed), Some(&second), &[]).unwrap()
}

/// The one effect that explains the gap, with the interval of a number of it.
fn assert_found(truth: Truth, effect: &str, joint: Option<usize>, number: (&str, f64, f64)) {
    for seed in [1, 2] {
        let found = examined(truth, seed);
        assert!(
            found.has_gap() && found.is_adequate(),
            "{effect}: {:?}",
            found.findings
        );
        let first = &found.findings[0];
        assert_eq!(
            (first.effect, first.joint),
            (effect, joint),
            "seed {seed}: {:?}",
            found.findings
        );
        let (name, wanted, tolerance) = number;
        let (_, value, _) = first.numbers.iter().find(|own| own.0 == name).unwrap();
        assert!(
            (value - wanted).abs() < tolerance,
            "{name}: {value}, {wanted}"
        );
    }
}

#[test]
fn a_sound_arm_has_no_gap_though_its_masses_are_off() {
    for seed in 1..=5 {
        let found = examined(Truth::default(), seed);
        assert!(
            !found.has_gap(),
            "seed {seed}: {:?}",
            found
                .channels
                .iter()
                .map(|own| own.rms_before / own.noise)
                .collect::<Vec<_>>()
        );
        assert!(
            found.findings.is_empty(),
            "seed {seed}: {:?}",
            found.findings
        );
    }
}

#[test]
fn a_payload_is_named_with_its_mass() {
    let truth = Truth {
        payload_kg: 1.2,
        ..Truth::default()
    };
    assert_found(truth, "payload", None, ("mass_kg", 1.2, 0.25));
}

/// The last link has 2 kg: a load that it lacks may be a tool's that was taken off, and no more than the link.
#[test]
fn a_body_lacks_no_more_mass_than_it_has() {
    let lacking = |payload_kg: f64| {
        let truth = Truth {
            payload_kg,
            ..Truth::default()
        };
        let findings = examined(truth, 1).findings;
        findings.iter().any(|found| found.effect == "payload")
    };
    assert!(lacking(-1.2) && !lacking(-3.2));
}

/// A torque that pushes a joint away from an angle is no spring's.
#[test]
fn a_spring_has_no_stiffness_below_zero() {
    for (stiffness_nm_per_rad, is_spring) in [(6.0, true), (-6.0, false)] {
        let mut log = recording(Truth::default(), 1);
        let angles = log.joint[1].clone();
        let torque_nm = log.torque_nm[1].as_mut().unwrap();
        for (torque_nm, angle) in torque_nm.iter_mut().zip(angles) {
            *torque_nm += stiffness_nm_per_rad * (angle - 0.3);
        }
        let findings = examine(&device(), &log, None, &[]).unwrap().findings;
        let mut numbers = findings.iter().flat_map(|found| &found.numbers);
        let stiffness = numbers.find(|own| own.0 == "stiffness_nm_per_rad");
        let stiffness = stiffness.map(|own| own.1);
        assert_eq!(stiffness.is_some(), is_spring, "{stiffness:?}");
        assert!(stiffness.is_none_or(|own| (own - 6.0).abs() < 0.6));
    }
}

#[test]
fn a_delay_is_named_with_its_length() {
    let truth = Truth {
        late_s: 0.016,
        ..Truth::default()
    };
    assert_found(truth, "encoder-latency", None, ("delay_s", 0.016, 0.001));
}

#[test]
fn torques_that_are_late_are_no_early_encoders() {
    let truth = Truth {
        late_s: -0.016,
        ..Truth::default()
    };
    assert_found(truth, "torque-latency", None, ("delay_s", 0.016, 0.001));
}

#[test]
fn readings_as_the_file_states_them_leave_no_gap() {
    let truth = Truth {
        offset_nm: 5.0,
        late_s: -0.016,
        ..Truth::default()
    };
    let mut stated = device();
    stated.joints[0].torque_offset_nm = Some(truth.offset_nm);
    for joint in &mut stated.joints {
        joint.torque_delay_s = Some(-truth.late_s);
    }
    for seed in [1, 2] {
        let log = recording(truth, seed);
        assert!(examine(&device(), &log, None, &[]).unwrap().has_gap());
        let found = examine(&stated, &log, None, &[]).unwrap();
        assert!(!found.has_gap(), "seed {seed}: {:?}", found.findings);
    }
}

#[test]
fn a_sound_arm_that_rests_between_its_moves_has_no_gap() {
    let truth = Truth {
        rests: true,
        ..Truth::default()
    };
    for seed in 1..=5 {
        let found = examined(truth, seed);
        let of_noise = found.channels.iter().map(|own| own.rms_before / own.noise);
        let of_noise: Vec<f64> = of_noise.collect();
        assert!(!found.has_gap(), "seed {seed}: {of_noise:?}");
        assert!(found.findings.is_empty(), "{:?}", found.findings);
    }
    // what it carries is seen all the same
    let loaded = Truth {
        payload_kg: 1.2,
        ..truth
    };
    assert_found(loaded, "payload", None, ("mass_kg", 1.2, 0.25));
}

#[test]
fn a_scale_of_a_torque_is_named_at_its_joint() {
    let truth = Truth {
        gain: 3.0,
        ..Truth::default()
    };
    assert_found(truth, "torque-gain", Some(1), ("gain", 0.75, 0.01));
}

#[test]
fn cogging_is_named_with_its_order() {
    let truth = Truth {
        cogging_nm: 0.5,
        ..Truth::default()
    };
    assert_found(truth, "motor-cogging", Some(0), ("order", 30.0, 0.3));
}

/// Of twenty intervals one misses: of six, two in a hundred thousand miss by four standard deviations.
#[test]
fn the_interval_of_an_order_holds_it() {
    let truth = Truth {
        cogging_nm: 0.5,
        ..Truth::default()
    };
    for seed in 1..=6 {
        let found = examined(truth, seed);
        let numbers = &found.findings[0].numbers;
        let (_, value, sd) = numbers.iter().find(|own| own.0 == "order").unwrap();
        assert!(
            (value - 30.0).abs() < 4.0 * sd,
            "seed {seed}: {value} +- {sd}"
        );
        // a law that is off by 2 % turns the phase by 0.02 at one end of the travel or at the other
        let q = &recording(truth, seed).joint[0];
        let ends = q
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], q| {
                [low.min(*q), high.max(*q)]
            });
        let of_law = 0.02 * 12_f64.sqrt() / (ends[1] - ends[0]);
        assert!((1.0..1.2).contains(&(sd / of_law)), "{sd}, {of_law}");
    }
}

#[test]
fn an_effect_that_the_second_recording_does_not_have_is_refuted() {
    let truth = Truth {
        payload_kg: 1.2,
        ..Truth::default()
    };
    let found = examined_beside(truth, Truth::default(), 1);
    assert!(
        found.refuted.contains(&("payload", None)) && !found.is_adequate(),
        "{:?}, {:?}",
        found.refuted,
        found.findings
    );
    assert!(found.has_gap());
    let found = examined(truth, 1);
    assert!(
        found.refuted.is_empty() && found.is_adequate(),
        "{:?}",
        found.refuted
    );
}

#[test]
fn what_leaves_a_gap_of_the_second_recording_is_not_named() {
    let truth = Truth {
        cogging_nm: 0.5,
        ..Truth::default()
    };
    let of_second = Truth {
        dent_nm: 2.0,
        ..truth
    };
    let found = examined_beside(truth, of_second, 1);
    assert!(
        found.is_contradicted() && !found.is_adequate(),
        "{:?}",
        found.left_of_second
    );
    // a push of the second recording beside one of the first says nothing
    let pushed = Truth {
        push_n: 25.0,
        ..Truth::default()
    };
    let found = examined(pushed, 1);
    assert!(found.left_of_second.is_none() && found.is_adequate());
    // a gap that no push explains does
    let dent = Truth {
        dent_nm: 2.0,
        ..Truth::default()
    };
    assert!(!examined_beside(pushed, dent, 1).is_adequate());
}

#[test]
fn a_weight_is_known_no_better_than_the_bodies_that_measure_it() {
    let truth = Truth {
        payload_kg: 6.0,
        ..Truth::default()
    };
    let found = examined(truth, 1);
    assert_eq!(found.findings[0].effect, "payload");
    let (_, value, sd) = found.findings[0].numbers[0];
    assert!(sd > 0.05 * value, "{value} +- {sd}");
    assert!((value - 6.0).abs() < 2.0 * sd, "{value} +- {sd}");
}

#[test]
fn armatures_that_are_off_together_are_found_beside_a_payload() {
    for payload_kg in [0.0, 1.2] {
        let truth = Truth {
            payload_kg,
            armatures: 0.4,
            ..Truth::default()
        };
        let found = examined(truth, 1);
        assert!(found.is_adequate(), "{:?}", found.findings);
        let places = found.findings.iter().map(|own| (own.effect, own.joint));
        let mut places: Vec<_> = places.collect();
        places.sort_unstable();
        let mut wanted = vec![("armature", Some(0)), ("armature", Some(1))];
        wanted.extend((payload_kg > 0.0).then_some(("payload", None)));
        assert_eq!(places, wanted);
        for own in &found.findings {
            let wanted = match (own.effect, own.joint) {
                ("payload", _) => payload_kg,
                (_, Some(0)) => 0.3 * truth.armatures,
                _ => 0.1 * truth.armatures,
            };
            let (name, value, sd) = own.numbers[0];
            assert!((value - wanted).abs() < 2.5 * sd, "{name}: {value} +- {sd}");
        }
    }
}

#[test]
fn the_phase_of_cogging_is_that_of_a_cosine() {
    let truth = Truth {
        cogging_nm: 0.5,
        ..Truth::default()
    };
    // sin(30 q + 0.4) = cos(30 q - (pi / 2 - 0.4))
    let phase = std::f64::consts::FRAC_PI_2 - 0.4;
    assert_found(truth, "motor-cogging", Some(0), ("phase_rad", phase, 0.1));
}

#[test]
fn where_a_payload_hangs_is_told_in_the_frame_of_the_flange() {
    let truth = Truth {
        payload_kg: 1.2,
        beyond_m: 0.1,
        ..Truth::default()
    };
    assert_found(truth, "payload", None, ("moment_x_kg_m", 0.12, 0.05));
}

#[test]
fn a_tilted_mount_is_named_with_its_angle() {
    let truth = Truth {
        tilt_rad: 0.15,
        ..Truth::default()
    };
    for seed in [1, 2] {
        let found = examined(truth, seed);
        assert!(
            found.has_gap() && found.is_adequate(),
            "{:?}",
            found.findings
        );
        // the first axis lies: a tilt about it is another zero of its joint, and nothing tells the two apart
        let first = &found.findings[0];
        let near = first.rivals.iter().filter(|own| own.is_near());
        let mut names = near.map(|own| own.effect).chain([first.effect]);
        assert!(
            names.any(|own| own == "gravity-direction"),
            "{:?}",
            found.findings
        );
        let angles = ["tilt_rad", "offset_rad"];
        let mut angles = first.numbers.iter().filter(|own| angles.contains(&own.0));
        let (_, angle_rad, _) = angles.next().unwrap();
        assert!((angle_rad.abs() - 0.15).abs() < 0.02, "{angle_rad}");
    }
}

#[test]
fn a_push_for_a_part_of_the_log_is_named_with_its_share_of_it() {
    let truth = Truth {
        push_n: 25.0,
        ..Truth::default()
    };
    assert_found(truth, "contact", None, ("share", 0.075, 0.02));
}

/// What a push adds is free in its own rows, of which no others say anything: predicted, they were off by millions.
#[test]
fn rows_of_a_push_are_not_predicted_by_the_others() {
    let truth = Truth {
        push_n: 25.0,
        ..Truth::default()
    };
    let found = examine(&device(), &recording(truth, 1), None, &[]).unwrap();
    assert_eq!(found.findings[0].effect, "contact");
    let all = found.time_s.len();
    for own in &found.unseen {
        let (left_out, square) = own.left_out;
        assert_eq!(left_out + own.rows_in_all(), all, "{own:?}");
        assert!((1..all / 3).contains(&left_out), "{left_out} of {all} rows");
        // they hold the gap of a torque that feels the push
        let beyond = |square: f64, rows: usize| square / own.noise.powi(2) - rows as f64;
        let [before, after] = [own.before, own.after].map(|own| own.iter().sum::<f64>());
        let rows = own.rows_in_all();
        assert!(beyond(square, left_out) > beyond(before, rows), "{own:?}");
        assert!(after < 2.0 * own.noise.powi(2) * rows as f64, "{own:?}");
    }
}

#[test]
fn friction_near_rest_is_named_by_another_law_than_it_was_made_with() {
    let truth = Truth {
        stribeck_nm: 2.0,
        ..Truth::default()
    };
    assert_found(truth, "stribeck-friction", Some(0), ("torque_nm", 1.8, 0.6));
}

#[test]
fn what_is_in_no_catalogue_has_no_name() {
    for truth in [
        Truth {
            dent_nm: 2.0,
            ..Truth::default()
        },
        Truth {
            unrelated_nm: 20.0,
            ..Truth::default()
        },
    ] {
        for seed in [1, 2] {
            let found = examined(truth, seed);
            assert!(
                found.has_gap() && !found.is_adequate(),
                "{truth:?}: {:?}",
                found.findings
            );
        }
    }
}

#[test]
fn an_effect_that_is_left_out_is_not_named_and_leaves_a_gap() {
    let truth = Truth {
        late_s: 0.016,
        ..Truth::default()
    };
    let without = ["encoder-latency".to_owned()];
    let found = examine(&device(), &recording(truth, 1), None, &without).unwrap();
    assert!(
        found.has_gap() && !found.is_adequate(),
        "{:?}",
        found.findings
    );
}

#[test]
fn a_drive_that_loads_another_joint_is_named_with_its_share() {
    let truth = Truth {
        coupling: 0.3,
        ..Truth::default()
    };
    assert_found(truth, "cross-coupling", Some(0), ("gain", 0.3, 0.02));
    let found = examined(truth, 1);
    let numbers = &found.findings[0].numbers;
    assert!(numbers.contains(&("from_joint", 2.0, 0.0)), "{numbers:?}");
}

/// What explains a little of a joint within its noise explains no gap of another joint.
#[test]
fn an_effect_where_no_gap_is_explains_none() {
    let mut found = examined(
        Truth {
            gain: 3.0,
            ..Truth::default()
        },
        1,
    );
    assert!(found.is_adequate() && found.findings[0].effect == "torque-gain");
    let own = found.findings[0].joint;
    for channel in &mut found.channels {
        if Some(channel.joint) == own {
            channel.rms_before = channel.noise;
            channel.rms_after = channel.noise;
        } else {
            channel.rms_before = 1.3 * channel.noise;
            channel.rms_after = 1.3 * channel.noise;
        }
    }
    assert!(found.has_gap() && !found.is_adequate());
    // a payload acts on all of them
    found.findings[0].effect = "payload";
    found.findings[0].joint = None;
    assert!(found.is_adequate());
}
