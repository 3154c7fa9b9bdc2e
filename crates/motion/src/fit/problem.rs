//! A recording's torques as whitened rows, with what rigid bodies say of them.

use std::cell::OnceCell;
use std::ops::Range;
use std::sync::Arc;

use haptical_linalg::dot;
use haptical_model::Recording;

use crate::MotionError;
use crate::arm::{Arm, PARAMETERS};
use crate::fit::column::Column;
use crate::fit::file_effects::FileEffects;
use crate::signal::line::{Line, line};
use crate::signal::local_polynomial::LocalPolynomial;
use crate::signal::memory::{Within, two_parts};
use crate::signal::noise::Noise;
use crate::signal::samples::Samples;
use crate::signal::states::States;
use crate::survey::check_rate;
use crate::thresholds::fit::{
    EDGE_OF_RATE, EDGES_HZ, LEAST_JOINT_ROWS, OF_FRICTION, RESTING_SHARE, STILL,
};

/// Joints whose torque has a noise with a memory, with it.
pub(crate) type Memories = Arc<[(usize, Noise)]>;

/// How a recording is read.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Reading {
    /// Edge of the band, where it is settled already.
    pub(crate) edge_hz: Option<f64>,
    /// Rows that are repeated or missing are set right ([`crate::signal::sampling`]).
    pub(crate) sets_right: bool,
    /// Noises of torques that have a memory, each of its joint.
    pub(crate) memories: Memories,
    /// Share of a torque's root mean square that the noise of the positions may be, where it is above that of the torque: the band is
    /// narrowed until then.
    pub(crate) noise_share: f64,
    /// What pushes the arm for a part of the log may do so beside the flange, and begin at once.
    pub(crate) at_tool: bool,
}

/// The rows of a recording.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) arm: Arm,
    pub(crate) samples: Samples,
    pub(crate) states: States,
    /// Joints that have a torque.
    pub(crate) channels: Vec<usize>,
    /// As [`Reading::memories`].
    pub(crate) memories: Memories,
    /// As [`Reading::at_tool`].
    pub(crate) at_tool: bool,
    /// Standard deviation of the noise of a row of each channel, and of a reading.
    pub(crate) row_sd: Vec<f64>,
    pub(crate) reading_sd: Vec<f64>,
    /// Regressor of the inertial parameters: body by body, ten columns of all channels' rows each.
    inertial: Vec<Vec<f64>>,
    /// Torques of the nominal bodies without armatures at the fine steps, joint by joint.
    pub(crate) rigid: Vec<Vec<f64>>,
    /// What each joint carries at the fine steps, where that is settled ([`Problem::carry`]); else that of the nominal bodies counts.
    carried: Option<Vec<Vec<f64>>>,
    /// What effects of the device's file add to the torques.
    pub(crate) file_effects: FileEffects,
    /// Weight of each row: one over the standard deviation of what is not known of it.
    weights: Vec<f64>,
    /// Of each channel, once they are asked for, the squares of the rows of waves along its joint's angle ([`crate::effect`]).
    pub(crate) wave_squares: Vec<OnceCell<Vec<[f64; 2]>>>,
}

