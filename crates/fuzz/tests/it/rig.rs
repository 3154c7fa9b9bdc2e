//! Rig files, put into a device file.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::Device;

/// A rig that is accepted gives a device file that is read, and whose device can be written anew.
fn read(device: &str, bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Ok((merged, _)) = Device::with_rig(device, "device.toml", text, "rig.toml") else {
        return;
    };
    // the two may contradict each other, and the reader says so
    let Ok(read) = Device::from_toml(&merged, "device.toml") else {
        return;
    };
    if let Ok(file) = read.device.to_new_toml() {
        Device::from_toml(&file, "again.toml").unwrap();
    }
}

#[test]
fn rig_files() {
    let device = seeds(&["sound-device"], &[]).unwrap().remove(0);
    let device = String::from_utf8(device).unwrap();
    let others = [
        "rigs/camera.toml",
        "rigs/homing.toml",
        "rigs/planes.toml",
        "rigs/two-cables.toml",
    ];
    let seeds = seeds(&["rig-"], &others).unwrap();
    seeds.iter().for_each(|seed| read(&device, seed));
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&device, &mutated(&seeds, *pick, edits)));
}
