//! An arm with parallel joints, all of whose numbers a plain search returns and whose data fix fewer.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

use anyhow::{Context, Result};
use haptical_calibration::{
    Channel, DeviceProblem, FitRequest, HeldOut, Options, ParameterFit, Weighting, Weights,
    fit_parameters, with_curvature,
};
use haptical_identification::{Convergence, Settings, Status, solve};
use haptical_metrics::{position_errors_m, rms};
use haptical_model::{Device, ParameterId, Recording};
use haptical_report::Table;
use haptical_simulator::true_poses;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use xtask_output::{Output, cells};

use super::held::{Held, Interval, Kind, intervals};
use super::rigs::{TRACKER_SD_M, generator, tracked};

/// Modified Denavit-Hartenberg rows 1 to 6 of an arm like the UR10, (a, alpha, theta, d) in m and rad: the axes
/// of joints 2 and 3 are parallel, and of 4 in the real arm; here joint 4 can be turned out of their plane.
const ROWS: [[f64; 4]; 6] = [
    [0.0, 0.0, 0.0, 0.1273],
    [0.0, FRAC_PI_2, PI, 0.0],
    [0.612, 0.0, 0.0, 0.0],
    [0.5723, 0.0, 0.0, 0.163_941],
    [0.0, -FRAC_PI_2, 0.0, 0.1157],
    [0.0, FRAC_PI_2, PI, 0.0922],
];

/// Twist of row 4 of the arm with only two parallel joints \[rad\].
const TURNED_RAD: f64 = 0.9;
/// Where the tracked point is in the last joint's frame \[m\]: x and z.
const TOOL_M: [f64; 2] = [0.07, 0.11];
const POSES: usize = 200;
/// Standard deviations of the true deviations \[m, rad\], those of parallel twists left out.
const DEVIATIONS: (f64, f64) = (1e-3, 3e-3);
/// True twists between the parallel axes \[rad\].
const TWISTS_RAD: [f64; 6] = [0.0, 1e-5, 1e-4, 1e-3, 1e-2, 5e-2];
/// Most that our error at unseen postures may be above that of the plain search.
const AS_GOOD: f64 = 1.05;

pub(super) fn section(output: &mut Output) -> Result<()> {
    output.section("Parallel joints");
    output.words(format!(
        "An arm like the UR10: six joints, 24 modified Denavit-Hartenberg parameters, {POSES} random poses, a tracker \
         of {} mm on each axis. Joints 2 and 3 are parallel (and 4, in the arm with three), but for a true twist; \
         sliding along parallel axes is one number, not two. The plain search is Levenberg-Marquardt over all 24 \
         parameters without a look at their rank, as a calibration program does that takes them all; ours decides the \
         rank first. The error at unseen postures is the rms distance between predicted and true positions of \
         {POSES} others, without noise.",
        TRACKER_SD_M * 1e3
    ));
    let columns = "parallel joints | true twist [mrad] | plain search says | its largest angle error [mrad] | its \
             largest length error [mm] | rank of 24, nominal | said of d3 | d3's interval | largest error over \
             interval | error at unseen postures, ours [mm] | plain [mm]";
    let mut table = Table::with_heads("Parallel joints", columns);
    let (mut named, mut honest, mut as_good) = (true, true, true);
    for count in [2, 3] {
        for (number, twist_rad) in TWISTS_RAD.into_iter().enumerate() {
            let trial = Trial::new(count, twist_rad, number as u64)?;
            let plain = trial.plain()?;
            let ours = trial.ours()?;
            let place = trial.place("d3")?;
            let at_nominal = &ours.nominal_identifiability;
            let said = at_nominal.reason(place);
            let said = said.unwrap_or_else(|| "fixed".to_owned());
            named &= at_nominal.rank == 25 - count && said.contains("acts like");
            let worst = worst_over_interval(&ours, &trial.truth)?;
            honest &= worst.is_none_or(|worst| worst < FARTHEST);
            let (own, other) = (trial.unseen(&ours.device)?, trial.unseen(&plain.device)?);
            as_good &= own <= AS_GOOD * other;
            let status = match &ours.identifiability.statuses[place] {
                Status::Dependent { .. } | Status::Invisible => "none: dependent".to_owned(),
                Status::Weak { .. } => "none: weak".to_owned(),
                Status::Identifiable { standard_deviation } => {
                    format!("+-{:.2} mm", 1.96e3 * standard_deviation)
                }
            };
            let errors = trial.errors(&plain.device);
            table.push(cells! {
                count => 0, twist_rad * 1e3 => 2, plain.says, errors.0 * 1e3 => 2,
                errors.1 * 1e3 => 2, at_nominal.rank => 0, said, status,
                worst => 2, own * 1e3 => 4, other * 1e3 => 4,
            })?;
        }
    }
    output.table("parallel-joints", table)?;
    output.verdict(
        named,
        "rank 23 of 24 (22 with three parallel joints) and the combination are named at the nominal arm",
    );
    let text = format!(
        "no interval that is given, those of combinations and of their members included, misses the truth by more than {FARTHEST} of its half widths"
    );
    output.verdict(honest, text);
    let text = format!(
        "unseen positions are predicted as well as by the plain search, within {:.0} %",
        100.0 * (AS_GOOD - 1.0)
    );
    output.verdict(as_good, text);
    coverage(output)
}

