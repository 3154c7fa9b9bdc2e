//! Rigid bodies of a chain: mass matrix and bias forces from partial velocities of the mass centres.
//!
//! Source: Kane & Levinson, *Dynamics: Theory and Applications*, McGraw-Hill 1985, sections 2.14 and 6.1: the generalised
//! force of a body is the sum over its mass centre of partial velocity times inertia force and partial angular velocity times
//! inertia moment. With `Jv` and `Jw` the partial velocities,
//!
//! ```text
//! M = sum m Jv' Jv + Jw' I Jw
//! h = sum m Jv' (a0 - g) + Jw' (I alpha0 + omega x I omega)
//! ```
//!
//! where `a0` and `alpha0` are the accelerations at `q'' = 0`. No recursion of forces runs inwards, and no composite body is
//! formed: every body meets every joint before it.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

/// One body with the joint before it. The joint turns about z of its frame, or slides along it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) slides: bool,
    /// Frame of the joint in that of the body before.
    pub(crate) origin_m: Vector3<f64>,
    pub(crate) turn: Matrix3<f64>,
    pub(crate) mass_kg: f64,
    /// Centre of mass in the body's frame \[m\].
    pub(crate) centre_m: Vector3<f64>,
    /// About the centre of mass, along the body's axes \[kg m^2\].
    pub(crate) inertia_kgm2: Matrix3<f64>,
}

/// Bodies in a row, each behind a joint of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub(crate) links: Vec<Link>,
    pub(crate) gravity_mps2: Vector3<f64>,
    /// A place in the last body but those that are `behind` the flange \[m\].
    pub(crate) flange_m: Vector3<f64>,
    /// Bodies behind the flange: what swings from it.
    pub(crate) behind: usize,
}

/// What one body does at one instant, in the base's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Moved {
    turn: Matrix3<f64>,
    origin_m: Vector3<f64>,
    axis: Vector3<f64>,
    centre_m: Vector3<f64>,
    spin: Vector3<f64>,
    /// Velocity of the frame's origin.
    velocity: Vector3<f64>,
}

impl Default for Moved {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            origin_m: Vector3::zeros(),
            axis: Vector3::z(),
            centre_m: Vector3::zeros(),
            spin: Vector3::zeros(),
            velocity: Vector3::zeros(),
        }
    }
}

/// Mass matrix, bias and frames of a chain at one instant.
#[derive(Debug, Clone, Default)]
pub(crate) struct At {
    /// Row by row.
    pub(crate) mass: Vec<f64>,
    /// Forces of the joints that hold `q'' = 0`: Coriolis, centrifugal, gravity.
    pub(crate) bias: Vec<f64>,
    moved: Vec<Moved>,
    flange: usize,
    flange_m: Vector3<f64>,
    slides: Vec<bool>,
}

impl Chain {
    /// Works out mass matrix and bias at `angle` and `rate`, one entry for each body.
    pub(crate) fn at(&self, angle: &[f64], rate: &[f64], at: &mut At) {
        let count = self.links.len();
        at.mass.clear();
        at.mass.resize(count * count, 0.0);
        at.bias.clear();
        at.bias.resize(count, 0.0);
        at.moved.clear();
        at.flange = count - 1 - self.behind;
        at.flange_m = self.flange_m;
        at.slides.clear();
        let mut before = Moved::default();
        let (mut spin_rate, mut acceleration) = (Vector3::zeros(), -self.gravity_mps2);
        for (index, link) in self.links.iter().enumerate() {
            at.slides.push(link.slides);
            let (value, speed) = (angle[index], rate[index]);
            let carried = before.turn * link.origin_m;
            let mut origin_m = before.origin_m + carried;
            let mut velocity = before.velocity + before.spin.cross(&carried);
            acceleration +=
                spin_rate.cross(&carried) + before.spin.cross(&before.spin.cross(&carried));
            let mut turn = before.turn * link.turn;
            let axis: Vector3<f64> = turn.column(2).into_owned();
            let mut spin = before.spin;
            if link.slides {
                let slid = axis * value;
                origin_m += slid;
                velocity += before.spin.cross(&slid) + axis * speed;
                acceleration += spin_rate.cross(&slid)
                    + before.spin.cross(&before.spin.cross(&slid))
                    + 2.0 * speed * before.spin.cross(&axis);
            } else {
                spin_rate += before.spin.cross(&axis) * speed;
                spin += axis * speed;
                turn = turned(&turn, value);
            }
            let arm = turn * link.centre_m;
            before = Moved {
                turn,
                origin_m,
                axis,
                centre_m: origin_m + arm,
                spin,
                velocity,
            };
            at.moved.push(before);
            let inertia = turn * link.inertia_kgm2 * turn.transpose();
            let force_n = (acceleration + spin_rate.cross(&arm) + spin.cross(&spin.cross(&arm)))
                * link.mass_kg;
            let moment_nm = inertia * spin_rate + spin.cross(&(inertia * spin));
            at.add(index, link.mass_kg, &inertia, &force_n, &moment_nm);
        }
    }
}

