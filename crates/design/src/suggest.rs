//! Further measurements that would identify the parameters that a rig does not.

use haptical_calibration::Channel;
use haptical_identification::{Identifiability, Status};
use haptical_model::Evaluation;
use haptical_model::kinematics::nalgebra::Vector3;
use serde::Serialize;

use crate::kind::cable_name;
use crate::{DesignError, Equipped, Information, Measure, Posture, Terms, Tracking, equip};

/// A further measurement that identifies a parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remedy {
    /// The measurement, as `--measure` takes it.
    pub measure: String,
    /// The measurement of the rig in whose place it is; none where it is one more.
    pub instead_of: Option<String>,
    /// Standard deviation that the parameter would have, the scales of instruments counted.
    pub standard_deviation: f64,
}

/// A parameter that a rig does not identify, and what would.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestion {
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the parameter and its standard deviations.
    pub unit: String,
    /// Why it is not identified.
    pub reason: String,
    /// Names of the parameters that it acts like together; empty where it is weak or invisible.
    pub not_told_from: Vec<String>,
    /// Further measurements that identify it, best first; empty where none of those tried does.
    pub remedies: Vec<Remedy>,
}

/// Poses that a trial looks at: enough for every statement on rank.
const TRIAL_POSES: usize = 300;
/// Where further cables are tried, in half sizes of the workspace about its middle: to its sides and above.
const PLACES: [[f64; 3]; 10] = [
    [1.5, 0.0, 0.0],
    [-1.5, 0.0, 0.0],
    [0.0, 1.5, 0.0],
    [0.0, -1.5, 0.0],
    [0.0, 0.0, 1.5],
    [0.0, 0.0, -1.5],
    [1.5, 1.5, 1.5],
    [1.5, -1.5, -1.5],
    [-1.5, 1.5, -1.5],
    [-1.5, -1.5, 1.5],
];

/// Half of the room that a workspace has at least: of touches of one point there is none, and a cable's exit must
/// not be where the handle is \[m\].
const LEAST_ROOM_M: f64 = 0.3;

/// What may be added to a rig, or take the place of a tracker of it.
struct Further {
    name: String,
    measure: Measure,
    instead_of: Option<Tracking>,
}

/// One trial: what is added, and what is known then.
struct Trial {
    further: Further,
    judged: Identifiability,
    /// Parameters of the rig that are identified with it, and the sum of ln(sd / plausible size) over them.
    identified: usize,
    log_sum: f64,
}

/// Tries measurements in addition to a rig, for `count` poses: a cable at ten places around the workspace, of which
/// the best is kept, an external encoder or a homing fixture on each joint without one, the handle's position, its
/// pose; and instead of a tracker one that sees the orientation too, or whose base or tool is known. `postures` are
/// candidates of the rig.
///
/// # Errors
/// As [`Information::new`].
pub fn suggestions(
    equipped: &Equipped,
    terms: Terms,
    postures: &[Posture],
    judged: &Identifiability,
    count: usize,
) -> Result<Vec<Suggestion>, DesignError> {
    let open: Vec<usize> = (0..judged.names.len())
        .filter(|&index| judged.reason(index).is_some())
        .collect();
    if open.is_empty() || !equipped.sees_chain() {
        return Ok(Vec::new());
    }
    let postures = &postures[..postures.len().min(TRIAL_POSES)];
    let further = further(equipped, postures)?;
    let trials = haptical_parallel::map(further, |further| {
        trial(equipped, terms, postures, judged, count, further)
    });
    let mut trials: Vec<Trial> = trials.into_iter().collect::<Result<_, _>>()?;
    // of the places of a further cable only the best is reported
    let is_cable = |trial: &Trial| matches!(trial.further.measure, Measure::Cable { .. });
    let cables = trials.iter().filter(|trial| is_cable(trial));
    let best = cables.reduce(|best, other| {
        let better = (other.identified, -other.log_sum) > (best.identified, -best.log_sum);
        if better { other } else { best }
    });
    let best = best.map(|trial| trial.further.name.clone());
    trials.retain(|trial| !is_cable(trial) || Some(&trial.further.name) == best.as_ref());
    let suggestion = |&index: &usize| {
        let name = &judged.names[index];
        let mut remedies: Vec<Remedy> = trials
            .iter()
            .filter_map(|trial| {
                let place = trial.judged.names.iter().position(|other| other == name)?;
                match trial.judged.statuses[place] {
                    Status::Identifiable { standard_deviation } => Some(Remedy {
                        measure: trial.further.name.clone(),
                        instead_of: trial.further.instead_of.map(Tracking::name),
                        standard_deviation,
                    }),
                    _ => None,
                }
            })
            .collect();
        remedies.sort_by(|a, b| a.standard_deviation.total_cmp(&b.standard_deviation));
        Suggestion {
            parameter: name.clone(),
            unit: equipped.parameters[index].unit(&equipped.device).to_owned(),
            reason: judged.reason(index).unwrap_or_default(),
            not_told_from: match &judged.statuses[index] {
                Status::Dependent { combination } => {
                    combination.iter().map(|term| term.name.clone()).collect()
                }
                _ => Vec::new(),
            },
            remedies,
        }
    };
    Ok(open.iter().map(suggestion).collect())
}

