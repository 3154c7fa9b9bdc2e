//! From how far away a search finds the device, with and without random places to start from.

use anyhow::Result;
use haptical_calibration::{
    CalibrationMethod, Channel, HeldOut, Options, ParameterFit, Weighting, Weights, fit_kinematics,
    predict_distances,
};
use haptical_metrics::rms;
use haptical_model::{Device, Parameter, ParameterId};
use haptical_report::{Figure, Mark, Series, Table};
use haptical_simulator::{Settings, simulate, true_poses};
use rand::RngExt;
use xtask_output::{Output, Progress, cells};
use xtask_paper::Paper;

use super::rigs::{Errors, Rig, generator, nominal};

/// Rows of a recording, and unseen postures that a fit is judged at.
const ROWS: usize = 200;
const UNSEEN: usize = 100;
/// Root mean square error of distances at unseen postures up to which the device was found \[m\]: one standard
/// deviation of a reading. A fit at the right minimum has a third of it.
const FOUND_M: f64 = 1e-5;
/// The same in standard deviations that the fit states for these distances: at a posture near a singular one, or
/// with a weak parameter held, it states more than a reading's.
const AS_STATED: f64 = 2.0;
/// Largest errors of the start at size 10: of an angle \[rad\] and of a length \[m\].
const LARGEST: (f64, f64) = (10.0 * std::f64::consts::PI / 180.0, 0.05);
/// Sizes, in tenths of those, and in the paper's deviations.
const SIZES: [usize; 8] = [1, 2, 4, 6, 8, 10, 15, 20];
/// The size that the bar is of.
const BAR: usize = 10;

/// How the start is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Away {
    /// The paper's assigned deviations of Table 3, times a size, with random signs.
    Paper,
    /// Uniform, up to a size's share of 10 degrees and 50 mm.
    Uniform,
}

/// What became of one device.
#[derive(Debug, Clone, Copy, Default)]
struct Outcome {
    plain: Ended,
    tried: Ended,
    /// Random places were tried.
    doubted: bool,
    /// A random place led to the fit that was kept.
    replaced: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Ended {
    Found,
    /// Elsewhere, and it says so: an error, or a doubt that remains.
    Told,
    /// Elsewhere, without a word.
    #[default]
    Silent,
}

pub(super) fn section(output: &mut Output, devices: usize) -> Result<()> {
    let paper = Paper::load()?;
    output.section("Convergence basin");
    output.words(format!(
        "Step 2 with known joint angles: {devices} devices a row, {ROWS} distances each with the stated noise, searched \
         from a device file that is wrong by the size given. `Paper`: Table 3's deviations times the size, with random \
         signs. `Uniform`: every angle within +- size x 1 degree, every length within +- size x 5 mm, so 10 degrees \
         and 50 mm at 10 (and twice that at 20, for the limit). A device counts as found where the distances of {UNSEEN} unseen postures come out with an \
         rms error below {} um, or below {AS_STATED} of the standard deviations that the fit itself states for them. \
         Without random places a search that is doubted (it failed, its residual is above five times the stated \
         noise, a value is over ten plausible sizes off, or no plausible value of a held parameter explains the \
         residual) only says so; with them 12 others are \
         tried.",
        FOUND_M * 1e6
    ));
    let columns = "start wrong by | size | found by one search [%] | wrong and warned of [%] | wrong, silent [%] | doubted \
             [%] | found with random places [%] | wrong and warned of [%] | wrong, silent [%]";
    let mut table = Table::with_heads("Starts and what was reached", columns);
    let nominal = nominal(Rig::Cable, Errors::Gaussian)?;
    let mut curves: Vec<Curves> = Vec::new();
    let (mut silent, mut all, mut lost, mut gained) = (0, 0, 0, 0);
    for (away, name) in [(Away::Paper, "paper"), (Away::Uniform, "uniform")] {
        let progress = Progress::new(&format!("starts, {name}"), devices * SIZES.len());
        let (mut one, mut many) = (Vec::new(), Vec::new());
        for size in SIZES {
            let of_seed = |seed| device(&nominal, &paper, (away, size), seed);
            let outcomes = progress.over(devices, of_seed).into_iter();
            let outcomes = outcomes.collect::<Result<Vec<Outcome>>>()?;
            let count =
                |of: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|own| of(own)).count();
            let share = |of: &dyn Fn(&Outcome) -> bool| 100.0 * count(of) as f64 / devices as f64;
            silent += count(&|o| o.tried == Ended::Silent);
            lost += count(&|o| o.plain == Ended::Found && o.tried != Ended::Found);
            gained += count(&|o| o.plain != Ended::Found && o.tried == Ended::Found && o.replaced);
            all += devices;
            one.push((size as f64, share(&|o| o.plain == Ended::Found)));
            many.push((size as f64, share(&|o| o.tried == Ended::Found)));
            table.push(cells! {
                name, size => 0, share(&|o| o.plain == Ended::Found) => 1,
                share(&|o| o.plain == Ended::Told) => 1, share(&|o| o.plain == Ended::Silent) => 1,
                share(&|o| o.doubted) => 1, share(&|o| o.tried == Ended::Found) => 1,
                share(&|o| o.tried == Ended::Told) => 1, share(&|o| o.tried == Ended::Silent) => 1,
            })?;
        }
        curves.push((name, one, many));
    }
    output.table("basin", table)?;
    let caption = "Found devices against the size of the start's error";
    output.figure("basin", caption, &figure(&curves))?;
    let text = format!("no fit ends at a wrong minimum without a word: {silent} of {all} do");
    output.verdict(silent == 0, text);
    let text = format!(
        "random places lose no device that one search finds: {lost}; they find {gained} more"
    );
    output.verdict(lost == 0, text);
    let at_bar = |point: &&(f64, f64)| point.0 == BAR as f64;
    let uniform = curves.last();
    let uniform = uniform.and_then(|(.., many)| many.iter().find(at_bar));
    let farthest = uniform.map_or(0.0, |point| point.1);
    let text =
        format!("from up to 10 degrees and 50 mm away {farthest:.1} % are found (bar: 95 %)");
    output.verdict(farthest >= 95.0, text);
    Ok(())
}

