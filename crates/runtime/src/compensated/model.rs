//! The model of a device with its effects, and one step of it.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{Pose, Twist};

use super::memory::{EffectState, Memory};
use super::place::place_of;
use super::structure::{Place, Stance, displaced};
use super::torques::{DriveTorques, sensor_error_n};
use super::{CompensatedState, Effect, Inputs, add};
use crate::error::{DeviceError, attempt, is_bounded};
use crate::{CoupledModel, RuntimeError, State};

/// A calibrated device of `JOINTS` joints that move `ROWS` rows, with at most `EFFECTS` effects.
///
/// The memory of its effects (plays, loops, creep) is the caller's: one [`EffectState`] for each loop, handed to every
/// step once, in order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompensatedModel<const JOINTS: usize, const ROWS: usize, const EFFECTS: usize> {
    pub(super) model: CoupledModel<JOINTS, ROWS>,
    pub(super) effects: [Effect; EFFECTS],
    places: [Place; EFFECTS],
    has_structure: bool,
    has_torques: bool,
    has_sensor: bool,
}

impl<const JOINTS: usize, const ROWS: usize, const EFFECTS: usize>
    CompensatedModel<JOINTS, ROWS, EFFECTS>
{
    /// A device with effects. Usable in a constant: `haptical export --format rust` writes one.
    ///
    /// # Errors
    /// [`DeviceError`] names the effect, the number and what is allowed.
    ///
    /// ```
    /// use haptical_runtime::*;
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let play = Effect::Backlash { joint: 0, width_rad: 0.02, driven_by: Side::Motor };
    /// let model = CompensatedModel::new(CoupledModel::of_rows(model), [play])?;
    /// let mut state = model.start();
    /// model.forward(&Inputs::at([0.0]), &mut state)?;
    /// // forward the joint is half a width behind its motor, back it is half a width ahead
    /// let there = model.forward(&Inputs::at([0.5]), &mut state)?.state.outputs[0];
    /// let back = model.forward(&Inputs::at([0.4]), &mut state)?.state.outputs[0];
    /// assert!((there - 0.49).abs() < 1e-15 && (back - 0.41).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub const fn new(
        model: CoupledModel<JOINTS, ROWS>,
        effects: [Effect; EFFECTS],
    ) -> Result<Self, DeviceError> {
        let mut places = [Place::NONE; EFFECTS];
        let (mut has_structure, mut has_torques, mut has_sensor) = (false, false, false);
        let mut index = 0;
        while index < EFFECTS {
            let effect = &effects[index];
            attempt!(effect.check(index, JOINTS, ROWS));
            places[index] = attempt!(place_of(
                model.chain.constants(),
                &model.drives,
                effect,
                index
            ));
            has_structure |= effect.is_of_structure();
            has_torques |= effect.is_of_torques();
            has_sensor |= effect.is_of_sensor();
            index += 1;
        }
        Ok(Self {
            model,
            effects,
            places,
            has_structure,
            has_torques,
            has_sensor,
        })
    }

    /// The device without its effects.
    #[must_use]
    pub const fn bare(&self) -> &CoupledModel<JOINTS, ROWS> {
        &self.model
    }

    /// The effects.
    #[must_use]
    pub const fn effects(&self) -> &[Effect; EFFECTS] {
        &self.effects
    }

    /// A state in which nothing has happened yet: at the start of a loop, and after each homing.
    #[must_use]
    pub const fn start(&self) -> EffectState<EFFECTS> {
        let mut memory = [Memory::Nothing; EFFECTS];
        let mut index = 0;
        while index < EFFECTS {
            memory[index] = Memory::of(&self.effects[index]);
            index += 1;
        }
        EffectState(memory)
    }

    /// Where the device truly stands: the joint values of the transmissions plus the errors of the effects, the links
    /// yielded, the handle displaced; docs/equations.md, Effects in a control loop. `state` goes on by one sample.
    ///
    /// # Errors
    /// [`RuntimeError`]; the state is then as it was. All numbers of an answer are finite.
    #[inline]
    pub fn forward(
        &self,
        inputs: &Inputs<JOINTS>,
        state: &mut EffectState<EFFECTS>,
    ) -> Result<CompensatedState<JOINTS>, RuntimeError> {
        inputs.check()?;
        let mut memory = state.0;
        let driven = self.driven(inputs, &mut memory)?;
        let (pose, jacobian) = self.placed(inputs, &driven)?;
        let mut torques = DriveTorques::NONE;
        if self.has_torques {
            let effects = self.effects.iter().zip(&mut memory).enumerate();
            for (index, (effect, memory)) in effects {
                torques.take(index, effect, inputs, &jacobian, memory)?;
            }
        }
        state.0 = memory;
        Ok(CompensatedState {
            state: State {
                outputs: driven.outputs,
                output_slopes: driven.slopes,
                pose,
                jacobian,
            },
            links: driven.links,
            hand_force_n: (pose.rotation * driven.force_n).into(),
            torques,
        })
    }

    /// Joint values and link angles, and the hand's force in the handle's axes.
    #[inline]
    pub(super) fn driven(
        &self,
        inputs: &Inputs<JOINTS>,
        memory: &mut [Memory; EFFECTS],
    ) -> Result<Driven<JOINTS>, RuntimeError> {
        let (mut outputs, mut slopes) = self.model.transmissions.outputs(&inputs.readings)?;
        let drives = outputs;
        let mut yielded = [0.0; JOINTS];
        let mut force_n = Vector3::from(inputs.force_n);
        for (index, (effect, memory)) in self.effects.iter().zip(memory).enumerate() {
            if let Some(error) = effect.drive_error(index, inputs, &drives, memory)? {
                add(&mut outputs, error.joint, error.value);
                add(&mut slopes, error.joint, error.slope);
            } else if let Effect::EncoderLatency { delay_s } = *effect {
                for (joint, output) in outputs.iter_mut().enumerate() {
                    *output += inputs.delayed(joint, -delay_s);
                }
            } else if let Effect::JointCompliance { joint, rad_per_nm } = *effect {
                let torque_nm = super::at(&inputs.torque_nm, joint);
                add(&mut yielded, joint, rad_per_nm * torque_nm);
            } else if self.has_sensor
                && let Some(error_n) = sensor_error_n(index, effect, inputs, memory)?
            {
                force_n -= error_n;
            }
        }
        let mut links = outputs;
        let yields = links.iter_mut().zip(&yielded).zip(&outputs);
        for (joint, ((link, yielded), output)) in yields.enumerate() {
            *link -= yielded;
            if !(is_bounded(*link) && is_bounded(*output)) {
                return Err(RuntimeError::OutputOutOfRange {
                    joint: joint + 1,
                    reading: super::at(&inputs.readings, joint),
                    output: *output,
                });
            }
        }
        Ok(Driven {
            outputs,
            slopes,
            links,
            force_n,
        })
    }

    /// Pose of the handle and Jacobian of the link angles.
    #[inline]
    pub(super) fn placed(
        &self,
        inputs: &Inputs<JOINTS>,
        driven: &Driven<JOINTS>,
    ) -> Result<(Pose, [Twist; JOINTS]), RuntimeError> {
        let (model, links) = (&self.model, &driven.links);
        let variables = model.variables(links, &inputs.readings)?;
        let mut of_rows = [Twist::default(); ROWS];
        if !self.has_structure {
            let pose = model
                .chain
                .pose_and_jacobian_in_range(&variables, &mut of_rows);
            return Ok((pose, model.of_joints(&of_rows)));
        }
        let mut behind = [Pose::default(); ROWS];
        let pose =
            model
                .chain
                .pose_jacobian_and_frames_in_range(&variables, &mut of_rows, &mut behind);
        let mut jacobian = model.of_joints(&of_rows);
        let mut before = [model.chain.constants().start; ROWS];
        for (before, behind) in before.iter_mut().skip(1).zip(&behind) {
            *before = *behind;
        }
        let stance = Stance {
            pose,
            jacobian: &jacobian,
            links,
            before: &before,
            behind: &behind,
            force_n: pose.rotation * driven.force_n,
            temperature_degc: inputs.temperature_degc,
        };
        let displaced = displaced(&stance, &self.effects, &self.places)?;
        // what the last link carries moves with it
        let shift_m = displaced.position_m - pose.position_m;
        for column in &mut jacobian {
            column.linear += column.angular.cross(&shift_m);
        }
        Ok((displaced, jacobian))
    }
}

/// What drives and sensors say of one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Driven<const JOINTS: usize> {
    pub(super) outputs: [f64; JOINTS],
    pub(super) slopes: [f64; JOINTS],
    pub(super) links: [f64; JOINTS],
    /// Force of the hand in the handle's axes.
    pub(super) force_n: Vector3<f64>,
}
