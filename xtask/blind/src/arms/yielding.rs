//! An arm that yields to its own weight: gears, bearings and links, and what it is screwed to.

use std::collections::BTreeMap;

use haptical_model::Device;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::random::Random;
use crate::rig::geometry::{Flex, link_rotation_after_axis, turn_z};

/// A gear's spring: soft until the teeth are in full contact, stiffer beyond.
///
/// Source: data sheets of strain wave gears give three stiffnesses, each above the one before.
#[derive(Debug, Clone, Copy)]
struct Gear {
    compliance_rad_per_nm: f64,
    /// Torque from which it is stiffer \[N m\].
    knee_nm: f64,
    /// Compliance beyond the knee, relative.
    beyond: f64,
}

impl Gear {
    fn turn_rad(&self, torque_nm: f64) -> f64 {
        let size = torque_nm.abs();
        let soft = size.min(self.knee_nm);
        let turn = soft + self.beyond * (size - soft);
        torque_nm.signum() * self.compliance_rad_per_nm * turn
    }
}

/// What yields, and how far.
#[derive(Debug, Clone, Default)]
pub(crate) struct Yielding {
    gears: Vec<Option<Gear>>,
    /// Across each joint's axis \[rad/(N m)\].
    across_rad_per_nm: Vec<f64>,
    /// The base, about any axis \[rad/(N m)\].
    base_rad_per_nm: f64,
}

/// Load of the weights beyond a joint, about its origin.
struct Load {
    /// Axes of the frame before the joint.
    before: Matrix3<f64>,
    moment_nm: Vector3<f64>,
}

fn loads(device: &Device, angle_rad: &[f64]) -> Vec<Load> {
    let mut rotation: Matrix3<f64> = Matrix3::identity();
    let mut origin_m: Vector3<f64> = Vector3::zeros();
    let gravity = Vector3::from(device.gravity_mps2.unwrap_or_default());
    let mut joints: Vec<(Matrix3<f64>, Vector3<f64>)> = Vec::new();
    let mut weights: Vec<(Vector3<f64>, Vector3<f64>)> = Vec::new();
    for (index, link) in device.links.iter().enumerate() {
        let mut angle = link.theta_rad;
        if let Some(joint) = index.checked_sub(1) {
            angle += device.joints[joint].home_rad + angle_rad[joint];
            joints.push((rotation, origin_m));
        }
        rotation *= turn_z(angle);
        if let Some(body) = device.bodies.get(index).copied().flatten() {
            let centre_m = origin_m + rotation * Vector3::from(body.centre_of_mass_m);
            weights.push((centre_m, gravity * body.mass_kg));
        } else {
            weights.push((origin_m, Vector3::zeros()));
        }
        origin_m += rotation * Vector3::new(link.a_m, 0.0, link.d_m);
        rotation *= link_rotation_after_axis(link);
    }
    let beyond = |joint: usize, about_m: &Vector3<f64>| {
        let mut moment = Vector3::zeros();
        for (centre_m, weight_n) in &weights[joint + 1..] {
            moment += (centre_m - about_m).cross(weight_n);
        }
        moment
    };
    let joints = joints.into_iter().enumerate();
    let load = |(joint, (before, about_m))| Load {
        before,
        moment_nm: beyond(joint, &about_m),
    };
    joints.map(load).collect()
}

impl Yielding {
    /// Gears of all joints, stiffer the more they carry (so that each turns by about as much at full load).
    pub(crate) fn of_joints(device: &Device, random: &mut Random) -> Self {
        let typical = typical_loads_nm(device, random);
        let gears = typical.iter().map(|load_nm| {
            Some(Gear {
                compliance_rad_per_nm: random.around(1.0, 4.0) / load_nm,
                knee_nm: load_nm * random.uniform(0.3, 1.0),
                beyond: random.uniform(0.65, 0.95),
            })
        });
        Self {
            gears: gears.collect(),
            across_rad_per_nm: vec![0.0; typical.len()],
            base_rad_per_nm: 0.0,
        }
    }

    /// With bearings and links that bend across the axes too.
    pub(crate) fn and_across(mut self, device: &Device, random: &mut Random) -> Self {
        let typical = typical_loads_nm(device, random);
        for (across, load_nm) in self.across_rad_per_nm.iter_mut().zip(typical) {
            *across = 0.6 * random.around(1.0, 3.0) / load_nm;
        }
        self
    }

    pub(crate) fn and_base(mut self, device: &Device, random: &mut Random) -> Self {
        let typical = typical_loads_nm(device, random);
        self.base_rad_per_nm = random.around(1.0, 2.0) / typical.first().copied().unwrap_or(1.0);
        self
    }

    /// All compliances times a factor.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        for gear in self.gears.iter_mut().flatten() {
            gear.compliance_rad_per_nm *= factor;
        }
        for across in &mut self.across_rad_per_nm {
            *across *= factor;
        }
        self.base_rad_per_nm *= factor;
        self
    }

    /// Turns of the joints \[rad\] at one posture, and the tilts between.
    pub(crate) fn at(&self, device: &Device, angle_rad: &[f64]) -> (Vec<f64>, Flex) {
        let mut flex = Flex {
            tilt_rad: vec![None; angle_rad.len()],
            tool_m: None,
        };
        let mut turns = vec![0.0; angle_rad.len()];
        if self.gears.is_empty() {
            return (turns, flex);
        }
        for (joint, load) in loads(device, angle_rad).into_iter().enumerate() {
            let own = load.before.transpose() * load.moment_nm;
            if let Some(gear) = &self.gears[joint] {
                turns[joint] = gear.turn_rad(own.z);
            }
            let across = self.across_rad_per_nm[joint];
            let mut tilt = Vector3::new(own.x, own.y, 0.0) * across;
            if joint == 0 {
                tilt += own * self.base_rad_per_nm;
            }
            flex.tilt_rad[joint] = Some(vec![tilt.into()]);
        }
        (turns, flex)
    }

    /// The joint that turns furthest over some postures.
    pub(crate) fn foremost(&self, device: &Device, postures: &[Vec<f64>]) -> Option<usize> {
        let mut squares = vec![0.0; device.joints.len()];
        for posture in postures {
            let (turns, _) = self.at(device, posture);
            for (square, turn) in squares.iter_mut().zip(turns) {
                *square += turn * turn;
            }
        }
        let joints = squares.iter().enumerate();
        joints
            .max_by(|a, b| a.1.total_cmp(b.1))
            .map(|(joint, _)| joint)
    }

    /// Compliances for readers.
    pub(crate) fn law(&self) -> BTreeMap<String, f64> {
        let mut law = BTreeMap::new();
        for (joint, gear) in self.gears.iter().enumerate() {
            if let Some(gear) = gear {
                let name = format!("compliance{}_rad_per_nm", joint + 1);
                law.insert(name, gear.compliance_rad_per_nm);
            }
        }
        law
    }
}

/// Largest moment of the weights about each joint's origin over some postures \[N m\].
fn typical_loads_nm(device: &Device, random: &mut Random) -> Vec<f64> {
    let mut largest = vec![1e-3_f64; device.joints.len()];
    for _ in 0..20 {
        let joints = device.joints.iter();
        let posture = joints.map(|joint| random.uniform(joint.lower_rad, joint.upper_rad));
        let posture: Vec<f64> = posture.collect();
        for (most, load) in largest.iter_mut().zip(loads(device, &posture)) {
            *most = most.max(load.moment_nm.norm());
        }
    }
    largest
}
