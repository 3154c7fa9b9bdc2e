//! A trial as a folder, with what the arm's user knows: the device, a URDF, the controller.

use std::path::Path;

use anyhow::Result;
use serde_json::json;

use crate::files::{write_text, write_trial};
use crate::moving::arms::urdf;
use crate::moving::motion::control::Kind;
use crate::moving::plan::plan;
use crate::moving::trial::{Moving, make};
use crate::suites::Suite;

/// Writes the trial at an index of the suite `moving`: `device.toml`, `log.csv.gz`, `log2.csv.gz`, `arm.urdf`, `arm.json` and
/// `truth.json` into a folder of its own below `folder`.
pub fn write_moving(index: u64, seed: u64, folder: &Path) -> Result<()> {
    let mut random = Suite::Moving.random(index, seed);
    let plan = plan(index, &mut random);
    let moving = make(&plan, 0.0, Suite::Moving.id(index, seed), &mut random)?;
    let truth = &moving.trial.truth;
    let name = format!("{}-{index:03}-{}", Suite::Moving.name(), truth.name);
    let own = folder.join(&name);
    write_trial(&moving.trial, &own, false)?;
    let effects: Vec<serde_json::Value> = truth
        .effects
        .iter()
        .map(|effect| {
            let mut numbers = json!(effect.law);
            if let (Some(joint), Some(map)) = (effect.joint, numbers.as_object_mut()) {
                map.insert("joint".to_owned(), json!(joint));
            }
            json!([effect.effect, numbers])
        })
        .collect();
    let size = match truth.effects.first() {
        None => serde_json::Value::Null,
        Some(_) if plan.stratum.size() < 1.0 => json!("weak"),
        Some(_) => json!("strong"),
    };
    let truth_json = json!({
        "set": name,
        "name": truth.name,
        "arm": moving.arm.name,
        "effects": effects,
        "right": truth.right,
        "acceptable": truth.acceptable,
        "no_gap_is_right": truth.no_gap_is_right,
        "joint": truth.joint,
        "joints": truth.joints,
        "size": size,
        "without": truth.without,
        "depends_on": truth.depends_on,
        "second_encoders": moving.sensors.has_outputs,
        "seed": seed,
    });
    write_text(&own.join("truth.json"), &format!("{truth_json:#}\n"))?;
    let arm_json = described(&moving);
    write_text(&own.join("arm.json"), &format!("{arm_json:#}\n"))?;
    write_text(&own.join("arm.urdf"), &urdf(moving.arm))
}

/// What stands in no device file.
fn described(moving: &Moving) -> serde_json::Value {
    let of = |pick: fn(&crate::moving::arms::Axis) -> f64| -> Vec<f64> {
        moving.arm.axes.iter().map(pick).collect()
    };
    let law = match moving.design.kind {
        Kind::Gravity => {
            "kp*(command-theta) + kd*(d command/dt - d theta/dt) + gravity(theta, nominal)"
        }
        Kind::Computed => {
            "M(theta, nominal, armature included)*(d2 command/dt2 + kp*(command-theta) + kd*(d command/dt - d theta/dt)) \
             + bias(theta, d theta/dt, nominal)"
        }
    };
    json!({
        "ratio": of(|axis| axis.ratio),
        "encoder_counts_per_motor_turn": of(|axis| axis.counts),
        "armature_kg_m2": of(|axis| axis.armature),
        "torque_range_nm": of(|axis| axis.range),
        "torque_noise_sd_nm": moving.sensors.noise,
        "rate_hz": moving.sensors.rate_hz,
        "duration_s": moving.sensors.duration_s,
        "controller": {
            "law": law,
            "rate_hz": 1000,
            "velocity_lowpass_hz": moving.design.lowpass_hz,
            "kp": moving.design.stiffness,
            "kd": moving.design.damping,
        },
    })
}
