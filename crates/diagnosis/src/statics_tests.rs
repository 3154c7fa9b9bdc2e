//! The compliance that a diagnosis names has the column of the one that a calibration fits.

use haptical_calibration::{Channel, Weights, prepare_device};
use haptical_effects::{Context, catalogue, streams};
use haptical_identification::Interrupt;
use haptical_model::{Device, JointCompliance, ParameterId, Recording, holding_torques_nm};
use proptest::prelude::*;

use crate::engine::{Base, BaseProblem};

const ROWS: usize = 12;

/// An arm with masses whose every number is drawn, and postures at which it touches two points.
fn arms() -> impl Strategy<Value = (Device, Recording)> {
    let row = (
        [-0.4..0.4_f64, -1.5..1.5, -0.4..0.4],
        0.1..5.0_f64,
        [-0.2..0.2_f64, -0.2..0.2, -0.2..0.2],
    );
    let rows = prop::collection::vec(row, 4);
    let postures = prop::collection::vec(prop::collection::vec(-1.5..1.5_f64, ROWS), 3);
    let forces = prop::option::of(prop::collection::vec(-20.0..20.0_f64, 3 * ROWS));
    let slides = prop::collection::vec(prop::bool::weighted(0.2), 3);
    (rows, postures, forces, slides, any::<bool>()).prop_map(
        |(rows, joint, forces, slides, modified)| {
            let mut text = String::from("[gravity]\nvector_mps2 = [1.0, -2.0, -9.0]\n");
            if modified {
                text += "[device]\nconvention = \"modified\"\n";
            }
            for ([a, alpha, d], mass, centre) in rows {
                text += &format!(
                    "[[link]]\na_m = {a:?}\nalpha_rad = {alpha:?}\nd_m = {d:?}\nmass_kg = {mass:?}\n\
                     centre_of_mass_m = {centre:?}\n"
                );
            }
            for slides in slides {
                text += "[[joint]]\n";
                text += if slides { "type = \"prismatic\"\n" } else { "" };
            }
            let mut device = Device::from_toml(&text, "drawn.toml").unwrap().device;
            let may_yield = JointCompliance {
                rad_per_nm: 0.0,
                fit: true,
            };
            device.surroundings.compliance = vec![may_yield; 3];
            let axis = |forces: &Vec<f64>, axis: usize| forces[axis * ROWS..][..ROWS].to_vec();
            let recording = Recording {
                line: (2..).take(ROWS).collect(),
                joint,
                output: vec![None; 3],
                torque_nm: vec![None; 3],
                force_n: forces.map(|forces| [0, 1, 2].map(|own| axis(&forces, own))),
                contact: Some((0..ROWS).map(|row| format!("point{}", row % 2)).collect()),
                ..Recording::default()
            };
            (device, recording)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_diagnosed_compliance_has_the_column_of_a_fitted_one((device, recording) in arms()) {
        let device = prepare_device(&device, &recording).unwrap();
        let channels = vec![Channel::Contact];
        let parameters: Vec<ParameterId> =
            (0..3).map(|joint| ParameterId::Compliance { joint }).collect();
        let base = Base {
            device,
            channels: channels.clone(),
            free: (0..3).collect(),
            parameters,
            described: Vec::new(),
            anchor: None,
            unfinished: None,
            interrupt: Interrupt::default(),
        };
        let streams = streams(&base.device, &channels);
        let weights = Weights::stated(&base.device, &channels);
        let problem = BaseProblem::new(&base, &recording, &recording, &streams, &weights).unwrap();
        let matrix = problem.evaluate(&problem.start(), true).unwrap().derivatives.unwrap();
        let context = Context::new(&base.device, &recording, &streams).unwrap();
        let effects = catalogue(&base.device);
        let held = holding_torques_nm(&base.device, &recording).unwrap().unwrap();
        for joint in 0..3 {
            let torque_nm = context.torque_nm[joint].as_ref().unwrap();
            for (own, held) in torque_nm.iter().zip(&held[joint]) {
                // the hand's force is turned into frame (-1) before it is used: rounding alone
                prop_assert!((own - held).abs() < 1e-12 * (1.0 + held.abs()), "{own} for {held}");
            }
            let effect = effects
                .iter()
                .find(|effect| {
                    effect.name() == "joint-compliance" && effect.joint() == Some(joint)
                })
                .unwrap();
            let signal = &effect.derivative(&context, &[0.0], 0.0)[0];
            for stream in 0..streams.len() {
                let fitted = problem.derivative(&matrix, stream, joint).unwrap();
                let named = signal.on(stream).unwrap();
                for (row, named) in named.iter().enumerate() {
                    let scale = 1.0 + named.abs();
                    prop_assert!(
                        (named - fitted(row)).abs() < 1e-9 * scale,
                        "joint {joint}, axis {stream}, row {row}: {named} for {}", fitted(row)
                    );
                }
            }
        }
    }
}
