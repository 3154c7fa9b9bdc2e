//! URDF robot descriptions.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::{Device, DeviceChain};
use haptical_urdf::{
    BaseAndTip, UrdfDevice, chain_ends, corrected_urdf, device_from_urdf, new_urdf,
};

/// Reads it, from the root and back from its tip; a chain that is accepted has finite poses, and its device file and its
/// URDF are read again.
fn read(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Some(read) = read_between(text, BaseAndTip::default()) else {
        return;
    };
    let back = read_between(text, BaseAndTip::between(&read.tip, &read.base));
    assert_eq!(back.unwrap().device.links, read.device.links, "{text}");
    let ends = chain_ends(text, "robot.urdf", Some(&read.tip)).unwrap();
    if let Some(end) = ends.first() {
        let across = read_between(text, BaseAndTip::between(&read.tip, &end.tip));
        assert_eq!(across.unwrap().device.joints.len(), end.joints, "{text}");
    }
    if let Ok((new, _)) = new_urdf(&read.device) {
        device_from_urdf(&new, "new.urdf", BaseAndTip::default()).unwrap();
    }
}

fn read_between(text: &str, ends: BaseAndTip<'_>) -> Option<UrdfDevice> {
    let read = device_from_urdf(text, "robot.urdf", ends).ok()?;
    let device = &read.device;
    if let Ok(pose) = DeviceChain::new(device).pose(&vec![0.1; device.joints.len()]) {
        let numbers = pose.position_m.iter().chain(pose.rotation.iter());
        assert!(
            numbers.into_iter().all(|number| number.is_finite()),
            "{text}"
        );
    }
    if let Ok(file) = device.to_new_toml() {
        let again = Device::from_toml(&file, "again.toml").unwrap().device;
        assert_eq!(&again, device, "{text}");
    }
    // the same device corrects nothing, and what is written is read
    if let Ok(corrected) = corrected_urdf(text, "robot.urdf", ends, device) {
        let named = BaseAndTip::between(&corrected.base, &corrected.tip);
        let again = device_from_urdf(&corrected.text, "corrected.urdf", named);
        assert!(again.is_ok(), "{text}\n{}\n{again:?}", corrected.text);
    }
    Some(read)
}

#[test]
fn robot_descriptions() {
    let seeds = seeds(&["urdf-"], &["urdf/arm.urdf", "urdf/linkage.urdf"]).unwrap();
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}
