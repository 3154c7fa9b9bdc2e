//! Numbers of motion that stand: armature, damping, gains and the time step, from the inertia and the weight that each
//! joint carries (docs/equations.md, A simulated model that stands).

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, JointType};

use crate::write::effects::{Effects, Yield, YieldKind};
use haptical_model::RowBody;
use haptical_model::Segments;
use haptical_model::rigid::then;

/// Armature per inertia that a joint carries: assumption A151.
const ARMATURE: f64 = 0.1;
/// Time in which a joint that is left alone comes to rest \[s\]: assumption A151.
const COASTING_S: f64 = 1.0;
/// Damping of a spring per critical damping: assumption A151.
const SPRING_DAMPING: f64 = 0.05;
/// Least natural frequency of a joint that its actuator holds \[rad/s\]: assumption A151.
const HOLDING_RAD_PER_S: f64 = 50.0;
/// How far weight may pull a held joint away \[rad\], \[m\]: assumption A151.
const SAG: [f64; 2] = [0.01, 0.001];
/// Armature of what moves between a motor and its link, per inertia that it carries: assumption A151.
const YIELD_ARMATURE: f64 = 1e-3;
/// What a spring may be slowed down by armature that only stability asks for, per inertia that it carries.
const FURTHER_ARMATURE: f64 = 0.1;
/// Phase of the fastest spring in one step \[rad\].
const PHASE_RAD: f64 = 1.0;
/// Time steps, the longest that serves is taken \[s\].
const STEPS_S: [f64; 4] = [1e-3, 5e-4, 2e-4, 1e-4];
/// Least inertia of a joint \[kg m^2\], \[kg\]: below it MuJoCo takes a number for zero.
const LEAST_INERTIA: f64 = 1e-9;

/// What a joint carries, and what it is written with.
#[derive(Debug, Clone)]
pub(crate) struct RowDynamics {
    pub(crate) armature: f64,
    /// Whether the armature is the device's own.
    pub(crate) is_armature_known: bool,
    pub(crate) damping: f64,
    /// Whether the damping is the device's own.
    pub(crate) is_damping_known: bool,
    pub(crate) friction_loss: f64,
    /// Stiffness and damping of its position actuator.
    pub(crate) gains: [f64; 2],
    pub(crate) yields: Vec<RowYield>,
}

/// A yield with its numbers.
#[derive(Debug, Clone)]
pub(crate) struct RowYield {
    pub(crate) of: Yield,
    pub(crate) damping: f64,
    pub(crate) armature: f64,
}

impl RowDynamics {
    /// Armature with which its actuator is stable in every posture.
    fn needed(&self, step_s: f64) -> f64 {
        needed(step_s, self.gains[0], self.damping + self.gains[1])
    }
}

/// Inertia and load of a joint.
#[derive(Debug, Clone, Copy, Default)]
struct Carried {
    /// \[kg m^2\], \[kg\]
    inertia: f64,
    /// Largest torque of weight \[Nm\], \[N\].
    load: f64,
}

/// Frames behind the motions at home.
fn frames(device: &Device, segments: &Segments) -> Vec<Pose> {
    let mut frames: Vec<Pose> = Vec::with_capacity(segments.rows.len());
    for (row, segment) in segments.rows.iter().enumerate() {
        let parent = device
            .parent(row + 1)
            .and_then(|parent| parent.checked_sub(1));
        let parent = parent.and_then(|parent| frames.get(parent)).copied();
        let origin = segment.origin(device);
        frames.push(then(&parent.unwrap_or_default(), &origin));
    }
    frames
}

/// Inertia and weight that each row's joint carries, with every mass as far off as it is at home.
fn carried(device: &Device, segments: &Segments, bodies: &[RowBody], gravity: f64) -> Vec<Carried> {
    let frames = frames(device, segments);
    let mut carried = vec![Carried::default(); segments.rows.len()];
    for (row, (body, frame)) in bodies.iter().zip(&frames).enumerate() {
        let centre: Vector3<f64> = frame.position_m + frame.rotation * body.centre_m;
        // from the body's own row up to the root
        let mut next = Some(row);
        while let Some(joint) = next {
            let arm_m = (centre - frames[joint].position_m).norm();
            let own = &mut carried[joint];
            match segments.rows[joint].drive.motion {
                JointType::Revolute => {
                    own.inertia += body.mass_kg * arm_m * arm_m + 0.5 * body.inertia_kgm2.trace();
                    own.load += gravity * body.mass_kg * arm_m;
                }
                JointType::Prismatic => {
                    own.inertia += body.mass_kg;
                    own.load += gravity * body.mass_kg;
                }
            }
            next = device
                .parent(joint + 1)
                .and_then(|parent| parent.checked_sub(1));
        }
    }
    // a joint moves those that follow it too
    for row in 0..segments.rows.len() {
        if let Some((source, multiplier)) = segments.followed(device, row) {
            let own = carried[row];
            carried[source].inertia += multiplier * multiplier * own.inertia;
            carried[source].load += multiplier.abs() * own.load;
        }
    }
    carried
}

/// What a joint's numbers are divided by where rows follow it: each of its rows gets the same.
struct Shares {
    /// Of forces.
    of_force: f64,
    /// Of forces per speed or acceleration.
    of_inertia: f64,
}

/// Sums over a joint's own row and those that follow it, of how far each moves per motion of the own one.
fn shares(device: &Device, segments: &Segments, own: usize) -> Shares {
    let mut shares = Shares {
        of_force: 1.0,
        of_inertia: 1.0,
    };
    for row in 0..segments.rows.len() {
        let followed = segments.followed(device, row);
        if let Some((_, multiplier)) = followed.filter(|(source, _)| *source == own) {
            shares.of_force += multiplier.abs();
            shares.of_inertia += multiplier * multiplier;
        }
    }
    shares
}

