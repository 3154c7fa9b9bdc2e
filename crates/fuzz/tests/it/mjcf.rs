//! MJCF robot descriptions.

use haptical_fuzz::{Edit, bounded, mutated, seeds};
use haptical_model::{Device, DeviceChain};
use haptical_urdf::{
    BaseAndTip, NewJoints, UrdfDevice, chain_ends, corrected_mjcf, device_from_mjcf, new_mjcf,
};

/// Reads it, from the world and back from its tip; a chain that is accepted has finite poses, and its device file and its
/// MJCF are read again.
fn read(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Some(read) = read_between(text, BaseAndTip::default()) else {
        return;
    };
    let back = read_between(text, BaseAndTip::between(&read.tip, &read.base));
    assert_eq!(back.unwrap().device.links, read.device.links, "{text}");
    chain_ends(text, "robot.xml", Some(&read.tip)).unwrap();
    if let Ok((new, _)) = new_mjcf(&read.device) {
        let odd = odd_number(&new);
        assert!(odd.is_none(), "{odd:?}\n{text}\n{new}");
        let again = device_from_mjcf(&new, "new.xml", BaseAndTip::to("handle"));
        assert!(again.is_ok(), "{text}\n{new}\n{again:?}");
    }
}

/// A number of this text that is not finite; joints are called what their device calls them, also `inf`.
fn odd_number(xml: &str) -> Option<&str> {
    let names = ["name", "joint", "actuator", "site", "body1", "body2"];
    let mut parts = xml.split('"');
    while let (Some(before), Some(value)) = (parts.next(), parts.next()) {
        let is_name = names
            .iter()
            .any(|name| before.ends_with(&format!(" {name}=")));
        let mut numbers = value.split_whitespace();
        let odd = numbers.find(|word| word.parse().is_ok_and(|number: f64| !number.is_finite()));
        if odd.is_some() && !is_name {
            return odd;
        }
    }
    None
}

fn read_between(text: &str, ends: BaseAndTip<'_>) -> Option<UrdfDevice> {
    let read = device_from_mjcf(text, "robot.xml", ends).ok()?;
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
    // what is written of the same device is read
    if let Ok(corrected) = corrected_mjcf(text, "robot.xml", ends, device, NewJoints::PutIn) {
        let named = BaseAndTip::between(&corrected.base, &corrected.tip);
        let again = device_from_mjcf(&corrected.text, "corrected.xml", named);
        assert!(again.is_ok(), "{text}\n{}\n{again:?}", corrected.text);
    }
    Some(read)
}

#[test]
fn mujoco_descriptions() {
    let seeds = seeds(&["mjcf-"], &["mjcf/arm.xml", "mjcf/robot.xml"]).unwrap();
    seeds.iter().for_each(|seed| read(seed));
    bounded!(bolero::check!(), 2000)
        .with_type::<(u16, Vec<Edit>)>()
        .for_each(|(pick, edits)| read(&mutated(&seeds, *pick, edits)));
}
