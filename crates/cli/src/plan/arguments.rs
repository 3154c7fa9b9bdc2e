//! Flags of `haptical plan`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use haptical::{Device, SettleRequest};
use haptical_design::{Criterion, DEGREE, KINDS, Limits, Region, Request, Rig, Spread, Terms};

use crate::arguments::{above_zero, one_or_more, whole_number};
use crate::failure::Failure;
use crate::flags::{DeviceOptions, OverwriteOptions};

/// The arguments of the command.
#[derive(Debug, Args)]
pub(crate) struct PlanArguments {
    /// Device file (TOML, URDF or MJCF)
    #[arg(long, value_name = "FILE")]
    pub(crate) device: PathBuf,
    #[command(flatten)]
    pub(crate) device_options: DeviceOptions,
    /// A rig: measurements separated by commas; give it again to compare rigs. The first one is what
    /// --poses plans for. With --rig a tracker's base and tool are known or unknown as its file says. Without it: what the
    /// device and rig files describe, with a position and a pose
    #[arg(long, value_name = "RIG")]
    pub(crate) measure: Vec<String>,
    /// Folder for plan.json, plan.html, rigs.svg, poses.csv and report.html; made if it is missing
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteOptions,
    /// Number of poses to choose, written to poses.csv
    #[arg(long, value_name = "N", value_parser = one_or_more, allow_negative_numbers = true)]
    pub(crate) poses: Option<NonZeroUsize>,
    /// What the poses are best for
    #[arg(long, value_enum, default_value_t = CriterionName::D)]
    pub(crate) criterion: CriterionName,
    /// Where the task is done: x,y,z,r of a ball in m, or low:high of each joint's reading
    #[arg(long, value_name = "REGION", value_parser = region, allow_hyphen_values = true)]
    pub(crate) region: Option<Region>,
    /// Poses to choose from (default 2000), or with --settle motions (default 240)
    #[arg(long, value_name = "M", value_parser = one_or_more, allow_negative_numbers = true)]
    pub(crate) candidates: Option<NonZeroUsize>,
    /// Seed of the candidates and of the search's random starts
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole_number, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Log of poses that were measured with the first rig already: the next ones add to them. With --settle the log of the
    /// diagnosis; give it again for each of several
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Vec<PathBuf>,
    /// gap.json of a diagnosis that is ambiguous or unknown: choose the recording that tells its candidates apart
    #[arg(long, value_name = "FILE", requires = "log", conflicts_with_all = ["measure", "poses", "known_transmissions"])]
    pub(crate) settle: Option<PathBuf>,
    /// Rows of the recording that settles, at most; without it as many as the log has
    #[arg(long, value_name = "N", requires = "settle", value_parser = one_or_more, allow_negative_numbers = true)]
    pub(crate) rows: Option<NonZeroUsize>,
    /// Force in N with which the hand can press on the handle while it moves; without it what the log shows
    #[arg(long, value_name = "NEWTONS", requires = "settle", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) press: Option<f64>,
    /// How candidates are spread between the joint limits
    #[arg(long, value_enum, default_value_t = SpreadName::Uniform)]
    pub(crate) spread: SpreadName,
    /// Box that the handle stays in: lowest x,y,z then highest x,y,z in frame (-1), in m
    #[arg(long, value_name = "BOX", value_parser = workspace, allow_hyphen_values = true)]
    pub(crate) workspace: Option<[[f64; 3]; 2]>,
    /// Shortest and longest length of every cable in m
    #[arg(long, value_name = "MIN,MAX", value_parser = lengths)]
    pub(crate) cable_length: Option<[f64; 2]>,
    /// Radius of the links in m: poses in which links overlap are left out, but for neighbours and those that less than
    /// two radii join
    #[arg(long, value_name = "METRES", value_parser = above_zero, allow_negative_numbers = true)]
    pub(crate) link_radius: Option<f64>,
    /// Take the transmissions as known, as the second step of a two-step calibration does
    #[arg(long)]
    pub(crate) known_transmissions: bool,
    /// Print plan.json instead of the tables
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CriterionName {
    /// Smallest confidence ellipsoid of all parameters
    D,
    /// Smallest mean variance of the parameters over their plausible sizes
    A,
    /// Largest observability index O1
    O1,
    /// Smallest error of the handle's position in the region
    TaskPosition,
    /// Smallest error of the force's direction in the region
    TaskForce,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpreadName {
    /// Uniform between the limits
    Uniform,
    /// Normal about home, with the device file's sampling_sd_rad
    Normal,
}

impl PlanArguments {
    /// What is asked of the library.
    pub(crate) fn request(&self, device: &Device) -> Result<Request, Failure> {
        let usual = Request::default();
        let rigs = self.measure.iter().map(|text| Rig::parse(text));
        Ok(Request {
            rigs: rigs
                .collect::<Result<_, _>>()
                .map_err(|error| Failure::design(&error, &device.source().path))?,
            terms: match self.known_transmissions {
                true => Terms::Known,
                false => Terms::Degree(DEGREE),
            },
            limits: self.limits(),
            candidates: self.candidates.map_or(usual.candidates, NonZeroUsize::get),
            seed: self.seed,
            poses: self.poses.map_or(usual.poses, NonZeroUsize::get),
            chooses: self.poses.is_some(),
            criterion: self.criterion.into(),
            region: self.region.clone().unwrap_or(Region::Everywhere),
        })
    }

    /// The same for a recording that settles a diagnosis.
    pub(crate) fn settling(&self) -> SettleRequest {
        let usual = SettleRequest::default();
        SettleRequest {
            rows: self.rows.map(NonZeroUsize::get),
            candidates: self.candidates.map_or(usual.candidates, NonZeroUsize::get),
            limits: self.limits(),
            seed: self.seed,
            press_n: self.press,
        }
    }

    fn limits(&self) -> Limits {
        let usual = Limits::default();
        Limits {
            spread: match self.spread {
                SpreadName::Uniform => Spread::Uniform,
                SpreadName::Normal => Spread::Normal,
            },
            workspace_m: self.workspace,
            cable_m: self.cable_length.unwrap_or(usual.cable_m),
            link_radius_m: self.link_radius,
        }
    }
}

impl From<CriterionName> for Criterion {
    fn from(name: CriterionName) -> Self {
        match name {
            CriterionName::D => Self::D,
            CriterionName::A => Self::A,
            CriterionName::O1 => Self::O1,
            CriterionName::TaskPosition => Self::TaskPosition,
            CriterionName::TaskForce => Self::TaskForce,
        }
    }
}

fn numbers<const N: usize>(text: &str, wanted: &str) -> Result<[f64; N], String> {
    let refuse = || format!("{wanted} are expected, separated by commas");
    let parts = text
        .split(',')
        .map(|part| match part.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(refuse()),
        });
    let parts: Vec<f64> = parts.collect::<Result<_, _>>()?;
    parts.try_into().map_err(|_| refuse())
}

fn region(text: &str) -> Result<Region, String> {
    if !text.contains(':') {
        let [x, y, z, radius_m] = numbers(text, "four numbers x,y,z,r in m")?;
        let centre_m = [x, y, z];
        return Ok(Region::Ball { centre_m, radius_m });
    }
    let ranges = text.split(',').map(|range| {
        let ends = range
            .split_once(':')
            .ok_or("low:high is expected for each joint")?;
        let [low, high] = numbers(&format!("{},{}", ends.0, ends.1), "two numbers low:high")?;
        Ok([low, high])
    });
    Ok(Region::Joints(ranges.collect::<Result<_, String>>()?))
}

fn workspace(text: &str) -> Result<[[f64; 3]; 2], String> {
    let [x, y, z, x2, y2, z2] = numbers(text, "six numbers x,y,z,x,y,z in m")?;
    Ok([[x, y, z], [x2, y2, z2]])
}

fn lengths(text: &str) -> Result<[f64; 2], String> {
    numbers(text, "two lengths in m")
}

/// Example and kinds of measurement, for `--help`.
pub(crate) fn help() -> String {
    let mut help = "\
Example:
  haptical plan --device device.toml --measure out,cable --measure out,cable,cable2:0.4,0,0.3 --out plan
  haptical plan --device device.toml --measure out,cable --poses 100 --out plan
  haptical plan --device device.toml --settle result/gap.json --log log.csv --out next

Writes plan/plan.json, plan/plan.html (a page), plan/rigs.svg and plan/report.html, an index of the results
in the folder, with --poses plan/poses.csv too: all or none. Files of an earlier `haptical plan` are
overwritten, and one that is not written again is removed; others need --force.

With --settle the next recording is chosen: gap.json is what `haptical diagnose` wrote of an ambiguous or unknown answer,
--log the log that it was made from. next/poses.csv is the motion to record, row by row: times and joint readings, with
fx_n, fy_n, fz_n where the hand is to press. Said first: the odds to expect of the true candidate. Then
`haptical diagnose --log log.csv --log next.csv` judges both logs together.

Measurements of a rig:
"
    .to_owned();
    for kind in KINDS {
        help.push_str(&format!("  {}\n      {}\n", kind.form, kind.meaning));
    }
    help
}
