//! A joint that follows its command only once the error is large enough: Prandtl's element (Prandtl 1928) of half width b,
//! z <- min(max(z, u - b), u + b).
//!
//! A proportional servo K against Coulomb friction F rests wherever |K (u - x)| <= F, so b = F / K (Armstrong-Helouvry, Dupont &
//! Canudas de Wit, Automatica 30, 1994, 2.4). A dead zone of the controller and a play in front of the sensor have the same
//! course.

use std::ops::Range;

/// Friction of the gears against a finite gain.
pub(crate) const NAME: &str = "joint-friction";
/// The controller's own.
pub(crate) const DEAD_ZONE: &str = "dead-zone";
/// In front of the sensor.
pub(crate) const BACKLASH: &str = "backlash";

/// Lets a piece be followed from `first` on, in place.
pub(crate) fn followed(piece: Range<usize>, half_width: f64, first: f64, input: &mut [f64]) {
    if half_width <= 0.0 {
        return;
    }
    let mut at = first;
    for value in &mut input[piece] {
        at = at.clamp(*value - half_width, *value + half_width);
        *value = at;
    }
}
