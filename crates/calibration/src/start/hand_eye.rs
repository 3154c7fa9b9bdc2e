//! Start values of a tracker's base and marker: in closed form, then fitted with the geometry held.

use haptical_identification::{Settings, solve};
use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{Matrix3, Matrix6, Vector3, Vector6};
use haptical_model::{Device, ParameterId, Placement, Recording, SurroundingParameter};

use crate::problem::measurement::rotation::{measured_rotation, rotation_vector};
use crate::{CalibrationError, Channel, DeviceProblem, Weights};

/// Rounds between turn and offset where positions alone are seen: the error falls by the share of the tool's
/// length in the workspace at each.
const ROUNDS: usize = 30;
/// Tool offsets that are tried where positions alone are seen \[m\].
const REACH_M: f64 = 0.1;
/// Turns between two rows that have an axis: from a twentieth of a radian to what is clearly below half a turn.
const TURNS_RAD: std::ops::Range<f64> = 0.05..2.9;
/// Damping of tool and base where their offsets are sought, in shares of the trace: the larger one decides a direction
/// that is open, and moves none that is seen.
const DAMPING: [f64; 2] = [1e-9, 1e-13];
/// Steps of the fit with the geometry held.
const STEPS: usize = 100;

/// How often wild sights are looked for, and from how many medians of what the sights miss by one is wild: a device as
/// built leaves none at half of that.
const TRIMMINGS: usize = 8;
const WILD: f64 = 8.0;

/// One row: the handle in frame (-1), and what the tracker saw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// Row of the recording.
    pub(crate) row: usize,
    pub(crate) handle: Pose,
    pub(crate) position_m: Option<Vector3<f64>>,
    pub(crate) rotation: Option<Matrix3<f64>>,
}

/// Base B and tool X with `seen = B handle X`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Frames {
    pub(crate) base: Pose,
    pub(crate) tool: Pose,
}

/// A tracker's frames as far as a device has them, and which of base and tool are open: unknown, and without a place.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rig {
    known: Frames,
    pub(crate) open: [bool; 2],
}

impl Rig {
    /// The same tracker at a base that is known, and a tool that is open.
    pub(crate) fn at_base(base: Pose) -> Self {
        Self {
            known: Frames {
                base,
                ..Frames::default()
            },
            open: [false, true],
        }
    }

    /// A tracker of which nothing is known but what is not open.
    pub(crate) fn from_open(open: [bool; 2]) -> Self {
        Self {
            open,
            ..Self::default()
        }
    }

    /// None for a device without a tracker.
    pub(crate) fn new(device: &Device) -> Option<Self> {
        let tracker = device.tracker.as_ref()?;
        let (base, tool) = (
            device.surroundings.tracker_base,
            device.surroundings.tracker_tool,
        );
        Some(Self {
            known: Frames {
                base: base.unwrap_or_default().pose(),
                tool: tool.unwrap_or_default().pose(),
            },
            open: [
                !tracker.base_known && base.is_none(),
                !tracker.tool_known && tool.is_none(),
            ],
        })
    }
}

/// Gives the tracker's unknown base and tool a place, unless the device has one.
pub(crate) fn place_tracker(
    device: &mut Device,
    recording: &Recording,
    poses: &[Pose],
) -> Result<(), CalibrationError> {
    let Some(rig) = Rig::new(device).filter(|rig| rig.open != [false; 2]) else {
        return Ok(());
    };
    let open = rig.open;
    let (frames, tame) = trimmed(&sights(recording, poses), &rig);
    let tame = tame.map(|rows| recording.select(&rows));
    let recording = tame.as_ref().unwrap_or(recording);
    if open[0] {
        device.surroundings.tracker_base = Some(Placement::from_pose(&frames.base));
    }
    if open[1] {
        device.surroundings.tracker_tool = Some(Placement::from_pose(&frames.tool));
    }
    if let Some(fitted) = fit(device, recording, open)? {
        device.surroundings = fitted.surroundings.settled();
    }
    Ok(())
}

