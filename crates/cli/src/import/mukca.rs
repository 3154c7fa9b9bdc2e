//! Postures with a ball in one of two printed sockets, as the authors of MUKCa keep them (arXiv 2503.12584).

use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Args;
use haptical_model::Recording;

use super::sockets::read_angles;
use super::{Imported, Target, shape_without_limits};
use crate::arguments::{above_zero, one_or_more};
use crate::failure::Failure;

/// End of the help of `haptical import mukca`.
pub(super) const HELP: &str = "\
Example:
  haptical import mukca panda_1 --out panda_1.csv
  haptical identify --device panda.urdf --rig panda_1.rig.toml --log panda_1.csv --out result

Each row of hole_0.csv and hole_1.csv has the joint angles [rad] of one posture with the ball in that socket.
The log has a run for each position of the tool, and a contact for each socket; the rig file beside it says how
far the two sockets of a position are from each other.";

/// End of the rig file's name.
const RIG: &str = "rig.toml";

/// What to do where there are no postures.
const GIVE_FOLDER: &str =
    "give the folder of one robot: <robot>/<position of the tool>/hole_{0,1}.csv";

/// Flags of `haptical import mukca`.
#[derive(Debug, Args)]
pub(super) struct MukcaArguments {
    /// Folder of one robot: it holds a folder for each position of the tool
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    #[command(flatten)]
    target: Target,
    /// Columns that are joints, from the left; those behind them, as a gripper's, are left out
    #[arg(long, value_name = "N", value_parser = one_or_more)]
    joints: Option<NonZeroUsize>,
    /// Distance of the two sockets' centres
    #[arg(long, value_name = "METRES", default_value = "0.05", value_parser = above_zero)]
    distance_m: f64,
    /// Standard deviation of that distance
    #[arg(long, value_name = "METRES", default_value = "0.0001", value_parser = above_zero)]
    distance_sd_m: f64,
}

/// The postures of one socket.
struct Socket {
    /// Name of the contact: position of the tool and socket.
    contact: String,
    run: i64,
    rows: Vec<Vec<f64>>,
}

/// Runs the command.
pub(super) fn run(arguments: &MukcaArguments) -> Result<(), Failure> {
    arguments.target.check(Some(RIG))?;
    let mut warnings = Vec::new();
    let (sockets, pairs) = read_folder(&arguments.folder, &mut warnings)?;
    let n_columns = common_columns(&sockets, &arguments.folder)?;
    let n_joints = arguments.joints.map_or(n_columns, NonZeroUsize::get);
    if n_joints > n_columns {
        let said = format!(
            "--joints is {n_joints}, and the files have {n_columns} columns; give the number of the robot's joints"
        );
        return Err(Failure::arguments(said));
    }
    if n_joints < n_columns {
        let columns = match n_joints + 1 {
            last if last == n_columns => format!("column {last} is"),
            first => format!("columns {first} to {n_columns} are"),
        };
        let folder = arguments.folder.display();
        warnings.push(format!("{folder}: {columns} left out"));
    }
    let rows = || {
        sockets
            .iter()
            .flat_map(|socket| socket.rows.iter().map(move |row| (socket, row)))
    };
    let recording = Recording {
        run: Some(rows().map(|(socket, _)| socket.run).collect()),
        joint: (0..n_joints)
            .map(|joint| rows().map(|(_, row)| row[joint]).collect())
            .collect(),
        contact: Some(rows().map(|(socket, _)| socket.contact.clone()).collect()),
        ..Recording::default()
    };
    let shape = shape_without_limits(&vec![false; n_joints], 0);
    let rig = rig_text(&pairs, arguments);
    arguments.target.write(Imported {
        beside: Some((RIG, rig.into_bytes())),
        ..Imported::of(&recording, &shape, warnings)?
    })
}

/// Sockets in the order of the names of their positions, and the contacts of sockets that belong together.
fn read_folder(
    folder: &Path,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Socket>, Vec<[String; 2]>), Failure> {
    let mut sockets = Vec::new();
    let mut pairs = Vec::new();
    let mut run = 0;
    for position in entries(folder)? {
        let name = position.file_name().and_then(|name| name.to_str());
        let Some(name) = name.filter(|_| position.is_dir()) else {
            warnings.push(format!("{}: not read", position.display()));
            continue;
        };
        run += 1;
        let mut found = Vec::new();
        for file in entries(&position)? {
            match file.file_name().and_then(|name| name.to_str()) {
                Some(socket @ ("hole_0.csv" | "hole_1.csv")) => {
                    let contact = format!("{name}_{}", socket.trim_end_matches(".csv"));
                    found.push(contact.clone());
                    let rows = read_angles(&file)?;
                    sockets.push(Socket { contact, run, rows });
                }
                _ => warnings.push(format!("{}: not read", file.display())),
            }
        }
        match <[String; 2]>::try_from(found) {
            Ok(pair) => pairs.push(pair),
            Err(found) => warnings.push(format!(
                "{}: {} of its two sockets, so no distance between them",
                position.display(),
                found.len()
            )),
        }
    }
    if sockets.is_empty() {
        let what = "no folder in it has hole_0.csv or hole_1.csv";
        return Err(Failure::in_file("no-postures", what, folder, GIVE_FOLDER));
    }
    Ok((sockets, pairs))
}

/// What a folder holds, by name; names that begin with a point are hidden.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let refuse = |error: std::io::Error| Failure::unreadable(&error, folder, GIVE_FOLDER);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(refuse)? {
        let entry = entry.map_err(refuse)?;
        if !entry.file_name().to_string_lossy().starts_with('.') {
            paths.push(entry.path());
        }
    }
    paths.sort();
    Ok(paths)
}

/// The number of columns, which all files share.
fn common_columns(sockets: &[Socket], folder: &Path) -> Result<usize, Failure> {
    let width = |socket: &Socket| socket.rows.first().map_or(0, Vec::len);
    let first = sockets.first().map_or(0, width);
    match sockets.iter().find(|socket| width(socket) != first) {
        None => Ok(first),
        Some(other) => {
            let (own, contact) = (&other.contact, &sockets[0].contact);
            let what = format!("`{own}` has {} columns, `{contact}` {first}", width(other));
            let next = "give recordings of one robot";
            Err(Failure::in_file("cell-count", what, folder, next))
        }
    }
}

/// The rig file: how far the sockets are from each other.
fn rig_text(pairs: &[[String; 2]], arguments: &MukcaArguments) -> String {
    let mut rig = toml_edit::DocumentMut::new();
    let mut tables = toml_edit::ArrayOfTables::new();
    for [a, b] in pairs {
        let mut table = toml_edit::Table::new();
        table.insert("a", toml_edit::value(a));
        table.insert("b", toml_edit::value(b));
        table.insert("distance_m", toml_edit::value(arguments.distance_m));
        table.insert("sd_m", toml_edit::value(arguments.distance_sd_m));
        tables.push(table);
    }
    if !tables.is_empty() {
        rig.insert("contact_pair", toml_edit::Item::ArrayOfTables(tables));
    }
    format!(
        "# Two sockets for a ball at each position of the tool; `haptical import mukca` wrote this.\n\n{rig}"
    )
}
