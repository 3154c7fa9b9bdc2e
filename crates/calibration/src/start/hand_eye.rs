//! Start values of a tracker's bases and markers: in closed form, then fitted with the geometry held.

use haptical_identification::{Settings, solve};
use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use haptical_model::{Device, ParameterId, Recording};

use crate::problem::measurement::rotation::rotation_vector;
use crate::start::sights::{Frames, Open, Rig, Sight, sights};
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

/// Gives the tracker's unknown bases and what it sees on the hand a place, unless the device has one.
pub(crate) fn place_tracker(
    device: &mut Device,
    recording: &Recording,
    poses: &[Pose],
) -> Result<(), CalibrationError> {
    let mut rig = Rig::new(device, recording);
    let all = sights(recording, poses, device, &rig);
    rig.close_unseen(&all);
    if !rig.open.is_any() {
        return Ok(());
    }
    let (frames, tame) = trimmed(&all, &rig);
    let rows = tame.unwrap_or_else(|| all.iter().map(|sight| sight.row).collect());
    rig.place(device, &frames, &all);
    if let Some(fitted) = fit(device, &recording.select(&rows), &rig)? {
        device.surroundings = fitted.surroundings.settled();
    }
    Ok(())
}

/// Base and tool by the sights that are no wild readings, and the rows of those; none where all are. What is left of
/// the sights by the frames of the others is compared, as wild ones draw the frames to themselves.
fn trimmed(sights: &[Sight], rig: &Rig) -> (Frames, Option<Vec<usize>>) {
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

/// Bases and tools by sights. Turns from orientations; where a base is seen by positions alone, its turn and the offsets in
/// turn.
pub(crate) fn closed_form(sights: &[Sight], rig: &Rig) -> Frames {
    let (mut frames, open) = (rig.known.clone(), &rig.open);
    let is_turned = sights.iter().any(|sight| sight.rotation.is_some());
    if is_turned {
        turn(sights, &mut frames, open);
    }
    let turned = |base: usize| {
        let mut own = sights.iter().filter(|sight| sight.base == base);
        own.any(|sight| sight.rotation.is_some())
    };
    let unturned: Vec<usize> = (0..open.bases.len())
        .filter(|&base| open.bases[base] && !turned(base))
        .collect();
    if unturned.is_empty() {
        slide(sights, &mut frames, open);
        return frames;
    }
    let mut starts = vec![Vector3::zeros()];
    if !is_turned && open.tools.contains(&true) {
        let axes = (0..3).flat_map(|axis| [REACH_M, -REACH_M].map(|out| Vector3::ith(axis, out)));
        starts.extend(axes);
    }
    let tried = starts.into_iter().map(|tool_m| {
        let mut frames = frames.clone();
        for (tool, _) in frames
            .tools
            .iter_mut()
            .zip(&open.tools)
            .filter(|own| *own.1)
        {
            tool.position_m = tool_m;
        }
        for _ in 0..ROUNDS {
            for &base in &unturned {
                turn_by_positions(sights, &mut frames, base);
            }
            slide(sights, &mut frames, open);
        }
        frames
    });
    let best = tried.min_by(|a, b| missed(sights, a).total_cmp(&missed(sights, b)));
    best.unwrap_or(frames)
}

/// The turns of bases and tools from the orientations seen.
///
/// Between two rows of one base and one tool the handle turns by `b = log(R_i^T R_j)` and what is tracked by
/// `a = X^T b`, whatever the base is: X^T is the turn that takes all b to their a best (Park & Martin 1994). Then
/// `B = M X^T R^T`, averaged.
fn turn(sights: &[Sight], frames: &mut Frames, open: &Open) {
    let seen: Vec<(&Sight, Matrix3<f64>)> = sights
        .iter()
        .filter_map(|sight| Some((sight, sight.rotation?)))
        .collect();
    for tool in (0..open.tools.len()).filter(|&tool| open.tools[tool]) {
        let own: Vec<(&Sight, Matrix3<f64>)> = seen
            .iter()
            .filter(|(sight, _)| sight.tool == tool)
            .copied()
            .collect();
        if own.is_empty() {
            continue;
        }
        frames.tools[tool].rotation = if own.iter().any(|(sight, _)| open.bases[sight.base]) {
            nearest_turn(&turns_by_pairs(&own)).transpose()
        } else {
            let sum = own.iter().map(|(sight, m)| {
                let base = frames.bases[sight.base].rotation;
                sight.handle.rotation.transpose() * base.transpose() * m
            });
            nearest_turn(&sum.sum())
        };
    }
    for base in (0..open.bases.len()).filter(|&base| open.bases[base]) {
        let own = seen.iter().filter(|(sight, _)| sight.base == base);
        let sum = own.map(|(sight, m)| {
            let tool = frames.tools[sight.tool].rotation;
            m * tool.transpose() * sight.handle.rotation.transpose()
        });
        frames.bases[base].rotation = nearest_turn(&sum.sum());
    }
}

/// Sum of a b^T over pairs of rows of one tool that were seen from one base.
fn turns_by_pairs(own: &[(&Sight, Matrix3<f64>)]) -> Matrix3<f64> {
    let count = own.len();
    let mut sum = Matrix3::zeros();
    for step in [1, count / 3, count / 2] {
        for first in 0..count {
            let ((one, m), (other, n)) = (own[first], own[(first + step) % count]);
            if one.base != other.base {
                continue;
            }
            let (r, s) = (one.handle.rotation, other.handle.rotation);
            let (by_handle, by_tool) = (
                rotation_vector(&(r.transpose() * s)),
                rotation_vector(&(m.transpose() * n)),
            );
            if TURNS_RAD.contains(&by_handle.norm()) && TURNS_RAD.contains(&by_tool.norm()) {
                sum += by_tool * by_handle.transpose();
            }
        }
    }
    sum
}

/// A base's turn from positions, the tools' offsets given (Kabsch 1976).
fn turn_by_positions(sights: &[Sight], frames: &mut Frames, base: usize) {
    let points: Vec<(Vector3<f64>, Vector3<f64>)> = sights
        .iter()
        .filter(|sight| sight.base == base)
        .filter_map(|sight| Some((frames.point_m(sight), sight.position_m?)))
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
    frames.bases[base].rotation = nearest_turn(&spread.sum());
}

/// The offsets of bases and tools, the turns given: linear in all, `seen - B p = B R x + b`.
fn slide(sights: &[Sight], frames: &mut Frames, open: &Open) {
    // tools first, then bases
    let tools = frames.tools.len();
    let size = 3 * (tools + frames.bases.len());
    let (mut normal, mut right) = (
        DMatrix::<f64>::zeros(size, size),
        DVector::<f64>::zeros(size),
    );
    for sight in sights {
        let Some(seen) = sight.position_m else {
            continue;
        };
        let base = &frames.bases[sight.base];
        let turned = base.rotation * sight.handle.rotation;
        let mut rest = seen - base.rotation * sight.handle.position_m;
        let blocks = [
            (open.tools[sight.tool], 3 * sight.tool, turned),
            (
                open.bases[sight.base],
                3 * (tools + sight.base),
                Matrix3::identity(),
            ),
        ];
        if !blocks[0].0 {
            rest -= turned * frames.tools[sight.tool].position_m;
        }
        if !blocks[1].0 {
            rest -= base.position_m;
        }
        let own = || blocks.iter().filter(|(is_open, _, _)| *is_open);
        for (_, first, by_first) in own() {
            let mut part = right.fixed_rows_mut::<3>(*first);
            part += by_first.transpose() * rest;
            for (_, second, by_second) in own() {
                let mut part = normal.fixed_view_mut::<3, 3>(*first, *second);
                part += by_first.transpose() * by_second;
            }
        }
    }
    // where base and tool slide along one direction that nothing turns, the marker is near the handle
    let [of_tool, of_base] = DAMPING.map(|share| share * normal.trace().max(1.0));
    for column in 0..size {
        let damping = if column < 3 * tools { of_tool } else { of_base };
        normal[(column, column)] += damping;
    }
    let solution = normal.cholesky().map(|factor| factor.solve(&right));
    let Some(solution) = solution.filter(|all| all.iter().all(|part| part.is_finite())) else {
        return;
    };
    let all = frames.tools.iter_mut().chain(&mut frames.bases);
    let are_open = open.tools.iter().chain(&open.bases);
    for (index, (frame, is_open)) in all.zip(are_open).enumerate() {
        if *is_open {
            frame.position_m = solution.fixed_rows::<3>(3 * index).into_owned();
        }
    }
}

/// Sum of squares of the positions' errors.
pub(crate) fn missed(sights: &[Sight], frames: &Frames) -> f64 {
    sights.iter().map(|sight| miss(sight, frames).powi(2)).sum()
}

/// A position's error \[m\]; 0 without one.
fn miss(sight: &Sight, frames: &Frames) -> f64 {
    let base = &frames.bases[sight.base];
    let seen = base.rotation * frames.point_m(sight) + base.position_m;
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

/// Bases and tools that were open fitted to what the tracker saw, all else held; none where the search ends nowhere.
fn fit(
    device: &Device,
    recording: &Recording,
    rig: &Rig,
) -> Result<Option<Device>, CalibrationError> {
    let sees =
        |channel: Channel| (0..recording.len()).any(|row| channel.has_reading(recording, row));
    let (slides, turns) = (sees(Channel::Position), sees(Channel::Orientation));
    let seen = [
        slides.then_some(Channel::Position),
        turns.then_some(Channel::Orientation),
    ];
    let channels: Vec<Channel> = seen.into_iter().flatten().collect();
    let parameters: Vec<ParameterId> = rig
        .open_parameters(device, slides, turns)
        .into_iter()
        .map(ParameterId::Surrounding)
        .collect();
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