/// Base and tool by the sights that are no wild readings, and the rows of those; none where all are. What is left of
/// the sights by the frames of the others is compared, as wild ones draw the frames to themselves.
pub(crate) fn trimmed(sights: &[Sight], rig: &Rig) -> (Frames, Option<Vec<usize>>) {
    let mut frames = closed_form(sights, rig);
    let mut kept: Option<Vec<usize>> = None;
    for _ in 0..TRIMMINGS {
        let misses: Vec<f64> = sights.iter().map(|sight| miss(sight, &frames)).collect();
        let mut sorted: Vec<f64> = misses.iter().copied().filter(|miss| *miss > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(median) = sorted.get(sorted.len() / 2) else {
            break;
        };
        let tame: Vec<usize> = (0..sights.len())
            .filter(|&own| misses[own] <= WILD * median)
            .collect();
        let are_all = tame.len() == sights.len();
        if kept.as_ref() == Some(&tame) || (kept.is_none() && are_all) {
            break;
        }
        let own: Vec<Sight> = tame.iter().map(|&own| sights[own]).collect();
        frames = closed_form(&own, rig);
        kept = Some(tame);
    }
    let kept = kept.map(|kept| kept.into_iter().map(|own| sights[own].row).collect());
    (frames, kept)
}

pub(crate) fn sights(recording: &Recording, poses: &[Pose]) -> Vec<Sight> {
    let rows = poses.iter().enumerate();
    let sights = rows.map(|(row, handle)| {
        let position = recording.position_m.as_ref();
        let position = position.map(|axes| Vector3::from(axes.each_ref().map(|axis| axis[row])));
        let rotation = measured_rotation(recording, row);
        Sight {
            row,
            handle: *handle,
            position_m: position.filter(|position| position.iter().all(|part| part.is_finite())),
            rotation: rotation
                .iter()
                .all(|part| part.is_finite())
                .then_some(rotation),
        }
    });
    sights
        .filter(|sight| sight.position_m.is_some() || sight.rotation.is_some())
        .collect()
}

pub(crate) fn closed_form(sights: &[Sight], rig: &Rig) -> Frames {
    let (mut frames, open) = (rig.known, rig.open);
    let is_turned = sights.iter().any(|sight| sight.rotation.is_some());
    if is_turned {
        turn(sights, &mut frames, open);
        slide(sights, &mut frames, open);
        return frames;
    }
    if !open[0] {
        slide(sights, &mut frames, open);
        return frames;
    }
    let mut starts = vec![Vector3::zeros()];
    if open[1] {
        let axes = (0..3).flat_map(|axis| [REACH_M, -REACH_M].map(|out| Vector3::ith(axis, out)));
        starts.extend(axes);
    }
    let tried = starts.into_iter().map(|tool_m| {
        let mut frames = frames;
        if open[1] {
            frames.tool.position_m = tool_m;
        }
        for _ in 0..ROUNDS {
            turn_by_positions(sights, &mut frames);
            slide(sights, &mut frames, open);
        }
        frames
    });
    let best = tried.min_by(|a, b| missed(sights, a).total_cmp(&missed(sights, b)));
    best.unwrap_or(frames)
}

/// The turns of base and tool from the orientations seen.
///
/// Between two rows the handle turns by `b = log(R_i^T R_j)` and what is tracked by `a = X^T b`, whatever the base
/// is: X^T is the turn that takes all b to their a best (Park & Martin 1994). Then `B = M X^T R^T`, averaged.
fn turn(sights: &[Sight], frames: &mut Frames, open: [bool; 2]) {
    let seen: Vec<(Matrix3<f64>, Matrix3<f64>)> = sights
        .iter()
        .filter_map(|sight| Some((sight.handle.rotation, sight.rotation?)))
        .collect();
    let count = seen.len();
    if open == [true, true] {
        let mut sum = Matrix3::zeros();
        for step in [1, count / 3, count / 2] {
            for first in 0..count {
                let ((r, m), (s, n)) = (seen[first], seen[(first + step) % count]);
                let (by_handle, by_tool) = (
                    rotation_vector(&(r.transpose() * s)),
                    rotation_vector(&(m.transpose() * n)),
                );
                if TURNS_RAD.contains(&by_handle.norm()) && TURNS_RAD.contains(&by_tool.norm()) {
                    sum += by_tool * by_handle.transpose();
                }
            }
        }
        frames.tool.rotation = nearest_turn(&sum).transpose();
    } else if open[1] {
        let sum = seen
            .iter()
            .map(|(r, m)| r.transpose() * frames.base.rotation.transpose() * m);
        frames.tool.rotation = nearest_turn(&sum.sum());
    }
    if open[0] {
        let sum = seen
            .iter()
            .map(|(r, m)| m * frames.tool.rotation.transpose() * r.transpose());
        frames.base.rotation = nearest_turn(&sum.sum());
    }
}

/// The base's turn from positions, the tool's offset given (Kabsch 1976).
fn turn_by_positions(sights: &[Sight], frames: &mut Frames) {
    let points: Vec<(Vector3<f64>, Vector3<f64>)> = sights
        .iter()
        .filter_map(|sight| {
            let handle = &sight.handle;
            let point = handle.position_m + handle.rotation * frames.tool.position_m;
            Some((point, sight.position_m?))
        })
        .collect();
    let count = points.len().max(1) as f64;
    let (from, to) = points
        .iter()
        .fold((Vector3::zeros(), Vector3::zeros()), |sum, point| {
            (sum.0 + point.0 / count, sum.1 + point.1 / count)
        });
    let spread = points
        .iter()
        .map(|point| (point.1 - to) * (point.0 - from).transpose());
    frames.base.rotation = nearest_turn(&spread.sum());
}

/// The offsets of base and tool, the turns given: linear in both, `seen - B p = B R x + b`.
fn slide(sights: &[Sight], frames: &mut Frames, open: [bool; 2]) {
    let (mut normal, mut right) = (Matrix6::zeros(), Vector6::zeros());
    let base = frames.base.rotation;
    for sight in sights {
        let Some(seen) = sight.position_m else {
            continue;
        };
        let turned = base * sight.handle.rotation;
        let mut rest = seen - base * sight.handle.position_m;
        if !open[0] {
            rest -= frames.base.position_m;
        }
        if !open[1] {
            rest -= turned * frames.tool.position_m;
        }
        for axis in 0..3 {
            let mut row = Vector6::zeros();
            for column in 0..3 {
                row[column] = if open[1] { turned[(axis, column)] } else { 0.0 };
            }
            row[3 + axis] = if open[0] { 1.0 } else { 0.0 };
            normal += row * row.transpose();
            right += row * rest[axis];
        }
    }
    // where base and tool slide along one direction that nothing turns, the marker is near the handle
    let [tool, base] = DAMPING.map(|share| share * normal.trace().max(1.0));
    let damping = Vector6::new(tool, tool, tool, base, base, base);
    let solution = (normal + Matrix6::from_diagonal(&damping)).cholesky();
    let solution = solution.map(|factor| factor.solve(&right));
    let Some(solution) = solution.filter(|all| all.iter().all(|part| part.is_finite())) else {
        return;
    };
    if open[1] {
        frames.tool.position_m = solution.fixed_rows::<3>(0).into_owned();
    }
    if open[0] {
        frames.base.position_m = solution.fixed_rows::<3>(3).into_owned();
    }
}

/// Sum of squares of the positions' errors.
pub(crate) fn missed(sights: &[Sight], frames: &Frames) -> f64 {
    sights.iter().map(|sight| miss(sight, frames).powi(2)).sum()
}

/// A position's error \[m\]; 0 without one.
fn miss(sight: &Sight, frames: &Frames) -> f64 {
    let handle = &sight.handle;
    let point = handle.position_m + handle.rotation * frames.tool.position_m;
    let seen = frames.base.rotation * point + frames.base.position_m;
    sight.position_m.map_or(0.0, |own| (seen - own).norm())
}

/// The rotation R with the largest trace of R^T M: that nearest to M.
fn nearest_turn(sum: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = sum.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let sign = (u * v_t).determinant().signum();
    let turn = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    if turn.iter().all(|part| part.is_finite()) {
        turn
    } else {
        Matrix3::identity()
    }
}

/// Base and tools alone fitted to what the tracker saw; none where the search ends nowhere.
pub(crate) fn fit(
    device: &Device,
    recording: &Recording,
    open: [bool; 2],
) -> Result<Option<Device>, CalibrationError> {
    use SurroundingParameter::{Tool, TrackerBase, TrackerTool};
    let sees =
        |channel: Channel| (0..recording.len()).any(|row| channel.has_reading(recording, row));
    let (slides, turns) = (sees(Channel::Position), sees(Channel::Orientation));
    let seen = [
        slides.then_some(Channel::Position),
        turns.then_some(Channel::Orientation),
    ];
    let channels: Vec<Channel> = seen.into_iter().flatten().collect();
    let first = if slides { 0 } else { 3 };
    // positions tell the base's turn too; only orientations tell the tool's
    let end = if turns { 6 } else { 3 };
    let base = (first..6)
        .filter(|_| open[0])
        .map(|index| TrackerBase { index });
    let tool = (first..end)
        .filter(|_| open[1] && !device.has_tool_per_hand())
        .map(|index| TrackerTool { index });
    let tools = (0..device.surroundings.tools.len()).filter(|_| open[1]);
    let tools = tools.flat_map(|tool| (first..end).map(move |index| Tool { tool, index }));
    let parameters = base.chain(tool).chain(tools).map(ParameterId::Surrounding);
    let parameters: Vec<ParameterId> = parameters.collect();
    let weights = Weights::stated(device, &channels);
    let problem = DeviceProblem::new(device, recording, &channels, &parameters, &weights)?;
    let free: Vec<usize> = (0..parameters.len()).collect();
    let settings = Settings {
        max_iterations: STEPS,
        ..Settings::default()
    };
    let fitted = solve(&problem, &problem.start(), &free, &settings);
    Ok(fitted.ok().map(|fit| problem.device_with(&fit.parameters)))
}
