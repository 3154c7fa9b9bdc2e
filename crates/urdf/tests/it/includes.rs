//! MJCFs of several files: what is included, from where, and faults with the file that they are in.

use std::path::Path;

use haptical_model::Device;
use haptical_urdf::{
    BaseAndTip, NewJoints, chain_ends, corrected_mjcf, device_from_mjcf, new_mjcf, read_urdf_text,
};

use crate::mjcf_read;

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

fn read(path: &Path) -> Result<Device, String> {
    let text = read_urdf_text(path).map_err(|error| error.to_string())?;
    let name = path.display().to_string();
    let read = device_from_mjcf(&text, &name, BaseAndTip::to("tip"));
    read.map(|read| read.device)
        .map_err(|error| error.to_string())
}

/// What is refused, without the name of the folder.
fn refused(files: &[(&str, &str)]) -> String {
    let folder = folder(files);
    let said = read(&folder.path().join("main.xml")).unwrap_err();
    said.replace(&format!("{}/", folder.path().display()), "")
}

const MAIN: &str = "<mujoco model=\"m\">\n<include file=\"parts/defaults.xml\"/>\n<worldbody>\n  <body name=\"a\">\
    <joint name=\"j\"/><include file=\"parts/arm.xml\"/></body></worldbody></mujoco>";
const DEFAULTS: &str = "<mujoco model=\"other\"><compiler angle=\"radian\"/><default><joint armature=\"0.5\"/></default></mujoco>";
const ARM: &str = "<?xml version=\"1.0\"?>\n<!-- <include file=\"no\"/> -->\n<mujocoinclude>\n<inertial pos=\"0 0 0\" mass=\"2\" \
    diaginertia=\"1 1 1\"/>\n<body name=\"b\" pos=\"0 0 1\">\n<joint name=\"k\" axis=\"1 0 0\" range=\"-1 1\"/>\n\
    <include file=\"tool.xml\"/></body></mujocoinclude>";
const TOOL: &str = "<x><site name=\"tip\" pos=\"0 1 0\"/></x>";
const ALL: [(&str, &str); 4] = [
    ("main.xml", MAIN),
    ("parts/defaults.xml", DEFAULTS),
    ("parts/arm.xml", ARM),
    ("parts/tool.xml", TOOL),
];

#[test]
fn parts_are_read_as_if_they_stood_there() {
    let folder = folder(&ALL);
    let found = read(&folder.path().join("main.xml")).unwrap();
    let whole = "<mujoco model=\"m\"><compiler angle=\"radian\"/><default><joint armature=\"0.5\"/></default><worldbody><body \
        name=\"a\"><joint name=\"j\"/><inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\"1 1 1\"/><body name=\"b\" pos=\"0 0 1\">\
        <joint name=\"k\" axis=\"1 0 0\" range=\"-1 1\"/><site name=\"tip\" pos=\"0 1 0\"/></body></body></worldbody></mujoco>";
    assert_eq!(found, mjcf_read::read(whole, BaseAndTip::to("tip")).device);
    assert_eq!(found.joints[1].armature_kgm2, Some(0.5));
    let text = read_urdf_text(&folder.path().join("main.xml")).unwrap();
    assert_eq!(chain_ends(&text, "main.xml", None).unwrap().len(), 2);
}

/// The folder of the main file comes before that of the file that includes.
#[test]
fn a_name_is_of_the_main_folder_first() {
    let mut files = ALL.to_vec();
    files.push(("tool.xml", "<x><site name=\"tip\" pos=\"0 3 0\"/></x>"));
    let folder = folder(&files);
    let found = read(&folder.path().join("main.xml")).unwrap();
    let handle = found.chain_origins().last().copied().flatten().unwrap();
    assert!((handle.position_m.norm() - 3.0).abs() < 1e-12);
}

#[test]
fn faults_name_the_file_and_the_line_that_they_are_in() {
    let with = |name: &str, from: &str, to: &str| {
        let files = ALL.map(|(entry, text)| match entry == name {
            true => (entry, text.replacen(from, to, 1)),
            false => (entry, text.to_owned()),
        });
        assert!(files.iter().zip(ALL).any(|(entry, was)| entry.1 != was.1));
        refused(&files.each_ref().map(|(name, text)| (*name, text.as_str())))
    };
    for (said, wanted) in [
        (
            with("parts/arm.xml", "\"1 0 0\"", "\"1 0\""),
            "parts/arm.xml:6:1: joint `k`: axis is \"1 0\"",
        ),
        (
            with("parts/arm.xml", "</body>", "</bod>"),
            "parts/arm.xml:7:27: not XML that is read",
        ),
        (
            with("parts/tool.xml", "0 1 0", "0 1"),
            "parts/tool.xml:1:4: site `tip`: pos is \"0 1\"",
        ),
        // behind what is included
        (
            with(
                "main.xml",
                "<body name=\"a\">",
                "<body name=\"a\" pos=\"x\">",
            ),
            "main.xml:4:3: body `a`: pos is \"x\"",
        ),
        (
            with(
                "main.xml",
                "</worldbody>",
                "<body\nname=\"q\" pos=\"y\"/></worldbody>",
            ),
            "main.xml:4:73: body `q`",
        ),
        (
            with("parts/arm.xml", "tool.xml", "none.xml"),
            "parts/arm.xml:7:1: <include>: the file is \"none.xml\", but there is no",
        ),
    ] {
        assert!(said.starts_with(wanted), "{said}");
    }
    // and so do warnings
    let far = ARM.replace("0 0 1\">", "0 0 100\">");
    let folder = folder(&[ALL[0], ALL[1], ("parts/arm.xml", &far), ALL[3]]);
    let path = folder.path().join("main.xml");
    let text = read_urdf_text(&path).unwrap();
    let read = device_from_mjcf(&text, "main.xml", BaseAndTip::to("tip")).unwrap();
    assert!(
        read.warnings[0].contains("parts/arm.xml:5:1: body `b`: pos is 100 m"),
        "{:?}",
        read.warnings
    );
}

