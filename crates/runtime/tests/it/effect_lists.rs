//! Effects of a device file as the runtime takes them, and random ones.

use std::collections::BTreeMap;

use haptical_effects::joint_origin_m;
use haptical_model::{Device, DeviceChain, DeviceEffect, JointType, Statics};
use haptical_runtime::{CompensatedModel, CoupledModel, Effect, Over, Side, Turnover};
use proptest::prelude::*;

use crate::devices::model;

/// Room for the effects of any device here: with weights and compliances.
pub(crate) const ROOM: usize = 32;

/// A device with its effects.
pub(crate) fn compensated<const JOINTS: usize>(
    device: &Device,
) -> CompensatedModel<JOINTS, JOINTS, ROOM> {
    let own = runtime_effects(device);
    let mut effects = [Effect::None; ROOM];
    effects[..own.len()].copy_from_slice(&own);
    CompensatedModel::new(CoupledModel::of_rows(model::<JOINTS>(device)), effects).unwrap()
}

/// All effects of a device, its weights and compliances among them.
pub(crate) fn runtime_effects(device: &Device) -> Vec<Effect> {
    let mut effects: Vec<Effect> = device
        .effects
        .iter()
        .map(|effect| runtime_effect(device, effect))
        .collect();
    for joint in 0..device.joints.len() {
        let rad_per_nm = device.compliance_rad_per_nm(joint);
        if rad_per_nm != 0.0 {
            effects.push(Effect::JointCompliance { joint, rad_per_nm });
        }
    }
    let at_zero = vec![0.0; device.joints.len()];
    let weights = Statics::new(device).weights(&at_zero).unwrap();
    effects.extend(weights.into_iter().map(|weight| Effect::Weight {
        row: weight.row - 1,
        place_m: weight.place_m.into(),
        force_n: weight.force_n.into(),
    }));
    effects
}

fn runtime_effect(device: &Device, effect: &DeviceEffect) -> Effect {
    let number = |name: &str| effect.numbers.get(name).copied();
    let n = |name: &str| number(name).unwrap_or_else(|| panic!("{}: no {name}", effect.label()));
    let joint = effect.joint.unwrap_or(0);
    let polar = |size: &str| {
        let (sine, cosine) = n("phase_rad").sin_cos();
        (n(size) * cosine, n(size) * sine)
    };
    let own = device.joints.get(joint);
    let ratio = own.map_or(1.0, |joint| joint.transmission_ratio);
    let driven_by = match number("driven_by") {
        Some(1.0) => Side::Hand,
        _ => Side::Motor,
    };
    let harmonic = |periods: f64| {
        let (cosine_rad, sine_rad) = polar("amplitude_rad");
        Effect::Harmonic {
            joint,
            periods,
            cosine_rad,
            sine_rad,
        }
    };
    let from = || n("from_joint") as usize - 1;
    match effect.name.as_str() {
        "capstan-compliance" => Effect::CapstanCompliance {
            joint,
            rad_per_nm: 1.0 / n("stiffness_nm_per_rad"),
        },
        "backlash" => Effect::Backlash {
            joint,
            width_rad: n("width_rad"),
            driven_by,
        },
        "hysteresis" => Effect::Hysteresis {
            joint,
            amplitude_rad: n("amplitude_rad"),
            transition_rad: n("transition_rad"),
            driven_by,
        },
        "capstan-creep" => Effect::CapstanCreep {
            joint,
            creep_per_nm: n("creep_per_nm"),
        },
        "viscous-lag" => Effect::ViscousLag {
            joint,
            delay_s: n("delay_s"),
        },
        "encoder-latency" => Effect::EncoderLatency {
            delay_s: n("delay_s"),
        },
        "drum-eccentricity" => harmonic(1.0),
        "drum-out-of-round" => harmonic(2.0),
        "input-drum-harmonic" => harmonic(n("order") * ratio),
        "device-encoder-eccentricity" => harmonic(ratio),
        "cable-pitch" => Effect::CablePitch {
            joint,
            quadratic_per_rad: n("quadratic_per_rad"),
            cubic_per_rad2: number("cubic_per_rad2").unwrap_or(0.0),
        },
        "ratio-error" => Effect::Coupling {
            joint,
            from: joint,
            gain: -n("ratio_deviation") / ratio,
        },
        "cross-coupling" => Effect::Coupling {
            joint,
            from: from(),
            gain: n("gain"),
        },
        "coupled-backlash" => Effect::CoupledBacklash {
            joint,
            from: from(),
            width_rad: n("width_rad"),
            play_rad: n("play_rad"),
        },
        "joint-drift" => match (number("rad_per_s"), number("time_constant_s")) {
            (None, _) => Effect::WarmDrift {
                joint,
                rad_per_degc: n("rad_per_degc"),
                reference_degc: n("reference_degc"),
            },
            (Some(rate), Some(constant_s)) => Effect::SettlingDrift {
                joint,
                end_rad: rate * n("over_s") / (1.0 - (-n("over_s") / constant_s).exp()),
                time_constant_s: constant_s,
            },
            (Some(rad_per_s), None) => Effect::Drift { joint, rad_per_s },
        },
        "correction" => curve(effect, joint),
        _ => structure_law(device, effect, joint, ratio),
    }
}

