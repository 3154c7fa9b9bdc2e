//! Effects: nothing at size zero, only on the channels they can reach, and by the laws they state.

use std::collections::BTreeMap;

use haptical_model::Device;
use haptical_model::kinematics::nalgebra::{SMatrix, SVector};
use xtask_blind::{
    Draw, Effect, KINDS, Kind, MotionPlan, NOMINALS, NoisePlan, Random, Recorded, Scene, kind,
    perturbed,
};

/// Rows in which every effect shows.
const ROWS: usize = 2500;
/// Rows that are enough where nothing must show.
const FEW_ROWS: usize = 600;

fn plan(kind: &Kind, rows: usize) -> MotionPlan {
    let runs = if kind.needs_two_runs() { 2 } else { 1 };
    MotionPlan {
        rows: rows / runs,
        runs,
        ..MotionPlan::default()
    }
}

fn effect(nominal: &Device, kind: &Kind, joint: usize, size: f64, seed: u64) -> Effect {
    kind.draw(&mut Draw {
        device: nominal,
        joint,
        size,
        tag: 0,
        random: &mut Random::new(seed, 3),
    })
}

/// A recording of a manufactured device with these effects, and the scene's device.
fn record(nominal: &Device, plan: &MotionPlan, effects: &[Effect]) -> (Recorded, Device) {
    let mut device = perturbed(nominal, &mut Random::new(40, 0));
    for effect in effects {
        effect.device(&mut device);
    }
    let scene = Scene::draw(&device, plan, 17).expect("a scene");
    let noise = NoisePlan::white(device.joints.len());
    let scales = vec![1.0; device.joints.len()];
    let recorded = scene.record(effects, &noise, &scales).expect("a recording");
    (recorded, device)
}

/// Every kind on every device at its first and last joint, and the recording of its motion without an effect.
fn everywhere(rows: usize, mut check: impl FnMut(&Device, &Kind, usize, &Recorded)) {
    for nominal in NOMINALS {
        let device = nominal.device().expect("a device");
        let mut without: BTreeMap<usize, Recorded> = BTreeMap::new();
        for kind in KINDS {
            let plan = plan(kind, rows);
            let clean = without
                .entry(plan.runs)
                .or_insert_with(|| record(&device, &plan, &[]).0);
            let joints = kind.joints(&device);
            let last = joints.last().copied();
            let first = joints.first().copied().filter(|first| Some(*first) != last);
            for joint in first.into_iter().chain(last) {
                check(&device, kind, joint, clean);
            }
        }
    }
}

#[test]
fn size_zero_is_clean() {
    everywhere(FEW_ROWS, |nominal, kind, joint, clean| {
        let plan = plan(kind, FEW_ROWS);
        let (with, _) = record(nominal, &plan, &[effect(nominal, kind, joint, 0.0, 5)]);
        assert_eq!(with.log, clean.log, "{} at joint {joint}", kind.name);
    });
}

/// Which columns an effect may change: motor readings, external encoders, cable, torque, force.
fn reach(kind: &Kind) -> [bool; 5] {
    let name = kind.name;
    let is_torque = [
        "joint-friction",
        "motor-cogging",
        "torque-gain",
        "unbalanced-gravity",
        "payload",
        "payload-on-link",
        "friction-beside",
        "friction-alone",
    ];
    if name == "outliers" || name == "noise-level" {
        [false, true, true, false, false]
    } else if name.starts_with("external-") {
        [false, true, false, false, false]
    } else if is_torque.contains(&name) || name.starts_with("torque-") {
        [false, false, false, true, false]
    } else if name.starts_with("force-") || name == "grip-force" {
        [false, false, false, false, true]
    } else if [
        "thermal-drift",
        "joint-compliance",
        "axis-wobble",
        "base-compliance",
        "tool-compliance",
        "tool-changed",
    ]
    .contains(&name)
        || (name.starts_with("cable-") && name != "cable-pitch")
    {
        [false, false, true, false, false]
    } else {
        [true, false, false, false, false]
    }
}

#[test]
fn effects_reach_their_channels_and_no_others() {
    everywhere(ROWS, |nominal, kind, joint, clean| {
        let plan = plan(kind, ROWS);
        let (with, _) = record(nominal, &plan, &[effect(nominal, kind, joint, 1.0, 5)]);
        let changed = [
            with.log.joint != clean.log.joint,
            with.log.output != clean.log.output,
            with.log.cable_m != clean.log.cable_m,
            with.log.torque_nm != clean.log.torque_nm,
            with.log.force_n != clean.log.force_n,
        ];
        for (changed, may) in changed.iter().zip(reach(kind)) {
            assert!(
                may || !changed,
                "{} at joint {joint}: {changed:?}",
                kind.name
            );
        }
        assert!(
            changed.contains(&true),
            "{} at joint {joint} does nothing",
            kind.name
        );
        if reach(kind)[0] && kind.name != "encoder-latency" {
            for (other, (a, b)) in with.log.joint.iter().zip(&clean.log.joint).enumerate() {
                assert!(
                    other == joint || a == b,
                    "{} reaches joint {other}",
                    kind.name
                );
            }
        }
    });
}

