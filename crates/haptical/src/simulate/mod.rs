//! A log of single postures of a true device, as a rig would record them.

mod refuse;
mod rig;

use haptical_calibration::candidate_parameters;
use haptical_design::Rig;
use haptical_effects::device::{add_effects, shown_by_effects};
use haptical_model::{
    Device as Model, ParameterId, Recording, SurroundingParameter, TransmissionKind,
};
use haptical_simulator::{PostureSimulation, draw_deviations, with_places_of};

use self::rig::{blank_as, described, rigged, with_fixtures};
use crate::device::Device;
use crate::error::Error;
use crate::log::Log;

/// Times that postures and effects are brought together.
const MOST_ROUNDS: usize = 50;
/// Change of a joint below which they are \[rad, m\].
const SETTLED: f64 = 1e-10;
/// Share of its plausible error that a cable's place is off which nobody states.
const CABLE_SHARE: f64 = 0.3;

/// The true device of a simulated log.
#[derive(Debug, Clone, Copy, Default)]
pub enum Truth<'t> {
    /// The device itself.
    #[default]
    Nominal,
    /// The device of another file.
    Of(&'t Device),
    /// The device with normal deviations of its parameters, this share of their plausible size.
    Drawn(f64),
}

/// A simulated log of postures.
#[derive(Debug, Clone)]
pub struct SimulatedPostures {
    /// The log.
    pub recording: Recording,
    /// The true device, with a place for everything that the log is about.
    pub truth: Model,
    /// A rig file with which the log is read; none where the device file has all of its sensors.
    pub rig: Option<String>,
    /// What is odd: postures that the true device does not get to.
    pub warnings: Vec<String>,
}

/// Simulates what a rig records of a true device at postures such as `haptical plan` writes them.
///
/// Rows of `postures` say what happens in them as those of a log do: `contact` and `plane` what is touched, `tool`, `hand`
/// and `run`, `fixture1_rad` the angle at which a fixture holds a link, `t_s`, `temp_degc`, forces and torques the
/// conditions. With a rig its sensors are read; else those that `postures` has readings of, cell by cell, where it is a log;
/// else those that the device describes. Effects of the true device act on all of it.
///
/// ```
/// use haptical::{Device, Log, Truth, design::Rig, simulate_postures};
/// let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n";
/// let text = format!("{row}{row}{row}[[joint]]\nlower_rad = -2\nupper_rad = 2\n[[joint]]\nlower_rad = -2\nupper_rad = 2\n");
/// let device = Device::from_toml(&text, "arm.toml")?;
/// let columns = [("theta1_rad", vec![0.1, 0.7]), ("theta2_rad", vec![0.5, -0.4])];
/// let columns: Vec<_> = columns
///     .iter()
///     .map(|(name, cells)| (*name, haptical::data::Cells::Numbers(cells)))
///     .collect();
/// let postures = Log::from_columns(&columns, "poses.csv", &device)?;
/// let rig = Rig::parse("pose:unknown")?;
/// let made = simulate_postures(&device, Truth::Drawn(0.2), &postures, Some(&rig), 1)?;
/// assert!(made.recording.position_m.is_some() && made.rig.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A rig that the device cannot have or that the postures do not touch, things that are out of reach, an effect without
/// what drives it.
pub fn simulate_postures(
    device: &Device,
    truth: Truth<'_>,
    postures: &Log,
    rig: Option<&Rig>,
    seed: u64,
) -> Result<SimulatedPostures, Error> {
    let with_rig = match rig {
        Some(rig) => rigged(device, rig)?,
        None => described(&device.model, &postures.recording),
    };
    refuse::unasked(rig, postures)?;
    let refuse = |error| refuse::simulator(&error, device, postures);
    let (model, sensors) = (with_rig.model, with_rig.sensors);
    let whole = whole_truth(truth, &device.model, &model, seed).map_err(refuse)?;
    let asked = with_fixtures(&postures.recording, &with_rig.fixtures, &model);
    let asked = asked.as_ref().unwrap_or(&postures.recording);
    let mut simulation =
        PostureSimulation::new(&whole, &model, asked, sensors, seed).map_err(refuse)?;
    let mut names = asked.covariates.iter().map(|(name, _)| name);
    let is_moved = asked.contact.is_some()
        || asked.plane.is_some()
        || names.any(|name| name.starts_with("fixture"));
    let refuse_effect = |error| refuse::effect(&error, device, postures);
    let mut is_settled = !is_moved || whole.effects.is_empty() && !whole.has_compliance();
    let mut rounds = 0;
    while !is_settled {
        let exact = simulation.exact().map_err(refuse)?;
        let shown = shown_by_effects(simulation.device(), &exact).map_err(refuse_effect)?;
        let change = simulation.meet(&shown).map_err(refuse)?;
        is_settled = change < SETTLED;
        rounds += 1;
        if rounds == MOST_ROUNDS && !is_settled {
            return Err(refuse::unsettled(postures));
        }
    }
    let mut recording = simulation.exact().map_err(refuse)?;
    add_effects(simulation.device(), &mut recording).map_err(refuse_effect)?;
    simulation.disturb(&mut recording).map_err(refuse)?;
    if rig.is_none() {
        blank_as(&mut recording, &postures.recording, simulation.left_out());
    }
    Ok(SimulatedPostures {
        warnings: refuse::left_out(simulation.left_out(), postures),
        recording,
        truth: simulation.device().clone(),
        rig: with_rig.file,
    })
}

