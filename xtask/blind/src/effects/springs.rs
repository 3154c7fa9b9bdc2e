//! Compliance: pre-tensioned cable strands, links behind the encoder, creep, slip at peaks.

use haptical_model::TransmissionKind;

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts};
use crate::laws::{ramp, slope_beside, slope_of};
use crate::rig::scene::Scene;
use crate::truth::Event;

/// Names that data cannot tell apart where no external encoder sits between them.
const EITHER_COMPLIANCE: [&str; 2] = ["capstan-compliance", "joint-compliance"];
/// Order of the polynomial in place of a parallelogram's error.
const POLYNOMIAL_ORDER: i32 = 10;

/// Two pre-tensioned strands: stiff together, half as stiff once one is slack, each a little harder
/// the further it is drawn (a stranded rope settles).
#[derive(Debug)]
struct Strands {
    compliance_rad_per_nm: f64,
    /// Load at which one strand is slack \[N m\].
    slack_nm: f64,
    /// Load at which settling has made the strands stiffer by half \[N m\].
    settling_nm: f64,
    sign: f64,
}

impl Strands {
    fn draw(draw: &mut Draw<'_>, stiffness_nm_per_rad: f64, sign: f64) -> Self {
        let stiffness = draw.random.around(stiffness_nm_per_rad, 3.0);
        Self {
            compliance_rad_per_nm: draw.size / stiffness,
            slack_nm: draw.random.uniform(1.0, 2.5),
            settling_nm: draw.random.uniform(6.0, 15.0),
            sign,
        }
    }

    fn deflection_rad(&self, torque_nm: f64) -> f64 {
        let load = torque_nm.abs();
        let taut = load / (1.0 + load / (2.0 * self.settling_nm));
        let beyond = (load - self.slack_nm).max(0.0);
        self.sign * self.compliance_rad_per_nm * torque_nm.signum() * (taut + beyond)
    }
}

/// Shapes over the joint's angle that its transmission's errors take up (eqs. (1) and (2)): weight hangs on the
/// angle, and a spring that is not linear has another slope in what is left.
fn taken_up(scene: &Scene<'_>, joint: usize) -> Vec<Vec<f64>> {
    let angle = &scene.motion.angle_rad[joint];
    let shape = |of: &dyn Fn(f64) -> f64| angle.iter().map(|angle| of(*angle)).collect();
    let description = &scene.device.joints[joint];
    if description.output_sd_rad().is_none() {
        return Vec::new();
    }
    match description.transmission {
        TransmissionKind::Direct => Vec::new(),
        TransmissionKind::Capstan => vec![shape(&|a| a), shape(&libm::sin), shape(&libm::cos)],
        TransmissionKind::Parallelogram => (1..=POLYNOMIAL_ORDER)
            .map(|order| shape(&|a| libm::pow(a, f64::from(order))))
            .collect(),
    }
}

impl Law for Strands {
    fn deviation(&self, scene: &Scene<'_>, place: Place, _signal: &[f64]) -> Vec<f64> {
        place.joint().map_or_else(Vec::new, |joint| {
            let torque = scene.torque_nm[joint].iter();
            torque.map(|torque| self.deflection_rad(*torque)).collect()
        })
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let facts = Facts::default()
            .law("initial_compliance_rad_per_nm", self.compliance_rad_per_nm)
            .law("slack_nm", self.slack_nm)
            .law("settling_nm", self.settling_nm);
        let Some(joint) = place.joint() else {
            return facts;
        };
        let torque = &scene.torque_nm[joint];
        let deflection = self.deviation(scene, place, &[]);
        let taken_up = match place {
            Place::Upstream(joint) => taken_up(scene, joint),
            _ => Vec::new(),
        };
        let compliance = slope_beside(torque, &deflection, &taken_up).abs();
        if compliance > 0.0 {
            facts.with("stiffness_nm_per_rad", 1.0 / compliance)
        } else {
            facts
        }
    }
}

