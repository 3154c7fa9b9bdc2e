//! The exports of a description: corrected, new URDF, new MJCF, each read again and given to the peers.

use haptical_model::kinematics::{Convention, Link, Parameter};
use haptical_model::{Device, FrictionNumber, JointType};
use haptical_urdf::{
    BaseAndTip, Loader, NewJoints, UrdfError, corrected_mjcf, corrected_urdf, loader_notes,
    new_mjcf, new_urdf,
};

use super::ask::Model;
use super::compare::{Check, apart};
use super::files::Kind;
use super::findings::{Finding, Part, State, Worst};
use super::ours::{friction, ours};
use super::said::{explained, with_any};
use super::subject::{Subject, read};

/// Largest change of a number of a row by the calibration that is tried \[m\], \[rad\].
const CHANGE: f64 = 2e-3;
/// How much more the rows weigh where masses are corrected too.
const HEAVIER: f64 = 1.05;
/// A text that haptical wrote.
struct Written {
    part: Part,
    kind: Kind,
    text: String,
    base: Option<String>,
    tips: Vec<String>,
    said: Vec<String>,
    /// What the text is to describe.
    device: Device,
}

/// Adds what the peers are asked about a description and its exports; gives what needs no peer.
pub(crate) fn add(
    subject: &Subject,
    row: usize,
    models: &mut Vec<Model>,
    checks: &mut Vec<Check>,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let device = &subject.read.device;
    let own = match ours(device, &subject.motions) {
        Ok(own) => own,
        Err(error) => {
            return vec![by_haptical(Part::Given, State::Refused(error.to_string()))];
        }
    };
    let said = [words(subject), own.said.clone()].concat();
    let kind = subject.found.kind;
    models.push(Model {
        kind,
        path: (kind == Kind::Mjcf).then(|| subject.found.path.display().to_string()),
        text: subject.text.clone(),
        peers: peers(kind),
        base: subject.base.clone(),
        root: subject.read.base.clone(),
        tips: subject.tips.clone(),
        joints: joints(device),
        gravity: gravity(device),
        motions: subject.motions.clone(),
    });
    checks.push(Check {
        row,
        part: Part::Given,
        ours: own,
        said,
    });
    for (part, written) in [
        (Part::Corrected, corrected(subject, calibrated(device))),
        (Part::Corrected, corrected(subject, weighed(device))),
        (Part::NewUrdf, new(subject, Kind::Urdf)),
        (Part::NewMjcf, new(subject, Kind::Mjcf)),
    ] {
        match written {
            Ok(written) => findings.push(ask_of(subject, &written, row, models, checks)),
            Err(error) => findings.push(by_haptical(part, State::Refused(error.to_string()))),
        }
    }
    findings
}

/// What haptical says of a file, and of what Pinocchio makes of it.
fn words(subject: &Subject) -> Vec<String> {
    let mut said = subject.read.warnings.clone();
    if subject.found.kind == Kind::Urdf {
        let file = &subject.found.shown;
        let notes = loader_notes(&subject.text, file, Loader::Pinocchio);
        said.extend(notes.unwrap_or_default());
    }
    said
}

fn by_haptical(part: Part, state: State) -> Finding {
    let with = "haptical".to_owned();
    Finding { part, with, state }
}

fn peers(kind: Kind) -> Vec<&'static str> {
    match kind {
        Kind::Urdf => vec!["pinocchio", "mujoco"],
        Kind::Mjcf => vec!["mujoco"],
    }
}

fn joints(device: &Device) -> Vec<String> {
    let joints = device.joints.iter();
    joints.map(|joint| joint.name.clone()).collect()
}

fn gravity(device: &Device) -> [f64; 3] {
    device.gravity_mps2.unwrap_or_default()
}

/// The device as a calibration might leave it: every number of every row changed.
fn calibrated(device: &Device) -> Device {
    let mut changed = device.clone();
    let mut turn: f64 = 0.0;
    for link in &mut changed.links {
        for parameter in Parameter::ALL {
            turn += 1.0;
            link.set(parameter, CHANGE * libm::sin(turn));
        }
    }
    changed
}

/// The same where no mass moves with a corrected origin: but for what is behind the last motions, and the zeros of slides. What the
/// rows carry weighs more.
fn weighed(device: &Device) -> Device {
    let mut changed = calibrated(device);
    for row in 1..changed.links.len() {
        let ends = device.hands.iter().any(|hand| hand.row == row);
        let is_last = ends || (device.hands.is_empty() && row + 1 == device.links.len());
        let slides = device.drive(row).map(|own| own.motion) == Some(JointType::Prismatic);
        let link = &mut changed.links[row];
        if is_last && device.convention == Convention::Standard {
            *link = Link {
                theta_rad: link.theta_rad,
                ..Link::default()
            };
        }
        if is_last || slides {
            link.d_m = 0.0;
        }
    }
    for body in changed.bodies.iter_mut().flatten() {
        body.mass_kg *= HEAVIER;
        let inertia = body.inertia_kgm2.map(|own| own.map(|own| own * HEAVIER));
        body.inertia_kgm2 = inertia;
    }
    changed
}

