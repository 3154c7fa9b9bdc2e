//! A free curve over one covariate that is added to a joint's angle: what is done about a gap whose cause is not known. It is no
//! effect of the catalogue and never a cause.

mod resolve;

use haptical_model::Device;
use haptical_model::transmission::spline::curve;

use crate::laws::{Input, Law, Placed};
use crate::{Effect, Family, Follows, Form, Hook, Need, Parameter, Spec};

pub use self::resolve::curve_of;
pub(crate) use self::resolve::resolved;

/// Its name in a device file.
pub const NAME: &str = "correction";
/// Most coefficients that a device file may have: the reader takes no longer lists.
pub const MOST_COEFFICIENTS: usize = 100;

/// What a curve is drawn over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// The joint's own angle, or travel, as its motor encoder reads it.
    Angle,
    /// The joint's torque, or force.
    Torque,
    /// The temperature.
    Temperature,
    /// The time since the start of the run.
    Time,
}

const fn over(parameters: &'static [Parameter], needs: &'static [Need], follows: Follows) -> Spec {
    Spec {
        name: NAME,
        meaning: "a curve that was fitted to a gap of unknown cause",
        inspect: "the place where the curve is largest",
        adds: "a curve of cubic splines",
        hook: Hook::Transmission,
        form: Form::Curve,
        needs,
        parameters,
        follows,
        ..Spec::of(Family::Shape)
    }
}

const fn ends(from: &'static str, to: &'static str) -> [Parameter; 2] {
    [
        Parameter::size(from, 0.0, f64::MAX),
        Parameter::size(to, 0.0, f64::MAX),
    ]
}

static OVER_ANGLE: Spec = over(&ends_of::RAD, &[], Follows::Angle);
static OVER_TRAVEL: Spec = over(&ends_of::M, &[], Follows::Angle);
static OVER_TORQUE: Spec = over(&ends_of::NM, &[Need::Torque], Follows::Torque);
static OVER_FORCE: Spec = over(&ends_of::N, &[Need::Torque], Follows::Torque);
static OVER_TEMPERATURE: Spec = over(&ends_of::DEGC, &[Need::Temperature], Follows::Temperature);
static OVER_TIME: Spec = over(&ends_of::S, &[Need::Time], Follows::Time);

/// Names of a curve's ends.
mod ends_of {
    use super::{Parameter, ends};

    pub(super) static RAD: [Parameter; 2] = ends("from_rad", "to_rad");
    pub(super) static M: [Parameter; 2] = ends("from_m", "to_m");
    pub(super) static NM: [Parameter; 2] = ends("from_nm", "to_nm");
    pub(super) static N: [Parameter; 2] = ends("from_n", "to_n");
    pub(super) static DEGC: [Parameter; 2] = ends("from_degc", "to_degc");
    pub(super) static S: [Parameter; 2] = ends("from_s", "to_s");
}

impl Over {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Angle, Self::Torque, Self::Temperature, Self::Time];

    /// What is known of such a curve at a joint (from 0) of a device: its two parameters are the ends of its range.
    pub fn spec(self, device: &Device, joint: usize) -> &'static Spec {
        let slides = unit_of(device, joint) == "m";
        match (self, slides) {
            (Self::Angle, false) => &OVER_ANGLE,
            (Self::Angle, true) => &OVER_TRAVEL,
            (Self::Torque, false) => &OVER_TORQUE,
            (Self::Torque, true) => &OVER_FORCE,
            (Self::Temperature, _) => &OVER_TEMPERATURE,
            (Self::Time, _) => &OVER_TIME,
        }
    }
}

fn unit_of(device: &Device, joint: usize) -> &'static str {
    device.joints.get(joint).map_or("rad", |joint| joint.unit())
}

/// Key of the coefficients in a device file: what the curve adds is in the joint's unit.
pub fn coefficients_key(device: &Device, joint: usize) -> &'static str {
    match unit_of(device, joint) {
        "m" => "coefficients_m",
        _ => "coefficients_rad",
    }
}

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it is drawn over.
    pub over: Over,
    /// Ends of its range, in the covariate's unit.
    pub range: [f64; 2],
    /// Its coefficients \[rad\], \[m\] of a slide ([`haptical_model::transmission::spline`]).
    pub coefficients: Vec<f64>,
}

impl Curve {
    /// The curve as an effect of a joint (from 0); its one amplitude is the share of it that there is, 1.
    pub fn at(self, device: &Device, joint: usize) -> Box<dyn Effect> {
        Box::new(Placed {
            spec: self.over.spec(device, joint),
            joint: Some(joint),
            law: self,
        })
    }
}

/// A covariate's value at every row.
fn covariate(over: Over, input: Input<'_, '_>) -> Option<Vec<f64>> {
    match over {
        Over::Angle => input.reading().map(<[f64]>::to_vec),
        Over::Torque => input.torque_nm().map(<[f64]>::to_vec),
        Over::Temperature => {
            let reference_degc = input.context.reference_degc;
            let warming = input.context.warming_k.as_ref()?.iter();
            Some(warming.map(|warming| warming + reference_degc).collect())
        }
        Over::Time => input.context.elapsed_s(),
    }
}

impl Law for Curve {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let [from, to] = self.range;
        let places = covariate(self.over, input)?.into_iter();
        let value =
            |place| curve(place, from, to, &self.coefficients).map_or(0.0, |(value, _)| value);
        Some(vec![places.map(value).collect()])
    }

    fn values(&self, _: Input<'_, '_>, _: &[f64], _: f64) -> Vec<f64> {
        self.range.to_vec()
    }

    fn amplitudes(&self, _: Input<'_, '_>, _: &[f64]) -> (Vec<f64>, f64) {
        (vec![1.0], 0.0)
    }
}
