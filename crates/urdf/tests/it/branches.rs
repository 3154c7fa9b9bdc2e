//! Masses of branches off a chain: the torques of a device against sums over the whole tree.

use haptical_model::Device;
use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Rotation3, Vector3};
use haptical_urdf::{BaseAndTip, device_from_urdf};

use crate::support::ROUNDING;

/// A trunk that turns about an oblique axis, an arm to a hand on it, and next to that a head, an arm of two
/// joints that cannot be at 0, a gripper that follows, and a leg on the root.
const FIGURE: &str = r#"<robot name="figure">
  <link name="pelvis"/>
  <link name="trunk"><inertial><origin xyz="0.01 0 0.2"/><mass value="9"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0 0 -0.1"/><mass value="1.5"/></inertial></link>
  <link name="hand"><inertial><origin xyz="0 0 -0.05"/><mass value="0.7"/></inertial></link>
  <link name="head"><inertial><origin xyz="0 0.02 0.1"/><mass value="2.5"/></inertial></link>
  <link name="other_arm"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/></inertial></link>
  <link name="other_hand"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/></inertial></link>
  <link name="jaw"><inertial><origin xyz="0 0.03 0"/><mass value="0.2"/></inertial></link>
  <link name="finger"><inertial><origin xyz="0 0 -0.02"/><mass value="0.05"/></inertial></link>
  <link name="leg"><inertial><mass value="11"/></inertial></link>
  <joint name="waist" type="revolute"><parent link="pelvis"/><child link="trunk"/>
    <origin xyz="0 0 0.1" rpy="0.1 0 0.2"/><axis xyz="0.6 0.8 0"/><limit lower="-1" upper="1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="trunk"/><child link="arm"/>
    <origin xyz="0 0.2 0.4" rpy="0 0.3 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="wrist" type="revolute"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0 -0.3"/><axis xyz="1 0 0"/><limit lower="-2" upper="2"/></joint>
  <joint name="neck" type="floating"><parent link="trunk"/><child link="head"/>
    <origin xyz="0 0 0.5" rpy="0.2 0 0"/></joint>
  <joint name="other_shoulder" type="revolute"><parent link="trunk"/><child link="other_arm"/>
    <origin xyz="0 -0.2 0.4"/><axis xyz="1 0 0"/><limit lower="0.2" upper="1"/></joint>
  <joint name="other_wrist" type="prismatic"><parent link="other_arm"/><child link="other_hand"/>
    <origin xyz="0 0 -0.3"/><axis xyz="0 0 -1"/><limit lower="-0.3" upper="-0.1"/></joint>
  <joint name="grip" type="revolute"><parent link="other_hand"/><child link="jaw"/>
    <origin xyz="0 0 -0.1"/><axis xyz="0 0 1"/><mimic joint="other_shoulder" multiplier="-2" offset="0.5"/></joint>
  <joint name="thumb" type="continuous"><parent link="hand"/><child link="finger"/></joint>
  <joint name="hip" type="continuous"><parent link="pelvis"/><child link="leg"/></joint>
</robot>"#;

/// Torque about a row's axis by gravity on all bodies from this row on \[N m\]: the axis through the frame
/// before the row's motion, its z.
fn torque(device: &Device, readings: &[f64], row: usize) -> f64 {
    let frames = frames(device, readings);
    let joint = &frames[row];
    let axis = joint.rotation.column(2).into_owned();
    let gravity = Vector3::from(device.gravity_mps2.unwrap());
    let carried = device.bodies.iter().enumerate().skip(row);
    let torques = carried.filter_map(|(row, body)| {
        let body = body.as_ref()?;
        let frame = &frames[row];
        let centre = frame.position_m + frame.rotation * Vector3::from(body.centre_of_mass_m);
        Some(axis.dot(&(centre - joint.position_m).cross(&gravity)) * body.mass_kg)
    });
    torques.sum()
}

/// Frames behind each row's motion: the general rows of a URDF are origins, then a turn about z.
fn frames(device: &Device, readings: &[f64]) -> Vec<Pose> {
    let origins = device.chain_origins();
    let mut at = Pose::default();
    let mut frames = Vec::new();
    for row in 0..device.links.len() {
        let origin = origins[row].unwrap();
        at = Pose {
            position_m: at.position_m + at.rotation * origin.position_m,
            rotation: at.rotation * origin.rotation,
        };
        if let Some(drive) = device.drive(row) {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), readings[drive.joint]);
            at.rotation *= turn.into_inner();
        }
        frames.push(at);
    }
    frames
}

