//! What was named on a moving arm is in corrected.toml, in a URDF and in an MJCF, and the next recording then has no gap.

use haptical_model::{Device, RigidBodies};
use serde_json::Value;

use super::log::{Arm, Log};
use super::{Trial, told, warns};
use crate::{haptical, text};

fn export(trial: &Trial, format: &str, from: &str, out: &str) -> String {
    let output = haptical()
        .args(["export", "--format", format, "--device"])
        .arg(trial.path("kept").join("corrected.toml"))
        .arg(format!("--{format}"))
        .arg(trial.path(from))
        .arg("--out")
        .arg(trial.path(out))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stderr)
}

/// The effect is named on one log; with what was written of it another log of the arm has no gap, and without it has one.
fn assert_carried(arm: Arm, device: &str, effect: &str, further: &[&str]) -> Trial {
    let trial = Trial::new(arm);
    trial.write("log2.csv", &Log::of(arm, 2));
    let (verdict, causes) = told(&trial.answer(device, "log.csv", further));
    assert_eq!(
        (verdict.as_str(), causes[0].as_str()),
        ("named", effect),
        "{causes:?}"
    );
    std::fs::create_dir(trial.path("kept")).unwrap();
    let corrected = trial.path("kept").join("corrected.toml");
    std::fs::copy(trial.path("out").join("corrected.toml"), &corrected).unwrap();
    let again = trial.answer(
        device,
        "log2.csv",
        &["--model", corrected.to_str().unwrap()],
    );
    assert_eq!(told(&again), ("no-gap".to_owned(), Vec::new()), "{again}");
    assert_eq!(
        told(&trial.answer(device, "log2.csv", further)).1[0],
        effect
    );
    trial
}

fn assert_no_gap(trial: &Trial, device: &str) {
    let answer = trial.answer(device, "log2.csv", &[]);
    assert_eq!(
        told(&answer),
        ("no-gap".to_owned(), Vec::new()),
        "{device}: {answer}"
    );
}

#[test]
fn a_payload_is_in_the_masses_of_the_file_the_urdf_and_the_mjcf() {
    let arm = Arm {
        payload_kg: 1.2,
        ..Arm::default()
    };
    let trial = assert_carried(arm, "arm.xml", "payload", &[]);
    let text = std::fs::read_to_string(trial.path("kept").join("corrected.toml")).unwrap();
    let device = Device::from_toml(&text, "corrected.toml").unwrap().device;
    let carried = RigidBodies::of_device(&device).unwrap();
    let own = carried.masses()[1].inertia;
    // the deviations of a sound arm take a part of it: 10 % of 2 kg
    assert!((own.mass_kg - 3.2).abs() < 0.25, "{}", own.mass_kg);
    assert!((own.first_moment_kgm.norm() - 0.66).abs() < 0.05, "{own:?}");
    export(&trial, "mjcf", "arm.xml", "new.xml");
    assert_no_gap(&trial, "new.xml");
    // what the base model adjusts of the other body is little
    let upper = carried.masses()[0].inertia.mass_kg;
    assert!((upper - 3.0).abs() < 0.1, "{upper}");
    let described = carried_by(&trial, "new.xml");
    for (found, wanted) in described.iter().zip(own.parameters()) {
        assert!((found - wanted).abs() < 1e-9, "{found}, {wanted}");
    }

    let trial = assert_carried(arm, "arm.urdf", "payload", &[]);
    export(&trial, "urdf", "arm.urdf", "new.urdf");
    assert_no_gap(&trial, "new.urdf");
}

/// What the last row of a description carries.
fn carried_by(trial: &Trial, name: &str) -> [f64; 10] {
    let device = haptical::Device::load(trial.path(name)).unwrap();
    RigidBodies::of_device(&device.model).unwrap().masses()[1]
        .inertia
        .parameters()
}