impl Problem {
    /// Rows of a recording.
    ///
    /// # Errors
    /// [`MotionError`] where the recording has no time, no torques or no motion, is too slow or too short.
    pub(crate) fn new(
        arm: Arm,
        recording: &Recording,
        reading: Reading,
    ) -> Result<Self, MotionError> {
        let Reading {
            edge_hz,
            sets_right,
            memories,
            noise_share,
            at_tool,
        } = reading;
        let samples = Samples::new(recording, sets_right)?;
        check_rate(&samples)?;
        let channels: Vec<usize> = (0..arm.joints())
            .filter(|&joint| samples.constant_torque(joint) == Some(None))
            .collect();
        if channels.is_empty() {
            return Err(MotionError::Constant);
        }
        let highest = EDGE_OF_RATE * samples.rate_hz();
        let edges: Vec<f64> = match edge_hz {
            Some(edge_hz) => vec![edge_hz],
            None => EDGES_HZ
                .into_iter()
                .filter(|edge| *edge <= highest)
                .collect(),
        };
        let mut chosen = None;
        for edge in edges {
            let states = States::new(&samples, edge);
            let Some(states) = states.filter(|own| own.rows() >= LEAST_JOINT_ROWS) else {
                continue;
            };
            let [positions, torques] = noises(&arm, &samples, &states, (&channels, &memories))?;
            let allowed = |channel: usize| {
                let own = states.torque(&samples, channels[channel], 0.0);
                torques[channel].max(noise_share * (dot(&own, &own) / own.len() as f64).sqrt())
            };
            let mut own = positions.iter().enumerate();
            let is_fine = own.all(|(channel, own)| *own <= allowed(channel));
            let sd: Vec<f64> = (positions.iter().zip(&torques))
                .map(|(own, torque)| own.hypot(*torque))
                .collect();
            chosen = Some((states, sd));
            if is_fine {
                break;
            }
        }
        let (states, row_sd) = chosen.ok_or_else(MotionError::too_short)?;
        let fastest = states
            .motor
            .dq
            .iter()
            .flatten()
            .fold(0.0_f64, |most, dq| most.max(dq.abs()));
        if fastest < STILL {
            return Err(MotionError::Standstill);
        }
        let mut problem = Self {
            reading_sd: reading_noises(&samples, &channels, &states, &memories)
                .iter()
                .map(|own| own.sd)
                .collect(),
            arm,
            samples,
            states,
            channels,
            memories,
            at_tool,
            row_sd,
            inertial: Vec::new(),
            rigid: Vec::new(),
            carried: None,
            file_effects: FileEffects::default(),
            weights: Vec::new(),
            wave_squares: Vec::new(),
        };
        problem.wave_squares = vec![OnceCell::new(); problem.channels.len()];
        problem.file_effects = FileEffects::new(&problem, recording);
        let rows = problem.states.rows();
        let sds = problem.row_sd.iter();
        problem.weights = sds
            .flat_map(|sd| std::iter::repeat_n(1.0 / sd, rows))
            .collect();
        problem.regress()?;
        Ok(problem)
    }

    /// Takes what the bodies of an arm ask for along this motion for what its joints carry; armatures are no load of a gear's far end.
    ///
    /// # Errors
    /// [`MotionError`] for positions at which there are no torques.
    pub(crate) fn carry(&mut self, arm: &Arm) -> Result<(), MotionError> {
        let (joints, nominal) = (arm.joints(), arm.nominal());
        let mut work = arm.work();
        let mut regressor = vec![0.0; joints * nominal.len()];
        let mut carried = vec![vec![0.0; self.states.steps()]; joints];
        let link = &self.states.link;
        for step in 0..self.states.steps() {
            let at = [&link.q, &link.dq, &link.ddq];
            let [q, dq, ddq] = at.map(|own| own.iter().map(|own| own[step]).collect::<Vec<f64>>());
            arm.bodies
                .regressor(&q, &dq, &ddq, &mut work, &mut regressor)?;
            for (joint, own) in regressor.chunks_exact(nominal.len()).enumerate() {
                carried[joint][step] = dot(own, &nominal);
            }
        }
        self.carried = Some(carried);
        Ok(())
    }

    /// What a joint carries at the fine steps.
    pub(crate) fn carried(&self, joint: usize) -> &[f64] {
        let own = self.carried.as_ref().unwrap_or(&self.rigid);
        &own[joint]
    }

