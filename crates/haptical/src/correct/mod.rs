//! Commands that make a corrected arm go where a path wants it.

mod path;
mod stance;

use haptical_data::LogShape;
use haptical_kinematics::Pose;
use haptical_model::{InversePose, Recording, Wanted};
use serde::Serialize;

pub use self::path::Waypoints;
use self::path::unreachable;
use self::stance::Stance;
use crate::device::{Device, refuse_other_device};
use crate::error::Error;
use crate::units::Shown;

/// What to do about waypoints out of reach.
const COMMAND_PLACE: &str = "give another start (joint columns beside the poses), allow a rest with --within-m and \
                             --within-rad, or ask for the position alone with --match position";
/// Column of the written path with what is left of each waypoint \[m\].
pub(crate) const REST_COLUMN: &str = "rest_m";
/// Times that readings and what bends the arm are brought together.
const MOST_ROUNDS: usize = 50;
/// A handle that moves by less between two of them has settled \[m\], and \[rad\].
const SETTLED: f64 = 1e-11;
/// A pose that is nearer is reached \[m\], \[rad\].
const REACHED: f64 = 1e-8;
/// Postures from which a pose is searched where the waypoint before gives none.
const STARTS: usize = 64;

/// What of a pose the corrected arm is to reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Match {
    /// Position and orientation of an arm with six joints or more and of a path with orientations; else the position.
    #[default]
    Auto,
    /// Position and orientation.
    Pose,
    /// The position.
    Position,
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correct {
    /// What is to be reached.
    pub to_match: Match,
    /// Distance that may be left \[m\].
    pub within_m: f64,
    /// Turn that may be left \[rad\].
    pub within_rad: f64,
}

impl Default for Correct {
    /// As near as 1 um and 1 urad.
    fn default() -> Self {
        Self {
            to_match: Match::Auto,
            within_m: 1e-6,
            within_rad: 1e-6,
        }
    }
}

/// One waypoint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CorrectedWaypoint {
    /// Line of the path.
    pub line: u64,
    /// Readings to command \[rad\], \[m\].
    pub command: Vec<f64>,
    /// How far the corrected arm would be with the path's own readings \[m\]; none where the path has none.
    pub before_m: Option<f64>,
    /// The same of its orientation \[rad\]; none where that is not asked for.
    pub before_rad: Option<f64>,
    /// What is left \[m\].
    pub rest_m: f64,
    /// What is left \[rad\]; none where orientations are not asked for.
    pub rest_rad: Option<f64>,
}

/// A corrected path.
#[derive(Debug, Clone)]
pub struct Corrected {
    /// Waypoint by waypoint.
    pub waypoints: Vec<CorrectedWaypoint>,
    /// The path with the commands in the place of its readings, the wanted poses, and what is left of each (`rest_m`,
    /// `rest_rad`).
    pub recording: Recording,
    /// Whether orientations were asked for.
    pub with_orientations: bool,
    /// What is left out, and what is odd.
    pub warnings: Vec<String>,
    shape: LogShape,
}