#[test]
fn a_heavier_link_is_in_its_mass() {
    let arm = Arm {
        heavier: 0.8,
        ..Arm::default()
    };
    let trial = Trial::new(arm);
    trial.write("log2.csv", &Log::of(arm, 2));
    let answer = trial.answer("arm.xml", "log.csv", &["--without", "payload"]);
    assert_eq!(told(&answer).1[0], "link-inertia", "{answer}");
    // what a link has more of need not be at its centre
    let mass = &answer["causes"][0]["parameters"]["mass_kg"];
    let number = |value: &Value| value.as_f64().unwrap();
    let half = 0.5 * (number(&mass["ci95"][1]) - number(&mass["ci95"][0]));
    assert!(half > 0.5 * number(&mass["value"]), "{mass}");
    std::fs::create_dir(trial.path("kept")).unwrap();
    let corrected = trial.path("kept").join("corrected.toml");
    std::fs::copy(trial.path("out").join("corrected.toml"), &corrected).unwrap();
    let again = trial.answer(
        "arm.xml",
        "log2.csv",
        &["--model", corrected.to_str().unwrap()],
    );
    assert_eq!(told(&again).0, "no-gap", "{again}");
}

#[test]
fn an_armature_is_in_the_file_and_in_the_mjcf() {
    let arm = Arm {
        armature_kgm2: 0.4,
        ..Arm::default()
    };
    let trial = assert_carried(arm, "arm.xml", "armature", &[]);
    let text = std::fs::read_to_string(trial.path("kept").join("corrected.toml")).unwrap();
    let device = Device::from_toml(&text, "corrected.toml").unwrap().device;
    let armature = device.joints[0].armature_kgm2.unwrap();
    assert!((armature - 0.7).abs() < 0.07, "{armature}");
    export(&trial, "mjcf", "arm.xml", "new.xml");
    assert_no_gap(&trial, "new.xml");
}

#[test]
fn a_tilted_mount_is_in_the_direction_of_gravity() {
    let arm = Arm {
        tilt_rad: 0.15,
        ..Arm::default()
    };
    // all axes of this arm lie along one another: a tilt about them is another zero of the first joint, and no log tells the two apart
    let without = ["--without", "joint-offset"];
    let trial = assert_carried(arm, "arm.xml", "gravity-direction", &without);
    let text = std::fs::read_to_string(trial.path("kept").join("corrected.toml")).unwrap();
    let [x, _, z] = Device::from_toml(&text, "corrected.toml")
        .unwrap()
        .device
        .gravity_mps2
        .unwrap();
    // a mount that is turned as a joint turns: its weight leans back
    assert!(((x / z).atan().abs() - 0.15).abs() < 0.02, "{x} {z}");
    let said = export(&trial, "mjcf", "arm.xml", "new.xml");
    assert!(
        said.contains("the direction of gravity is not put in"),
        "{said}"
    );
}

#[test]
fn late_positions_are_a_delay_of_the_file() {
    let trial = Trial::with(|log| {
        // positions are logged 15 ms late
        for own in &mut log.theta_rad {
            let late: Vec<f64> = (0..own.len())
                .map(|row| own[row.saturating_sub(3)])
                .collect();
            *own = late;
        }
    });
    let answer = trial.answer("arm.urdf", "log.csv", &[]);
    assert_eq!(told(&answer).1[0], "encoder-latency", "{answer}");
    let text = std::fs::read_to_string(trial.path("out").join("corrected.toml")).unwrap();
    let device = Device::from_toml(&text, "corrected.toml").unwrap().device;
    for joint in &device.joints {
        let delay_s = joint.torque_delay_s.unwrap();
        assert!((delay_s + 0.015).abs() < 1e-3, "{delay_s}");
    }
}

#[test]
fn what_no_file_holds_is_said() {
    let trial = Trial::with(|log| {
        let angles = log.theta_rad[1].clone().into_iter();
        let torque = log.torque_nm[1].iter_mut();
        torque
            .zip(angles)
            .for_each(|(torque, angle)| *torque += 2.0 * angle);
    });
    let answer = trial.answer("arm.urdf", "log.csv", &[]);
    let (_, causes) = told(&answer);
    assert!(
        causes.contains(&"gravity-spring".to_owned()),
        "{}",
        answer["answer"]
    );
    assert!(
        warns(&answer, &["corrected.toml does not hold gravity-spring"]),
        "{}",
        answer["warnings"]
    );
}
