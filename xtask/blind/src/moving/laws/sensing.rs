//! What sensors, recorder and controller do that their user does not know of.

use super::{Draw, Drawn, Law};
use crate::moving::motion::control::TICKS_PER_S;
use crate::moving::motion::log::Ticks;
use crate::random::Random;

/// A current sensor's characteristic.
#[derive(Debug)]
enum Reading {
    Factor(f64),
    Offset(f64),
    /// Nothing beyond it.
    Limit(f64),
    /// Nothing below it.
    DeadBand(f64),
}

#[derive(Debug)]
struct Torque {
    joint: usize,
    reading: Reading,
}

impl Law for Torque {
    fn readings(&self, ticks: &mut Ticks) {
        for torque in &mut ticks.torque[self.joint] {
            *torque = match self.reading {
                Reading::Factor(factor) => *torque * factor,
                Reading::Offset(offset) => *torque + offset,
                Reading::Limit(limit) => torque.clamp(-limit, limit),
                Reading::DeadBand(width) => torque.signum() * (torque.abs() - width).max(0.0),
            };
        }
    }
}

fn reading(draw: &Draw<'_>, reading: Reading) -> Drawn {
    Drawn::new(Torque {
        joint: draw.joint,
        reading,
    })
    .at(draw.joint)
}

/// A scale that is off by 20 to 45 %.
pub(crate) fn gain(draw: &mut Draw<'_>) -> Drawn {
    let factor = 1.0 + draw.random.sign() * draw.size * draw.random.uniform(0.2, 0.45);
    reading(draw, Reading::Factor(factor)).with("factor", factor)
}

/// A scale in a wrong unit: four times too large, or four times too small.
pub(crate) fn gain_of_four(draw: &mut Draw<'_>) -> Drawn {
    let factor = if draw.random.unit() < 0.5 { 4.0 } else { 0.25 };
    reading(draw, Reading::Factor(factor)).with("factor", factor)
}

pub(crate) fn offset(draw: &mut Draw<'_>) -> Drawn {
    let offset = draw.random.sign() * draw.of_range(0.05, 0.1);
    reading(draw, Reading::Offset(offset)).with("offset", offset)
}

/// Readings that end at 45 to 65 % of what the bodies need at most.
pub(crate) fn saturation(draw: &mut Draw<'_>) -> Drawn {
    let limit = draw.peak() * (1.0 - draw.size * draw.random.uniform(0.35, 0.55));
    reading(draw, Reading::Limit(limit)).with("limit", limit)
}

pub(crate) fn dead_band(draw: &mut Draw<'_>) -> Drawn {
    let width = draw.of_range(0.05, 0.09);
    reading(draw, Reading::DeadBand(width)).with("width", width)
}

/// All angles are logged late, torques on time.
#[derive(Debug)]
struct Late(f64);

impl Law for Late {
    fn readings(&self, ticks: &mut Ticks) {
        ticks.delay_angles(self.0, TICKS_PER_S);
    }
}

pub(crate) fn encoder_latency(draw: &mut Draw<'_>) -> Drawn {
    let delay_s = draw.size * draw.random.uniform(0.012, 0.03);
    Drawn::new(Late(delay_s)).with("delay_s", delay_s)
}

/// The controller hears its command late.
#[derive(Debug)]
struct Unheard(f64);

impl Law for Unheard {
    fn command_delay_s(&self) -> f64 {
        self.0
    }
}

pub(crate) fn command_latency(draw: &mut Draw<'_>) -> Drawn {
    let delay_s = draw.size * draw.random.uniform(0.004, 0.012);
    Drawn::new(Unheard(delay_s)).with("delay_s", delay_s)
}

/// A controller that is softer for a while.
#[derive(Debug)]
struct Softer {
    from_s: f64,
    until_s: f64,
    factors: [f64; 2],
}

impl Law for Softer {
    fn gains(&self, time_s: f64) -> [f64; 2] {
        let is_soft = time_s > self.from_s && time_s < self.until_s;
        if is_soft { self.factors } else { [1.0, 1.0] }
    }
}

pub(crate) fn controller_mode(draw: &mut Draw<'_>) -> Drawn {
    let from_s = draw.duration_s * draw.random.uniform(0.3, 0.5);
    let until_s = draw.duration_s * draw.random.uniform(0.7, 1.1);
    let factor = 1.0 - draw.size * draw.random.uniform(0.4, 0.65);
    let law = Softer {
        from_s,
        until_s,
        factors: [factor, libm::sqrt(factor)],
    };
    Drawn::new(law)
        .with("from_s", from_s)
        .with("until_s", until_s)
        .with("factor", factor)
}

/// A recorder that shows a row twice, in the place of the next one.
#[derive(Debug)]
struct Repeats(f64);

impl Law for Repeats {
    fn rows(&self, rows: &mut Vec<usize>, random: &mut Random) {
        for row in 1..rows.len() {
            if random.unit() < self.0 {
                rows[row] = rows[row - 1];
            }
        }
    }
}

pub(crate) fn repeated(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.02, 0.06);
    Drawn::new(Repeats(share)).with("share", share)
}

/// A recorder that loses rows and counts on as if none was lost.
#[derive(Debug)]
struct Losses {
    share: f64,
    most: usize,
}

impl Law for Losses {
    fn rows(&self, rows: &mut Vec<usize>, random: &mut Random) {
        let mut kept = Vec::with_capacity(rows.len());
        let mut lost = 0;
        for row in rows.iter() {
            if lost > 0 {
                lost -= 1;
                continue;
            }
            kept.push(*row);
            if random.unit() < self.share {
                lost = 1 + random.index(self.most);
            }
        }
        *rows = kept;
    }
}

pub(crate) fn dropped(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.004, 0.01);
    Drawn::new(Losses { share, most: 4 }).with("share", share)
}
