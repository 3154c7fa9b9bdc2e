//! What a plan says: rigs beside parameters, suggestions, chosen poses.

use haptical_design::{
    Criterion, DesignError, Equipped, Figures, Information, Posture, Region, Rig, Search,
    Suggestion, driving_order, equip, postures, select, suggestions, task_rows,
};
use haptical_identification::{Identifiability, Status};
use haptical_model::Device;
use serde::Serialize;

use super::arguments::PlanArguments;
use crate::provenance::{Record, VERSION};
use crate::terminal::Progress;

/// Poses that a table looks at, at most: statuses are the same with more.
const TABLE_POSES: usize = 600;

/// plan.json.
#[derive(Debug, Serialize)]
pub(crate) struct Plan {
    pub(crate) device: String,
    /// Number of poses that standard deviations of the rigs are for, poses of average worth.
    pub(crate) poses: usize,
    /// Poses of the log, which count for the first rig.
    pub(crate) measured_poses: usize,
    pub(crate) rigs: Vec<RigEntry>,
    pub(crate) next_poses: Option<NextPoses>,
    pub(crate) warnings: Vec<String>,
    pub(crate) provenance: Record,
}

/// What one rig tells.
#[derive(Debug, Serialize)]
pub(crate) struct RigEntry {
    pub(crate) measure: String,
    pub(crate) readings_per_pose: usize,
    /// Parameters that are identified, weak ones included.
    pub(crate) rank: usize,
    pub(crate) parameters: Vec<ParameterEntry>,
    pub(crate) suggestions: Vec<Suggestion>,
}

/// What a rig tells of a parameter.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ParameterEntry {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) plausible_size: f64,
    /// `identifiable`, `weak`, `combination` or `invisible`.
    pub(crate) status: &'static str,
    pub(crate) standard_deviation: Option<f64>,
    pub(crate) reason: Option<String>,
}

/// The chosen poses.
#[derive(Debug, Serialize)]
pub(crate) struct NextPoses {
    pub(crate) measure: String,
    pub(crate) criterion: Criterion,
    pub(crate) count: usize,
    pub(crate) candidates: usize,
    pub(crate) figures: Figures,
    /// Medians over random choices of as many candidates.
    pub(crate) random: Option<Figures>,
    pub(crate) exchanges: usize,
    pub(crate) parameters: Vec<Predicted>,
}

/// Standard deviation that the chosen poses give a parameter.
#[derive(Debug, Serialize)]
pub(crate) struct Predicted {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) plausible_size: f64,
    pub(crate) standard_deviation: f64,
}

/// Plans; returns the chosen poses in an order to drive through, too.
pub(crate) fn plan(
    arguments: &PlanArguments,
    device: &Device,
    measured: &[Posture],
    progress: &Progress,
) -> Result<(Plan, Option<Vec<Posture>>), DesignError> {
    let rigs = rigs(arguments, device)?;
    let mut plan = Plan {
        device: String::new(),
        poses: arguments.pose_count(),
        measured_poses: measured.len(),
        rigs: Vec::new(),
        next_poses: None,
        warnings: Vec::new(),
        provenance: Record::new(VERSION, "plan", Vec::new(), Vec::new()),
    };
    let mut chosen = None;
    for (index, rig) in rigs.iter().enumerate() {
        progress.say(format!("rig {}", rig.name));
        let mut equipped = equip(device, rig, arguments.terms())?;
        let is_planned = index == 0 && arguments.poses.is_some();
        let all = arguments.candidates.get();
        let count = if is_planned {
            all
        } else {
            all.min(TABLE_POSES)
        };
        let candidates = postures(&mut equipped, &arguments.limits(), count, arguments.seed)?;
        let looked_at = &candidates[..count.min(TABLE_POSES)];
        let before = if index == 0 { measured } else { &[] };
        if !before.is_empty() && candidates.iter().any(touches) {
            return Err(DesignError::Measure {
                item: rig.name.clone(),
                message: "a log does not say which touch a pose was at: leave --log out".to_owned(),
            });
        }
        let information = Information::new(&equipped, looked_at, before)?;
        let judged = information.judge(plan.poses)?;
        let suggested = suggestions(&equipped, arguments.terms(), looked_at, &judged, plan.poses)?;
        plan.rigs
            .push(entry(&equipped, &information, &judged, suggested));
        if is_planned {
            progress.say(format!("choosing {} of {count} poses", plan.poses));
            let information = Information::new(&equipped, &candidates, before)?;
            let (next, poses) = choose(arguments, &information, &candidates)?;
            plan.next_poses = Some(next);
            chosen = Some(poses);
        }
    }
    Ok((plan, chosen))
}

