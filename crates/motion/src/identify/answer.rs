//! From coordinates of a fit to the answer.

use haptical_dynamics::Inertia;
use haptical_model::{Device, JointType};
use nalgebra::DVector;

use crate::arm::PARAMETERS;
use crate::fit::problem::Problem;
use crate::identify::combinations::Combinations;
use crate::identify::estimate::Estimate;
use crate::identify::feasible::Feasible;
use crate::identify::fit::Settled;
use crate::identify::friction::FrictionLaw;
use crate::identify::numbers::Number;
use crate::identify::result::{BaseParameter, BodyDynamics, Estimated, JointDynamics};
use crate::identify::shape::Shape;
use crate::thresholds::identify::ARMATURE_SD;
use crate::thresholds::plausible;

/// From coordinates of the fit to an answer.
pub(crate) struct Answer<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) numbers: &'a [Number],
    pub(crate) settled: &'a Settled,
    pub(crate) feasible: &'a Feasible,
    pub(crate) shapes: &'a [(usize, Shape)],
}

impl Answer<'_> {
    fn of(&self, number: Number) -> Estimated {
        let place = self.numbers.iter().position(|own| *own == number);
        place.map_or(
            Estimated {
                value: 0.0,
                sd: 0.0,
            },
            |place| Estimated {
                value: number.nominal(self.problem) + self.feasible.values[place],
                sd: self.feasible.sd[place],
            },
        )
    }

    /// A joint's law with the size that its turnover says.
    fn law(&self, joint: usize) -> FrictionLaw {
        let (law, coulomb) = (
            self.settled.friction[joint],
            self.of(Number::Coulomb { joint }),
        );
        match coulomb.is_told() && coulomb.value > 0.0 {
            true => law.scaled(self.of(Number::Turnover { joint }).value / coulomb.value),
            false => law,
        }
    }

    pub(crate) fn joints(&self) -> Vec<JointDynamics> {
        let of = |joint: &usize| {
            let joint = *joint;
            JointDynamics {
                joint,
                law: self.law(joint),
                coulomb: self.of(Number::Coulomb { joint }),
                viscous: self.of(Number::Viscous { joint }),
                load: (self.numbers.contains(&Number::Load { joint }))
                    .then(|| self.of(Number::Load { joint })),
                carried: mean_size(self.problem.carried(joint)),
                armature: self.of(Number::Armature { joint }),
                offset: self.of(Number::Offset { joint }),
            }
        };
        self.problem.channels.iter().map(of).collect()
    }

    pub(crate) fn bodies(&self, is_held: &[bool]) -> Vec<BodyDynamics> {
        let masses = self.problem.arm.bodies.masses().iter().enumerate();
        let of = |(body, own): (usize, &haptical_model::RowMass)| {
            let entry = |entry| self.of(Number::Body { body, entry });
            let numbers: [Estimated; PARAMETERS] = std::array::from_fn(entry);
            BodyDynamics {
                row: own.row,
                inertia: match is_held[body] {
                    true => own.inertia,
                    false => Inertia::from_parameters(numbers.map(|own| own.value)),
                },
                nominal: own.inertia,
                sd: numbers.map(|own| own.sd),
                is_assumed: !own.has_mass,
                is_held: is_held[body],
            }
        };
        masses.map(of).collect()
    }

    pub(crate) fn base(
        &self,
        device: &Device,
        (base, estimate): (&Combinations, &Estimate),
        bias: Option<&[f64]>,
    ) -> Vec<BaseParameter> {
        let types: Vec<JointType> = device.joints.iter().map(|own| own.joint_type).collect();
        let nominal: Vec<f64> = (self.numbers.iter())
            .map(|own| own.nominal(self.problem))
            .collect();
        let nominal = &base.map * DVector::from_vec(nominal);
        let known: Vec<Option<f64>> = self.numbers.iter().map(|own| self.known_sd(*own)).collect();
        let of = |(row, kept): (usize, &usize)| {
            let kept = *kept;
            let others =
                (0..self.numbers.len()).filter(|k| *k != kept && base.map[(row, *k)] != 0.0);
            let terms: Vec<usize> = [kept].into_iter().chain(others).collect();
            let square = |k: &usize| Some((base.map[(row, *k)] * known[*k]?).powi(2));
            let square: Option<f64> = terms.iter().map(square).sum();
            BaseParameter {
                terms: (terms.iter())
                    .map(|k| (self.numbers[*k].name(self.problem), base.map[(row, *k)]))
                    .collect(),
                unit: self.numbers[kept].unit(&types),
                estimated: Estimated {
                    value: nominal[row] + estimate.values[row],
                    sd: estimate.sd[row],
                },
                nominal: nominal[row],
                known_sd: square.map(f64::sqrt),
                bias: bias.map(|own| own[row]),
            }
        };
        let all = base.kept().iter().enumerate();
        all.filter(|(_, kept)| !self.numbers[**kept].is_beside())
            .map(of)
            .collect()
    }

    /// Standard deviation of a body's number that is known beforehand, or of an armature's.
    fn known_sd(&self, number: Number) -> Option<f64> {
        match number {
            Number::Body { body, entry } => {
                let shape = self.shapes.iter().find(|own| own.0 == body);
                shape.map(|own| own.1.known_sd()[entry])
            }
            Number::Armature { joint } => {
                let stated = self.problem.arm.armature[joint].unwrap_or(0.0);
                Some(ARMATURE_SD * stated)
            }
            _ => None,
        }
    }

    pub(crate) fn delay(&self, base: &Combinations, estimate: &Estimate) -> Estimated {
        let place = |own: &usize| self.numbers[*own] == Number::Delay;
        let place = base.kept().iter().position(place);
        Estimated {
            // torques that are early are logged before their positions
            value: 0.0 - self.settled.early_s - place.map_or(0.0, |k| estimate.values[k]),
            sd: place.map_or(0.0, |k| {
                estimate.sd[k].hypot(plausible::OF_STEP * self.problem.samples.step_s)
            }),
        }
    }
}

fn mean_size(own: &[f64]) -> f64 {
    own.iter().map(|own| own.abs()).sum::<f64>() / own.len().max(1) as f64
}
