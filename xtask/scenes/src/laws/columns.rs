//! Laws that add a truthful column to a log.

use anyhow::Result;
use haptical::model::{DeviceChain, Statics};

use crate::catalogue::{TRACKER, TRACKER_SD_M};
use crate::noise::Noise;
use crate::scene::Made;
use crate::table::{Column, Table};

/// Seed of added noise.
const SEED: u64 = 5;
/// Noise of a force sensor that touches nothing \[N\].
const FORCE_SD_N: f64 = 0.1;
/// Noise of an encoder on a link \[rad\], \[m\], and of a coarse one.
const OUTPUT_SD: f64 = 2e-5;
const COARSE_OUTPUT_SD: f64 = 2e-4;
/// Noise of a torque \[N m\].
const TORQUE_SD_NM: f64 = 0.01;
/// A motor \[N m/A\], noise of its current's sensor \[A\], and its supply \[V\].
const CONSTANT_NM_PER_A: f64 = 3.0;
const CURRENT_SD_A: f64 = 1e-3;
const SUPPLY_V: f64 = 48.0;
const ROOM_DEGC: f64 = 21.5;

/// Adds columns to each log of a scene; none where `add` adds none to the first.
fn to_each(
    made: &Made,
    mut add: impl FnMut(&mut Table, &mut Noise) -> Result<bool>,
) -> Result<Option<Made>> {
    let mut changed = made.clone();
    let mut noise = Noise::new(SEED);
    if !add(&mut changed.log, &mut noise)? {
        return Ok(None);
    }
    for further in changed.also.iter_mut().chain(&mut changed.validate) {
        add(further, &mut noise)?;
    }
    Ok(Some(changed))
}

/// A wrist sensor that touches nothing, on an arm with a handle.
pub(super) fn forces(made: &Made) -> Result<Option<Made>> {
    let has_links = made.device.open()?.model.has_links();
    to_each(made, |log, noise| {
        if log.has("fx_n") || !has_links {
            return Ok(false);
        }
        for name in ["fx_n", "fy_n", "fz_n"] {
            let cells = (0..log.rows()).map(|_| noise.normal(FORCE_SD_N)).collect();
            log.push(name, cells);
        }
        Ok(true)
    })
}

/// Encoders on the links, where those are where the motors say.
pub(super) fn outputs(made: &Made) -> Result<Option<Made>> {
    outputs_with(made, OUTPUT_SD)
}

/// The same with coarse encoders, whose noise an acceleration carries into the torques.
pub(super) fn coarse_outputs(made: &Made) -> Result<Option<Made>> {
    outputs_with(made, COARSE_OUTPUT_SD)
}

fn outputs_with(made: &Made, sd: f64) -> Result<Option<Made>> {
    if !made.links_follow {
        return Ok(None);
    }
    to_each(made, |log, noise| {
        for (joint, unit, angles) in joints(log) {
            let read = angles.iter().map(|angle| angle + noise.normal(sd));
            log.push(format!("out{joint}_{unit}"), read.collect());
        }
        Ok(true)
    })
}

/// A tracker that sees the handle of an arm whose geometry is the file's, where the encoders on its links say, or its motors.
pub(super) fn tracker(made: &Made) -> Result<Option<Made>> {
    let device = made.device.open()?.model;
    let is_on_links = made.log.has("out1_rad");
    let is_seen = ["x_m", "cable_m", "contact"].map(|name| made.log.has(name));
    if is_seen.contains(&true) || !made.is_of_true_geometry || made.device.rig.is_some() {
        return Ok(None);
    }
    let chain = DeviceChain::new(&device);
    let changed = to_each(made, |log, noise| {
        let prefix = if is_on_links { "out" } else { "theta" };
        let angles = numbered(log, prefix);
        let mut columns = [const { Vec::new() }; 3];
        for row in 0..log.rows() {
            let at: Vec<f64> = angles.iter().map(|(.., cells)| cells[row]).collect();
            let position_m = chain.pose(&at)?.position_m;
            for (column, along_m) in columns.iter_mut().zip(position_m.iter()) {
                column.push(along_m + noise.normal(TRACKER_SD_M));
            }
        }
        for (name, column) in ["x_m", "y_m", "z_m"].into_iter().zip(columns) {
            log.push(name, column);
        }
        Ok(true)
    })?;
    Ok(changed.map(|mut changed| {
        changed.device = changed.device.rigged(TRACKER);
        changed
    }))
}

