//! The arm of a page: as given and as identified at a posture of the log, with what moved.

use haptical_calibration::frame_origins_m;
use haptical_model::kinematics::nalgebra::Rotation3;
use haptical_model::{Device, Recording, Segments};
use haptical_report::{ArmPicture, Block};

use super::FIGURE_PX;
use crate::error::Error;
use crate::units::{Shown, decimals};

/// Joints whose change is written beside them.
const NOTED: usize = 4;
/// Changes below these are none \[m\], \[rad\].
const LEAST: [f64; 2] = [5e-8, 5e-8];
/// Plausible sizes by which a shift and a turn are compared: those of a length and of an angle of a link.
const PLAUSIBLE: [f64; 2] = [5e-3, 0.02];
/// Upwards where the device file states no gravity.
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// How far a joint's place on the part before it moved.
struct Moved {
    row: usize,
    shift_m: f64,
    turn_rad: f64,
}

impl Moved {
    fn multiples(&self) -> f64 {
        (self.shift_m / PLAUSIBLE[0]).max(self.turn_rad / PLAUSIBLE[1])
    }
}

/// The arm before and after, which is called `name`; none of a device without links, of one that did not move, and where it has no place.
pub(crate) fn picture(
    given: &Device,
    found: &Device,
    recording: &Recording,
    name: &str,
) -> Result<Option<Block>, Error> {
    if !given.has_links() || recording.is_empty() {
        return Ok(None);
    }
    let row = typical_row(recording);
    let part = recording.select(&[row]);
    let origins = |device: &Device| frame_origins_m(device, &part).ok()?.pop();
    let (Some(before), Some(after)) = (origins(given), origins(found)) else {
        return Ok(None);
    };
    if before.len() != after.len() {
        return Ok(None);
    }
    let moved = moved(given, found);
    let size = |from: &[f64; 3], to: &[f64; 3]| {
        let axes = from.iter().zip(to).map(|(a, b)| (a - b).powi(2));
        axes.sum::<f64>().sqrt()
    };
    let handles = before.last().zip(after.last());
    let handle_m = handles.map_or(0.0, |(a, b)| size(a, b));
    if moved.is_empty() && handle_m < LEAST[0] {
        return Ok(None);
    }
    // the frame behind a row is at the next joint, but at its own where the row begins with a constant origin
    let has_origins = given.chain_origins().iter().skip(1).any(Option::is_some);
    let place = |row: usize| row + usize::from(has_origins);
    let notes = moved.iter().take(NOTED);
    let notes = notes.map(|own| (place(own.row), said(given, own)));
    let arm = ArmPicture {
        title: "What moved".to_owned(),
        names: ["as given".to_owned(), name.to_owned()],
        up: given
            .gravity_mps2
            .map_or(UP, |gravity| gravity.map(|axis| -axis)),
        // without the line to the frame of the measurement
        before: before[1..].to_vec(),
        after: after[1..].to_vec(),
        notes: notes.collect(),
    };
    let Ok(svg) = arm.to_svg(FIGURE_PX.0, FIGURE_PX.1) else {
        // an arm without extent
        return Ok(None);
    };
    let gain = match arm.gain() {
        gain if gain > 1.0 => format!(" drawn {gain} times"),
        _ => String::new(),
    };
    let caption = format!(
        "The arm at row {} of the log, its deviation{gain}: there the handle is {} from where the given device has it. \
         Beside a joint: how far its place and its axis on the part before it moved.",
        row + 1,
        number(handle_m, "m")
    );
    Ok(Some(Block::Svg { caption, svg }))
}

/// The row whose readings are nearest to the middle ones of all joints.
fn typical_row(recording: &Recording) -> usize {
    let middle = |readings: &Vec<f64>| {
        let mut sorted = readings.clone();
        sorted.retain(|own| own.is_finite());
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
    };
    let middles: Vec<f64> = recording.joint.iter().map(middle).collect();
    let distance = |row: usize| -> f64 {
        let joints = recording.joint.iter().zip(&middles);
        let distances = joints.map(|(readings, middle)| (readings[row] - middle).abs());
        distances.sum()
    };
    let rows = 0..recording.len();
    rows.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
        .unwrap_or(0)
}

