//! Laws that are not quite those of the catalogue, and what a gap depends on.

use haptical_motion::{Examined, Quantity, examine};

use super::arm::{Truth, device, recording, second_recording};

fn examined(truth: Truth, seed: u64, without: &[&str]) -> Examined {
    let without: Vec<String> = without.iter().map(|own| (*own).to_owned()).collect();
    examine(&device(), &recording(truth, seed), None, &without).unwrap()
}

#[test]
fn readings_that_end_are_named_with_their_end_though_they_do_for_a_third_of_the_log() {
    for (seed, end_nm) in [(1, 3.0), (2, 3.5)] {
        let truth = Truth {
            end_nm: Some(end_nm),
            ..Truth::default()
        };
        let found = examined(truth, seed, &[]);
        assert!(found.is_adequate(), "seed {seed}: {:?}", found.findings);
        let first = &found.findings[0];
        assert_eq!((first.effect, first.joint), ("torque-saturation", Some(1)));
        let (_, value, sd) = first.numbers[0];
        assert!((value - end_nm).abs() < 2.0 * sd, "{value} +- {sd}");
        assert!(sd < 0.1, "{sd}");
        // rows of the log that the fit does not see end there too, and none is predicted by what no other row fixes
        let own = found.unseen.iter().find(|own| own.joint == 1).unwrap();
        let [before, after] = [own.before, own.after].map(|own| own.iter().sum::<f64>().sqrt());
        assert!(
            after < 0.3 * before,
            "seed {seed}: {after} of {before} is left of unseen rows"
        );
        // the second recording's end there too
        let second = second_recording(truth, seed);
        let found = examine(&device(), &recording(truth, seed), Some(&second), &[]).unwrap();
        let own = found.unseen.iter().find(|own| own.joint == 1).unwrap();
        let [before, after] = [own.before, own.after]
            .map(|own| own.iter().sum::<f64>())
            .map(|own: f64| own.sqrt());
        assert!(
            after < 0.15 * before,
            "seed {seed}: {after} of {before} is left"
        );
    }
}

#[test]
fn friction_that_turns_over_before_the_motion_is_no_gap() {
    // MuJoCo's frictionloss as it is set; of a small drive the rows near rest, which weigh little, hold all of it
    let truth = Truth {
        lead_s: 0.009,
        rough_nm: 150.0,
        ..Truth::default()
    };
    for seed in [1, 2, 3] {
        let found = examined(truth, seed, &[]);
        assert!(!found.has_gap(), "seed {seed}: {:?}", found.findings);
    }
}

#[test]
fn friction_of_the_drives_own_load_is_named_to_its_size() {
    for seed in [1, 2, 3] {
        let truth = Truth {
            load_share: 0.25,
            ..Truth::default()
        };
        let found = examined(truth, seed, &[]);
        assert!(found.is_adequate(), "seed {seed}: {:?}", found.findings);
        let first = &found.findings[0];
        assert_eq!((first.effect, first.joint), ("load-friction", Some(0)));
        let (_, share, _) = first.numbers[0];
        assert!((share - 0.25).abs() < 0.01, "seed {seed}: {share}");
        assert!(!found.channels[0].has_rest(), "seed {seed}");
    }
}

#[test]
fn a_payloads_own_inertia_goes_into_the_device() {
    let truth = Truth {
        payload_kg: 1.2,
        payload_kgm2: 0.06,
        ..Truth::default()
    };
    let found = examined(truth, 1, &[]);
    assert_eq!(found.findings[0].effect, "payload");
    let nominal = device();
    let loaded = found.findings[0].change.unwrap().applied(&nominal).unwrap();
    // about the second joint, which alone feels it
    let about = |device: &haptical_model::Device| {
        let body = device.bodies[2].unwrap();
        let [x, y, _] = body.centre_of_mass_m;
        let out = [x, y];
        body.inertia_kgm2.unwrap()[2] + body.mass_kg * (out[0] * out[0] + out[1] * out[1])
    };
    let more = about(&loaded) - about(&nominal);
    let wanted = 1.2 * 0.09 + 0.06;
    assert!((more / wanted - 1.0).abs() < 0.15, "{more} {wanted}");
}

#[test]
fn a_centre_on_the_other_side_of_its_joint_is_named_with_its_shift() {
    for (body, shift_m) in [(1, 0.4), (2, 0.3)] {
        let mut device = device();
        device.bodies[body].as_mut().unwrap().centre_of_mass_m[0] *= -1.0;
        for seed in [1, 2, 3] {
            let truth = Truth::default();
            let [log, second] = [recording, second_recording].map(|log| log(truth, seed));
            let found = examine(&device, &log, Some(&second), &[]).unwrap();
            let about = format!("body {body}, seed {seed}: {:?}", found.findings);
            assert_eq!(found.findings.len(), 1, "{about}");
            let finding = &found.findings[0];
            for joint in &found.unseen {
                // in squares of the noise
                let left: f64 = joint.after.iter().sum();
                assert!(left < 2.0, "{left} of joint {}, {about}", joint.joint);
            }
            if body == 1 && finding.effect == "gravity-spring" {
                // about the first joint of two the same torque
                let rival = finding.rivals.first().unwrap();
                assert_eq!((rival.effect, rival.joint), ("link-inertia", Some(0)));
                assert!(rival.behind_nats < 1.0, "{about}");
                continue;
            }
            assert_eq!(finding.effect, "link-inertia", "{about}");
            assert_eq!(finding.joint, Some(body - 1), "{about}");
            let (_, along_m, _) = finding.numbers[0];
            // masses are off by up to 6 %
            assert!((along_m / shift_m - 1.0).abs() < 0.1, "{about}");
        }
    }
}

