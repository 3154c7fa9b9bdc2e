//! Names and parameters of the catalogue that scripts rely on (docs/diagnosis.md, Catalogue).

use haptical_model::JointType;

use super::rig::rigs;
use crate::{catalogue, names};

/// Effects with the parameters that gap.json gives for them. Those that the scan does not
/// test, and terms of the base model, have none here.
const STABLE: [(&str, &[&str]); 82] = [
    ("capstan-compliance", &["stiffness_nm_per_rad"]),
    ("capstan-creep", &["creep_per_nm"]),
    ("capstan-slip", &["slip_rad", "time_s"]),
    ("backlash", &["width_rad"]),
    ("hysteresis", &["amplitude_rad", "transition_rad"]),
    ("viscous-lag", &["delay_s"]),
    ("drum-out-of-round", &["amplitude_rad", "phase_rad"]),
    ("cable-pitch", &["quadratic_per_rad"]),
    ("encoder-count-loss", &["counts", "time_s"]),
    (
        "input-drum-harmonic",
        &["amplitude_rad", "phase_rad", "order"],
    ),
    (
        "device-encoder-eccentricity",
        &["amplitude_rad", "phase_rad"],
    ),
    ("cross-coupling", &["gain", "from_joint"]),
    ("coupled-backlash", &["width_rad", "play_rad", "from_joint"]),
    ("joint-drift", &[]),
    ("ratio-error", &[]),
    ("drum-eccentricity", &[]),
    ("parallelogram-error", &[]),
    ("joint-offset", &[]),
    ("link-geometry", &[]),
    (
        "external-encoder-eccentricity",
        &["amplitude_rad", "phase_rad"],
    ),
    ("external-encoder-windup", &["amplitude_rad"]),
    ("external-encoder-count-loss", &["counts", "time_s"]),
    ("external-encoder-drift", &["rad_per_s"]),
    ("external-encoder-latency", &["delay_s"]),
    ("noise-level", &[]),
    ("encoder-latency", &["delay_s"]),
    ("cable-scale", &["scale"]),
    ("cable-stretch", &["scale"]),
    ("cable-zero-offset", &["offset_m"]),
    ("cable-sag", &["weight_n_per_m_over_tension"]),
    ("cable-twist", &["twist_m_per_rad2"]),
    ("cable-exit-geometry", &["radius_m"]),
    ("cable-drum-eccentricity", &["amplitude_m", "phase_rad"]),
    ("cable-hysteresis", &["amplitude_m"]),
    ("thermal-drift", &["m_per_degc"]),
    ("cable-drift", &["m_per_s"]),
    ("cable-count-loss", &["counts", "time_s"]),
    ("cable-latency", &["delay_s"]),
    ("joint-compliance", &["stiffness_nm_per_rad"]),
    ("axis-wobble", &["amplitude_rad", "phase_rad", "order"]),
    ("base-compliance", &["rad_per_nm"]),
    ("lateral-compliance", &["stiffness_nm_per_rad"]),
    ("tool-compliance", &["m_per_n"]),
    ("tool-changed", &["shift_m"]),
    ("tracker-latency", &["delay_s"]),
    ("tracker-scale", &["scale"]),
    ("zero-changed", &["offset_rad"]),
    ("tracker-moved", &["shift_m", "tilt_rad"]),
    ("periodic-disturbance", &[]),
    ("dropouts", &[]),
    ("outliers", &[]),
    ("force-bias", &[]),
    ("force-gain", &[]),
    ("force-crosstalk", &[]),
    ("force-hysteresis", &[]),
    ("joint-friction", &[]),
    ("motor-cogging", &[]),
    ("torque-gain", &[]),
    ("unbalanced-gravity", &[]),
    ("payload", &[]),
    ("grip-force", &[]),
    ("stribeck-friction", &[]),
    ("load-friction", &[]),
    ("friction-asymmetry", &[]),
    ("friction-drift", &[]),
    ("presliding", &[]),
    ("torque-offset", &[]),
    ("torque-saturation", &[]),
    ("torque-latency", &[]),
    ("contact", &[]),
    ("gravity-spring", &[]),
    ("armature", &[]),
    ("link-inertia", &[]),
    ("gravity-direction", &[]),
    ("sampling", &[]),
    ("command-latency", &[]),
    ("servo-stiffness", &[]),
    ("dead-zone", &[]),
    ("servo-gain", &[]),
    ("speed-saturation", &[]),
    ("magnetic-saturation", &[]),
    ("torque-constant-drift", &[]),
];

#[test]
fn every_stable_name_is_in_the_catalogue_and_no_other() {
    let mut stable: Vec<&str> = STABLE.iter().map(|(name, _)| *name).collect();
    let mut have = names();
    stable.sort_unstable();
    have.sort_unstable();
    assert_eq!(have, stable);
}

#[test]
fn every_effect_at_a_place_has_a_name_and_its_stable_parameters() {
    for rig in rigs() {
        for effect in catalogue(&rig.device) {
            let entry = STABLE.iter().find(|(name, _)| *name == effect.name());
            let (_, parameters) = entry.unwrap_or_else(|| panic!("{}", effect.name()));
            let have: Vec<&str> = effect
                .spec()
                .parameters
                .iter()
                .map(|spec| spec.name)
                .collect();
            let slides = effect
                .joint()
                .is_some_and(|joint| rig.device.joints[joint].joint_type == JointType::Prismatic);
            if effect.name() == "zero-changed" && slides {
                assert_eq!(have, ["offset_m"]);
                continue;
            }
            // a finer one may be added behind
            assert!(have.starts_with(parameters), "{}: {have:?}", effect.label());
            assert!(!have.is_empty(), "{}", effect.label());
        }
    }
}

#[test]
fn every_kind_of_effect_stands_at_some_place() {
    let [seven, _] = rigs();
    let at_places: Vec<&str> = catalogue(&seven.device)
        .iter()
        .map(|effect| effect.name())
        .collect();
    let scanned = STABLE
        .iter()
        .filter(|(_, parameters)| !parameters.is_empty());
    for (name, _) in scanned {
        assert!(at_places.contains(name), "{name}");
    }
}

#[test]
fn a_drift_in_time_and_one_with_temperature_have_parameters_of_their_own() {
    let [seven, _] = rigs();
    let effects = catalogue(&seven.device);
    let drifts = effects
        .iter()
        .filter(|effect| effect.name() == "joint-drift" && effect.joint() == Some(0));
    let mut parameters: Vec<&str> = drifts
        .map(|effect| effect.spec().parameters[0].name)
        .collect();
    parameters.sort_unstable();
    assert_eq!(parameters, ["rad_per_degc", "rad_per_s"]);
}
