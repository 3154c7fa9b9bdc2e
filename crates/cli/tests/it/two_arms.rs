//! A robot of two arms, and readings at which its finger tips touch, without the software.

use std::fmt::Write;

use haptical_model::kinematics::nalgebra::{
    DMatrix, DVector, Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3,
};

/// Joints of an arm from the trunk: place of each in the frame before \[m\], and axis.
const ARM: [([f64; 3], [f64; 3]); 4] = [
    ([0.0, 0.2, 0.4], [0.0, 1.0, 0.0]),
    ([0.02, 0.03, 0.0], [1.0, 0.0, 0.0]),
    ([0.0, 0.01, -0.3], [0.0, 1.0, 0.0]),
    ([0.03, 0.0, -0.22], [1.0, 0.0, 0.0]),
];
/// Finger tip behind the last joint \[m\].
const FINGER: [f64; 3] = [0.02, 0.0, -0.15];
/// By how much more than they read the elbows are turned, left and right \[rad\].
pub(crate) const ELBOWS_RAD: [f64; 2] = [-0.02, 0.03];
const ELBOW: usize = 2;

/// The right arm is the left one in a mirror, but for its axes.
fn mirrored([x, y, z]: [f64; 3], side: &str) -> [f64; 3] {
    match side {
        "left" => [x, y, z],
        _ => [x, -y, z],
    }
}

pub(crate) fn urdf() -> String {
    let mut text = "<robot name=\"two_arms\">\n<link name=\"pelvis\"/><link name=\"trunk\"/>\n\
        <joint name=\"waist\" type=\"continuous\"><parent link=\"pelvis\"/><child link=\"trunk\"/></joint>\n"
        .to_owned();
    for side in ["left", "right"] {
        let mut parent = "trunk".to_owned();
        for (index, (place, axis)) in ARM.into_iter().enumerate() {
            let link = format!("{side}_link{}", index + 1);
            let [[x, y, z], [ax, ay, az]] = [mirrored(place, side), axis];
            let _ = writeln!(
                text,
                "<link name=\"{link}\"><inertial><mass value=\"1\"/></inertial></link>\n\
                 <joint name=\"{side}_joint{}\" type=\"revolute\"><origin xyz=\"{x} {y} {z}\"/>\
                 <parent link=\"{parent}\"/><child link=\"{link}\"/><axis xyz=\"{ax} {ay} {az}\"/>\
                 <limit lower=\"-2.8\" upper=\"2.8\"/></joint>",
                index + 1
            );
            parent = link;
        }
        let [x, y, z] = FINGER;
        let _ = writeln!(
            text,
            "<link name=\"{side}_finger\"/>\n<joint name=\"{side}_nail\" type=\"fixed\"><origin xyz=\"{x} {y} {z}\"/>\
             <parent link=\"{parent}\"/><child link=\"{side}_finger\"/></joint>"
        );
    }
    text + "</robot>"
}

/// A finger tip on the trunk \[m\], without the software.
fn finger(side: &str, angles: &[f64]) -> Vector3<f64> {
    let mut at = Isometry3::identity();
    for ((place, axis), angle) in ARM.into_iter().zip(angles) {
        at *= Translation3::from(Vector3::from(mirrored(place, side)));
        let axis = UnitVector3::new_normalize(Vector3::from(axis));
        at *= UnitQuaternion::from_axis_angle(&axis, *angle);
    }
    (at * Translation3::from(Vector3::from(FINGER)))
        .translation
        .vector
}

/// Where the right arm must be for its finger to touch the left one, from a start; none where it cannot reach.
fn touching(left: &[f64], start: &[f64]) -> Option<Vec<f64>> {
    let target = finger("left", left);
    let mut right = DVector::from_column_slice(start);
    for _ in 0..100 {
        let gap = target - finger("right", right.as_slice());
        if gap.norm() < 1e-13 {
            let is_within = right.iter().all(|angle| angle.abs() < 2.6);
            return is_within.then(|| right.as_slice().to_vec());
        }
        let columns = (0..right.len()).map(|joint| {
            let at = |step: f64| {
                let mut moved = right.clone();
                moved[joint] += step;
                finger("right", moved.as_slice())
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        });
        let columns: Vec<f64> = columns
            .flat_map(|column| [column.x, column.y, column.z])
            .collect();
        let jacobian = DMatrix::from_column_slice(3, right.len(), &columns);
        let step = jacobian
            .svd(true, true)
            .solve(&DVector::from_column_slice(gap.as_slice()), 1e-6);
        let step = step.unwrap();
        right += &step * (0.3 / step.amax().max(0.3));
    }
    None
}

/// Readings of touches; the chain begins at the left hand, so its joints come from the wrist up.
pub(crate) fn touches() -> Vec<Vec<f64>> {
    const TRIED: usize = 400;
    const WANTED: usize = 80;
    // middle and half the range of each joint \[rad\], the rolls outwards
    let range =
        |joint: usize, side: f64| [(-0.9, 0.8), (-0.3 * side, 0.5), (-0.9, 0.9), (0.0, 0.9)][joint];
    let wave =
        |row: usize, of: usize| (1.0 + 0.7 * (row * (of + 2)) as f64 + 1.9 * of as f64).sin();
    let posture = |row: usize, first: usize, side: f64| -> Vec<f64> {
        let angle = |joint: usize| {
            let (middle, half) = range(joint, side);
            middle + half * wave(row, first + joint)
        };
        (0..ARM.len()).map(angle).collect()
    };
    let rows = (0..TRIED).filter_map(|row| {
        let mut left = posture(row, 0, 1.0);
        let mut right = touching(&left, &posture(row, ARM.len(), -1.0))?;
        left[ELBOW] -= ELBOWS_RAD[0];
        right[ELBOW] -= ELBOWS_RAD[1];
        left.reverse();
        Some([left, right].concat())
    });
    let rows: Vec<Vec<f64>> = rows.take(WANTED).collect();
    assert_eq!(rows.len(), WANTED, "the hands do not meet");
    rows
}

/// A log of the touches with further columns.
pub(crate) fn log(header: &str, cells: &str) -> String {
    let names: Vec<String> = (1..=2 * ARM.len())
        .map(|joint| format!("theta{joint}_rad"))
        .collect();
    let mut text = format!("{},{header}\n", names.join(","));
    for readings in touches() {
        let readings: Vec<String> = readings.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{},{cells}", readings.join(","));
    }
    text
}
