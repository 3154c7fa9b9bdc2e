//! Which joint of a data set is which of a device.

use std::path::Path;

use haptical_model::Device;

use crate::failure::Failure;

/// The data set's joints that are written, by their places in its lists, and what is said of them.
pub(super) struct Order {
    pub(super) places: Vec<usize>,
    pub(super) warning: Option<String>,
}

/// The joints that the user lists; else the device's by their names; else all in the order of the data set.
pub(super) fn order(
    names: &[String],
    listed: &[String],
    device: Option<(&Device, &Path)>,
) -> Result<Order, Failure> {
    let all = || (0..names.len()).collect::<Vec<usize>>();
    if !listed.is_empty() {
        let place = |wanted: &String| {
            let mut own = names.iter().position(|name| is_same(name, wanted));
            own = own.or_else(|| {
                wanted
                    .parse()
                    .ok()
                    .filter(|n| (1..=names.len()).contains(n))
                    .map(|n: usize| n - 1)
            });
            own.ok_or_else(|| {
                let known = names.join(", ");
                Failure::arguments(format!(
                    "--joints names `{wanted}`, which the data set has not; it has {known}"
                ))
            })
        };
        let places = listed
            .iter()
            .map(place)
            .collect::<Result<Vec<usize>, Failure>>()?;
        return Ok(Order {
            warning: left_out(names, &places),
            places,
        });
    }
    let Some((device, path)) = device else {
        return Ok(Order {
            places: all(),
            warning: None,
        });
    };
    let place =
        |joint: &haptical_model::Joint| names.iter().position(|name| is_same(name, &joint.name));
    let by_name: Option<Vec<usize>> = device.joints.iter().map(place).collect();
    match by_name {
        Some(places) => Ok(Order {
            warning: left_out(names, &places),
            places,
        }),
        None if device.joints.len() == names.len() => {
            let pairs = device.joints.iter().zip(names);
            let pairs: Vec<String> = pairs
                .map(|(joint, name)| format!("{name} is {}", joint.name))
                .collect();
            let warning = format!(
                "the device's joints have other names than the data set's and are taken in their order: {}; give --joints if that is wrong",
                pairs.join(", ")
            );
            Ok(Order {
                places: all(),
                warning: Some(warning),
            })
        }
        None => {
            let of_device: Vec<&str> = device
                .joints
                .iter()
                .map(|joint| joint.name.as_str())
                .collect();
            let said = format!(
                "the device has {} joints ({}), the data set {} ({}): list the data set's that are the device's, in its order, with --joints",
                of_device.len(),
                of_device.join(", "),
                names.len(),
                names.join(", ")
            );
            Err(Failure::of_file("other-device", said, path))
        }
    }
}

fn left_out(names: &[String], places: &[usize]) -> Option<String> {
    let others = names
        .iter()
        .enumerate()
        .filter(|(place, _)| !places.contains(place));
    let others: Vec<&str> = others.map(|(_, name)| name.as_str()).collect();
    (!others.is_empty()).then(|| {
        format!(
            "joints of the data set that are left out: {}",
            others.join(", ")
        )
    })
}

/// Whether two names are one but for case, signs and the words that say that it is a joint.
fn is_same(a: &str, b: &str) -> bool {
    let plain = |name: &str| {
        let name = name.to_ascii_lowercase();
        let parts = name.split(|letter: char| !letter.is_ascii_alphanumeric());
        let parts =
            parts.filter(|part| !["joint", "pos", "position", "motor", "main"].contains(part));
        parts.collect::<String>()
    };
    let [a, b] = [a, b].map(plain);
    !a.is_empty() && a == b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(all: &[&str]) -> Vec<String> {
        all.iter().map(|&name| name.to_owned()).collect()
    }

    fn device(joints: &[&str]) -> Device {
        let joints: Vec<String> = joints
            .iter()
            .map(|name| format!("[[joint]]\nname = \"{name}\"\n"))
            .collect();
        Device::from_toml(&joints.concat(), "d.toml")
            .unwrap()
            .device
    }

    #[test]
    fn joints_are_ordered_by_the_device_and_others_left_out() {
        let set = names(&["shoulder_pan", "elbow_flex", "gripper", "wrist_roll"]);
        let arm = device(&["Wrist_Roll_joint", "elbow-flex"]);
        let found = order(&set, &[], Some((&arm, Path::new("d.toml")))).unwrap();
        assert_eq!(found.places, [3, 1]);
        assert!(
            found
                .warning
                .unwrap()
                .ends_with("left out: shoulder_pan, gripper")
        );
        let listed = order(&set, &names(&["elbow_flex", "1"]), None).unwrap();
        assert_eq!(listed.places, [1, 0]);
        assert!(order(&set, &names(&["elbow"]), None).is_err());
    }

    #[test]
    fn other_names_are_taken_in_order_where_the_numbers_agree_and_refused_else() {
        let set = names(&["1", "2"]);
        let found = order(&set, &[], Some((&device(&["a", "b"]), Path::new("d.toml")))).unwrap();
        assert_eq!(found.places, [0, 1]);
        assert!(found.warning.unwrap().contains("1 is a, 2 is b"));
        assert!(order(&set, &[], Some((&device(&["a"]), Path::new("d.toml")))).is_err());
    }
}