fn trial(
    equipped: &Equipped,
    terms: Terms,
    postures: &[Posture],
    judged: &Identifiability,
    count: usize,
    further: Further,
) -> Result<Trial, DesignError> {
    let mut rig = equipped.rig.with(&further.name, further.measure.clone());
    if let Some(old) = further.instead_of {
        let old = Measure::Tracker(old);
        rig.measures.retain(|measure| *measure != old);
    }
    let more = equip(&equipped.device, &rig, terms)?;
    let information = Information::new(&more, postures, &[])?;
    let found = information.judge(count)?;
    let (mut identified, mut log_sum) = (0, 0.0);
    for name in &judged.names {
        let place = found.names.iter().position(|other| other == name);
        if let Some(place) = place
            && let Status::Identifiable { standard_deviation } = found.statuses[place]
        {
            identified += 1;
            log_sum += (standard_deviation / information.infos[place].plausible_size).ln();
        }
    }
    let statuses = information.with_scales(&found)?;
    Ok(Trial {
        further,
        judged: Identifiability { statuses, ..found },
        identified,
        log_sum,
    })
}

/// What may be tried.
fn further(equipped: &Equipped, postures: &[Posture]) -> Result<Vec<Further>, DesignError> {
    let mut further = Vec::new();
    for own in &equipped.rig.measures {
        if let Measure::Tracker(own) = *own {
            further.extend(own.better().map(|better| Further {
                name: better.name(),
                measure: Measure::Tracker(better),
                instead_of: Some(own),
            }));
        }
    }
    let mut add = |name: String, measure: Measure| {
        further.push(Further {
            name,
            measure,
            instead_of: None,
        });
    };
    let has = |channel: Channel| equipped.channels.contains(&channel);
    let cables = equipped
        .channels
        .iter()
        .filter_map(|channel| match channel {
            Channel::Cable { index } => Some(index + 1),
            _ => None,
        });
    let index = cables.max().unwrap_or(0);
    let [middle, half] = workspace_m(equipped, postures)?;
    for place in PLACES {
        let anchor_m: [f64; 3] = (middle + half.component_mul(&Vector3::from(place))).into();
        // to the centimetre: a lab does not place it better
        let anchor_m = anchor_m.map(|value| (value * 100.0).round() / 100.0);
        let [x, y, z] = anchor_m;
        let name = cable_name(index);
        let measure = Measure::Cable {
            index,
            anchor_m: Some(anchor_m),
            unknown: false,
        };
        add(format!("{name}:{x},{y},{z}"), measure);
    }
    for joint in 0..equipped.device.joints.len() {
        if !has(Channel::Output { joint }) {
            add(format!("out{}", joint + 1), Measure::Output { joint });
        }
    }
    for joint in 0..equipped.device.joints.len() {
        if !has(Channel::Fixture { joint }) {
            let measure = Measure::Fixture { joint: Some(joint) };
            add(format!("fixture{}", joint + 1), measure);
        }
    }
    if !has(Channel::Position) && !has(Channel::Orientation) {
        for orientation in [false, true] {
            let tracking = Tracking {
                orientation,
                base_known: true,
                tool_known: true,
            };
            add(tracking.name(), Measure::Tracker(tracking));
        }
    }
    Ok(further)
}

/// Middle and half sizes of the box around the handle's positions \[m\].
fn workspace_m(
    equipped: &Equipped,
    postures: &[Posture],
) -> Result<[Vector3<f64>; 2], DesignError> {
    let mut evaluation = Evaluation::new(&equipped.device);
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for (index, posture) in postures.iter().enumerate() {
        let moved = evaluation.move_pose_to(&posture.readings);
        let pose = moved.and_then(|()| evaluation.pose().copied());
        let pose = pose.map_err(DesignError::of_pose(index))?;
        low = low.inf(&pose.position_m);
        high = high.sup(&pose.position_m);
    }
    // an arm that moves in a plane still has room at its side
    let least = (0.2 * (high - low).max()).max(LEAST_ROOM_M);
    Ok([
        (high + low) / 2.0,
        ((high - low) / 2.0).sup(&Vector3::repeat(least)),
    ])
}
