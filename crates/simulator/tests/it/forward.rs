//! A device that moves under torques: closed forms, energy, the order of the steps, friction that stops.

use std::f64::consts::{FRAC_PI_2, PI};

use haptical_simulator::model::{Device, RigidBodies};
use haptical_simulator::{ForwardModel, ForwardState};

/// A point of 2 kg at 0.5 m that hangs along -y, with effects; theta counts from there.
fn pendulum(effects: &str) -> Device {
    let text = format!(
        "[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n[[link]]\na_m = 0.5\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 2.0\n\
         centre_of_mass_m = [0.5, 0.0, 0.0]\ninertia_kgm2 = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n\
         [[joint]]\nhome_rad = {home}\n[gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n{effects}",
        home = -FRAC_PI_2
    );
    Device::from_toml(&text, "pendulum.toml")
        .expect("a number")
        .device
}

/// K(k) by the arithmetic-geometric mean: the period of a pendulum from rest at an amplitude is 4 K(sin(a/2)) / omega.
fn period_s(amplitude: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (amplitude / 2.0).cos());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let omega = (9.81_f64 / 0.5).sqrt();
    2.0 * PI / (a * omega)
}

#[test]
fn a_pendulum_comes_back_after_its_period() {
    let model = ForwardModel::of_device(&pendulum(""), (0, 1)).expect("a number");
    let mut work = model.work();
    for amplitude in [0.2, 1.5, 2.8] {
        let mut state = model.start(&[amplitude], &[0.0]);
        model
            .run(&mut state, &mut work, period_s(amplitude), [&[0.0], &[0.0]])
            .expect("a number");
        assert!((state.theta[0] - amplitude).abs() < 1e-5, "{amplitude}");
        assert!(
            state.dtheta[0].abs() < 2e-4,
            "{amplitude} {:?}",
            state.dtheta
        );
    }
}

/// Two links that hang on each other with other axes, and something to brake them.
fn double(effects: &str) -> Device {
    let text = format!(
        "[[link]]\na_m = 0.0\nalpha_rad = 0.3\nd_m = 0.2\n\
         [[link]]\na_m = 0.4\nalpha_rad = 1.1\nd_m = 0.05\nmass_kg = 2.0\ncentre_of_mass_m = [0.2, 0.02, 0.01]\n\
         inertia_kgm2 = [0.004, 0.03, 0.031, 0.0005, 0.0, 0.001]\n\
         [[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\nmass_kg = 1.0\ncentre_of_mass_m = [0.15, 0.0, 0.03]\n\
         inertia_kgm2 = [0.002, 0.015, 0.016, 0.0, 0.0002, 0.0]\n\
         [[joint]]\narmature_kgm2 = 0.02\n[[joint]]\n[gravity]\nvector_mps2 = [0.0, -9.81, -1.0]\n{effects}"
    );
    Device::from_toml(&text, "double.toml")
        .expect("a number")
        .device
}

fn energy_j(bodies: &RigidBodies, theta: &[f64], dtheta: &[f64]) -> f64 {
    use haptical_simulator::model::dynamics::Scratch;
    let tree = bodies.tree().expect("a number");
    let mut scratch = [Scratch::default(); 2];
    tree.kinetic_energy_j(theta, dtheta, &mut scratch)
        .expect("a number")
        + tree
            .potential_energy_j(theta, &mut scratch)
            .expect("a number")
}

#[test]
fn what_swings_freely_keeps_its_energy() {
    let model = ForwardModel::of_device(&double(""), (0, 1)).expect("a number");
    let (mut work, mut state) = (model.work(), model.start(&[0.4, 0.9], &[1.0, -2.0]));
    let before = energy_j(model.bodies(), &state.theta, &state.dtheta);
    model
        .run(&mut state, &mut work, 5.0, [&[0.0; 2], &[0.0; 2]])
        .expect("a number");
    let after = energy_j(model.bodies(), &state.theta, &state.dtheta);
    // of some 10 J that go to and fro
    assert!((after - before).abs() < 1e-3, "{before} {after}");
}

/// Errors of three steps, each half of the one before: of the second order they go down to a quarter.
fn errors(device: &Device, longest_s: f64, seconds: f64) -> [f64; 3] {
    let model = ForwardModel::of_device(device, (0, 1)).expect("a number");
    let mut work = model.work();
    let mut end = |longest_s: f64| {
        let mut state = model.start(&[0.4, 0.9], &[1.0, -2.0]);
        let torques: [&[f64]; 2] = [&[0.0, 1.0], &[3.0, -1.0]];
        model
            .run_by(&mut state, &mut work, (seconds, longest_s), torques)
            .expect("a number");
        state.theta[1]
    };
    let exact = end(longest_s / 64.0);
    [1.0, 2.0, 4.0].map(|part| (end(longest_s / part) - exact).abs())
}

