//! Planning: what rigs identify before anything is measured, and the poses to measure next.

mod flags;
mod page;
mod settle;
mod text;

use std::path::{Path, PathBuf};

use haptical_design::{NextPoses, Posture, Request, RigIdentifiability, Step, plan as plan_rigs};
use serde::Serialize;

use crate::device::Device;
use crate::error::Error;
use crate::files::{NewFile, PLAN_FILES, Record, ResultKind, VERSION, sealed_json};
use crate::log::Log;

pub use self::settle::{
    Chosen, ExpectedOdds, GapFile, SettleRequest, Settled, choose_next, settle, settle_as,
};

/// A plan with how it came about: the content of plan.json. It prints as the command's tables.
#[derive(Debug, Clone, Serialize)]
pub struct Planned {
    /// Device file.
    pub device: String,
    /// The plan in a line.
    pub answer: String,
    /// What each rig identifies, and the poses.
    #[serde(flatten)]
    pub plan: haptical_design::Plan,
    /// What is odd about the device and the log.
    pub warnings: Vec<String>,
    /// How the plan came about.
    pub provenance: Record,
    /// Header of poses.csv.
    #[serde(skip)]
    columns: Vec<String>,
    /// Which row each number in a parameter's name stands for, where the joints have names of their own; else empty.
    #[serde(skip)]
    named_rows: String,
}

/// Plans for a device; `measured` is a log of poses that were measured with the first rig already.
///
/// # Errors
/// A rig that fixes nothing, limits between which there are no poses, a device without what the plan needs.
pub fn plan(device: &Device, request: &Request, measured: Option<&Log>) -> Result<Planned, Error> {
    plan_as(VERSION, device, request, measured, &|_| ())
}

/// The same under the name of another version, for a result that is made again; `step` hears what is done.
///
/// # Errors
/// As [`plan`].
pub fn plan_as(
    version: &str,
    device: &Device,
    request: &Request,
    measured: Option<&Log>,
    step: &dyn Fn(Step<'_>),
) -> Result<Planned, Error> {
    device.refuse_hands("a plan")?;
    let postures = measured.map(postures).unwrap_or_default();
    let request = &as_stated(device, request);
    let plan = plan_rigs(&device.model, request, &postures, step)
        .map_err(|error| Error::design(&error, &device.source().path).with_equipment(device))?;
    let mut warnings = device.warnings.clone();
    warnings.extend(measured.iter().flat_map(|log| log.warnings.iter().cloned()));
    let mut inputs = device.inputs("device");
    inputs.extend(measured.and_then(|log| log.input("log")));
    let flags = device.equipment().chain_flags();
    let flags = flags.chain(flags::from_request(request));
    let mut provenance = Record::of(version, "plan", inputs, flags);
    provenance.seeds.insert("poses", request.seed);
    Ok(Planned {
        device: device.source().label.clone(),
        answer: text::answer(&plan),
        plan,
        warnings,
        provenance,
        named_rows: device.named_rows(),
        columns: device.joint_columns(),
    })
}

/// Poses of a log.
fn postures(log: &Log) -> Vec<Posture> {
    let recording = &log.recording;
    let row = |row: usize| recording.joint.iter().map(|column| column[row]).collect();
    let rows = 0..recording.len();
    rows.map(|number| Posture::free(row(number))).collect()
}

/// The request with what a rig file says of its tracker where a measurement says nothing.
fn as_stated(device: &Device, request: &Request) -> Request {
    let mut request = request.clone();
    if let Some(tracker) = &device.model.tracker
        && device.equipment().rig.is_some()
    {
        for rig in &mut request.rigs {
            *rig = rig.clone().with_tracker_as(tracker);
        }
    }
    request
}

impl Planned {
    /// Names of the files that are written; the last where poses were asked for only.
    pub const FILES: [&str; 4] = PLAN_FILES;

    fn rigs(&self) -> &[RigIdentifiability] {
        &self.plan.rigs
    }

    /// The poses to measure next, where they were asked for.
    pub fn next_poses(&self) -> Option<&NextPoses> {
        self.plan.next_poses.as_ref()
    }

    /// Names of the rigs' columns.
    fn rig_names(&self) -> impl Iterator<Item = String> {
        self.rigs().iter().map(|rig| rig.measure.clone())
    }

    /// The files, as they are written.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let [json_name, page_name, picture_name, poses_name] = Self::FILES;
        let mut files: Vec<NewFile<'static>> = Vec::new();
        if !self.rigs().is_empty() {
            let svg = page::picture(self)?;
            files.push((page_name, page::page(self, &svg)?.into_bytes()));
            files.push((picture_name, svg.into_bytes()));
        }
        if let Some(next) = self.next_poses() {
            files.push((poses_name, self.poses_csv(&next.postures)?));
        }
        let mut sealed = self.clone();
        sealed.provenance = sealed.provenance.with_outputs(&files);
        files.insert(0, (json_name, sealed_json(&sealed)?.into_bytes()));
        Ok(files)
    }

    /// Writes plan.json, plan.html, rigs.svg, where poses were asked for poses.csv, and report.html, an index of the
    /// results in the folder: all of them or none. A poses.csv of an earlier run is removed.
    ///
    /// # Errors
    /// The folder cannot be written to, or a file of these names in it is none that an earlier run wrote:
    /// [`crate::files::write_result`] can overwrite it.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        ResultKind::PLAN.write(folder.as_ref(), &self.files()?)
    }

    /// The joints' columns of a log, to drive to and then to measure at.
    fn poses_csv(&self, poses: &[Posture]) -> Result<Vec<u8>, Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut header = self.columns.clone();
        let has = |name: fn(&Posture) -> &String| poses.iter().any(|pose| !name(pose).is_empty());
        let contact = has(|posture| &posture.contact);
        let plane = has(|posture| &posture.plane);
        header.extend(contact.then(|| "contact".to_owned()));
        header.extend(plane.then(|| "plane".to_owned()));
        writer.write_record(&header).map_err(Error::internal)?;
        for posture in poses {
            let mut cells: Vec<String> = posture.readings.iter().map(f64::to_string).collect();
            cells.extend(contact.then(|| posture.contact.clone()));
            cells.extend(plane.then(|| posture.plane.clone()));
            writer.write_record(&cells).map_err(Error::internal)?;
        }
        writer.into_inner().map_err(Error::internal)
    }
}

impl std::fmt::Display for Planned {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        text::write(formatter, self)
    }
}