/// The commands with which the arm `model` has the poses of a path.
///
/// The path is readings that the nominal device means (its poses are those of the nominal device), or poses. Of the model
/// count geometry, transmissions, what its joints yield under gravity, and every effect that depends on the posture, the
/// loads and the temperature; what depends on the motion is left out and said. Readings stay within limits; of an arm with
/// more joints than the pose fixes they are those next to the path's.
///
/// ```
/// use haptical::{Correct, Device, Log, Waypoints, correct};
/// let row = |a_m: f64| format!("[[link]]\na_m = {a_m}\nalpha_rad = 0.0\nd_m = 0.0\n");
/// let arm = |a_m| format!("{}{}{}[[joint]]\n[[joint]]\n", row(0.0), row(a_m), row(0.3));
/// let nominal = Device::from_toml(&arm(0.4), "nominal.toml")?;
/// let model = Device::from_toml(&arm(0.402), "model.toml")?;
/// let columns = [("theta1_rad", vec![0.1, 0.2]), ("theta2_rad", vec![0.5, 0.9])];
/// let columns: Vec<_> =
///     columns.iter().map(|(name, cells)| (*name, haptical::data::Cells::Numbers(cells))).collect();
/// let path = Waypoints::from_log(Log::from_columns(&columns, "path.csv", &nominal)?)?;
/// let corrected = correct(&nominal, &model, &path, &Correct::default())?;
/// let first = &corrected.waypoints[0];
/// assert!(first.before_m.is_some_and(|own| (own - 0.002).abs() < 1e-9) && first.rest_m < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Devices of different joints, one without links, or waypoints out of reach, with row and line.
pub fn correct(
    nominal: &Device,
    model: &Device,
    path: &Waypoints,
    request: &Correct,
) -> Result<Corrected, Error> {
    let source = path.log.source();
    refuse_other_device(&nominal.model, &model.model, &model.source().path)?;
    if !model.model.has_links() {
        let said = "the device has no [[link]] rows, so it has no handle; add one [[link]] for the base and one for each joint";
        return Err(Error::of_file("no-links", said, &model.source().path));
    }
    let rows = path.recording();
    let with_orientations = asks_for_orientations(nominal, path, request)?;
    let mut warnings = Vec::new();
    let targets = targets(nominal, path, with_orientations, &mut warnings)?;
    let mut stance = Stance::new(model, path)?;
    warnings.extend(stance.left_out());
    warnings.extend(model.relative_to_tracker());
    let near = match path.has_readings {
        true => readings_of(rows),
        false => starts(model, path, &targets)?,
    };
    let mut readings = near.clone();
    let before = stance.rests(&readings, &targets)?;
    let mut solver = InversePose::new(&model.model);
    let mut is_settled = false;
    let mut is_reached = vec![false; readings.len()];
    for _ in 0..MOST_ROUNDS {
        stance.bend(&readings)?;
        for (row, readings) in readings.iter_mut().enumerate() {
            let wanted = stance.unbent(row, &targets[row]);
            let evaluation = solver.evaluation();
            evaluation.choose_hand(model.model.hand_at(rows, row));
            evaluation.set_torques(stance.torques_nm(row));
            let found = solver.solve(&wanted, &near[row], readings);
            let found = found.map_err(|error| path.refuse_row(row, &error))?;
            is_reached[row] = found.rest_m.max(found.rest_rad) <= REACHED;
            *readings = found.readings;
        }
        // what is out of reach is refused, wherever it is
        if stance.settles(&readings, SETTLED, &is_reached)? {
            is_settled = true;
            break;
        }
    }
    if !is_settled {
        let said = "the commands and what the arm yields under its loads do not settle; check the stiffnesses and masses of the model";
        return Err(Error::of_file("unsettled", said, &model.source().path));
    }
    let rests = stance.rests(&readings, &targets)?;
    let waypoints = (0..rows.len()).map(|row| CorrectedWaypoint {
        line: rows.line.get(row).copied().unwrap_or(0),
        command: readings[row].clone(),
        before_m: path.has_readings.then_some(before[row].0),
        before_rad: (path.has_readings && with_orientations).then_some(before[row].1),
        rest_m: rests[row].0,
        rest_rad: with_orientations.then_some(rests[row].1),
    });
    let waypoints: Vec<CorrectedWaypoint> = waypoints.collect();
    refuse_unreached(&waypoints, request, source)?;
    Ok(Corrected {
        recording: written(rows, &targets, &waypoints),
        with_orientations,
        waypoints,
        warnings,
        shape: LogShape::from(&model.model),
    })
}

/// Poses of a device at rest.
#[derive(Debug, Clone)]
pub struct RestPoses {
    /// Row by row, in frame (-1).
    pub poses: Vec<Pose>,
    /// Effects that are left out, and why.
    pub warnings: Vec<String>,
}

