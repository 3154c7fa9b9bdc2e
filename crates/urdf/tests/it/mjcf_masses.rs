//! Masses that `<compiler>` of an MJCF changes: the expected numbers are those of MuJoCo's compiled models.

use haptical_model::Body;
use haptical_urdf::{BaseAndTip, NewJoints, UrdfDevice, corrected_mjcf};

use crate::mjcf_read::read;

const OWN: &str = "<inertial pos=\".1 0 0\" mass=\"1\" diaginertia=\".01 .02 .03\"/>";

/// A turning body with a child that is fixed to it, and what else is in the world.
fn model(compiler: &str, inertial: &str, child: &str, world: &str) -> String {
    format!(
        "<mujoco><compiler angle=\"radian\" {compiler}/><worldbody><body name=\"a\"><joint name=\"j\" axis=\"0 0 1\"/>{inertial}\
         <site name=\"tip\" pos=\"1 0 0\"/>{child}</body>{world}</worldbody></mujoco>"
    )
}

fn of(text: &str) -> (UrdfDevice, Body) {
    let read = read(text, BaseAndTip::to("tip"));
    let body = read.device.bodies[1].unwrap();
    (read, body)
}

/// Whether mass, centre along x and moments about x, y, z are these.
#[track_caller]
fn assert_body(text: &str, mass_kg: f64, x_m: f64, moments: [f64; 3]) {
    let (read, body) = of(text);
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    let found = body.inertia_kgm2.unwrap();
    let pairs = found[..3].iter().zip(moments);
    let gap = pairs.map(|(entry, wanted)| (entry - wanted).abs());
    let gap = gap.chain([
        (body.mass_kg - mass_kg).abs(),
        (body.centre_of_mass_m[0] - x_m).abs(),
    ]);
    assert!(gap.fold(0.0, f64::max) < 1e-12, "{body:?}");
}

#[test]
fn bounds_are_applied() {
    let one = |compiler| model(compiler, OWN, "", "");
    assert_body(&one("boundmass=\"5\""), 5.0, 0.1, [0.01, 0.02, 0.03]);
    assert_body(&one("boundmass=\"0.5\""), 1.0, 0.1, [0.01, 0.02, 0.03]);
    assert_body(&one("boundmass=\"-5\""), 1.0, 0.1, [0.01, 0.02, 0.03]);
    assert_body(
        &one("boundinertia=\"0.025\""),
        1.0,
        0.1,
        [0.025, 0.025, 0.03],
    );
    // principal moments are bounded: 0.015, 0.025 about axes between x and y
    let full = "<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\".02 .02 .03 .005 0 0\"/>";
    let text = model("boundinertia=\"0.02\"", full, "", "");
    assert_body(&text, 1.0, 0.0, [0.0225, 0.0225, 0.03]);
    assert!((of(&text).1.inertia_kgm2.unwrap()[3] - 0.0025).abs() < 1e-12);
    // a body that states no mass gets one, where MuJoCo puts it
    let empty = "<body name=\"e\" pos=\"1 0 0\"/>";
    assert_body(
        &model("boundmass=\"0.5\"", OWN, empty, ""),
        1.5,
        (0.1 + 0.5 * 2.0) / 1.5,
        [0.01, 0.02 + 1.9 * 1.9 / 3.0, 0.03 + 1.9 * 1.9 / 3.0],
    );
}

#[test]
fn an_inertia_that_no_body_has_is_balanced() {
    let entry =
        |diagonal| format!("<inertial pos=\".1 0 0\" mass=\"1\" diaginertia=\"{diagonal}\"/>");
    let text = |compiler, diagonal| model(compiler, &entry(diagonal), "", "");
    let balance = "balanceinertia=\"true\"";
    assert_body(&text(balance, ".01 .02 .9"), 1.0, 0.1, [0.31; 3]);
    // a plate is a body
    assert_body(&text(balance, ".01 .02 .03"), 1.0, 0.1, [0.01, 0.02, 0.03]);
    let both = "balanceinertia=\"true\" boundinertia=\"0.1\"";
    assert_body(&text(both, ".01 .02 .9"), 1.0, 0.1, [1.1 / 3.0; 3]);
    let both = "balanceinertia=\"true\" boundinertia=\"0.5\"";
    assert_body(&text(both, ".01 .02 .9"), 1.0, 0.1, [0.5, 0.5, 0.9]);
    // and nothing is done where it is not asked for
    let (read, _) = of(&text("balanceinertia=\"false\"", ".01 .02 .9"));
    assert!(read.warnings[0].contains("no body has the inertia of link `a`"));
}

#[test]
fn a_total_mass_scales_all_masses_and_inertias() {
    let other = "<body name=\"o\"><freejoint/><inertial pos=\"0 0 0\" mass=\"3\" diaginertia=\"1 1 1\"/></body>";
    let read = |compiler| {
        let (read, body) = of(&model(compiler, OWN, "", other));
        assert_eq!(read.warnings.len(), 1, "{:?}", read.warnings);
        let inertia = body.inertia_kgm2.unwrap();
        [
            body.mass_kg,
            inertia[0],
            inertia[2],
            body.centre_of_mass_m[0],
        ]
    };
    let close = |found: [f64; 4], wanted: [f64; 4]| {
        let gaps = found.iter().zip(wanted).map(|(a, b)| (a - b).abs());
        assert!(gaps.fold(0.0, f64::max) < 1e-12, "{found:?}");
    };
    close(read("settotalmass=\"20\""), [5.0, 0.05, 0.15, 0.1]);
    close(
        read("settotalmass=\"10\" boundmass=\"2\""),
        [4.0, 0.02, 0.06, 0.1],
    );
    for none in ["settotalmass=\"0\"", "settotalmass=\"-3\""] {
        close(read(none), [1.0, 0.01, 0.03, 0.1]);
    }
}

