//! URDF robot descriptions.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::{Device, DeviceChain};
use haptical_urdf::{BaseAndTip, corrected_urdf, device_from_urdf, new_urdf};

/// Reads it; a chain that is accepted has finite poses, and its device file and its URDF are read again.
fn read(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Ok(read) = device_from_urdf(text, "robot.urdf", BaseAndTip::default()) else {
        return;
    };
    let device = read.device;
    if let Ok(pose) = DeviceChain::new(&device).pose(&vec![0.1; device.joints.len()]) {
        let numbers = pose.position_m.iter().chain(pose.rotation.iter());
        assert!(
            numbers.into_iter().all(|number| number.is_finite()),
            "{text}"
        );
    }
    if let Ok(file) = device.to_new_toml() {
        let again = Device::from_toml(&file, "again.toml").unwrap().device;
        assert_eq!(again, device, "{text}");
    }
    // the same device corrects nothing, and what is written is read
    if let Ok(corrected) = corrected_urdf(text, "robot.urdf", BaseAndTip::default(), &device) {
        let again = device_from_urdf(
            &corrected.text,
            "corrected.urdf",
            BaseAndTip::to(&corrected.tip),
        );
        assert!(again.is_ok(), "{text}\n{}\n{again:?}", corrected.text);
    }
    if let Ok((new, _)) = new_urdf(&device) {
        device_from_urdf(&new, "new.urdf", BaseAndTip::default()).unwrap();
    }
}

#[test]
fn robot_descriptions() {
    let seeds = seeds(&["urdf-"], &["urdf/arm.urdf", "urdf/linkage.urdf"]).unwrap();
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}