    /// Allows for friction whose direction is not known, given its size in each joint and the speed within which it turns over: it is
    /// anything between its two directions where a joint rests, and where two smoothings of the positions differ on it, as about the corners
    /// of a motion and between the counts of a coarse encoder (docs/assumptions.md, A188).
    pub(crate) fn allow_for_rest(&mut self, coulomb: &[f64], turnovers: &[f64]) {
        let channels = self.channels.iter().zip(&self.row_sd);
        let of_law = channels.map(|(joint, sd)| sd.hypot(OF_FRICTION * coulomb[*joint]));
        self.reweigh(&of_law.collect::<Vec<_>>());
        let rows = self.states.rows();
        for (channel, &joint) in self.channels.iter().enumerate() {
            let dq = &self.states.motor.dq[joint];
            let fastest = dq.iter().fold(0.0_f64, |most, dq| most.max(dq.abs()));
            let rests: Vec<f64> = (dq.iter())
                .map(|dq| f64::from(dq.abs() < RESTING_SHARE * fastest))
                .collect();
            let slower = self.states.slower_speed(&self.samples, joint);
            let direction = |dq: f64| libm::tanh(dq / turnovers[joint]);
            let differs: Vec<f64> = (dq.iter().zip(&slower))
                .map(|(dq, slower)| (direction(*dq) - direction(*slower)).abs())
                .collect();
            let differs = self.states.filtered(&differs);
            for (row, share) in self.states.filtered(&rests).into_iter().enumerate() {
                let unknown = share.hypot(differs[row]) * coulomb[joint];
                let sd = self.row_sd[channel].hypot(unknown);
                let at = channel * rows + row;
                let change = 1.0 / (sd * self.weights[at]);
                self.weights[at] *= change;
                self.inertial.iter_mut().for_each(|own| own[at] *= change);
            }
        }
    }

    /// Weights all rows of a channel by one standard deviation.
    pub(crate) fn reweigh(&mut self, row_sd: &[f64]) {
        let rows = self.states.rows();
        for at in 0..self.channel_rows() {
            let change = 1.0 / (row_sd[at / rows] * self.weights[at]);
            self.weights[at] *= change;
            self.inertial.iter_mut().for_each(|own| own[at] *= change);
        }
        self.row_sd = row_sd.to_vec();
    }

    /// Weight of a row, all channels counted through.
    pub(crate) fn weight(&self, row: usize) -> f64 {
        self.weights[row]
    }

    /// Rows of all channels.
    pub(crate) fn channel_rows(&self) -> usize {
        self.channels.len() * self.states.rows()
    }

    /// Position of a joint among the channels.
    pub(crate) fn channel_of(&self, joint: usize) -> Option<usize> {
        self.channels.iter().position(|own| *own == joint)
    }

    /// Whitened rows of a signal of one joint at the fine steps; none where it has no torque.
    pub(crate) fn of_joint(&self, joint: usize, signal: &[f64]) -> Option<Column> {
        let channel = self.channel_of(joint)?;
        Some(self.weighted(channel, self.states.filtered(signal)))
    }

    /// Whitened rows of what an effect of the device's file adds to the torque of a joint; none where it has no torque.
    pub(crate) fn of_added(&self, joint: usize, effect: usize) -> Option<Column> {
        let channel = self.channel_of(joint)?;
        Some(self.weighted(channel, self.states.added(&self.samples, effect)))
    }

    fn weighted(&self, channel: usize, mut values: Vec<f64>) -> Column {
        let first = channel * self.states.rows();
        let weights = &self.weights[first..];
        (values.iter_mut().zip(weights)).for_each(|(value, weight)| *value *= weight);
        Column::Part { first, values }
    }

    /// Whitened rows of signals of all joints.
    pub(crate) fn of_joints(&self, signals: &[Vec<f64>]) -> Column {
        let mut all = vec![0.0; self.channel_rows()];
        for &joint in &self.channels {
            if let Some(column) = self.of_joint(joint, &signals[joint]) {
                column.add_to(&mut all, 1.0);
            }
        }
        Column::All(all)
    }

    /// Whitened rows of signals of all joints that are zero but at some fine steps, of which they are given.
    pub(crate) fn of_joints_at(
        &self,
        steps: &Range<usize>,
        signal: impl Fn(usize) -> Vec<f64>,
    ) -> Column {
        let rows = self.states.rows();
        let mut all = vec![0.0; self.channel_rows()];
        for (channel, &joint) in self.channels.iter().enumerate() {
            let values = self.states.filtered_at(steps, &signal(joint));
            for (row, value) in self.states.rows_of(steps).zip(values) {
                let at = channel * rows + row;
                all[at] = value * self.weights[at];
            }
        }
        Column::All(all).in_spans()
    }

    /// Whitened rows of a change of the inertial parameters of a body.
    pub(crate) fn of_body(&self, body: usize, parameters: &[f64; PARAMETERS]) -> Column {
        let mut all = vec![0.0; self.channel_rows()];
        for (own, factor) in self.inertial[PARAMETERS * body..].iter().zip(parameters) {
            if *factor != 0.0 {
                (all.iter_mut().zip(own)).for_each(|(into, value)| *into += factor * value);
            }
        }
        Column::All(all)
    }