/// Places of joints, and of the handle behind the last, that moved on the part before them, most first.
fn moved(given: &Device, found: &Device) -> Vec<Moved> {
    let (Ok(given), Ok(found)) = (Segments::of_device(given), Segments::of_device(found)) else {
        return Vec::new();
    };
    let poses = |own: &Segments| {
        let rows = own.rows.iter().map(|row| row.before);
        rows.chain(own.handles.first().copied()).collect::<Vec<_>>()
    };
    let pairs = poses(&given).into_iter().zip(poses(&found)).enumerate();
    let each = pairs.map(|(row, (from, to))| {
        let turn = from.rotation.transpose() * to.rotation;
        Moved {
            row,
            shift_m: (to.position_m - from.position_m).norm(),
            turn_rad: Rotation3::from_matrix_unchecked(turn).angle(),
        }
    });
    let mut all: Vec<Moved> = each
        .filter(|own| own.shift_m >= LEAST[0] || own.turn_rad >= LEAST[1])
        .collect();
    all.sort_by(|a, b| b.multiples().total_cmp(&a.multiples()));
    all
}

/// A size in mm or degrees, with two digits at least.
fn number(size: f64, unit: &str) -> String {
    let shown = Shown::for_people(unit);
    let value = size * shown.per_si;
    let blank = if shown.name == "°" { "" } else { " " };
    let decimals = decimals(value).saturating_sub(2);
    format!("{value:.decimals$}{blank}{}", shown.name)
}

/// A joint's change in mm and degrees.
fn said(device: &Device, moved: &Moved) -> String {
    let drive = device.drive(moved.row + 1).map(|drive| drive.joint);
    let name = match drive.and_then(|joint| Some((joint, device.joints.get(joint)?))) {
        None => "handle".to_owned(),
        Some((joint, own))
            if own.name.is_empty() || own.name.chars().all(|c| c.is_ascii_digit()) =>
        {
            format!("joint {}", joint + 1)
        }
        Some((_, own)) => own.name.clone(),
    };
    let parts = [
        (moved.shift_m, LEAST[0], "m"),
        (moved.turn_rad, LEAST[1], "rad"),
    ];
    let parts = parts.into_iter().filter(|(size, least, _)| size >= least);
    let parts: Vec<String> = parts.map(|(size, _, unit)| number(size, unit)).collect();
    format!("{name}: {}", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVER: &str = "name = \"lever\"\n[[link]]\na_m = 0.0\nalpha_rad = 0.0\nd_m = 0.1\n[[link]]\na_m = 0.2\nalpha_rad = 0.0\n\
                         d_m = 0.0\n[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";

    fn recording() -> Recording {
        Recording {
            joint: vec![vec![-1.0, 0.1, 0.3, 2.0, 0.2]],
            line: vec![2, 3, 4, 5, 6],
            ..Recording::default()
        }
    }

    #[test]
    fn the_picture_says_what_moved_in_mm_and_degrees() {
        let given = Device::from_toml(LEVER, "lever.toml").unwrap().device;
        let mut found = given.clone();
        found.links[1].a_m += 0.002;
        found.links[0].theta_rad += 0.01;
        let block = picture(&given, &found, &recording(), "as identified")
            .unwrap()
            .unwrap();
        let Block::Svg { caption, svg } = block else {
            panic!("no picture");
        };
        assert!(
            svg.contains("handle: 2.0 mm") && svg.contains("joint 1: 0.57°"),
            "{svg}"
        );
        // two millimetres along the lever and a hundredth of 202 mm across it
        assert!(
            caption.starts_with("The arm at row 5 of the log"),
            "{caption}"
        );
        assert!(caption.contains("the handle is 2.8"), "{caption}");
        assert!(
            picture(&given, &given, &recording(), "as identified")
                .unwrap()
                .is_none()
        );
    }
}
