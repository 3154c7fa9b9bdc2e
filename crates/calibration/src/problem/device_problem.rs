//! The least-squares problem of a device and a recording: weighted residuals and derivatives.

use std::collections::BTreeMap;
use std::ops::Range;

use haptical_identification::{IdentificationError, Matrix, Problem};
use haptical_model::{AddedReadings, Device, ModelError, Mount, ParameterId, Recording};

use crate::error::at_row;
use crate::problem::added::added_to;
use crate::problem::lanes::transmission::outputs_in_bulk;
use crate::problem::loads::Loads;
use crate::problem::measurement::tracked::Mountings;
use crate::problem::mounts::mounts;
use crate::problem::propagated::propagated_variances;
use crate::{CalibrationError, Channel, Weights};

/// Residuals (model minus measurement, over standard deviation) of chosen channels as functions of
/// chosen parameters.
#[derive(Debug)]
pub struct DeviceProblem<'a> {
    pub(crate) device: &'a Device,
    pub(crate) recording: &'a Recording,
    pub(crate) parameters: &'a [ParameterId],
    pub(crate) blocks: Vec<Block>,
    residual_count: usize,
    pub(crate) sees_chain: bool,
    /// Output angles, row by row, where no transmission parameter can change them: a fit of the chain
    /// alone then evaluates each transmission once, not at every step.
    pub(crate) outputs: Option<Vec<f64>>,
    /// Torques that compliant joints yield to.
    pub(crate) loads: Option<Loads>,
    /// Where the tracker stood and what was on the hand, row by row; empty where that is the same for all.
    mounts: Vec<Mount>,
}

/// Rows of which output angles that stay are kept: of more, each pass works them out again.
const MOST_KEPT: usize = 100_000;

/// The residuals of one channel: consecutive, in row order.
#[derive(Debug)]
pub(crate) struct Block {
    pub(crate) channel: Channel,
    /// Rows with a reading.
    pub(crate) rows: Vec<usize>,
    /// One over the standard deviation, per entry of `rows`.
    pub(crate) weights: Vec<f64>,
    /// Which touched point or plane each entry of `rows` is about; empty for other kinds.
    pub(crate) subjects: Vec<usize>,
    /// First residual.
    pub(crate) first: usize,
    /// What effects add to its readings, per entry of `rows`.
    pub(crate) added: Vec<AddedReadings>,
}

impl Block {
    /// Residual after the last.
    pub(crate) fn end(&self) -> usize {
        self.first + self.rows.len() * self.channel.width()
    }
}

impl<'a> DeviceProblem<'a> {
    /// A problem over `parameters` of `device`; its parameter vector holds their absolute values.
    ///
    /// # Errors
    /// [`CalibrationError::Row`] where the device has no value at a row.
    pub fn new(
        device: &'a Device,
        recording: &'a Recording,
        channels: &[Channel],
        parameters: &'a [ParameterId],
        weights: &Weights,
    ) -> Result<Self, CalibrationError> {
        let loads = Loads::new(device, recording)?;
        let deviations = |channel| {
            let variances = propagated_variances(device, recording, channel, loads.as_ref())?;
            Ok(weights.with_variances(recording, channel, variances))
        };
        let blocks = blocks(device, recording, channels, deviations)?;
        Self::of_blocks(device, recording, (blocks, parameters), loads)
    }

    /// A channel without parameters whose residuals are in its own unit; `loads` are those of the recording.
    pub(crate) fn unweighted(
        device: &'a Device,
        recording: &'a Recording,
        channel: Channel,
        loads: Option<Loads>,
    ) -> Result<Self, CalibrationError> {
        let ones = |_| Ok(vec![1.0; recording.len()]);
        let blocks = blocks(device, recording, &[channel], ones)?;
        Self::of_blocks(device, recording, (blocks, &[]), loads)
    }