fn touches(posture: &Posture) -> bool {
    !posture.contact.is_empty() || !posture.plane.is_empty()
}

/// The rigs asked for, or what the device file describes beside trackers.
fn rigs(arguments: &PlanArguments, device: &Device) -> Result<Vec<Rig>, DesignError> {
    if !arguments.measure.is_empty() {
        let rigs = arguments.measure.iter().map(|text| Rig::parse(text));
        return rigs.collect();
    }
    let mut own: Vec<String> = Vec::new();
    if device
        .joints
        .iter()
        .any(|joint| joint.output_sd_rad().is_some())
    {
        own.push("out".to_owned());
    }
    if !device.has_links() {
        return Ok(vec![Rig::parse(&own.join(","))?]);
    }
    let encoders = own.clone();
    own.extend((0..device.cables.len()).map(|index| match index {
        0 => "cable".to_owned(),
        _ => format!("cable{}", index + 1),
    }));
    let with = |measure: &str| {
        let parts: Vec<&str> = encoders
            .iter()
            .map(String::as_str)
            .chain([measure])
            .collect();
        Rig::parse(&parts.join(","))
    };
    let mut rigs = vec![with("position")?, with("pose")?];
    if !device.cables.is_empty() {
        rigs.insert(0, Rig::parse(&own.join(","))?);
    }
    Ok(rigs)
}

fn entry(
    equipped: &Equipped,
    information: &Information,
    judged: &Identifiability,
    suggestions: Vec<Suggestion>,
) -> RigEntry {
    let parameter = |index: usize| {
        let info = &information.infos[index];
        let (status, standard_deviation) = match judged.statuses[index] {
            Status::Identifiable { standard_deviation } => {
                ("identifiable", Some(standard_deviation))
            }
            Status::Weak { standard_deviation } => ("weak", Some(standard_deviation)),
            Status::Invisible => ("invisible", None),
            Status::Dependent { .. } => ("combination", None),
        };
        ParameterEntry {
            name: info.name.clone(),
            unit: info.unit.clone(),
            plausible_size: info.plausible_size,
            status,
            standard_deviation,
            reason: judged.reason(index),
        }
    };
    RigEntry {
        measure: equipped.rig.name.clone(),
        readings_per_pose: (0..information.poses())
            .map(|pose| information.readings(Some(pose)))
            .max()
            .unwrap_or(0),
        rank: judged.rank,
        parameters: (0..information.parameters()).map(parameter).collect(),
        suggestions,
    }
}

fn choose(
    arguments: &PlanArguments,
    information: &Information,
    candidates: &[Posture],
) -> Result<(NextPoses, Vec<Posture>), DesignError> {
    let count = arguments.pose_count();
    let judged = information.judge(count)?;
    let criterion = Criterion::from(arguments.criterion);
    let region = arguments.region.clone().unwrap_or(Region::Everywhere);
    let limits = arguments.limits();
    let columns = &judged.independent;
    let task = task_rows(
        criterion,
        information,
        columns,
        (&region, &limits),
        arguments.seed,
    )?;
    let search = Search {
        seed: arguments.seed,
        ..Search::default()
    };
    let selection = select(information, &judged, count, criterion, &task, &search)?;
    let poses: Vec<Posture> = selection
        .chosen
        .iter()
        .map(|&pose| candidates[pose].clone())
        .collect();
    let readings: Vec<Vec<f64>> = poses.iter().map(|pose| pose.readings.clone()).collect();
    let order = driving_order(&readings);
    let parameters = selection.parameters.iter().zip(&selection.deviations);
    let parameters = parameters.map(|(&index, &standard_deviation)| {
        let info = &information.infos[index];
        Predicted {
            name: info.name.clone(),
            unit: info.unit.clone(),
            plausible_size: info.plausible_size,
            standard_deviation,
        }
    });
    let next = NextPoses {
        measure: information.equipped.rig.name.clone(),
        criterion,
        count,
        candidates: candidates.len(),
        figures: selection.figures,
        random: selection.random,
        exchanges: selection.history.len() - 1,
        parameters: parameters.collect(),
    };
    Ok((
        next,
        order.iter().map(|&pose| poses[pose].clone()).collect(),
    ))
}
