//! Texts that are no chain: each is refused with its place, none panics or takes long.

use std::fmt::Write;

use haptical_urdf::{BaseAndTip, UrdfError, device_from_urdf};
use proptest::prelude::*;

use crate::support::fixture;

fn refusal(text: &str) -> String {
    device_from_urdf(text, "robot.urdf", BaseAndTip::default())
        .unwrap_err()
        .to_string()
}

/// A robot of one joint, with parts replaced.
fn robot(from: &str, to: &str) -> String {
    let text = "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n\
        <joint name=\"j\" type=\"revolute\">\n<parent link=\"a\"/>\n<child link=\"b\"/>\n\
        <origin xyz=\"1 2 3\" rpy=\"0 0 0\"/>\n<axis xyz=\"0 0 1\"/>\n</joint>\n</robot>";
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

#[test]
fn the_reason_and_the_place_are_said() {
    for (from, to, said) in [
        (
            "xyz=\"1 2 3\"",
            "xyz=\"1 2\"",
            "robot.urdf:7:1: joint `j`: xyz is \"1 2\", but three finite numbers",
        ),
        (
            "xyz=\"1 2 3\"",
            "xyz=\"1 2 NaN\"",
            "robot.urdf:7:1: joint `j`: xyz is \"1 2 NaN\"",
        ),
        (
            "rpy=\"0 0 0\"",
            "rpy=\"0 inf 0\"",
            "robot.urdf:7:1: joint `j`: rpy is \"0 inf 0\"",
        ),
        ("1 2 3", "1e300 2 3", "robot.urdf:7:1: joint `j`: xyz"),
        ("1 2 3", "${x} 2 3", "expand it first"),
        (
            "0 0 1",
            "0 0 0",
            "robot.urdf:8:1: joint `j`: the axis is [0.0, 0.0, 0.0], but it must have a direction",
        ),
        (
            "revolute",
            "hinge",
            "robot.urdf:4:1: joint `j`: the type is \"hinge\", but revolute, continuous",
        ),
        (
            "revolute",
            "planar",
            "robot.urdf:4:1: joint `j` is floating or planar",
        ),
        (
            "revolute",
            "fixed",
            "robot.urdf: no joint moves: there is no chain to calibrate",
        ),
        (
            " type=\"revolute\"",
            "",
            "robot.urdf:4:1: joint `j` has no type",
        ),
        (
            "<child link=\"b\"/>",
            "",
            "robot.urdf:4:1: joint `j` has no child",
        ),
        (
            "<child link=\"b\"/>",
            "<child/>",
            "robot.urdf:6:1: joint `j` has no link",
        ),
        (
            "<child link=\"b\"/>",
            "<child link=\"c\"/>",
            "robot.urdf:6:1: joint `j`: there is no link `c`, its child",
        ),
        (
            "<child link=\"b\"/>",
            "<child link=\"a\"/>",
            "robot.urdf:2:1: the link `a` is below itself",
        ),
        (
            "<link name=\"b\"/>",
            "<link name=\"a\"/>",
            "robot.urdf:3:1: there are two links `a`",
        ),
        (
            "<link name=\"b\"/>",
            "<link/>",
            "robot.urdf:3:1: a <link> has no name",
        ),
    ] {
        let found = refusal(&robot(from, to));
        assert!(found.contains(said), "{from} -> {to}: {found}");
    }
}

#[test]
fn the_reason_is_said_of_mimics_limits_and_masses_too() {
    for (from, to, said) in [
        (
            "</joint>",
            "<mimic joint=\"j\"/></joint>",
            "robot.urdf:4:1: joint `j` follows itself",
        ),
        (
            "</joint>",
            "<mimic joint=\"k\"/></joint>",
            "robot.urdf:9:1: joint `j` follows `k`, which is no joint",
        ),
        (
            "</joint>",
            "<mimic/></joint>",
            "robot.urdf:9:1: the <mimic> of joint `j` has no joint",
        ),
        (
            "</joint>",
            "<limit lower=\"x\" upper=\"1\"/></joint>",
            "robot.urdf:9:1: joint `j`: lower is \"x\"",
        ),
        ("</robot>", "", "not XML that is read"),
        ("<robot name=\"r\">", "<sdf>", "not XML that is read"),
        (
            "<link name=\"b\"/>",
            "<link name=\"b\"><inertial><mass value=\"-1\"/></inertial></link>",
            "link `b`: the mass is -1, but a mass is not negative",
        ),
    ] {
        let found = refusal(&robot(from, to));
        assert!(found.contains(said), "{from} -> {to}: {found}");
    }
}

#[test]
fn other_files_are_told_apart() {
    assert!(refusal("<mujoco><worldbody/></mujoco>").contains("it looks like MJCF"));
    assert!(refusal("<sdf version='1.6'/>").contains("it looks like SDF"));
    assert!(refusal("[device]\nname = 'x'").contains("robot.urdf:1:1: not XML that is read"));
    assert!(refusal("").contains("not XML that is read"));
    assert!(refusal("<robot/>").contains("no joint moves"));
}

#[test]
fn two_parents_are_named() {
    let second = "<joint name=\"k\" type=\"fixed\">\n<parent link=\"a\"/><child link=\"b\"/></joint></robot>";
    let found = refusal(&robot("</robot>", second));
    let said = "robot.urdf:10:1: the link `b` has two parents, by the joints `j` and `k`: a URDF is a tree";
    assert_eq!(found, said);
}

/// Entities are not expanded: a document type is refused before anything of it is read.
#[test]
fn entities_are_refused() {
    let mut text = "<!DOCTYPE robot [<!ENTITY a0 \"x\">".to_owned();
    for level in 1..40 {
        let before = format!("&a{};", level - 1);
        let _ = write!(text, "<!ENTITY a{level} \"{}\">", before.repeat(10));
    }
    text.push_str("]><robot name=\"&a39;\"/>");
    assert!(refusal(&text).contains("DTD"), "{}", refusal(&text));
}

fn comb(teeth: usize) -> String {
    let mut text = "<robot name=\"comb\"><link name=\"l0\"/>".to_owned();
    for tooth in 1..=teeth {
        let _ = write!(
            text,
            "<link name=\"l{tooth}\"/><link name=\"t{tooth}\"/>\
             <joint name=\"j{tooth}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{tooth}\"/>\
             <mimic joint=\"j1\"/></joint>\
             <joint name=\"k{tooth}\" type=\"fixed\"><parent link=\"l{tooth}\"/><child link=\"t{tooth}\"/></joint>",
            tooth - 1
        );
    }
    text + "</robot>"
}

/// Links by the thousand end at a limit, and what is below it does not take long.
#[test]
fn large_robots_are_refused() {
    assert!(refusal(&comb(3000)).contains("more than 4096 links"));
    let chain = refusal(&comb(2000));
    // the first one follows itself; nobody walks the comb twice for each tooth
    assert!(chain.contains("follows itself"), "{chain}");
    let long = comb(2000).replace("<mimic joint=\"j1\"/>", "");
    let chain = refusal(&long);
    assert!(
        chain.contains("2000 moving joints; at most 256 are read"),
        "{chain}"
    );
}

#[test]
fn deep_nesting_is_survived() {
    let depth = 200_000;
    let text = format!(
        "<robot>{}{}</robot>",
        "<a>".repeat(depth),
        "</a>".repeat(depth)
    );
    let error = device_from_urdf(&text, "deep.urdf", BaseAndTip::default()).unwrap_err();
    assert!(
        matches!(error, UrdfError::Chain { .. } | UrdfError::Xml { .. }),
        "{error}"
    );
}

/// The parser compares attributes and namespaces pair by pair: a megabyte of either took half a minute.
#[test]
fn attributes_and_namespaces_are_bounded() {
    let list = |count: usize, prefix: &str| {
        (0..count).fold(String::new(), |mut text, number| {
            let _ = write!(text, " {prefix}{number:06}=\"\"");
            text
        })
    };
    let begun = std::time::Instant::now();
    let many = list(100_000, "a");
    let text = robot("<link name=\"b\"", &format!("<link name=\"b\"{many}"));
    let message = refusal(&text);
    assert!(
        message.contains("robot.urdf:3:1") && message.contains("more than 256 attributes"),
        "{message}"
    );
    let nested = (0..30_000).fold(String::new(), |mut text, number| {
        let _ = write!(text, "<a xmlns:n{number}=\"u{number}\">");
        text
    });
    let text = robot("<link name=\"b\"", &format!("{nested}<link name=\"b\""));
    assert!(
        refusal(&text).contains("more than 256 namespaces"),
        "{}",
        refusal(&text)
    );
    // sixty times less than the pairs of 100 000
    assert!(begun.elapsed().as_secs() < 5, "{:?}", begun.elapsed());
    let few = format!("<link name=\"b\"{}", list(200, "a"));
    let commented = format!("<!-- <a {many}> --><![CDATA[<a {many}>]]>{few}");
    let text = robot("<link name=\"b\"", &commented);
    let read = device_from_urdf(&text, "robot.urdf", BaseAndTip::default());
    assert!(read.is_ok(), "{:?}", read.err());
}

#[test]
fn a_file_that_is_too_large_or_no_text_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.urdf");
    std::fs::write(&path, vec![b' '; (8 << 20) + 1]).unwrap();
    let error = haptical_urdf::read_urdf_text(&path)
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("larger than 8 MiB, the most that is read"),
        "{error}"
    );
    std::fs::write(&path, b"\xff\xfe<").unwrap();
    let error = haptical_urdf::read_urdf_text(&path)
        .unwrap_err()
        .to_string();
    assert!(error.contains("UTF-16"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// A byte changed, left out or doubled anywhere: an answer or a refusal.
    #[test]
    fn damaged_text_is_answered_or_refused(
        place in 0.0..1.0_f64,
        byte in prop::sample::select(b"<>&\"'/ =0-e.\n\0x${}".to_vec()),
        how in 0..3_u8,
    ) {
        for name in ["arm.urdf", "linkage.urdf"] {
            let Some(text) = fixture(name) else { return Ok(()); };
            let mut bytes = text.into_bytes();
            let place = (place * bytes.len() as f64) as usize;
            match how {
                0 => bytes[place] = byte,
                1 => { bytes.remove(place); }
                _ => bytes.insert(place, byte),
            }
            let Ok(text) = String::from_utf8(bytes) else { return Ok(()); };
            if let Ok(read) = device_from_urdf(&text, name, BaseAndTip::default()) {
                let readings = vec![0.1; read.device.joints.len()];
                let pose = crate::support::pose(&read.device, &readings);
                prop_assert!(pose.position_m.iter().chain(&pose.rotation).all(|x| x.is_finite()));
                let corrected = haptical_urdf::corrected_urdf(&text, name, BaseAndTip::default(), &read.device).unwrap();
                prop_assert!(device_from_urdf(&corrected.text, name, BaseAndTip::to(&corrected.tip)).is_ok());
            }
        }
    }
}
