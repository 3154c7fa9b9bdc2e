//! The content of identified.json of an identification of the dynamics.

use std::collections::BTreeMap;

use haptical_model::{Device, JointType};
use haptical_motion::{
    BaseParameter, BodyDynamics, Dynamics, Estimated, FrictionLaw, Instruments, JointDynamics,
    Residual, stacked_percent,
};
use serde::Serialize;

use super::IdentifiedHead;
use crate::files::Record;
use crate::identify::summary::sum_in_words;

/// identified.json of `haptical identify --with dynamics`.
#[derive(Debug, Clone, Serialize)]
pub struct IdentifiedDynamics {
    /// Version that made it.
    pub haptical_version: String,
    /// The result in a line.
    pub answer: String,
    /// Device file.
    pub device: String,
    /// Log.
    pub log: String,
    /// Log that was predicted and not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validate: Option<String>,
    /// `dynamics`.
    pub method: &'static str,
    /// Rows of the log.
    pub rows: usize,
    /// Rows of a joint behind the low pass.
    pub band_rows: usize,
    /// Edge of the low pass that torques and model went through \[Hz\].
    pub band_hz: f64,
    /// Torques of the fitted log.
    pub torques: Vec<TorqueEntry>,
    /// All joints together, `||tau - model|| / ||tau||` \[%\].
    pub stacked_percent: StackedEntry,
    /// Torques of the log that was not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torques_validate: Option<Vec<TorqueEntry>>,
    /// The same of all joints together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stacked_percent_validate: Option<StackedEntry>,
    /// How much later torques are logged than positions.
    pub torque_delay_s: NumberEntry,
    /// Friction, armature and offset of each joint.
    pub joints: Vec<JointEntry>,
    /// The feasible set: one body a moving row.
    pub bodies: Vec<BodyEntry>,
    /// What the motion fixes: base parameters, each a sum.
    pub combinations: Vec<CombinationEntry>,
    /// Of those: what the motion fixes no better than it was known before.
    pub not_determined: Vec<String>,
    /// Numbers that no torque of the motion depends on.
    pub unseen: Vec<String>,
    /// What keeps the noise of the positions out: `repetition`, `commands` or `none`.
    pub instruments: &'static str,
    /// Period of the motion, where its repetitions are the instruments \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Noise of each joint's position reading.
    pub position_noise: Vec<f64>,
    /// Variance of the numbers over that of independent rows.
    pub variance_inflation: f64,
    /// What is odd.
    pub warnings: Vec<String>,
    /// How the result came about.
    pub provenance: Record,
}

/// Per cent of the torque that is left.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct StackedEntry {
    /// By the device as it was.
    pub before: f64,
    /// By the identified device.
    pub after: f64,
    /// By the base parameters, which need not belong to any bodies.
    pub base: f64,
}

/// A joint's torque.
#[derive(Debug, Clone, Serialize)]
pub struct TorqueEntry {
    /// `torque1`.
    pub channel: String,
    /// SI unit.
    pub unit: &'static str,
    /// Root mean square of what was measured, in the band.
    pub rms: f64,
    /// Root mean square of what is left: of the device as it was, of the identified one.
    pub rms_before: f64,
    /// See `rms_before`.
    pub rms_after: f64,
    /// `||tau - model|| / ||tau||` \[%\].
    pub percent: StackedEntry,
}

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NumberEntry {
    /// Value.
    pub value: f64,
    /// SI unit.
    pub unit: &'static str,
    /// 95 % interval, a rest with a memory counted; none of a number that is held where physics ends: nothing says how far from there it is.
    pub ci95: Option<[f64; 2]>,
}

/// Numbers of a joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointEntry {
    /// Joint, from 1.
    pub joint: usize,
    /// Its name in the device file or the robot description.
    pub name: String,
    /// Coulomb friction.
    pub coulomb: NumberEntry,
    /// Viscous friction.
    pub viscous: NumberEntry,
    /// Share of what the joint carries that its friction has beside, where the log shows one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_load: Option<NumberEntry>,
    /// Speed within which Coulomb friction turns over, or travel over which it builds up.
    pub transition: BTreeMap<&'static str, f64>,
    /// Armature.
    pub armature: NumberEntry,
    /// What the torque reads without any.
    pub offset: NumberEntry,
}

/// A body, in the frame behind its row's motion.
#[derive(Debug, Clone, Serialize)]
pub struct BodyEntry {
    /// Row of the device, from 1.
    pub row: usize,
    /// Mass, its interval by the log and by what is known of bodies beforehand.
    pub mass_kg: NumberEntry,
    /// Centre of mass.
    pub centre_of_mass_m: [f64; 3],
    /// xx, yy, zz, xy, xz, yz about the centre of mass.
    pub inertia_kgm2: [f64; 6],
    /// Mass of the device as it was; none where nobody said.
    pub nominal_mass_kg: Option<f64>,
    /// Whether it weighs nothing by the device file and is kept so.
    pub held: bool,
}

/// A base parameter.
#[derive(Debug, Clone, Serialize)]
pub struct CombinationEntry {
    /// The sum in words: `izz1 + armature1 + 0.09 m2`.
    pub sum: String,
    /// Numbers and factors.
    pub terms: Vec<(String, f64)>,
    /// Value and interval by the log alone.
    pub found: NumberEntry,
    /// Value in the device as it was.
    pub nominal: f64,
    /// Whether the motion says more of it than was known.
    pub determined: bool,
    /// What the noise of the positions is taken to have changed it by; none where instruments keep that out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<f64>,
}

