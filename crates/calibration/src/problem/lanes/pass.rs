//! One block of rows in lanes: errors, angles and distances, and every channel's columns made of them.

use haptical_batch::{PoseBatch, TileRows};
use haptical_model::ParameterId;

use crate::DeviceProblem;
use crate::problem::lanes::capstan::ErrorValues;
use crate::problem::lanes::columns::{CableColumns, ColumnSource};
use crate::problem::lanes::plan::{
    CablePlan, ChannelPlan, ErrorPart, JointPlan, LaneRows, RowBlock, RowPart, seen_columns,
};

/// Rows of one channel with the derivatives that can differ from zero, as [`Pass::block`] hands them over.
pub(crate) struct PartRows<'r> {
    /// Position of the channel within the problem.
    pub(crate) channel: usize,
    /// First residual of the problem.
    pub(crate) first: usize,
    /// Position within the free parameters of each column.
    pub(crate) columns: &'r [usize],
    /// Which of the derivatives each column is.
    pub(crate) of: &'r [usize],
    /// Derivatives that differ.
    pub(crate) derivatives: &'r [&'r [f64]],
    pub(crate) residuals: &'r [f64],
}

/// Room of a block.
#[derive(Debug, Default)]
pub(crate) struct Room {
    /// A joint's error parameters.
    error: Vec<f64>,
    /// Joint by joint.
    errors: Vec<ErrorValues>,
    /// A joint's variables.
    angles: Vec<f64>,
    /// Channel by channel, a cable's poses.
    poses: Vec<Option<PoseBatch>>,
    /// Columns of derivatives, one after the other.
    columns: Vec<f64>,
    residuals: Vec<f64>,
    /// The vector of the batch's model.
    values: Vec<f64>,
}

impl Room {
    /// Makes room for another block.
    pub(crate) fn forget(&mut self) {
        self.poses.clear();
    }
}

/// What a pass asks of all blocks.
pub(crate) struct Pass<'l> {
    rows: &'l LaneRows,
    problem: &'l DeviceProblem<'l>,
    parameters: &'l [f64],
    free: &'l [usize],
    pub(crate) channels: Vec<ChannelColumns>,
}

/// A channel's columns.
pub(crate) struct ChannelColumns {
    /// Positions within the free parameters.
    pub(crate) positions: Vec<usize>,
    /// Which of the distinct columns each is.
    pub(crate) of: Vec<usize>,
    pub(crate) distinct: usize,
    cable: Option<CableColumns>,
}

impl<'l> Pass<'l> {
    pub(crate) fn new(
        rows: &'l LaneRows,
        problem: &'l DeviceProblem<'l>,
        parameters: &'l [f64],
        free: &'l [usize],
    ) -> Option<Self> {
        let mut channels = Vec::with_capacity(rows.channels.len());
        for (plan, positions) in rows.channels.iter().zip(seen_columns(problem, free)) {
            let mut cable = None;
            if let ChannelPlan::Cable(plan) = plan {
                let chosen = positions.iter().map(|&position| free[position]);
                let made = CableColumns::new(plan, &rows.joints, problem.parameters, chosen);
                cable = Some(made?);
            }
            let own = || (0..positions.len()).collect();
            channels.push(ChannelColumns {
                of: cable.as_ref().map_or_else(own, |cable| cable.of.clone()),
                distinct: cable
                    .as_ref()
                    .map_or(positions.len(), |cable| cable.distinct.len()),
                positions,
                cable,
            });
        }
        Some(Self {
            channels,
            rows,
            problem,
            parameters,
            free,
        })
    }

