//! What `<compiler>` of an MJCF makes of the masses that bodies state: bounds from below, balanced inertias, a total mass.

use haptical_model::kinematics::nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::numbers::rounded;
use crate::robot::xml::{Element, Reader, Result};
use crate::robot::{Inertial, Robot};

/// Rounding of an inertia's axes: MuJoCo balances what its own digits show.
const ROUNDING: f64 = 1e-12;

/// The rules, in the order in which MuJoCo applies them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MassRules {
    /// Least mass of a body \[kg\].
    least_kg: f64,
    /// Least principal moment \[kg m^2\].
    least_kgm2: f64,
    /// Whether an inertia that no body has becomes that of a ball.
    balances: bool,
    /// Mass of all bodies together \[kg\]; none at 0 or below.
    total_kg: f64,
}

/// A body of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MassOf {
    pub(crate) link: usize,
    /// Where MuJoCo puts the mass of a body that states none: its place in its parent, taken in its own frame \[m\].
    pub(crate) place_m: Vector3<f64>,
    /// Whether MuJoCo works its mass out from geoms.
    pub(crate) is_of_geoms: bool,
}

impl MassRules {
    /// Adds what a `<compiler>` says.
    pub(crate) fn add(&mut self, reader: &Reader<'_, '_>, node: Element<'_, '_>) -> Result<()> {
        let one = |key| reader.one(node, "<compiler>", key);
        self.least_kg = one("boundmass")?.unwrap_or(self.least_kg);
        self.least_kgm2 = one("boundinertia")?.unwrap_or(self.least_kgm2);
        self.total_kg = one("settotalmass")?.unwrap_or(self.total_kg);
        if let Some(balances) = node.attribute("balanceinertia") {
            self.balances = balances == "true";
        }
        Ok(())
    }

    /// The attributes that change masses.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let named = [
            (self.total_kg > 0.0, "settotalmass"),
            (self.least_kg > 0.0, "boundmass"),
            (self.least_kgm2 > 0.0, "boundinertia"),
            (self.balances, "balanceinertia"),
        ];
        let named = named.into_iter().filter(|(is_set, _)| *is_set);
        named.map(|(_, name)| name).collect()
    }

    /// Whether a body that states no mass gets one.
    pub(crate) fn has_bounds(&self) -> bool {
        self.least_kg > 0.0 || self.least_kgm2 > 0.0
    }

    /// Gives every body the mass and the inertia that MuJoCo's compiler gives it.
    pub(crate) fn apply(&self, robot: &mut Robot, bodies: &[MassOf], is_whole: bool, file: &str) {
        robot.mass_rules = self.names();
        if robot.mass_rules.is_empty() {
            return;
        }
        for body in bodies.iter().filter(|body| !body.is_of_geoms) {
            let entry = &mut robot.links[body.link].inertial;
            *entry = self.bounded(*entry, body);
        }
        if self.total_kg <= 0.0 {
            return;
        }
        if !is_whole || bodies.iter().any(|body| body.is_of_geoms) {
            robot.notes.push(format!(
                "{file}: settotalmass=\"{}\" is left out, because masses of geoms are not read, and its factor depends on them: \
                 masses are not those that MuJoCo simulates",
                rounded(self.total_kg)
            ));
            return;
        }
        let masses = bodies
            .iter()
            .filter_map(|body| robot.links[body.link].inertial);
        let sum_kg: f64 = masses.map(|entry| entry.mass_kg).sum();
        let factor = self.total_kg / sum_kg;
        if !factor.is_finite() {
            return;
        }
        for body in bodies {
            if let Some(entry) = &mut robot.links[body.link].inertial {
                entry.mass_kg *= factor;
                entry.inertia_kgm2 = entry.inertia_kgm2.map(|inertia| inertia * factor);
            }
        }
    }

    fn bounded(&self, entry: Option<Inertial>, body: &MassOf) -> Option<Inertial> {
        if entry.is_none() && !self.has_bounds() {
            return None;
        }
        let entry = entry.unwrap_or(Inertial {
            mass_kg: 0.0,
            centre_m: body.place_m.into(),
            // a point
            inertia_kgm2: Some(Matrix3::zeros()),
        });
        let mut inertia_kgm2 = entry.inertia_kgm2;
        if self.least_kgm2 > 0.0 {
            let stated = inertia_kgm2.unwrap_or_else(Matrix3::zeros);
            inertia_kgm2 = Some(at_least(&stated, self.least_kgm2));
        }
        if self.balances {
            inertia_kgm2 = inertia_kgm2.map(|entry| balanced(&entry));
        }
        Some(Inertial {
            mass_kg: entry.mass_kg.max(self.least_kg),
            inertia_kgm2,
            ..entry
        })
    }
}

/// An inertia whose principal moments are at least as large.
fn at_least(inertia: &Matrix3<f64>, least: f64) -> Matrix3<f64> {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::new(*inertia);
    if eigenvalues.min() >= least {
        return *inertia;
    }
    let moments = eigenvalues.map(|entry| entry.max(least));
    eigenvectors * Matrix3::from_diagonal(&moments) * eigenvectors.transpose()
}

/// The mean of the moments about each axis, where one is larger than the sum of the two others.
fn balanced(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    let trace = inertia.trace();
    let largest = inertia.symmetric_eigenvalues().max();
    match 2.0 * largest - trace > ROUNDING * trace.abs() {
        true => Matrix3::identity() * (trace / 3.0),
        false => *inertia,
    }
}
