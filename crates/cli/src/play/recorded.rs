//! The recording as the page plays it: positions, errors and the axis of a thinned log, rounded for embedding.

use std::path::Path;

use haptical_calibration::{
    CalibrationError, Channel, ChannelResiduals, Weights, channel_residuals, channels,
    frame_origins_m, prepare_device,
};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, DeviceEffect, Recording};
use serde::Serialize;

use crate::failure::Failure;
use haptical::units::Shown;
use haptical::{Drawn, drawn};

/// Characters that one number takes in the page on average, its comma included.
const NUMBER_BYTES: usize = 6;
/// Characters for the numbers of a page whose thinning is left to the command: with text, style and
/// script the page stays below 3 MB.
const DATA_BYTES: usize = 2_500_000;
/// Coordinates beyond this are no arm, and their micrometres would have no exact numbers \[m\].
const LARGEST_M: f64 = 1e6;
/// Micrometres in a metre: positions are embedded as whole micrometres.
const PER_METRE: f64 = 1e6;
/// Upward direction where the device file states no gravity: z of frame (-1).
const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// What was asked for, and the files to name in refusals.
pub(crate) struct Request<'a> {
    /// Keep every n-th row; none leaves it to the size of the page.
    pub(crate) every: Option<usize>,
    pub(crate) device_file: &'a Path,
    pub(crate) model_file: &'a Path,
    pub(crate) log_file: &'a Path,
}

impl Request<'_> {
    fn refuse(&self, error: &CalibrationError) -> Failure {
        Failure::calibration(error, self.device_file, self.log_file)
    }
}

/// The data of the page; field names are those that the script reads.
#[derive(Debug, Serialize)]
pub(crate) struct Recorded {
    pub(crate) device: String,
    /// Whether there is a calibrated arm.
    pub(crate) calibrated: bool,
    /// Effects of the arm that is drawn last, such as `backlash@3`.
    #[serde(skip)]
    pub(crate) effects: Vec<String>,
    /// Rows of the log, and how many of them were passed over for each one kept.
    pub(crate) rows: usize,
    pub(crate) every: usize,
    pub(crate) axis: Axis,
    /// Kept rows at which a new run starts; curves are broken there.
    pub(crate) run_starts: Vec<usize>,
    /// Direction against gravity, or z of frame (-1); not of unit length.
    pub(crate) up: [f64; 3],
    /// Per row x, y, z of every frame of the nominal arm in frame (-1): frame (-1), base, joints,
    /// handle \[um\].
    pub(crate) origins_um: Vec<Vec<i64>>,
    /// Calibrated minus nominal, in the same order \[um\].
    pub(crate) deviations_um: Option<Vec<Vec<i64>>>,
    /// Tracked handle, where a row has it \[um\].
    pub(crate) tracked_um: Option<Vec<Option<[i64; 3]>>>,
    pub(crate) channels: Vec<ChannelErrors>,
}

/// Horizontal axis: time or rows.
#[derive(Debug, Serialize)]
pub(crate) struct Axis {
    /// Whether the values are seconds; otherwise rows, from 1.
    pub(crate) is_time: bool,
    pub(crate) values: Vec<f64>,
}

/// Errors of one channel, model minus measurement, in a unit for people; `null` where a row has none.
#[derive(Debug, Serialize)]
pub(crate) struct ChannelErrors {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) unit: &'static str,
    /// Digits after the point that the errors are rounded to.
    pub(crate) decimals: usize,
    /// Exit of a cable in frame (-1) \[um\].
    pub(crate) exit_um: Option<[i64; 3]>,
    pub(crate) nominal: Vec<Option<f64>>,
    pub(crate) calibrated: Option<Vec<Option<f64>>>,
    /// Unit of the two figures below, which are over the rows of the page.
    #[serde(skip)]
    pub(crate) si_unit: &'static str,
    #[serde(skip)]
    pub(crate) rms_nominal: Option<f64>,
    #[serde(skip)]
    pub(crate) rms_calibrated: Option<f64>,
}

/// `backlash@3`, joint by joint where joints yield.
fn effects(device: &Device) -> Vec<String> {
    let yields = |joint: &usize| device.compliance_rad_per_nm(*joint) != 0.0;
    let compliant = (0..device.joints.len()).filter(yields);
    let compliant = compliant.map(|joint| format!("joint-compliance@{}", joint + 1));
    let own = device.effects.iter().map(DeviceEffect::label);
    own.chain(compliant).collect()
}

