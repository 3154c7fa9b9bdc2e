//! Rig files: the sensors of one laboratory put around any device.

use haptical_model::{Device, DeviceFileError};

const ARM: &str = "\
# the arm of the second floor
[device]
name = \"arm\"

[[link]]
a_m = 0.1
alpha_rad = 0.0
d_m = 0.0

[[link]]
a_m = 0.2 # measured
alpha_rad = 0.0
d_m = 0.0

[[joint]]

[cable_encoder]
distance_sd_m = 1e-4

[[cable]]
anchor_m = [1.0, 0.0, 0.0]

[gravity]
vector_mps2 = [0.0, 0.0, -9.81]
";

fn merged(rig: &str) -> Result<(Device, String, Vec<String>), DeviceFileError> {
    let (text, warnings) = Device::with_rig(ARM, "arm.toml", rig, "rig.toml")?;
    Ok((Device::from_toml(&text, "arm.toml")?.device, text, warnings))
}

#[test]
fn what_the_rig_has_replaces_and_the_rest_stays() {
    let rig = "[tracker]\nbase = \"unknown\"\nposition_sd_m = 2e-4\n\
        [[contact_pair]]\na = \"p\"\nb = \"q\"\ndistance_m = 0.2\nsd_m = 1e-5\n";
    let (device, text, warnings) = merged(rig).unwrap();
    assert!(warnings.is_empty());
    let tracker = device.tracker.unwrap();
    assert_eq!(
        (tracker.base_known, tracker.position_sd_m),
        (false, Some(2e-4))
    );
    assert_eq!(device.contact_pairs.len(), 1);
    assert_eq!(device.cables.len(), 2, "the rig says nothing of cables");
    assert_eq!(device.gravity_mps2, Some([0.0, 0.0, -9.81]));
    assert!(
        text.contains("# the arm of the second floor") && text.contains("a_m = 0.2 # measured")
    );
}

#[test]
fn a_rig_with_cables_replaces_all_of_them() {
    let (device, _, _) = merged("[cable_encoder]\ndistance_sd_m = 3e-4\n").unwrap();
    assert_eq!(device.cables.len(), 1);
    assert_eq!(device.cables[0].distance_sd_m, Some(3e-4));
    let (device, _, _) = merged("[gravity]\nvector_mps2 = [0.0, -9.81, 0.0]\n").unwrap();
    assert_eq!(
        (device.cables.len(), device.gravity_mps2),
        (2, Some([0.0, -9.81, 0.0]))
    );
    assert_eq!(
        merged("").unwrap().0,
        Device::from_toml(ARM, "arm.toml").unwrap().device
    );
}

#[test]
fn faults_are_told_at_their_place_in_the_rig_file() {
    for (rig, said) in [
        (
            "[gravity]\n",
            "rig.toml:1:1: [gravity] has no `vector_mps2`",
        ),
        (
            "[tracker]\nbase = 1\n",
            "rig.toml:2:8: [tracker]: `base` is integer",
        ),
        ("\n[[joint]]\n", "a rig file holds sensors alone"),
        ("[tracker\n", "rig.toml:1:9: "),
    ] {
        let error = merged(rig).unwrap_err().to_string();
        assert!(error.contains(said), "{rig}: {error}");
    }
    let (_, _, warnings) = merged("[trackers]\nbase = \"known\"\n").unwrap();
    assert!(
        warnings[0].contains("did you mean `tracker`?"),
        "{warnings:?}"
    );
}

/// Tables of a list are together, whichever file they come from, so that a person finds them.
#[test]
fn the_sections_of_both_files_stand_in_groups() {
    let device = "[device]\nname = \"arm\"\n\n[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n\n\
        [[link]]\na_m = 0.1\nalpha_rad = 0.0\nd_m = 0.0\n\n[[contact_pair]]\na = \"p\"\nb = \"q\"\n\
        distance_m = 0.1\nsd_m = 1e-4\n\n[[joint]]\nname = \"turn\"\n\n[gravity]\nvector_mps2 = [0.0, 0.0, -9.8]\n";
    let rig = "[contact]\nsd_m = 5e-4\n# on the plate\n[[contact_pair]]\na = \"s0\"\nb = \"s1\"\n\
        distance_m = 0.2\nsd_m = 1e-4\n[[contact_pair]]\na = \"s0\"\nb = \"s2\"\ndistance_m = 0.3\n\
        sd_m = 1e-4\n\n[[contact_pair]]\na = \"s1\"\nb = \"s2\"\ndistance_m = 0.4\nsd_m = 1e-4\n";
    let (text, warnings) = Device::with_rig(device, "device.toml", rig, "rig.toml").unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    let headings: Vec<&str> = text.lines().filter(|line| line.starts_with('[')).collect();
    let expected = [
        "[device]",
        "[[link]]",
        "[[link]]",
        "[[contact_pair]]",
        "[[contact_pair]]",
        "[[contact_pair]]",
        "[[joint]]",
        "[gravity]",
        "[contact]",
    ];
    assert_eq!(headings, expected, "{text}");
    assert!(
        text.contains("\n\n# on the plate\n[[contact_pair]]"),
        "{text}"
    );
    assert_eq!(
        text.matches("\n\n[").count() + 1,
        headings.len() - 1,
        "{text}"
    );
    let merged = Device::from_toml(&text, "merged.toml").unwrap().device;
    assert_eq!(merged.contact_pairs.len(), 3);
    assert_eq!(merged.surroundings.contact_sd_m, Some(5e-4));
}