#[test]
fn a_total_mass_with_masses_of_geoms_is_named() {
    for child in [
        "<body name=\"g\"><geom size=\"0.1\"/></body>",
        "<replicate count=\"2\"><body><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/></body></replicate>",
    ] {
        let (read, body) = of(&model("settotalmass=\"20\"", OWN, child, ""));
        let said = read.warnings.join("\n");
        assert!(said.contains("settotalmass=\"20\" is left out"), "{said}");
        assert!(
            said.contains("masses are not those that MuJoCo simulates"),
            "{said}"
        );
        assert_eq!(body.mass_kg, 1.0);
    }
}

/// What MuJoCo's compiler would change once more is not written into the user's file.
#[test]
fn masses_are_not_put_into_a_file_whose_compiler_changes_them() {
    let text = model("settotalmass=\"20\"", OWN, "", "");
    let mut device = of(&text).0.device;
    assert_eq!(device.bodies[1].unwrap().mass_kg, 20.0);
    if let Some(body) = &mut device.bodies[1] {
        body.mass_kg = 22.0;
    }
    let ends = BaseAndTip::to("tip");
    let corrected = corrected_mjcf(&text, "robot.xml", ends, &device, NewJoints::Listed).unwrap();
    assert_eq!(corrected.text, text);
    let said = corrected.warnings.join("\n");
    assert!(
        said.contains("masses are not put in, because settotalmass of <compiler>"),
        "{said}"
    );
}

/// MuJoCo adds what holds the weight of a body; a drive's torque then lacks it, but for one that is told to give it.
#[test]
fn gravcomp_is_named_by_its_bodies() {
    let said = |joint: &str, gravcomp: [&str; 2], option: &str| {
        let text = format!(
            "<mujoco>{option}<worldbody><body name=\"a\" gravcomp=\"{}\"><joint name=\"j\" axis=\"1 0 0\" {joint}/>{OWN}\
             <body name=\"b\" gravcomp=\"{}\"><joint name=\"k\" axis=\"1 0 0\" {joint}/>{OWN}<site name=\"tip\"/></body></body>\
             </worldbody></mujoco>",
            gravcomp[0], gravcomp[1]
        );
        read(&text, BaseAndTip::to("tip")).warnings.join("\n")
    };
    let both = said("", ["1", "0.5"], "");
    assert!(both.contains("gravcomp of `a`, `b` is left out"), "{both}");
    assert!(both.contains("lack gravity's part"), "{both}");
    let one = said("", ["0", "1"], "");
    assert!(one.contains("gravcomp of `b` is left out"), "{one}");
    assert_eq!(said("", ["0", "0.0"], ""), "");
    assert_eq!(said("actuatorgravcomp=\"true\"", ["1", "1"], ""), "");
    assert_eq!(said("", ["1", "1"], "<option gravity=\"0 0 0\"/>"), "");
    let class = "<default><joint actuatorgravcomp=\"true\"/></default>";
    assert_eq!(said("", ["1", "1"], class), "");
}

/// Springs, tendons, a fluid and ties load joints in MuJoCo, and are in no device: each is named, and an element of numbers 0 is not.
#[test]
fn forces_that_are_in_no_device_are_named() {
    let said = |joint: &str, rest: &str| {
        let text = format!(
            "<mujoco>{rest}<worldbody><body name=\"a\"><joint name=\"j\" axis=\"1 0 0\" {joint}/>{OWN}\
             <body name=\"b\"><joint name=\"k\" axis=\"1 0 0\"/>{OWN}<site name=\"tip\"/></body></body></worldbody></mujoco>"
        );
        read(&text, BaseAndTip::to("tip")).warnings.join("\n")
    };
    for (joint, rest, expected) in [
        ("stiffness=\"3\"", "", "stiffness of `j` is left out"),
        ("stiffness=\"0 0 3\"", "", "stiffness of `j` is left out"),
        (
            "springdamper=\"0.1 1\"",
            "",
            "springdamper of `j` is left out",
        ),
        (
            "damping=\"1 2\"",
            "",
            "damping of `j` is its first number alone",
        ),
        (
            "",
            "<option density=\"1.2\" viscosity=\"0\"/>",
            "the density of <option> is left out",
        ),
        (
            "",
            "<equality><connect body1=\"b\" anchor=\"0 0 0\"/></equality>",
            "<connect> of <equality> is left out",
        ),
        (
            "",
            "<default><tendon stiffness=\"2\"/></default><tendon><fixed name=\"t\"><joint joint=\"j\" coef=\"1\"/></fixed></tendon>",
            "stiffness of tendons is left out, which loads joints in a simulator: `t`",
        ),
        (
            "",
            "<actuator><motor name=\"m\" joint=\"k\" armature=\"0.1\"/></actuator>",
            "armature of actuators is left out, which loads joints in a simulator: `m`",
        ),
    ] {
        let found = said(joint, rest);
        assert!(found.contains(expected), "{expected}: {found}");
    }
    for (joint, rest) in [
        ("stiffness=\"0\" damping=\"1\"", "<option density=\"0\"/>"),
        (
            "",
            "<equality><connect body1=\"b\" anchor=\"0 0 0\" active=\"false\"/></equality>",
        ),
        (
            "",
            "<tendon><fixed><joint joint=\"j\" coef=\"1\"/></fixed></tendon><actuator><motor joint=\"k\"/></actuator>",
        ),
    ] {
        assert_eq!(said(joint, rest), "");
    }
}
