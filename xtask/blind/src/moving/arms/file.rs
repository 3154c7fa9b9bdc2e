//! An arm as its user has it: a device file, or a URDF.

use std::fmt::Write;

use super::{Arm, Axis, GRAVITY_MPS2, of_rpy};
use haptical_model::kinematics::nalgebra::{Rotation3, UnitQuaternion};

/// Counts of an encoder behind a joint, per turn (per metre where it slides).
pub(crate) const OUTPUT_COUNTS: f64 = 524_288.0;

/// The device file of the arm as described. Rows have no numbers of their own: each stands behind a constant origin.
pub(crate) fn device_toml(arm: &Arm, has_second_encoders: bool) -> String {
    device_toml_of(arm, arm.axes, has_second_encoders)
}

/// The same with other numbers of its joints and bodies.
pub(crate) fn device_toml_of(arm: &Arm, axes: &[Axis], has_second_encoders: bool) -> String {
    let [x, y, z] = arm.flange_m;
    let row = "a_m = 0.0\nalpha_rad = 0.0\nd_m = 0.0\n";
    let mut text = format!(
        "[device]\nname = \"arm {}\"\ndof = {}\nhandle_xyz_m = [{x:?}, {y:?}, {z:?}]\n\n[gravity]\nvector_mps2 = \
         {GRAVITY_MPS2:?}\n\n[[link]]\n{row}",
        arm.name,
        arm.count(),
    );
    // writing to a string cannot fail
    for axis in axes {
        let turn = Rotation3::from_matrix_unchecked(of_rpy(axis.origin_rpy));
        let turn = UnitQuaternion::from_rotation_matrix(&turn);
        let turn = [turn.w, turn.i, turn.j, turn.k];
        let [ixx, iyy, izz] = axis.inertia_kgm2;
        let _ = write!(
            text,
            "\n[[link]]\n{row}origin_xyz_m = {:?}\norigin_wxyz = {turn:?}\nmass_kg = {:?}\ncentre_of_mass_m = \
             {:?}\ninertia_kgm2 = [{ixx:?}, {iyy:?}, {izz:?}, 0.0, 0.0, 0.0]\n",
            axis.origin_m, axis.mass_kg, axis.centre_m
        );
    }
    for (index, axis) in axes.iter().enumerate() {
        let (kind, unit, torque, armature) = match axis.slides {
            true => ("prismatic", "m", "torque_limit_n", "armature_kg"),
            false => ("revolute", "rad", "torque_limit_nm", "armature_kgm2"),
        };
        let [lower, upper] = axis.reach;
        let _ = write!(
            text,
            "\n[[joint]]\nname = \"{}\"\ntype = \"{kind}\"\nlower_{unit} = {lower:?}\nupper_{unit} = {upper:?}\n\
             transmission = \"direct\"\ntransmission_ratio = {:?}\nencoder_counts_per_rev = {:?}\n{armature} = \
             {:?}\n{torque} = {:?}\n",
            index + 1,
            axis.ratio,
            axis.counts,
            axis.armature,
            axis.range
        );
        if has_second_encoders {
            let _ = writeln!(text, "external_encoder_counts_per_rev = {OUTPUT_COUNTS:?}");
        }
    }
    text
}

pub(crate) fn urdf(arm: &Arm) -> String {
    let words = |numbers: [f64; 3]| numbers.map(|number| format!("{number}")).join(" ");
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n<link name=\"base\"/>\n",
        arm.name
    );
    let mut before = "base".to_owned();
    for (index, axis) in arm.axes.iter().enumerate() {
        let number = index + 1;
        let [ixx, iyy, izz] = axis.inertia_kgm2;
        let kind = if axis.slides { "prismatic" } else { "revolute" };
        let [lower, upper] = axis.reach;
        let _ = write!(
            text,
            "<link name=\"link{number}\"><inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/><mass value=\"{}\"/><inertia \
             ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"{iyy}\" iyz=\"0\" izz=\"{izz}\"/></inertial></link>\n<joint \
             name=\"joint{number}\" type=\"{kind}\"><parent link=\"{before}\"/><child link=\"link{number}\"/><origin \
             xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"0 0 1\"/><limit lower=\"{lower}\" upper=\"{upper}\" effort=\"{}\" \
             velocity=\"{}\"/></joint>\n",
            words(axis.centre_m),
            axis.mass_kg,
            words(axis.origin_m),
            words(axis.origin_rpy),
            axis.range,
            axis.speed
        );
        before = format!("link{number}");
    }
    let _ = write!(
        text,
        "<link name=\"flange\"/>\n<joint name=\"flange_fixed\" type=\"fixed\"><parent link=\"{before}\"/><child \
         link=\"flange\"/><origin xyz=\"{}\" rpy=\"0 0 0\"/></joint>\n</robot>\n",
        words(arm.flange_m)
    );
    text
}