/// Half widths of a 95 % interval that hold the truth of some twenty parameters in all rows, but for one run in a
/// hundred: 4 standard deviations.
const FARTHEST: f64 = 2.0;

struct Trial {
    nominal: Device,
    truth: Device,
    seen: Recording,
    unseen: Recording,
    parameters: Vec<ParameterId>,
}

struct Plain {
    device: Device,
    says: &'static str,
}

impl Trial {
    /// An arm whose parallel axes are twisted by so much, its other parameters off by [`DEVIATIONS`].
    fn new(parallel: usize, twist_rad: f64, seed: u64) -> Result<Self> {
        let size = |parameter: ParameterId, nominal: &Device, normal: f64| {
            let name = parameter.name(nominal);
            match parameter.unit(nominal) {
                "m" => DEVIATIONS.0 * normal,
                _ if name == "alpha3" || (parallel == 3 && name == "alpha4") => twist_rad,
                _ => DEVIATIONS.1 * normal,
            }
        };
        Self::with_deviations(parallel, seed, size)
    }

    /// An arm all of whose parameters are off by draws of their plausible sizes.
    fn plausible(parallel: usize, seed: u64) -> Result<Self> {
        let size = |parameter: ParameterId, nominal: &Device, normal: f64| {
            parameter.plausible_size(nominal) * normal
        };
        Self::with_deviations(parallel, seed, size)
    }

    fn with_deviations(
        parallel: usize,
        seed: u64,
        size: impl Fn(ParameterId, &Device, f64) -> f64,
    ) -> Result<Self> {
        let nominal = arm(parallel)?;
        let parameters: Vec<ParameterId> = nominal
            .link_parameters(false)
            .into_iter()
            .filter(|parameter| matches!(parameter, ParameterId::Link { row: 1..=6, .. }))
            .collect();
        let mut random = generator(seed, 20 + parallel as u64);
        let mut truth = nominal.clone();
        for &parameter in &parameters {
            let normal: f64 = StandardNormal.sample(&mut random);
            let amount = size(parameter, &nominal, normal);
            parameter.set(&mut truth, parameter.value(&nominal) + amount);
        }
        let mut poses = |rows: usize, sd_m: f64| -> Result<Recording> {
            let joint = |index: usize, random: &mut rand_chacha::ChaCha8Rng| -> Vec<f64> {
                let reach = if index < 6 { 2.5 } else { 0.0 };
                let each = (0..rows).map(|_| reach * random.random_range(-1.0..1.0));
                each.collect()
            };
            let mut recording = Recording {
                line: (2..2 + rows as u64).collect(),
                joint: (0..7).map(|index| joint(index, &mut random)).collect(),
                output: vec![None; 7],
                ..Recording::default()
            };
            let poses = true_poses(&truth, &recording)?;
            recording.position_m = Some(tracked(&poses, sd_m, &mut random));
            Ok(recording)
        };
        let seen = poses(POSES, TRACKER_SD_M)?;
        let unseen = poses(POSES, 0.0)?;
        Ok(Self {
            nominal,
            truth,
            seen,
            unseen,
            parameters,
        })
    }

    fn place(&self, name: &str) -> Result<usize> {
        let mut parameters = self.parameters.iter();
        let place = parameters.position(|own| own.name(&self.nominal) == name);
        place.context("no such parameter")
    }

    /// All parameters at once, whatever their rank.
    fn plain(&self) -> Result<Plain> {
        let (nominal, seen, parameters) = (&self.nominal, &self.seen, &self.parameters);
        let channels = [Channel::Position];
        let weights = Weights::stated(nominal, &channels);
        let problem = DeviceProblem::new(nominal, seen, &channels, parameters, &weights)?;
        let all: Vec<usize> = (0..parameters.len()).collect();
        // tolerances as MINPACK's users set them, and no question of rank
        let settings = Settings {
            cost_tolerance: 1e-16,
            step_tolerance: 1e-8,
            rank_tolerance: 0.0,
            ..Settings::default()
        };
        let fit = solve(&problem, &problem.start(), &all, &settings)?;
        Ok(Plain {
            says: match fit.convergence {
                Convergence::IterationLimit => "iteration limit",
                Convergence::NoFurtherDescent => "no descent",
                Convergence::RankLost => "dependent",
                _ => "converged",
            },
            device: problem.device_with(&fit.parameters),
        })
    }

