//! URDFs as devices: read, checked, exported, corrected; rig files next to them.

use std::path::{Path, PathBuf};

use haptical_model::{Device, DeviceChain};
use haptical_urdf::{BaseAndTip, device_from_urdf};
use serde_json::Value;

use crate::export::export;
use crate::{haptical, text};

/// A file of fixtures/urdf; a packaged crate has none, and says that it skips.
pub(crate) fn fixture(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/urdf")
        .join(name);
    if !path.exists() {
        println!("skipped: {name} is not here");
        return None;
    }
    Some(path)
}

fn check(arguments: &[&str]) -> (Value, i32) {
    let output = haptical()
        .arg("check")
        .args(arguments)
        .arg("--json")
        .output()
        .unwrap();
    let json = serde_json::from_slice(&output.stdout).unwrap();
    (json, output.status.code().unwrap())
}

#[test]
fn a_urdf_is_a_device() {
    let (Some(arm), Some(linkage)) = (fixture("arm.urdf"), fixture("linkage.urdf")) else {
        return;
    };
    let (found, status) = check(&[arm.to_str().unwrap()]);
    assert_eq!(status, 0);
    assert_eq!(found["device"]["links"], 7);
    assert_eq!(found["device"]["joints"][3]["unit"], "m");
    assert!(
        found["warnings"][0]
            .as_str()
            .unwrap()
            .contains("`left`, `right`")
    );
    let (found, _) = check(&[arm.to_str().unwrap(), "--tip", "palm"]);
    assert_eq!(found["device"]["links"], 7);
    // five rows move, three joints are read
    let (found, _) = check(&[linkage.to_str().unwrap()]);
    assert_eq!(found["device"]["joints"].as_array().unwrap().len(), 3);
}

#[test]
fn what_is_wrong_with_a_urdf_is_said_with_its_place() {
    let Some(arm) = fixture("arm.urdf") else {
        return;
    };
    let (found, status) = check(&[arm.to_str().unwrap(), "--tip", "hand"]);
    assert_eq!(status, 2);
    assert!(
        found["error"]["what"]
            .as_str()
            .unwrap()
            .starts_with("there is no link `hand`")
    );
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.urdf");
    let broken = std::fs::read_to_string(&arm)
        .unwrap()
        .replace("xyz=\"0 0 0.33\"", "xyz=\"0 0 NaN\"");
    std::fs::write(&bad, broken).unwrap();
    let output = haptical().arg("check").arg(&bad).output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        said.contains("joint `shoulder_pan`: xyz is \"0 0 NaN\"") && said.contains("bad.urdf:21:5"),
        "{said}"
    );
    // a tip is a link of a URDF
    std::fs::write(folder.path().join("device.toml"), "[[joint]]\n").unwrap();
    let (found, status) = check(&[
        folder.path().join("device.toml").to_str().unwrap(),
        "--tip",
        "hand",
    ]);
    assert_eq!(status, 2);
    assert!(
        found["error"]["what"]
            .as_str()
            .unwrap()
            .starts_with("--tip names a link of a URDF")
    );
}

/// The device file that an export writes, with a rig's sensors in it, is the URDF's device again.
#[test]
fn a_device_file_with_a_rig_is_written() {
    let Some(linkage) = fixture("linkage.urdf") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let rig = folder.path().join("rig.toml");
    std::fs::write(
        &rig,
        "[cable_encoder]\ndistance_sd_m = 1e-4\n[gravity]\nvector_mps2 = [0.0, 9.81, 0.0]\n",
    )
    .unwrap();
    let out = folder.path().join("device.toml");
    let output = export(&linkage, "toml", &out, &["--rig", rig.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let device = Device::load(&out).unwrap().device;
    let urdf = std::fs::read_to_string(&linkage).unwrap();
    let mut expected = device_from_urdf(&urdf, "linkage.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    assert_eq!(device.cables.len(), 1);
    expected.cables.clone_from(&device.cables);
    expected.gravity_mps2 = Some([0.0, 9.81, 0.0]);
    assert_eq!(device, expected);
    std::fs::write(&rig, "[[joint]]\n").unwrap();
    let output = export(&linkage, "toml", &out, &["--rig", rig.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("a rig file holds sensors alone"));
}

/// A calibrated device file and its URDF give a URDF with the same forward kinematics.
#[test]
fn a_corrected_urdf_moves_as_the_calibrated_device() {
    /// What the issue asks for \[m\].
    const SAME_M: f64 = 1e-9;
    let Some(arm) = fixture("arm.urdf") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let urdf = std::fs::read_to_string(&arm).unwrap();
    let mut device = device_from_urdf(&urdf, "arm.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    for (index, id) in device.link_parameters(false).into_iter().enumerate() {
        id.set(&mut device, 2e-3 * (index as f64).cos());
    }
    let identified = folder.path().join("identified.toml");
    std::fs::write(&identified, device.to_new_toml().unwrap()).unwrap();
    let out = folder.path().join("corrected.urdf");
    let original = arm.to_str().unwrap();
    let output = export(&identified, "urdf", &out, &["--urdf", original, "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let corrected = std::fs::read_to_string(&out).unwrap();
    assert!(corrected.contains("<!-- the mount stands askew -->"));
    let again = device_from_urdf(&corrected, "corrected.urdf", BaseAndTip::default())
        .unwrap()
        .device;
    for step in 0..50 {
        let outputs: Vec<f64> = (0..6)
            .map(|joint| (0.7 * f64::from(step + 3 * joint)).sin())
            .collect();
        let [ours, theirs] =
            [&device, &again].map(|device| DeviceChain::new(device).pose(&outputs).unwrap());
        assert!((ours.position_m - theirs.position_m).norm() < SAME_M);
        assert!((ours.rotation - theirs.rotation).amax() < SAME_M);
    }
    // another tip is another chain
    let output = export(
        &identified,
        "urdf",
        &out,
        &["--urdf", original, "--tip", "palm"],
    );
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the handle is elsewhere in it"));
    // and a URDF is corrected by --format urdf alone
    let output = export(&identified, "mjcf", &out, &["--urdf", original]);
    assert!(text(&output.stderr).contains("--urdf is for --format urdf and kinematics-yaml alone"));
    // the URDF itself is never written over
    let output = export(&identified, "urdf", &arm, &["--urdf", original]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&arm).unwrap(), urdf);
}

#[test]
fn descriptions_of_a_device_without_a_urdf_are_written() {
    let sandbox = crate::Sandbox::new();
    let out = sandbox.path("new.urdf");
    let output = export(&sandbox.path("device.toml"), "urdf", &out, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let device = Device::load(&sandbox.path("device.toml")).unwrap().device;
    let urdf = std::fs::read_to_string(&out).unwrap();
    let again = device_from_urdf(&urdf, "new.urdf", BaseAndTip::to("handle"))
        .unwrap()
        .device;
    for step in 0..20 {
        let readings: Vec<f64> = (0..7)
            .map(|joint| 0.6 * (0.9 * f64::from(step + 5 * joint)).sin())
            .collect();
        let [ours, theirs] =
            [&device, &again].map(|device| DeviceChain::new(device).pose(&readings).unwrap());
        assert!((ours.position_m - theirs.position_m).norm() < 1e-12);
        assert!((ours.rotation - theirs.rotation).amax() < 1e-12);
    }
    let out = sandbox.path("model.xml");
    let output = export(&sandbox.path("device.toml"), "mjcf", &out, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        std::fs::read_to_string(&out)
            .unwrap()
            .starts_with("<mujoco model=")
    );
}
