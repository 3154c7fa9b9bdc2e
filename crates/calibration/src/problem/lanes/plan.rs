//! The rows of all channels in lanes: transmissions by their laws at many readings, distances by the batch.

use haptical_batch::DistanceModel;
use haptical_model::kinematics::Parameter;
use haptical_model::{Device, JointType, ParameterId, TransmissionError};

use crate::problem::lanes::cable::cable_model;
use crate::problem::lanes::transmission::{ErrorRows, errors_in_bulk};
use crate::{Channel, DeviceProblem};

/// Rows of the recording that are worked out together: twelve tiles of the batch. 6000 rows make two blocks, and
/// a merger costs a fiftieth of a block.
const BLOCK_ROWS: usize = 3072;
/// Most blocks that are kept from pass to pass, with the sines of their readings: of 120 000 rows, some 100 MB. Of more
/// rows a pass makes each block anew, which takes a tenth of its time.
const MOST_KEPT: usize = 40;

/// External encoders and distances of a recording, ready for many parameter vectors.
///
/// With e_i(p) the error of transmission i, theta_i its readings and q_i = theta_i + e_i + home the variable
/// that moves row i of the chain, the derivatives of a distance delta with respect to a transmission's
/// parameters are d delta / d p_ik = (d delta / d q_i) (d e_i / d p_ik), and d delta / d q_i is the derivative
/// with respect to the row's own joint offset, as the two are added (docs/equations.md, "Joint problem").
#[derive(Debug)]
pub(crate) struct LaneRows {
    pub(crate) joints: Vec<JointPlan>,
    pub(crate) channels: Vec<ChannelPlan>,
    /// First row of each block.
    pub(crate) starts: Vec<usize>,
    /// The blocks, made once; empty where they are too many to be kept.
    pub(crate) blocks: Vec<RowBlock>,
}

/// A joint's transmission.
#[derive(Debug)]
pub(crate) struct JointPlan {
    pub(crate) home: f64,
    /// All parameters of the error, as the device has them.
    pub(crate) error: Vec<f64>,
    /// Place within the error of the parameter that is added whatever the reading: c of equation (1), the
    /// coefficient of T_0.
    pub(crate) constant: Option<usize>,
    /// Place within the error, and parameter of the problem.
    pub(crate) fitted: Vec<(usize, usize)>,
}

/// What a channel measures.
#[derive(Debug)]
pub(crate) enum ChannelPlan {
    Output { joint: usize },
    Cable(Box<CablePlan>),
}

/// The chain behind a cable.
#[derive(Debug)]
pub(crate) struct CablePlan {
    pub(crate) model: DistanceModel,
    /// The model's vector, as the device has it.
    pub(crate) values: Vec<f64>,
    /// The problem's parameter behind each entry of that vector; none behind those that are there for a joint.
    pub(crate) links: Vec<Option<usize>>,
    /// Entry that moves with each joint; none where nothing of its transmission is fitted.
    pub(crate) variables: Vec<Option<usize>>,
}

/// Some rows of the recording.
#[derive(Debug)]
pub(crate) struct RowBlock {
    /// Joint by joint.
    pub(crate) readings: Vec<Vec<f64>>,
    pub(crate) errors: Vec<ErrorPart>,
    /// Channel by channel.
    pub(crate) parts: Vec<RowPart>,
}

/// A joint's transmission error at a block's readings.
#[derive(Debug)]
pub(crate) enum ErrorPart {
    /// No parameter of the problem changes it.
    Fixed(Vec<f64>),
    Fitted(ErrorRows),
}

/// A channel's rows within a block.
#[derive(Debug)]
pub(crate) struct RowPart {
    /// Rows of the block with a reading; none where all have one.
    pub(crate) picked: Option<Vec<usize>>,
    pub(crate) measured: Vec<f64>,
    pub(crate) weights: Vec<f64>,
    /// First residual of the problem.
    pub(crate) first: usize,
}

impl LaneRows {
    /// None where the problem has a channel, a chain or a fitted transmission of another kind, several tools or tracker
    /// places, or a number that is refused: then the general form serves, and says what is wrong with which line.
    pub(crate) fn new(problem: &DeviceProblem<'_>) -> Option<Self> {
        let (device, recording) = (problem.device, problem.recording);
        let is_known = |id: &ParameterId| {
            matches!(
                id,
                ParameterId::Link { .. } | ParameterId::Transmission { .. }
            )
        };
        let is_plain = !problem.sees_chain || (device.is_plain_table() && problem.loads.is_none());
        if !is_plain
            || problem.has_mounts()
            || !recording.added.is_empty()
            || !problem.parameters.iter().all(is_known)
            || recording.joint.len() != device.joints.len()
        {
            return None;
        }
        let joints: Vec<JointPlan> = (0..device.joints.len())
            .map(|joint| joint_plan(device, problem.parameters, joint))
            .collect::<Option<_>>()?;
        let channels = problem
            .channels()
            .map(|channel| channel_plan(device, problem.parameters, &joints, channel))
            .collect::<Option<Vec<_>>>()?;
        let starts: Vec<usize> = (0..recording.len()).step_by(BLOCK_ROWS).collect();
        let kept = starts.iter().filter(|_| starts.len() <= MOST_KEPT);
        let blocks = kept.map(|&start| row_block(problem, &joints, start));
        Some(Self {
            blocks: blocks.collect::<Option<_>>()?,
            starts,
            joints,
            channels,
        })
    }