/// Where a device's handle is at rest at readings: geometry, transmissions, what its joints yield, and the effects that depend on
/// the posture.
///
/// # Errors
/// A row at which the device has no value.
pub fn rest_poses(device: &Device, postures: &Waypoints) -> Result<RestPoses, Error> {
    let mut stance = Stance::new(device, postures)?;
    let poses = stance.poses(&readings_of(postures.recording()))?;
    let pose = |own: Wanted| Pose {
        position_m: own.position_m,
        rotation: own.rotation.unwrap_or_default(),
    };
    Ok(RestPoses {
        poses: poses.into_iter().map(pose).collect(),
        warnings: stance.left_out(),
    })
}

/// The poses that the path wants.
fn targets(
    nominal: &Device,
    path: &Waypoints,
    with_orientations: bool,
    warnings: &mut Vec<String>,
) -> Result<Vec<Wanted>, Error> {
    let mut targets = match path.has_poses {
        true => stance::wanted(path.recording()),
        false => {
            let mut stance = Stance::new(nominal, path)?;
            let left_out = stance.left_out().into_iter();
            warnings.extend(left_out.map(|own| format!("nominal device, {own}")));
            stance.poses(&readings_of(path.recording()))?
        }
    };
    for target in &mut targets {
        target.rotation = target.rotation.filter(|_| with_orientations);
    }
    Ok(targets)
}

fn asks_for_orientations(
    nominal: &Device,
    path: &Waypoints,
    request: &Correct,
) -> Result<bool, Error> {
    let has = !path.has_poses || path.recording().orientation_wxyz.is_some();
    match request.to_match {
        Match::Auto => Ok(has && nominal.model.joints.len() >= 6),
        Match::Position => Ok(false),
        Match::Pose if has => Ok(true),
        Match::Pose => {
            let said = "the path has no orientations to match; add the columns qw, qx, qy, qz, or ask for the position alone";
            Err(Error::of_file(
                "no-orientations",
                said,
                &path.log.source().path,
            ))
        }
    }
}

fn readings_of(recording: &Recording) -> Vec<Vec<f64>> {
    let rows = 0..recording.len();
    rows.map(|row| recording.joint.iter().map(|column| column[row]).collect())
        .collect()
}

/// Postures of the rigid model at poses that come without readings: from the waypoint before, or from wherever in the
/// joints' ranges the pose is reached.
fn starts(model: &Device, path: &Waypoints, targets: &[Wanted]) -> Result<Vec<Vec<f64>>, Error> {
    let mut solver = InversePose::new(&model.model);
    let spread = spread(solver.limits());
    let mut found: Vec<Vec<f64>> = Vec::new();
    for (row, target) in targets.iter().enumerate() {
        let evaluation = solver.evaluation();
        evaluation.choose_hand(model.model.hand_at(path.recording(), row));
        let mut best: Option<haptical_model::Reached> = None;
        for start in found.last().into_iter().chain(&spread) {
            let reached = solver.solve(target, start, start);
            let reached = reached.map_err(|error| path.refuse_row(row, &error))?;
            let is_reached = reached.rest_m.max(reached.rest_rad) <= REACHED;
            let rest = |own: &haptical_model::Reached| own.rest_m + own.rest_rad;
            if best.as_ref().is_none_or(|own| rest(&reached) < rest(own)) {
                best = Some(reached);
            }
            if is_reached {
                break;
            }
        }
        found.extend(best.map(|own| own.readings));
    }
    Ok(found)
}

/// Postures all over the ranges: multiples of irrational shares, whose squares' roots are of different primes.
fn spread(limits: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let share = |case: usize, joint: usize| {
        let prime = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0][joint % 8];
        // the middle first
        (0.5 + case as f64 * prime.sqrt() * (1 + joint / 8) as f64).fract()
    };
    let posture = |case: usize| {
        let joints = limits.iter().enumerate();
        let reading = |(joint, [lower, upper]): (usize, &[f64; 2])| {
            let (lower, upper) = (lower.max(-3.0), upper.min(3.0));
            lower + (upper - lower) * share(case, joint)
        };
        joints.map(reading).collect()
    };
    (0..STARTS).map(posture).collect()
}

