//! The chain at one instant: axes, links with their motion, and what inertia, weight and the hand's
//! force ask of the drives.
//!
//! docs/diagnosis-force.md, "Torques of the drives", derives the formulas. All vectors are in frame
//! (-1).

use haptical_model::kinematics::{Convention, Link, Motion, Parameter, Pose};
use haptical_model::{Device, JointType};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Inertial parameters of a link: mass, first moments x y z, then xx yy zz xy xz yz of the inertia
/// tensor, in the frame after Rz(theta), about its origin.
pub(super) const PER_LINK: usize = 10;

/// The rows of a chain, homes added, with gravity.
#[derive(Debug)]
pub(super) struct Rows {
    convention: Convention,
    links: Vec<Link>,
    motions: Vec<Motion>,
    origins: Vec<Option<Pose>>,
    slides: Vec<bool>,
    pub(super) gravity_mps2: Vector3<f64>,
}

/// A joint's axis as a screw about the origin of frame (-1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    direction: Vector3<f64>,
    origin_m: Vector3<f64>,
    slides: bool,
}

/// One link: its frame and how that moves.
#[derive(Debug, Clone, Copy)]
struct Body {
    rotation: Matrix3<f64>,
    origin_m: Vector3<f64>,
    spin: Vector3<f64>,
    spin_rate: Vector3<f64>,
    acceleration: Vector3<f64>,
}

/// One elementary motion of a row, a turn or a slide along an axis: what a wrong row parameter
/// does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) parameter: Parameter,
    direction: Vector3<f64>,
    point_m: Vector3<f64>,
    /// Joints and links from these on are moved by it.
    first_joint: usize,
    first_body: usize,
}

/// A chain at one instant.
#[derive(Debug, Default)]
pub(super) struct Posture {
    pub(super) axes: Vec<Axis>,
    bodies: Vec<Body>,
    pub(super) steps: Vec<Step>,
    handle_m: Vector3<f64>,
    handle: Matrix3<f64>,
}

/// Mass and first moment (about the origin of frame (-1)) of a link and all that it carries.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Carried {
    mass_kg: f64,
    moment: Vector3<f64>,
}

impl Rows {
    pub(super) fn new(device: &Device, gravity_mps2: Vector3<f64>) -> Self {
        Self {
            convention: device.convention,
            links: device.chain_links(),
            motions: device.motions(),
            origins: device.chain_origins(),
            slides: device
                .joints
                .iter()
                .map(|joint| joint.joint_type == JointType::Prismatic)
                .collect(),
            gravity_mps2,
        }
    }

    /// The parameters of all rows, in the order of a posture's steps.
    pub(super) fn parameters(&self) -> impl Iterator<Item = Parameter> {
        let order = self.convention.order();
        self.links.iter().flat_map(move |_| order)
    }

    /// The chain at joint positions, rates and accelerations; `posture` is written over.
    pub(super) fn place(&self, joints: [&[f64]; 3], posture: &mut Posture) {
        let [position, rate, acceleration] = joints;
        posture.axes.clear();
        posture.bodies.clear();
        posture.steps.clear();
        let mut at = Body {
            rotation: Matrix3::identity(),
            origin_m: Vector3::zeros(),
            spin: Vector3::zeros(),
            spin_rate: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        for (row, (link, motion)) in self.links.iter().zip(&self.motions).enumerate() {
            if let Some(Some(origin)) = self.origins.get(row) {
                at.place(origin);
            }
            let variable = motion.variable();
            for parameter in self.convention.order() {
                let mut value = link.get(parameter);
                let (mut speed, mut change) = (0.0, 0.0);
                let column = match parameter {
                    Parameter::A | Parameter::Alpha => 0,
                    Parameter::B | Parameter::Beta => 1,
                    Parameter::D | Parameter::Theta => 2,
                };
                let direction: Vector3<f64> = at.rotation.column(column).into_owned();
                let is_joint = variable == Some(parameter) && row > 0;
                if is_joint {
                    let joint = row - 1;
                    value += position[joint];
                    speed = rate[joint];
                    change = acceleration[joint];
                    posture.axes.push(Axis {
                        direction,
                        origin_m: at.origin_m,
                        slides: self.slides[joint],
                    });
                }
                posture.steps.push(Step {
                    parameter,
                    direction,
                    point_m: at.origin_m,
                    first_joint: posture.axes.len(),
                    first_body: posture.bodies.len(),
                });
                if parameter.unit() == "m" {
                    at.slide(&direction, value, speed, change);
                } else {
                    at.turn(&direction, value, speed, change);
                }
                if is_joint {
                    posture.bodies.push(at);
                }
            }
        }
        if let Some(Some(origin)) = self.origins.get(self.links.len()) {
            at.place(origin);
        }
        posture.handle_m = at.origin_m;
        posture.handle = at.rotation;
    }
}

impl Body {
    /// Goes on to a frame that is fixed in this one.
    fn place(&mut self, constant: &Pose) {
        let arm = self.rotation * constant.position_m;
        self.acceleration += self.spin_rate.cross(&arm) + self.spin.cross(&self.spin.cross(&arm));
        self.origin_m += arm;
        self.rotation *= constant.rotation;
    }

