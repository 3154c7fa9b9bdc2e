//! Readings for wanted joint values: what motors must be told.

use super::memory::Memory;
use super::root::zero_near;
use super::{CompensatedModel, Effect, EffectState, Inputs, at};
use crate::RuntimeError;

/// Rounds over the joints: each leaves a coupling gain of the error before.
const ROUNDS: usize = 30;
/// A reading that moves by less has settled.
const SETTLED: f64 = 1e-14;
/// A joint value that is nearer to the wanted one is that value.
const REACHED: f64 = 1e-10;

impl<const JOINTS: usize, const ROWS: usize, const EFFECTS: usize>
    CompensatedModel<JOINTS, ROWS, EFFECTS>
{
    /// Readings at the next sample for which the joints have these values \[rad\], \[m\]: to the inverse of the
    /// transmission a play adds its half width in the direction of the motion, a spring what it yields.
    ///
    /// `inputs` are those of the next sample; its readings are the present ones, from which the search starts and at
    /// which a motor stays whose joint is where it is wanted. `state` is that of the present sample and stays so: hand
    /// the new readings to [`forward`](Self::forward).
    ///
    /// # Errors
    /// [`RuntimeError::NotReached`] where no reading gives a value; as [`forward`](Self::forward).
    ///
    /// ```
    /// use haptical_runtime::*;
    /// let arm = Link { a_m: 0.3, ..Link::IDENTITY };
    /// let joint = Joint { motion: Motion::Revolute, home: 0.0, transmission: Transmission::Exact };
    /// let model = Model::new(Convention::Standard, Link::IDENTITY, [arm], [joint])?;
    /// let play = Effect::Backlash { joint: 0, width_rad: 0.02, driven_by: Side::Motor };
    /// let model = CompensatedModel::new(CoupledModel::of_rows(model), [play])?;
    /// let mut state = model.start();
    /// let now = Inputs::at([0.0]);
    /// model.forward(&now, &mut state)?;
    /// assert!((model.inverse(&[0.3], &now, &state)?[0] - 0.31).abs() < 1e-12);
    /// assert!((model.inverse(&[-0.3], &now, &state)?[0] + 0.31).abs() < 1e-12);
    /// assert_eq!(model.inverse(&[0.0], &now, &state)?, [0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse(
        &self,
        outputs: &[f64; JOINTS],
        inputs: &Inputs<JOINTS>,
        state: &EffectState<EFFECTS>,
    ) -> Result<[f64; JOINTS], RuntimeError> {
        inputs.check()?;
        let mut next = *inputs;
        for _ in 0..ROUNDS {
            let mut moved = 0.0_f64;
            for joint in 0..JOINTS {
                let before = at(&next.readings, joint);
                let reading = self.joint_inverse(joint, at(outputs, joint), &next, state)?;
                moved = moved.max((reading - before).abs());
                if let Some(own) = next.readings.get_mut(joint) {
                    *own = reading;
                }
            }
            if moved <= SETTLED {
                break;
            }
        }
        for (joint, &output) in outputs.iter().enumerate() {
            let reached = self.joint_output(joint, at(&next.readings, joint), &next, state)?;
            // NaN is not near either
            let is_near = (reached - output).abs() <= REACHED * output.abs().max(1.0);
            if !is_near {
                let joint = joint + 1;
                return Err(RuntimeError::NotReached { joint, output });
            }
        }
        Ok(next.readings)
    }

    /// The reading of one joint, the others as they are.
    fn joint_inverse(
        &self,
        joint: usize,
        output: f64,
        inputs: &Inputs<JOINTS>,
        state: &EffectState<EFFECTS>,
    ) -> Result<f64, RuntimeError> {
        let now = at(&inputs.readings, joint);
        let not_reached = RuntimeError::NotReached {
            joint: joint + 1,
            output,
        };
        if !output.is_finite() {
            return Err(not_reached);
        }
        let missing = |reading: f64| Ok(self.joint_output(joint, reading, inputs, state)? - output);
        let at_now = missing(now)?;
        if at_now.abs() <= SETTLED {
            return Ok(now);
        }
        let range = self.model.transmissions.ranges.get(joint);
        let range = range.copied().unwrap_or([now, now]);
        // most of the error is there already
        zero_near(now - at_now, range, missing)?.ok_or(not_reached)
    }

    /// The value of one joint at a reading of it.
    fn joint_output(
        &self,
        joint: usize,
        reading: f64,
        inputs: &Inputs<JOINTS>,
        state: &EffectState<EFFECTS>,
    ) -> Result<f64, RuntimeError> {
        let Some(output) = self.model.transmissions.output(joint, reading) else {
            return Ok(0.0);
        };
        let (mut output, _) = output?;
        // effects of a joint look at no other joint's
        let mut drives = [0.0; JOINTS];
        if let Some(own) = drives.get_mut(joint) {
            *own = output;
        }
        let mut inputs = *inputs;
        if let Some(own) = inputs.readings.get_mut(joint) {
            *own = reading;
        }
        for (index, (effect, memory)) in self.effects.iter().zip(&state.0).enumerate() {
            if !effect.moves_drive(joint) {
                continue;
            }
            let mut memory: Memory = *memory;
            output += match (
                effect.drive_error(index, &inputs, &drives, &mut memory)?,
                effect,
            ) {
                (Some(error), _) => error.value,
                (None, Effect::EncoderLatency { delay_s }) => inputs.delayed(joint, -delay_s),
                (None, _) => 0.0,
            };
        }
        Ok(output)
    }
}
