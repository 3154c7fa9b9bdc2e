//! Your own effect: a scratch on an encoder's disk, which the catalogue does not have, is tested with it and named.
//!
//! `cargo run -p haptical --example own_effect`
#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use haptical::effects::{Context, Effect, Family, Follows, Hook, Parameter, Signal, Spec};
use haptical::prelude::*;
use haptical::simulator::{Effects, HandMotion, MotionSettings, record_motion};

const DEVICE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../fixtures/devices/haptic7.toml"
);

const SCRATCH: Spec = Spec {
    name: "encoder-scratch",
    meaning: "the external encoder reads wrong over a scratch near home",
    inspect: "the disk of the encoder",
    hook: Hook::ExternalEncoder,
    parameters: &[Parameter::size("depth_rad", 0.0, 0.01)],
    follows: Follows::Angle,
    ..Spec::of(Family::Shape)
};

#[derive(Debug)]
struct Scratch {
    joint: usize,
}

/// Reading error of a scratch of depth 1.
fn scratch(angle_rad: &f64) -> f64 {
    (-(angle_rad / 0.1).powi(2)).exp()
}

impl Effect for Scratch {
    fn spec(&self) -> &'static Spec {
        &SCRATCH
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let error: Vec<f64> = context.output[self.joint].iter().map(scratch).collect();
        vec![context.encoder(self.joint, &error)]
    }
}

fn scratches(device: &haptical::model::Device) -> Vec<Box<dyn Effect>> {
    let joints = 0..device.joints.len();
    joints
        .map(|joint| Box::new(Scratch { joint }) as _)
        .collect()
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let device = Device::load(DEVICE)?;
    let motion = HandMotion {
        seconds: 60.0,
        rate_hz: 20.0,
        ..HandMotion::default()
    };
    let settings = MotionSettings {
        motion,
        ..MotionSettings::default()
    };
    let mut recording = record_motion(&device.model, &Effects::default(), &settings, 1)?;
    for reading in recording.output[1].iter_mut().flatten() {
        *reading += 2e-3 * scratch(reading);
    }
    let log = Log::from_recording(recording, "a hand's motion", &device)?;
    let request = Diagnose {
        own_effects: Some(scratches),
        ..Diagnose::default()
    };
    let gap = diagnose(&device, &log, &request)?;
    println!("{gap}");
    let cause = gap.named().ok_or("no cause is named")?;
    assert_eq!(
        (cause.0.effect.as_str(), cause.0.joint),
        ("encoder-scratch", Some(2))
    );
    Ok(())
}