/// What a curve is drawn over, with the names of its ends.
const OVER: [(Over, [[&str; 2]; 2]); 4] = [
    (Over::Angle, [["from_rad", "to_rad"], ["from_m", "to_m"]]),
    (Over::Torque, [["from_nm", "to_nm"], ["from_n", "to_n"]]),
    (Over::Temperature, [["from_degc", "to_degc"]; 2]),
    (Over::Time, [["from_s", "to_s"]; 2]),
];

fn curve(effect: &DeviceEffect, joint: usize) -> Effect {
    let number = |name: &str| effect.numbers.get(name).copied();
    let names = OVER
        .iter()
        .flat_map(|(over, all)| all.map(|ends| (*over, ends)));
    let mut found = names.filter_map(|(over, [from, to])| Some((over, number(from)?, number(to)?)));
    let (over, lower, upper) = found.next().unwrap();
    let coefficients = effect.lists.values().next().unwrap().clone().leak();
    Effect::Curve {
        joint,
        over,
        lower,
        upper,
        coefficients,
    }
}

/// A random curve: motions, loads and temperatures go beyond its ends.
fn correction(device: &Device, joint: usize, [a, b, c]: [f64; 3]) -> DeviceEffect {
    let slides = usize::from(device.joints[joint].joint_type == JointType::Prismatic);
    let (over, names) = &OVER[((c + 1.0) * 2.0) as usize % 4];
    let [from, to] = match over {
        Over::Temperature => [19.0 + a, 24.0 + b],
        Over::Time => [0.2 * a, 0.8 + 0.1 * b],
        Over::Angle | Over::Torque => [-0.5 + 0.2 * a, 0.6 + 0.2 * b],
    };
    let mut effect = named(
        "correction",
        Some(joint),
        &[(names[slides][0], from), (names[slides][1], to)],
    );
    let count = 4 + ((a + 1.0) * 8.0) as usize;
    let wave = |index: usize| 2e-3 * (1.7 * index as f64 + 3.0 * b).sin();
    let key = ["coefficients_rad", "coefficients_m"][slides];
    let coefficients = (0..count).map(wave).collect();
    effect.lists.insert(key.to_owned(), coefficients);
    effect
}

/// Effects of the structure.
fn structure_law(device: &Device, effect: &DeviceEffect, joint: usize, ratio: f64) -> Effect {
    let number = |name: &str| effect.numbers.get(name).copied();
    let n = |name: &str| number(name).unwrap_or_else(|| panic!("{}: no {name}", effect.label()));
    let base_m = || {
        let base = DeviceChain::to_row(device, 0);
        base.chain().unwrap().pose(&[]).unwrap().position_m.into()
    };
    let origin_m = || joint_origin_m(device, joint).unwrap().into();
    match effect.name.as_str() {
        "lateral-compliance" => Effect::LateralCompliance {
            joint,
            rad_per_nm: 1.0 / n("stiffness_nm_per_rad"),
            origin_m: origin_m(),
        },
        "base-compliance" => Effect::BaseCompliance {
            rad_per_nm: n("rad_per_nm"),
            base_m: base_m(),
        },
        "tool-compliance" => Effect::ToolCompliance {
            m_per_n: n("m_per_n"),
        },
        // without tilts about the second direction
        "axis-wobble" => {
            let (cosine, sine) = {
                let (sine, cosine) = n("phase_rad").sin_cos();
                (n("amplitude_rad") * cosine, n("amplitude_rad") * sine)
            };
            Effect::AxisWobble {
                joint,
                order: n("order"),
                cosine_rad: [cosine, 0.0],
                sine_rad: [sine, 0.0],
                origin_m: origin_m(),
            }
        }
        "thermal-drift" => Effect::ThermalGrowth {
            per_degc: n("m_per_degc") / n("length_m"),
            reference_degc: n("reference_degc"),
            base_m: base_m(),
        },
        "tool-changed" => Effect::ToolChanged {
            shift_m: ["x_m", "y_m", "z_m"].map(n),
        },
        _ => torque_effect(device, effect, joint, ratio),
    }
}

