//! A cable encoder: what it reads at a handle position, and how that changes.

use haptical_kinematics::nalgebra::Vector3;
use haptical_kinematics::{KinematicsError, distance_m};

use crate::Device;

/// A cable encoder that measures the distance from its anchor to the handle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cable {
    /// Where the cable leaves its guide, in frame (-1) \[m\].
    pub anchor_m: [f64; 3],
    /// Radius of the encoder's drum \[m\].
    pub drum_radius_m: Option<f64>,
    /// Counts per revolution of the drum.
    pub counts_per_rev: Option<f64>,
    /// Standard deviation of a distance \[m\].
    pub distance_sd_m: Option<f64>,
    /// Standard deviation of the reading per length: how well the drum's circumference is known.
    pub scale_sd: Option<f64>,
    /// Direction in which the cable leaves its guide straight.
    pub exit_axis: Option<[f64; 3]>,
    /// Reading at no length \[m\].
    pub zero_m: f64,
    /// Reading per length; 1 where the drum has the circumference that it should have.
    pub scale: f64,
    /// Radius of the round guide that the cable bends over where it leaves \[m\].
    pub exit_radius_m: f64,
    /// What a calibration may fit of it.
    pub fit: CableFit,
}

/// Which numbers of a cable are unknown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CableFit {
    /// The anchor's three coordinates.
    pub anchor: bool,
    /// The reading at no length.
    pub zero: bool,
    /// The reading per length.
    pub scale: bool,
    /// The guide's radius.
    pub exit_radius: bool,
}

impl Default for Cable {
    /// A straight cable from frame (-1)'s origin.
    fn default() -> Self {
        Self {
            anchor_m: [0.0; 3],
            drum_radius_m: None,
            counts_per_rev: None,
            distance_sd_m: None,
            scale_sd: None,
            exit_axis: None,
            zero_m: 0.0,
            scale: 1.0,
            exit_radius_m: 0.0,
            fit: CableFit::default(),
        }
    }
}

/// What a cable encoder reads at a handle position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CableReading {
    /// Reading \[m\].
    pub reading_m: f64,
    /// Length of the cable from its exit to the handle, over the guide \[m\].
    pub length_m: f64,
    /// Derivative of the reading with respect to the handle's position; minus it with respect to the
    /// anchor's.
    pub by_position: Vector3<f64>,
    /// Derivative of the reading with respect to the guide's radius.
    pub by_exit_radius: f64,
}

impl Cable {
    /// Whether the reading is the distance itself and nothing of the cable is fitted.
    pub fn is_plain(&self) -> bool {
        self.zero_m == 0.0
            && self.scale == 1.0
            && self.exit_radius_m == 0.0
            && self.fit == CableFit::default()
    }

    /// What the encoder reads: `zero + scale length`, the length taken over a round guide of the exit
    /// radius that touches the exit axis at the exit.
    ///
    /// With x the handle's distance along the exit axis, y that across it and r the radius, the cable leaves
    /// the guide s = sqrt(x^2 + y^2 - 2 y r) before the handle and the length is
    /// `s + r (atan2(y - r, x) + atan2(r, s))` (docs/diagnosis.md, "Exit guide"); without a radius it is
    /// the distance, Baser & Konukseven eq. (5).
    ///
    /// ```
    /// use haptical_model::Cable;
    /// let cable = Cable { zero_m: 0.001, scale: 1.01, ..Cable::default() };
    /// let read = cable.reading(&[0.3, 0.0, 0.4].into())?;
    /// assert!((read.reading_m - (0.001 + 1.01 * 0.5)).abs() < 1e-15);
    /// # Ok::<(), haptical_model::kinematics::KinematicsError>(())
    /// ```
    ///
    /// # Errors
    /// [`KinematicsError::ZeroDistance`] where the handle is at the anchor or within the guide;
    /// [`KinematicsError`] for a position that is not finite.
    pub fn reading(&self, position_m: &Vector3<f64>) -> Result<CableReading, KinematicsError> {
        let anchor = Vector3::from(self.anchor_m);
        let distance = distance_m(position_m, &anchor)?;
        let way = position_m - anchor;
        let straight = CableReading {
            reading_m: self.zero_m + self.scale * distance,
            length_m: distance,
            by_position: way * (self.scale / distance),
            by_exit_radius: 0.0,
        };
        let axis = self.exit_axis.map(Vector3::from);
        let Some(axis) = axis.and_then(|axis| axis.try_normalize(f64::MIN_POSITIVE)) else {
            return Ok(straight);
        };
        if self.exit_radius_m == 0.0 && !self.fit.exit_radius {
            return Ok(straight);
        }
        let r = self.exit_radius_m;
        let x = axis.dot(&way);
        let aside = way - axis * x;
        let y = aside.norm();
        let s_square = x * x + y * y - 2.0 * y * r;
        if s_square <= 0.0 || !s_square.is_finite() {
            return Err(KinematicsError::ZeroDistance {
                position_m: (*position_m).into(),
            });
        }
        let s = s_square.sqrt();
        let square = s_square + r * r;
        let turned = (y - r).atan2(x) + r.atan2(s);
        let along = x / s - r * ((y - r) + r * x / s) / square;
        let across = (y - r) / s + r * (x - r * (y - r) / s) / square;
        let by_radius = turned - y / s + r * (s + r * y / s - x) / square;
        let mut by_position = axis * along;
        if y > 0.0 {
            by_position += aside * (across / y);
        }
        let length_m = s + r * turned;
        Ok(CableReading {
            reading_m: self.zero_m + self.scale * length_m,
            length_m,
            by_position: by_position * self.scale,
            by_exit_radius: by_radius * self.scale,
        })
    }
}

impl Device {
    /// Standard deviation of the cable encoder at `index` \[m\]: as stated, or one third of the
    /// largest quantization error as the paper takes it for encoders.
    pub fn cable_sd_m(&self, index: usize) -> Option<f64> {
        let cable = self.cables.get(index)?;
        cable.distance_sd_m.or_else(|| {
            let quantum = std::f64::consts::TAU * cable.drum_radius_m? / cable.counts_per_rev?;
            Some(quantum / 3.0)
        })
    }
}
