//! Names of joints in a new description: the device's own, all different.

use haptical_model::Device;

/// A name for each row's joint: the device's own for a joint's own row, `joint1` for a joint without one; all different.
pub(crate) fn joint_names(device: &Device, rows: usize) -> Vec<String> {
    let is_of_a_hand = |name: &str| {
        let of_hand = name.strip_suffix("_fixed");
        of_hand.is_some_and(|entry| {
            entry == "handle" || device.hands.iter().any(|hand| hand.name == entry)
        })
    };
    let stated: Vec<Option<&str>> = (1..=rows).map(|row| stated(device, row)).collect();
    let mut names: Vec<String> = Vec::new();
    for (index, entry) in stated.iter().enumerate() {
        let mut name = match entry {
            Some(entry) => plain(entry),
            None => made_up(device, index + 1),
        };
        // what is made up gives way to what a joint behind it is called
        let is_behind =
            |name: &str| entry.is_none() && stated.iter().flatten().any(|other| *other == name);
        while names.contains(&name) || is_of_a_hand(&name) || is_behind(&name) {
            name.push('_');
        }
        names.push(name);
    }
    names
}

/// What is said of joints that are not called as the device calls them.
pub(crate) fn said_of_renamed(device: &Device, names: &[String]) -> Option<String> {
    let pairs = names.iter().enumerate().filter_map(|(index, name)| {
        let entry = stated(device, index + 1).filter(|entry| entry != name)?;
        Some(format!("`{}` is `{name}`", plain(entry)))
    });
    let pairs: Vec<String> = pairs.collect();
    (!pairs.is_empty()).then(|| {
        format!(
            "joints with another name, because theirs is taken or has characters that XML does not hold: {}",
            pairs.join(", ")
        )
    })
}

/// The name that a row's joint has itself.
fn stated(device: &Device, row: usize) -> Option<&str> {
    let joint = device.drive(row)?.joint;
    let entry = device.joints.get(joint)?;
    let is_own = device.own_row(joint) == Some(row) && entry.has_own_name();
    Some(entry.name.as_str()).filter(|name| is_own && !name.is_empty())
}

fn made_up(device: &Device, row: usize) -> String {
    let joint = device.drive(row).map_or(0, |drive| drive.joint);
    match device.own_row(joint) == Some(row) {
        true => format!("joint{}", joint + 1),
        false => format!("row{row}"),
    }
}

/// Without what the value of an attribute does not hold.
fn plain(name: &str) -> String {
    let characters = name.chars();
    characters
        .map(|entry| if entry.is_control() { ' ' } else { entry })
        .collect()
}
