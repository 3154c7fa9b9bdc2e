//! One plan from rigs to poses: the parameters that each rig identifies, measurements for the rest, the next poses.

use haptical_calibration::ScaleOfLengths;
use haptical_identification::{Identifiability, Status};
use haptical_model::Device;
use serde::{Serialize, Serializer};

use crate::kind::cable_name;
use crate::{
    Criterion, DEGREE, DesignError, Equipped, Information, Limits, NextPoses, Posture, Region, Rig,
    Suggestion, Terms, equip, postures, suggestions,
};

/// Poses that a rig's table looks at, at most: statuses are the same with more.
const TABLE_POSES: usize = 600;

/// What is asked of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Rigs to compare; poses are chosen for the first. None for [`described_rigs`].
    pub rigs: Vec<Rig>,
    /// What of the transmissions is planned for.
    pub terms: Terms,
    /// Limits of the poses.
    pub limits: Limits,
    /// Candidates to choose from.
    pub candidates: usize,
    /// Seed of the candidates and of the search's random starts.
    pub seed: u64,
    /// Number of poses that standard deviations are for.
    pub poses: usize,
    /// Whether that many poses are to be chosen for the first rig.
    pub chooses: bool,
    /// What the chosen poses are best for.
    pub criterion: Criterion,
    /// Where the task of such a criterion is done.
    pub region: Region,
}

impl Default for Request {
    /// What `haptical plan` asks without flags: the device file's rigs, 200 poses, none chosen; D, 2000 candidates,
    /// seed 1.
    fn default() -> Self {
        Self {
            rigs: Vec::new(),
            terms: Terms::Degree(DEGREE),
            limits: Limits::default(),
            candidates: 2000,
            seed: 1,
            poses: 200,
            chooses: false,
            criterion: Criterion::D,
            region: Region::Everywhere,
        }
    }
}

/// A plan.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Number of poses that standard deviations of the rigs are for, poses of average worth.
    pub poses: usize,
    /// Poses that were measured before, which count for the first rig.
    pub measured_poses: usize,
    /// The rigs that were compared.
    pub rigs: Vec<RigIdentifiability>,
    /// The chosen poses, where they were asked for.
    pub next_poses: Option<NextPoses>,
}

/// The parameters that one rig identifies, and measurements that would identify the others.
#[derive(Debug, Clone, Serialize)]
pub struct RigIdentifiability {
    /// The rig, as it was given.
    pub measure: String,
    /// Most readings of a pose.
    pub readings_per_pose: usize,
    /// Parameters that are identified, weak ones included.
    pub rank: usize,
    /// Scales of instruments that the lengths rest on; the standard deviations count them.
    pub length_scales: Vec<ScaleOfLengths>,
    /// Every parameter that a calibration from this rig could free.
    pub parameters: Vec<ParameterStatus>,
    /// For each parameter that it does not identify, measurements that would.
    pub suggestions: Vec<Suggestion>,
}

/// Whether a rig identifies a parameter.
#[derive(Debug, Clone, Serialize)]
pub struct ParameterStatus {
    /// Name.
    pub name: String,
    /// Unit of the plausible size and the standard deviation.
    pub unit: String,
    /// Plausible size of its deviation from nominal.
    pub plausible_size: f64,
    /// The status with the standard deviation (Cramér-Rao, and the scales of instruments); plan.json has the status' name as `status` and
    /// `standard_deviation`, null where there is none.
    #[serde(flatten, serialize_with = "name_and_deviation")]
    pub status: Status,
    /// Why it is not identified.
    pub reason: Option<String>,
}

fn name_and_deviation<S: Serializer>(status: &Status, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Fields {
        status: &'static str,
        standard_deviation: Option<f64>,
    }
    let fields = Fields {
        status: status.name(),
        standard_deviation: status.standard_deviation(),
    };
    fields.serialize(to)
}

/// A step of a plan, for whoever shows that work goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step<'r> {
    /// This rig is judged.
    Rig(&'r str),
    /// Poses are chosen.
    Choosing {
        /// How many.
        poses: usize,
        /// From how many.
        candidates: usize,
    },
}

