//! Residuals and derivatives of what effects add to some rows.

use std::ops::Range;

use haptical_identification::Matrix;
use haptical_model::{Device, ParameterId};

use crate::DeviceProblem;
use crate::problem::added::Change;

impl DeviceProblem<'_> {
    /// Adds what effects do to the residuals of some rows, and their derivatives.
    pub(crate) fn add_effects(
        &self,
        device: &Device,
        rows: &Range<usize>,
        firsts: &[usize],
        residuals: &mut [f64],
        jacobian: &mut Option<(&[usize], &mut Matrix)>,
    ) {
        let is_of_effect =
            |&&parameter: &&usize| matches!(self.parameters[parameter], ParameterId::Effect { .. });
        for (block, &first) in self.blocks.iter().zip(firsts) {
            let begin = block.rows.partition_point(|&row| row < rows.start);
            let end = block.rows.partition_point(|&row| row < rows.end);
            let width = block.channel.width();
            if let Some((free, matrix)) = jacobian.as_mut() {
                let columns = free.iter().enumerate();
                for (column, _) in columns.filter(|(_, parameter)| is_of_effect(parameter)) {
                    matrix.column_mut(column)[first..first + (end - begin) * width].fill(0.0);
                }
            }
            for own in &block.added {
                let change = Change::new(device, own);
                let place = |entry: usize| first + (entry - begin) * width + own.axis;
                for entry in begin..end {
                    residuals[place(entry)] += block.weights[entry] * change.at(own, entry);
                }
                let Some((free, matrix)) = jacobian.as_mut() else {
                    continue;
                };
                for (column, &parameter) in free.iter().enumerate() {
                    let ParameterId::Effect { effect, number } = self.parameters[parameter] else {
                        continue;
                    };
                    let slope = own.slopes.get(number).filter(|_| effect == own.effect);
                    let Some(slope) = slope else { continue };
                    let into = matrix.column_mut(column);
                    for entry in begin..end {
                        into[place(entry)] += block.weights[entry] * slope[entry];
                    }
                }
            }
        }
    }
}
