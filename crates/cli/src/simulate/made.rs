//! The simulated log itself: row by row where each row says all, else as a whole.

use std::path::Path;

use haptical::effects::device::{add_effects, bare};
use haptical::files::make_folder;
use haptical_data::{LogFile, LogShape};
use haptical_model::{Device as Model, Recording};
use haptical_simulator::{
    Effects, HandMotion, MotionSettings, MotionSimulation, SimulatorError, add_tracker,
    record_motion, simulate_motion,
};

use super::SimulateArguments;
use crate::failure::Failure;
use crate::flags::outputs::Outputs;
use crate::interrupt::Writing;
use crate::progress::Progress;

/// Rows made at a time: enough that progress costs nothing, few enough to take no memory.
const ROWS_AT_A_TIME: usize = 1000;
/// Most rows of a log that is made as a whole: some gigabytes.
const MOST_ROWS: f64 = 5e6;

/// Makes the log and writes it; how many rows. `refuse` says what the simulator refuses, of the file that it came from.
pub(super) fn write(
    (arguments, outputs): (&SimulateArguments, &Outputs<'_>),
    truth: &Model,
    effects: &Effects,
    refuse: &dyn Fn(SimulatorError) -> Failure,
) -> Result<u64, Failure> {
    let settings = MotionSettings {
        motion: HandMotion {
            seconds: arguments.seconds,
            rate_hz: arguments.rate_hz,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let progress = Progress::start("preparing the motion");
    // where a row depends on what was before, or a tracker sees the device
    if !truth.effects.is_empty() || truth.has_compliance() || truth.tracker.is_some() {
        let made = whole(arguments, truth, (effects, &settings), refuse, &progress)?;
        outputs.write_log(&made, &LogShape::from(truth))?;
        return Ok(made.len() as u64);
    }
    let simulation = simulate_motion(truth, effects, &settings, arguments.seed).map_err(refuse)?;
    by_rows(arguments, simulation, truth, refuse, &progress)
}

fn by_rows(
    arguments: &SimulateArguments,
    mut simulation: MotionSimulation<'_>,
    truth: &Model,
    refuse: &dyn Fn(SimulatorError) -> Failure,
    progress: &Progress,
) -> Result<u64, Failure> {
    let rows = simulation.rows();
    let mut chunk = simulation.no_rows();
    // Declared before the log, so that its temporary file is gone first.
    let writing = Writing::begin();
    let _folder = make_folder(arguments.out.parent().unwrap_or(Path::new("")))?;
    let mut log = LogFile::create(&arguments.out, &chunk, &LogShape::from(truth))?;
    let mut written = 0;
    loop {
        writing.go_on(&arguments.out)?;
        let count = simulation
            .fill(&mut chunk, ROWS_AT_A_TIME)
            .map_err(refuse)?;
        if count == 0 {
            break;
        }
        log.write_rows(&chunk)?;
        written += count;
        progress.say(format!("{written} of {rows} rows"));
    }
    progress.say("closing the log");
    log.finish()?;
    Ok(rows)
}

fn whole(
    arguments: &SimulateArguments,
    truth: &Model,
    (effects, settings): (&Effects, &MotionSettings),
    refuse: &dyn Fn(SimulatorError) -> Failure,
    progress: &Progress,
) -> Result<Recording, Failure> {
    let rows = arguments.seconds * arguments.rate_hz;
    if rows > MOST_ROWS {
        let what = format!(
            "a log of {rows:e} rows is asked for, of a device whose effects or tracker need it in memory as a whole"
        );
        let next = format!("give other --seconds or --rate-hz: at most {MOST_ROWS:e} rows");
        return Err(Failure::command_line("arguments", what, next));
    }
    let mut rigid = bare(truth);
    rigid.surroundings.compliance.clear();
    progress.say("moving the device");
    let mut recording = record_motion(&rigid, effects, settings, arguments.seed).map_err(refuse)?;
    add_tracker(&rigid, &mut recording, arguments.seed).map_err(refuse)?;
    progress.say("adding its effects");
    add_effects(truth, &mut recording).map_err(|error| {
        let next = "give every effect its numbers, or take it out of the device file";
        let path = arguments.truth.as_ref().unwrap_or(&arguments.device);
        Failure::in_file("effect", error.to_string(), path, next)
    })?;
    Ok(recording)
}
