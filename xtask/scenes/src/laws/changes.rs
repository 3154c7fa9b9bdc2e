//! Laws that write the same device and log in another way.

use anyhow::{Context, Result};
use haptical::identify_dynamics;
use haptical_tables::{Cells, Mapping, Reading, apply, table_from_bytes};
use std::fmt::Write as _;

use crate::noise::Noise;
use crate::scene::Made;
use crate::table::{Column, Table};

/// How much later a log may start \[s\].
const LATER_S: f64 = 1e6;
/// Seed of another order.
const SEED: u64 = 11;

/// Nothing: the number of threads is changed where it is asked.
pub(super) fn as_it_is(made: &Made) -> Result<Option<Made>> {
    Ok(Some(made.clone()))
}

/// Joints whose names are other numbers' digits, in TOML, or end otherwise, in descriptions.
pub(super) fn renamed(made: &Made) -> Result<Option<Made>> {
    let mut changed = made.clone();
    let is_description = !made.device.name.ends_with(".toml");
    let text = match is_description {
        true => renamed_description(&made.device.text, &made.device.open()?),
        false => renamed_toml(&made.device.text),
    };
    changed.device.text = text;
    if let (Some(model), false) = (&made.model, is_description) {
        changed.model = Some(renamed_toml(model));
    }
    Ok(Some(changed))
}

/// The joint named K of n gets the name n + 1 - K.
fn renamed_toml(text: &str) -> String {
    let count = text.lines().filter(|line| line.trim() == "[[joint]]");
    let count = count.count();
    let (mut joint, mut is_in_joint) = (0, false);
    let mut renamed = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with('[') {
            is_in_joint = line.trim() == "[[joint]]";
            renamed += line;
            renamed.push('\n');
            if is_in_joint {
                joint += 1;
                renamed += &format!("name = \"{}\"\n", count + 1 - joint);
            }
        } else if !(is_in_joint && line.trim_start().starts_with("name")) {
            renamed += line;
            renamed.push('\n');
        }
    }
    renamed
}

fn renamed_description(text: &str, device: &haptical::Device) -> String {
    let mut text = text.to_owned();
    for joint in &device.model.joints {
        let (own, other) = (
            format!("\"{}\"", joint.name),
            format!("\"of_{}\"", joint.name),
        );
        text = text.replace(&own, &other);
    }
    text
}

/// Degrees, millimetres, milliseconds and millinewtons, through a mapping file as another program's table.
pub(super) fn other_units(made: &Made) -> Result<Option<Made>> {
    made.with_each_log(in_other_units).map(Some)
}

fn in_other_units(log: &Table) -> Result<Table> {
    let mut mapping = String::new();
    let (mut numbers, mut others) = (Vec::new(), Vec::new());
    for (index, (name, column)) in log.columns.iter().enumerate() {
        let Column::Numbers(cells) = column else {
            others.push((name.clone(), column.clone()));
            continue;
        };
        let Some((unit, factor)) = other_unit(name) else {
            others.push((name.clone(), column.clone()));
            continue;
        };
        writeln!(
            mapping,
            "[[column]]\nlog = \"{name}\"\nfrom = \"c{index}\"\nunit = \"{unit}\""
        )?;
        numbers.push((format!("c{index}"), cells, factor));
    }
    let mut text = String::new();
    let names: Vec<&str> = numbers.iter().map(|(name, ..)| name.as_str()).collect();
    writeln!(text, "{}", names.join(","))?;
    for row in 0..log.rows() {
        let cell = |(_, cells, factor): &(String, &Vec<f64>, f64)| match cells[row].is_nan() {
            true => String::new(),
            false => (cells[row] * factor).to_string(),
        };
        let cells: Vec<String> = numbers.iter().map(cell).collect();
        writeln!(text, "{}", cells.join(","))?;
    }
    let table = table_from_bytes(text.into_bytes(), "table.csv", &Reading::default())?;
    let applied = apply(&[table], &Mapping::from_toml(&mapping, "columns.toml")?)?;
    let mut imported = Table::default();
    for (name, cells) in applied.columns {
        match cells {
            // said by the other columns, as it was
            _ if name == "run" => {}
            Cells::Numbers(cells) => imported.push(name, cells),
            Cells::Texts(_) => {}
        }
    }
    imported.columns.extend(others);
    Ok(imported)
}

/// Another unit of a measured column, and its numbers over those in SI units; none of texts and covariates.
fn other_unit(name: &str) -> Option<(&'static str, f64)> {
    const MEASURED: [&str; 9] = [
        "t_s", "theta", "out", "cable", "x_m", "y_m", "z_m", "torque", "f",
    ];
    if !MEASURED.iter().any(|start| name.starts_with(start)) || name.starts_with("fixture") {
        return None;
    }
    match name.rsplit('_').next()? {
        "rad" => Some(("deg", 180.0 / std::f64::consts::PI)),
        "m" => Some(("mm", 1e3)),
        "s" => Some(("ms", 1e3)),
        "nm" => Some(("mNm", 1e3)),
        "n" => Some(("mN", 1e3)),
        _ => None,
    }
}