/// How far the motor leads the output, beyond the true transmission error, at joint `joint`.
fn lead_rad(recorded: &Recorded, device: &Device, joint: usize) -> Vec<f64> {
    let output = recorded.clean.output_rad[joint]
        .as_ref()
        .expect("an encoder");
    let readings = recorded.log.joint[joint].iter();
    readings
        .zip(output)
        .map(|(theta, out)| theta + device.joints[joint].error_rad(*theta).expect("error") - out)
        .collect()
}

fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let xy: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
    xy / x.iter().map(|x| (x - mx) * (x - mx)).sum::<f64>()
}

fn haptic7() -> Device {
    NOMINALS[0].device().expect("a device")
}

fn single(name: &str, joint: usize) -> (Recorded, Device, BTreeMap<&'static str, f64>) {
    let nominal = haptic7();
    let kind = kind(name).expect("a kind");
    let effects = [effect(&nominal, kind, joint, 1.0, 8)];
    let (recorded, device) = record(&nominal, &MotionPlan::default(), &effects);
    let scene = Scene::draw(&device, &MotionPlan::default(), 17).expect("a scene");
    let parameters = effects[0].facts(&scene).parameters;
    (recorded, device, parameters)
}

/// The motor leads by torque over stiffness, with the sign of the torque. The spring hardens, and weight hangs
/// on the angle: the stated stiffness is that of the fit together with offset, ratio and output drum.
#[test]
fn a_compliant_capstan_leads_under_load() {
    // torque readings have 4 mNm of noise on the 0.1 Nm that the angle does not explain
    const TOLERANCE: f64 = 5e-3;
    let (recorded, device, parameters) = single("capstan-compliance", 1);
    let torque = recorded.log.torque_nm[1].as_ref().expect("torque");
    let lead = lead_rad(&recorded, &device, 1);
    let angle = recorded.clean.output_rad[1].as_ref().expect("an encoder");
    let (mut normal, mut right) = (SMatrix::<f64, 5, 5>::zeros(), SVector::<f64, 5>::zeros());
    for ((torque, lead), angle) in torque.iter().zip(&lead).zip(angle) {
        let row = SVector::from([*torque, 1.0, *angle, angle.sin(), angle.cos()]);
        normal += row * row.transpose();
        right += row * *lead;
    }
    let compliance = normal.lu().solve(&right).expect("a solution")[0];
    let stated = 1.0 / parameters["stiffness_nm_per_rad"];
    assert!(
        (compliance / stated - 1.0).abs() < TOLERANCE,
        "{compliance} for {stated}"
    );
}

/// Play: the lead lies between minus and plus half the width, and is there most of the time.
#[test]
fn backlash_leads_by_half_its_width() {
    let (recorded, device, parameters) = single("backlash", 2);
    let half = 0.5 * parameters["width_rad"];
    let lead = lead_rad(&recorded, &device, 2);
    let count = device.joints[2].reading_quantum_rad().expect("a count");
    assert!(lead.iter().all(|lead| lead.abs() <= half + count));
    let settled = lead
        .iter()
        .filter(|lead| lead.abs() > 0.95 * half - count)
        .count();
    assert!(settled as f64 > 0.75 * lead.len() as f64);
    // the motor leads the way it goes
    let output = recorded.clean.output_rad[2].as_ref().expect("an encoder");
    let agree = (10..lead.len()).filter(|row| {
        let step = output[*row] - output[row - 10];
        step.abs() > 0.02 && (step > 0.0) != (lead[*row] > 0.0)
    });
    assert!(agree.count() < lead.len() / 50);
}

