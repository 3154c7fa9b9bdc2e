//! What an identification of the dynamics gives.

use haptical_dynamics::Inertia;

use crate::identify::friction::FrictionLaw;
use crate::identify::instruments::Instruments;
use crate::identify::predict::Residual;
use crate::thresholds::identify::NORMAL_95;

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
}

impl Estimated {
    /// Normal 95 % interval.
    pub fn ci95(&self) -> [f64; 2] {
        let half = NORMAL_95 * self.sd;
        [self.value - half, self.value + half]
    }

    /// Whether the interval leaves 0 out.
    pub fn is_told(&self) -> bool {
        self.value.abs() > NORMAL_95 * self.sd
    }
}

/// Numbers of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDynamics {
    /// Joint, from 0.
    pub joint: usize,
    /// How its Coulomb friction turns over.
    pub law: FrictionLaw,
    /// Coulomb friction \[N m\], \[N\].
    pub coulomb: Estimated,
    /// Viscous friction \[N m s/rad\], \[N s/m\].
    pub viscous: Estimated,
    /// Share of what the joint carries that its friction has beside; none where the log does not show one.
    pub load: Option<Estimated>,
    /// Mean of what the joint carried, either way \[N m\], \[N\].
    pub carried: f64,
    /// Armature \[kg m^2\], \[kg\].
    pub armature: Estimated,
    /// What the torque reads without any \[N m\], \[N\].
    pub offset: Estimated,
}

/// A body of the feasible set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyDynamics {
    /// Row of the device, from 1.
    pub row: usize,
    /// What it carries, in the frame behind the row's motion.
    pub inertia: Inertia,
    /// The same in the device as it was.
    pub nominal: Inertia,
    /// Standard deviation of each of the ten parameters, by the log and by what is known of bodies beforehand.
    pub sd: [f64; 10],
    /// Whether nothing was known of it but its row's geometry.
    pub is_assumed: bool,
    /// Whether the file says that it weighs nothing: it is kept so.
    pub is_held: bool,
}

/// A combination of numbers that the motion fixes.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Numbers and their factors: `izz1`, `armature1`, `m2`, ...; the first one has the factor 1.
    pub terms: Vec<(String, f64)>,
    /// SI unit.
    pub unit: &'static str,
    /// Value and interval by the log alone.
    pub estimated: Estimated,
    /// The same combination of the device as it was.
    pub nominal: f64,
    /// Standard deviation that it may have by what is known beforehand; the log says little where its own is no smaller. None
    /// of friction, offsets and delay.
    pub known_sd: Option<f64>,
    /// What the noise of the positions is taken to have changed it by; none where instruments keep that out.
    pub bias: Option<f64>,
}

impl BaseParameter {
    /// Whether the log says more of it than what is known beforehand.
    pub fn is_determined(&self) -> bool {
        self.known_sd
            .is_none_or(|known| self.estimated.sd < 0.5 * known)
    }
}

/// Identified dynamics of a moving arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Dynamics {
    /// One entry a joint with torques.
    pub joints: Vec<JointDynamics>,
    /// One entry a moving row.
    pub bodies: Vec<BodyDynamics>,
    /// What the motion fixes.
    pub base: Vec<BaseParameter>,
    /// Numbers that no torque of this motion depends on.
    pub unseen: Vec<String>,
    /// How much later the torques are logged than their positions \[s\].
    pub delay_s: Estimated,
    /// On the fitted log.
    pub residuals: Vec<Residual>,
    /// On the log that was held out, or why it could not be predicted.
    pub validated: Option<Result<Vec<Residual>, String>>,
    /// What keeps the noise of positions out; none where nothing does.
    pub instruments: Option<Instruments>,
    /// Noise of each joint's position reading.
    pub position_sd: Vec<f64>,
    /// Edge of the band \[Hz\].
    pub edge_hz: f64,
    /// Rows of a joint behind the low pass.
    pub rows: usize,
    /// Variance of the numbers over that of independent rows.
    pub inflation: f64,
    /// What is odd.
    pub warnings: Vec<String>,
}

/// `||tau - model|| / ||tau||` over all joints \[%\]: of the device as it was, of the feasible set, of the base parameters.
pub fn stacked_percent(residuals: &[Residual]) -> [f64; 3] {
    let sum = |of: fn(&Residual) -> f64| residuals.iter().map(|own| of(own).powi(2)).sum::<f64>();
    let torque = sum(|own| own.torque_rms).max(1e-300);
    let share = |of: fn(&Residual) -> f64| 100.0 * (sum(of) / torque).sqrt();
    [
        share(|own| own.before_rms),
        share(|own| own.after_rms),
        share(|own| own.base_rms),
    ]
}
