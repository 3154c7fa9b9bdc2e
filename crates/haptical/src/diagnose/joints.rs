//! The names that a robot description gives to the joints that a diagnosis calls by number.

use std::collections::BTreeSet;

use haptical_diagnosis::Diagnosis;

use crate::device::{Device, is_description};

/// `joint 4 is elbow` for each joint of the causes and of the place; none for a device that is no robot description.
pub(super) fn named(device: &Device, diagnosis: &Diagnosis) -> Option<String> {
    if !is_description(&device.source().path) {
        return None;
    }
    let joints = device.model.joints.iter();
    let names: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
    said(&names, diagnosis)
}

fn said(names: &[&str], diagnosis: &Diagnosis) -> Option<String> {
    let causes = diagnosis.causes.iter().filter_map(|cause| cause.joint);
    let place = diagnosis.place.iter().filter_map(|place| place.joint);
    let numbers: BTreeSet<usize> = causes.chain(place).collect();
    let named = numbers.into_iter().filter_map(|number| {
        let name = names.get(number.checked_sub(1)?)?;
        // a name that says no more than the number
        let is_number = [
            format!("joint{number}"),
            format!("joint_{number}"),
            number.to_string(),
        ];
        let says_more = !name.is_empty() && is_number.iter().all(|own| own != name);
        says_more.then(|| format!("joint {number} is {name}"))
    });
    let named: Vec<String> = named.collect();
    (!named.is_empty()).then(|| named.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::{named as example, no_gap};

    #[test]
    fn joints_of_the_answer_have_their_names() {
        let names = ["shoulder_pan", "shoulder_lift", "elbow"];
        let mut diagnosis = example();
        assert_eq!(
            said(&names, &diagnosis).unwrap(),
            "joint 2 is shoulder_lift"
        );
        let mut second = diagnosis.causes[0].clone();
        second.joint = Some(1);
        diagnosis.causes.push(second);
        let wanted = "joint 1 is shoulder_pan, joint 2 is shoulder_lift";
        assert_eq!(said(&names, &diagnosis).unwrap(), wanted);
        assert_eq!(
            said(&names[..1], &diagnosis).unwrap(),
            "joint 1 is shoulder_pan"
        );
        assert!(said(&names, &no_gap()).is_none());
        let plain = ["joint1", "joint2"];
        assert!(said(&plain, &diagnosis).is_none());
    }
}