    fn ours(&self) -> Result<ParameterFit> {
        let channels = [Channel::Position];
        let weights = Weights::stated(&self.nominal, &channels);
        let options = Options {
            weighting: Weighting::Stated,
            held_out: HeldOut::None,
            ..Options::default()
        };
        let fit = fit_parameters(&FitRequest {
            what: "parallel joints",
            device: &self.nominal,
            recording: &self.seen,
            channels: &channels,
            parameters: &self.parameters,
            unsupported: &[],
            weights: &weights,
            options: &options,
            start: None,
            yielded: None,
        })?;
        Ok(with_curvature(fit, &self.seen, &channels, &weights)?)
    }

    /// Root mean square distance between predicted and true positions.
    fn unseen(&self, device: &Device) -> Result<f64> {
        let points = |device: &Device| -> Result<Vec<[f64; 3]>> {
            let poses = true_poses(device, &self.unseen)?;
            Ok(poses.iter().map(|pose| pose.position_m.into()).collect())
        };
        let errors_m = position_errors_m(&points(device)?, &points(&self.truth)?)?;
        Ok(rms(&errors_m)?)
    }

    /// Largest errors of angles \[rad\] and lengths \[m\].
    fn errors(&self, device: &Device) -> (f64, f64) {
        let (mut angle, mut length) = (0.0_f64, 0.0_f64);
        for parameter in &self.parameters {
            let error = (parameter.value(device) - parameter.value(&self.truth)).abs();
            match parameter.unit(&self.nominal) {
                "m" => length = length.max(error),
                _ => angle = angle.max(error),
            }
        }
        (angle, length)
    }
}

/// Largest error of a parameter or a combination with an interval, over its half width.
fn worst_over_interval(fit: &ParameterFit, truth: &Device) -> Result<Option<f64>> {
    let found = intervals(fit, truth)?.into_iter();
    let missed = found.map(|found| found.error_over_half_width.abs());
    Ok(missed.reduce(f64::max))
}

/// How often intervals hold the truth of arms whose parameters deviate by draws of their plausible sizes.
fn coverage(output: &mut Output) -> Result<()> {
    let columns = "parallel joints | quantity | intervals | hold the truth [%] | lowest [%] | of";
    let mut table = Table::with_heads("Coverage with plausible deviations", columns);
    let mut is_covered = true;
    for count in [2, 3] {
        let fits: Vec<Result<Vec<Interval>>> = (0..ARMS)
            .into_par_iter()
            .map(|seed| {
                let trial = Trial::plausible(count, seed)?;
                intervals(&trial.ours()?, &trial.truth)
            })
            .collect();
        let mut kinds: BTreeMap<Kind, BTreeMap<String, Held>> = BTreeMap::new();
        for found in fits {
            for own in found? {
                let names = kinds.entry(own.kind).or_default();
                let count = names.entry(own.name).or_default();
                count.count(own.error_over_half_width.abs() <= 1.0);
            }
        }
        for (kind, names) in kinds {
            let all = Held {
                held: names.values().map(|own| own.held).sum(),
                all: names.values().map(|own| own.all).sum(),
            };
            let often = names.iter().filter(|(_, own)| own.is_often(ARMS as usize));
            let lowest = often.min_by(|a, b| a.1.percent().total_cmp(&b.1.percent()));
            let (lowest, least) = lowest.context("no interval was given often")?;
            is_covered &= (93.0..=98.0).contains(&all.percent());
            table.push(cells! {
                count => 0, kind.name(), all.all => 0, all.percent() => 2, least.percent() => 1,
                lowest.as_str(),
            })?;
        }
    }
    output.table("parallel-joints-coverage", table)?;
    let text = format!(
        "of {ARMS} arms each whose parameters deviate by draws of their plausible sizes, 93 to 98 % of the intervals \
         of every kind hold the truth"
    );
    output.verdict(is_covered, text);
    Ok(())
}

/// Arms of each number of parallel joints.
const ARMS: u64 = 200;

/// The nominal arm; its seventh row is the tool, behind a joint that rests.
fn arm(parallel: usize) -> Result<Device> {
    let mut text = "[device]\nname = \"six joints\"\nconvention = \"modified\"\n".to_owned();
    let mut link = |[a, alpha, theta, d]: [f64; 4]| {
        text += &format!(
            "[[link]]\na_m = {a:?}\nalpha_rad = {alpha:?}\ntheta_offset_rad = {theta:?}\nd_m = {d:?}\n"
        );
    };
    link([0.0; 4]);
    for (index, mut row) in ROWS.into_iter().enumerate() {
        if index == 3 && parallel == 2 {
            row[1] = TURNED_RAD;
        }
        link(row);
    }
    link([TOOL_M[0], 0.0, 0.0, TOOL_M[1]]);
    text += &"[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n".repeat(7);
    text += &format!(
        "[tracker]\nbase = \"known\"\ntool = \"known\"\nposition_sd_m = {TRACKER_SD_M}\nscale_sd = 0.0\n"
    );
    Ok(Device::from_toml(&text, "six joints")?.device)
}
