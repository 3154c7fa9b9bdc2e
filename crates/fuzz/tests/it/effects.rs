//! Effects of a simulation.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::Device;
use haptical_simulator::{Effects, HandMotion, MotionSettings, simulate_motion};

/// Reads it; effects that are accepted are simulated for some rows, which are finite or refused.
fn read(device: &Device, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Ok(effects) = Effects::from_toml(text, "effects.toml") else {
        return;
    };
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: 6.0,
            rate_hz: 5.0,
            rests: 0,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let Ok(mut simulation) = simulate_motion(device, &effects, &settings, 1) else {
        return;
    };
    let mut rows = simulation.no_rows();
    if simulation.fill(&mut rows, 40).is_ok() {
        assert!(
            rows.joint
                .iter()
                .flatten()
                .all(|reading| reading.is_finite()),
            "{text}"
        );
        let outputs = rows.output.iter().flatten().flatten();
        assert!(
            outputs
                .chain(rows.cable_m.iter().flatten().flatten())
                .all(|r| !r.is_nan()),
            "{text}"
        );
    }
}

#[test]
fn effect_files() {
    let device = seeds(&["sound-device"], &[]).unwrap().remove(0);
    let device = Device::from_toml(std::str::from_utf8(&device).unwrap(), "device.toml").unwrap();
    let seeds = seeds(&["effects-", "sound-effects"], &["effects/example.toml"]).unwrap();
    seeds.iter().for_each(|seed| read(&device.device, seed));
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&device.device, &mutated(&seeds, *pick, edits)));
}
