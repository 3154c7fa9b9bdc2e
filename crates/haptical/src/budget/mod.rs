//! A budget of the uncertainty of the handle's position: what the fit leaves, what the instruments were known to, what readings in use
//! add (JCGM 100), and the same by draws (JCGM 101).

mod contributions;
mod draws;
mod handle;
mod instruments;
mod page;

use std::collections::BTreeSet;

use haptical_calibration::{ParameterFit, predict_positions};
use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_metrics::budget::{Agreement, Combined, Group, Simulated, combined};
use haptical_metrics::median;
use haptical_model::Recording;
use serde::Serialize;

pub use self::instruments::{ActsAs, Instrument, Instruments, Known, Shape};

use self::contributions::{Part, identified_anew, parts};
use self::draws::by_draws;
use self::handle::Handle;
use crate::device::Device;
use crate::error::Error;
use crate::files::{Record, VERSION};
use crate::identify::{Identify, identify};
use crate::log::Log;

/// Postures of a region that are looked at; of more every k-th.
const MOST_POSTURES: usize = 200;
/// Where the draws begin.
const SEED: u64 = 101;

/// What a budget is asked for.
#[derive(Debug, Clone)]
pub struct BudgetOptions {
    /// Level of confidence of the expanded uncertainty.
    pub level: f64,
    /// Least and largest x, y and z of the handle \[m\] of the postures that count, in the frame of the measurand.
    pub region_m: Option<[f64; 6]>,
    /// Draws, ten thousand at least.
    pub draws: usize,
}

impl Default for BudgetOptions {
    fn default() -> Self {
        Self {
            level: 0.95,
            region_m: None,
            draws: 100_000,
        }
    }
}

/// A budget. As JSON it is budget.json.
#[derive(Debug, Clone, Serialize)]
pub struct Budget {
    /// Device that was identified.
    pub device: String,
    /// Its log.
    pub log: String,
    /// What is measured.
    pub measurand: &'static str,
    /// Postures of the region that were looked at.
    pub postures: usize,
    /// Expanded uncertainty along the direction in which a position is known least \[m\]: median over the postures, and the worst.
    pub expanded_median_m: f64,
    /// See [`Budget::expanded_median_m`].
    pub expanded_worst_m: f64,
    /// At the posture with the largest one.
    pub worst: PostureBudget,
    /// Certificates.
    pub instruments: Vec<Instrument>,
    /// The worst posture by draws.
    pub draws: Draws,
    /// Things that a reader should know.
    pub warnings: Vec<String>,
    /// Level of confidence.
    pub level: f64,
    /// How it came about.
    pub provenance: Record,
}

/// The budget of one posture, along one direction.
#[derive(Debug, Clone, Serialize)]
pub struct PostureBudget {
    /// Line of the log that the posture is from.
    pub line: u64,
    /// Joint readings \[rad\] or \[m\].
    pub joints: Vec<f64>,
    /// Handle \[m\], in the frame of the measurand.
    pub position_m: [f64; 3],
    /// Direction in which it is known least, of length 1.
    pub direction: [f64; 3],
    /// Contributions, the largest first.
    pub contributions: Vec<Contribution>,
    /// Correlations of identified parameters that change the result most.
    pub correlations: Vec<(String, String, f64)>,
    /// All of them together.
    #[serde(flatten)]
    pub combined: Combined,
    /// Expanded uncertainty of each coordinate \[m\].
    pub expanded_xyz_m: [f64; 3],
}

/// A line of a budget.
#[derive(Debug, Clone, Serialize)]
pub struct Contribution {
    /// What it is.
    pub name: String,
    /// `A`, by statistics of readings, or `B`, otherwise.
    pub kind: &'static str,
    /// Distribution.
    pub distribution: &'static str,
    /// Standard uncertainty u_i of the input, where it is one number.
    pub standard_uncertainty: Option<f64>,
    /// Unit of the input; `1` for a share.
    pub unit: String,
    /// Sensitivity c_i \[m per unit\], where it is one number.
    pub sensitivity: Option<f64>,
    /// |c_i| u_i \[m\].
    pub contribution_m: f64,
    /// Share of the variance.
    pub share: f64,
    /// Degrees of freedom; none for infinitely many.
    pub degrees_of_freedom: Option<f64>,
    /// The numbers of the fit within it, the largest first; correlated, so that their squares do not add up.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<ParameterPart>,
}