/// `turn * Rz(angle)`.
fn turned(turn: &Matrix3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = libm::sincos(angle);
    let (x, y) = (turn.column(0), turn.column(1));
    Matrix3::from_columns(&[
        x * cosine + y * sine,
        y * cosine - x * sine,
        turn.column(2).into_owned(),
    ])
}

impl At {
    /// One body meets every joint before it.
    fn add(
        &mut self,
        body: usize,
        mass_kg: f64,
        inertia: &Matrix3<f64>,
        force_n: &Vector3<f64>,
        moment_nm: &Vector3<f64>,
    ) {
        let count = self.bias.len();
        let centre_m = self.moved[body].centre_m;
        for joint in 0..=body {
            let (linear, angular) = self.partial(joint, &centre_m);
            self.bias[joint] += linear.dot(force_n) + angular.dot(moment_nm);
            let (momentum, spin) = (linear * mass_kg, inertia * angular);
            for other in 0..=joint {
                let (linear, angular) = self.partial(other, &centre_m);
                let entry = linear.dot(&momentum) + angular.dot(&spin);
                self.mass[joint * count + other] += entry;
                if other != joint {
                    self.mass[other * count + joint] += entry;
                }
            }
        }
    }

    /// Partial velocity of a place that moves with the last body, and partial angular velocity.
    fn partial(&self, joint: usize, place_m: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let own = &self.moved[joint];
        if self.slides[joint] {
            (own.axis, Vector3::zeros())
        } else {
            (own.axis.cross(&(place_m - own.origin_m)), own.axis)
        }
    }

    /// Force that a joint needs for these accelerations, its rotor's inertia included.
    pub(crate) fn needed(&self, joint: usize, acceleration: &[f64], armature: f64) -> f64 {
        let count = acceleration.len();
        let row = self.mass[joint * count..(joint + 1) * count].iter();
        let inertial: f64 = row.zip(acceleration).map(|(entry, a)| entry * a).sum();
        inertial + armature * acceleration[joint] + self.bias[joint]
    }

    /// Energy of the weights, 0 at the base's origin \[J\].
    #[cfg(test)]
    pub(crate) fn potential_j(&self, chain: &Chain) -> f64 {
        let bodies = chain.links.iter().zip(&self.moved);
        bodies
            .map(|(link, moved)| -link.mass_kg * chain.gravity_mps2.dot(&moved.centre_m))
            .sum()
    }

    /// Where the flange is, and its velocity \[m\], \[m/s\].
    pub(crate) fn flange(&self) -> (Vector3<f64>, Vector3<f64>) {
        let own = &self.moved[self.flange];
        let arm = own.turn * self.flange_m;
        (own.origin_m + arm, own.velocity + own.spin.cross(&arm))
    }

    pub(crate) fn add_at_flange(&self, force_n: &Vector3<f64>, torque: &mut [f64]) {
        let (place_m, _) = self.flange();
        for joint in 0..=self.flange {
            torque[joint] += self.partial(joint, &place_m).0.dot(force_n);
        }
    }
}

/// Solves `matrix x = right` for a symmetric positive definite matrix, row by row, by `L D L'`; both are overwritten, `right` by
/// the solution. Source: Golub & Van Loan, *Matrix Computations*, 4th ed., section 4.1.2.
pub(crate) fn solve(matrix: &mut [f64], right: &mut [f64]) {
    let count = right.len();
    for column in 0..count {
        for row in column + 1..count {
            let factor = matrix[row * count + column] / matrix[column * count + column];
            for inner in row..count {
                matrix[inner * count + row] -= factor * matrix[inner * count + column];
            }
        }
        // what is left below the pivot are the entries of L times D
        let pivot = matrix[column * count + column];
        for row in column + 1..count {
            let factor = matrix[row * count + column] / pivot;
            right[row] -= factor * right[column];
        }
    }
    for row in (0..count).rev() {
        let pivot = matrix[row * count + row];
        let mut value = right[row];
        for below in row + 1..count {
            value -= matrix[below * count + row] * right[below];
        }
        right[row] = value / pivot;
    }
}
