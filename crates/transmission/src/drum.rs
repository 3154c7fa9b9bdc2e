//! The angle by which one eccentric drum turns the line of centres, with derivatives.

use crate::error::TransmissionError;

/// `g` of eq. (1) at one drum angle and its derivatives.
#[derive(Clone, Copy)]
pub(crate) struct DrumAngle {
    pub(crate) value_rad: f64,
    /// `dg / d phi`.
    pub(crate) slope: f64,
    /// `dg / dx`, `dg / dy`, rad/m.
    pub(crate) per_xy: [f64; 2],
}

/// An eccentric drum: the centre's offset at home over the denominator `D`.
#[derive(Clone, Copy)]
pub(crate) struct Drum {
    x: f64,
    y: f64,
    denominator_m: f64,
}

impl Drum {
    /// A drum whose centre lies at `xy_m` from its axis at home; `denominator_m` is positive and finite.
    pub(crate) fn new(
        drum: &'static str,
        [x_m, y_m]: [f64; 2],
        denominator_m: f64,
    ) -> Result<Self, TransmissionError> {
        let eccentricity_m = libm::hypot(x_m, y_m);
        if eccentricity_m < denominator_m {
            Ok(Self {
                x: x_m / denominator_m,
                y: y_m / denominator_m,
                denominator_m,
            })
        } else {
            Err(TransmissionError::EccentricityTooLarge {
                drum,
                eccentricity_m,
                denominator_m,
            })
        }
    }

    /// With `n = x sin phi + y cos phi` and `d = 1 - (x cos phi - y sin phi)` (lengths over `D`),
    /// `g = atan2(n, d)`. Since `dn/dphi = 1 - d` and `dd/dphi = n`,
    /// `dg/dphi = ((1 - d) d - n^2) / (n^2 + d^2)`; `d > 0` because the eccentricity is less than `D`.
    pub(crate) fn angle(&self, phi_rad: f64) -> DrumAngle {
        let (sin, cos) = libm::sincos(phi_rad);
        let n = self.x * sin + self.y * cos;
        let q = self.x * cos - self.y * sin;
        let d = 1.0 - q;
        let scale = n * n + d * d;
        DrumAngle {
            value_rad: libm::atan2(n, d),
            slope: (q * d - n * n) / scale,
            per_xy: [
                (sin * d + n * cos) / scale / self.denominator_m,
                (cos * d - n * sin) / scale / self.denominator_m,
            ],
        }
    }

    /// `g(phi) - g(0)`: the encoder reads zero at home, whatever the drum's orientation there.
    pub(crate) fn angle_from_home(&self, phi_rad: f64) -> DrumAngle {
        let (here, home) = (self.angle(phi_rad), self.angle(0.0));
        DrumAngle {
            value_rad: here.value_rad - home.value_rad,
            slope: here.slope,
            per_xy: [
                here.per_xy[0] - home.per_xy[0],
                here.per_xy[1] - home.per_xy[1],
            ],
        }
    }
}
