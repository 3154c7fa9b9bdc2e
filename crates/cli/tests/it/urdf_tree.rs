//! URDFs with branches: masses off the chain, the choice of a chain, rows that follow, rig files next to
//! them.

use std::fmt::Write;

use haptical_model::Device;
use serde_json::Value;

use crate::folder::Folder;

/// A waist with a head, and an arm on either side of two joints, each with a finger.
const FIGURE: &str = r#"<robot name="figure">
  <link name="pelvis"/>
  <link name="trunk"><inertial><origin xyz="0 0 0.2"/><mass value="9"/></inertial></link>
  <link name="head"><inertial><origin xyz="0 0 0.1"/><mass value="4"/></inertial></link>
  <link name="left_arm"><inertial><origin xyz="0 0 -0.1"/><mass value="1.5"/></inertial></link>
  <link name="left_hand"/> <link name="left_finger"/>
  <link name="right_arm"><inertial><origin xyz="0 0 -0.1"/><mass value="5"/></inertial></link>
  <joint name="waist" type="revolute"><parent link="pelvis"/><child link="trunk"/>
    <origin xyz="0 0 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>
  <joint name="neck" type="revolute"><parent link="trunk"/><child link="head"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>
  <joint name="left_shoulder" type="revolute"><parent link="trunk"/><child link="left_arm"/>
    <origin xyz="0 0.2 0.4"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="left_wrist" type="revolute"><parent link="left_arm"/><child link="left_hand"/>
    <origin xyz="0 0 -0.3"/><axis xyz="1 0 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="left_knuckle" type="revolute"><parent link="left_hand"/><child link="left_finger"/>
    <origin xyz="0 0 -0.1"/><axis xyz="1 0 0"/><limit lower="0" upper="1"/></joint>
  <joint name="right_shoulder" type="revolute"><parent link="trunk"/><child link="right_arm"/>
    <origin xyz="0 -0.2 0.4"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
</robot>"#;

/// Columns of joints and nothing else.
fn log(joints: usize) -> String {
    let names: Vec<String> = (1..=joints)
        .map(|joint| format!("theta{joint}_rad"))
        .collect();
    let mut text = names.join(",") + "\n";
    for row in 0..30 {
        let cells = (0..joints).map(|joint| (0.7 * (row + 3 * joint) as f64).sin().to_string());
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join(","));
    }
    text
}

#[test]
fn a_log_of_another_chain_is_told_which_chain_was_taken() {
    let folder = Folder::with("figure.urdf", FIGURE);
    folder.write("two.csv", &log(2));
    folder.write("three.csv", &log(3));
    folder.write("one.csv", &log(1));
    let plan = |further: &[&str]| {
        let arguments = ["plan", "--device", "figure.urdf", "--log"];
        folder.run(&[&arguments[..], further].concat())
    };
    let (status, _, said) = plan(&["three.csv"]);
    assert_eq!(status, Some(2));
    assert!(
        said.contains(
            "error: missing `theta4_rad` (joint `left_knuckle`): the chain ends at `left_finger`, as the \
             longest one does, and no --tip names another\n  where: three.csv:1, column `theta4_rad`\n  \
             next: the chain to `left_hand` has 3 joints, as the log has: add --tip left_hand\n"
        ),
        "{said}"
    );
    let (_, _, said) = plan(&["two.csv"]);
    assert!(
        said.contains("(joints `left_wrist`, `left_knuckle`): ")
            && said.contains(
                "next: the chains to `head`, `left_arm`, `right_arm` have 2 joints, as the log has: add \
                 --tip with the one that was measured\n"
            ),
        "{said}"
    );
    let (_, _, said) = plan(&["one.csv", "--tip", "left_hand"]);
    assert!(
        said.contains("the chain ends at `left_hand`, as --tip says\n")
            && said.contains("the chain to `trunk` has 1 joint, as the log has: add --tip trunk\n"),
        "{said}"
    );
    // the chain that fits is read
    let (status, _, said) = plan(&["three.csv", "--tip", "left_hand"]);
    assert!(status == Some(0) && !said.contains("missing"), "{said}");
}

