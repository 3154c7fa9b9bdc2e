//! Where things stand that a rig measures and that no file places: tracker, tools, points and planes that are touched.

use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::{
    ContactPoint, Device, Evaluation, Mount, Placement, Recording, RunBase, Tool, TouchedPlane,
};

use crate::SimulatorError;
use crate::postures::rows::mounts;
use crate::streams::{Stream, normal};
use crate::track::{STANDS_AT_M, TOOL_M, drawn_place};

/// Variance across a line, as a share of that along it, below which places lie in one line.
const IN_A_LINE: f64 = 1e-9;

/// A true device with the sensors of the device that its log is read with: the tracker, how well each thing measures, and
/// the places that the true device's file does not state. Cables that the true device lacks are the other's.
///
/// ```
/// use haptical_simulator::{model::Device, with_places_of};
/// let truth = Device::from_toml("[[joint]]\n", "truth.toml")?.device;
/// let device = Device::from_toml("[[joint]]\n[contact]\nsd_m = 2e-5\n", "device.toml")?.device;
/// assert_eq!(with_places_of(&truth, &device).surroundings.contact_sd_m, Some(2e-5));
/// # Ok::<(), haptical_simulator::model::DeviceFileError>(())
/// ```
#[must_use]
pub fn with_places_of(truth: &Device, device: &Device) -> Device {
    let mut whole = truth.clone();
    whole.tracker = device.tracker.or(truth.tracker);
    let further = device.cables.iter().skip(truth.cables.len());
    whole.cables.extend(further.copied());
    if whole.contact_pairs.is_empty() {
        whole.contact_pairs.clone_from(&device.contact_pairs);
    }
    whole.gravity_mps2 = truth.gravity_mps2.or(device.gravity_mps2);
    let (own, other) = (&mut whole.surroundings, &device.surroundings);
    own.contact_sd_m = other.contact_sd_m.or(own.contact_sd_m);
    own.plane_sd_m = other.plane_sd_m.or(own.plane_sd_m);
    own.fixture_sd_rad = other.fixture_sd_rad.or(own.fixture_sd_rad);
    own.tracker_base = own.tracker_base.or(other.tracker_base);
    own.tracker_tool = own.tracker_tool.or(other.tracker_tool);
    if own.plane_pairs.is_empty() {
        own.plane_pairs.clone_from(&other.plane_pairs);
    }
    for base in &other.run_bases {
        if !own.run_bases.iter().any(|known| known.run == base.run) {
            own.run_bases.push(*base);
        }
    }
    for tool in &other.tools {
        match own.tool_index(&tool.id) {
            None => own.tools.push(tool.clone()),
            Some(index) => own.tools[index].from_line = tool.from_line,
        }
    }
    for contact in &other.contacts {
        if own.contact_index(&contact.id).is_none() {
            own.contacts.push(contact.clone());
        }
    }
    for plane in &other.planes {
        if own.plane_index(&plane.id).is_none() {
            own.planes.push(plane.clone());
        }
    }
    if let Some(tracker) = whole.tracker {
        let own = &mut whole.surroundings;
        own.tracker_base = own
            .tracker_base
            .filter(|_| !tracker.base_known && !tracker.base_per_run);
        own.tracker_tool = own.tracker_tool.filter(|_| !tracker.tool_known);
    }
    whole
}