#[test]
fn an_offset_that_is_left_out_is_not_taken_for_a_spring() {
    let truth = Truth {
        offset_nm: 3.0,
        ..Truth::default()
    };
    for seed in [1, 2, 3] {
        let whole = examined(truth, seed, &[]);
        assert_eq!(whole.findings[0].effect, "torque-offset", "seed {seed}");
        let found = examined(truth, seed, &["torque-offset", "friction-asymmetry"]);
        assert!(
            found.has_gap() && !found.is_adequate(),
            "seed {seed}: {:?}",
            found.findings
        );
    }
}

#[test]
fn a_gap_is_said_to_follow_what_it_is_a_function_of() {
    let shares = |truth: Truth, joint: usize| {
        let found = examined(truth, 4, &[]);
        let channel = found.channels.into_iter().find(|own| own.joint == joint);
        let told = channel.unwrap().depends_on;
        let of = |quantity| told.iter().find(|own| own.quantity == quantity);
        [Quantity::Load, Quantity::Velocity, Quantity::Time].map(|own| of(own).unwrap().share)
    };
    let gain = Truth {
        gain: 0.4,
        ..Truth::default()
    };
    let [load, _, time] = shares(gain, 1);
    assert!(load > 0.8 && load > time + 0.2, "{load} {time}");
    let stribeck = Truth {
        stribeck_nm: 1.5,
        ..Truth::default()
    };
    let [load, velocity, time] = shares(stribeck, 0);
    assert!(velocity > 0.8 && velocity > load + 0.2, "{velocity} {load}");
    assert!(velocity > time + 0.2, "{velocity} {time}");
}

#[test]
fn intervals_hold_the_gain_of_a_torque_and_the_place_of_cogging() {
    for seed in 1..=4 {
        let truth = Truth {
            gain: 0.4,
            ..Truth::default()
        };
        let found = examined(truth, seed, &[]);
        let (_, gain, sd) = found.findings[0].numbers[0];
        // of a reading 0.4 / 1.4 are too much
        assert!((gain - 0.4 / 1.4).abs() < 3.0 * sd, "{gain} +- {sd}");
        let truth = Truth {
            cogging_nm: 1.0,
            ..Truth::default()
        };
        let found = examined(truth, seed, &[]);
        let numbers = &found.findings[0].numbers;
        let (_, order, sd) = numbers.iter().find(|own| own.0 == "order").unwrap();
        assert!(*sd > 0.0 && *sd < 0.3, "{sd}");
        assert!((order - 30.0).abs() < 3.0 * sd, "{order} +- {sd}");
    }
}

/// Friction that is another one near an angle is no law of a weight: it is said next to it, and alone it has no name.
#[test]
fn a_payload_is_named_next_to_friction_by_position() {
    for seed in 1..4 {
        let dent = Truth {
            dent_nm: 2.0,
            ..Truth::default()
        };
        let loaded = Truth {
            payload_kg: 1.0,
            ..dent
        };
        let found = examined(loaded, seed, &[]);
        let names = || -> Vec<&str> { found.findings.iter().map(|own| own.effect).collect() };
        assert!(
            found.is_answer(),
            "{seed}: {:?} {:?}",
            names(),
            found.refusal()
        );
        assert_eq!(names(), ["payload"], "{seed}");
        assert!(
            found.leaves_friction() && found.channels[0].has_rest(),
            "{seed}"
        );
        let (_, mass, sd) = found.findings[0].numbers[0];
        assert!((mass - 1.0).abs() < 4.0 * sd + 0.03, "{seed}: {mass} {sd}");
        let alone = examined(dent, seed, &[]);
        assert!(
            alone.has_gap() && !alone.is_answer(),
            "{seed}: {:?}",
            alone.findings
        );
        assert!(alone.channels[0].share_of_friction[0] > 0.9, "{seed}");
    }
}

/// The log of a torque in another scale has its noise in that scale, too: what is left is compared with it there.
#[test]
fn what_a_scale_leaves_is_in_the_unit_of_the_log() {
    let truth = Truth::default();
    let mut recorded = recording(truth, 3);
    for torque in recorded.torque_nm.iter_mut().flatten() {
        torque.iter_mut().for_each(|value| *value *= 3.0);
    }
    let found = examine(&device(), &recorded, None, &[]).unwrap();
    assert_eq!(found.findings[0].effect, "torque-gain");
    assert!((found.findings[0].numbers[0].1 - 3.0).abs() < 0.4);
    let mut second = second_recording(truth, 3);
    for torque in second.torque_nm.iter_mut().flatten() {
        torque.iter_mut().for_each(|value| *value *= 3.0);
    }
    let predicted = examine(&device(), &recorded, Some(&second), &[]).unwrap();
    for unseen in &predicted.unseen {
        let count = unseen.predictions.len() as f64;
        assert!(count > 0.0);
        let left = unseen.predictions.iter();
        let left = left.map(|(_, [measured, _, after])| (measured - after).powi(2));
        let ratio = (left.sum::<f64>() / count).sqrt() / unseen.noise;
        assert!((0.7..1.4).contains(&ratio), "{ratio}");
    }
    for channel in &found.channels {
        let ratio = channel.rms_after / channel.noise;
        assert!((0.7..1.3).contains(&ratio), "{ratio}");
    }
    for unseen in &found.unseen {
        let square = unseen.after.iter().sum::<f64>() / unseen.rows_in_all() as f64;
        let ratio = square.sqrt() / unseen.noise;
        assert!((0.7..1.3).contains(&ratio), "{ratio}");
    }
}