/// A late channel shows what was true before: reading = truth - delay * rate.
#[test]
fn latencies_make_readings_late() {
    const TOLERANCE: f64 = 5e-3;
    let nominal = haptic7();
    for (name, joint) in [("external-encoder-latency", 1), ("cable-latency", 0)] {
        let kind = kind(name).expect("a kind");
        let effects = [effect(&nominal, kind, joint, 1.0, 8)];
        let plan = MotionPlan::default();
        let (clean, device) = record(&nominal, &plan, &[]);
        let (late, _) = record(&nominal, &plan, &effects);
        let pick = |recorded: &Recorded| -> Vec<f64> {
            let channels = &recorded.clean;
            let column = if name.starts_with("cable") {
                &channels.cable_m[0]
            } else {
                &channels.output_rad[joint]
            };
            column.clone().expect("a channel")
        };
        let (now, late) = (pick(&clean), pick(&late));
        let rows = 1..now.len() - 1;
        let rate: Vec<f64> = rows
            .clone()
            .map(|row| (now[row + 1] - now[row - 1]) * 50.0)
            .collect();
        let behind: Vec<f64> = rows.map(|row| now[row] - late[row]).collect();
        let scene = Scene::draw(&device, &plan, 17).expect("a scene");
        let stated = effects[0].facts(&scene).parameters["delay_s"];
        let delay = slope(&rate, &behind);
        assert!(
            (delay / stated - 1.0).abs() < TOLERANCE,
            "{name}: {delay} for {stated}"
        );
    }
}

/// The links of a compliant joint stay behind the torque; the cable sees it, the encoder does not.
#[test]
fn a_compliant_joint_stays_behind() {
    let nominal = haptic7();
    let kind = kind("joint-compliance").expect("a kind");
    let effects = [effect(&nominal, kind, 1, 1.0, 8)];
    let plan = MotionPlan::default();
    let (clean, device) = record(&nominal, &plan, &[]);
    let (with, _) = record(&nominal, &plan, &effects);
    let scene = Scene::draw(&device, &plan, 17).expect("a scene");
    let stiffness = effects[0].facts(&scene).parameters["stiffness_nm_per_rad"];
    let mut evaluation = haptical_model::Evaluation::new(&device);
    let (mut stated, mut seen) = (Vec::new(), Vec::new());
    for row in (0..scene.len()).step_by(50) {
        let q: Vec<f64> = scene
            .motion
            .angle_rad
            .iter()
            .map(|angle| angle[row])
            .collect();
        evaluation.move_outputs(&q).expect("a pose");
        let position = evaluation.pose().expect("a pose").position_m;
        let per_rad = position.normalize().dot(&evaluation.joint_twist(1).linear);
        stated.push(-per_rad * scene.torque_nm[1][row] / stiffness);
        let cable =
            |recorded: &Recorded| recorded.clean.cable_m[0].as_ref().map(|cable| cable[row]);
        seen.push(cable(&with).expect("a cable") - cable(&clean).expect("a cable"));
    }
    // the law hardens a little: the line through it is good to a few per cent
    let gain = slope(&stated, &seen);
    assert!((gain - 1.0).abs() < 0.05, "{gain}");
}

/// Lost counts shift the motor's reading by whole counts from a time on.
#[test]
fn lost_counts_are_whole() {
    let nominal = haptic7();
    let kind = kind("encoder-count-loss").expect("a kind");
    let plan = MotionPlan::default();
    let effects = [effect(&nominal, kind, 0, 1.0, 8)];
    let (clean, device) = record(&nominal, &plan, &[]);
    let (with, _) = record(&nominal, &plan, &effects);
    let count = device.joints[0].reading_quantum_rad().expect("a count");
    let scene = Scene::draw(&device, &plan, 17).expect("a scene");
    let events = effects[0].facts(&scene).events;
    for row in 0..scene.len() {
        let time_s = scene.elapsed_s(row);
        let lost: f64 = events
            .iter()
            .filter(|event| event.time_s < time_s)
            .map(|event| event.size)
            .sum();
        let shift = (with.log.joint[0][row] - clean.log.joint[0][row]) / count;
        assert!(
            (shift - lost).abs() < 0.01,
            "{shift} for {lost} at {time_s} s"
        );
    }
}

/// A second tool position, in the second run only.
#[test]
fn a_changed_tool_shows_in_the_second_run() {
    let nominal = haptic7();
    let kind = kind("tool-changed").expect("a kind");
    let effects = [effect(&nominal, kind, 0, 1.0, 8)];
    let (clean, device) = record(&nominal, &plan(kind, ROWS), &[]);
    let (with, _) = record(&nominal, &plan(kind, ROWS), &effects);
    let scene = Scene::draw(&device, &plan(kind, ROWS), 17).expect("a scene");
    let shift_m = effects[0].facts(&scene).parameters["shift_m"];
    let run = with.log.run.as_ref().expect("runs");
    let cable = |recorded: &Recorded| recorded.clean.cable_m[0].clone().expect("a cable");
    for (row, (a, b)) in cable(&with).iter().zip(cable(&clean)).enumerate() {
        let change = (a - b).abs();
        assert!(if run[row] == 0 {
            change == 0.0
        } else {
            change <= shift_m * 1.01
        });
    }
}
