//! What sensors, recorder and controller do that their user does not know of.

use super::{Draw, Drawn};
use crate::moving::motion::control::TICKS_PER_S;
use crate::moving::motion::log::Ticks;
use crate::random::Random;

/// A current sensor's characteristic.
fn reading(draw: &Draw<'_>, read: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Drawn {
    let joint = draw.joint;
    let change = move |ticks: &mut Ticks| {
        for torque in &mut ticks.torque[joint] {
            *torque = read(*torque);
        }
    };
    Drawn::new(|drawn| drawn.readings = Box::new(change)).at(joint)
}

/// A scale that is off by 20 to 45 %.
pub(crate) fn gain(draw: &mut Draw<'_>) -> Drawn {
    let factor = 1.0 + draw.random.sign() * draw.size * draw.random.uniform(0.2, 0.45);
    reading(draw, move |torque| torque * factor).with("factor", factor)
}

/// A scale in a wrong unit: four times too large, or four times too small.
pub(crate) fn gain_of_four(draw: &mut Draw<'_>) -> Drawn {
    let factor = if draw.random.unit() < 0.5 { 4.0 } else { 0.25 };
    reading(draw, move |torque| torque * factor).with("factor", factor)
}

pub(crate) fn offset(draw: &mut Draw<'_>) -> Drawn {
    let offset = draw.random.sign() * draw.of_range(0.05, 0.1);
    reading(draw, move |torque| torque + offset).with("offset", offset)
}

/// Readings that end at 45 to 65 % of what the bodies need at most.
pub(crate) fn saturation(draw: &mut Draw<'_>) -> Drawn {
    let limit = draw.peak() * (1.0 - draw.size * draw.random.uniform(0.35, 0.55));
    reading(draw, move |torque| torque.clamp(-limit, limit)).with("limit", limit)
}

/// Nothing below a torque.
pub(crate) fn dead_band(draw: &mut Draw<'_>) -> Drawn {
    let width = draw.of_range(0.05, 0.09);
    reading(draw, move |torque| {
        torque.signum() * (torque.abs() - width).max(0.0)
    })
    .with("width", width)
}

/// All angles are logged late, torques on time.
pub(crate) fn encoder_latency(draw: &mut Draw<'_>) -> Drawn {
    let delay_s = draw.size * draw.random.uniform(0.012, 0.03);
    let late = move |ticks: &mut Ticks| ticks.delay_angles(delay_s, TICKS_PER_S);
    Drawn::new(|drawn| drawn.readings = Box::new(late)).with("delay_s", delay_s)
}

pub(crate) fn command_latency(draw: &mut Draw<'_>) -> Drawn {
    let delay_s = draw.size * draw.random.uniform(0.004, 0.012);
    Drawn::new(|drawn| drawn.command_delay_s = delay_s).with("delay_s", delay_s)
}

/// A controller that is softer for a while.
pub(crate) fn controller_mode(draw: &mut Draw<'_>) -> Drawn {
    let from_s = draw.duration_s * draw.random.uniform(0.3, 0.5);
    let until_s = draw.duration_s * draw.random.uniform(0.7, 1.1);
    let factor = 1.0 - draw.size * draw.random.uniform(0.4, 0.65);
    let gains = move |time_s: f64| match time_s > from_s && time_s < until_s {
        true => [factor, libm::sqrt(factor)],
        false => [1.0, 1.0],
    };
    Drawn::new(|drawn| drawn.gains = Box::new(gains)).with_all(named!(from_s, until_s, factor))
}

/// A recorder that shows a row twice, in the place of the next one.
pub(crate) fn repeated(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.02, 0.06);
    let repeat = move |rows: &mut Vec<usize>, random: &mut Random| {
        for row in 1..rows.len() {
            if random.unit() < share {
                rows[row] = rows[row - 1];
            }
        }
    };
    Drawn::new(|drawn| drawn.rows = Box::new(repeat)).with("share", share)
}

/// A recorder that loses up to four rows at a time and counts on as if none was lost.
pub(crate) fn dropped(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.004, 0.01);
    let lose = move |rows: &mut Vec<usize>, random: &mut Random| {
        let mut lost = 0;
        rows.retain(|_| {
            if lost > 0 {
                lost -= 1;
                return false;
            }
            if random.unit() < share {
                lost = 1 + random.index(4);
            }
            true
        });
    };
    Drawn::new(|drawn| drawn.rows = Box::new(lose)).with("share", share)
}
