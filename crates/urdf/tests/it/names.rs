//! Names: those of a file are kept, made-up ones are free, and where one cannot be kept both are said.

use haptical_model::Device;
use haptical_urdf::{BaseAndTip, new_mjcf, new_urdf, ros2_control};
use roxmltree::Document;

use crate::mjcf_read::read;

/// A chain of hinges with these names along changing axes.
fn chain(names: &[&str]) -> String {
    let mut text = String::from("<mujoco><worldbody>");
    for (index, name) in names.iter().enumerate() {
        let axis = ["0 1 0", "0 0 1"][index % 2];
        text.push_str(&format!(
            "<body name=\"b{index}\" pos=\"0.1 0 0\"><joint name=\"{name}\" axis=\"{axis}\"/>\
             <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"
        ));
    }
    text.push_str("<site name=\"tool\" pos=\"0 0 0.1\"/>");
    text + &"</body>".repeat(names.len()) + "</worldbody></mujoco>"
}

/// Names of the joints that move, in the order of the file.
fn moving(text: &str) -> Vec<String> {
    let document = Document::parse(text).unwrap();
    let joints = document.descendants().filter(|entry| {
        entry.has_tag_name("joint")
            && entry.attribute("type") != Some("fixed")
            && entry.attribute("type").is_some()
    });
    joints
        .map(|entry| entry.attribute("name").unwrap().to_owned())
        .collect()
}

#[test]
fn names_of_digits_are_kept() {
    // the second list is what a file without names would count
    for names in [
        ["1", "0", "2", "3"],
        ["1", "2", "3", "4"],
        ["8", "1e3", "inf", "-0"],
    ] {
        let device = read(&chain(&names), BaseAndTip::to("tool")).device;
        // as a command takes it: through the text of a device file
        let file = device.to_new_toml().unwrap();
        let device = Device::from_toml(&file, "finger.toml").unwrap().device;
        let (urdf, said_of_urdf) = new_urdf(&device).unwrap();
        let (mjcf, said_of_mjcf) = new_mjcf(&device).unwrap();
        assert_eq!(moving(&urdf), names);
        assert_eq!(moving(&mjcf), names);
        assert!(
            ros2_control(&device)
                .0
                .contains(&format!("<joint name=\"{}\">", names[2]))
        );
        let said = [said_of_urdf, said_of_mjcf].concat().join("\n");
        assert!(!said.contains("another name"), "{said}");
    }
}

#[test]
fn a_joint_without_a_name_is_called_by_its_number() {
    let row = "[[link]]\na_m = 0.1\nalpha_rad = 0.4\nd_m = 0.0\n";
    let text = format!("{row}{row}{row}[[joint]]\n[[joint]]\nname = \"joint1\"\n");
    let device = Device::from_toml(&text, "arm.toml").unwrap().device;
    let (urdf, said) = new_urdf(&device).unwrap();
    // what is made up gives way
    assert_eq!(moving(&urdf), ["joint1_", "joint1"]);
    assert!(!said.join("\n").contains("another name"), "{said:?}");
}

#[test]
fn a_name_that_cannot_be_kept_is_said_with_the_new_one() {
    let device = read(&chain(&["handle_fixed", "elbow"]), BaseAndTip::to("tool")).device;
    for (text, said) in [new_urdf(&device).unwrap(), new_mjcf(&device).unwrap()] {
        assert_eq!(moving(&text), ["handle_fixed_", "elbow"]);
        let said = said.join("\n");
        assert!(said.contains("`handle_fixed` is `handle_fixed_`"), "{said}");
        assert!(!said.contains("elbow"), "{said}");
    }
}

/// A body or a joint without a name, next to those that have the name which is made up for it.
#[test]
fn made_up_names_are_free() {
    let inertial = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
    let text = |bodies: [&str; 2], joints: [&str; 2]| {
        format!(
            "<mujoco><worldbody><body {}><joint {} axis=\"0 0 1\"/>{inertial}<body {} pos=\"1 0 0\"><joint {}/>{inertial}\
             <site name=\"tip\"/></body></body></worldbody></mujoco>",
            bodies[0], joints[0], bodies[1], joints[1]
        )
    };
    let joints = |text: &str| -> Vec<String> {
        let read = read(text, BaseAndTip::to("tip"));
        read.device
            .joints
            .into_iter()
            .map(|entry| entry.name)
            .collect()
    };
    let (named, none) = (["name=\"a\"", "name=\"b\""], ["", "name=\"\""]);
    assert_eq!(
        joints(&text(named, ["", "name=\"joint1\""])),
        ["joint1_", "joint1"]
    );
    assert_eq!(
        joints(&text(named, ["name=\"joint2\"", ""])),
        ["joint2", "joint2_"]
    );
    assert_eq!(joints(&text(named, none)), ["joint1", "joint2"]);
    for bodies in [["", "name=\"body1\""], ["name=\"body2\"", ""], none] {
        assert_eq!(
            joints(&text(bodies, ["name=\"j\"", "name=\"k\""])),
            ["j", "k"],
            "{bodies:?}"
        );
    }
    // a site before the body that has no name
    let site = text(["", ""], none).replacen("<worldbody>", "<worldbody><site name=\"body1\"/>", 1);
    assert_eq!(joints(&site), ["joint1", "joint2"]);
    // what is between two joints of one body is a link too
    let two = "<mujoco><worldbody><body name=\"a\"><joint name=\"j\"/><joint name=\"k\" axis=\"1 0 0\"/>\
               <body name=\"a/j\"><joint name=\"l\"/></body></body></worldbody></mujoco>";
    assert_eq!(
        joints(&two.replace("</body></body>", "<site name=\"tip\"/></body></body>")),
        ["j", "k", "l"]
    );
}
