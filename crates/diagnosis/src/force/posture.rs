//! The chain at one instant: what joints and rows move, what links weigh, and how torques at rest depend on the rows.
//!
//! docs/diagnosis-force.md, "Torques of the drives", derives the formulas. Vectors are along the axes of frame (-1); twists
//! and moments are about the handle.

use haptical_model::dynamics::Inertia;
use haptical_model::kinematics::{LinkDerivatives, Parameter, Pose, Twist};
use haptical_model::{DeviceChain, ModelError, MotionWork};
use nalgebra::Vector3;

/// Inertial parameters of a link: mass, first moments x y z, then xx yy zz xy xz yz of the inertia tensor
/// ([`Inertia::parameters`]).
pub(super) const PER_LINK: usize = 10;

/// A chain at one instant.
#[derive(Debug)]
pub(super) struct Posture {
    handle: Pose,
    /// What each joint moves the handle by.
    joints: Vec<Twist>,
    /// The same for each number of each row, in the convention's order.
    steps: Vec<Step>,
    /// Frames of the links; positions from the handle.
    links: Vec<Pose>,
}

/// What a wrong number of a row does.
#[derive(Debug, Clone, Copy)]
struct Step {
    twist: Twist,
    /// Joints and links from these on are moved by it.
    first_joint: usize,
    first_link: usize,
}

impl Posture {
    /// The chain at joint positions; `work` has the frames of its links there.
    ///
    /// # Errors
    /// [`ModelError`] where the chain has no pose.
    pub(super) fn new(
        chain: &DeviceChain,
        joints: &[f64],
        work: &MotionWork,
    ) -> Result<Self, ModelError> {
        let chain = chain.chain()?;
        let mut rows = vec![LinkDerivatives::default(); chain.links().len()];
        let handle = chain.derivatives(joints, &mut rows)?;
        let order = chain.convention().order();
        // a link's frame is behind this turn; a slide of its joint changes places with what follows in the row
        let mut parameters = order.iter();
        let turn = parameters.position(|parameter| *parameter == Parameter::Theta);
        let step = |(row, place): (usize, usize)| Step {
            twist: rows[row].get(order[place]),
            first_joint: row.saturating_sub(usize::from(Some(place) < turn)),
            first_link: row.saturating_sub(usize::from(Some(place) <= turn)),
        };
        let places =
            (0..rows.len()).flat_map(|row| (0..order.len()).map(move |place| (row, place)));
        let moved = rows.iter().zip(chain.motions());
        let links = (0..joints.len()).filter_map(|link| work.pose(link));
        let from_handle = |link: &Pose| Pose {
            position_m: link.position_m - handle.position_m,
            ..*link
        };
        Ok(Self {
            joints: moved
                .filter_map(|(row, motion)| row.joint(*motion))
                .collect(),
            steps: places.map(step).collect(),
            links: links.map(from_handle).collect(),
            handle,
        })
    }

    /// Row of the transposed Jacobian in the handle's frame: a force of the handle on the hand
    /// times it is the torque that the joint's drive exerts for it.
    pub(super) fn hand(&self, joint: usize) -> Vector3<f64> {
        self.handle.rotation.tr_mul(&self.joints[joint].linear)
    }

    /// What each joint carries, at these inertial parameters; nothing behind the last one.
    fn carried(&self, inertia: &[f64]) -> Vec<Inertia> {
        let mut carried = vec![Inertia::default(); self.links.len() + 1];
        let (parameters, _) = inertia.as_chunks::<PER_LINK>();
        for (index, (link, numbers)) in self.links.iter().zip(parameters).enumerate().rev() {
            carried[index] = Inertia::from_parameters(*numbers).seen_from(link);
            let beyond = carried[index + 1];
            carried[index] += beyond;
        }
        carried
    }

    /// Torques for a unit acceleration of one joint: its column of the mass matrix, without rotors.
    pub(super) fn mass_column(&self, joint: usize, inertia: &[f64]) -> Vec<f64> {
        let carried = self.carried(inertia);
        let moved = &self.joints[joint];
        let torque = |(other, axis): (usize, &Twist)| {
            let load = &carried[joint.max(other)];
            let h = &load.first_moment_kgm;
            let force = moved.linear * load.mass_kg + moved.angular.cross(h);
            let moment = h.cross(&moved.linear) + load.about_origin_kgm2 * moved.angular;
            axis.linear.dot(&force) + axis.angular.dot(&moment)
        };
        self.joints.iter().enumerate().map(torque).collect()
    }

    /// `put(number, joint, change)` for the change of each joint's torque with each number of the rows: weights and the
    /// hand's force act on a chain that is not quite as modelled (statics alone; `force` in the handle's frame).
    pub(super) fn geometry(
        &self,
        inertia: &[f64],
        gravity: &Vector3<f64>,
        force: &Vector3<f64>,
        mut put: impl FnMut(usize, usize, f64),
    ) {
        let carried = self.carried(inertia);
        let force = self.handle.rotation * force;
        for (number, step) in self.steps.iter().enumerate() {
            let Twist { linear, angular } = step.twist;
            let moved = &carried[step.first_link];
            let shift = angular.cross(&moved.first_moment_kgm) + linear * moved.mass_kg;
            let moment = shift.cross(gravity) + linear.cross(&force);
            let (turned, tilted) = (angular.cross(&force), angular.cross(gravity));
            for (joint, axis) in self.joints.iter().enumerate() {
                let change = if joint < step.first_joint {
                    -axis.angular.dot(&moment) - axis.linear.dot(&turned)
                } else {
                    // joint and load turn together: for them gravity turns the other way
                    let load = &carried[joint];
                    let moment = load.first_moment_kgm.cross(&tilted);
                    axis.angular.dot(&moment) + axis.linear.dot(&tilted) * load.mass_kg
                };
                put(number, joint, change);
            }
        }
    }
}
