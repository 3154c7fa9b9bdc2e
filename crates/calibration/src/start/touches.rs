//! Start values of touched points and planes, and of tools that touch them.

use haptical_model::kinematics::Pose;
use haptical_model::kinematics::nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use haptical_model::{ContactPoint, Device, Placement, Recording, TouchedPlane};

use crate::start::ids::listed;
use crate::start::points::mean;
use crate::start::sights::tool_of;

/// Damping of a tool's offset, in shares of the trace: it decides a direction that is open, and moves none that is seen.
const DAMPING: f64 = 1e-9;
/// The same of a point, which tools decide.
const DAMPING_OF_POINTS: f64 = 1e-13;

pub(crate) fn place_touches(device: &mut Device, recording: &Recording, poses: &[Pose]) {
    place_tools(device, recording, poses);
    let points = touching_m(device, recording, poses);
    let touches = |ids: &[String], id: &str| -> Vec<Vector3<f64>> {
        let touched = ids.iter().zip(&points).filter(|(other, _)| *other == id);
        touched.map(|(_, point)| *point).collect()
    };
    let old = std::mem::take(&mut device.surroundings.contacts);
    for id in recording.contact.as_deref().map(listed).unwrap_or_default() {
        let known = old.iter().find(|point| point.id == id).cloned();
        let ids = recording.contact.as_deref().unwrap_or_default();
        let point = known.unwrap_or_else(|| ContactPoint {
            position_m: mean(&touches(ids, &id)).into(),
            id,
        });
        device.surroundings.contacts.push(point);
    }
    let old = std::mem::take(&mut device.surroundings.planes);
    for id in recording.plane.as_deref().map(listed).unwrap_or_default() {
        let known = old.iter().find(|plane| plane.id == id).cloned();
        let ids = recording.plane.as_deref().unwrap_or_default();
        let plane = known.unwrap_or_else(|| plane_through(id.clone(), &touches(ids, &id)));
        device.surroundings.planes.push(plane);
    }
}

/// What touches at each row, in frame (-1).
fn touching_m(device: &Device, recording: &Recording, poses: &[Pose]) -> Vec<Vector3<f64>> {
    let mounts = device.mounts(recording).unwrap_or_default();
    let rows = poses.iter().enumerate();
    rows.map(|(row, pose)| {
        let mount = mounts.get(row).copied().unwrap_or_default();
        pose.position_m + pose.rotation * device.touching_m(mount)
    })
    .collect()
}

/// Gives every tool that rows name and that has no place yet one: from its touches of points, `P + R p = c`, linear in p
/// and c; on the handle where it touches none.
fn place_tools(device: &mut Device, recording: &Recording, poses: &[Pose]) {
    if !device.has_tools(recording) {
        return;
    }
    let touching = |row| Some(device.tool_at(recording, row)).filter(|id| !device.is_of_hand(id));
    let ids: Vec<String> = (0..recording.len())
        .map(|row| touching(row).unwrap_or_default().to_owned())
        .collect();
    let around = &device.surroundings;
    let mut open = listed(&ids);
    open.retain(|id| {
        let own = around.tool_index(id);
        own.is_none_or(|own| around.tools[own].placement.is_none())
    });
    if open.is_empty() {
        return;
    }
    let offsets = offsets_by_touches(device, recording, poses, (&ids[..], &open[..]));
    for (id, offset_m) in open.iter().zip(offsets) {
        let mut placement = Placement::default();
        placement.start.position_m = offset_m;
        tool_of(&mut device.surroundings.tools, id).placement = Some(placement);
    }
}

/// The offsets of the open tools by least squares; those of a tool that touches no point are zero.
fn offsets_by_touches(
    device: &Device,
    recording: &Recording,
    poses: &[Pose],
    (ids, open): (&[String], &[String]),
) -> Vec<[f64; 3]> {
    let around = &device.surroundings;
    let touched = recording.contact.as_deref().unwrap_or_default();
    let unknown: Vec<String> = listed(touched)
        .into_iter()
        .filter(|id| around.contact_index(id).is_none())
        .collect();
    // tools first, then points
    let size = 3 * (open.len() + unknown.len());
    let (mut normal, mut right) = (
        DMatrix::<f64>::zeros(size, size),
        DVector::<f64>::zeros(size),
    );
    for ((pose, id), point) in poses.iter().zip(ids).zip(touched) {
        if point.is_empty() {
            continue;
        }
        let mut rest = -pose.position_m;
        let mut blocks: Vec<(usize, Matrix3<f64>)> = Vec::with_capacity(2);
        match open.iter().position(|own| own == id) {
            Some(tool) => blocks.push((3 * tool, pose.rotation)),
            None => {
                let tool = around
                    .tool_index(id)
                    .and_then(|own| around.tools[own].placement);
                let place = tool.map_or_else(Vector3::zeros, |own| own.start.position_m.into());
                rest -= pose.rotation * place;
            }
        }
        match around.contact_index(point) {
            Some(known) => rest += Vector3::from(around.contacts[known].position_m),
            None => {
                let own = unknown.iter().position(|own| own == point);
                let first = 3 * (open.len() + own.unwrap_or(0));
                blocks.push((first, -Matrix3::identity()));
            }
        }
        for (first, by_first) in &blocks {
            let mut part = right.fixed_rows_mut::<3>(*first);
            part += by_first.transpose() * rest;
            for (second, by_second) in &blocks {
                let mut part = normal.fixed_view_mut::<3, 3>(*first, *second);
                part += by_first.transpose() * by_second;
            }
        }
    }
    let scale = normal.trace().max(1.0);
    for column in 0..size {
        let is_tool = column < 3 * open.len();
        normal[(column, column)] += scale * if is_tool { DAMPING } else { DAMPING_OF_POINTS };
    }
    let solution = normal.cholesky().map(|factor| factor.solve(&right));
    let solution = solution.filter(|all| all.iter().all(|part| part.is_finite()));
    let offset = |tool: usize| {
        let all = solution.as_ref();
        all.map_or([0.0; 3], |all| {
            all.fixed_rows::<3>(3 * tool).into_owned().into()
        })
    };
    (0..open.len()).map(offset).collect()
}

/// Plane of least squares: through the mean, its normal the direction of least spread.
fn plane_through(id: String, points: &[Vector3<f64>]) -> TouchedPlane {
    let middle = mean(points);
    let mut spread = Matrix3::zeros();
    for point in points {
        let out = point - middle;
        spread += out * out.transpose();
    }
    let axes = spread.symmetric_eigen();
    let normal = axes
        .eigenvectors
        .column(axes.eigenvalues.imin())
        .into_owned();
    let normal = normal.try_normalize(0.5).unwrap_or_else(Vector3::z);
    TouchedPlane {
        id,
        normal: normal.into(),
        tilt: [0.0; 2],
        offset_m: normal.dot(&middle),
    }
}