#[test]
fn steps_are_of_the_second_order_with_friction_too() {
    let friction = "[[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 0.5\nviscous_nm_s_per_rad = 0.2\n\
        transition_rad_per_s = 0.3\n\
        [[effect]]\nname = \"motor-cogging\"\njoint = 2\namplitude_nm = 0.2\nphase_rad = 0.4\norder = 6\n";
    for (device, longest_s) in [(double(""), 4e-3), (double(friction), 4e-3)] {
        let [whole, half, quarter] = errors(&device, longest_s, 0.5);
        for ratio in [whole / half, half / quarter] {
            assert!((3.4..4.6).contains(&ratio), "{ratio}");
        }
    }
}

/// Coulomb's friction alone: rate falls by F t / J, and stays at rest; with steps far beyond the time constant of its
/// transition too.
#[test]
fn friction_stops_a_joint_and_holds_it() {
    let text = |effects: &str| {
        let effects = effects.to_owned();
        let device = pendulum(&effects);
        Device {
            gravity_mps2: Some([0.0; 3]),
            ..device
        }
    };
    let (inertia, friction) = (0.5, 2.0);
    for transition in [1e-2, 1e-3, 1e-4] {
        let own = format!(
            "[[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 2.0\ntransition_rad_per_s = {transition}\n"
        );
        let model = ForwardModel::of_device(&text(&own), (0, 1)).expect("a number");
        let mut work = model.work();
        let mut state = model.start(&[0.0], &[1.0]);
        let mut run = |state: &mut ForwardState, seconds: f64, torque: f64| {
            let torque = [torque];
            model
                .run(state, &mut work, seconds, [&torque, &torque])
                .expect("a number");
        };
        run(&mut state, 0.2, 0.0);
        assert!((state.dtheta[0] - (1.0 - friction / inertia * 0.2)).abs() < 1e-9);
        // comes to rest after v^2 / (2 F / J), but for the last transition
        run(&mut state, 3.0, 0.0);
        assert!(
            state.dtheta[0].abs() < 1e-9,
            "{transition} {:?}",
            state.dtheta
        );
        let far = transition * transition + 1e-6;
        assert!(
            (state.theta[0] - 0.125).abs() < far,
            "{transition} {:?}",
            state.theta
        );
        // a torque below friction moves it by next to nothing: v = w atanh(1/2)
        run(&mut state, 1.0, 1.0);
        assert!((state.dtheta[0] - transition * 0.5_f64.atanh()).abs() < 1e-9);
    }
}

/// Dahl's friction holds like a spring of F / transition before it slides, and comes back when it is let go.
#[test]
fn friction_over_a_travel_is_a_spring_at_first() {
    let own = "[[effect]]\nname = \"joint-friction\"\njoint = 1\ncoulomb_nm = 2.0\ntransition_rad = 0.01\n\
        viscous_nm_s_per_rad = 5.0\n";
    let mut device = pendulum(own);
    device.gravity_mps2 = Some([0.0; 3]);
    let model = ForwardModel::of_device(&device, (0, 2)).expect("a number");
    let (mut work, mut state) = (model.work(), model.start(&[0.0], &[0.0]));
    model
        .run(&mut state, &mut work, 3.0, [&[0.0], &[1.0]])
        .expect("a number");
    // where 2 (1 - exp(-x / 0.01)) is 1, but for what viscous friction takes
    let expected = 0.01 * 2.0_f64.ln();
    assert!(
        (state.theta[0] - expected).abs() < 2e-4,
        "{:?}",
        state.theta
    );
}

#[test]
fn a_payload_and_a_gain_are_taken_and_others_are_named() {
    let own = "[[effect]]\nname = \"payload\"\nmass_kg = 1.0\nfrom_run = 2\n\
        [[effect]]\nname = \"torque-gain\"\njoint = 1\ngain = 0.1\n\
        [[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 0.001\n";
    let device = pendulum(own);
    let before = ForwardModel::of_device(&device, (0, 2)).expect("a number");
    let after = ForwardModel::of_device(&device, (1, 2)).expect("a number");
    let inertia = |model: &ForwardModel| {
        let (mut work, mut mass) = (model.bodies().work(), [0.0]);
        model
            .bodies()
            .mass_matrix(&[0.0], &mut work, &mut mass)
            .expect("a number");
        mass[0]
    };
    assert!((inertia(&before) - 0.5).abs() < 1e-12);
    assert!((inertia(&after) - 0.75).abs() < 1e-12);
    // a log of one run was recorded later
    let later = ForwardModel::of_device(&device, (0, 1)).expect("a model");
    assert!((inertia(&later) - 0.75).abs() < 1e-12);
    assert!((before.given(0, 1.0) - 0.9).abs() < 1e-15);
    // a payload of another place is no point mass at the handle
    let mut other = device.clone();
    let moment = ("moment_x_kg_m".to_owned(), 0.2);
    other.effects[0].numbers.extend([moment]);
    let other = ForwardModel::of_device(&other, (1, 2)).expect("a model");
    assert!((inertia(&other) - 0.5).abs() < 1e-12 && other.left_out().len() == 2);
    assert_eq!(before.left_out().len(), 1, "{:?}", before.left_out());
    assert!(before.left_out()[0].contains("backlash"));
}