/// Stretch of the capstan's cable: the motor leads by the deflection.
pub(crate) fn capstan_compliance(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Strands::draw(draw, 260.0, 1.0);
    let info = if draw.has_external() {
        draw.at_joint("capstan-compliance", &["capstan-compliance"])
    } else {
        draw.at_joint("capstan-compliance", &EITHER_COMPLIANCE)
    };
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// A link that gives behind the external encoder: it stays behind by the deflection.
pub(crate) fn joint_compliance(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Strands::draw(draw, 420.0, -1.0);
    let info = if draw.has_external() {
        draw.at_joint("joint-compliance", &["joint-compliance"])
    } else {
        draw.at_joint("joint-compliance", &EITHER_COMPLIANCE)
    };
    Added::boxed(info, Place::Link(draw.joint), law)
}

/// Micro-slip of the wraps: a little more with every travel under load.
#[derive(Debug)]
struct Creep {
    per_nm: f64,
    exponent: f64,
}

impl Law for Creep {
    fn deviation(&self, scene: &Scene<'_>, place: Place, signal: &[f64]) -> Vec<f64> {
        let Some(joint) = place.joint() else {
            return Vec::new();
        };
        let mut sum = 0.0;
        let mut before = signal.first().copied().unwrap_or(0.0);
        signal
            .iter()
            .zip(&scene.torque_nm[joint])
            .map(|(&now, &torque)| {
                let size = libm::pow(torque.abs(), self.exponent);
                sum += self.per_nm * torque.signum() * size * (now - before).abs();
                before = now;
                sum
            })
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let facts = Facts::default()
            .law("creep_per_nm", self.per_nm)
            .law("exponent", self.exponent);
        let Some(joint) = place.joint() else {
            return facts;
        };
        let signal = &scene.motion.angle_rad[joint];
        let linear = Self {
            per_nm: 1.0,
            exponent: 1.0,
        };
        let effective = slope_of(
            &linear.deviation(scene, place, signal),
            &self.deviation(scene, place, signal),
        );
        facts.with("creep_per_nm", effective)
    }
}

/// Creep of the cable on its drum.
pub(crate) fn capstan_creep(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Creep {
        per_nm: draw.amplitude(2e-4),
        exponent: draw.random.uniform(0.95, 1.1),
    };
    let info = draw.at_joint("capstan-creep", &["capstan-creep"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// Gross slip at the largest torques: fast, but not instantaneous.
#[derive(Debug)]
struct Slip {
    slip_rad: f64,
    events: usize,
    rise_s: f64,
}

impl Slip {
    /// Times of the highest torque peaks, at least 5 s apart, not in the outer tenths.
    fn times_s(&self, scene: &Scene<'_>, joint: usize) -> Vec<(f64, f64)> {
        let torque = &scene.torque_nm[joint];
        let rows = torque.len();
        let mean = torque.iter().sum::<f64>() / rows.max(1) as f64;
        let mut order: Vec<usize> = (rows / 10..rows - rows / 10).collect();
        order.sort_by(|a, b| {
            let away = |row: usize| (torque[row] - 0.5 * mean).abs();
            away(*b).total_cmp(&away(*a))
        });
        let mut times: Vec<(f64, f64)> = Vec::new();
        for row in order {
            let time_s = scene.elapsed_s(row);
            if times.len() < self.events && times.iter().all(|(t, _)| (t - time_s).abs() > 5.0) {
                times.push((time_s, torque[row].signum()));
            }
        }
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        times
    }
}

impl Law for Slip {
    fn deviation(&self, scene: &Scene<'_>, place: Place, signal: &[f64]) -> Vec<f64> {
        let Some(joint) = place.joint() else {
            return Vec::new();
        };
        let times = self.times_s(scene, joint);
        (0..signal.len())
            .map(|row| {
                let time_s = scene.elapsed_s(row);
                let parts = times
                    .iter()
                    .map(|(at, sign)| sign * ramp(time_s, *at, self.rise_s));
                self.slip_rad * parts.sum::<f64>()
            })
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let mut facts = Facts::default().law("rise_s", self.rise_s);
        let times = place.joint().map(|joint| self.times_s(scene, joint));
        facts.events = times
            .unwrap_or_default()
            .into_iter()
            .map(|(time_s, sign)| Event {
                time_s,
                size: sign * self.slip_rad,
            })
            .collect();
        if let [event] = &facts.events[..] {
            let (time_s, size) = (event.time_s, event.size);
            facts = facts.with("slip_rad", size).with("time_s", time_s);
        }
        facts
    }
}

/// Slip of the cable on its drum. Without its ramp it is a loss of counts.
pub(crate) fn capstan_slip(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Slip {
        slip_rad: draw.amplitude(2e-3),
        events: 1 + draw.random.index(3),
        rise_s: draw.random.uniform(0.03, 0.08),
    };
    let info = draw.at_joint("capstan-slip", &["capstan-slip", "encoder-count-loss"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}
