//! Friction that depends on speed, load, direction, time or angle.

use super::{Draw, Drawn, Levels, Sliding};
use crate::moving::motion::specimen::{Sense, Specimen};

/// Changes the levels of the drive of the joint.
fn levels(
    draw: &Draw<'_>,
    change: impl Fn(&Sliding, &mut Levels) + Send + Sync + 'static,
) -> Drawn {
    let joint = draw.joint;
    let of_joint = move |sliding: &Sliding, levels: &mut Levels| {
        if sliding.joint == joint {
            change(sliding, levels);
        }
    };
    Drawn::new(|drawn| drawn.friction = Box::new(of_joint)).at(joint)
}

impl Levels {
    fn scale(&mut self, factor: f64) {
        self.coulomb *= factor;
        self.viscous *= factor;
    }
}

/// Higher near rest: `extra / (1 + (v / speed)^2)`. Source: Hess & Soom, "Friction at a lubricated line contact operating at
/// oscillating sliding velocities", Journal of Tribology 112, 1990.
pub(crate) fn stribeck(draw: &mut Draw<'_>) -> Drawn {
    let extra = draw.of_range(0.06, 0.1);
    let speed = draw.top_speed() * draw.random.uniform(0.05, 0.12);
    levels(draw, move |sliding, levels| {
        let ratio = sliding.speed / speed;
        levels.coulomb += extra / (1.0 + ratio * ratio);
    })
    .with_all(named!(extra, speed))
}

/// Grows with what the motor exerts: `share sqrt(tau^2 + small^2)`.
pub(crate) fn load(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.14, 0.28);
    let small = 0.01 * draw.arm.axes[draw.joint].range;
    levels(draw, move |sliding, levels| {
        levels.coulomb += share * libm::sqrt(sliding.drive * sliding.drive + small * small);
    })
    .with("share", share)
}

/// More one way than the other, Coulomb's part and the viscous one alike.
pub(crate) fn asymmetry(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.random.sign() * draw.size * draw.random.uniform(0.35, 0.6);
    let range = draw.arm.axes[draw.joint].range;
    let viscous = range * draw.random.uniform(0.08, 0.13) / draw.top_speed();
    let joint = draw.joint;
    let prepare = move |specimen: &mut Specimen| specimen.friction[joint].viscous = viscous;
    let mut drawn = levels(draw, move |sliding, levels| {
        levels.scale(1.0 + share * sliding.speed.signum());
    });
    drawn.prepare = Box::new(prepare);
    drawn.with("share", share).with("viscous", viscous)
}

/// Grease that warms: `1 + share exp(-t / time)`.
pub(crate) fn drift(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.9, 1.6);
    let time_s = draw.duration_s * draw.random.uniform(0.25, 0.5);
    levels(draw, move |sliding, levels| {
        levels.scale(1.0 + share * libm::exp(-sliding.time_s / time_s));
    })
    .with_all(named!(share, time_s))
}

/// A bristle that yields over a long way.
pub(crate) fn presliding(draw: &mut Draw<'_>) -> Drawn {
    let level = draw.arm.axes[draw.joint].range * draw.random.uniform(0.04, 0.06);
    let length = draw.size * draw.top_speed() * draw.random.uniform(0.008, 0.02);
    let joint = draw.joint;
    let prepare = move |specimen: &mut Specimen| {
        let friction = &mut specimen.friction[joint];
        friction.coulomb = friction.coulomb.max(level);
    };
    let build =
        move |specimen: &mut Specimen| specimen.friction[joint].sense = Sense::Bristle { length };
    Drawn::new(|drawn| (drawn.prepare, drawn.build) = (Box::new(prepare), Box::new(build)))
        .at(joint)
        .with_all(named!(level, length))
}

/// A bearing with a dent: more near one angle.
pub(crate) fn dent(draw: &mut Draw<'_>) -> Drawn {
    let extra = draw.of_range(0.06, 0.1);
    let share = draw.random.uniform(0.3, 0.7);
    let angle = draw.angle_at(share);
    let wide = draw.angle_at(0.95) - draw.angle_at(0.05);
    let width = wide * draw.random.uniform(0.04, 0.09);
    levels(draw, move |sliding, levels| {
        let off = (sliding.angle - angle) / width;
        levels.coulomb += extra * libm::exp(-0.5 * off * off);
    })
    .with_all(named!(extra, angle, width))
}

/// Coulomb friction that rises and falls along the way: `level (1 + sin(waves q + phase)) / 2`.
pub(crate) fn waves(draw: &mut Draw<'_>) -> Drawn {
    let level = draw.of_range(0.02, 0.05);
    let wide = draw.angle_at(0.95) - draw.angle_at(0.05);
    let waves = std::f64::consts::TAU / (wide * draw.random.uniform(0.2, 0.45));
    let phase_rad = draw.random.phase_rad();
    levels(draw, move |sliding, levels| {
        levels.coulomb += 0.5 * level * (1.0 + libm::sin(waves * sliding.angle + phase_rad));
    })
    .with_all(named!(level, waves, phase_rad))
}

/// A bristle that yields over several hundredths of the way, of 2 to 5 % of the range.
pub(crate) fn slow_bristle(draw: &mut Draw<'_>) -> Drawn {
    let level = draw.of_range(0.02, 0.05);
    let length = draw.top_speed() * draw.random.uniform(0.05, 0.12);
    let joint = draw.joint;
    let prepare = move |specimen: &mut Specimen| specimen.friction[joint].coulomb = level;
    let build =
        move |specimen: &mut Specimen| specimen.friction[joint].sense = Sense::Bristle { length };
    Drawn::new(|drawn| (drawn.prepare, drawn.build) = (Box::new(prepare), Box::new(build)))
        .at(joint)
        .with_all(named!(level, length))
}

/// A dent of half the depth.
pub(crate) fn shallow_dent(draw: &mut Draw<'_>) -> Drawn {
    draw.size *= 0.5;
    dent(draw)
}
