//! What readings of torques are worth to a forward prediction, against an integrator of its own; and that no number which an
//! identification writes is left out of one without a word.

use haptical::data::Cells;
use haptical::simulator::ControllerFile;
use haptical::{Device, Drive, ErrorKind, Forward, Log, forward, replay};
use haptical_model::{DriveNumber, FrictionNumber, JointType};

/// Gravity \[m/s^2\], lengths \[m\], masses \[kg\], centres \[m\], inertias about them and armatures \[kg m^2\].
const GRAVITY: f64 = 9.81;
const LENGTH: f64 = 0.4;
const MASSES: [f64; 2] = [3.0, 2.0];
const CENTRES: [f64; 2] = [0.2, 0.15];
const INERTIAS: [f64; 2] = [0.05, 0.02];
const ARMATURES: [f64; 2] = [0.3, 0.1];

/// The device of these numbers; `joints` are further lines of its joints.
fn two_links(joints: [&str; 2]) -> Device {
    let row = |length: f64, body: usize| {
        format!(
            "[[link]]\na_m = {length}\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = {}\ncentre_of_mass_m = [{}, 0.0, 0.0]\n\
             inertia_kgm2 = [0.001, {i}, {i}, 0.0, 0.0, 0.0]\n",
            MASSES[body],
            CENTRES[body],
            i = INERTIAS[body]
        )
    };
    let text = format!(
        "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n{}{}[[joint]]\narmature_kgm2 = {}\n{}\n[[joint]]\narmature_kgm2 = {}\n{}\n\
         [gravity]\nvector_mps2 = [0.0, -{GRAVITY}, 0.0]\n",
        row(LENGTH, 0),
        row(0.3, 1),
        ARMATURES[0],
        joints[0],
        ARMATURES[1],
        joints[1],
    );
    Device::from_toml(&text, "two_links.toml").expect("a device")
}

/// Accelerations of two links in a vertical plane. Source: Spong, Hutchinson and Vidyasagar, Robot Modeling and Control (2006),
/// example 7.2.
fn accelerations(q: [f64; 2], dq: [f64; 2], torque: [f64; 2]) -> [f64; 2] {
    let [m1, m2] = MASSES;
    let [c1, c2] = CENTRES;
    let coupled = m2 * LENGTH * c2 * q[1].cos();
    let m22 = m2 * c2 * c2 + INERTIAS[1];
    let m12 = m22 + coupled;
    let m11 =
        m1 * c1 * c1 + INERTIAS[0] + m2 * LENGTH * LENGTH + m22 + 2.0 * coupled + ARMATURES[0];
    let m22 = m22 + ARMATURES[1];
    let h = m2 * LENGTH * c2 * q[1].sin();
    let weight2 = m2 * GRAVITY * c2 * (q[0] + q[1]).cos();
    let weight1 = (m1 * c1 + m2 * LENGTH) * GRAVITY * q[0].cos() + weight2;
    let right = [
        torque[0] + h * (2.0 * dq[0] * dq[1] + dq[1] * dq[1]) - weight1,
        torque[1] - h * dq[0] * dq[0] - weight2,
    ];
    let determinant = m11 * m22 - m12 * m12;
    [
        (m22 * right[0] - m12 * right[1]) / determinant,
        (m11 * right[1] - m12 * right[0]) / determinant,
    ]
}

/// What the drives give: enough to hold the arm about where it is, and waves.
fn given(t: f64) -> [f64; 2] {
    [
        14.0 + 6.0 * (7.0 * t).sin() + 2.0 * (31.0 * t).cos(),
        2.5 + 1.5 * (9.0 * t).cos() - (37.0 * t).sin(),
    ]
}

/// A second of motion by the classical Runge-Kutta method in steps of 0.1 ms, a row every 5 ms, and torques as they are read:
/// with offsets, some time after they acted.
fn columns(offset_nm: [f64; 2], delay_s: [f64; 2]) -> Vec<(String, Vec<f64>)> {
    const STEP_S: f64 = 1e-4;
    let names = [
        "t_s",
        "theta1_rad",
        "theta2_rad",
        "torque1_nm",
        "torque2_nm",
    ];
    let mut columns = names.map(|name| (name.to_owned(), Vec::new()));
    let slope = |t: f64, [q1, q2, v1, v2]: [f64; 4]| {
        let [a1, a2] = accelerations([q1, q2], [v1, v2], given(t));
        [v1, v2, a1, a2]
    };
    let along = |from: [f64; 4], k: [f64; 4], s: f64| std::array::from_fn(|i| from[i] + s * k[i]);
    let mut state = [0.3, 0.2, 0.0, 0.0];
    for step in 0..=10_000 {
        let t = f64::from(step) * STEP_S;
        if step % 50 == 0 {
            let read = [0, 1].map(|joint| given(t - delay_s[joint])[joint] + offset_nm[joint]);
            let row = [t, state[0], state[1], read[0], read[1]];
            for ((_, column), value) in columns.iter_mut().zip(row) {
                column.push(value);
            }
        }
        let first = slope(t, state);
        let second = slope(t + 0.5 * STEP_S, along(state, first, 0.5 * STEP_S));
        let third = slope(t + 0.5 * STEP_S, along(state, second, 0.5 * STEP_S));
        let fourth = slope(t + STEP_S, along(state, third, STEP_S));
        let mean = std::array::from_fn(|i| {
            (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]) / 6.0
        });
        state = along(state, mean, STEP_S);
    }
    columns.into()
}

