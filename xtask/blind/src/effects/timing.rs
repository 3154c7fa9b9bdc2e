//! Errors in time: latencies, lag, drift, lost counts.

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts, Info};
use crate::laws::{delayed, slope_of};
use crate::rig::scene::Scene;
use crate::truth::Event;

/// The signal as it was a while ago.
#[derive(Debug)]
struct Delay {
    delay_s: f64,
}

impl Law for Delay {
    fn deviation(&self, scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        delayed(signal, &scene.motion.run, scene.step_s, self.delay_s)
            .iter()
            .zip(signal)
            .map(|(late, now)| late - now)
            .collect()
    }

    fn facts(&self, _scene: &Scene<'_>, _place: Place) -> Facts {
        Facts::default().with("delay_s", self.delay_s)
    }
}

/// The cable's reading is late.
pub(crate) fn cable_latency(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Delay {
        delay_s: draw.amplitude(4e-3),
    };
    let has_external = draw
        .device
        .joints
        .iter()
        .any(|joint| joint.output_sd_rad().is_some());
    let names: &[&'static str] = if has_external {
        &["cable-latency"]
    } else {
        &["cable-latency", "encoder-latency"]
    };
    let info = draw.anywhere("cable-latency", names);
    Added::boxed(info, Place::Cable, law)
}

/// One external encoder is late.
pub(crate) fn external_latency(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Delay {
        delay_s: draw.amplitude(4e-3),
    };
    let info = draw.at_joint("external-encoder-latency", &["external-encoder-latency"]);
    Added::boxed(info, Place::External(draw.joint), law)
}

/// All motor-side encoders are late.
#[derive(Debug)]
struct MotorDelay {
    info: Info,
    delay: Delay,
}

impl Effect for MotorDelay {
    fn info(&self) -> &Info {
        &self.info
    }

    fn facts(&self, scene: &Scene<'_>) -> Facts {
        self.delay.facts(scene, Place::Cable)
    }

    fn motor(&self, scene: &Scene<'_>, reading_rad: &mut [Vec<f64>]) {
        for column in reading_rad {
            *column = delayed(column, &scene.motion.run, scene.step_s, self.delay.delay_s);
        }
    }
}

/// All motor-side encoders are late.
pub(crate) fn encoder_latency(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let delay_s = draw.amplitude(4e-3);
    let has_external = draw
        .device
        .joints
        .iter()
        .any(|joint| joint.output_sd_rad().is_some());
    let names: &[&'static str] = if has_external {
        &["encoder-latency"]
    } else {
        &["encoder-latency", "cable-latency"]
    };
    // late readings of every motor are a negative lag of every joint, or the others too early
    let acceptable = vec!["viscous-lag", "external-encoder-latency", "cable-latency"];
    Box::new(MotorDelay {
        info: Info {
            acceptable,
            ..draw.anywhere("encoder-latency", names)
        },
        delay: Delay { delay_s },
    })
}

/// Lag of a lubricated cable: the motor leads in proportion to speed, a little less at high speed.
#[derive(Debug)]
struct Lag {
    delay_s: f64,
    thinning_rad_s: f64,
}

impl Law for Lag {
    fn deviation(&self, scene: &Scene<'_>, place: Place, _signal: &[f64]) -> Vec<f64> {
        place.joint().map_or_else(Vec::new, |joint| {
            scene.motion.rate_rad_s[joint]
                .iter()
                .map(|rate| self.delay_s * rate / (1.0 + rate.abs() / self.thinning_rad_s))
                .collect()
        })
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let facts = Facts::default().law("thinning_rad_s", self.thinning_rad_s);
        let Some(joint) = place.joint() else {
            return facts;
        };
        let rate = &scene.motion.rate_rad_s[joint];
        facts.with(
            "delay_s",
            slope_of(rate, &self.deviation(scene, place, &[])),
        )
    }
}