    /// Works a block out and hands its channels over, one after the other.
    pub(crate) fn block(
        &self,
        block: &RowBlock,
        room: &mut Room,
        mut visit: impl FnMut(&PartRows<'_>) -> Option<()>,
    ) -> Option<()> {
        self.errors(block, room)?;
        let plans = self.rows.channels.iter().zip(&block.parts);
        for (channel, (plan, part)) in plans.enumerate() {
            match plan {
                _ if part.measured.is_empty() => {}
                ChannelPlan::Output { joint } => {
                    self.outputs(channel, *joint, block, part, room, &mut visit)?;
                }
                ChannelPlan::Cable(plan) => {
                    self.distances(channel, plan, block, part, room, &mut visit)?;
                }
            }
        }
        Some(())
    }

    /// Every transmission's error at the block's readings.
    fn errors(&self, block: &RowBlock, room: &mut Room) -> Option<()> {
        room.errors
            .resize_with(block.errors.len(), ErrorValues::default);
        let joints = self.rows.joints.iter().zip(&block.errors);
        for ((plan, error), at) in joints.zip(&mut room.errors) {
            if let ErrorPart::Fitted(law) = error {
                let JointPlan { error, fitted, .. } = plan;
                room.error.clone_from(error);
                for &(place, parameter) in fitted {
                    room.error[place] = self.parameters[parameter];
                }
                law.evaluate(&room.error, !self.free.is_empty(), at)?;
            }
        }
        Some(())
    }

    /// Place within the error of a free parameter of a joint's transmission.
    fn transmission(&self, position: usize) -> Option<(usize, usize)> {
        match self.problem.parameters[self.free[position]] {
            ParameterId::Transmission { joint, index } => Some((joint, index)),
            _ => None,
        }
    }

    fn outputs(
        &self,
        channel: usize,
        joint: usize,
        block: &RowBlock,
        part: &RowPart,
        room: &mut Room,
        visit: &mut impl FnMut(&PartRows<'_>) -> Option<()>,
    ) -> Option<()> {
        let rows = part.measured.len();
        let ChannelColumns {
            positions: columns,
            of,
            ..
        } = &self.channels[channel];
        let Room {
            errors,
            columns: into,
            residuals,
            ..
        } = room;
        let at = &errors[joint];
        let values = values(&block.errors[joint], at);
        let residuals = at_least(residuals, rows);
        for (place, residual) in residuals.iter_mut().enumerate() {
            let row = part.row(place);
            let predicted = block.readings[joint][row] + values[row];
            *residual = part.weights[place] * (predicted - part.measured[place]);
        }
        let into = at_least(into, columns.len() * rows);
        for (into, &position) in into.chunks_exact_mut(rows).zip(columns) {
            let (_, index) = self.transmission(position)?;
            let slopes = &derivatives(&block.errors[joint], at)[index];
            part.multiply(slopes, &part.weights, 0, into);
        }
        let derivatives: Vec<&[f64]> = into.chunks_exact(rows).collect();
        visit(&PartRows {
            channel,
            first: part.first,
            columns,
            of,
            derivatives: &derivatives,
            residuals,
        })
    }

    fn distances(
        &self,
        channel: usize,
        plan: &CablePlan,
        block: &RowBlock,
        part: &RowPart,
        room: &mut Room,
        visit: &mut impl FnMut(&PartRows<'_>) -> Option<()>,
    ) -> Option<()> {
        let Room {
            errors,
            angles,
            poses,
            columns: products,
            values: vector,
            ..
        } = room;
        poses.resize_with(self.rows.channels.len(), || None);
        let variables = |joint: usize, into: &mut Vec<f64>| {
            let (readings, home) = (&block.readings[joint], self.rows.joints[joint].home);
            let values = values(&block.errors[joint], &errors[joint]);
            into.clear();
            into.extend((0..part.measured.len()).map(|place| {
                let row = part.row(place);
                readings[row] + values[row] + home
            }));
        };
        if let Some(poses) = &mut poses[channel] {
            for (joint, error) in block.errors.iter().enumerate() {
                if let ErrorPart::Fitted(_) = error {
                    variables(joint, angles);
                    poses.move_joint(joint, angles).ok()?;
                }
            }
        } else {
            let mut all = vec![Vec::new(); self.rows.joints.len()];
            for (joint, into) in all.iter_mut().enumerate() {
                variables(joint, into);
            }
            let motions = plan.model.motions();
            let made = PoseBatch::new(motions, &all, &part.measured, &part.weights);
            poses[channel] = Some(made.ok()?);
        }
        let poses = poses[channel].as_ref()?;
        vector.clone_from(&plan.values);
        for (value, parameter) in vector.iter_mut().zip(&plan.links) {
            if let Some(parameter) = parameter {
                *value = self.parameters[*parameter];
            }
        }
        let ChannelColumns {
            positions: columns,
            of,
            cable,
            ..
        } = &self.channels[channel];
        let cable = cable.as_ref()?;
        let mut is_sound = Some(());
        let tiles = poses.visit(
            &plan.model,
            vector,
            &cable.entries,
            |tile: &TileRows<'_>| {
                let rows = tile.residuals().len();
                let along: Vec<&[f64]> = tile.derivatives().collect();
                let products = at_least(products, cable.products * rows);
                let mut into = products.chunks_exact_mut(rows);
                for source in &cable.distinct {
                    if let ColumnSource::Product {
                        entry,
                        joint,
                        index,
                    } = *source
                        && let Some(into) = into.next()
                    {
                        let slopes = &derivatives(&block.errors[joint], &errors[joint])[index];
                        part.multiply(slopes, along[entry], tile.first_pose(), into);
                    }
                }
                let mut made = products.chunks_exact(rows);
                let mut derivatives = Vec::with_capacity(cable.distinct.len());
                derivatives.extend(cable.distinct.iter().filter_map(|source| match source {
                    ColumnSource::Entry(entry) => Some(along[*entry]),
                    ColumnSource::Product { .. } => made.next(),
                }));
                let first = part.first + tile.first_pose();
                if is_sound.is_some() {
                    is_sound = visit(&PartRows {
                        channel,
                        first,
                        columns,
                        of,
                        derivatives: &derivatives,
                        residuals: tile.residuals(),
                    });
                }
            },
        );
        tiles.ok()?;
        is_sound
    }
}

impl RowPart {
    /// Row of the block behind an entry.
    fn row(&self, place: usize) -> usize {
        match &self.picked {
            None => place,
            Some(picked) => picked[place],
        }
    }

    /// `slopes`, row by row of the block, times `factors`, from entry `first` on.
    fn multiply(&self, slopes: &[f64], factors: &[f64], first: usize, into: &mut [f64]) {
        let rows = first..first + into.len();
        match &self.picked {
            None => {
                let pairs = slopes[rows].iter().zip(factors);
                for (into, (slope, factor)) in into.iter_mut().zip(pairs) {
                    *into = slope * factor;
                }
            }
            Some(picked) => {
                let pairs = picked[rows].iter().zip(factors);
                for (into, (&row, factor)) in into.iter_mut().zip(pairs) {
                    *into = slopes[row] * factor;
                }
            }
        }
    }
}

/// Room for so many numbers, which grows and never shrinks: what it holds is written over.
fn at_least(room: &mut Vec<f64>, count: usize) -> &mut [f64] {
    if room.len() < count {
        room.resize(count, 0.0);
    }
    &mut room[..count]
}

/// A transmission's errors at a block's readings.
fn values<'v>(error: &'v ErrorPart, at: &'v ErrorValues) -> &'v [f64] {
    match error {
        ErrorPart::Fixed(values) => values,
        ErrorPart::Fitted(_) => &at.values,
    }
}

/// Their derivatives with respect to the error's parameters.
fn derivatives<'v>(error: &'v ErrorPart, at: &'v ErrorValues) -> &'v [Vec<f64>] {
    match error {
        ErrorPart::Fixed(_) => &[],
        ErrorPart::Fitted(law) => law.derivatives(at),
    }
}