/// The true device with the sensors of the device, for a log of its motion.
///
/// # Errors
/// A share that is no finite number from 0.
pub fn true_device(device: &Device, truth: Truth<'_>, seed: u64) -> Result<Model, Error> {
    whole_truth(truth, &device.model, &device.model, seed).map_err(Error::internal)
}

/// The true device with the sensors of `rigged`, the device with its rig; cables that no file places have places of
/// their own.
fn whole_truth(
    truth: Truth<'_>,
    device: &Model,
    rigged: &Model,
    seed: u64,
) -> Result<Model, haptical_simulator::SimulatorError> {
    let stated = match truth {
        Truth::Nominal => device,
        Truth::Of(truth) => &truth.model,
        Truth::Drawn(share) => return draw_deviations(rigged, &deviating(rigged), share, seed),
    };
    let whole = match truth {
        Truth::Of(truth) => with_places_of(&truth.model, rigged),
        _ => rigged.clone(),
    };
    let is_open = |parameter: &ParameterId| {
        cable_of(*parameter).is_some_and(|cable| cable >= stated.cables.len())
    };
    let mut open = whole.further_parameters();
    open.retain(is_open);
    draw_deviations(&whole, &open, CABLE_SHARE, seed)
}

/// The cable whose place, zero or scale a parameter is.
fn cable_of(parameter: ParameterId) -> Option<usize> {
    use SurroundingParameter::{CableAnchor, CableScale, CableZero};
    match parameter {
        ParameterId::Surrounding(
            CableAnchor { cable, .. } | CableZero { cable } | CableScale { cable },
        ) => Some(cable),
        _ => None,
    }
}

/// What of a device is off when it was built: numbers of links, drums, and of cables that are to be found.
fn deviating(device: &Model) -> Vec<ParameterId> {
    let mut parameters = match device.has_links() {
        true => candidate_parameters(device),
        false => Vec::new(),
    };
    parameters.retain(|parameter| match parameter {
        ParameterId::Link { .. } => true,
        other => cable_of(*other).is_some(),
    });
    for (joint, described) in device.joints.iter().enumerate() {
        if described.transmission == TransmissionKind::Capstan
            && described.drum_distance_m.is_some()
        {
            parameters.extend(device.transmission_parameters(joint));
        }
    }
    parameters
}
