//! The residuals of a channel as one error for each row of the recording, for curves over time.

use crate::ChannelResiduals;

impl ChannelResiduals {
    /// One error for each of the recording's `rows` rows, in the channel's unit; none for a row
    /// without a residual.
    ///
    /// Model minus measurement with its sign for an encoder or a cable; for a position or an
    /// orientation the Euclidean length of its three residuals, never negative.
    ///
    /// # Examples
    /// ```
    /// use haptical_calibration::{Channel, ChannelResiduals};
    /// let position = ChannelResiduals {
    ///     channel: Channel::Position,
    ///     rows: vec![1],
    ///     residuals: vec![2e-3, -3e-3, 6e-3],
    ///     outside_range: 0,
    ///     noise_floor: 1e-4,
    /// };
    /// let errors_m = position.by_row(3);
    /// assert_eq!((errors_m[0], errors_m[2]), (None, None));
    /// assert!((errors_m[1].unwrap_or(0.0) - 7e-3).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn by_row(&self, rows: usize) -> Vec<Option<f64>> {
        let mut errors = vec![None; rows];
        let readings = self.residuals.chunks_exact(self.channel.width());
        for (&row, reading) in self.rows.iter().zip(readings) {
            let error = match reading {
                [signed] => *signed,
                axes => length(axes),
            };
            if let Some(place) = errors.get_mut(row) {
                *place = Some(error);
            }
        }
        errors
    }
}

/// Euclidean length; `hypot`, because the squares of a wild reading are not representable.
fn length(axes: &[f64]) -> f64 {
    axes.iter().fold(0.0, |sum: f64, axis| sum.hypot(*axis))
}
