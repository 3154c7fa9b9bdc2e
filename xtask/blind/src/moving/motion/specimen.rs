//! One arm as it was built: masses, centres, inertias, rotors and friction of its own.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};

use crate::moving::arms::Arm;
use crate::moving::motion::rigid::Chain;
use crate::random::Random;

/// Share by which a mass is off, at most.
const MASS_SHARE: f64 = 0.1;
/// Share by which a moment of inertia is off beside its mass, at most.
const INERTIA_SHARE: f64 = 0.1;
/// Standard deviation of a coordinate of a centre of mass \[m\].
const CENTRE_SD_M: f64 = 0.002;
/// Share by which the inertia of a rotor is off, at most.
const ARMATURE_SHARE: f64 = 0.1;

/// How friction turns over from one direction to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sense {
    /// A bristle: `dz/dx = (1 - z sgn dx) / length`, of which a step is known in closed form. Source: Dahl, "Solid friction
    /// damping of mechanical vibrations", AIAA Journal 14, 1976.
    Bristle {
        /// Travel over which it yields, in the joint's unit.
        length: f64,
    },
    /// `2/pi atan(v / speed)`.
    Arctan {
        /// In the joint's unit per second.
        speed: f64,
    },
    /// `v / sqrt(v^2 + speed^2)`.
    Root {
        /// In the joint's unit per second.
        speed: f64,
    },
}

impl Sense {
    /// From -1 to 1, after a travel from where the bristle stood at `before`.
    pub(crate) fn at(self, before: f64, travel: f64, speed: f64) -> f64 {
        match self {
            Self::Bristle { length } if travel == 0.0 || length <= 0.0 => before,
            Self::Bristle { length } => {
                let towards = travel.signum();
                towards + (before - towards) * libm::exp(-travel.abs() / length)
            }
            Self::Arctan { speed: scale } => {
                libm::atan(speed / scale) * std::f64::consts::FRAC_2_PI
            }
            Self::Root { speed: scale } => speed / libm::sqrt(speed * speed + scale * scale),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Friction {
    /// Level that does not depend on speed \[N m\] (\[N\]).
    pub(crate) coulomb: f64,
    /// Torque at a speed of 1.
    pub(crate) viscous: f64,
    /// Power of the speed that the viscous part grows with.
    pub(crate) power: f64,
    pub(crate) sense: Sense,
}

impl Friction {
    pub(crate) fn drag(viscous: f64, power: f64, speed: f64) -> f64 {
        if power == 1.0 {
            viscous * speed
        } else {
            viscous * speed.signum() * libm::pow(speed.abs(), power)
        }
    }
}

/// A drive that gives way between motor and link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Soft {
    pub(crate) joint: usize,
    /// Near rest \[N m/rad\].
    pub(crate) stiffness: f64,
    /// Deflection at which it is twice as stiff \[rad\].
    pub(crate) hardens_rad: f64,
    /// \[N m s/rad\].
    pub(crate) damping: f64,
    pub(crate) play_rad: f64,
}

impl Soft {
    /// Torque from the motor to the link, at their distance and its rate.
    pub(crate) fn torque(&self, apart_rad: f64, rate: f64) -> f64 {
        let half = 0.5 * self.play_rad;
        let stretch = apart_rad - apart_rad.clamp(-half, half);
        if stretch == 0.0 && half > 0.0 {
            return 0.0;
        }
        let ratio = stretch / self.hardens_rad;
        self.stiffness * stretch * (1.0 + ratio * ratio) + self.damping * rate
    }
}

/// An arm that was built.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Specimen {
    pub(crate) chain: Chain,
    pub(crate) armature: Vec<f64>,
    pub(crate) friction: Vec<Friction>,
    pub(crate) soft: Option<Soft>,
    /// Damping of what swings behind the flange \[N m s/rad\].
    pub(crate) swing_damping: f64,
}

impl Specimen {
    pub(crate) fn draw(arm: &Arm, random: &mut Random) -> Self {
        let mut chain = arm.chain();
        for link in &mut chain.links {
            let heavier = 1.0 + random.uniform(-MASS_SHARE, MASS_SHARE);
            link.mass_kg *= heavier;
            for axis in 0..3 {
                link.centre_m[axis] += CENTRE_SD_M * random.normal_within(3.0);
            }
            let own =
                [(); 3].map(|()| heavier * (1.0 + random.uniform(-INERTIA_SHARE, INERTIA_SHARE)));
            let principal = Matrix3::from_diagonal(&Vector3::from(own));
            link.inertia_kgm2 *= principal;
        }
        let off = |random: &mut Random| 1.0 + random.uniform(-ARMATURE_SHARE, ARMATURE_SHARE);
        let kind = random.index(3);
        let has_power = random.unit() < 0.4;
        let friction = arm.axes.iter().map(|axis| {
            let power = if has_power {
                random.uniform(0.88, 0.97)
            } else {
                1.0
            };
            Friction {
                coulomb: axis.range * random.uniform(0.025, 0.07),
                viscous: axis.range * random.uniform(0.02, 0.06) / axis.speed,
                power,
                sense: match kind {
                    0 => Sense::Bristle {
                        length: axis.speed * random.around(2.5e-5, 2.0),
                    },
                    1 => Sense::Arctan {
                        speed: axis.speed * random.around(2.5e-3, 2.0),
                    },
                    _ => Sense::Root {
                        speed: axis.speed * random.around(5e-3, 2.0),
                    },
                },
            }
        });
        let friction = friction.collect();
        let armature = arm.axes.iter().map(|axis| axis.armature * off(random));
        let armature = armature.collect();
        Self {
            chain,
            armature,
            friction,
            soft: None,
            swing_damping: 0.0,
        }
    }
}