    /// A block that is not kept, by its first row.
    pub(crate) fn block(&self, problem: &DeviceProblem<'_>, start: usize) -> Option<RowBlock> {
        row_block(problem, &self.joints, start)
    }
}

fn joint_plan(device: &Device, parameters: &[ParameterId], joint: usize) -> Option<JointPlan> {
    let described = device.joints.get(joint)?;
    let count = described.error_parameter_count();
    let mut fitted = Vec::new();
    for (parameter, id) in parameters.iter().enumerate() {
        if let ParameterId::Transmission { joint: own, index } = *id
            && own == joint
        {
            fitted.push((index, parameter));
        }
    }
    let error = (0..count).map(|index| ParameterId::Transmission { joint, index }.value(device));
    fitted
        .iter()
        .all(|&(index, _)| index < count)
        .then(|| JointPlan {
            home: described.home_rad,
            constant: match described.transmission_error {
                TransmissionError::Capstan(_) | TransmissionError::Chebyshev { .. } => Some(0),
                TransmissionError::Parallelogram { .. } => None,
            },
            error: error.collect(),
            fitted,
        })
}

fn channel_plan(
    device: &Device,
    parameters: &[ParameterId],
    joints: &[JointPlan],
    channel: Channel,
) -> Option<ChannelPlan> {
    let index = match channel {
        Channel::Output { joint } => return Some(ChannelPlan::Output { joint }),
        Channel::Cable { index } => index,
        _ => return None,
    };
    let (mut chosen, mut links) = (Vec::new(), Vec::new());
    for (parameter, id) in parameters.iter().enumerate() {
        if let ParameterId::Link { row, parameter: of } = *id {
            chosen.push((row, of));
            links.push(Some(parameter));
        }
    }
    let mut variables = Vec::with_capacity(joints.len());
    for (joint, plan) in joints.iter().enumerate() {
        if plan.fitted.is_empty() {
            variables.push(None);
            continue;
        }
        let moved = match device.joints[joint].joint_type {
            JointType::Revolute => Parameter::Theta,
            JointType::Prismatic => Parameter::D,
        };
        let wanted = (joint + 1, moved);
        let known = chosen.iter().position(|each| *each == wanted);
        variables.push(Some(known.unwrap_or(chosen.len())));
        if known.is_none() {
            chosen.push(wanted);
            links.push(None);
        }
    }
    let model = cable_model(device, index, &chosen)?;
    Some(ChannelPlan::Cable(Box::new(CablePlan {
        values: model.start(),
        model,
        links,
        variables,
    })))
}

/// The rows from `start` on.
fn row_block(problem: &DeviceProblem<'_>, joints: &[JointPlan], start: usize) -> Option<RowBlock> {
    let recording = problem.recording;
    let rows = start..(start + BLOCK_ROWS).min(recording.len());
    let mut readings = Vec::with_capacity(joints.len());
    let mut errors = Vec::with_capacity(joints.len());
    let described = problem.device.joints.iter().zip(&recording.joint);
    for ((index, plan), (joint, column)) in joints.iter().enumerate().zip(described) {
        let is_measured = |channel| channel == Channel::Output { joint: index };
        if !problem.sees_chain && !problem.channels().any(is_measured) {
            readings.push(Vec::new());
            errors.push(ErrorPart::Fixed(Vec::new()));
            continue;
        }
        let own = column.get(rows.clone())?.to_vec();
        if !own.iter().all(|reading| reading.is_finite()) {
            return None;
        }
        errors.push(if plan.fitted.is_empty() {
            ErrorPart::Fixed(errors_in_bulk(problem.device, index, &own)?)
        } else {
            ErrorPart::Fitted(ErrorRows::new(joint, &own)?)
        });
        readings.push(own);
    }
    let mut parts = Vec::with_capacity(problem.blocks.len());
    for block in &problem.blocks {
        let column = match block.channel {
            Channel::Output { joint } => recording.output.get(joint)?.as_ref()?,
            Channel::Cable { index } => recording.cable_m.get(index)?.as_ref()?,
            _ => return None,
        };
        let place = |row: usize| block.rows.partition_point(|&other| other < row);
        let (first, end) = (place(rows.start), place(rows.end));
        let own = &block.rows[first..end];
        parts.push(RowPart {
            picked: (own.len() < rows.len())
                .then(|| own.iter().map(|row| row - rows.start).collect()),
            measured: own.iter().map(|&row| column[row]).collect(),
            weights: block.weights[first..end].to_vec(),
            first: block.first + first,
        });
    }
    Some(RowBlock {
        readings,
        errors,
        parts,
    })
}

/// Columns of every channel for the parameters `free`: positions within these.
pub(crate) fn seen_columns(problem: &DeviceProblem<'_>, free: &[usize]) -> Vec<Vec<usize>> {
    let parameters = problem.parameters;
    let seen = |channel: Channel| {
        let sees = |&position: &usize| channel.can_see(parameters[free[position]]);
        let mut columns = Vec::with_capacity(free.len());
        columns.extend((0..free.len()).filter(sees));
        columns
    };
    problem.channels().map(seen).collect()
}