/// Viscous lag between motor and joint.
pub(crate) fn viscous_lag(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Lag {
        delay_s: draw.amplitude(3e-3),
        thinning_rad_s: draw.random.uniform(15.0, 40.0),
    };
    let info = draw.at_joint("viscous-lag", &["viscous-lag"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// What a drift follows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Clock {
    /// Time: a power law.
    Time { exponent: f64 },
    /// Temperature above that of a cold start.
    Temperature,
}

/// A slow change of zero.
#[derive(Debug)]
struct Drift {
    clock: Clock,
    /// At the end of a minute, or per kelvin.
    size: f64,
    /// Names of the rates per second and per kelvin.
    names: [&'static str; 2],
}

/// A power-law drift reaches its size after this time \[s\].
const DRIFT_TIME_S: f64 = 60.0;

impl Law for Drift {
    fn deviation(&self, scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        (0..signal.len())
            .map(|row| {
                self.size
                    * match self.clock {
                        Clock::Time { exponent } => {
                            libm::pow(scene.elapsed_s(row) / DRIFT_TIME_S, exponent)
                        }
                        Clock::Temperature => scene.temperature_degc[row] - scene.cold_degc,
                    }
            })
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, place: Place) -> Facts {
        let rows = vec![0.0; scene.len()];
        let deviation = self.deviation(scene, place, &rows);
        match self.clock {
            Clock::Time { exponent } => {
                let time: Vec<f64> = (0..rows.len()).map(|row| scene.elapsed_s(row)).collect();
                Facts::default()
                    .with(self.names[0], slope_of(&time, &deviation))
                    .law("exponent", exponent)
            }
            Clock::Temperature => Facts::default().with(self.names[1], self.size),
        }
    }
}

/// A clock whose exponent is 1 up to a tenth.
fn time_clock(draw: &mut Draw<'_>) -> Clock {
    Clock::Time {
        exponent: draw.random.uniform(0.95, 1.1),
    }
}

/// The joint's zero moves, in time or with temperature.
pub(crate) fn joint_drift(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = if draw.random.unit() < 0.5 {
        Drift {
            clock: time_clock(draw),
            size: draw.coarseness() * draw.signed(1.5e-3),
            names: ["rad_per_s", "rad_per_degc"],
        }
    } else {
        Drift {
            clock: Clock::Temperature,
            size: draw.coarseness() * draw.signed(1.5e-4),
            names: ["rad_per_s", "rad_per_degc"],
        }
    };
    let info = draw.at_joint("joint-drift", &["joint-drift"]);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// The external encoder's zero moves.
pub(crate) fn external_drift(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Drift {
        clock: time_clock(draw),
        size: draw.signed(1.5e-3),
        names: ["rad_per_s", ""],
    };
    let info = draw.at_joint("external-encoder-drift", &["external-encoder-drift"]);
    Added::boxed(info, Place::External(draw.joint), law)
}

/// The cable encoder's zero moves.
pub(crate) fn cable_drift(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Drift {
        clock: time_clock(draw),
        size: draw.signed(400e-6),
        names: ["m_per_s", ""],
    };
    let info = draw.anywhere("cable-drift", &["cable-drift"]);
    Added::boxed(info, Place::Cable, law)
}

/// Counts that go missing, once or a few times.
#[derive(Debug)]
struct CountLoss {
    counts: Vec<f64>,
    tag: u64,
}

impl CountLoss {
    fn draw(draw: &mut Draw<'_>, counts: f64) -> Self {
        let events = 1 + draw.random.index(3);
        Self {
            counts: (0..events)
                .map(|_| draw.random.sign() * libm::ceil(draw.amplitude(counts) - 0.5))
                .collect(),
            tag: draw.tag,
        }
    }

    /// Times differ between recordings: one in each part of the middle of the record.
    fn times_s(&self, scene: &Scene<'_>) -> Vec<f64> {
        let mut random = scene.events(self.tag);
        let (first_s, last_s) = (
            0.15 * scene.elapsed_s(scene.len()),
            0.85 * scene.elapsed_s(scene.len()),
        );
        let part_s = (last_s - first_s) / self.counts.len() as f64;
        (0..self.counts.len())
            .map(|event| first_s + part_s * (event as f64 + random.uniform(0.1, 0.9)))
            .collect()
    }
}

impl Law for CountLoss {
    fn deviation(&self, scene: &Scene<'_>, place: Place, signal: &[f64]) -> Vec<f64> {
        let count = place.count(scene);
        let times = self.times_s(scene);
        (0..signal.len())
            .map(|row| {
                let time_s = scene.elapsed_s(row);
                let lost = times.iter().zip(&self.counts);
                count
                    * lost
                        .filter(|(at, _)| time_s > **at)
                        .map(|(_, counts)| counts)
                        .sum::<f64>()
            })
            .collect()
    }

    fn facts(&self, scene: &Scene<'_>, _place: Place) -> Facts {
        let times = self.times_s(scene).into_iter();
        let events = times.zip(&self.counts).map(|(time_s, counts)| Event {
            time_s,
            size: *counts,
        });
        let mut facts = Facts {
            events: events.collect(),
            ..Facts::default()
        };
        if let [event] = &facts.events[..] {
            let (time_s, size) = (event.time_s, event.size);
            facts = facts.with("counts", size).with("time_s", time_s);
        }
        facts
    }
}

/// The motor-side encoder loses counts. A slip of the capstan in one sample looks the same.
pub(crate) fn encoder_count_loss(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = CountLoss::draw(draw, 60.0);
    let names = ["encoder-count-loss", "capstan-slip"];
    let info = draw.at_joint("encoder-count-loss", &names);
    Added::boxed(info, Place::Motor(draw.joint), law)
}

/// The external encoder loses counts.
pub(crate) fn external_count_loss(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = CountLoss::draw(draw, 8.0);
    let names = ["external-encoder-count-loss"];
    let info = draw.at_joint("external-encoder-count-loss", &names);
    Added::boxed(info, Place::External(draw.joint), law)
}

/// The cable's encoder loses counts.
pub(crate) fn cable_count_loss(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = CountLoss::draw(draw, 60.0);
    let info = draw.anywhere("cable-count-loss", &["cable-count-loss"]);
    Added::boxed(info, Place::Cable, law)
}