fn corrected(subject: &Subject, device: Device) -> Result<Written, UrdfError> {
    let (first, further) = subject.tips.split_first().unzip();
    let ends = BaseAndTip {
        base: subject.base.as_deref(),
        tip: first.map(String::as_str),
        further_tips: further.unwrap_or_default(),
    };
    let (text, file) = (subject.text.as_str(), subject.found.shown.as_str());
    let (text, base, tip, further, said) = match subject.found.kind {
        Kind::Urdf => {
            let own = corrected_urdf(text, file, ends, &device)?;
            (own.text, own.base, own.tip, own.further_tips, own.warnings)
        }
        Kind::Mjcf => {
            let own = corrected_mjcf(text, file, ends, &device, NewJoints::Listed)?;
            (own.text, own.base, own.tip, own.further_tips, own.warnings)
        }
    };
    let is_named = subject.base.is_some() || base != subject.read.base;
    Ok(Written {
        part: Part::Corrected,
        kind: subject.found.kind,
        text,
        base: is_named.then_some(base),
        tips: [vec![tip], further].concat(),
        said: [words(subject), said].concat(),
        device,
    })
}

fn new(subject: &Subject, kind: Kind) -> Result<Written, UrdfError> {
    let device = &subject.read.device;
    let (part, (text, said)) = match kind {
        Kind::Urdf => (Part::NewUrdf, new_urdf(device)?),
        Kind::Mjcf => (Part::NewMjcf, new_mjcf(device)?),
    };
    let hands = device.hands.iter().map(|hand| hand.name.clone());
    let tips: Vec<String> = match device.hands.is_empty() {
        true => vec!["handle".to_owned()],
        false => hands.collect(),
    };
    Ok(Written {
        part,
        kind,
        text,
        base: None,
        tips,
        said,
        device: device.clone(),
    })
}

/// Reads a text again, compares it with its device, and adds what the peers are asked about it.
fn ask_of(
    subject: &Subject,
    written: &Written,
    row: usize,
    models: &mut Vec<Model>,
    checks: &mut Vec<Check>,
) -> Finding {
    let part = written.part;
    let different = |what: String| {
        let words = format!("{}: {what}", part.name());
        by_haptical(part, State::Different(Worst::default(), words))
    };
    let base = written.base.as_deref();
    let source = (written.text.as_str(), part.name(), written.kind);
    let again = match read(source, base, &written.tips) {
        Ok(again) => again,
        Err(error) => return different(format!("haptical does not read what it wrote: {error}")),
    };
    if let Some(words) = with_any(&written.said, &["has none of its own: its value"]) {
        return by_haptical(part, State::Said(words));
    }
    let is_new = part != Part::Corrected;
    let described = match is_new {
        true => again.device.clone(),
        false => written.device.clone(),
    };
    let (peers, kind) = (peers(written.kind), written.kind);
    match ours(&described, &subject.motions) {
        Ok(own) => {
            models.push(Model {
                kind,
                path: None,
                text: written.text.clone(),
                peers,
                base: written.base.clone(),
                root: again.base.clone(),
                tips: written.tips.clone(),
                joints: joints(&again.device),
                gravity: gravity(&again.device),
                motions: subject.motions.clone(),
            });
            let said = [written.said.clone(), again.warnings.clone()].concat();
            checks.push(Check {
                row,
                part,
                ours: own,
                said,
            });
        }
        Err(error) => return different(error.to_string()),
    }
    let state = same(subject, written, &again.device);
    by_haptical(part, state)
}

/// Whether a text that was read again is the device that was written.
fn same(subject: &Subject, written: &Written, again: &Device) -> State {
    let mut was = written.device.clone();
    let mut again = again.clone();
    let part = written.part.name();
    let different = |what: String| State::Different(Worst::default(), format!("{part}: {what}"));
    if again.joints.len() != was.joints.len() {
        let (now, before) = (again.joints.len(), was.joints.len());
        return different(format!("{now} joints come back of {before}"));
    }
    if written.part != Part::Corrected
        && let Err(what) = without_made_up(&mut was, &mut again, written)
    {
        return different(what);
    }
    let [before, now] = [&was, &again].map(|device| ours(device, &subject.motions));
    let (before, now) = match (before, now) {
        (Ok(before), Ok(now)) => (before, now),
        (Err(error), _) | (_, Err(error)) => return different(error.to_string()),
    };
    let gap = apart(&before, &now);
    match gap.is_small() {
        true => State::Equal(gap.worst()),
        false => match explained(&written.said, written.part) {
            Some(words) if gap.has_equal_poses() => State::Said(words),
            _ => State::Different(gap.worst(), format!("{part} read again: {}", gap.words())),
        },
    }
}

/// Takes away what an export makes up or cannot hold, where it says so.
fn without_made_up(was: &mut Device, again: &mut Device, written: &Written) -> Result<(), String> {
    let says = |words: &[&str]| with_any(&written.said, words).is_some();
    for joint in 0..was.joints.len() {
        let (old, new) = (&mut was.joints[joint], &mut again.joints[joint]);
        if old.armature_kgm2.unwrap_or(0.0) == new.armature_kgm2.unwrap_or(0.0) {
            continue;
        }
        if !says(&["armature"]) {
            return Err(format!("the armature of `{}` is another one", old.name));
        }
        (old.armature_kgm2, new.armature_kgm2) = (None, None);
    }
    // what the device does not have of friction is made up, and marked in the file
    for effect in again.effects.iter_mut().filter(|own| own.is_friction()) {
        let Some(joint) = effect.joint else {
            continue;
        };
        let kind = was.joints[joint].joint_type;
        let numbers = [FrictionNumber::Coulomb, FrictionNumber::Viscous];
        for (number, known) in numbers.into_iter().zip(friction(was, joint)) {
            if known == 0.0 {
                effect.numbers.insert(number.key(kind).to_owned(), 0.0);
            }
        }
    }
    if again.gravity_mps2 != was.gravity_mps2 && says(&["gravity"]) {
        again.gravity_mps2 = was.gravity_mps2;
    }
    Ok(())
}
