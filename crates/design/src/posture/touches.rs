//! Poses in which the handle sits in a socket or lies on a plane, and where these are put.

use haptical_model::kinematics::nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use haptical_model::{ContactPair, ContactPoint, Device, Evaluation, PlanePair, TouchedPlane};

use crate::posture::candidates::Draws;
use crate::{DesignError, Equipped, Limits, Measure, Posture, candidates};

/// Standard deviation of a stated distance or angle between touched things: a gauge of 10 um over 0.1 m.
const STATED_SD: f64 = 1e-5;
/// Poses that show where the handle gets to.
const CLOUD: usize = 200;
/// Steps of the projection onto what is touched.
const STEPS: usize = 40;
/// Tolerance of a touch \[m\], rounding: a larger miss would add information that a real touch does not have.
const MET_M: f64 = 1e-13;

/// What the handle touches.
enum Touch {
    Point(String, Vector3<f64>),
    Plane(String, Vector3<f64>, f64),
}

/// Candidate poses of a rig with touches; none for other rigs. Sockets and planes go into the device.
pub(crate) fn postures(
    equipped: &mut Equipped,
    limits: &Limits,
    count: usize,
    seed: u64,
) -> Result<Option<Vec<Posture>>, DesignError> {
    let touches = place(equipped, limits, seed)?;
    if touches.is_empty() {
        return Ok(None);
    }
    let device = equipped.device.clone();
    let mut draws = Draws::new(&device, limits, seed)?;
    let found = draws.find(count, |draws, found| {
        let touch = &touches[found % touches.len()];
        let readings = project(&device, touch, draws.draw())?;
        if !(draws.is_within(&readings) && draws.admits(&readings)) {
            return None;
        }
        let mut posture = Posture::free(readings);
        match touch {
            Touch::Point(id, _) => posture.contact.clone_from(id),
            Touch::Plane(id, ..) => posture.plane.clone_from(id),
        }
        Some(posture)
    });
    found.map(Some)
}

/// Puts sockets and planes where the handle gets to, and names their unknowns among the parameters.
fn place(equipped: &mut Equipped, limits: &Limits, seed: u64) -> Result<Vec<Touch>, DesignError> {
    let measures = equipped.rig.measures.clone();
    let is_touch =
        |measure: &Measure| matches!(measure, Measure::Contact { .. } | Measure::Plane { .. });
    let places = &mut equipped.device.surroundings;
    (places.contacts, places.planes) = (Vec::new(), Vec::new());
    if !measures.iter().any(is_touch) {
        return Ok(Vec::new());
    }
    let cloud = handles_m(
        &equipped.device,
        &candidates(&equipped.device, limits, CLOUD, seed)?,
    );
    let mut touches = Vec::new();
    for measure in measures {
        match measure {
            Measure::Contact { points, distance_m } => {
                let at_m = sockets_m(&cloud, points, distance_m);
                for (index, position_m) in at_m.into_iter().enumerate() {
                    let id = format!("socket{}", index + 1);
                    equipped.device.surroundings.contacts.push(ContactPoint {
                        id: id.clone(),
                        position_m: position_m.into(),
                    });
                    touches.push(Touch::Point(id, position_m));
                }
                if let Some(distance_m) = distance_m {
                    equipped.device.contact_pairs = vec![ContactPair {
                        a: "socket1".to_owned(),
                        b: "socket2".to_owned(),
                        distance_m,
                        sd_m: STATED_SD,
                    }];
                }
            }
            Measure::Plane { planes } => {
                for (index, (normal, offset_m)) in planes_of(&cloud, planes).into_iter().enumerate()
                {
                    let id = format!("plane{}", index + 1);
                    equipped.device.surroundings.planes.push(TouchedPlane {
                        id: id.clone(),
                        normal: normal.into(),
                        tilt: [0.0; 2],
                        offset_m,
                    });
                    touches.push(Touch::Plane(id, normal, offset_m));
                }
                if planes > 1 {
                    equipped.device.surroundings.plane_pairs = vec![PlanePair {
                        a: "plane1".to_owned(),
                        b: "plane2".to_owned(),
                        angle_rad: std::f64::consts::FRAC_PI_2,
                        sd_rad: STATED_SD,
                    }];
                }
            }
            _ => {}
        }
    }
    equipped.name_parameters();
    Ok(touches)
}

