//! Fits that need many steps, and one that finds no minimum.

use haptical_diagnosis::{Diagnosis, Options, Verdict, diagnose};
use haptical_effects::{Context, Effect, Family, Follows, Hook, Parameter, Signal, Spec};
use haptical_model::Device;

use crate::arm::{Errors, Session, assert_named, assert_near, device, record, summary};

/// Joint (from 0) whose external encoder has a scratched disk.
const SCRATCHED: usize = 1;
/// What the scratch adds at home \[rad\].
const ERROR_RAD: f64 = 2e-3;

const SPEC: Spec = Spec {
    name: "encoder-scratch",
    meaning: "the external encoder reads wrong over a scratch near home",
    inspect: "the disk of the encoder",
    hook: Hook::ExternalEncoder,
    parameters: &[Parameter::size("depth", 0.0, 1e12)],
    follows: Follows::Angle,
    ..Spec::of(Family::Shape)
};

/// A scratch whose error is a function of its depth.
#[derive(Debug)]
struct Scratch {
    joint: usize,
    /// Error at home \[rad\], and its derivative.
    law: fn(f64) -> (f64, f64),
}

/// Reading error of a scratch, relative to that at home.
fn scratch(angle_rad: f64) -> f64 {
    (-(angle_rad / 0.1).powi(2)).exp()
}

impl Scratch {
    fn entering(&self, context: &Context<'_>, size_rad: f64) -> Signal {
        let angles = context.output[self.joint].iter();
        let error: Vec<f64> = angles.map(|angle| size_rad * scratch(*angle)).collect();
        context.encoder(self.joint, &error)
    }
}

impl Effect for Scratch {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        vec![self.entering(context, (self.law)(amplitudes[0]).1)]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        self.entering(context, (self.law)(amplitudes[0]).0)
    }
}

/// Depth from which on the error grows with the logarithm alone: a twentieth of what is there.
const DEPTH: f64 = ERROR_RAD / 20.0;

/// An error that grows ever more slowly with the depth: each Gauss-Newton step multiplies the depth by some factor.
fn logarithmic(depth: f64) -> (f64, f64) {
    let ratio = 1.0 + depth.max(0.0) / DEPTH;
    (DEPTH * ratio.ln(), 1.0 / ratio)
}

/// An error that stops growing before it is large enough, while its derivative says that it goes on.
fn ends_early(depth: f64) -> (f64, f64) {
    (depth.min(0.95 * ERROR_RAD), 1.0)
}

fn with_law(device: &Device, law: fn(f64) -> (f64, f64)) -> Vec<Box<dyn Effect>> {
    let joints = 0..device.joints.len();
    joints
        .map(|joint| Box::new(Scratch { joint, law }) as _)
        .collect()
}

fn diagnosed(own: fn(&Device) -> Vec<Box<dyn Effect>>) -> Diagnosis {
    let recording = record(&Session::default(), |at| {
        let mut errors = Errors::default();
        errors.encoder_rad[SCRATCHED] = ERROR_RAD * scratch(at.reading_rad[SCRATCHED]);
        errors
    });
    let options = Options {
        own_effects: Some(own),
        ..Options::default()
    };
    diagnose(&device(), &recording, &options).unwrap()
}

#[test]
fn a_fit_of_many_slow_steps_goes_on_to_its_minimum() {
    let diagnosis = diagnosed(|device| with_law(device, logarithmic));
    let joint = Some(SCRATCHED + 1);
    let found = assert_named(&diagnosis, "encoder-scratch", joint, "depth");
    // the error's size is what the rows show
    let of_depth = |depth: f64| logarithmic(depth).0;
    let size = (of_depth(found.0), found.1.map(of_depth));
    assert_near(size, ERROR_RAD);
    assert!((size.0 / ERROR_RAD - 1.0).abs() < 0.02, "{size:?}");
    assert!(diagnosis.provenance.last_step < 1e-2);
}

#[test]
fn a_fit_without_a_minimum_is_no_name_and_no_number() {
    let diagnosis = diagnosed(|device| with_law(device, ends_early));
    let summary = summary(&diagnosis);
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{summary}");
    let is_scratch = |effect: &str| effect == "encoder-scratch";
    assert!(
        !diagnosis
            .causes
            .iter()
            .any(|cause| is_scratch(&cause.effect)),
        "{summary}"
    );
    let mut candidates = diagnosis.candidates.iter();
    let scratch = candidates
        .find(|candidate| is_scratch(&candidate.effect))
        .unwrap();
    assert_eq!(scratch.refused.as_deref(), Some("fit did not converge"));
    assert_eq!(scratch.joint, Some(SCRATCHED + 1));
    assert!(scratch.parameters.is_empty());
    // a scratch whose derivative is right is named in the same log
    let right = diagnosed(|device| with_law(device, |depth| (depth, 1.0)));
    assert_eq!(right.verdict, Verdict::Named);
}