/// A number of the fit in a budget.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterPart {
    /// Name.
    pub name: String,
    /// Standard uncertainty, in its unit.
    pub standard_uncertainty: f64,
    /// Unit.
    pub unit: String,
    /// Sensitivity \[m per unit\].
    pub sensitivity: f64,
    /// |c_i| u_i \[m\].
    pub contribution_m: f64,
}

/// The same by draws.
#[derive(Debug, Clone, Serialize)]
pub struct Draws {
    /// What the draws give \[m\], about the estimate.
    #[serde(flatten)]
    pub simulated: Simulated,
    /// Whether the law agrees with them, at two significant digits.
    pub agreement: Agreement,
    /// Seed.
    pub seed: u64,
}

/// A posture with all that is uncertain about it.
struct Posture {
    row: usize,
    position_m: Vector3<f64>,
    parts: Vec<Part>,
}

/// Identifies a device from a log, and works out what is known of the handle's position at the postures of a recording: the log's, or
/// another one's.
///
/// # Errors
/// As [`identify`]; the log does not fix the handle's position; no posture in the region; an instrument of a channel that is not read.
pub fn budget(
    device: &Device,
    log: &Log,
    identify_options: &Identify,
    instruments: &Instruments,
    postures: Option<&Log>,
    options: &BudgetOptions,
) -> Result<Budget, Error> {
    // what a certificate says of a scale takes the place of what is known of it without one
    let device = &contributions::with_certified_scales(device, instruments);
    let found = identify(device, log, identify_options)?;
    let path = &log.source().path;
    let Some(fit) = &found.calibration.fitted.whole else {
        let said = "the log fixes no links, or the fit was rejected: the handle's position has no budget; `haptical identify` says why";
        return Err(Error::of_file("no-position", said, path));
    };
    let mut handle = Handle::new(fit, &log.recording);
    let (recording, of) = match postures {
        Some(postures) => (&postures.recording, &postures.source().path),
        None => (&log.recording, path),
    };
    let recording = handle.prepared(recording);
    let recording = recording.map_err(|error| Error::effect(&error, &device.source().path, of))?;
    let chosen = chosen(&handle, &recording, options.region_m, path)?;
    let recording = recording.select(&chosen);
    let places = handle.at(&recording)?;
    if !handle.is_seen {
        refuse_open(fit, &recording, (&device.source().path, path))?;
    }
    let there = (&handle, &recording);
    let changed = identified_anew((device, log), identify_options, instruments, there)?;
    let beyond = (&*changed, contributions::unexplained_m(&found.calibration));
    let all = parts((&handle, fit), &recording, &places, instruments, beyond)?;
    let postures = all.into_iter().zip(&places).enumerate();
    let postures = postures.map(|(row, (parts, place))| Posture {
        row,
        position_m: place.position_m,
        parts,
    });
    let postures: Vec<Posture> = postures.collect();
    let mut sizes = Vec::new();
    let mut worst: Option<(f64, &Posture, Vector3<f64>)> = None;
    for posture in &postures {
        let axis = posture.axis();
        let size = posture.along(&axis, options.level)?.expanded_uncertainty;
        sizes.push(size);
        if worst.as_ref().is_none_or(|(largest, _, _)| size > *largest) {
            worst = Some((size, posture, axis));
        }
    }
    let (expanded_worst_m, worst, axis) = worst.ok_or_else(|| Error::internal("no posture"))?;
    let told = worst.tell((&handle, fit), &recording, &axis, options.level)?;
    let (law, trials) = (&told.combined, options.draws);
    let draws = by_draws(&handle, &recording, worst, &axis, law, trials)?;
    let mut files = device.inputs("device");
    files.splice(1..1, log.input("log"));
    let mut provenance = Record::of(VERSION, "report", files, None);
    provenance.seeds.insert("draws", SEED);
    let mut warnings = found.warnings().to_vec();
    if instruments.instrument.is_empty() {
        warnings.push("no instrument is named: the budget has what the readings themselves say, and no certificate".to_owned());
    }
    warnings.extend(instruments.overdue());
    Ok(Budget {
        device: device.source().label.clone(),
        log: log.source().label.clone(),
        measurand: handle.measurand(),
        postures: postures.len(),
        expanded_median_m: median(&sizes).map_err(Error::internal)?,
        expanded_worst_m,
        worst: told,
        instruments: instruments.instrument.clone(),
        draws,
        warnings,
        level: options.level,
        provenance,
    })
}

