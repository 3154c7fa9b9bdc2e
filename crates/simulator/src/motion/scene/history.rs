//! Transmission parts that remember which way they came: play and friction in a loop.

/// Play between two parts: Prandtl's element (Visintin, *Differential Models of Hysteresis*, chapter
/// III). The follower stays where it is while the leader crosses the gap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Play {
    half_width: f64,
    place: Option<f64>,
}

impl Play {
    /// Play of a total width; the leader starts in the middle of the gap.
    pub(crate) fn new(width: f64) -> Self {
        Self {
            half_width: width / 2.0,
            place: None,
        }
    }

    /// Place of the follower once the leader is at `leader`.
    pub(crate) fn follow(&mut self, leader: f64) -> f64 {
        let before = self.place.unwrap_or(leader);
        let place = before.clamp(leader - self.half_width, leader + self.half_width);
        self.place = Some(place);
        place
    }
}

/// Friction that builds up over a transition: Dahl's element with exponent 1 (Dahl, "Solid friction
/// damping of mechanical vibrations", AIAA Journal 1976), dz = (sgn dx - z) |dx| / w, exact for a
/// way in one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction {
    transition: f64,
    state: f64,
    place: Option<f64>,
}

impl Friction {
    /// Friction with a transition (in units of the way), without strain at first.
    pub(crate) fn new(transition: f64) -> Self {
        Self {
            transition,
            state: 0.0,
            place: None,
        }
    }

    /// Share of the full friction, -1 to 1, once the part is at `place`.
    pub(crate) fn move_to(&mut self, place: f64) -> f64 {
        let way = place - self.place.unwrap_or(place);
        self.place = Some(place);
        if way != 0.0 {
            let direction = way.signum();
            let kept = libm::exp(-way.abs() / self.transition);
            self.state = direction + (self.state - direction) * kept;
        }
        self.state
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-14;

    #[test]
    fn a_play_follows_half_its_width_behind_and_stays_while_the_gap_is_crossed() {
        let mut play = Play::new(0.2);
        let places: Vec<f64> = [0.0, 0.05, 0.5, 0.45, 0.32, 0.2]
            .into_iter()
            .map(|leader| play.follow(leader))
            .collect();
        for (got, want) in places.iter().zip([0.0, 0.0, 0.4, 0.4, 0.4, 0.3]) {
            assert!((got - want).abs() < ROUNDING, "{places:?}");
        }
    }

    #[test]
    fn friction_saturates_and_does_not_depend_on_the_steps_of_the_way() {
        let mut coarse = Friction::new(0.1);
        let mut fine = Friction::new(0.1);
        coarse.move_to(0.0);
        fine.move_to(0.0);
        let mut state = 0.0;
        for step in 1..=50 {
            state = fine.move_to(0.01 * f64::from(step) / 5.0);
        }
        assert!((coarse.move_to(0.1) - state).abs() < ROUNDING);
        assert!((state - (1.0 - libm::exp(-1.0))).abs() < ROUNDING);
        assert!((coarse.move_to(3.0) - 1.0).abs() < 1e-12);
        // back by w ln 2 it is zero again
        let back = 3.0 - 0.1 * std::f64::consts::LN_2;
        assert!(coarse.move_to(back).abs() < 1e-12);
    }
}
