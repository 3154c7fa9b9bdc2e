//! The length that a cable unit measures from its exit to the handle, before counts and noise.

use std::f64::consts::PI;

use haptical_model::Cable;
use haptical_model::kinematics::nalgebra::Vector3;

use crate::effect::Effect;
use crate::motion::scene::drive::Instant;

/// Steps to the drum's angle; each shrinks the error by eccentricity over radius.
const MAX_STEPS: usize = 200;
/// Change of the angle at which it is found \[rad\].
const LAST_STEP_RAD: f64 = 1e-14;

/// One cable with its effects.
#[derive(Debug, Clone)]
pub(crate) struct CablePath {
    /// Direction in which the cable leaves its guide straight; unit length.
    exit_axis: Vector3<f64>,
    /// Length of the cable at home, where the unit is set to the true distance \[m\].
    home_m: f64,
    guide_radius_m: f64,
    twist_m_per_rad2: f64,
    offset_m: f64,
    m_per_s: f64,
    m_per_k: f64,
    drum: Option<Drum>,
}

/// A drum whose centre is off its axis.
#[derive(Debug, Clone, Copy)]
struct Drum {
    radius_m: f64,
    amplitude_m: f64,
    phase_rad: f64,
}

impl CablePath {
    /// `home` leads from the anchor to the handle at home. Effects of a cable are the first one's.
    pub(crate) fn new(cable: &Cable, home: &Vector3<f64>, effects: &[Effect]) -> Self {
        let axis = cable.exit_axis.map_or(*home, Vector3::from);
        let length = libm::sqrt(axis.norm_squared());
        let mut path = Self {
            exit_axis: if length > 0.0 {
                axis / length
            } else {
                Vector3::z()
            },
            home_m: libm::sqrt(home.norm_squared()),
            guide_radius_m: 0.0,
            twist_m_per_rad2: 0.0,
            offset_m: 0.0,
            m_per_s: 0.0,
            m_per_k: 0.0,
            drum: None,
        };
        for effect in effects {
            match *effect {
                Effect::CableExitGeometry { radius_m } => path.guide_radius_m = radius_m,
                Effect::CableTwist { twist_m_per_rad2 } => path.twist_m_per_rad2 = twist_m_per_rad2,
                Effect::CableZeroOffset { offset_m } => path.offset_m = offset_m,
                Effect::CableDrift { m_per_s } => path.m_per_s = m_per_s,
                Effect::ThermalDrift { m_per_degc } => path.m_per_k = m_per_degc,
                Effect::CableDrumEccentricity {
                    amplitude_m,
                    phase_rad,
                } => {
                    path.drum = cable.drum_radius_m.map(|radius_m| Drum {
                        radius_m,
                        amplitude_m,
                        phase_rad,
                    });
                }
                _ => {}
            }
        }
        path
    }

    /// Reading for a way from the anchor to the handle of a given length \[m\]; none where the handle
    /// is inside the guide.
    pub(crate) fn reading_m(
        &self,
        way: &Vector3<f64>,
        distance_m: f64,
        at: Instant,
    ) -> Option<f64> {
        let mut length_m = distance_m;
        if self.guide_radius_m > 0.0 || self.twist_m_per_rad2 != 0.0 {
            let along = self.exit_axis.dot(way);
            let across = libm::sqrt(self.exit_axis.cross(way).norm_squared());
            let angle_rad = libm::atan2(across, along);
            if self.guide_radius_m > 0.0 {
                length_m = bent_m(distance_m, angle_rad, self.guide_radius_m)?;
            }
            length_m += self.twist_m_per_rad2 * angle_rad * angle_rad;
        }
        if let Some(drum) = &self.drum {
            length_m = drum.reading_m(length_m, self.home_m);
        }
        Some(
            length_m + self.offset_m + self.m_per_s * at.time_s.max(0.0) + self.m_per_k * at.rise_k,
        )
    }
}

