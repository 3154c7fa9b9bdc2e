//! Random chains and trees, and where their links are by URDF's definition.

use std::fmt::Write;

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{
    Isometry3, Translation3, Unit, UnitQuaternion, Vector3,
};
use proptest::prelude::*;

/// One joint of a tree, and the link behind it: joint k leads to link k + 1.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) kind: &'static str,
    /// Link that it is on, from 0, the root.
    pub(crate) parent: usize,
    pub(crate) xyz: [f64; 3],
    pub(crate) rpy: [f64; 3],
    pub(crate) axis: [f64; 3],
    /// Follows the moving joint of this number, where that is another one that follows none.
    pub(crate) follows: Option<(usize, f64, f64)>,
}

fn part() -> impl Strategy<Value = Part> {
    let kind = prop::sample::select(vec![
        "fixed",
        "revolute",
        "continuous",
        "prismatic",
        "revolute",
    ]);
    let axis = prop_oneof![
        prop::sample::select(vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, -1.0],
        ]),
        prop::array::uniform3(-1.0..1.0_f64).prop_filter("a direction", |axis| {
            axis.iter().map(|part| part * part).sum::<f64>() > 0.01
        }),
    ];
    let place = prop_oneof![Just([0.0; 3]), prop::array::uniform3(-0.5..0.5_f64)];
    let turn = prop_oneof![
        Just([0.0; 3]),
        Just([0.0, std::f64::consts::FRAC_PI_2, 0.3]),
        prop::array::uniform3(-3.2..3.2_f64),
    ];
    let follows = prop_oneof![
        3 => Just(None),
        1 => (0..6_usize, prop_oneof![-2.0..-0.2, 0.2..2.0], -0.5..0.5).prop_map(Some),
    ];
    (kind, place, turn, axis, follows).prop_map(|(kind, xyz, rpy, axis, follows)| Part {
        kind,
        parent: 0,
        xyz,
        rpy,
        axis,
        follows,
    })
}

/// A chain with at least one joint that moves.
pub(crate) fn chain() -> impl Strategy<Value = Vec<Part>> {
    parts(1..9).prop_map(|mut parts| {
        for (index, part) in parts.iter_mut().enumerate() {
            part.parent = index;
        }
        parts
    })
}

/// A tree with at least one joint that moves: half of the joints are on the link before, the others anywhere before.
pub(crate) fn tree() -> impl Strategy<Value = Vec<Part>> {
    let parents = prop::collection::vec(prop::option::of(0..9_usize), 9);
    (parts(2..10), parents).prop_map(|(mut parts, parents)| {
        for (index, (part, parent)) in parts.iter_mut().zip(parents).enumerate() {
            part.parent = parent.map_or(index, |parent| parent % (index + 1));
        }
        parts
    })
}

/// Joints of which at least one moves, and who follows whom resolved.
fn parts(number: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Part>> {
    prop::collection::vec(part(), number).prop_map(|mut parts| {
        if parts.iter().all(|part| part.kind == "fixed") {
            parts[0].kind = "revolute";
        }
        let moving: Vec<usize> = (0..parts.len())
            .filter(|part| parts[*part].kind != "fixed")
            .collect();
        // the first free one is free, so that there is a joint of its own
        parts[moving[0]].follows = None;
        for part in 0..parts.len() {
            if let Some((which, _, _)) = parts[part].follows {
                let source = moving[which % moving.len()];
                if source == part || parts[source].follows.is_some() {
                    parts[part].follows = None;
                }
            }
        }
        let resolved: Vec<usize> = moving.clone();
        for part in &mut parts {
            if let Some((which, _, _)) = &mut part.follows {
                *which = resolved[*which % resolved.len()];
            }
        }
        parts
    })
}

/// The URDF: links l0, l1, ..., joints j0, j1, ...
pub(crate) fn text(parts: &[Part]) -> String {
    let mut text = "<robot name=\"random\">\n<link name=\"l0\"/>\n".to_owned();
    for (index, part) in parts.iter().enumerate() {
        let vector = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
        let _ = write!(
            text,
            "<link name=\"l{}\"/>\n<joint name=\"j{index}\" type=\"{}\">\n<origin xyz=\"{}\" rpy=\"{}\"/>\n\
             <parent link=\"l{}\"/><child link=\"l{}\"/><axis xyz=\"{}\"/>",
            index + 1,
            part.kind,
            vector(part.xyz),
            vector(part.rpy),
            part.parent,
            index + 1,
            vector(part.axis)
        );
        if let Some((source, multiplier, offset)) = part.follows {
            let _ = write!(
                text,
                "<mimic joint=\"j{source}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>"
            );
        }
        text.push_str("</joint>\n");
    }
    text + "</robot>"
}

/// A link in the root's frame as URDF defines it: T(xyz) R(rpy) then a turn about or a slide along the axis,
/// by quaternions.
pub(crate) fn placed(parts: &[Part], link: usize, value: &impl Fn(&str) -> f64) -> Isometry3<f64> {
    let mut above = Vec::new();
    let mut link = link;
    while link > 0 {
        above.push(link - 1);
        link = parts[link - 1].parent;
    }
    let mut product = Isometry3::identity();
    for index in above.into_iter().rev() {
        let part = &parts[index];
        let [roll, pitch, yaw] = part.rpy;
        let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        product *= Isometry3::from_parts(Translation3::from(Vector3::from(part.xyz)), turn);
        let own = match part.follows {
            Some((source, multiplier, offset)) => {
                multiplier * value(&format!("j{source}")) + offset
            }
            None if part.kind == "fixed" => 0.0,
            None => value(&format!("j{index}")),
        };
        let axis = Unit::new_normalize(Vector3::from(part.axis));
        match part.kind {
            "fixed" => {}
            "prismatic" => product *= Translation3::from(axis.into_inner() * own),
            _ => product *= UnitQuaternion::from_axis_angle(&axis, own),
        }
    }
    product
}

/// The same as a pose.
pub(crate) fn by_definition(parts: &[Part], link: usize, value: impl Fn(&str) -> f64) -> Pose {
    as_pose(&placed(parts, link, &value))
}

pub(crate) fn as_pose(place: &Isometry3<f64>) -> Pose {
    Pose {
        position_m: place.translation.vector,
        rotation: place.rotation.to_rotation_matrix().into_inner(),
    }
}
