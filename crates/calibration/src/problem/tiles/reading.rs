//! Readings of a tile, one by one: residuals, and the derivatives that no twist of the handle gives.

use haptical_batch::{POSTURES, TwistLanes};
use haptical_identification::Matrix;
use haptical_model::kinematics::Twist;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation, ParameterId};

use crate::problem::channel::with_kind;
use crate::problem::device_problem::Block;
use crate::problem::measurement::kind::{Measurement, Posture, is_of_handle};
use crate::problem::measurement::tracked::Mountings;
use crate::{Channel, DeviceProblem};

/// A channel's readings within a tile.
pub(super) struct Part {
    pub(super) channel: Channel,
    pub(super) width: usize,
    /// Postures of the tile with a reading.
    pub(super) postures: Vec<usize>,
    pub(super) weights: Vec<f64>,
    /// First residual of each of them.
    pub(super) places: Vec<usize>,
    /// First residual of the run, and which reading within the block that is.
    first: usize,
    begin: usize,
    /// Next reading within the block.
    cursor: usize,
    /// Derivatives of each residual along the handle's twist, and along that of the base; none for what the chain
    /// does not move.
    pub(super) along: Option<Box<[[TwistLanes; 3]; 2]>>,
}

/// Free parameters with their columns, whose derivatives are worked out reading by reading.
pub(super) struct Besides {
    all: Vec<(usize, ParameterId)>,
    /// Those that do not move the handle.
    surroundings: Vec<(usize, ParameterId)>,
    /// Whether one of them moves the robot's base.
    has_base: bool,
}

impl Besides {
    pub(super) fn new(free: impl Iterator<Item = ParameterId>) -> Self {
        let all: Vec<(usize, ParameterId)> = free.enumerate().collect();
        let is_around = |(_, parameter): &&(usize, ParameterId)| {
            matches!(parameter, ParameterId::Surrounding(_))
        };
        let is_of_base = |(_, parameter): &(usize, ParameterId)| {
            matches!(parameter, ParameterId::Link { row: 0, .. })
        };
        Self {
            surroundings: all.iter().filter(is_around).copied().collect(),
            has_base: all.iter().any(is_of_base),
            all,
        }
    }
}

impl Part {
    /// Makes room for the next tile.
    pub(super) fn clear(&mut self) {
        self.postures.clear();
        self.weights.clear();
        self.places.clear();
    }
}

impl DeviceProblem<'_> {
    /// The channels before a run's first row; `firsts` is where their residuals begin.
    pub(super) fn parts(&self, start: usize, firsts: &[usize], derivatives: bool) -> Vec<Part> {
        let blocks = self.blocks.iter().zip(firsts);
        let part = |(block, &first): (&Block, &usize)| {
            let is_of_handle = with_kind!(block.channel, kind => is_of_handle(&kind));
            let begin = block.rows.partition_point(|&row| row < start);
            Part {
                channel: block.channel,
                width: block.channel.width(),
                postures: Vec::with_capacity(POSTURES),
                weights: Vec::with_capacity(POSTURES),
                places: Vec::with_capacity(POSTURES),
                first,
                begin,
                cursor: begin,
                along: (is_of_handle && derivatives)
                    .then(|| Box::new([[TwistLanes::default(); 3]; 2])),
            }
        };
        blocks.map(part).collect()
    }

    /// All channels' readings at one row: residuals, and the derivatives that no twist of the handle gives.
    pub(super) fn readings(
        &self,
        (row, posture): (usize, usize),
        (device, mountings, besides): (&Device, &Mountings, &Besides),
        evaluation: &mut Evaluation<'_>,
        parts: &mut [Part],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        for (block, part) in self.blocks.iter().zip(parts) {
            // rows of another hand lie between
            while block
                .rows
                .get(part.cursor)
                .is_some_and(|&other| other < row)
            {
                part.cursor += 1;
            }
            if block.rows.get(part.cursor) != Some(&row) {
                continue;
            }
            if let (Channel::Fixture { joint }, Some(_), None) =
                (block.channel, &jacobian, &self.outputs)
            {
                let reading = self.recording.joint[joint][row];
                evaluation.move_joint(joint, reading).ok()?;
            }
            let at = Posture {
                device,
                evaluation,
                recording: self.recording,
                row,
                subject: block.subjects.get(part.cursor).copied().unwrap_or(0),
                mount: self.mount(row),
                mountings,
            };
            let own = part.first + (part.cursor - part.begin) * part.width;
            let weight = block.weights[part.cursor];
            with_kind!(block.channel, kind => {
                self.tile_reading(&kind, &at, weight, own, (posture, &mut *part), besides, residuals, jacobian)
            })?;
            part.postures.push(posture);
            part.places.push(own);
            part.weights.push(weight);
            part.cursor += 1;
        }
        Some(())
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one reading, with where each of its numbers goes"
    )]
    fn tile_reading<M: Measurement>(
        &self,
        kind: &M,
        at: &Posture<'_>,
        weight: f64,
        own: usize,
        (posture, part): (usize, &mut Part),
        besides: &Besides,
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) -> Option<()> {
        let (values, seen) = kind.see(at, weight).ok()?;
        residuals[own..own + M::WIDTH].copy_from_slice(&values[..M::WIDTH]);
        let Some((_, matrix)) = jacobian else {
            return Some(());
        };
        if matches!(part.channel, Channel::Output { .. }) {
            return Some(());
        }
        if let Some(along) = &mut part.along {
            let seen = &seen;
            let by_twist = |twist: &Twist| kind.by_twist(seen, twist);
            let by_base_twist = |twist: &Twist| kind.by_base_twist(seen, twist);
            let [own, of_base] = &mut **along;
            write_along(own, M::WIDTH, posture, by_twist);
            if besides.has_base {
                write_along(of_base, M::WIDTH, posture, by_base_twist);
            }
        }
        let entries = if M::IS_OF_HANDLE {
            &besides.surroundings
        } else {
            &besides.all
        };
        for &(position, parameter) in entries {
            let values = match kind.sees(parameter) {
                true => kind.derivative(&seen, at, parameter),
                false => [0.0; 3],
            };
            let into = &mut matrix.column_mut(position)[own..own + M::WIDTH];
            into.copy_from_slice(&values[..M::WIDTH]);
        }
        Some(())
    }
}

/// Writes a posture's derivatives along each of the six unit twists.
fn write_along(
    along: &mut [TwistLanes; 3],
    width: usize,
    posture: usize,
    by: impl Fn(&Twist) -> [f64; 3],
) {
    for axis in 0..3 {
        let slide = by(&Twist {
            linear: AXES[axis],
            angular: Vector3::new(0.0, 0.0, 0.0),
        });
        let turn = by(&Twist {
            linear: Vector3::new(0.0, 0.0, 0.0),
            angular: AXES[axis],
        });
        for (lanes, (slide, turn)) in along
            .iter_mut()
            .zip(slide.into_iter().zip(turn))
            .take(width)
        {
            lanes.linear[axis][posture] = slide;
            lanes.angular[axis][posture] = turn;
        }
    }
}

/// Axes of frame (-1).
const AXES: [Vector3<f64>; 3] = [
    Vector3::new(1.0, 0.0, 0.0),
    Vector3::new(0.0, 1.0, 0.0),
    Vector3::new(0.0, 0.0, 1.0),
];