/// Effects of the drives' torques and the force sensor.
fn torque_effect(device: &Device, effect: &DeviceEffect, joint: usize, ratio: f64) -> Effect {
    let number = |name: &str| effect.numbers.get(name).copied();
    let n = |name: &str| number(name).unwrap_or_else(|| panic!("{}: no {name}", effect.label()));
    let vector = |names: [&str; 3]| names.map(n);
    let slides = device
        .joints
        .get(joint)
        .is_some_and(|joint| joint.joint_type == JointType::Prismatic);
    match effect.name.as_str() {
        "torque-gain" => Effect::TorqueGain {
            joint,
            gain: n("gain"),
        },
        "joint-friction" => {
            let (nm, rate, way) = match slides {
                true => ("n", "n_s_per_m", "m"),
                false => ("nm", "nm_s_per_rad", "rad"),
            };
            let travel = number(&format!("transition_{way}")).map(Turnover::Travel);
            let over = number(&format!("transition_{way}_per_s")).map(Turnover::Rate);
            Effect::Friction {
                joint,
                coulomb_nm: n(&format!("coulomb_{nm}")),
                viscous_nm_s_per_rad: n(&format!("viscous_{rate}")),
                stribeck_nm: n(&format!("stribeck_{nm}")),
                stribeck_rad_per_s: if slides { 0.01 } else { 0.1 },
                side: travel.or(over).unwrap(),
            }
        }
        "motor-cogging" => {
            let size = number("amplitude_nm").unwrap_or_else(|| n("amplitude_n"));
            let (sine, cosine) = n("phase_rad").sin_cos();
            Effect::MotorCogging {
                joint,
                periods: n("order") * ratio,
                cosine_nm: size * cosine,
                sine_nm: size * sine,
            }
        }
        "payload" => Effect::Payload {
            mass_kg: n("mass_kg"),
            gravity_mps2: device.gravity_mps2.unwrap(),
        },
        "force-bias" => Effect::ForceBias {
            bias_n: vector(["x_n", "y_n", "z_n"]),
        },
        "force-gain" => Effect::ForceGain {
            gain: vector(["x", "y", "z"]),
        },
        "force-crosstalk" => Effect::ForceCrosstalk {
            parts: ["xy", "xz", "yx", "yz", "zx", "zy"].map(n),
        },
        "force-hysteresis" => Effect::ForceHysteresis {
            size_n: vector(["x_n", "y_n", "z_n"]),
            transition_n: n("transition_n"),
        },
        other => panic!("{other} is not in the list"),
    }
}

/// An effect by name and numbers.
pub(crate) fn named(name: &str, joint: Option<usize>, numbers: &[(&str, f64)]) -> DeviceEffect {
    let numbers = numbers
        .iter()
        .map(|(name, value)| ((*name).to_owned(), *value));
    DeviceEffect {
        name: name.to_owned(),
        joint,
        numbers: numbers.collect::<BTreeMap<_, _>>(),
        ..DeviceEffect::default()
    }
}

/// What a random effect is made of: a kind, a joint, another joint, sizes within [-1, 1].
pub(crate) type Seed = (usize, usize, usize, [f64; 3]);

pub(crate) fn any_seed() -> impl Strategy<Value = Seed> {
    let part = || -1.0..1.0_f64;
    (
        0..64_usize,
        0..7_usize,
        1..7_usize,
        [part(), part(), part()],
    )
}