/// Readings that need no URDF explain themselves as before, with the joint's name where it has one.
#[test]
fn a_device_file_s_joint_is_named_too() {
    let folder = Folder::with("figure.urdf", FIGURE);
    folder.write(
        "named.toml",
        "[[joint]]\nname = \"turn\"\n[[joint]]\nname = \"lift\"\n",
    );
    folder.write("bare.toml", "[[joint]]\n[[joint]]\n");
    folder.write("one.csv", &log(1));
    let (_, _, said) = folder.run(&["check", "named.toml", "one.csv"]);
    assert!(
        said.contains("error: missing `theta2_rad` (joint `lift`)\n"),
        "{said}"
    );
    assert!(
        said.contains("next: the device needs one column per joint: "),
        "{said}"
    );
    let (_, _, said) = folder.run(&["check", "bare.toml", "one.csv"]);
    assert!(said.contains("error: missing `theta2_rad`\n"), "{said}");
}

/// A waist that bends under the weight of everything on it: its compliance is the true one only when head and
/// right arm weigh on it, and the joints of both were at 0.
#[test]
fn masses_beside_the_chain_load_it() {
    /// Of the waist and the left shoulder \[rad/(N m)\].
    const COMPLIANCE: [f64; 2] = [2.5e-4, 1.1e-3];
    /// Torques are taken where the readings are, not where the bent joints are: compliance times change of
    /// torque with angle, 2.5e-4 rad/(N m) 62 N m/rad, is left. Without the masses a half is missing.
    const FIRST_ORDER: f64 = 0.03;
    let folder = Folder::with("figure.urdf", FIGURE);
    let rig = "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = 1e-5\nrotation_sd_rad = 1e-5\n\
        [gravity]\nvector_mps2 = [0.0, 0.0, -9.81]\n";
    folder.write("rig.toml", rig);
    folder.write("log.csv", &bending_log(COMPLIANCE));
    let (status, _, said) = folder.run(&[
        "identify",
        "--device",
        "figure.urdf",
        "--tip",
        "left_hand",
        "--rig",
        "rig.toml",
        "--log",
        "log.csv",
        "--with",
        "joint-compliance",
        "--out",
        "result",
    ]);
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains(
            "warning: figure.urdf: masses beside the chain count as fixed to it, their joints at 0: 4 kg \
             behind `neck`, 5 kg behind `right_shoulder`; hold these joints there while you record"
        ),
        "{said}"
    );
    let json = std::fs::read_to_string(folder.path("result/identified.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    for (joint, truth) in COMPLIANCE.into_iter().enumerate() {
        let name = format!("joint_compliance{}", joint + 1);
        let all = json["parameters"].as_array().unwrap();
        let found = all.iter().find(|own| own["name"] == name.as_str()).unwrap();
        let value = found["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < FIRST_ORDER, "{name}: {value}");
    }
    // the device file that is written has the masses too
    let identified = Device::load(&folder.path("result/identified.toml")).unwrap();
    assert_eq!(identified.device.bodies[1].unwrap().mass_kg, 18.0);
    assert!(identified.device.compliance_rad_per_nm(0) > 2e-4);
}

/// Hand poses of the figure, its waist and left shoulder bending by their own rules: nothing of the software
/// is used.
fn bending_log([waist, shoulder]: [f64; 2]) -> String {
    const G: f64 = 9.81;
    let mut text = "theta1_rad,theta2_rad,theta3_rad,x_m,y_m,z_m,qw,qx,qy,qz\n".to_owned();
    for row in 0..80 {
        let row = f64::from(row);
        let [q1, q2, q3] = [
            0.9 * (1.3 * row).sin(),
            1.5 * (2.1 * row).cos(),
            1.2 * (0.7 * row).sin(),
        ];
        // both turn about y: in the plane, from the waist, u up the trunk and v down the left arm
        let (mut a, mut b) = (q1, q2);
        for _ in 0..60 {
            // x of a point at height u on the trunk is u sin a, of one down the arm -v sin(a + b)
            let arm = 1.5 * G * (-0.1 * (a + b).sin());
            let trunk = G * (9.0 * 0.2 + 4.0 * 0.6 + 1.5 * 0.4 + 5.0 * 0.4) * a.sin()
                - 5.0 * G * 0.1 * a.sin();
            (a, b) = (q1 + waist * (trunk + arm), q2 + shoulder * arm);
        }
        let x = 0.4 * a.sin() - 0.3 * (a + b).sin();
        let z = 0.1 + 0.4 * a.cos() - 0.3 * (a + b).cos();
        let ((s1, c1), (s2, c2)) = ((0.5 * (a + b)).sin_cos(), (0.5 * q3).sin_cos());
        // about y, then about x
        let [w, qx, qy, qz] = [c1 * c2, c1 * s2, s1 * c2, -s1 * s2];
        let _ = writeln!(text, "{q1},{q2},{q3},{x},0.2,{z},{w},{qx},{qy},{qz}");
    }
    text
}
