//! What there is to read at each tick of the controller, before sensors and recorder have it.

use crate::moving::motion::control::Asked;

/// Columns at the controller's rate: joint by joint, tick by tick.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) time_s: Vec<f64>,
    /// Of the motors, at the joints.
    pub(crate) angle: Vec<Vec<f64>>,
    pub(crate) rate: Vec<Vec<f64>>,
    pub(crate) acceleration: Vec<Vec<f64>>,
    /// Of the links.
    pub(crate) output: Vec<Vec<f64>>,
    /// Of the motors, at the joints.
    pub(crate) torque: Vec<Vec<f64>>,
    pub(crate) command: Vec<Vec<f64>>,
    pub(crate) command_rate: Vec<Vec<f64>>,
    pub(crate) command_acceleration: Vec<Vec<f64>>,
}

impl Ticks {
    pub(crate) fn new(joints: usize) -> Self {
        let columns = || vec![Vec::new(); joints];
        Self {
            time_s: Vec::new(),
            angle: columns(),
            rate: columns(),
            acceleration: columns(),
            output: columns(),
            torque: columns(),
            command: columns(),
            command_rate: columns(),
            command_acceleration: columns(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.time_s.len()
    }

    pub(crate) fn joints(&self) -> usize {
        self.angle.len()
    }

    pub(crate) fn push_command(&mut self, asked: &Asked) {
        for joint in 0..self.joints() {
            self.command[joint].push(asked.angle[joint]);
            self.command_rate[joint].push(asked.rate[joint]);
            self.command_acceleration[joint].push(asked.acceleration[joint]);
        }
    }

    pub(crate) fn asked(&self, tick: usize) -> Asked {
        let of = |columns: &[Vec<f64>]| columns.iter().map(|column| column[tick]).collect();
        Asked {
            angle: of(&self.command),
            rate: of(&self.command_rate),
            acceleration: of(&self.command_acceleration),
        }
    }

    /// Motor angles and what follows from them, and the links', as they were so many seconds earlier.
    pub(crate) fn delay_angles(&mut self, delay_s: f64, ticks_per_s: f64) {
        for columns in [
            &mut self.angle,
            &mut self.rate,
            &mut self.acceleration,
            &mut self.output,
        ] {
            for column in columns {
                *column = delayed(column, delay_s * ticks_per_s);
            }
        }
    }
}

/// A column as it was so many ticks earlier, straight between ticks; what came before the first one is the first one.
pub(crate) fn delayed(column: &[f64], ticks: f64) -> Vec<f64> {
    let whole = libm::floor(ticks);
    let share = ticks - whole;
    let at = |row: usize, back: usize| column[row.saturating_sub(back)];
    let value =
        |row: usize| (1.0 - share) * at(row, whole as usize) + share * at(row, whole as usize + 1);
    (0..column.len()).map(value).collect()
}