/// Length of a cable that leaves along an axis, bends over a round guide that touches the axis at the
/// exit, and leaves the guide at a tangent to a point at a distance and an angle from the axis.
///
/// Seen from the guide's centre, across the axis at the radius r, the point is at
/// (L cos phi, L sin phi - r): the tangent is s = sqrt(L (L - 2 r sin phi)) long, and the angle wrapped
/// is what the centre's line of sight and the tangent triangle leave. Source: docs/equations.md,
/// Motion simulation.
fn bent_m(distance_m: f64, angle_rad: f64, radius_m: f64) -> Option<f64> {
    let (sine, cosine) = libm::sincos(angle_rad);
    let square = distance_m * (distance_m - 2.0 * radius_m * sine);
    if square <= 0.0 {
        return None;
    }
    let straight_m = libm::sqrt(square);
    let sight_rad = libm::atan2(distance_m * sine - radius_m, distance_m * cosine);
    let mut wrapped_rad = sight_rad + libm::atan2(radius_m, straight_m);
    if wrapped_rad < -PI {
        // the line of sight of a point behind the exit and below the centre
        wrapped_rad += 2.0 * PI;
    }
    Some(straight_m + radius_m * wrapped_rad)
}

impl Drum {
    /// What the encoder shows if the drum has given out a length and was right at home.
    ///
    /// At the angle psi the cable leaves the drum at the radius r + A sin(psi - phase), so it gives out
    /// L = r psi - A cos(psi - phase) + constant; the encoder shows r psi, psi = reading / r.
    fn reading_m(&self, length_m: f64, home_m: f64) -> f64 {
        let bump_m = |angle_rad: f64| self.amplitude_m * libm::cos(angle_rad - self.phase_rad);
        let at_home_m = bump_m(home_m / self.radius_m);
        let mut angle_rad = length_m / self.radius_m;
        for _ in 0..MAX_STEPS {
            let next = (length_m + bump_m(angle_rad) - at_home_m) / self.radius_m;
            let step = (next - angle_rad).abs();
            angle_rad = next;
            if step <= LAST_STEP_RAD {
                break;
            }
        }
        self.radius_m * angle_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_at_a_right_angle_above_the_exit_is_half_a_turn_around_the_guide_less_the_tangent() {
        // at (0, L) with L = 4 r: the centre is (0, r), the point 3 r above it; the tangent's length is
        // sqrt(9 - 1) r and the angle at the centre between sight and tangent point acos(1/3); the
        // cable turns from the lowest point of the guide by pi - acos(1/3)
        let radius_m = 0.005;
        let want = radius_m * (8.0_f64.sqrt() + PI - (1.0_f64 / 3.0).acos());
        let got = bent_m(4.0 * radius_m, PI / 2.0, radius_m).expect("outside the guide");
        assert!((got - want).abs() < 1e-16, "{got} {want}");
    }

    #[test]
    fn straight_out_nothing_is_wrapped_and_a_point_inside_the_guide_has_no_length() {
        let got = bent_m(0.3, 0.0, 0.006).expect("outside the guide");
        assert!((got - 0.3).abs() < 1e-16, "{got}");
        assert_eq!(bent_m(0.009, PI / 2.0, 0.006), None);
    }

    #[test]
    fn a_guide_of_a_small_radius_adds_radius_times_angle_less_sine() {
        let (length_m, angle_rad, radius_m) = (0.5, 0.7, 1e-6);
        let added = bent_m(length_m, angle_rad, radius_m).expect("outside") - length_m;
        assert!((added / radius_m - (0.7 - 0.7_f64.sin())).abs() < 1e-5);
    }

    #[test]
    fn the_length_that_an_eccentric_drum_gives_out_is_the_one_that_went_in() {
        let drum = Drum {
            radius_m: 0.015,
            amplitude_m: 2e-4,
            phase_rad: 0.7,
        };
        let (home_m, length_m) = (0.128, 0.3);
        let psi = drum.reading_m(length_m, home_m) / drum.radius_m;
        // given out: the integral of r + A sin(psi - phase) from home's angle
        let given =
            |psi: f64| drum.radius_m * psi - drum.amplitude_m * (psi - drum.phase_rad).cos();
        let out = given(psi) - given(home_m / drum.radius_m);
        assert!((out - (length_m - home_m)).abs() < 1e-15);
        assert!((drum.reading_m(home_m, home_m) - home_m).abs() < 1e-15);
    }
}