/// An effect of a joint's angle.
pub(crate) fn drive_effect(device: &Device, seed: Seed) -> DeviceEffect {
    let (kind, joint, other, [a, b, c]) = seed;
    let joints = device.joints.len();
    let joint = joint % joints;
    let from = (joint + 1 + other % (joints - 1).max(1)) % joints;
    let turns = device.joints[joint].joint_type == JointType::Revolute;
    let has_other = turns && joints > 1;
    let side = ("driven_by", f64::from(u8::from(c > 0.0)));
    let wave = [("amplitude_rad", 2e-3 * a), ("phase_rad", 3.0 * b)];
    let at = |name: &str, numbers: &[(&str, f64)]| named(name, Some(joint), numbers);
    match kind % 18 {
        16 | 17 => correction(device, joint, [a, b, c]),
        0 => at(
            "capstan-compliance",
            &[("stiffness_nm_per_rad", 300.0 + 200.0 * a)],
        ),
        1 | 2 => at("backlash", &[("width_rad", 0.02 * (1.0 + a))]),
        3 => at(
            "hysteresis",
            &[
                ("amplitude_rad", 2e-3 * a.abs()),
                ("transition_rad", 0.1 + 0.09 * b),
                side,
            ],
        ),
        4 => at("capstan-creep", &[("creep_per_nm", 1e-3 * a.abs())]),
        5 => at("viscous-lag", &[("delay_s", 0.01 * a.abs())]),
        6 => named("encoder-latency", None, &[("delay_s", 0.01 * a)]),
        7 if turns => at("drum-eccentricity", &wave),
        8 if turns => at("drum-out-of-round", &wave),
        9 if turns => {
            let order = 3.0 + c.signum();
            at("input-drum-harmonic", &[wave[0], wave[1], ("order", order)])
        }
        10 if turns => at("device-encoder-eccentricity", &wave),
        11 if turns => at(
            "cable-pitch",
            &[
                ("quadratic_per_rad", 0.01 * a),
                ("cubic_per_rad2", 0.01 * b),
            ],
        ),
        12 if has_other => {
            let from = (from + 1) as f64;
            at(
                "cross-coupling",
                &[("gain", 0.05 * a), ("from_joint", from)],
            )
        }
        13 if has_other => {
            let from = (from + 1) as f64;
            let play = 0.2 + 0.1 * b;
            at(
                "coupled-backlash",
                &[
                    ("width_rad", 2e-3 * a),
                    ("play_rad", play),
                    ("from_joint", from),
                ],
            )
        }
        14 if b > 0.3 => at("joint-drift", &[("rad_per_s", 1e-4 * a)]),
        14 if b > -0.3 => at(
            "joint-drift",
            &[
                ("rad_per_s", 1e-4 * a),
                ("time_constant_s", 1.0 + b),
                ("over_s", 3.0),
            ],
        ),
        14 => at(
            "joint-drift",
            &[("rad_per_degc", 1e-3 * a), ("reference_degc", 20.0)],
        ),
        _ => at("ratio-error", &[("ratio_deviation", 0.1 * a)]),
    }
}

/// An effect of the structure.
pub(crate) fn structure_effect(device: &Device, seed: Seed) -> DeviceEffect {
    let (kind, joint, _, [a, b, c]) = seed;
    let joint = joint % device.joints.len();
    let turns = device.joints[joint].joint_type == JointType::Revolute;
    match kind % 6 {
        0 if turns => {
            let stiffness = ("stiffness_nm_per_rad", 300.0 + 200.0 * a);
            named("lateral-compliance", Some(joint), &[stiffness])
        }
        1 => named("base-compliance", None, &[("rad_per_nm", 1e-3 * a.abs())]),
        2 => named("tool-compliance", None, &[("m_per_n", 1e-4 * a.abs())]),
        3 if turns => {
            let order = if c > 0.0 { 2.0 } else { 1.0 };
            let amplitude = ("amplitude_rad", 5e-3 * a.abs());
            let numbers = [amplitude, ("phase_rad", 3.0 * b), ("order", order)];
            named("axis-wobble", Some(joint), &numbers)
        }
        4 => {
            let numbers = [
                ("m_per_degc", 1e-4 * a),
                ("length_m", 0.7),
                ("reference_degc", 20.0),
            ];
            named("thermal-drift", None, &numbers)
        }
        _ => {
            let shift = [("x_m", 0.01 * a), ("y_m", 0.01 * b), ("z_m", 0.01 * c)];
            let length = shift
                .iter()
                .map(|(_, part)| part * part)
                .sum::<f64>()
                .sqrt();
            let numbers = [shift[0], shift[1], shift[2], ("shift_m", length)];
            named("tool-changed", None, &numbers)
        }
    }
}