/// Numbers of all rows, and the time step \[s\].
pub(crate) fn row_dynamics(
    device: &Device,
    segments: &Segments,
    bodies: &[RowBody],
    effects: &Effects<'_>,
    gravity_mps2: &[f64; 3],
) -> (Vec<RowDynamics>, f64) {
    let gravity = Vector3::from(*gravity_mps2).norm();
    let carried = carried(device, segments, bodies, gravity);
    let rows = segments.rows.iter().zip(&carried).enumerate();
    let rows = rows.map(|(row, (segment, carried))| {
        let inertia = carried.inertia.max(LEAST_INERTIA);
        let followed = segments.followed(device, row);
        let is_own = followed.is_none();
        let own = followed.map_or(row, |(source, _)| source);
        let shares = shares(device, segments, own);
        let friction = effects.friction.get(segment.drive.joint).copied();
        let friction = friction.unwrap_or_default();
        let coulomb = friction.coulomb.map(|own| own / shares.of_force);
        let viscous = friction.viscous.map(|own| own / shares.of_inertia);
        let known = segments.rows[own].armature(device);
        let known = known.map(|own| own / shares.of_inertia);
        let armature = known.unwrap_or(ARMATURE * inertia);
        let sag = SAG[usize::from(segment.drive.motion == JointType::Prismatic)];
        let stiffness = (inertia * HOLDING_RAD_PER_S * HOLDING_RAD_PER_S).max(carried.load / sag);
        let yields = effects.yields.get(segment.drive.joint).filter(|_| is_own);
        let multiplier = segment.drive.multiplier;
        let yields = yields.into_iter().flatten().map(|of| {
            let of = Yield {
                // torque per motion of a row that moves `multiplier` times as far
                kind: match of.kind {
                    YieldKind::Spring(stiffness) => {
                        YieldKind::Spring(stiffness / (multiplier * multiplier))
                    }
                    other => other,
                },
                ..of.clone()
            };
            RowYield {
                damping: match of.kind {
                    YieldKind::Spring(stiffness) => {
                        2.0 * SPRING_DAMPING * libm::sqrt(stiffness * inertia)
                    }
                    _ => inertia / COASTING_S,
                },
                armature: YIELD_ARMATURE * inertia,
                of,
            }
        });
        RowDynamics {
            armature,
            is_armature_known: known.is_some(),
            damping: viscous.unwrap_or(inertia / COASTING_S),
            is_damping_known: viscous.is_some(),
            friction_loss: coulomb.unwrap_or(0.0),
            // what follows with its share of known numbers has no actuator to be stable with
            gains: match is_own || known.is_none() {
                true => [
                    stiffness,
                    2.0 * libm::sqrt(stiffness * (inertia + armature)),
                ],
                false => [0.0; 2],
            },
            yields: yields.collect(),
        }
    });
    let mut rows: Vec<RowDynamics> = rows.collect();
    let step_s = step(&rows, &carried);
    for row in &mut rows {
        if !row.is_armature_known {
            row.armature = row.armature.max(row.needed(step_s));
        }
        for own in &mut row.yields {
            if let YieldKind::Spring(stiffness) = own.of.kind {
                own.armature = own.armature.max(needed(step_s, stiffness, own.damping));
            }
        }
    }
    (rows, step_s)
}

/// The longest time step that follows every spring and keeps it stable without much armature.
fn step(rows: &[RowDynamics], carried: &[Carried]) -> f64 {
    let serves = |step_s: &f64| {
        rows.iter().zip(carried).all(|(row, carried)| {
            let inertia = carried.inertia.max(LEAST_INERTIA);
            // motor and link swing against each other
            let reduced = row.armature * inertia / (row.armature + inertia);
            let is_steady = !row.is_armature_known || row.needed(*step_s) <= row.armature;
            is_steady
                && row.yields.iter().all(|own| match own.of.kind {
                    YieldKind::Spring(stiffness) => {
                        needed(*step_s, stiffness, own.damping) <= FURTHER_ARMATURE * inertia
                            && step_s * libm::sqrt(stiffness / reduced) <= PHASE_RAD
                    }
                    _ => true,
                })
        })
    };
    let [.., shortest] = STEPS_S;
    STEPS_S.into_iter().find(serves).unwrap_or(shortest)
}

/// Armature with which a spring is stable in every posture, twice over: h^2 k < 4 a + 2 h d.
pub(crate) fn needed(step_s: f64, stiffness: f64, damping: f64) -> f64 {
    (0.5 * step_s * (step_s * stiffness - damping)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of semi-implicit Euler with implicit damping, MuJoCo's for one joint: largest swing after a while.
    fn swing(step_s: f64, stiffness: f64, damping: f64, inertia: f64) -> f64 {
        let (mut x, mut v) = (1.0_f64, 0.0_f64);
        for _ in 0..20_000 {
            v = (inertia * v - step_s * stiffness * x) / (inertia + step_s * damping);
            x += step_s * v;
            if x.abs() > 1e6 {
                break;
            }
        }
        x.abs()
    }

    #[test]
    fn the_needed_armature_is_enough_and_a_third_of_it_is_not() {
        for (stiffness, damping) in [(1e4, 0.0), (1e4, 1.0), (3e5, 10.0)] {
            let step_s = 1e-3;
            let armature = needed(step_s, stiffness, damping);
            assert!(swing(step_s, stiffness, damping, armature) < 10.0);
            assert!(swing(step_s, stiffness, damping, armature / 3.0) > 1e3);
        }
    }
}