/// Refuses a path of which a row is not reached.
fn refuse_unreached(
    waypoints: &[CorrectedWaypoint],
    request: &Correct,
    source: &crate::files::Source,
) -> Result<(), Error> {
    let beyond = waypoints.iter().enumerate().filter(|(_, own)| {
        // NaN is beyond
        !(own.rest_m <= request.within_m
            && own.rest_rad.is_none_or(|rest| rest <= request.within_rad))
    });
    let beyond = beyond.map(|(row, own)| {
        let way = Shown::fine("m").text(own.rest_m);
        let rest = match own.rest_rad {
            Some(rest) => format!("{way} and {} are left", Shown::fine("rad").text(rest)),
            None => format!("{way} are left"),
        };
        (own.line, row + 1, rest)
    });
    let beyond: Vec<_> = beyond.collect();
    match beyond.is_empty() {
        true => Ok(()),
        false => Err(unreachable(&beyond, waypoints.len(), source)),
    }
}

/// The table that is written.
fn written(rows: &Recording, targets: &[Wanted], waypoints: &[CorrectedWaypoint]) -> Recording {
    let mut written = rows.clone();
    // what a log measured there is no part of a path
    written.output = vec![None; written.joint.len()];
    written.cable_m.clear();
    (written.contact, written.plane, written.tool) = (None, None, None);
    for (joint, column) in written.joint.iter_mut().enumerate() {
        *column = waypoints.iter().map(|own| own.command[joint]).collect();
    }
    let column = |of: &dyn Fn(&Wanted) -> f64| targets.iter().map(of).collect::<Vec<f64>>();
    written.position_m = Some(std::array::from_fn(|axis| {
        column(&|own: &Wanted| own.position_m[axis])
    }));
    let turns: Option<Vec<[f64; 4]>> = targets.iter().map(stance::quaternion_wxyz).collect();
    written.orientation_wxyz =
        turns.map(|turns| std::array::from_fn(|part| turns.iter().map(|own| own[part]).collect()));
    let rest = waypoints.iter().map(|own| own.rest_m).collect();
    written.covariates.push((REST_COLUMN.to_owned(), rest));
    let turns: Option<Vec<f64>> = waypoints.iter().map(|own| own.rest_rad).collect();
    let turns = turns.map(|column| ("rest_rad".to_owned(), column));
    written.covariates.extend(turns);
    written
}

impl Waypoints {
    fn refuse_row(&self, row: usize, error: &haptical_model::ModelError) -> Error {
        let next = "correct the waypoint, or the device file";
        self.log.refuse_row("row", error.to_string(), row, next)
    }
}

impl Corrected {
    /// The corrected path as a table.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn to_csv(&self) -> Result<Vec<u8>, Error> {
        let mut text = Vec::new();
        haptical_data::write_log_to(&mut text, &self.recording, &self.shape)
            .map_err(Error::internal)?;
        Ok(text)
    }

    /// Largest distance that is left \[m\], and the largest turn \[rad\].
    pub fn largest_rest(&self) -> (f64, Option<f64>) {
        let way = self.waypoints.iter().map(|own| own.rest_m);
        let turn = self.waypoints.iter().filter_map(|own| own.rest_rad);
        let (way, turn) = (way.fold(0.0, f64::max), turn.fold(0.0, f64::max));
        (way, self.with_orientations.then_some(turn))
    }

    /// Root mean square and largest of the distances that the path's own readings would leave \[m\], and the row (from 1) of
    /// the largest; none where the path has no readings.
    pub fn before_m(&self) -> Option<(f64, f64, usize)> {
        let before: Option<Vec<f64>> = self.waypoints.iter().map(|own| own.before_m).collect();
        let before = before?;
        let squares: f64 = before.iter().map(|own| own * own).sum();
        let rows = before.iter().enumerate();
        let (row, largest) = rows.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        Some(((squares / before.len() as f64).sqrt(), *largest, row + 1))
    }
}
