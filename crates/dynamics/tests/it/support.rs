//! Random trees, and each function of the crate with vectors of its own.

use haptical_dynamics::nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use haptical_dynamics::{
    Body, DynamicsError, Inertia, Joint, Pose, Scratch, TorqueDerivatives, Tree, Wrench,
};
use proptest::prelude::*;

/// A tree and its gravity.
#[derive(Clone, Debug)]
pub(crate) struct Robot {
    pub(crate) bodies: Vec<Body>,
    pub(crate) gravity_mps2: Vector3<f64>,
}

/// Numbers of joints, one vector each.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) ddq: Vec<f64>,
}

impl Robot {
    pub(crate) fn tree(&self) -> Tree<'_> {
        Tree::new(&self.bodies, self.gravity_mps2).unwrap()
    }

    /// Calls a function of the tree with room for its answer.
    pub(crate) fn call(
        &self,
        entries: usize,
        function: impl Fn(&Tree<'_>, &mut [Scratch], &mut [f64]) -> Result<(), DynamicsError>,
    ) -> Vec<f64> {
        let mut scratch = vec![Scratch::default(); self.bodies.len()];
        // what a call leaves in its slices must not matter
        let mut out = vec![f64::NAN; entries];
        function(&self.tree(), &mut scratch, &mut out).unwrap();
        out
    }

    pub(crate) fn inverse(&self, state: &State, wrenches: &[Wrench]) -> Vec<f64> {
        let State { q, dq, ddq } = state;
        self.call(q.len(), |tree, scratch, out| {
            tree.inverse_dynamics(q, dq, ddq, wrenches, scratch, out)
        })
    }

    pub(crate) fn bias(&self, state: &State) -> Vec<f64> {
        self.call(state.q.len(), |tree, scratch, out| {
            tree.bias_forces(&state.q, &state.dq, scratch, out)
        })
    }

    pub(crate) fn forward(&self, state: &State, tau: &[f64], wrenches: &[Wrench]) -> Vec<f64> {
        self.call(tau.len(), |tree, scratch, out| {
            tree.forward_dynamics(&state.q, &state.dq, tau, wrenches, scratch, out)
        })
    }

    pub(crate) fn mass(&self, q: &[f64]) -> Vec<f64> {
        self.call(q.len() * q.len(), |tree, scratch, out| {
            tree.mass_matrix(q, scratch, out)
        })
    }

    pub(crate) fn regressor(&self, state: &State) -> Vec<f64> {
        let State { q, dq, ddq } = state;
        self.call(10 * q.len() * q.len(), |tree, scratch, out| {
            tree.regressor(q, dq, ddq, scratch, out)
        })
    }

    /// By positions, and by velocities.
    pub(crate) fn derivatives(&self, state: &State) -> [Vec<f64>; 2] {
        let State { q, dq, ddq } = state;
        let mut by_dq = vec![f64::NAN; q.len() * q.len()];
        let mut by_q = by_dq.clone();
        let mut scratch = vec![Scratch::default(); q.len()];
        let out = TorqueDerivatives {
            by_q: &mut by_q,
            by_dq: &mut by_dq,
        };
        self.tree()
            .torque_derivatives(q, dq, ddq, &mut scratch, out)
            .unwrap();
        [by_q, by_dq]
    }

    /// Kinetic and potential energy.
    pub(crate) fn energies(&self, q: &[f64], dq: &[f64]) -> [f64; 2] {
        let mut scratch = vec![Scratch::default(); q.len()];
        let tree = self.tree();
        [
            tree.kinetic_energy_j(q, dq, &mut scratch).unwrap(),
            tree.potential_energy_j(q, &mut scratch).unwrap(),
        ]
    }
}

/// Largest difference per largest entry, which counts as 1 at least; infinite where a number is not one.
pub(crate) fn gap(left: &[f64], right: &[f64]) -> f64 {
    assert_eq!(left.len(), right.len());
    let size = right
        .iter()
        .fold(1.0_f64, |size, value| size.max(value.abs()));
    let gaps = left.iter().zip(right).map(|(l, r)| (l - r).abs() / size);
    gaps.fold(0.0, |worst, gap| {
        if gap.is_nan() {
            f64::INFINITY
        } else {
            f64::max(worst, gap)
        }
    })
}

pub(crate) fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-size..size).prop_map(Vector3::from)
}

/// A direction that is no axis of a frame.
fn axis() -> impl Strategy<Value = Unit<Vector3<f64>>> {
    vector(1.0)
        .prop_filter("a direction", |own| own.norm() > 0.1)
        .prop_map(Unit::new_normalize)
}

/// Four point masses: every inertia is physical.
fn inertia() -> impl Strategy<Value = Inertia> {
    prop::collection::vec((0.1..1.0_f64, vector(0.3)), 4).prop_map(|points| {
        let mut sum = Inertia::default();
        for (mass_kg, place_m) in points {
            sum += Inertia::about_centre(mass_kg, &place_m, &Matrix3::zeros());
        }
        sum
    })
}

fn body() -> impl Strategy<Value = Body> {
    let joint = (axis(), prop::bool::weighted(0.7)).prop_map(|(axis, turns)| {
        if turns {
            Joint::Revolute(axis)
        } else {
            Joint::Prismatic(axis)
        }
    });
    let armature = prop_oneof![Just(0.0), 0.0..0.3_f64];
    (joint, vector(0.5), vector(3.0), inertia(), armature).prop_map(
        |(joint, position_m, turn, inertia, armature_kgm2)| Body {
            parent: None,
            placement: Pose {
                position_m,
                rotation: *Rotation3::new(turn).matrix(),
            },
            joint,
            inertia,
            armature_kgm2,
        },
    )
}

/// Trees of 1 to `most` joints with branches, in any order in which parents come first.
pub(crate) fn robot(most: usize) -> impl Strategy<Value = Robot> {
    let bodies = prop::collection::vec((body(), any::<prop::sample::Index>()), 1..=most);
    (bodies, vector(10.0)).prop_map(|(bodies, gravity_mps2)| Robot {
        bodies: bodies
            .into_iter()
            .enumerate()
            .map(|(index, (body, parent))| Body {
                // the base counts as one more
                parent: parent.index(index + 1).checked_sub(1),
                ..body
            })
            .collect(),
        gravity_mps2,
    })
}

/// A robot and a motion of it.
pub(crate) fn moving(most: usize) -> impl Strategy<Value = (Robot, State)> {
    robot(most).prop_flat_map(|robot| {
        let count = robot.bodies.len();
        let numbers = move |size: f64| prop::collection::vec(-size..size, count);
        let state = (numbers(3.0), numbers(3.0), numbers(5.0));
        let state = state.prop_map(|(q, dq, ddq)| State { q, dq, ddq });
        (Just(robot), state)
    })
}
