//! The C that `haptical export` writes of a corrected device, compiled by this machine's compiler: what it predicts of a
//! recording.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, anyhow, ensure};
use haptical::effects::Context;
use haptical::effects::device::bare;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device as Model, Recording};
use xtask_blind::channel_of;
use xtask_output::{built_command, root, said};

/// Reads rows of doubles from its standard input and writes joint values and the place of the handle of each.
const PROGRAM: &str = include_str!("../assets/replay.c");

/// What a control loop would know of the device at the rows of a recording.
#[derive(Debug)]
pub(crate) struct Predicted {
    /// True joint values, joint by joint.
    output: Vec<Vec<f64>>,
    /// What each cable reads.
    cable_m: Vec<Vec<f64>>,
}

impl Predicted {
    /// What is predicted for a channel: an external encoder, a cable. Not a number at rows that the C refuses.
    pub(crate) fn channel(&self, name: &str) -> Option<&[f64]> {
        channel_of(name, &self.output, &self.cable_m).map(Vec::as_slice)
    }
}

/// What the exported C predicts of a recording; none where the device has effects that no control loop
/// sees or that began with a run of the first recording, or where the recording is of single postures.
pub(crate) fn predicted(
    corrected: &Model,
    recording: &Recording,
    haptical: &Path,
) -> Result<Option<Predicted>> {
    let base = bare(corrected);
    let context = Context::new(&base, recording, &[])?;
    // a control loop is later than every run of a log: what began with one of them is there in all of it
    let mut effects = corrected.effects.iter();
    let begins = effects.any(|effect| effect.numbers.contains_key("from_run"));
    if !context.ordered || begins {
        return Ok(None);
    }
    let folder = tempfile::tempdir()?;
    let Some(program) = compiled(corrected, haptical, folder.path())? else {
        return Ok(None);
    };
    let joints = corrected.joints.len();
    let rows = rows(corrected, recording, &context);
    let numbers = answered(&program, &rows)?;
    let width = joints + 3;
    let count = recording.len();
    ensure!(
        numbers.len() == width * count,
        "the C answered {} numbers for {count} rows",
        numbers.len()
    );
    let column = |index: usize| numbers.chunks_exact(width).map(move |row| row[index]);
    let cables = corrected.cables.iter().map(|cable| {
        let positions = numbers.chunks_exact(width);
        let readings = positions.map(|row| {
            if row[joints].is_nan() {
                return Ok(f64::NAN);
            }
            let position_m = Vector3::new(row[joints], row[joints + 1], row[joints + 2]);
            cable.reading(&position_m).map(|reading| reading.reading_m)
        });
        readings.collect::<Result<Vec<f64>, _>>()
    });
    Ok(Some(Predicted {
        output: (0..joints).map(|joint| column(joint).collect()).collect(),
        cable_m: cables.collect::<Result<_, _>>()?,
    }))
}

/// The command `haptical`, built beside this program; nothing, and a message, where it or a compiler is missing.
pub(crate) fn command() -> Option<PathBuf> {
    let compiler = Command::new("cc").arg("--version").output();
    if !compiler.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: there is no cc to compile the exported C with");
        return None;
    }
    let built = built_command(&root());
    built
        .map_err(|error| eprintln!("skipped: the command that exports C: {error:#}"))
        .ok()
}

/// The exported header with [`PROGRAM`], compiled; none where the export leaves effects out.
fn compiled(device: &Model, haptical: &Path, folder: &Path) -> Result<Option<PathBuf>> {
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).map_err(|error| anyhow!("{name}: {error}"))
    };
    write("corrected.toml", &device.to_new_toml()?)?;
    write("replay.c", PROGRAM)?;
    let arguments = "export --format c-header --device corrected.toml --out model.h --json";
    let mut export = Command::new(haptical);
    let answer = said(export.args(arguments.split(' ')).current_dir(folder))?;
    let answer: serde_json::Value = serde_json::from_str(&answer)?;
    let is_whole = answer["warnings"].as_array().is_some_and(Vec::is_empty);
    if !is_whole {
        return Ok(None);
    }
    let arguments = "-std=c99 -O2 -Wall -Wextra -Werror replay.c -o replay -lm";
    let mut compiler = Command::new("cc");
    said(compiler.args(arguments.split(' ')).current_dir(folder))?;
    Ok(Some(folder.join("replay")))
}

/// The rows as [`PROGRAM`] reads them: readings, torques, rates, accelerations, force, time and temperature as the effects of
/// the device see them, and whether a run starts.
fn rows(device: &Model, recording: &Recording, context: &Context<'_>) -> Vec<f64> {
    let joints = device.joints.len();
    let elapsed_s = context.elapsed_s();
    let mut rows = Vec::new();
    for row in 0..recording.len() {
        let of = |column: Option<&Vec<f64>>| column.map_or(0.0, |column| column[row]);
        let motion = |joint: usize| context.motion.as_ref().and_then(|all| all.get(joint));
        rows.extend(recording.joint.iter().map(|column| column[row]));
        rows.extend(context.torque_nm.iter().map(|column| of(column.as_ref())));
        rows.extend((0..joints).map(|joint| of(motion(joint).map(|own| &own.velocity))));
        rows.extend((0..joints).map(|joint| of(motion(joint).map(|own| &own.acceleration))));
        let force_n = context.force_n.as_ref().map(|force_n| force_n[row]);
        // in the handle's axes
        let turned = force_n.zip(context.rotation.get(row));
        let force_n =
            turned.map_or_else(Vector3::zeros, |(force_n, own)| own.transpose() * force_n);
        rows.extend(force_n.iter());
        rows.push(of(elapsed_s.as_ref()));
        rows.push(of(context.warming_k.as_ref()) + context.reference_degc);
        let starts = context.runs.iter().any(|run| run.start == row);
        rows.push(f64::from(u8::from(starts)));
    }
    rows
}

fn answered(program: &Path, rows: &[f64]) -> Result<Vec<f64>> {
    let mut run = Command::new(program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let mut stdin = run.stdin.take().context("no standard input")?;
    let bytes = rows.iter().flat_map(|number| number.to_ne_bytes());
    let bytes: Vec<u8> = bytes.collect();
    let writer = std::thread::spawn(move || stdin.write_all(&bytes));
    let output = run.wait_with_output()?;
    let written = writer.join();
    written.map_err(|_| anyhow!("the writer panicked"))??;
    ensure!(output.status.success(), "the compiled C failed");
    let numbers = output.stdout.chunks_exact(size_of::<f64>());
    let number = |bytes: &[u8]| bytes.try_into().map(f64::from_ne_bytes);
    Ok(numbers.map(number).collect::<Result<_, _>>()?)
}