impl IdentifiedDynamics {
    pub(super) fn new(
        device: &Device,
        found: &Dynamics,
        head: IdentifiedHead,
        mut warnings: Vec<String>,
        provenance: Record,
    ) -> Self {
        warnings.extend(found.warnings.iter().cloned());
        warnings.extend(by_load(found));
        let validated = match &found.validated {
            Some(Ok(residuals)) => Some(residuals),
            Some(Err(why)) => {
                warnings.push(format!("the log of --validate was not predicted: {why}"));
                None
            }
            None => None,
        };
        let torques = |own: &[Residual]| own.iter().map(|own| torque(device, own)).collect();
        let combinations: Vec<CombinationEntry> = found.base.iter().map(combination).collect();
        let not_determined = combinations.iter().filter(|own| !own.determined);
        let mut result = Self {
            haptical_version: provenance.haptical_version.clone(),
            answer: String::new(),
            device: head.device,
            log: head.log,
            validate: head.validate,
            method: super::DYNAMICS,
            rows: head.rows,
            band_rows: found.rows,
            band_hz: found.edge_hz,
            torques: torques(&found.residuals),
            stacked_percent: stacked(&found.residuals),
            torques_validate: validated.map(|own| torques(own)),
            stacked_percent_validate: validated.map(|own| stacked(own)),
            torque_delay_s: number(&found.delay_s, "s"),
            joints: found.joints.iter().map(|own| joint(device, own)).collect(),
            bodies: found.bodies.iter().map(|own| body(device, own)).collect(),
            not_determined: not_determined.map(|own| own.sum.clone()).collect(),
            combinations,
            unseen: found.unseen.clone(),
            instruments: match found.instruments {
                None => "none",
                Some(Instruments::Commands) => "commands",
                Some(Instruments::Repetition { .. }) => "repetition",
            },
            period_s: match found.instruments {
                Some(Instruments::Repetition { period_s }) => Some(period_s),
                _ => None,
            },
            position_noise: found.position_sd.clone(),
            variance_inflation: found.inflation,
            warnings,
            provenance,
        };
        result.answer = result.in_a_line();
        result
    }

    fn in_a_line(&self) -> String {
        let fixed = self.combinations.len() - self.not_determined.len();
        let unseen = self.stacked_percent_validate.map_or_else(
            || "no log was held out".to_owned(),
            |own| format!("{:.1} % on the log that was not fitted", own.after),
        );
        let share = self.stacked_percent;
        format!(
            "{fixed} of {} combinations determined; torques not explained: {:.1} % before, {:.1} % after, {unseen}.",
            self.combinations.len(),
            share.before,
            share.after
        )
    }
}

fn stacked(residuals: &[Residual]) -> StackedEntry {
    let [before, after, base] = stacked_percent(residuals);
    StackedEntry {
        before,
        after,
        base,
    }
}

fn torque(device: &Device, own: &Residual) -> TorqueEntry {
    TorqueEntry {
        channel: format!("torque{}", own.joint + 1),
        unit: device.joints[own.joint].torque_unit(),
        rms: own.torque_rms,
        rms_before: own.before_rms,
        rms_after: own.after_rms,
        percent: stacked(std::slice::from_ref(own)),
    }
}

fn number(own: &Estimated, unit: &'static str) -> NumberEntry {
    NumberEntry {
        value: own.value,
        unit,
        ci95: (own.sd > 0.0).then(|| own.ci95()),
    }
}

fn joint(device: &Device, own: &JointDynamics) -> JointEntry {
    let slides = device.joints[own.joint].joint_type == JointType::Prismatic;
    let pick = |turns, of_slide| if slides { of_slide } else { turns };
    let torque = pick("N m", "N");
    let transition = match own.law {
        FrictionLaw::Speed(speed) => (pick("speed_rad_per_s", "speed_m_per_s"), speed),
        FrictionLaw::Travel(travel) => (pick("travel_rad", "travel_m"), travel),
    };
    JointEntry {
        joint: own.joint + 1,
        name: device.joints[own.joint].name.clone(),
        coulomb: number(&own.coulomb, torque),
        viscous: number(&own.viscous, pick("N m s/rad", "N s/m")),
        of_load: own.load.as_ref().map(|load| number(load, "1")),
        transition: BTreeMap::from([transition]),
        armature: number(&own.armature, pick("kg m^2", "kg")),
        offset: number(&own.offset, torque),
    }
}

fn body(device: &Device, own: &BodyDynamics) -> BodyEntry {
    let about = own.inertia.about_centre_kgm2();
    let nominal = device.bodies.get(own.row).copied().flatten();
    let mass = Estimated {
        value: own.inertia.mass_kg,
        sd: own.sd[0],
    };
    BodyEntry {
        row: own.row,
        mass_kg: number(&mass, "kg"),
        centre_of_mass_m: own.inertia.centre_of_mass_m().unwrap_or_default().into(),
        inertia_kgm2: [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|place| about[place]),
        nominal_mass_kg: nominal.map(|own| own.mass_kg),
        held: own.is_held,
    }
}

/// What a device file cannot hold of friction that grows with the load.
fn by_load(found: &Dynamics) -> Option<String> {
    let joints = found.joints.iter().filter(|own| own.load.is_some());
    let joints: Vec<String> = joints.map(|own| (own.joint + 1).to_string()).collect();
    (!joints.is_empty()).then(|| {
        format!(
            "friction grows with the load of joints {}: a device file has no number for that, and identified.toml gets the friction of the mean \
             load of this log",
            joints.join(", ")
        )
    })
}

fn combination(own: &BaseParameter) -> CombinationEntry {
    let terms = own.terms.iter();
    CombinationEntry {
        sum: sum_in_words(terms.map(|(name, factor)| (name.as_str(), *factor))),
        terms: own.terms.clone(),
        found: number(&own.estimated, own.unit),
        nominal: own.nominal,
        determined: own.is_determined(),
        bias: own.bias,
    }
}