/// The figure with every side joint fixed where it is taken: the same masses by another way.
fn welded() -> String {
    let weld = |text: &str, joint: &str, origin: &str| {
        let start = text.find(&format!("<joint name=\"{joint}\"")).unwrap();
        let end = start + text[start..].find("</joint>").unwrap();
        let own = &text[start..end];
        let links = &own[own.find("<parent").unwrap()..own.find("/>").unwrap()];
        let child = &own[own.find("<child").unwrap()..];
        let child = &child[..=child.find('>').unwrap()];
        let fixed =
            format!("<joint name=\"{joint}\" type=\"fixed\">{links}/>{child}<origin {origin}/>");
        format!("{}{fixed}{}", &text[..start], &text[end..])
    };
    let text = weld(FIGURE, "neck", "xyz=\"0 0 0.5\" rpy=\"0.2 0 0\"");
    let text = weld(
        &text,
        "other_shoulder",
        "xyz=\"0 -0.2 0.4\" rpy=\"0.6 0 0\"",
    );
    let text = weld(&text, "other_wrist", "xyz=\"0 0 -0.1\"");
    let text = weld(&text, "grip", "xyz=\"0 0 -0.1\" rpy=\"0 0 -0.7\"");
    let text = weld(&text, "thumb", "");
    weld(&text, "hip", "")
}

#[test]
fn branches_load_the_joints_that_carry_them() {
    let read = device_from_urdf(FIGURE, "figure.urdf", BaseAndTip::to("hand")).unwrap();
    let welded = device_from_urdf(&welded(), "welded.urdf", BaseAndTip::to("hand")).unwrap();
    assert_eq!(welded.warnings, Vec::<String>::new());
    assert_eq!(
        read.warnings,
        [
            "figure.urdf: masses beside the chain count as fixed to it, their joints at 0, but \
             `other_shoulder` at 0.6 rad, `other_wrist` at -0.2 m, `grip` at -0.7 rad: 2.5 kg behind \
             `neck`, 2.7 kg behind `other_shoulder`, 0.05 kg behind `thumb`; hold these joints there while \
             you record",
            "figure.urdf: left out, because they move beside the chain: `hip`"
        ]
    );
    let masses: Vec<f64> = read
        .device
        .bodies
        .iter()
        .flatten()
        .map(|body| body.mass_kg)
        .collect();
    for (mass, expected) in masses.iter().zip([9.0 + 2.5 + 2.7, 1.5, 0.7 + 0.05]) {
        assert!((mass - expected).abs() < 1e-12, "{masses:?}");
    }
    for readings in [[0.0; 3], [0.4, -1.1, 0.7], [-0.9, 0.3, -1.6]] {
        for row in 1..=3 {
            let [own, other] = [&read, &welded].map(|read| torque(&read.device, &readings, row));
            // 14 kg at half a metre
            assert!(
                (own - other).abs() < 100.0 * ROUNDING,
                "{row}: {own} {other}"
            );
            assert!(own.abs() > 1e-3);
        }
    }
}

/// Limits that are none, turned round, or on one side only, and joints that follow nobody, hold a branch too.
#[test]
fn odd_joints_beside_the_chain_are_taken_somewhere() {
    let height = |joint: &str| {
        let text = format!(
            r#"<robot name="r"><link name="a"/><link name="b"/><link name="tip"/>
            <link name="side"><inertial><mass value="1"/></inertial></link>
            <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
            <joint name="k" type="continuous"><parent link="b"/><child link="tip"/></joint>
            <joint name="s" type="prismatic"><parent link="b"/><child link="side"/><axis xyz="0 0 1"/>{joint}</joint>
            </robot>"#
        );
        let read = device_from_urdf(&text, "r.urdf", BaseAndTip::to("tip")).unwrap();
        read.device.bodies[1].unwrap().centre_of_mass_m[2]
    };
    let limits =
        |lower: &str, upper: &str| height(&format!("<limit lower=\"{lower}\" upper=\"{upper}\"/>"));
    assert_eq!(height(""), 0.0);
    assert_eq!(limits("-1", "2"), 0.0);
    assert_eq!(limits("0.5", "0.5"), 0.5);
    assert_eq!(limits("0.5", "inf"), 0.5);
    assert_eq!(limits("-1e300", "-0.25"), -0.25);
    assert_eq!(limits("2", "1"), 0.0);
    assert_eq!(limits("1e300", "inf"), 0.0);
    // followed by nobody's fault: the chain does not need it
    assert_eq!(height("<mimic joint=\"nobody\"/>"), 0.0);
    assert_eq!(height("<mimic joint=\"k\" offset=\"0.3\"/>"), 0.3);
}