/// Judges rigs and, if asked, chooses the poses to measure next. `measured` are poses that were measured with the
/// first rig already; `step` is called when a step begins.
///
/// ```
/// use haptical_design::{Request, Rig, plan};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let rigs = vec![Rig::parse("out,cable")?, Rig::parse("out,pose")?];
/// let request = Request { rigs, candidates: 300, poses: 60, chooses: true, ..Request::default() };
/// let plan = plan(&device, &request, &[], &|_| ())?;
///
/// let alpha7 = |rig: usize| {
///     let mut parameters = plan.rigs[rig].parameters.iter();
///     parameters.find(|parameter| parameter.name == "alpha7").map(|parameter| parameter.status.name())
/// };
/// assert_eq!(alpha7(0), Some("invisible"));
/// assert_eq!(alpha7(1), Some("identifiable"));
/// let next = plan.next_poses.unwrap();
/// assert_eq!(next.postures.len(), 60);
/// assert!(next.figures.o1 > next.random.unwrap().o1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError::Setting`] for no poses or candidates; [`DesignError::Measure`] for a rig that this device cannot have, or measured poses of a rig that touches;
/// otherwise as [`postures`], [`crate::task_rows`] and [`crate::select`].
pub fn plan(
    device: &Device,
    request: &Request,
    measured: &[Posture],
    step: &dyn Fn(Step<'_>),
) -> Result<Plan, DesignError> {
    for (setting, value) in [("poses", request.poses), ("candidates", request.candidates)] {
        if value == 0 {
            return Err(DesignError::Setting {
                setting,
                value: 0.0,
                allowed: "1 or more",
            });
        }
    }
    let described = match request.rigs.is_empty() {
        true => described_rigs(device)?,
        false => Vec::new(),
    };
    let mut plan = Plan {
        poses: request.poses,
        measured_poses: measured.len(),
        rigs: Vec::new(),
        next_poses: None,
    };
    for (index, rig) in request.rigs.iter().chain(&described).enumerate() {
        step(Step::Rig(&rig.name));
        let mut equipped = equip(device, rig, request.terms)?;
        let is_planned = index == 0 && request.chooses;
        let count = match is_planned {
            true => request.candidates,
            false => request.candidates.min(TABLE_POSES),
        };
        let candidates = postures(&mut equipped, &request.limits, count, request.seed)?;
        let looked_at = &candidates[..candidates.len().min(TABLE_POSES)];
        let before = if index == 0 { measured } else { &[] };
        if !before.is_empty() && candidates.iter().any(Posture::touches) {
            return Err(DesignError::Measure {
                item: rig.name.clone(),
                message: "a log does not say which touch a pose was at: leave the log out"
                    .to_owned(),
            });
        }
        let information = Information::new(&equipped, looked_at, before)?;
        let judged = information.judge(request.poses)?;
        let further = suggestions(&equipped, request.terms, looked_at, &judged, request.poses)?;
        plan.rigs.push(identifiability_of_rig(
            &equipped,
            &information,
            &judged,
            further,
        )?);
        if is_planned {
            let poses = request.poses;
            step(Step::Choosing {
                poses,
                candidates: count,
            });
            let information = Information::new(&equipped, &candidates, before)?;
            plan.next_poses = Some(NextPoses::choose(request, &information, &candidates)?);
        }
    }
    Ok(plan)
}

/// The rigs that a device file describes: its external encoders and cables, and the same encoders with a tracker
/// of the position and of the pose.
///
/// ```
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let rigs = haptical_design::described_rigs(&device)?;
/// let names: Vec<&str> = rigs.iter().map(|rig| rig.name.as_str()).collect();
/// assert_eq!(names, ["out,cable", "out,position", "out,pose"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError::Measure`] where it describes neither sensors nor links.
pub fn described_rigs(device: &Device) -> Result<Vec<Rig>, DesignError> {
    let mut joints = device.joints.iter();
    let has_encoder = joints.any(|joint| joint.output_sd_rad().is_some());
    let encoders = has_encoder.then(|| "out".to_owned());
    let with = |measures: Vec<String>| {
        let all: Vec<String> = encoders.clone().into_iter().chain(measures).collect();
        Rig::parse(&all.join(","))
    };
    if !device.has_links() {
        return Ok(vec![with(Vec::new())?]);
    }
    let mut rigs = Vec::new();
    if !device.cables.is_empty() {
        rigs.push(with((0..device.cables.len()).map(cable_name).collect())?);
    }
    let touched = touched(device);
    if !touched.is_empty() {
        rigs.push(with(touched)?);
    }
    for tracker in ["position", "pose"] {
        let rig = with(vec![tracker.to_owned()])?;
        rigs.push(match &device.tracker {
            Some(stated) => rig.with_tracker_as(stated),
            None => rig,
        });
    }
    Ok(rigs)
}

/// What the device file, or a rig file, describes of what the handle touches.
fn touched(device: &Device) -> Vec<String> {
    let around = &device.surroundings;
    let mut measures = Vec::new();
    if let Some(pair) = device.contact_pairs.first() {
        let points = around.contacts.len().max(2);
        measures.push(format!("contact:{points}:{}", pair.distance_m));
    } else if around.contact_sd_m.is_some() {
        measures.push(format!("contact:{}", around.contacts.len().max(1)));
    }
    if !around.plane_pairs.is_empty() {
        measures.push("plane:2".to_owned());
    } else if around.plane_sd_m.is_some() {
        measures.push("plane".to_owned());
    }
    measures
}

fn identifiability_of_rig(
    equipped: &Equipped,
    information: &Information,
    judged: &Identifiability,
    suggestions: Vec<Suggestion>,
) -> Result<RigIdentifiability, DesignError> {
    let statuses = information.with_scales(judged)?;
    let parameter = |index: usize| {
        let info = &information.infos[index];
        ParameterStatus {
            name: info.name.clone(),
            unit: info.unit.clone(),
            plausible_size: info.plausible_size,
            status: statuses[index].clone(),
            reason: judged.reason(index),
        }
    };
    Ok(RigIdentifiability {
        measure: equipped.rig.name.clone(),
        length_scales: information.length_scales(),
        readings_per_pose: (0..information.poses())
            .map(|pose| information.readings(Some(pose)))
            .max()
            .unwrap_or(0),
        rank: judged.rank,
        parameters: (0..information.parameters()).map(parameter).collect(),
        suggestions,
    })
}