/// Refuses a fit that does not fix where the handle is: one cable cannot tell a turn about its exit.
fn refuse_open(
    fit: &ParameterFit,
    postures: &Recording,
    (device, log): (&std::path::Path, &std::path::Path),
) -> Result<(), Error> {
    let predicted = predict_positions(fit, postures)
        .map_err(|error| Error::calibration(&error, device, log))?;
    let axes = predicted.iter().flatten();
    let open: BTreeSet<&str> = (axes.flat_map(|axis| &axis.open_through))
        .map(String::as_str)
        .collect();
    if open.is_empty() && !fit.fitted.is_empty() {
        return Ok(());
    }
    let open: Vec<&str> = open.into_iter().take(5).collect();
    let what = format!(
        "the log does not fix where the handle is: it depends on {}, which no reading tells",
        open.join(", ")
    );
    let next = "record the handle with a tracker; `haptical plan` says what a rig fixes";
    Err(Error::in_file("no-position", what, log, next))
}

/// Rows whose handle is in the region, evenly thinned.
fn chosen(
    handle: &Handle,
    recording: &Recording,
    region_m: Option<[f64; 6]>,
    path: &std::path::Path,
) -> Result<Vec<usize>, Error> {
    let all = handle.positions(recording)?;
    let is_in = |row: &usize| {
        region_m.is_none_or(|ends| {
            let mut axes = all[*row].iter().zip(ends.chunks_exact(2));
            axes.all(|(axis, ends)| (ends[0]..=ends[1]).contains(axis))
        })
    };
    let rows: Vec<usize> = (0..recording.len()).filter(is_in).collect();
    if rows.is_empty() {
        let said = "no posture of the recording has its handle in the region; give a larger region, or --poses with postures in it";
        return Err(Error::of_file("empty-region", said, path));
    }
    let step = rows.len().div_ceil(MOST_POSTURES);
    Ok(rows.into_iter().step_by(step).collect())
}

impl Posture {
    /// Direction of the largest variance.
    fn axis(&self) -> Vector3<f64> {
        let covariance: Matrix3<f64> = self.parts.iter().map(Part::covariance).sum();
        let eigen = covariance.symmetric_eigen();
        let largest = eigen.eigenvalues.imax();
        let axis = eigen.eigenvectors.column(largest).into_owned();
        // one of the two signs, so that the same input gives the same bits in words
        match axis[axis.iamax()] < 0.0 {
            true => -axis,
            false => axis,
        }
    }

    fn along(&self, axis: &Vector3<f64>, level: f64) -> Result<Combined, Error> {
        let groups: Vec<Group> = self.parts.iter().map(|part| part.along(axis)).collect();
        combined(&groups, level).map_err(Error::internal)
    }

    /// The whole budget.
    fn tell(
        &self,
        (handle, fit): (&Handle, &ParameterFit),
        recording: &Recording,
        axis: &Vector3<f64>,
        level: f64,
    ) -> Result<PostureBudget, Error> {
        let combined = self.along(axis, level)?;
        let variance = combined.standard_uncertainty.powi(2);
        let contributions = self.parts.iter();
        let contributions = contributions.map(|part| part.tell(handle, axis, variance));
        let mut contributions = contributions.collect::<Result<Vec<_>, _>>()?;
        contributions.sort_by(|a, b| b.contribution_m.total_cmp(&a.contribution_m));
        let mut expanded_xyz_m = [0.0; 3];
        for (axis, size) in Matrix3::identity().column_iter().zip(&mut expanded_xyz_m) {
            *size = self.along(&axis.into_owned(), level)?.expanded_uncertainty;
        }
        Ok(PostureBudget {
            line: recording.line.get(self.row).copied().unwrap_or_default(),
            joints: (recording.joint.iter())
                .map(|column| column[self.row])
                .collect(),
            position_m: self.position_m.into(),
            direction: (*axis).into(),
            contributions,
            correlations: fit.high_correlations().into_iter().take(10).collect(),
            combined,
            expanded_xyz_m,
        })
    }
}