/// The device as it was identified while it was sound, in the place of its description: it has friction, armatures and offsets of its drives.
pub(super) fn identified(made: &Made) -> Result<Option<Made>> {
    let Some(sound) = &made.sound else {
        return Ok(None);
    };
    let device = made.device.open()?;
    let log = sound.log("sound.csv", &device)?;
    let found = identify_dynamics(&device, &log, None, None)?;
    let mut changed = made.clone();
    found.device.to_toml().clone_into(&mut changed.device.text);
    Ok(Some(changed))
}

/// One run is two, cut where the arm is slowest in the middle third of its log.
pub(super) fn two_runs(made: &Made) -> Result<Option<Made>> {
    if !made.log.has("t_s") || made.log.has("run") {
        return Ok(None);
    }
    let cut = |log: &Table| -> Result<Table> {
        let slowest = slowest(log).context("a log without rows")?;
        let runs = (0..log.rows()).map(|row| i64::from(row >= slowest));
        let mut log = log.clone();
        log.columns
            .push(("run".to_owned(), Column::Integers(runs.collect())));
        Ok(log)
    };
    made.with_each_log(cut).map(Some)
}

fn slowest(log: &Table) -> Option<usize> {
    let angles = log
        .columns
        .iter()
        .filter_map(|(name, column)| match column {
            Column::Numbers(cells) if name.starts_with("theta") => Some(cells),
            _ => None,
        });
    let angles: Vec<&Vec<f64>> = angles.collect();
    let rows = log.rows();
    let moved = |row: usize| -> f64 {
        let steps = angles.iter().map(|own| (own[row] - own[row - 1]).abs());
        steps.sum()
    };
    (rows / 3..2 * rows / 3)
        .filter(|row| *row > 0)
        .min_by(|a, b| moved(*a).total_cmp(&moved(*b)))
}

pub(super) fn later_start(made: &Made) -> Result<Option<Made>> {
    if !made.log.has("t_s") {
        return Ok(None);
    }
    let later = |log: &Table| -> Result<Table> {
        let mut log = log.clone();
        for time_s in log.numbers_mut("t_s")? {
            *time_s += LATER_S;
        }
        Ok(log)
    };
    made.with_each_log(later).map(Some)
}

/// Whether rows of a log may stand in any order: it has no time, no run, and no rig that counts its lines.
fn is_of_postures(made: &Made) -> bool {
    let counts_lines = |rig: &String| rig.contains("from_line");
    !made.log.has("t_s")
        && !made.log.has("run")
        && !made.device.rig.as_ref().is_some_and(counts_lines)
}

fn with_rows(made: &Made, rows: &[usize]) -> Option<Made> {
    is_of_postures(made).then(|| Made {
        log: made.log.taken(rows),
        ..made.clone()
    })
}

/// Rows in another order.
pub(super) fn other_order(made: &Made) -> Result<Option<Made>> {
    let mut rows: Vec<usize> = (0..made.log.rows()).collect();
    let mut noise = Noise::new(SEED);
    for row in (1..rows.len()).rev() {
        let other = noise.between(0.0, (row + 1) as f64) as usize;
        rows.swap(row, other.min(row));
    }
    Ok(with_rows(made, &rows))
}

/// Every row twice: as many readings, no more knowledge.
pub(super) fn doubled(made: &Made) -> Result<Option<Made>> {
    let rows: Vec<usize> = (0..made.log.rows()).flat_map(|row| [row, row]).collect();
    Ok(with_rows(made, &rows))
}

pub(super) fn second_half_first(made: &Made) -> Result<Option<Made>> {
    let count = made.log.rows();
    let rows: Vec<usize> = (count / 2..count).chain(0..count / 2).collect();
    Ok(with_rows(made, &rows))
}

#[cfg(test)]
mod tests {
    use crate::table::{Column, Table};

    use super::{in_other_units, renamed_toml};

    #[test]
    fn joints_of_a_device_file_get_the_names_of_others() {
        let text = "[device]\nname = \"arm\"\n[[joint]]\nname = \"a\"\n[[joint]]\nlower_rad = 0\n[gravity]\n";
        let renamed = "[device]\nname = \"arm\"\n[[joint]]\nname = \"2\"\n[[joint]]\nname = \"1\"\nlower_rad = 0\n[gravity]\n";
        assert_eq!(renamed_toml(text), renamed);
    }

    #[test]
    fn a_table_in_other_units_is_the_same_log() {
        let mut log = Table::default();
        log.push("t_s", vec![0.0, 0.25]);
        log.push("theta1_rad", vec![0.5, f64::NAN]);
        log.push("torque1_nm", vec![3.0, -4.0]);
        log.columns
            .push(("run".to_owned(), Column::Integers(vec![0, 0])));
        let imported = in_other_units(&log).unwrap();
        for name in ["t_s", "theta1_rad", "torque1_nm"] {
            let pairs = log
                .numbers(name)
                .unwrap()
                .iter()
                .zip(imported.numbers(name).unwrap());
            for (own, other) in pairs {
                assert!(
                    own.is_nan() && other.is_nan() || (own - other).abs() < 1e-14,
                    "{name}"
                );
            }
        }
        assert!(imported.has("run"));
    }
}