fn log(device: &Device, columns: &[(String, Vec<f64>)]) -> Log {
    let cells: Vec<_> = columns
        .iter()
        .map(|(name, values)| (name.as_str(), Cells::Numbers(values)))
        .collect();
    Log::from_columns(&cells, "log.csv", device).expect("a log")
}

fn predicted(device: &Device, log: &Log, drive: Drive<'_>) -> Forward {
    forward(&[("device", device)], log, drive).expect("a prediction")
}

/// At the end of windows of 0.1 s and of 0.5 s, the worse joint \[rad\].
fn ends(told: &Forward) -> [f64; 2] {
    [0, 1].map(|horizon| {
        let joints = &told.devices[0].drifts[horizon].joints;
        joints[0].end_rms.max(joints[1].end_rms)
    })
}

#[test]
fn offsets_and_delays_of_torques_are_taken_off() {
    let (offset_nm, delay_s) = ([0.6, -0.4], [0.0073, -0.0041]);
    let log_of = |device: &Device| log(device, &columns(offset_nm, delay_s));
    let joint =
        |offset: f64, delay: f64| format!("torque_offset_nm = {offset}\ntorque_delay_s = {delay}");
    let of = |offsets: [f64; 2], delays: [f64; 2]| {
        let lines = [0, 1].map(|own| joint(offsets[own], delays[own]));
        let device = two_links([&lines[0], &lines[1]]);
        let told = predicted(&device, &log_of(&device), Drive::Torques);
        (ends(&told), told)
    };
    let ([right, right_later], told) = of(offset_nm, delay_s);
    // what is left are the straight lines between readings 5 ms apart, and the smoothed velocity at the start
    assert!(right < 2e-4 && right_later < 1e-3, "{right} {right_later}");
    // torques of the ends were logged outside of the run: 7.3 ms at one, 4.1 ms at the other
    assert_eq!(told.warnings.len(), 1, "{:?}", told.warnings);
    assert!(told.warnings[0].starts_with("3 rows at the ends of runs are not predicted"));
    for (offsets, delays) in [
        ([0.0, 0.0], delay_s),
        (offset_nm.map(|own| -own), delay_s),
        (offset_nm, [0.0, 0.0]),
        (offset_nm, delay_s.map(|own| -own)),
    ] {
        let ([wrong, wrong_later], _) = of(offsets, delays);
        assert!(
            wrong > 5.0 * right && wrong_later > 5.0 * right_later,
            "{offsets:?} {delays:?}: {wrong} {wrong_later}, {right} {right_later}"
        );
    }
    let far = two_links(["torque_delay_s = 3.0", ""]);
    let error = forward(&[("device", &far)], &log_of(&far), Drive::Torques).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::BadInput);
    assert!(error.to_string().contains("torque_delay_s"), "{error}");
}

const CONTROLLER: &str = "kp_nm_per_rad = [200.0, 100.0]\nkd_nm_s_per_rad = [20.0, 10.0]\ngravity_compensation = true\nrate_hz = 500\n";

/// Whether a device's predictions differ from another's.
fn is_moved(own: &Forward, other: &Forward) -> bool {
    let of = |told: &Forward| {
        let joints = told.devices[0]
            .drifts
            .iter()
            .flat_map(|drift| &drift.joints);
        joints.map(|joint| joint.rms).collect::<Vec<f64>>()
    };
    let mut pairs = of(own).into_iter().zip(of(other));
    pairs.any(|(own, other)| (own - other).abs() > 1e-9 + 1e-6 * other)
}