/// A device over the rows of a log, with its effects.
#[derive(Debug)]
struct Arm {
    device: Device,
    drawn: Drawn,
}

impl Arm {
    /// Effects remember: they see all rows of the log, whatever is drawn.
    fn new(
        mut device: Device,
        recording: &Recording,
        files: (&Path, &Path),
    ) -> Result<Self, Failure> {
        let drawn = drawn(&mut device, files, recording)?;
        Ok(Self { device, drawn })
    }

    fn thinned(mut self, kept: &[usize]) -> Self {
        let moved = self.drawn.handle_moved_m.as_ref();
        self.drawn.handle_moved_m = moved.map(|rows| kept.iter().map(|&row| rows[row]).collect());
        self.drawn.recording = self.drawn.recording.select(kept);
        self
    }

    /// Origins of the frames; the last one, the handle, where the effects put it.
    fn origins_m(&self) -> Result<Vec<Vec<[f64; 3]>>, CalibrationError> {
        let mut origins = frame_origins_m(&self.device, &self.drawn.recording)?;
        let rows = self.drawn.handle_moved_m.iter().flatten();
        for (row, moved) in origins.iter_mut().zip(rows) {
            let handle = row.last_mut().into_iter().flatten();
            handle.zip(moved).for_each(|(axis, by)| *axis += by);
        }
        Ok(origins)
    }
}

impl Recorded {
    /// Thins the recording and works out everything that the page shows of it.
    pub(crate) fn new(
        nominal: &Device,
        model: Option<&Device>,
        recording: &Recording,
        request: &Request<'_>,
        warnings: &mut Vec<String>,
    ) -> Result<Self, Failure> {
        let refuse = |error| request.refuse(&error);
        // a tracker's frame and touched points that a file leaves open: where they fit this log best
        let nominal = prepare_device(nominal, recording).map_err(refuse)?;
        let nominal = Arm::new(nominal, recording, (request.device_file, request.log_file))?;
        let model = model.map(|model| prepare_device(model, recording));
        let model = model.transpose().map_err(refuse)?;
        let model =
            model.map(|model| Arm::new(model, recording, (request.model_file, request.log_file)));
        let model = model.transpose()?;
        let found = drawable_channels(&nominal.device, recording, request, warnings)?;
        let every = request.every.unwrap_or_else(|| {
            let (rows, channels) = (recording.len(), found.len());
            thinning(&nominal.device, model.is_some(), rows, channels)
        });
        let kept: Vec<usize> = (0..recording.len()).step_by(every).collect();
        let nominal = nominal.thinned(&kept);
        let model = model.map(|model| model.thinned(&kept));
        let model = model.as_ref();
        let part = &nominal.drawn.recording;
        let origins = nominal.origins_m().map_err(refuse)?;
        let calibrated = model.map(Arm::origins_m).transpose().map_err(refuse)?;
        let place = |line: u64| (request.log_file, line);
        let mut origins_um = Vec::with_capacity(kept.len());
        let mut deviations_um = calibrated.is_some().then(Vec::new);
        for (row, origins) in origins.iter().enumerate() {
            let at = place(part.line[row]);
            origins_um.push(flat_um(origins.iter().copied(), at)?);
            if let (Some(calibrated), Some(deviations)) = (&calibrated, &mut deviations_um) {
                let pairs = origins.iter().zip(&calibrated[row]);
                let differences =
                    pairs.map(|(from, to)| [0, 1, 2].map(|axis| to[axis] - from[axis]));
                deviations.push(flat_um(differences, at)?);
            }
        }
        let last = &model.unwrap_or(&nominal).device;
        let tracked_um = match found.contains(&Channel::Position) {
            true => tracked_um(last, part, request.log_file)?,
            false => None,
        };
        Ok(Self {
            device: nominal.device.name.clone(),
            calibrated: model.is_some(),
            effects: effects(last),
            rows: recording.len(),
            every,
            axis: Axis::new(part, &kept),
            run_starts: run_starts(part),
            up: (nominal.device.gravity_mps2).map_or(UP, |gravity| gravity.map(|axis| -axis)),
            origins_um,
            deviations_um,
            tracked_um,
            channels: channel_errors(&nominal, model, &found, request)?,
        })
    }

