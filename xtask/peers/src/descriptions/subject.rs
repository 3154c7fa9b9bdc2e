//! A description as haptical reads it: all its chains from one base as one device.

use haptical_model::Device;
use haptical_urdf::{
    BaseAndTip, UrdfDevice, UrdfError, chain_ends, device_from_mjcf, device_from_urdf,
    read_urdf_text,
};
use xtask_blind::Random;

use super::files::{Found, Kind};
use super::findings::{Finding, Part, Row, State};

/// Seed of the motions.
const SEED: u64 = 20_260_301;
/// Motions of each description.
const MOTIONS: usize = 3;
/// Where a joint without limits is at most \[rad\], \[m\].
const TURNED_RAD: f64 = 2.0;
const SHIFTED_M: f64 = 0.3;
/// Largest speed and acceleration \[rad/s\], \[rad/s^2\] and of slides \[m/s\], \[m/s^2\].
const FASTEST: f64 = 2.0;
const HARDEST: f64 = 5.0;

/// One state of motion: positions, velocities, accelerations of all joints.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Motion {
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) ddq: Vec<f64>,
}

/// A file, read from one base.
#[derive(Debug, Clone)]
pub(crate) struct Subject {
    pub(crate) found: Found,
    pub(crate) text: String,
    /// Base that is named; none for the root.
    pub(crate) base: Option<String>,
    pub(crate) tips: Vec<String>,
    pub(crate) read: UrdfDevice,
    pub(crate) motions: Vec<Motion>,
}

impl Subject {
    /// Its row in the table, empty yet.
    pub(crate) fn row(&self) -> Row {
        Row {
            file: shown(&self.found, self.base.as_deref()),
            joints: self.read.device.joints.len(),
            findings: Vec::new(),
        }
    }
}

fn shown(found: &Found, base: Option<&str>) -> String {
    match base {
        Some(base) => format!("{} from `{base}`", found.shown),
        None => found.shown.clone(),
    }
}

/// A file from its root and from each body behind a free or ball joint; where haptical refuses, the row that says so.
pub(crate) fn subjects(found: &Found) -> Vec<Result<Subject, Box<Row>>> {
    let refused = |base: Option<&str>, error: &UrdfError| {
        let state = State::Refused(error.to_string());
        let finding = Finding {
            part: Part::Given,
            with: "haptical".to_owned(),
            state,
        };
        Box::new(Row {
            file: shown(found, base),
            joints: 0,
            findings: vec![finding],
        })
    };
    let text = match read_urdf_text(&found.path) {
        Ok(text) => text,
        Err(error) => return vec![Err(refused(None, &error))],
    };
    let of_base = |base: Option<&str>| {
        let whole = whole(&text, found, base)?;
        let (tips, read) = whole;
        Ok(Subject {
            found: found.clone(),
            text: text.clone(),
            base: base.map(str::to_owned),
            tips,
            motions: motions(&read.device),
            read,
        })
    };
    let bases = bases(&text);
    let mut all = Vec::new();
    match of_base(None) {
        Ok(subject) => all.push(Ok(subject)),
        Err(error) if bases.is_empty() || !is_unmoved(&error) => {
            all.push(Err(refused(None, &error)));
        }
        // what moves is behind its free joints
        Err(_) => {}
    }
    for base in &bases {
        match of_base(Some(base)) {
            Ok(subject) => all.push(Ok(subject)),
            // a loose thing without joints of its own
            Err(error) if is_unmoved(&error) && !all.is_empty() => {}
            Err(error) => all.push(Err(refused(Some(base), &error))),
        }
    }
    all
}

fn is_unmoved(error: &UrdfError) -> bool {
    matches!(
        error,
        UrdfError::Chain { .. } | UrdfError::Tree { .. } | UrdfError::TipMissing { .. }
    )
}

/// Bodies that are behind a free or ball joint, and links behind a floating or planar one.
fn bases(text: &str) -> Vec<String> {
    let Ok(document) = roxmltree::Document::parse(text) else {
        return Vec::new();
    };
    let nodes = document.descendants();
    let found = nodes.filter_map(|node| {
        let kind = node.attribute("type");
        match node.tag_name().name() {
            "freejoint" => node.parent()?.attribute("name"),
            "joint" => match kind {
                Some("free" | "ball") => node.parent()?.attribute("name"),
                Some("floating" | "planar") => {
                    let mut children = node.children();
                    let child = children.find(|own| own.has_tag_name("child"))?;
                    child.attribute("link")
                }
                _ => None,
            },
            _ => None,
        }
    });
    let mut names: Vec<String> = Vec::new();
    for name in found {
        if !names.iter().any(|own| own == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// Reads the chains to some tips.
pub(crate) fn read(
    (text, file, kind): (&str, &str, Kind),
    base: Option<&str>,
    tips: &[String],
) -> Result<UrdfDevice, UrdfError> {
    let (first, further) = tips.split_first().unzip();
    let ends = BaseAndTip {
        base,
        tip: first.map(String::as_str),
        further_tips: further.unwrap_or_default(),
    };
    match kind {
        Kind::Urdf => device_from_urdf(text, file, ends),
        Kind::Mjcf => device_from_mjcf(text, file, ends),
    }
}

/// All chains from a base to their ends as one device.
fn whole(
    text: &str,
    found: &Found,
    base: Option<&str>,
) -> Result<(Vec<String>, UrdfDevice), UrdfError> {
    let source = (text, found.shown.as_str(), found.kind);
    let ends = chain_ends(text, &found.shown, base)?;
    let all: Vec<String> = ends.into_iter().map(|end| end.tip).collect();
    let device = read(source, base, &all)?;
    if all.len() < 2 {
        return Ok((vec![device.tip.clone()], device));
    }
    let rows = device.device.links.len();
    let has_child = |row: usize| (1..rows).any(|own| device.device.parent(own) == Some(row));
    let hands = device.device.hands.iter();
    let leaves: Vec<String> = hands
        .filter(|hand| !has_child(hand.row))
        .map(|hand| hand.name.clone())
        .collect();
    let device = read(source, base, &leaves)?;
    Ok((leaves, device))
}

/// Random motions within the limits.
fn motions(device: &Device) -> Vec<Motion> {
    let mut random = Random::new(SEED, device.joints.len() as u64);
    let motion = |_| {
        let q = device.joints.iter().map(|joint| {
            let most = match joint.joint_type {
                haptical_model::JointType::Revolute => TURNED_RAD,
                haptical_model::JointType::Prismatic => SHIFTED_M,
            };
            let (mut lower, mut upper) = (joint.lower_rad, joint.upper_rad);
            if !lower.is_finite() {
                lower = upper.min(most) - 2.0 * most;
            }
            if !upper.is_finite() {
                upper = lower + 2.0 * most;
            }
            random.uniform(lower, upper)
        });
        let q = q.collect();
        let mut some = |most: f64| -> Vec<f64> {
            let joints = device.joints.iter();
            joints.map(|_| random.uniform(-most, most)).collect()
        };
        let (dq, ddq) = (some(FASTEST), some(HARDEST));
        Motion { q, dq, ddq }
    };
    (0..MOTIONS).map(motion).collect()
}