    fn of_blocks(
        device: &'a Device,
        recording: &'a Recording,
        (blocks, parameters): (Vec<Block>, &'a [ParameterId]),
        loads: Option<Loads>,
    ) -> Result<Self, CalibrationError> {
        let sees_chain = blocks.iter().any(|block| block.channel.sees_chain());
        let outputs = fixed_outputs(device, recording, parameters, sees_chain)?;
        let channels: Vec<Channel> = blocks.iter().map(|block| block.channel).collect();
        Ok(Self {
            device,
            recording,
            parameters,
            residual_count: blocks.last().map_or(0, Block::end),
            blocks,
            sees_chain,
            outputs,
            loads,
            mounts: mounts(device, recording, &channels)?,
        })
    }

    /// The same for one channel whose readings all weigh the same, for the forms in lanes, without a look
    /// at every row by itself. None where it is another case, or where a number is refused: then
    /// [`DeviceProblem::new`] says which.
    pub(crate) fn in_bulk(
        device: &'a Device,
        recording: &'a Recording,
        channels: &[Channel],
        parameters: &'a [ParameterId],
        weights: &Weights,
    ) -> Option<Self> {
        let &[channel] = channels else {
            return None;
        };
        if !recording.added.is_empty() {
            return None;
        }
        let weight = 1.0 / weights.common_sd(device, channel)?;
        let mut blocks = Vec::with_capacity(1);
        add_block(&mut blocks, recording, channel, |_| weight);
        let sees_chain = channel.sees_chain();
        let outputs = if sees_chain {
            Some(outputs_in_bulk(device, recording, parameters)?)
        } else {
            None
        };
        Some(Self {
            device,
            recording,
            parameters,
            residual_count: blocks.last().map_or(0, Block::end),
            blocks,
            sees_chain,
            outputs,
            loads: None,
            mounts: mounts(device, recording, channels).ok()?,
        })
    }

    /// Lets every reading weigh as much as those of `all` that it stands for, where this problem is of some of its rows:
    /// to a search, and to what the readings fix, it is then the same but for chance. False where a channel has none of
    /// its readings.
    pub(crate) fn weigh_as(&mut self, all: &DeviceProblem<'_>) -> bool {
        for (own, all) in self.blocks.iter_mut().zip(&all.blocks) {
            if own.rows.is_empty() {
                return false;
            }
            let factor = (all.rows.len() as f64 / own.rows.len() as f64).sqrt();
            own.weights.iter_mut().for_each(|weight| *weight *= factor);
        }
        true
    }

    /// The values that the device itself has.
    pub fn start(&self) -> Vec<f64> {
        values_of(self.parameters, self.device)
    }

    /// The device with a parameter vector in place.
    pub fn device_with(&self, values: &[f64]) -> Device {
        let mut device = self.device.clone();
        for (parameter, value) in self.parameters.iter().zip(values) {
            parameter.set(&mut device, *value);
        }
        device
    }

    /// The problem in parts of the same parameters, with the channels of each: every external encoder by itself, which only
    /// its own joint's transmission changes, and all other channels together.
    pub fn apart(self) -> Vec<(Vec<Channel>, Self)> {
        let is_encoder = |block: &Block| matches!(block.channel, Channel::Output { .. });
        let (encoders, others): (Vec<Block>, Vec<Block>) =
            self.blocks.into_iter().partition(is_encoder);
        let alone = encoders.into_iter().map(|block| Self {
            device: self.device,
            recording: self.recording,
            parameters: self.parameters,
            residual_count: block.end() - block.first,
            blocks: vec![Block { first: 0, ..block }],
            sees_chain: false,
            outputs: None,
            loads: None,
            mounts: Vec::new(),
        });
        let mut parts: Vec<Self> = alone.collect();
        if !others.is_empty() {
            let mut blocks = others;
            let mut first = 0;
            for block in &mut blocks {
                let count = block.end() - block.first;
                block.first = first;
                first += count;
            }
            parts.push(Self {
                device: self.device,
                recording: self.recording,
                parameters: self.parameters,
                residual_count: first,
                blocks,
                sees_chain: self.sees_chain,
                outputs: self.outputs,
                loads: self.loads,
                mounts: self.mounts,
            });
        }
        let named = parts.into_iter();
        named
            .map(|part| (part.channels().collect(), part))
            .collect()
    }

    /// Positions of the parameters that some channel can depend on, ascending.
    pub fn seen(&self) -> Vec<usize> {
        let can = |&index: &usize| {
            let parameter = self.parameters[index];
            self.channels().any(|channel| channel.can_see(parameter))
        };
        (0..self.parameters.len()).filter(can).collect()
    }

    pub(crate) fn channels(&self) -> impl Iterator<Item = Channel> {
        self.blocks.iter().map(|block| block.channel)
    }

    /// What a row is about.
    pub(crate) fn mount(&self, row: usize) -> Mount {
        self.mounts.get(row).copied().unwrap_or_default()
    }

    /// Bases and tools that some rows are about.
    pub(crate) fn mountings(&self, device: &Device, rows: &Range<usize>) -> Mountings {
        Mountings::new(device, self.mounts.get(rows.clone()).unwrap_or(&[]))
    }

    /// Whether rows differ in where the tracker stood or in what was on the hand.
    pub(crate) fn has_mounts(&self) -> bool {
        !self.mounts.is_empty()
    }

    pub(crate) fn device(&self) -> &Device {
        self.device
    }

    pub(crate) fn parameters(&self) -> &[ParameterId] {
        self.parameters
    }

    /// Where each channel's residuals are: channel, first residual, count.
    pub fn layout(&self) -> BTreeMap<Channel, (usize, usize)> {
        self.blocks
            .iter()
            .map(|block| {
                (
                    block.channel,
                    (block.first, block.rows.len() * block.channel.width()),
                )
            })
            .collect()
    }
}

impl Problem for DeviceProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.parameters.len()
    }

    fn residual_count(&self) -> usize {
        self.residual_count
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        self.run(parameters, residuals, jacobian)
    }
}

