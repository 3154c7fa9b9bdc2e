//! Errors in time: latencies, lag, drift, lost counts.

use std::f64::consts::TAU;

use crate::effects::{Draw, Effect, Facts, Info, Stage, fixed};
use crate::laws::{delayed, slope_of};
use crate::rig::scene::Scene;
use crate::truth::Event;

/// The signal as it was a while ago.
fn late(info: Info, stage: Stage, delay_s: f64) -> Effect {
    let law = move |scene: &Scene<'_>, signal: &[f64]| {
        let late = delayed(signal, &scene.motion.run, scene.step_s, delay_s);
        late.iter()
            .zip(signal)
            .map(|(late, now)| late - now)
            .collect()
    };
    let facts = Facts::default().with("delay_s", delay_s);
    Effect::added(info, stage, fixed(facts), law)
}

/// Names of a latency of all motors or of the cable: without external encoders either is the other.
fn latency(draw: &Draw<'_>, name: &'static str, other: &'static str) -> Info {
    let mut joints = draw.device.joints.iter();
    match joints.any(|joint| joint.output_sd_rad().is_some()) {
        true => draw.anywhere(name, &[name]),
        false => draw.anywhere(name, &[name, other]),
    }
}

pub(crate) fn cable_latency(draw: &mut Draw<'_>) -> Effect {
    let delay_s = draw.amplitude(4e-3);
    let info = latency(draw, "cable-latency", "encoder-latency");
    late(info, Stage::Cable, delay_s)
}

pub(crate) fn external_latency(draw: &mut Draw<'_>) -> Effect {
    let delay_s = draw.amplitude(4e-3);
    let info = draw.at_joint("external-encoder-latency", &["external-encoder-latency"]);
    late(info, Stage::External, delay_s)
}

pub(crate) fn encoder_latency(draw: &mut Draw<'_>) -> Effect {
    let delay_s = draw.amplitude(4e-3);
    let info = Info {
        // late readings of every motor are a negative lag of every joint, or the others too early
        acceptable: vec!["viscous-lag", "external-encoder-latency", "cable-latency"],
        ..latency(draw, "encoder-latency", "cable-latency")
    };
    let act = move |scene: &Scene<'_>, readings: &mut [Vec<f64>]| {
        for column in readings {
            *column = delayed(column, &scene.motion.run, scene.step_s, delay_s);
        }
    };
    let facts = Facts::default().with("delay_s", delay_s);
    Effect::of_columns(info, Stage::Motor, facts, act)
}

/// Viscous lag of a lubricated cable: the motor leads in proportion to speed, a little less at high speed.
pub(crate) fn viscous_lag(draw: &mut Draw<'_>) -> Effect {
    let delay_s = draw.amplitude(3e-3);
    let thinning_rad_s = draw.random.uniform(15.0, 40.0);
    let joint = draw.joint;
    let law = move |scene: &Scene<'_>, _: &[f64]| -> Vec<f64> {
        let lead = |rate: &f64| delay_s * rate / (1.0 + rate.abs() / thinning_rad_s);
        scene.motion.rate_rad_s[joint].iter().map(lead).collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let effective = slope_of(&scene.motion.rate_rad_s[joint], &law(scene, &[]));
        Facts::default()
            .law("thinning_rad_s", thinning_rad_s)
            .with("delay_s", effective)
    };
    let info = draw.at_joint("viscous-lag", &["viscous-lag"]);
    Effect::added(info, Stage::Upstream, facts, law)
}

/// A power-law drift reaches its size after this time \[s\].
const DRIFT_TIME_S: f64 = 60.0;

/// A zero that moves by a power law of time, with an exponent of 1 up to a tenth.
fn drift(exponent: f64, info: Info, stage: Stage, size: f64, name: &'static str) -> Effect {
    let law = move |scene: &Scene<'_>, signal: &[f64]| -> Vec<f64> {
        let at = |row: usize| size * libm::pow(scene.elapsed_s(row) / DRIFT_TIME_S, exponent);
        (0..signal.len()).map(at).collect()
    };
    let facts = move |scene: &Scene<'_>| {
        let rows = vec![0.0; scene.len()];
        let time: Vec<f64> = (0..rows.len()).map(|row| scene.elapsed_s(row)).collect();
        Facts::default()
            .with(name, slope_of(&time, &law(scene, &rows)))
            .law("exponent", exponent)
    };
    Effect::added(info, stage, facts, law)
}