    /// Rows that the page has.
    pub(crate) fn len(&self) -> usize {
        self.origins_um.len()
    }
}

impl Axis {
    /// Time where it increases from row to row through the whole log, else the rows' numbers.
    fn new(part: &Recording, kept: &[usize]) -> Self {
        let increases = |times: &&Vec<f64>| {
            let steps = times.windows(2).all(|pair| pair[0] < pair[1]);
            steps && times.iter().all(|time| time.is_finite())
        };
        match part.time_s.as_ref().filter(increases) {
            Some(times) => Self {
                is_time: true,
                values: times.iter().map(|&time| rounded(time, 6)).collect(),
            },
            None => Self {
                is_time: false,
                values: kept.iter().map(|&row| (row + 1) as f64).collect(),
            },
        }
    }
}

/// The channels whose errors can be shown. A log without any plays the arm alone.
fn drawable_channels(
    device: &Device,
    recording: &Recording,
    request: &Request<'_>,
    warnings: &mut Vec<String>,
) -> Result<Vec<Channel>, Failure> {
    match channels(device, recording) {
        Err(CalibrationError::NoChannel) => {
            let warning = "the log has no outN_rad, cable_m or position that this device predicts, so the \
                           page shows the arm without errors";
            warnings.push(warning.to_owned());
            Ok(Vec::new())
        }
        found => found.map_err(|error| request.refuse(&error)),
    }
}

/// One row in how many a page of at most [`DATA_BYTES`] can hold.
fn thinning(device: &Device, has_model: bool, rows: usize, channels: usize) -> usize {
    let arms = 1 + usize::from(has_model);
    let numbers = arms * (3 * (device.links.len() + 1) + channels) + 4;
    (rows * numbers * NUMBER_BYTES).div_ceil(DATA_BYTES).max(1)
}

fn channel_errors(
    nominal: &Arm,
    model: Option<&Arm>,
    found: &[Channel],
    request: &Request<'_>,
) -> Result<Vec<ChannelErrors>, Failure> {
    let weights = Weights::stated(&nominal.device, found);
    // Both arms on the same rows: those where the calibrated transmissions are known.
    let range_of = &model.unwrap_or(nominal).device;
    let residuals = |arm: &Arm| {
        let (device, recording) = (&arm.device, &arm.drawn.recording);
        let all = channel_residuals(device, range_of, recording, found, &weights);
        all.map_err(|error| request.refuse(&error))
    };
    let rows = nominal.drawn.recording.len();
    let nominal_device = &nominal.device;
    let before = residuals(nominal)?;
    let mut after = model.map(residuals).transpose()?.map(Vec::into_iter);
    let mut all = Vec::with_capacity(found.len());
    for before in before {
        let channel = before.channel;
        let si_unit = channel.unit(nominal_device);
        let shown = Shown::fine(si_unit);
        let decimals = if si_unit == "rad" { 4 } else { 1 };
        let after = after.as_mut().and_then(Iterator::next);
        let shown_errors = |errors: Vec<Option<f64>>| -> Vec<Option<f64>> {
            let shown = |error: f64| rounded(error * shown.per_si, decimals);
            errors.into_iter().map(|error| error.map(shown)).collect()
        };
        let entry = ChannelErrors {
            name: channel.name(),
            title: title(nominal_device, channel),
            unit: shown.name,
            decimals: decimals as usize,
            exit_um: match channel {
                Channel::Cable { index } => exit_um(nominal_device, index, request.device_file)?,
                _ => None,
            },
            rms_nominal: before.rms(),
            rms_calibrated: after.as_ref().and_then(ChannelResiduals::rms),
            nominal: shown_errors(before.by_row(rows)),
            calibrated: after.map(|after| shown_errors(after.by_row(rows))),
            si_unit,
        };
        refuse_overflow(&entry, request.log_file)?;
        all.push(entry);
    }
    Ok(all)
}