/// Gives a place to everything on the hand and around it that rows of a recording are about and that has none: by chance,
/// within 1.5 m the tracker, within 5 cm of the handle what it sees.
pub(super) fn place_seen(truth: &mut Device, asked: &Recording, seed: u64) {
    if let Some(tracker) = truth.tracker {
        // in the order of `add_tracker`: a seed means one place
        let mut generator = Stream::TrackerPlace.open(0, seed);
        let base = drawn_place(&mut generator, STANDS_AT_M);
        let tool = drawn_place(&mut generator, TOOL_M);
        let around = &mut truth.surroundings;
        if tracker.base_per_run {
            place_runs(&mut around.run_bases, asked, seed);
        } else if !tracker.base_known {
            around.tracker_base.get_or_insert(base);
        }
        if !tracker.tool_known {
            around.tracker_tool.get_or_insert(tool);
        }
    }
    let sees_turn = asked.orientation_wxyz.is_some();
    let mut ids: Vec<String> = Vec::new();
    for row in 0..asked.len() {
        let id = truth.tool_at(asked, row);
        if !id.is_empty() && !ids.iter().any(|known| known == id) {
            ids.push(id.to_owned());
        }
    }
    for (index, id) in ids.into_iter().enumerate() {
        let mut drawn = drawn_place(&mut Stream::ToolPlace.open(index, seed), TOOL_M);
        if !sees_turn {
            // nothing shows it, and a file does not hold it
            drawn.turn_rad = [0.0; 3];
        }
        let tools = &mut truth.surroundings.tools;
        let known = tools.iter_mut().find(|tool| tool.id == id);
        let placed = Tool {
            placement: Some(drawn),
            has_turn: sees_turn,
            ..Tool::new(&id)
        };
        match known {
            None => tools.push(placed),
            Some(tool) if tool.placement.is_none() => {
                tool.placement = placed.placement;
                tool.has_turn = placed.has_turn;
            }
            Some(_) => {}
        }
    }
}

fn place_runs(bases: &mut Vec<RunBase>, asked: &Recording, seed: u64) {
    for row in 0..asked.len() {
        let run = asked.run_at(row);
        if !bases.iter().any(|base| base.run == run) {
            let mut generator = Stream::RunPlace.open(bases.len(), seed);
            let placement: Placement = drawn_place(&mut generator, STANDS_AT_M);
            bases.push(RunBase { run, placement });
        }
    }
}

/// Puts points and planes that rows touch and that have no place where the handle of the planned device is in those rows;
/// then moves the second of a pair until their known distance or angle is met within its standard deviation.
pub(super) fn place_touched(
    truth: &mut Device,
    planned: &Device,
    asked: &Recording,
    seed: u64,
) -> Result<(), SimulatorError> {
    if asked.contact.is_none() && asked.plane.is_none() {
        return Ok(());
    }
    let tips = tips_m(truth, planned, asked)?;
    let points = named(asked.contact.as_ref(), &tips);
    let mut open: Vec<String> = Vec::new();
    for (id, tips) in &points {
        if truth.surroundings.contact_index(id).is_none() {
            open.push(id.clone());
            truth.surroundings.contacts.push(ContactPoint {
                id: id.clone(),
                position_m: mean(tips).into(),
            });
        }
    }
    let mut generator = Stream::TouchPair.open(0, seed);
    for pair in truth.contact_pairs.clone() {
        let distance_m = pair.distance_m + pair.sd_m * normal(&mut generator);
        let index = |id: &str| truth.surroundings.contact_index(id);
        let (Some(a), Some(b)) = (index(&pair.a), index(&pair.b)) else {
            continue;
        };
        // whichever no file or earlier pair holds
        let is_open = |id: &String| open.contains(id);
        let (held, moved) = match (is_open(&pair.b), is_open(&pair.a)) {
            (true, _) => (a, b),
            (false, true) => (b, a),
            (false, false) => continue,
        };
        let contacts = &mut truth.surroundings.contacts;
        let from = Vector3::from(contacts[held].position_m);
        let way = Vector3::from(contacts[moved].position_m) - from;
        let way = way
            .try_normalize(f64::MIN_POSITIVE)
            .unwrap_or_else(Vector3::x);
        contacts[moved].position_m = (from + way * distance_m).into();
        open.retain(|id| *id != pair.a && *id != pair.b);
    }
    place_planes(truth, &named(asked.plane.as_ref(), &tips), seed)
}