/// The values that a device has of some parameters.
pub(crate) fn values_of(parameters: &[ParameterId], device: &Device) -> Vec<f64> {
    parameters
        .iter()
        .map(|parameter| parameter.value(device))
        .collect()
}

/// Adds a channel's rows after the blocks that are there.
fn add_block(
    blocks: &mut Vec<Block>,
    recording: &Recording,
    channel: Channel,
    weight: impl Fn(usize) -> f64,
) {
    let rows: Vec<usize> = (0..recording.len())
        .filter(|&row| channel.has_reading(recording, row))
        .collect();
    blocks.push(Block {
        channel,
        weights: rows.iter().map(|&row| weight(row)).collect(),
        added: added_to(recording, channel, &rows),
        rows,
        subjects: Vec::new(),
        first: blocks.last().map_or(0, Block::end),
    });
}

/// The rows of each channel, with the deviations of their residuals.
fn blocks(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    deviations: impl Fn(Channel) -> Result<Vec<f64>, CalibrationError>,
) -> Result<Vec<Block>, CalibrationError> {
    let mut blocks = Vec::with_capacity(channels.len());
    for &channel in channels {
        let deviations = deviations(channel)?;
        add_block(&mut blocks, recording, channel, |row| 1.0 / deviations[row]);
        if let Some(block) = blocks.last_mut() {
            block.subjects = subjects(device, recording, block)?;
        }
    }
    Ok(blocks)
}

/// Which of the device's touched points or planes each row of a block is about.
fn subjects(
    device: &Device,
    recording: &Recording,
    block: &Block,
) -> Result<Vec<usize>, CalibrationError> {
    let mut subjects = Vec::new();
    for &row in &block.rows {
        match block.channel.subject(device, recording, row) {
            None => break,
            Some(Ok(subject)) => subjects.push(subject),
            Some(Err(id)) => {
                return Err(CalibrationError::UnknownTouch {
                    line: recording.line.get(row).copied().unwrap_or(0),
                    column: block.channel.name(),
                    id,
                });
            }
        }
    }
    Ok(subjects)
}

/// Every row's output angles, unless a parameter can change them or nothing asks for the chain.
fn fixed_outputs(
    device: &Device,
    recording: &Recording,
    parameters: &[ParameterId],
    sees_chain: bool,
) -> Result<Option<Vec<f64>>, CalibrationError> {
    let is_transmission =
        |parameter: &ParameterId| matches!(parameter, ParameterId::Transmission { .. });
    let is_long = recording.len() > MOST_KEPT;
    if !sees_chain || is_long || parameters.iter().any(is_transmission) {
        return Ok(None);
    }
    if let Some(outputs) = outputs_in_bulk(device, recording, parameters) {
        return Ok(Some(outputs));
    }
    // refused: row by row, to report which one
    let mut outputs = Vec::with_capacity(recording.len() * device.joints.len());
    for row in 0..recording.len() {
        for (index, (joint, column)) in device.joints.iter().zip(&recording.joint).enumerate() {
            let error = joint
                .error_rad(column[row])
                .map_err(|source| ModelError::Transmission {
                    joint: index + 1,
                    source,
                })
                .map_err(at_row(recording, row))?;
            outputs.push(column[row] + error);
        }
    }
    Ok(Some(outputs))
}