    /// Whitened rows of the recorded torques less those of the nominal bodies; `early_s`: how long before the positions.
    pub(crate) fn recorded(&self, early_s: f64) -> Vec<f64> {
        self.recorded_less(&self.nominal_rows(), early_s)
    }

    /// The same, given [`Self::nominal_rows`].
    pub(crate) fn recorded_less(&self, nominal: &Column, early_s: f64) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.channel_rows());
        for (channel, &joint) in self.channels.iter().enumerate() {
            let weights = &self.weights[channel * self.states.rows()..];
            let early_s = early_s + self.arm.early_s[joint];
            let torque = self.states.torque(&self.samples, joint, early_s);
            let offset = self.arm.offset[joint];
            let own = torque.iter().zip(weights);
            all.extend(own.map(|(value, weight)| weight * (value - offset)));
        }
        nominal.add_to(&mut all, -1.0);
        all
    }

    /// Whitened rows of [`Self::nominal_torque`].
    pub(crate) fn nominal_rows(&self) -> Column {
        self.of_joints(&self.nominal_torque())
    }

    /// Torques of the nominal bodies with their armatures, and of effects of the device's file but friction, at the fine steps.
    pub(crate) fn nominal_torque(&self) -> Vec<Vec<f64>> {
        let mut torque = self.rigid.clone();
        for (joint, column) in torque.iter_mut().enumerate() {
            if let Some(armature) = self.arm.armature[joint] {
                let ddq = self.states.motor.ddq[joint].iter();
                (column.iter_mut().zip(ddq)).for_each(|(torque, ddq)| *torque += armature * ddq);
            }
        }
        for (joint, added) in &self.file_effects.known {
            (torque[*joint].iter_mut().zip(added)).for_each(|(torque, added)| *torque += added);
        }
        torque
    }

    /// Recorded torque of a joint at the fine steps, smoothed as the positions are.
    pub(crate) fn recorded_torque(&self, joint: usize) -> Vec<f64> {
        self.states.smoothed(&self.samples, joint)
    }

    /// The regressor's rows and the nominal torques.
    fn regress(&mut self) -> Result<(), MotionError> {
        let (states, joints) = (&self.states, self.arm.joints());
        let columns = PARAMETERS * self.arm.body_count();
        let rows = states.rows();
        let nominal = self.arm.nominal();
        let mut work = self.arm.work();
        let mut regressor = vec![0.0; joints * columns];
        let mut sums = vec![0.0; rows * joints * columns];
        self.rigid = vec![vec![0.0; states.steps()]; joints];
        let mut first = 0;
        let mut at = [vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]];
        for step in 0..states.steps() {
            for joint in 0..joints {
                at[0][joint] = states.link.q[joint][step];
                at[1][joint] = states.link.dq[joint][step];
                at[2][joint] = states.link.ddq[joint][step];
            }
            self.arm
                .bodies
                .regressor(&at[0], &at[1], &at[2], &mut work, &mut regressor)?;
            for (joint, own) in regressor.chunks_exact(columns).enumerate() {
                self.rigid[joint][step] = dot(own, &nominal);
            }
            while first < rows && {
                let (from, weights) = states.window(first);
                from + weights.len() <= step
            } {
                first += 1;
            }
            for row in first..rows {
                let (from, weights) = states.window(row);
                if from > step {
                    break;
                }
                let weight = weights[step - from];
                let into = &mut sums[row * joints * columns..][..joints * columns];
                (into.iter_mut().zip(&regressor)).for_each(|(into, value)| *into += weight * value);
            }
        }
        self.inertial = vec![vec![0.0; self.channel_rows()]; columns];
        for (channel, &joint) in self.channels.iter().enumerate() {
            for row in 0..rows {
                let at = channel * rows + row;
                let own = &sums[(row * joints + joint) * columns..][..columns];
                for (into, value) in self.inertial.iter_mut().zip(own) {
                    into[at] = value * self.weights[at];
                }
            }
        }
        Ok(())
    }
}