    fn turn(&mut self, axis: &Vector3<f64>, angle: f64, rate: f64, acceleration: f64) {
        self.spin_rate += axis * acceleration + self.spin.cross(axis) * rate;
        self.spin += axis * rate;
        if angle != 0.0 {
            let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), angle);
            self.rotation = turn.matrix() * self.rotation;
        }
    }

    fn slide(&mut self, axis: &Vector3<f64>, length: f64, rate: f64, acceleration: f64) {
        let arm = axis * length;
        self.acceleration += self.spin_rate.cross(&arm)
            + self.spin.cross(&self.spin.cross(&arm))
            + self.spin.cross(axis) * (2.0 * rate)
            + axis * acceleration;
        self.origin_m += arm;
    }
}

impl Axis {
    /// Turning part and the arm that maps a force at a place to the joint.
    fn screw(&self, place_m: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        if self.slides {
            (Vector3::zeros(), self.direction)
        } else {
            (
                self.direction,
                self.direction.cross(&(place_m - self.origin_m)),
            )
        }
    }
}

impl Posture {
    /// The rigid-body regressor: `put(joint, parameter, torque)` for the torque \[N m\] (a force
    /// \[N\] at a sliding joint) that one unit of an inertial parameter asks of a joint's drive.
    ///
    /// Newton-Euler for a link about its frame's origin: force `m (a - g) + s' x c + s x (s x c)`,
    /// moment `c x (a - g) + I s' + s x I s`, c the first moment, s the spin (Khalil & Dombre,
    /// *Modeling, Identification and Control of Robots*, section 9.4).
    pub(super) fn regressor(&self, gravity: &Vector3<f64>, mut put: impl FnMut(usize, usize, f64)) {
        for (index, body) in self.bodies.iter().enumerate() {
            let own = body.rotation.transpose();
            let pull = own * (body.acceleration - gravity);
            let (spin, rate) = (own * body.spin, own * body.spin_rate);
            let square = spin.norm_squared();
            let first = PER_LINK * index;
            for (joint, axis) in self.axes.iter().enumerate().take(index + 1) {
                let (turn, arm) = axis.screw(&body.origin_m);
                let (turn, arm) = (own * turn, own * arm);
                put(joint, first, arm.dot(&pull));
                let moment =
                    pull.cross(&turn) + arm.cross(&rate) + spin * spin.dot(&arm) - arm * square;
                for axis in 0..3 {
                    put(joint, first + 1 + axis, moment[axis]);
                }
                let across = turn.cross(&spin);
                let entry = |a: usize, b: usize| turn[a] * rate[b] + across[a] * spin[b];
                for axis in 0..3 {
                    put(joint, first + 4 + axis, entry(axis, axis));
                }
                for (place, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
                    put(joint, first + 7 + place, entry(a, b) + entry(b, a));
                }
            }
        }
    }

    /// Row of the transposed Jacobian in the handle's frame: a force of the handle on the hand
    /// times it is the torque that the joint's drive exerts for it.
    pub(super) fn hand(&self, joint: usize) -> Vector3<f64> {
        let (_, arm) = self.axes[joint].screw(&self.handle_m);
        self.handle.tr_mul(&arm)
    }

    /// The handle in the frame of the last link, after its rotation \[m\].
    pub(super) fn handle_in_last_link(&self) -> Vector3<f64> {
        let last = self.bodies.last();
        last.map_or_else(Vector3::zeros, |body| {
            body.rotation.tr_mul(&(self.handle_m - body.origin_m))
        })
    }

    /// What each link carries, itself included, at these inertial parameters.
    pub(super) fn carried(&self, inertia: &[f64]) -> Vec<Carried> {
        let mut carried = vec![Carried::default(); self.bodies.len() + 1];
        for (index, body) in self.bodies.iter().enumerate().rev() {
            let own = &inertia[PER_LINK * index..PER_LINK * (index + 1)];
            let moment = body.rotation * Vector3::new(own[1], own[2], own[3]);
            carried[index] = Carried {
                mass_kg: carried[index + 1].mass_kg + own[0],
                moment: carried[index + 1].moment + body.origin_m * own[0] + moment,
            };
        }
        carried
    }

    /// Change of each joint's torque with one row parameter: weights and the hand's force act on a
    /// chain that is not quite as modelled (statics alone; `force` in the handle's frame).
    pub(super) fn geometry(
        &self,
        step: &Step,
        carried: &[Carried],
        gravity: &Vector3<f64>,
        force: &Vector3<f64>,
        torque: &mut [f64],
    ) {
        let slides = step.parameter.unit() == "m";
        let force = self.handle * force;
        let moved = &carried[step.first_body];
        // shift of the moved masses, of the handle, and turn of the hand's force
        let (shift, handle, turned) = if slides {
            (
                step.direction * moved.mass_kg,
                step.direction,
                Vector3::zeros(),
            )
        } else {
            (
                step.direction
                    .cross(&(moved.moment - step.point_m * moved.mass_kg)),
                step.direction.cross(&(self.handle_m - step.point_m)),
                step.direction.cross(&force),
            )
        };
        for (joint, axis) in self.axes.iter().enumerate() {
            torque[joint] = if joint < step.first_joint {
                let (turn, arm) = axis.screw(&self.handle_m);
                -turn.dot(&shift.cross(gravity))
                    - turn.dot(&handle.cross(&force))
                    - arm.dot(&turned)
            } else if slides {
                0.0
            } else {
                // joint and load turn together: for them gravity turns the other way
                let load = &carried[joint];
                let tilted = step.direction.cross(gravity);
                if axis.slides {
                    axis.direction.dot(&tilted) * load.mass_kg
                } else {
                    let arm = load.moment - axis.origin_m * load.mass_kg;
                    axis.direction.dot(&arm.cross(&tilted))
                }
            };
        }
    }
}
