//! Tests of the crate as its users see it.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on fails there"
)]

mod changes;
mod episodes;
mod heavy;
mod input;
mod laws;
mod limits;
mod loops;
mod servo;
mod torque;

use haptical_servo::{Finding, JointAnswer, JointLog, Number, Untested, diagnose_joint};

use self::servo::Log;

/// The answer of a joint alone.
fn asked(log: &Log) -> Result<JointAnswer, Untested> {
    diagnose_joint(&JointLog {
        time_s: Some(&log.time_s),
        run: Some(&log.run),
        command: Some(&log.command),
        response: &log.response,
        ..JointLog::default()
    })
}

fn cause<'a>(answer: &'a JointAnswer, effect: &str) -> Option<&'a Finding> {
    answer.causes.iter().find(|cause| cause.effect == effect)
}

fn number(finding: &Finding, name: &str) -> Number {
    let mut numbers = finding.numbers.iter();
    *numbers.find(|number| number.name == name).unwrap()
}
