//! What a device knows and a robot description has no place for: the sentences of a command, and a comment in the file.

use std::fmt::Write;

use haptical_model::{Device, DeviceEffect, DriveNumber, FrictionNumber, drive_numbers_in_words};

use crate::chain::friction::turnover_per_s;
use crate::numbers::{commented, rounded};
use crate::write::corrected::{TRANSMISSIONS, has_transmission_errors};
use crate::write::effects::{Effects, FITTED_BESIDE, is_ahead};

/// Kinds of robot descriptions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Urdf,
    Mjcf,
}

/// How MuJoCo's friction differs from Coulomb's (docs/equations.md, A simulated model that stands).
const FRICTION_LOSS: &str = "`frictionloss` is a soft constraint of MuJoCo: its force reverses up to 9.5 ms before the speed does, so \
     that a model with Coulomb's law sees the simulated readings about that much late; a shorter `solreffriction` makes it less";

/// What a form does not hold of a device, a sentence each. Effects that MuJoCo has no means for are listed by the comment with
/// Python and not here.
pub(crate) fn not_carried(device: &Device, effects: &Effects<'_>, form: Form) -> Vec<String> {
    let mut said = Vec::new();
    if has_transmission_errors(device) {
        said.push(TRANSMISSIONS.to_owned());
    }
    said.extend(turnovers(device, effects, form));
    said.extend(effects.said.iter().cloned());
    said.extend(of_drives(device, form));
    match form {
        Form::Urdf => said.extend(without_means(device, effects)),
        Form::Mjcf if effects.friction.iter().any(|own| own.coulomb.is_some()) => {
            said.push(FRICTION_LOSS.to_owned());
        }
        Form::Mjcf => {}
    }
    said
}

/// A comment for the end of a file; empty where everything is carried.
pub(crate) fn comment(said: &[String]) -> String {
    if said.is_empty() {
        return String::new();
    }
    let mut text = String::from("  <!-- What this file does not carry of the device:\n");
    for own in said {
        let _ = writeln!(text, "       {}", commented(own));
    }
    text + "  -->\n"
}

/// How Coulomb friction changes sides, of joints whose friction is written.
fn turnovers(device: &Device, effects: &Effects<'_>, form: Form) -> Option<String> {
    let of = |effect: &DeviceEffect| {
        let joint = effect.joint.filter(|_| effect.is_friction())?;
        effects.friction.get(joint)?.coulomb?;
        let unit = device.joints.get(joint)?.unit();
        let size = |number: FrictionNumber| number.stated(effect).filter(|own| *own > 0.0);
        // a description has no other
        let usual = turnover_per_s(device.joints.get(joint)?.joint_type);
        let speed = size(FrictionNumber::TurnoverSpeed);
        if speed == Some(usual) {
            return None;
        }
        let speed = speed.map(|own| format!("tanh over {} {unit}/s", rounded(own)));
        let law = speed.or_else(|| {
            let travel = size(FrictionNumber::TurnoverTravel)?;
            Some(format!("Dahl's state over {} {unit}", rounded(travel)))
        })?;
        Some(format!("joint {} ({law})", joint + 1))
    };
    let joints: Vec<String> = device.effects.iter().filter_map(of).collect();
    let has = match form {
        Form::Urdf => "a URDF's `friction`",
        Form::Mjcf => "MuJoCo's `frictionloss`",
    };
    (!joints.is_empty()).then(|| {
        format!(
            "{has} is a size alone: how friction changes sides is left out, of {}",
            joints.join(", ")
        )
    })
}

/// Numbers of drives that have no place.
fn of_drives(device: &Device, form: Form) -> Option<String> {
    let without = match form {
        Form::Urdf => &[
            DriveNumber::Armature,
            DriveNumber::TorqueOffset,
            DriveNumber::TorqueDelay,
        ][..],
        Form::Mjcf => &[DriveNumber::TorqueOffset, DriveNumber::TorqueDelay],
    };
    let joints = drive_numbers_in_words(&device.joints, without)?;
    let has = match form {
        Form::Urdf => {
            "a URDF has no place for armatures, torque offsets and delays of torques, an MJCF has one for armatures"
        }
        Form::Mjcf => "an MJCF has no place for torque offsets and delays of torques",
    };
    Some(format!("{has}: left out of {joints}"))
}

/// What a table of origins leaves out of a device.
pub(crate) fn beside_origins(device: &Device) -> Vec<String> {
    let mut said = Vec::new();
    if has_transmission_errors(device) {
        said.push(TRANSMISSIONS.to_owned());
    }
    let effects = device
        .effects
        .iter()
        .map(|own| format!("`{}`", own.label()));
    let yields = (0..device.joints.len())
        .filter(|joint| device.compliance_rad_per_nm(*joint) != 0.0)
        .map(|joint| format!("`joint-compliance@{}`", joint + 1));
    let labels: Vec<String> = effects.chain(yields).collect();
    if !labels.is_empty() {
        said.push(format!(
            "a table of origins has no effects: {} are left out; {FITTED_BESIDE}",
            labels.join(", ")
        ));
    }
    said.extend(of_dynamics(device));
    said
}

/// What a file without masses, friction, limits and geometry of drives leaves out besides: every number of the drives, and the
/// masses of the rows.
pub(crate) fn of_dynamics(device: &Device) -> Option<String> {
    let masses = device.bodies.iter().flatten();
    let masses = masses.filter(|own| own.mass_kg > 0.0).count();
    let parts = [
        (masses > 0).then(|| format!("masses of {masses} links")),
        drive_numbers_in_words(&device.joints, &DriveNumber::ALL),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| {
        format!(
            "masses and numbers of drives have no place here: left out are {}",
            parts.join(", ")
        )
    })
}

/// Springs and effects of a device, of which a URDF has friction alone.
fn without_means(device: &Device, effects: &Effects<'_>) -> Vec<String> {
    let yields = (0..device.joints.len())
        .filter(|joint| device.compliance_rad_per_nm(*joint) != 0.0)
        .map(|joint| (joint + 1).to_string());
    let yields: Vec<String> = yields.collect();
    let which = match yields.as_slice() {
        [] => None,
        [one] => Some(format!("joint {one} yields")),
        several => Some(format!("joints {} yield", several.join(", "))),
    };
    let springs = which.map(|which| {
        format!(
            "{which} to torque, and a URDF has rigid joints: take compliance times torque off each joint's angle before you use it; \
             the compliances are in the device file, and an MJCF has them as springs"
        )
    });
    let is_left = |own: &&DeviceEffect| {
        effects
            .left_out
            .iter()
            .any(|left| std::ptr::eq(*left, *own))
    };
    let labels: Vec<String> = (device.effects.iter())
        .filter(|own| !is_ahead(own) && (!own.is_friction() || is_left(own)))
        .map(|own| format!("`{}`", own.label()))
        .collect();
    let others = (!labels.is_empty()).then(|| {
        format!(
            "a URDF has no effects but friction of a joint's own row: {} are left out; the forms rust, c-header and json have \
             them, an MJCF some; {FITTED_BESIDE}",
            labels.join(", ")
        )
    });
    springs.into_iter().chain(others).collect()
}