/// Name of a way, and shares found by one search and with random places, by size.
type Curves = (&'static str, Vec<(f64, f64)>, Vec<(f64, f64)>);

fn figure(curves: &[Curves]) -> Figure {
    let mut figure = Figure::new(
        "Found device",
        "size of the start's error",
        "devices found [%]",
    );
    for (index, (name, one, many)) in curves.iter().enumerate() {
        let label = |way: &str| format!("{name}, {way}");
        let one = Series::new(label("one search"), Mark::DashedLine, index, one.clone());
        figure.series.push(one);
        figure.line(label("random places"), index, many.clone());
    }
    figure
}

fn device(
    nominal: &Device,
    paper: &Paper,
    (away, size): (Away, usize),
    seed: u64,
) -> Result<Outcome> {
    let mut random = generator(seed, 10 + size as u64);
    let mut truth = nominal.clone();
    let mut move_by = |parameter: ParameterId, amount: f64, truth: &mut Device| {
        let amount = amount * random.random_range(-1.0..1.0);
        parameter.set(truth, parameter.value(nominal) + amount);
    };
    match away {
        Away::Uniform => {
            for parameter in nominal.link_parameters(false) {
                let share = size as f64 / 10.0;
                let largest = match parameter {
                    ParameterId::Link {
                        parameter: Parameter::A | Parameter::D | Parameter::B,
                        ..
                    } => LARGEST.1,
                    _ => LARGEST.0,
                };
                move_by(parameter, share * largest, &mut truth);
            }
        }
        Away::Paper => {
            for row in &paper.table3 {
                let parameter = nominal.parameter(&row.name)?;
                let sign = if random.random_range(0.0..1.0) < 0.5 {
                    -1.0
                } else {
                    1.0
                };
                let amount = sign * size as f64 * row.assigned;
                parameter.set(&mut truth, parameter.value(nominal) + amount);
            }
        }
    }
    let recording = simulate(&truth, &Settings::paper(), ROWS, seed)?;
    let unseen = simulate(&truth, &Settings::paper(), UNSEEN, seed ^ (1 << 40))?;
    let actual = true_poses(&truth, &unseen)?;
    let mut options = Options {
        method: CalibrationMethod::TwoStep,
        weighting: Weighting::Stated,
        held_out: HeldOut::None,
        ..Options::default()
    };
    options.rules.singular_values = false;
    let fit = |starts: usize| {
        let channels = [Channel::Cable { index: 0 }];
        let weights = Weights::stated(nominal, &channels);
        let options = Options {
            starts,
            ..options.clone()
        };
        fit_kinematics(nominal, &recording, &channels, &weights, &options)
    };
    let ended = |fit: &ParameterFit| -> Result<Ended> {
        let found = true_poses(&fit.device, &unseen)?;
        let pairs = found.iter().zip(&actual);
        let errors: Vec<f64> = pairs
            .map(|(found, actual)| found.position_m.norm() - actual.position_m.norm())
            .collect();
        let stated = || -> Result<f64> {
            let predicted = predict_distances(fit, &unseen, [0.0; 3])?;
            let deviations = predicted.iter();
            let deviations = deviations.map(|p| p.standard_deviation.unwrap_or(0.0));
            Ok(rms(&deviations.collect::<Vec<f64>>())?)
        };
        let error = rms(&errors)?;
        Ok(if error < FOUND_M || error < AS_STATED * stated()? {
            Ended::Found
        } else if fit.starts.doubt_that_remains.is_some() {
            Ended::Told
        } else {
            Ended::Silent
        })
    };
    let plain = fit(0).as_ref().map_or(Ok(Ended::Told), ended)?;
    let many = fit(Options::default().starts);
    let tried = many.as_ref().map_or(Ok(Ended::Told), ended)?;
    let starts = many.as_ref().map(|fit| &fit.starts);
    Ok(Outcome {
        plain,
        tried,
        doubted: starts.map_or(true, |starts| starts.doubt.is_some()),
        replaced: starts.is_ok_and(|starts| starts.replaced),
    })
}