#[test]
fn files_outside_the_folder_and_files_twice_are_refused() {
    let outside = tempfile::tempdir().unwrap();
    let other = outside.path().join("other.xml");
    std::fs::write(&other, TOOL).unwrap();
    let absolute = other.display().to_string();
    let body = |include: &str| {
        format!(
            "<mujoco><worldbody><body name=\"a\"><joint name=\"j\"/>{include}</body></worldbody></mujoco>"
        )
    };
    let one = |name: &str| body(&format!("<include file=\"{name}\"/>"));
    for name in [
        "../other.xml",
        "parts/../tool.xml",
        "parts\\..\\tool.xml",
        absolute.as_str(),
        "C:tool.xml",
        "",
        "parts/..",
        "tool?>.xml",
    ] {
        let said = refused(&[
            ("main.xml", &one(name).replace("?>", "?&gt;")),
            ("tool.xml", TOOL),
            ("parts/x.xml", TOOL),
        ]);
        assert!(
            said.contains("a file in the folder of the main file or below it is expected"),
            "{name}: {said}"
        );
    }
    for (include, wanted) in [
        (
            "<include file=\"tool.xml\"/><include file=\"./tool.xml\"/>",
            "each file is included once",
        ),
        ("<include file=\"main.xml\"/>", "each file is included once"),
        (
            "<include file=\"loop.xml\"/>",
            "loop.xml:1:4: <include>: the file is \"loop.xml\", but each file is included once",
        ),
        ("<include/>", "<include> has no file"),
        (
            "<include file=\"tool.xml\"><body/></include>",
            "nothing inside",
        ),
        (
            "<include file=\"empty.xml\"/>",
            "empty.xml:1:1: the file is empty",
        ),
        ("<include file=\"parts\"/>", "there is no such file"),
        ("<include file=\"binary.xml\"/>", "it cannot be read"),
    ] {
        let said = refused(&[
            ("main.xml", &body(include)),
            ("tool.xml", TOOL),
            ("loop.xml", "<x><include file=\"loop.xml\"/></x>"),
            ("empty.xml", "<mujoco>text</mujoco>"),
            ("binary.xml", "a\0b"),
            ("parts/x.xml", TOOL),
        ]);
        assert!(said.contains(wanted), "{include}: {said}");
    }
    // a name in the folder that leads out of it
    #[cfg(unix)]
    {
        let folder = folder(&[("main.xml", &one("link.xml"))]);
        std::os::unix::fs::symlink(&other, folder.path().join("link.xml")).unwrap();
        let said = read(&folder.path().join("main.xml")).unwrap_err();
        assert!(
            said.contains("a file in the folder of the main file"),
            "{said}"
        );
    }
}

#[test]
fn models_of_several_files_end_somewhere() {
    let many: Vec<(String, String)> = (0..300)
        .map(|index| {
            let text = format!("<x><site/><include file=\"{}.xml\"/></x>", index + 1);
            (format!("{index}.xml"), text)
        })
        .collect();
    let main = "<mujoco><worldbody><include file=\"0.xml\"/></worldbody></mujoco>";
    let mut files = vec![("main.xml", main)];
    files.extend(
        many.iter()
            .map(|(name, text)| (name.as_str(), text.as_str())),
    );
    let said = refused(&files);
    assert!(said.contains("at most 256 files"), "{said}");
    let large = format!("<x><!--{}--><site/></x>", " ".repeat(5 << 20));
    let two = "<mujoco><worldbody><include file=\"a.xml\"/><include file=\"b.xml\"/></worldbody></mujoco>";
    let said = refused(&[("main.xml", two), ("a.xml", &large), ("b.xml", &large)]);
    assert!(
        said.starts_with("main.xml:1:43:") && said.contains("at most 8 MiB"),
        "{said}"
    );
}

#[test]
fn a_corrected_file_is_refused_and_a_new_one_written() {
    let folder = folder(&ALL);
    let text = read_urdf_text(&folder.path().join("main.xml")).unwrap();
    let ends = BaseAndTip::to("tip");
    let device = device_from_mjcf(&text, "main.xml", ends).unwrap().device;
    let refused = corrected_mjcf(&text, "main.xml", ends, &device, NewJoints::Listed);
    let said = refused.unwrap_err().to_string();
    assert!(
        said.contains("the model includes other files") && said.contains("without --mjcf"),
        "{said}"
    );
    assert!(new_mjcf(&device).unwrap().0.contains("<joint name=\"k\""));
}