/// Every number on the list is part of a prediction under torques or under a controller; what it is not part of says so.
#[test]
fn no_number_of_a_drive_is_left_out_of_a_prediction_or_a_replay_without_a_word() {
    let plain = two_links(["", ""]);
    let mut all = columns([0.0; 2], [0.0; 2]);
    for joint in 1..=2 {
        all.push((format!("command{joint}_rad"), vec![0.3; all[0].1.len()]));
    }
    let controller = ControllerFile::from_toml(CONTROLLER, "controller.toml", 2).expect("gains");
    let both = |device: &Device| {
        let log = log(device, &all);
        let by_torques = predicted(device, &log, Drive::Torques);
        (
            by_torques,
            predicted(device, &log, Drive::Controller(&controller)),
        )
    };
    let (by_torques, controlled) = both(&plain);
    let mut devices: Vec<(String, Device)> = Vec::new();
    for number in DriveNumber::ALL {
        let key = number.key(JointType::Revolute);
        // a limit that the controller reaches, a delay of two rows
        let value = if number == DriveNumber::TorqueDelay {
            0.01
        } else {
            1.5
        };
        let device = match number {
            DriveNumber::Armature => {
                let text = plain
                    .to_toml()
                    .replace("armature_kgm2 = 0.1", "armature_kgm2 = 1.5");
                Device::from_toml(&text, "arm.toml").expect("a device")
            }
            _ => two_links(["", &format!("{key} = {value}")]),
        };
        devices.push((key.to_owned(), device));
    }
    let friction = |numbers: &[(FrictionNumber, f64)]| {
        let lines = numbers
            .iter()
            .map(|(number, value)| format!("{} = {value}\n", number.key(JointType::Revolute)));
        let lines: String = lines.collect();
        let text = format!(
            "{}\n[[effect]]\nname = \"joint-friction\"\njoint = 2\n{lines}",
            plain.to_toml()
        );
        Device::from_toml(&text, "arm.toml").expect("a device")
    };
    let usual = [
        (FrictionNumber::Coulomb, 0.5),
        (FrictionNumber::Viscous, 0.2),
        (FrictionNumber::Stribeck, 0.3),
        (FrictionNumber::TurnoverSpeed, 0.02),
    ];
    let (rubs, rubs_controlled) = both(&friction(&usual));
    assert!(is_moved(&rubs, &by_torques) && is_moved(&rubs_controlled, &controlled));
    for number in FrictionNumber::ALL {
        let mut other = usual.to_vec();
        match usual.iter().position(|own| own.0 == number) {
            Some(place) => other[place].1 *= 3.0,
            None => other[3] = (number, 0.02),
        }
        let (own, own_controlled) = both(&friction(&other));
        assert!(
            is_moved(&own, &rubs) && is_moved(&own_controlled, &rubs_controlled),
            "{number:?}"
        );
    }
    for (key, device) in &devices {
        let (own, own_controlled) = both(device);
        // a limit of a drive says nothing of torques that it gave
        assert_eq!(
            is_moved(&own, &by_torques),
            key != "torque_limit_nm",
            "{key}"
        );
        assert!(is_moved(&own_controlled, &controlled), "{key}");
    }
    // a replay has loads, not motions: it says what of their readings it leaves out
    let text = "[[joint]]\ntorque_offset_nm = 0.25\ntorque_delay_s = 0.002\n[[joint]]\ntorque_offset_nm = -0.5\n";
    let bare = Device::from_toml(text, "bare.toml").expect("a device");
    all.push(("out1_rad".to_owned(), all[1].1.clone()));
    let said = replay(&bare, &log(&bare, &all)).expect("a replay").warnings;
    let wanted =
        "joint 1 (torque offset 0.25 N m, torque delay 2 ms), joint 2 (torque offset -0.5 N m)";
    assert!(said.iter().any(|own| own.contains(wanted)), "{said:?}");
}

/// What has no part in the equations is named with its size.
#[test]
fn what_is_no_part_of_the_motion_is_named_with_its_size() {
    let text = format!(
        "{}\n[[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 0.00123\n[[effect]]\nname = \"joint-compliance\"\njoint = 2\n\
         stiffness_nm_per_rad = 800.0\n",
        two_links(["", ""]).to_toml()
    );
    let device = Device::from_toml(&text, "arm.toml").expect("a device");
    let told = predicted(
        &device,
        &log(&device, &columns([0.0; 2], [0.0; 2])),
        Drive::Torques,
    );
    let said = told.warnings.join("\n");
    assert!(said.contains("width_rad 0.00123"), "{said}");
    assert!(
        said.contains("compliance of joint 2 (stiffness 8"),
        "{said}"
    );
}

/// The same rule as of a diagnosis and of the exports: no prediction with an inertia that no body has.
#[test]
fn an_inertia_that_no_body_has_is_refused_by_its_entry() {
    let text = two_links(["", ""]).to_toml().to_owned();
    for (entries, why) in [
        (
            "[0.001, 0.02, 0.5, 0.0, 0.0, 0.0]",
            "izz is more than ixx + iyy",
        ),
        ("[-0.001, 0.02, 0.02, 0.0, 0.0, 0.0]", "ixx is below 0"),
    ] {
        let broken = text.replace("[0.001, 0.02, 0.02, 0.0, 0.0, 0.0]", entries);
        let device = Device::from_toml(&broken, "arm.toml").expect("a device");
        let said = device.warnings.join("\n");
        assert!(
            said.contains("an inertia of row 2 that no body has") && said.contains(why),
            "{said}"
        );
        let log = log(&device, &columns([0.0; 2], [0.0; 2]));
        let error = forward(&[("device", &device)], &log, Drive::Torques).unwrap_err();
        assert!(error.to_string().contains(why), "{error}");
    }
    // a point is a body
    let point = text.replace(
        "[0.001, 0.02, 0.02, 0.0, 0.0, 0.0]",
        "[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
    );
    let device = Device::from_toml(&point, "arm.toml").expect("a device");
    assert!(device.warnings.is_empty(), "{:?}", device.warnings);
    let told = predicted(
        &device,
        &log(&device, &columns([0.0; 2], [0.0; 2])),
        Drive::Torques,
    );
    assert!(
        told.warnings
            .iter()
            .any(|own| own.contains("rows 2 is given as 0")),
        "{:?}",
        told.warnings
    );
}