/// Whether a joint stands still beside another one that moves with `most`.
pub(crate) fn is_still(fastest: f64, most: f64) -> bool {
    fastest < STILL.max(STILL * most)
}

/// Noise of the readings of the channels' torques.
fn reading_noises(
    samples: &Samples,
    channels: &[usize],
    states: &States,
    memories: &Memories,
) -> Vec<Noise> {
    let local = LocalPolynomial::new(samples.step_s, 2.0 * states.pass.edge_hz);
    channels
        .iter()
        .map(|&joint| {
            let mut known = memories.iter().filter(|own| own.0 == joint);
            known.next().map_or_else(
                || {
                    let torques = samples.pieces.iter();
                    let torques = torques.filter_map(|own| own.torque[joint].as_deref());
                    Noise::white(torques, &local)
                },
                |own| own.1,
            )
        })
        .collect()
}

/// The noise of a channel if what a fit leaves of it is a noise of two parts: `rest` are its rows in the torque's unit.
pub(crate) fn noise_with_memory(problem: &Problem, joint: usize, rest: &[f64]) -> Option<Noise> {
    let (samples, states) = (&problem.samples, &problem.states);
    let local = LocalPolynomial::new(samples.step_s, 2.0 * states.pass.edge_hz);
    let torques = samples.pieces.iter();
    let torques = torques.filter_map(|own| own.torque[joint].as_deref());
    let (rows, every) = states.runs(rest);
    let weights = states.row_weights();
    let within = Within {
        weights: &weights,
        every,
    };
    two_parts(torques, (&local, samples.step_s), &rows, within)
}

/// Joints whose torque oscillates faster than the motion, each by the longest piece.
pub(crate) fn oscillations(problem: &Problem) -> Vec<(usize, Line)> {
    let samples = &problem.samples;
    let local = LocalPolynomial::new(samples.step_s, 2.0 * problem.states.pass.edge_hz);
    let of_joint = |joint: &usize| {
        let pieces = samples.pieces.iter();
        let torques = pieces.filter_map(|own| own.torque[*joint].as_deref());
        let longest = torques.max_by_key(|own| own.len())?;
        Some((*joint, line(longest, &local, samples.step_s)?))
    };
    problem.channels.iter().filter_map(of_joint).collect()
}

/// Noise of the channels' rows: from positions by way of the largest inertia, and of the torques.
fn noises(
    arm: &Arm,
    samples: &Samples,
    states: &States,
    (channels, memories): (&[usize], &Memories),
) -> Result<[Vec<f64>; 2], MotionError> {
    let joints = arm.joints();
    let mut work = arm.work();
    let mut matrix = vec![0.0; joints * joints];
    let mut inertia = vec![0.0_f64; joints];
    let every = (states.steps() / 50).max(1);
    let mut q = vec![0.0; joints];
    for step in (0..states.steps()).step_by(every) {
        for joint in 0..joints {
            q[joint] = states.link.q[joint][step];
        }
        arm.bodies.mass_matrix(&q, &mut work, &mut matrix)?;
        for joint in 0..joints {
            inertia[joint] = inertia[joint].max(matrix[joint * joints + joint]);
        }
    }
    let torques: Vec<f64> = reading_noises(samples, channels, states, memories)
        .into_iter()
        .map(|noise| states.behind(noise))
        .collect();
    let positions: Vec<f64> = (channels.iter())
        .map(|&joint| {
            let link = states.link_noise[joint];
            let bodies_by_motor = if link.is_apart { 0.0 } else { inertia[joint] };
            let by_motor = arm.likely_armature[joint] + bodies_by_motor;
            (by_motor * states.acceleration_sd[joint]).hypot(inertia[joint] * link.acceleration_sd)
        })
        .collect();
    // a torque that is computed and not measured has no noise at all: its rounding then
    let torques = (channels.iter().zip(torques))
        .map(|(&joint, sd)| {
            let values = samples
                .pieces
                .iter()
                .filter_map(|own| own.torque[joint].as_ref());
            let largest = values
                .flatten()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            sd.max(1e-6 * largest)
        })
        .collect();
    Ok([positions, torques])
}