fn place_planes(
    truth: &mut Device,
    touched: &[(String, Vec<Vector3<f64>>)],
    seed: u64,
) -> Result<(), SimulatorError> {
    let mut open: Vec<&String> = Vec::new();
    for (id, tips) in touched {
        if truth.surroundings.plane_index(id).is_none() {
            let normal = normal_of(id, tips)?;
            open.push(id);
            truth.surroundings.planes.push(TouchedPlane {
                id: id.clone(),
                normal: normal.into(),
                tilt: [0.0; 2],
                offset_m: normal.dot(&mean(tips)),
            });
        }
    }
    let mut generator = Stream::TouchPair.open(1, seed);
    let around = &mut truth.surroundings;
    for pair in around.plane_pairs.clone() {
        let angle_rad = pair.angle_rad + pair.sd_rad * normal(&mut generator);
        let (Some(a), Some(b)) = (around.plane_index(&pair.a), around.plane_index(&pair.b)) else {
            continue;
        };
        let (held, moved) = match (open.contains(&&pair.b), open.contains(&&pair.a)) {
            (true, _) => (a, b),
            (false, true) => (b, a),
            (false, false) => continue,
        };
        let id = &around.planes[moved].id;
        let middle = touched.iter().find(|(own, _)| own == id);
        let middle = middle.map_or_else(Vector3::zeros, |(_, tips)| mean(tips));
        let still = around.planes[held].normal_and_slopes().0;
        let turned = around.planes[moved].normal_and_slopes().0;
        let across = (turned - still * still.dot(&turned)).try_normalize(1e-6);
        let Some(across) = across else {
            continue;
        };
        let side = if turned.dot(&still) < 0.0 { -1.0 } else { 1.0 };
        let normal = still * (side * libm::cos(angle_rad)) + across * libm::sin(angle_rad);
        around.planes[moved].normal = normal.into();
        around.planes[moved].tilt = [0.0; 2];
        around.planes[moved].offset_m = normal.dot(&middle);
        open.retain(|id| **id != pair.a && **id != pair.b);
    }
    Ok(())
}

/// Where what touches is in each row of the planned device with the true device's tools \[m\].
fn tips_m(
    truth: &Device,
    planned: &Device,
    asked: &Recording,
) -> Result<Vec<Vector3<f64>>, SimulatorError> {
    let mut planned = planned.clone();
    planned.surroundings = truth.surroundings.clone();
    planned.tracker = truth.tracker;
    let mounts = mounts(&planned, asked)?;
    let mut evaluation = Evaluation::new(&planned);
    let mut readings = vec![0.0; planned.joints.len()];
    let mut tips = Vec::with_capacity(asked.len());
    for row in 0..asked.len() {
        let refuse = |source| SimulatorError::Row { row, source };
        asked.read_joints(row, &mut readings);
        evaluation.choose_hand(planned.hand_at(asked, row));
        evaluation.move_pose_to(&readings).map_err(refuse)?;
        let pose = evaluation.pose().map_err(refuse)?;
        let mount: Mount = mounts.get(row).copied().unwrap_or_default();
        tips.push(pose.position_m + pose.rotation * planned.touching_m(mount));
    }
    Ok(tips)
}

/// The places of the rows of each name, in the order in which names appear.
fn named(ids: Option<&Vec<String>>, tips: &[Vector3<f64>]) -> Vec<(String, Vec<Vector3<f64>>)> {
    let mut found: Vec<(String, Vec<Vector3<f64>>)> = Vec::new();
    let rows = ids.into_iter().flatten().zip(tips);
    for (id, tip) in rows.filter(|(id, _)| !id.is_empty()) {
        match found.iter_mut().find(|(known, _)| known == id) {
            Some((_, tips)) => tips.push(*tip),
            None => found.push((id.clone(), vec![*tip])),
        }
    }
    found
}

fn mean(places: &[Vector3<f64>]) -> Vector3<f64> {
    places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64
}

/// The direction in which places spread least.
fn normal_of(id: &str, places: &[Vector3<f64>]) -> Result<Vector3<f64>, SimulatorError> {
    let middle = mean(places);
    let mut spread = Matrix3::zeros();
    for place in places {
        let out = place - middle;
        spread += out * out.transpose();
    }
    let axes = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| axes.eigenvalues[a].total_cmp(&axes.eigenvalues[b]));
    let [least, middle, most] = order.map(|axis| axes.eigenvalues[axis]);
    let is_plane =
        places.len() >= 3 && most > 0.0 && middle > IN_A_LINE * most && least.is_finite();
    if !is_plane {
        return Err(SimulatorError::NoPlane {
            id: id.to_owned(),
            postures: places.len(),
        });
    }
    let normal: Vector3<f64> = axes.eigenvectors.column(order[0]).into_owned();
    let largest = normal[normal.iamax()];
    Ok(if largest < 0.0 { -normal } else { normal })
}
