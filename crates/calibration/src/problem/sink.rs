//! Receivers of one row's derivatives: none, a dense matrix, or gathered rows.

use haptical_identification::Matrix;
use haptical_model::{ModelError, ParameterId};

use crate::Channel;
use crate::problem::gathered::GatheredRows;

/// Receiver of derivatives; all but the last know parameters by their position within `free`.
pub(crate) enum Sink<'s> {
    /// Residuals alone are wanted.
    None,
    /// Free parameters, and a matrix with a column for each.
    Dense(&'s [usize], &'s mut Matrix),
    /// One growing triangle for each channel.
    Triangles(&'s mut [GatheredRows]),
}

/// Where one channel's residuals at one row stand.
pub(crate) struct Place {
    /// Position of the channel within the problem.
    pub(crate) block: usize,
    pub(crate) channel: Channel,
    /// First residual.
    pub(crate) index: usize,
    /// One over the standard deviation.
    pub(crate) weight: f64,
    /// Row of the recording.
    pub(crate) row: usize,
    /// Which touched point or plane the row is about.
    pub(crate) subject: usize,
}

impl Sink<'_> {
    /// Writes the derivatives of one channel's residuals at one row.
    pub(crate) fn put(
        &mut self,
        parameters: &[ParameterId],
        place: &Place,
        residuals: &[f64],
        mut derivative: impl FnMut(ParameterId) -> Result<[f64; 3], ModelError>,
    ) -> Result<(), ModelError> {
        let (channel, index) = (place.channel, place.index);
        let width = channel.width();
        match self {
            Sink::None => {}
            Sink::Dense(free, matrix) => {
                for (position, &parameter) in free.iter().enumerate() {
                    let values = if channel.can_see(parameters[parameter]) {
                        derivative(parameters[parameter])?
                    } else {
                        [0.0; 3]
                    };
                    matrix.column_mut(position)[index..index + width]
                        .copy_from_slice(&values[..width]);
                }
            }
            Sink::Triangles(triangles) => {
                let residuals = &residuals[index..index + width];
                triangles[place.block].append(index, residuals, |parameter| {
                    derivative(parameters[parameter])
                })?;
            }
        }
        Ok(())
    }
}
