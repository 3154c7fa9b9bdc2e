//! Forward prediction: logs of devices whose every number is known, with and without their friction.

use std::f64::consts::PI;

use haptical::data::Cells;
use haptical::simulator::{ControllerFile, ForwardModel};
use haptical::{Device, Drive, ErrorKind, Forward, Log, forward};

/// Two links under gravity.
const ARM: &str = "\
[[link]]
a_m = 0.0
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.4
alpha_rad = 1.1
d_m = 0.05
mass_kg = 2.0
centre_of_mass_m = [0.2, 0.02, 0.01]
inertia_kgm2 = [0.004, 0.03, 0.031, 0.0005, 0.0, 0.001]
[[link]]
a_m = 0.3
alpha_rad = 0.0
d_m = 0.0
mass_kg = 1.0
centre_of_mass_m = [0.15, 0.0, 0.03]
inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]
[[joint]]
armature_kgm2 = 0.2
[[joint]]
armature_kgm2 = 0.1
[gravity]
vector_mps2 = [0.0, 0.0, -9.81]
";

const FRICTION: &str = "
[[effect]]
name = \"joint-friction\"
joint = 1
coulomb_nm = 1.5
viscous_nm_s_per_rad = 0.8
stribeck_nm = 0.3
transition_rad_per_s = 0.02
[[effect]]
name = \"joint-friction\"
joint = 2
coulomb_nm = 0.6
viscous_nm_s_per_rad = 0.3
stribeck_nm = 0.0
transition_rad_per_s = 0.02
";

fn device(text: &str) -> Device {
    Device::from_toml(text, "arm.toml").expect("a device")
}

fn log(device: &Device, columns: &[(String, Vec<f64>)]) -> Log {
    let cells: Vec<_> = columns
        .iter()
        .map(|(name, values)| (name.as_str(), Cells::Numbers(values)))
        .collect();
    Log::from_columns(&cells, "log.csv", device).expect("a log")
}

/// Eight seconds of the true arm at 200 rows a second, under torques that hold it up about where it is.
fn by_torques(truth: &Device) -> Log {
    let model = ForwardModel::of_device(&truth.model, (0, 1)).expect("a model");
    let (mut work, mut state) = (model.work(), model.start(&[0.1, -0.4], &[0.0, 0.0]));
    let names = [
        "t_s",
        "theta1_rad",
        "theta2_rad",
        "torque1_nm",
        "torque2_nm",
    ];
    let mut columns: Vec<(String, Vec<f64>)> = names
        .iter()
        .map(|name| ((*name).to_owned(), Vec::new()))
        .collect();
    let mut rigid = model.bodies().work();
    let mut before: Option<[f64; 2]> = None;
    for row in 0..1600 {
        let time_s = f64::from(row) * 0.005;
        let mut hold = [0.0; 2];
        model
            .bodies()
            .bias(&state.theta, &[0.0; 2], &mut rigid, &mut hold)
            .expect("torques");
        let torque = [0, 1].map(|joint| {
            let goal = 0.5 * (2.0 * PI * (0.4 + 0.3 * joint as f64) * time_s).sin();
            hold[joint] + 20.0 * (goal - state.theta[joint]) - 4.0 * state.dtheta[joint]
        });
        // as a prediction has them: in straight lines from row to row; the first step has its own torque at both ends
        if let Some(from) = before {
            let step = [&from[..], &torque[..]];
            model
                .run(&mut state, &mut work, 0.005, step)
                .expect("a step");
        }
        before = Some(torque);
        let values = [time_s, state.theta[0], state.theta[1], torque[0], torque[1]];
        for ((_, column), value) in columns.iter_mut().zip(values) {
            column.push(value);
        }
    }
    log(truth, &columns)
}

fn rms(told: &Forward, device: usize, horizon: usize) -> [f64; 2] {
    let joints = &told.devices[device].drifts[horizon].joints;
    [joints[0].rms, joints[1].rms]
}