fn handles_m(device: &Device, poses: &[Vec<f64>]) -> Vec<Vector3<f64>> {
    let mut evaluation = Evaluation::new(device);
    let mut handle = |pose: &Vec<f64>| {
        let moved = evaluation.move_pose_to(pose);
        let pose = moved.and_then(|()| evaluation.pose().copied());
        pose.ok().map(|pose| pose.position_m)
    };
    poses.iter().filter_map(&mut handle).collect()
}

/// The first socket at the place that is nearest to the middle of where the handle gets to; the second at its
/// distance towards the place that is nearest to that distance, or, without one, each next at the place that is
/// farthest from the others within the inner half.
fn sockets_m(cloud: &[Vector3<f64>], points: usize, distance_m: Option<f64>) -> Vec<Vector3<f64>> {
    let middle = mean(cloud);
    let from_middle = |place: &&Vector3<f64>| (*place - middle).norm();
    let mut inner: Vec<&Vector3<f64>> = cloud.iter().collect();
    inner.sort_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
    inner.truncate(cloud.len().div_ceil(2));
    let mut chosen: Vec<Vector3<f64>> = inner.first().map_or(vec![middle], |first| vec![**first]);
    while chosen.len() < points {
        let nearest = |place: &&Vector3<f64>| {
            let ways = chosen.iter().map(|other| (*place - other).norm());
            ways.fold(f64::INFINITY, f64::min)
        };
        let wanted = distance_m.filter(|_| chosen.len() == 1);
        let rank = |place: &&Vector3<f64>| match wanted {
            Some(distance_m) => -(nearest(place) - distance_m).abs(),
            None => nearest(place),
        };
        let best = inner
            .iter()
            .copied()
            // the first one is nearer to a short distance than any other
            .filter(|place| nearest(place) > 0.0)
            .max_by(|a, b| rank(a).total_cmp(&rank(b)));
        let Some(best) = best else {
            break;
        };
        let way = (best - chosen[0]).try_normalize(f64::MIN_POSITIVE);
        chosen.push(match (wanted, way) {
            (Some(distance_m), Some(way)) => chosen[0] + way * distance_m,
            _ => *best,
        });
    }
    chosen
}

/// Planes through the middle, across the directions in which the handle gets least far.
fn planes_of(cloud: &[Vector3<f64>], planes: usize) -> Vec<(Vector3<f64>, f64)> {
    let middle = mean(cloud);
    let mut spread = Matrix3::zeros();
    for place in cloud {
        let out = place - middle;
        spread += out * out.transpose();
    }
    let axes = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| axes.eigenvalues[a].total_cmp(&axes.eigenvalues[b]));
    let plane = |&axis: &usize| {
        let normal = axes.eigenvectors.column(axis).into_owned();
        (normal, normal.dot(&middle))
    };
    order.iter().take(planes).map(plane).collect()
}

fn mean(places: &[Vector3<f64>]) -> Vector3<f64> {
    places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64
}

/// The posture near `readings` in which the handle meets what it touches, by Gauss-Newton steps of least
/// length; none where they do not get there.
fn project(device: &Device, touch: &Touch, mut readings: Vec<f64>) -> Option<Vec<f64>> {
    let mut evaluation = Evaluation::new(device);
    for _ in 0..STEPS {
        evaluation.move_to(&readings).ok()?;
        let handle = evaluation.pose().ok()?.position_m;
        let (gap, directions): (DVector<f64>, Vec<Vector3<f64>>) = match touch {
            Touch::Point(_, place) => {
                let gap = place - handle;
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                (DVector::from_column_slice(gap.as_slice()), axes.to_vec())
            }
            Touch::Plane(_, normal, offset_m) => {
                let gap = offset_m - normal.dot(&handle);
                (DVector::from_element(1, gap), vec![*normal])
            }
        };
        if gap.norm() < MET_M {
            return Some(readings);
        }
        let slopes = DMatrix::from_fn(directions.len(), readings.len(), |row, joint| {
            directions[row].dot(&evaluation.reading_twist(joint).linear)
        });
        let square = &slopes * slopes.transpose();
        let step = slopes.tr_mul(&square.lu().solve(&gap)?);
        if !step.iter().all(|step| step.is_finite()) {
            return None;
        }
        // half a radian at most: far from there the slopes mean little
        let most = step.amax().max(f64::MIN_POSITIVE);
        let share = (0.5 / most).min(1.0);
        for (reading, step) in readings.iter_mut().zip(step.iter()) {
            *reading += share * step;
        }
    }
    None
}