/// A reading such as 1e300 has no finite root mean square, and no place in a plot.
fn refuse_overflow(entry: &ChannelErrors, log: &Path) -> Result<(), Failure> {
    let sizes = [entry.rms_nominal, entry.rms_calibrated];
    if sizes.into_iter().flatten().all(f64::is_finite) {
        return Ok(());
    }
    let what = format!("an error of {} is too large to be squared", entry.name);
    Err(Failure::overflow(what, &entry.name, log, None))
}

fn title(device: &Device, channel: Channel) -> String {
    match channel {
        Channel::Output { joint } => {
            let name = &device.joints[joint].name;
            let number = (joint + 1).to_string();
            match name.as_str() {
                name if name.is_empty() || name == number => format!("output of joint {number}"),
                name => format!("output of joint {number} ({name})"),
            }
        }
        Channel::Cable { index } => format!("distance of cable {}", index + 1),
        Channel::Position => "handle position, distance from the tracked one".to_owned(),
        Channel::Orientation => "handle orientation, angle to the tracked one".to_owned(),
        other => other.name(),
    }
}

/// The point at which a cable leaves its guide; a chain without cables measures from frame (-1)'s origin.
fn exit_um(device: &Device, index: usize, file: &Path) -> Result<Option<[i64; 3]>, Failure> {
    let cable = device.cables.get(index);
    let exit = point_um(cable.map_or([0.0; 3], |cable| cable.anchor_m));
    let said = || {
        let number = index + 1;
        format!(
            "the exit of cable {number} is too far away to be drawn; give coordinates below {LARGEST_M:e} m"
        )
    };
    let exit = exit.ok_or_else(|| Failure::of_file("too-far", said(), file));
    exit.map(Some)
}

/// The tracked handle in frame (-1); none where the tracker sees a marker at some distance from the handle.
fn tracked_um(
    device: &Device,
    part: &Recording,
    log: &Path,
) -> Result<Option<Vec<Option<[i64; 3]>>>, Failure> {
    let places = &device.surroundings;
    let (Some([x, y, z]), None) = (&part.position_m, &places.tracker_tool) else {
        return Ok(None);
    };
    // several places of the tracker, or several markers
    if !device.mounts(part).is_ok_and(|mounts| mounts.is_empty()) {
        return Ok(None);
    }
    let base = places.tracker_base.unwrap_or_default().pose();
    let points = (0..part.len()).map(|row| {
        let seen = Vector3::new(x[row], y[row], z[row]);
        let point: [f64; 3] = (base.rotation.transpose() * (seen - base.position_m)).into();
        if !point.iter().all(|axis| axis.is_finite()) {
            return Ok(None);
        }
        let far = || too_far("tracked handle", (log, part.line[row]));
        point_um(point).ok_or_else(far).map(Some)
    });
    points.collect::<Result<_, _>>().map(Some)
}

/// Points one after the other \[um\].
fn flat_um(points: impl Iterator<Item = [f64; 3]>, at: (&Path, u64)) -> Result<Vec<i64>, Failure> {
    let mut flat = Vec::new();
    for point in points {
        flat.extend(point_um(point).ok_or_else(|| too_far("arm", at))?);
    }
    Ok(flat)
}

/// A point in whole micrometres; none beyond [`LARGEST_M`].
fn point_um(point_m: [f64; 3]) -> Option<[i64; 3]> {
    let inside = point_m.iter().all(|axis| axis.abs() <= LARGEST_M);
    inside.then(|| point_m.map(|axis| (axis * PER_METRE).round() as i64))
}

fn too_far(what: &str, (log, line): (&Path, u64)) -> Failure {
    let what = format!("the {what} reaches too far to be drawn");
    let next = format!("lengths are in metres, and coordinates stay below {LARGEST_M:e} m");
    Failure::placed("too-far", what, log, (line, 0), next)
}

/// Rows whose run is not that of the row before.
fn run_starts(part: &Recording) -> Vec<usize> {
    let Some(run) = &part.run else {
        return Vec::new();
    };
    let starts = (1..run.len()).filter(|&row| run[row] != run[row - 1]);
    starts.collect()
}

/// Rounded to digits after the point; a number too large for that stays as it is.
fn rounded(value: f64, decimals: i32) -> f64 {
    let factor = 10_f64.powi(decimals);
    let shown = (value * factor).round() / factor;
    if shown.is_finite() { shown } else { value }
}