/// The joint's zero moves, in time or with temperature above that of a cold start.
pub(crate) fn joint_drift(draw: &mut Draw<'_>) -> Effect {
    let info = draw.at_joint("joint-drift", &["joint-drift"]);
    if draw.random.unit() < 0.5 {
        let exponent = draw.random.uniform(0.95, 1.1);
        let size = draw.coarseness() * draw.signed(1.5e-3);
        return drift(exponent, info, Stage::Upstream, size, "rad_per_s");
    }
    let size = draw.coarseness() * draw.signed(1.5e-4);
    let law = move |scene: &Scene<'_>, _: &[f64]| {
        let rows = scene.temperature_degc.iter();
        rows.map(|degc| size * (degc - scene.cold_degc)).collect()
    };
    let facts = Facts::default().with("rad_per_degc", size);
    Effect::added(info, Stage::Upstream, fixed(facts), law)
}

pub(crate) fn external_drift(draw: &mut Draw<'_>) -> Effect {
    let info = draw.at_joint("external-encoder-drift", &["external-encoder-drift"]);
    let exponent = draw.random.uniform(0.95, 1.1);
    let size = draw.signed(1.5e-3);
    drift(exponent, info, Stage::External, size, "rad_per_s")
}

pub(crate) fn cable_drift(draw: &mut Draw<'_>) -> Effect {
    let info = draw.anywhere("cable-drift", &["cable-drift"]);
    let exponent = draw.random.uniform(0.95, 1.1);
    drift(exponent, info, Stage::Cable, draw.signed(400e-6), "m_per_s")
}

/// Length of one count of an encoder, in its signal's unit; 0 where there is none.
fn count(scene: &Scene<'_>, stage: Stage, joint: usize) -> f64 {
    let device = scene.device;
    let count = match stage {
        Stage::Cable => device
            .cables
            .first()
            .and_then(|cable| Some(TAU * cable.drum_radius_m? / cable.counts_per_rev?)),
        Stage::External => {
            let counts = device.joints[joint].external_encoder_counts_per_rev;
            counts.map(|counts| TAU / counts)
        }
        _ => device.joints[joint].reading_quantum_rad(),
    };
    count.unwrap_or(0.0)
}

/// Counts that go missing, once or a few times. Times differ between recordings: one in each part of the middle of the record.
fn count_loss(draw: &mut Draw<'_>, strong_counts: f64, info: Info, stage: Stage) -> Effect {
    let events = 1 + draw.random.index(3);
    let lost =
        (0..events).map(|_| draw.random.sign() * libm::ceil(draw.amplitude(strong_counts) - 0.5));
    let lost: Vec<f64> = lost.collect();
    let (tag, joint) = (draw.tag, draw.joint);
    let events = move |scene: &Scene<'_>| -> Vec<Event> {
        let mut random = scene.events(tag);
        let end_s = scene.elapsed_s(scene.len());
        let (first_s, last_s) = (0.15 * end_s, 0.85 * end_s);
        let part_s = (last_s - first_s) / lost.len() as f64;
        let event = |(event, size): (usize, &f64)| Event {
            time_s: first_s + part_s * (event as f64 + random.uniform(0.1, 0.9)),
            size: *size,
        };
        lost.iter().enumerate().map(event).collect()
    };
    let happened = events.clone();
    let law = move |scene: &Scene<'_>, signal: &[f64]| {
        let (count, events) = (count(scene, stage, joint), happened(scene));
        let off = |row: usize| {
            let time_s = scene.elapsed_s(row);
            let before = events.iter().filter(|event| time_s > event.time_s);
            count * before.map(|event| event.size).sum::<f64>()
        };
        (0..signal.len()).map(off).collect()
    };
    let facts = move |scene: &Scene<'_>| Facts::default().happening("counts", events(scene));
    Effect::added(info, stage, facts, law)
}

/// The motor-side encoder loses counts. A slip of the capstan in one sample looks the same.
pub(crate) fn encoder_count_loss(draw: &mut Draw<'_>) -> Effect {
    let names = ["encoder-count-loss", "capstan-slip"];
    let info = draw.at_joint("encoder-count-loss", &names);
    count_loss(draw, 60.0, info, Stage::Motor)
}

pub(crate) fn external_count_loss(draw: &mut Draw<'_>) -> Effect {
    let name = "external-encoder-count-loss";
    let info = draw.at_joint(name, &[name]);
    count_loss(draw, 8.0, info, Stage::External)
}

pub(crate) fn cable_count_loss(draw: &mut Draw<'_>) -> Effect {
    let info = draw.anywhere("cable-count-loss", &["cable-count-loss"]);
    count_loss(draw, 60.0, info, Stage::Cable)
}
