//! What a joint's drive has to overcome beside its links: friction and cogging, with their slopes.

use haptical_model::transmission::loops::{STRIBECK_M_PER_S, STRIBECK_RAD_PER_S};
use haptical_model::{Device, DeviceEffect, FrictionNumber, JointType};

/// Shortest travel and slowest rate over which friction changes sides \[m\], \[rad\], per second.
const SHORTEST: f64 = 1e-9;
/// Over what Coulomb's friction changes sides.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// tanh(rate / this) \[rad/s\], \[m/s\].
    Rate(f64),
    /// Dahl's state over this travel \[rad\], \[m\].
    Travel(f64),
}

/// `joint-friction` of a device.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Friction {
    coulomb: f64,
    viscous: f64,
    stribeck: f64,
    stribeck_rate: f64,
    side: Side,
}

/// `motor-cogging` of a device: amplitude cos(periods theta - phase).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cogging {
    amplitude: f64,
    periods: f64,
    phase_rad: f64,
}

/// All of one joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct JointForces {
    friction: Vec<Friction>,
    cogging: Vec<Cogging>,
}

/// Where a joint was when its friction was last settled, and on which side each friction then was.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Settled {
    theta: f64,
    sides: Vec<f64>,
}

/// Torque that a drive loses, and how that changes with the joint's position and velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Resisted {
    pub(super) torque: f64,
    pub(super) by_theta: f64,
    pub(super) by_rate: f64,
}

impl JointForces {
    /// Takes an effect of the device; whether it is one of this kind.
    pub(super) fn take(&mut self, device: &Device, joint: usize, effect: &DeviceEffect) -> bool {
        let number = |keys: [&str; 2]| {
            let own = keys.iter().find_map(|key| effect.numbers.get(*key));
            own.copied()
        };
        let slides = device.joints[joint].joint_type == JointType::Prismatic;
        match effect.name.as_str() {
            _ if effect.is_friction() => {
                let of = |number: FrictionNumber| number.stated(effect);
                let rate = of(FrictionNumber::TurnoverSpeed);
                let travel = of(FrictionNumber::TurnoverTravel);
                let side = match (rate, travel) {
                    (Some(rate), _) => Side::Rate(rate.max(SHORTEST)),
                    (None, Some(travel)) => Side::Travel(travel.max(SHORTEST)),
                    (None, None) => return false,
                };
                self.friction.push(Friction {
                    coulomb: of(FrictionNumber::Coulomb).unwrap_or(0.0),
                    viscous: of(FrictionNumber::Viscous).unwrap_or(0.0),
                    stribeck: of(FrictionNumber::Stribeck).unwrap_or(0.0),
                    stribeck_rate: if slides {
                        STRIBECK_M_PER_S
                    } else {
                        STRIBECK_RAD_PER_S
                    },
                    side,
                });
                true
            }
            "motor-cogging" => {
                let ratio = device.joints[joint].transmission_ratio;
                self.cogging.push(Cogging {
                    amplitude: number(["amplitude_nm", "amplitude_n"]).unwrap_or(0.0),
                    periods: number(["order"; 2]).unwrap_or(1.0) * ratio,
                    phase_rad: number(["phase_rad"; 2]).unwrap_or(0.0),
                });
                true
            }
            _ => false,
        }
    }

    /// Rate over which Coulomb's friction changes sides, per its size; infinite without such a friction.
    pub(super) fn steadiness(&self) -> f64 {
        let own = self.friction.iter().filter_map(|own| match own.side {
            Side::Rate(transition) => Some(transition / (own.coulomb + own.stribeck).abs()),
            Side::Travel(_) => None,
        });
        own.fold(f64::INFINITY, f64::min)
    }

    /// A joint that has been at rest here, on no side.
    pub(super) fn settled(&self, theta: f64) -> Settled {
        Settled {
            theta,
            sides: vec![0.0; self.friction.len()],
        }
    }

    /// At a position and a rate, after a motion in one direction from where it was settled.
    pub(super) fn at(&self, settled: &Settled, theta: f64, rate: f64) -> Resisted {
        let mut sum = Resisted::default();
        for (own, before) in self.friction.iter().zip(&settled.sides) {
            let (side, by_theta, by_rate) = own.side.at(*before, theta - settled.theta, rate);
            let slow = rate / own.stribeck_rate;
            let share = libm::exp(-slow * slow);
            let size = own.coulomb + own.stribeck * share;
            let by_slow = -2.0 * slow / own.stribeck_rate * share * own.stribeck * side;
            sum.torque += size * side + own.viscous * rate;
            sum.by_theta += size * by_theta;
            sum.by_rate += size * by_rate + own.viscous + by_slow;
        }
        for own in &self.cogging {
            let (sine, cosine) = libm::sincos(own.periods * theta - own.phase_rad);
            sum.torque += own.amplitude * cosine;
            sum.by_theta -= own.amplitude * own.periods * sine;
        }
        sum
    }

    /// Settles friction at a new position.
    pub(super) fn settle(&self, settled: &mut Settled, theta: f64) {
        for (own, side) in self.friction.iter().zip(&mut settled.sides) {
            *side = own.side.at(*side, theta - settled.theta, 0.0).0;
        }
        settled.theta = theta;
    }
}

impl Side {
    /// Side after a travel, with its derivatives by position and rate: Dahl (1968), or tanh.
    fn at(self, before: f64, travel: f64, rate: f64) -> (f64, f64, f64) {
        match self {
            Self::Rate(transition) => {
                let side = libm::tanh(rate / transition);
                (side, 0.0, (1.0 - side * side) / transition)
            }
            Self::Travel(transition) => {
                let ahead = if travel == 0.0 { rate } else { travel };
                let direction = if ahead < 0.0 { -1.0 } else { 1.0 };
                let left = libm::exp(-travel.abs() / transition);
                let side = direction + (before - direction) * left;
                (side, (1.0 - side * direction) / transition, 0.0)
            }
        }
    }
}