/// Torques of an arm that holds itself up at single postures.
pub(super) fn torques(made: &Made) -> Result<Option<Made>> {
    let device = made.device.open()?.model;
    let mut statics = Statics::new(&device);
    if !made.is_of_postures() || !statics.has_weights() || device.has_hands() {
        return Ok(None);
    }
    let mut held = move |log: &mut Table, noise: &mut Noise| {
        let angles = joints(log);
        let mut names = log.columns.iter().map(|(name, _)| name);
        if names.any(|name| name.starts_with("torque")) {
            return Ok(false);
        }
        let mut columns = vec![Vec::new(); angles.len()];
        for row in 0..log.rows() {
            let at: Vec<f64> = angles.iter().map(|(.., cells)| cells[row]).collect();
            let load = statics.load(&at, |_| None)?;
            for (column, torque_nm) in columns.iter_mut().zip(load.torques_nm) {
                column.push(torque_nm + noise.normal(TORQUE_SD_NM));
            }
        }
        for (joint, column) in (device.joints.iter().zip(1..)).zip(columns) {
            log.push(joint.0.torque_column(joint.1), column);
        }
        Ok(true)
    };
    to_each(made, &mut held)
}

/// Commands of drives that meet them at once.
pub(super) fn commands(made: &Made) -> Result<Option<Made>> {
    to_each(made, |log, _| {
        if !log.has("t_s") || log.has("command1_rad") {
            return Ok(false);
        }
        for (joint, unit, angles) in joints(log) {
            log.push(format!("command{joint}_{unit}"), angles);
        }
        Ok(true)
    })
}

/// A room that stays as warm as it is.
pub(super) fn temperature(made: &Made) -> Result<Option<Made>> {
    to_each(made, |log, _| {
        if log.has("temp_degc") {
            return Ok(false);
        }
        log.push("temp_degc", vec![ROOM_DEGC; log.rows()]);
        Ok(true)
    })
}

/// Velocities, as differences of the angles say them.
pub(super) fn velocities(made: &Made) -> Result<Option<Made>> {
    to_each(made, |log, _| {
        if !log.has("t_s") || log.has("velocity1_rad_per_s") {
            return Ok(false);
        }
        let times = log.numbers("t_s")?.to_vec();
        let runs = log.runs();
        for (joint, unit, angles) in joints(log) {
            let speed = |row: usize| {
                let near = |other: &usize| *other < times.len() && runs[*other] == runs[row];
                let before = row.checked_sub(1).filter(near).unwrap_or(row);
                let after = Some(row + 1).filter(near).unwrap_or(row);
                (angles[after] - angles[before]) / (times[after] - times[before])
            };
            let speeds = (0..times.len()).map(speed).collect();
            log.push(format!("velocity{joint}_{unit}_per_s"), speeds);
        }
        Ok(true)
    })
}

/// Currents of motors that each torque follows, and a supply's voltage.
pub(super) fn currents(made: &Made) -> Result<Option<Made>> {
    to_each(made, |log, noise| {
        let mut torques = numbered(log, "torque");
        torques.retain(|(_, unit, _)| unit == "nm");
        if torques.is_empty() || log.has("supply_v") {
            return Ok(false);
        }
        for (joint, _, cells) in torques {
            let read = |torque: &f64| torque / CONSTANT_NM_PER_A + noise.normal(CURRENT_SD_A);
            let read = cells.iter().map(read);
            log.push(format!("current{joint}_a"), read.collect());
        }
        log.push("supply_v", vec![SUPPLY_V; log.rows()]);
        Ok(true)
    })
}

/// Number, unit and readings of each motor encoder.
fn joints(log: &Table) -> Vec<(String, String, Vec<f64>)> {
    numbered(log, "theta")
}

/// The same of each column that is a joint's, by how their names begin.
fn numbered(log: &Table, prefix: &str) -> Vec<(String, String, Vec<f64>)> {
    let read = |(name, column): &(String, Column)| {
        let (joint, unit) = name.strip_prefix(prefix)?.split_once('_')?;
        match column {
            Column::Numbers(cells) => Some((joint.to_owned(), unit.to_owned(), cells.clone())),
            _ => None,
        }
    };
    log.columns.iter().filter_map(read).collect()
}
