//! Suites of arms that move by themselves and log joints and torques alone: with another payload from a run on, and
//! without.

use anyhow::{Context, Result};

use crate::effects::{Kind, kind};
use crate::random::Random;
use crate::suites::of_device;
use crate::trial::Order;

/// Runs of a recording, and their rows together.
const RUNS: usize = 2;

/// An arm without effects: half of them repeat their trajectory in every run.
fn bare(random: &mut Random) -> Result<Order> {
    let (mut order, _) = of_device(random)?;
    order.has_torques_alone = true;
    order.plan.hand = 0.0;
    order.plan.runs = RUNS;
    order.plan.rows /= RUNS;
    order.plan.repeats = random.index(2) == 0;
    Ok(order)
}

fn known(name: &'static str) -> Result<&'static Kind> {
    kind(name).with_context(|| format!("there is no effect `{name}`"))
}

/// Another payload from the middle on: three quarters of them at the flange, every other with friction of all joints.
pub(crate) fn changed(index: u64, random: &mut Random) -> Result<Order> {
    let mut order = bare(random)?;
    let name = match index % 4 {
        3 => "payload-on-link",
        _ => "payload",
    };
    order.effects.push((known(name)?, 0, 1.0));
    if index % 2 == 1 {
        order.effects.push((known("friction-beside")?, 0, 1.0));
    }
    if index.is_multiple_of(5) {
        // put on for the second of three runs alone would be two changes: here the third keeps it
        order.plan.runs = 3;
    }
    Ok(order)
}

/// The same arms without a change: without friction nothing is to be found, with it no payload.
pub(crate) fn unchanged(index: u64, random: &mut Random) -> Result<Order> {
    let mut order = bare(random)?;
    match index % 2 {
        0 => order.label = Some("clean-torques".to_owned()),
        _ => order.effects.push((known("friction-alone")?, 0, 1.0)),
    }
    Ok(order)
}
