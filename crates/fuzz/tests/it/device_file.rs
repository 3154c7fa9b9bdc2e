//! Device files, nominal and identified.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::{Device, Evaluation};

/// Reads it; a device that is accepted is written, read again and evaluated at home.
fn read(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Ok(loaded) = Device::from_toml(text, "device.toml") else {
        return;
    };
    let device = loaded.device;
    let written = device.to_toml(text, "device.toml").unwrap();
    let again = Device::from_toml(&written, "device.toml").unwrap().device;
    assert_eq!(again.links, device.links);
    assert_eq!(again.cables, device.cables);
    let errors = |device: &Device| -> Vec<_> {
        device
            .joints
            .iter()
            .map(|joint| joint.transmission_error.clone())
            .collect()
    };
    assert_eq!(errors(&again), errors(&device));
    for joint in &device.joints {
        if let Ok(error_rad) = joint.error_rad(0.1) {
            assert!(error_rad.is_finite(), "{text}");
        }
    }
    let home = vec![0.0; device.joints.len()];
    let mut evaluation = Evaluation::new(&device);
    if evaluation.move_to(&home).is_ok()
        && let Ok(pose) = evaluation.pose()
    {
        assert!(
            pose.position_m.iter().all(|part| part.is_finite()),
            "{text}"
        );
    }
}

#[test]
fn device_files() {
    let seeds = seeds(&["device-", "sound-device"], &["devices/haptic7.toml"]).unwrap();
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 4000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}

#[test]
fn identified_files() {
    let mut seeds = seeds(&["model-"], &[]).unwrap();
    seeds.push(include_bytes!("identified.toml").to_vec());
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 4000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}
