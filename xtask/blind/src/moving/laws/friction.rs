//! Friction that depends on speed, load, direction, time or angle.

use super::{Draw, Drawn, Law, Levels, Sliding};
use crate::moving::motion::specimen::{Sense, Specimen};

/// Higher near rest: `extra / (1 + (v / speed)^2)`. Source: Hess & Soom, "Friction at a lubricated line contact operating at
/// oscillating sliding velocities", Journal of Tribology 112, 1990.
#[derive(Debug)]
struct Stribeck {
    joint: usize,
    extra: f64,
    speed: f64,
}

impl Law for Stribeck {
    fn friction(&self, sliding: &Sliding, levels: &mut Levels) {
        if sliding.joint == self.joint {
            let ratio = sliding.speed / self.speed;
            levels.coulomb += self.extra / (1.0 + ratio * ratio);
        }
    }
}

pub(crate) fn stribeck(draw: &mut Draw<'_>) -> Drawn {
    let extra = draw.of_range(0.06, 0.1);
    let speed = draw.top_speed() * draw.random.uniform(0.05, 0.12);
    Drawn::new(Stribeck {
        joint: draw.joint,
        extra,
        speed,
    })
    .at(draw.joint)
    .with("extra", extra)
    .with("speed", speed)
}

/// Grows with what the motor exerts: `share sqrt(tau^2 + small^2)`.
#[derive(Debug)]
struct Load {
    joint: usize,
    share: f64,
    small: f64,
}

impl Law for Load {
    fn friction(&self, sliding: &Sliding, levels: &mut Levels) {
        if sliding.joint == self.joint {
            levels.coulomb +=
                self.share * libm::sqrt(sliding.drive * sliding.drive + self.small * self.small);
        }
    }
}

pub(crate) fn load(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.14, 0.28);
    let small = 0.01 * draw.arm.axes[draw.joint].range;
    Drawn::new(Load {
        joint: draw.joint,
        share,
        small,
    })
    .at(draw.joint)
    .with("share", share)
}

/// More one way than the other, Coulomb's part and the viscous one alike.
#[derive(Debug)]
struct OneWay {
    joint: usize,
    share: f64,
    viscous: f64,
}

impl Law for OneWay {
    fn friction(&self, sliding: &Sliding, levels: &mut Levels) {
        if sliding.joint == self.joint {
            let factor = 1.0 + self.share * sliding.speed.signum();
            levels.coulomb *= factor;
            levels.viscous *= factor;
        }
    }

    fn prepare(&self, specimen: &mut Specimen) {
        specimen.friction[self.joint].viscous = self.viscous;
    }
}

pub(crate) fn asymmetry(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.random.sign() * draw.size * draw.random.uniform(0.35, 0.6);
    let range = draw.arm.axes[draw.joint].range;
    let viscous = range * draw.random.uniform(0.08, 0.13) / draw.top_speed();
    Drawn::new(OneWay {
        joint: draw.joint,
        share,
        viscous,
    })
    .at(draw.joint)
    .with("share", share)
    .with("viscous", viscous)
}

/// Grease that warms: `1 + share exp(-t / time)`.
#[derive(Debug)]
struct Warming {
    joint: usize,
    share: f64,
    time_s: f64,
}

impl Law for Warming {
    fn friction(&self, sliding: &Sliding, levels: &mut Levels) {
        if sliding.joint == self.joint {
            let factor = 1.0 + self.share * libm::exp(-sliding.time_s / self.time_s);
            levels.coulomb *= factor;
            levels.viscous *= factor;
        }
    }
}

pub(crate) fn drift(draw: &mut Draw<'_>) -> Drawn {
    let share = draw.size * draw.random.uniform(0.9, 1.6);
    let time_s = draw.duration_s * draw.random.uniform(0.25, 0.5);
    Drawn::new(Warming {
        joint: draw.joint,
        share,
        time_s,
    })
    .at(draw.joint)
    .with("share", share)
    .with("time_s", time_s)
}

/// A bristle that yields over a long way.
#[derive(Debug)]
struct Long {
    joint: usize,
    level: f64,
    length: f64,
}

impl Law for Long {
    fn prepare(&self, specimen: &mut Specimen) {
        let own = &mut specimen.friction[self.joint];
        own.coulomb = own.coulomb.max(self.level);
    }

    fn build(&self, specimen: &mut Specimen) {
        specimen.friction[self.joint].sense = Sense::Bristle {
            length: self.length,
        };
    }
}

pub(crate) fn presliding(draw: &mut Draw<'_>) -> Drawn {
    let level = draw.arm.axes[draw.joint].range * draw.random.uniform(0.04, 0.06);
    let length = draw.size * draw.top_speed() * draw.random.uniform(0.008, 0.02);
    Drawn::new(Long {
        joint: draw.joint,
        level,
        length,
    })
    .at(draw.joint)
    .with("level", level)
    .with("length", length)
}

/// A bearing with a dent: more near one angle.
#[derive(Debug)]
struct Dent {
    joint: usize,
    extra: f64,
    angle: f64,
    width: f64,
}

impl Law for Dent {
    fn friction(&self, sliding: &Sliding, levels: &mut Levels) {
        if sliding.joint == self.joint {
            let off = (sliding.angle - self.angle) / self.width;
            levels.coulomb += self.extra * libm::exp(-0.5 * off * off);
        }
    }
}

pub(crate) fn dent(draw: &mut Draw<'_>) -> Drawn {
    let extra = draw.of_range(0.06, 0.1);
    let share = draw.random.uniform(0.3, 0.7);
    let angle = draw.angle_at(share);
    let wide = draw.angle_at(0.95) - draw.angle_at(0.05);
    let width = wide * draw.random.uniform(0.04, 0.09);
    Drawn::new(Dent {
        joint: draw.joint,
        extra,
        angle,
        width,
    })
    .at(draw.joint)
    .with("extra", extra)
    .with("angle", angle)
    .with("width", width)
}