#[test]
fn friction_of_the_truth_takes_the_drift_away() {
    let (nominal, truth) = (device(ARM), device(&format!("{ARM}{FRICTION}")));
    let log = by_torques(&truth);
    let devices = [("before", &nominal), ("after", &truth)];
    let told = forward(&devices, &log, Drive::Torques).expect("a prediction");
    assert!(told.warnings.is_empty(), "{:?}", told.warnings);
    for horizon in 0..3 {
        let (before, after) = (rms(&told, 0, horizon), rms(&told, 1, horizon));
        for (before, after) in before.iter().zip(after) {
            assert!(after < 0.05 * before, "horizon {horizon}: {before} {after}");
        }
    }
    // what is left is the log's velocity by local cubics
    let after = rms(&told, 1, 0);
    assert!(after.iter().all(|rms| *rms < 3e-4), "{after:?}");
    // half the step moves it by less still
    let halved = &told.devices[1].halved_step_moves;
    assert!(halved.iter().all(|moved| *moved < 1e-4), "{halved:?}");
    let csv = told.csv(&nominal, &log);
    assert_eq!(csv.lines().count(), 1601);
    let head = "t_s,run,start,theta1_rad,theta2_rad,before_theta1_rad,before_theta2_rad,after_theta1_rad,after_theta2_rad";
    assert_eq!(csv.lines().next(), Some(head));
    let starts = csv
        .lines()
        .skip(1)
        .filter(|line| line.split(',').nth(2) == Some("1"));
    assert_eq!(starts.count(), 8);
    assert!(told.page(&nominal, &log).expect("a page").contains("<svg"));
}

/// A drive without gravity that goes to a command: J theta'' + kd theta' + kp theta = kp c, from rest at 0.
#[test]
fn a_controller_moves_as_its_closed_form() {
    let text = "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.4\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 1.0\n\
        inertia_kgm2 = [0.15, 0.15, 0.3, 0.0, 0.0, 0.0]\n[[joint]]\narmature_kgm2 = 0.2\n[gravity]\nvector_mps2 = [0.0, 0.0, -9.81]\n";
    let device = device(text);
    let (inertia, kp, kd, command) = (0.5_f64, 50.0_f64, 4.0_f64, 0.3);
    let (omega, damping) = ((kp / inertia).sqrt(), kd / (2.0 * (kp * inertia).sqrt()));
    let turning = omega * (1.0 - damping * damping).sqrt();
    let theta = |t: f64| {
        let decay = (-damping * omega * t).exp();
        command
            * (1.0
                - decay * ((turning * t).cos() + damping * omega / turning * (turning * t).sin()))
    };
    let times: Vec<f64> = (0..400).map(|row| f64::from(row) * 0.005).collect();
    let columns = [
        ("t_s".to_owned(), times.clone()),
        (
            "theta1_rad".to_owned(),
            times.iter().map(|t| theta(*t)).collect(),
        ),
        ("command1_rad".to_owned(), vec![command; times.len()]),
    ];
    let log = log(&device, &columns);
    let file = |rate_hz: f64| {
        let text = format!(
            "kp_nm_per_rad = [{kp}]\nkd_nm_s_per_rad = [{kd}]\ngravity_compensation = false\nrate_hz = {rate_hz}\n"
        );
        ControllerFile::from_toml(&text, "controller.toml", 1).expect("a controller")
    };
    let drift = |rate_hz: f64| {
        let controller = file(rate_hz);
        let told = forward(&[("device", &device)], &log, Drive::Controller(&controller));
        let told = told.expect("a prediction");
        told.devices[0].drifts[4].joints[0].rms
    };
    // torques that stay for a tick are half a tick late
    let (slow, fast) = (drift(500.0), drift(5000.0));
    assert!(fast < 2e-4, "{fast}");
    assert!((5.0..15.0).contains(&(slow / fast)), "{slow} {fast}");
}

#[test]
fn what_a_prediction_lacks_is_named() {
    let arm = device(ARM);
    let log = by_torques(&arm);
    let bare = device(&ARM.replace("mass_kg = 1.0\n", "").replace(
        "inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]\n",
        "",
    ));
    let error = forward(&[("device", &bare)], &log, Drive::Torques).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::BadInput);
    assert!(
        error.to_string().contains("no mass of row 2 (`mass_kg`)"),
        "{error}"
    );
    let no_torques = [
        ("t_s".to_owned(), vec![0.0, 0.01, 0.02]),
        ("theta1_rad".to_owned(), vec![0.0; 3]),
        ("theta2_rad".to_owned(), vec![0.0; 3]),
    ];
    let cells: Vec<_> = no_torques
        .iter()
        .map(|(name, values)| (name.as_str(), Cells::Numbers(values)))
        .collect();
    let still = Log::from_columns(&cells, "log.csv", &arm).unwrap();
    let error = forward(&[("device", &arm)], &still, Drive::Torques).unwrap_err();
    assert!(
        error.to_string().contains("no column `torque1_nm`"),
        "{error}"
    );
    let light = device(&ARM.replace("armature_kgm2 = 0.2\n", ""));
    let told = forward(&[("device", &light)], &log, Drive::Torques).unwrap();
    assert!(
        told.warnings[0].contains("no armature_kgm2"),
        "{:?}",
        told.warnings
    );
}
