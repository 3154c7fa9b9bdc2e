//! Sizes of numbers that show another unit: every question names what it is of, and its line.

use haptical_urdf::{BaseAndTip, device_from_urdf};

use crate::mjcf_read::read;

/// An arm with usual numbers in places of their own.
const ARM: &str = "<robot name=\"r\"><link name=\"a\"/>\n<link name=\"b\"><inertial><mass value=\"1\"/>\n<origin xyz=\"0.1 0 0\" \
    rpy=\"0 0 -6.2832\"/><inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\"/></inertial></link>\n<link name=\"c\"/>\n\
    <joint name=\"j1\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>\n<origin xyz=\"0 0 0.3\" rpy=\"0 0 1.57\"/>\
    <limit lower=\"-3.2\" upper=\"12.6\"/></joint>\n<joint name=\"j2\" type=\"prismatic\"><parent link=\"b\"/><child link=\"c\"/>\
    <limit lower=\"0\" upper=\"2.5\"/></joint></robot>";

/// What is said of the arm where a part of it is another one.
fn with(usual: &str, odd: &str) -> Vec<String> {
    assert_eq!(ARM.matches(usual).count(), 1, "{usual}");
    let text = ARM.replace(usual, odd);
    let read = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("c"));
    read.unwrap().warnings
}

#[test]
fn usual_numbers_ask_nothing() {
    let none: [String; 0] = [];
    assert_eq!(with("0.3", "0.4"), none);
    // exporters write such limits where there is none
    for limits in [
        "lower=\"-1000\" upper=\"1000\"",
        "lower=\"-1e9\" upper=\"1e9\"",
        "lower=\"-inf\" upper=\"inf\"",
    ] {
        assert_eq!(with("lower=\"-3.2\" upper=\"12.6\"", limits), none);
        assert_eq!(with("lower=\"0\" upper=\"2.5\"", limits), none);
    }
    // small parts whose inertias somebody rounded up or down
    for (mass, moment) in [
        ("0.001", "1e-9"),
        ("20", "2"),
        ("0.05", "1e-3"),
        ("1", "1e-6"),
    ] {
        let inertia = format!("ixx=\"{moment}\" iyy=\"{moment}\" izz=\"{moment}\"");
        let text = ARM.replace("<mass value=\"1\"/>", &format!("<mass value=\"{mass}\"/>"));
        let text = text.replace("ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\"", &inertia);
        let read = device_from_urdf(&text, "arm.urdf", BaseAndTip::to("c"));
        assert_eq!(read.unwrap().warnings, none, "{mass} {moment}");
    }
}

#[test]
fn each_odd_size_of_a_urdf_is_asked_about_at_its_line() {
    for (usual, odd, said) in [
        (
            "0 0 0.3",
            "0 -300 0",
            "arm.urdf:6:1: joint `j1`: xyz is -300 m; if it is in millimetres, write -0.3",
        ),
        (
            "0.1 0 0",
            "100 0 0",
            "arm.urdf:3:1: link `b`: xyz is 100 m; if it is in millimetres, write 0.1",
        ),
        (
            "0 0 1.57",
            "0 0 90",
            "arm.urdf:6:1: joint `j1`: rpy is 90 rad; if it is in degrees, write 1.570796",
        ),
        (
            "0 0 -6.2832",
            "-180 0 0",
            "arm.urdf:3:1: link `b`: rpy is -180 rad; if it is in degrees, write -3.141593",
        ),
        (
            "-3.2",
            "-180",
            "arm.urdf:5:1: joint `j1`: the lower limit is -180 rad, which is taken as no limit; if it is in degrees",
        ),
        (
            "12.6",
            "360",
            "arm.urdf:5:1: joint `j1`: the upper limit is 360 rad, which is taken as no limit; if it is in degrees",
        ),
        (
            "2.5",
            "250",
            "arm.urdf:7:1: joint `j2`: the upper limit is 250 m; if it is in millimetres, write 0.25",
        ),
        (
            "value=\"1\"",
            "value=\"1000\"",
            "arm.urdf:2:1: link `b` has 1000 kg with a radius of gyration of 3.16 mm",
        ),
        (
            "ixx=\"0.01\" iyy=\"0.01\"",
            "ixx=\"9000\" iyy=\"9000\"",
            "arm.urdf:2:1: link `b` has 1 kg with a radius of gyration of 77 m",
        ),
    ] {
        let found = with(usual, odd);
        assert_eq!(
            found.iter().filter(|entry| entry.starts_with(said)).count(),
            1,
            "{found:?}"
        );
        // an inertia that no body has is said, too
        assert!(found.len() == 1 || said.contains("77 m"), "{found:?}");
    }
}

#[test]
fn sizes_of_an_mjcf_are_asked_about() {
    let said = |compiler: &str, body: &str, joint: &str| {
        let text = format!(
            "<mujoco><compiler {compiler}/><worldbody>\n<body name=\"b\" {body}>\n<joint name=\"j\" {joint}/>\n\
             <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\".01 .01 .01\"/><body name=\"c\">\n<joint name=\"k\" {joint}/>\
             <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\".01 .01 .01\"/><site name=\"tip\"/></body></body></worldbody></mujoco>"
        );
        read(&text, BaseAndTip::to("tip")).warnings
    };
    let radian = "angle=\"radian\"";
    for (found, wanted) in [
        (
            said("", "pos=\"0 0 300\"", ""),
            "robot.xml:2:1: body `b`: pos is 300 m; if it is in millimetres",
        ),
        (
            said(radian, "euler=\"0 90 0\"", ""),
            "robot.xml:2:1: body `b`: euler is 90 rad; if it is in degrees",
        ),
        (
            said(radian, "axisangle=\"0 1 0 90\"", ""),
            "robot.xml:2:1: body `b`: the angle is 90 rad",
        ),
        (
            said("", "", "pos=\"0 50 0\""),
            "robot.xml:3:1: joint `j`: pos is 50 m",
        ),
        (
            said(radian, "", "range=\"-90 90\""),
            "robot.xml:3:1: joint `j`: the lower limit is -90 rad",
        ),
        (
            said("", "", "range=\"-3.14 3.14\""),
            "robot.xml: the ranges of all hinges are within 6.3 degrees",
        ),
    ] {
        assert!(
            found.first().is_some_and(|entry| entry.starts_with(wanted)),
            "{found:?}"
        );
    }
    for (compiler, body, joint) in [
        ("", "euler=\"0 90 0\"", "range=\"-90 90\""),
        ("", "axisangle=\"0 1 0 90\"", "range=\"-0.5 0.5\""),
        (radian, "euler=\"0 1.57 0\"", "range=\"-3.14 3.14\""),
        ("", "", "type=\"slide\" range=\"-3.14 3.14\""),
    ] {
        let found = said(compiler, body, joint);
        assert!(found.is_empty(), "{found:?}");
    }
}

#[test]
fn a_file_that_is_all_in_millimetres_does_not_flood() {
    let body = "<body pos=\"0 0 100\"><joint/>";
    let text = format!(
        "<mujoco><worldbody>{}<site name=\"tip\"/>{}</worldbody></mujoco>",
        body.repeat(20),
        "</body>".repeat(20)
    );
    let said = read(&text, BaseAndTip::to("tip")).warnings;
    assert_eq!(said.len(), 9, "{said:?}");
    assert_eq!(said[8], "robot.xml: 12 more numbers of such sizes");
}
