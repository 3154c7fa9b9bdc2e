//! An identification of the dynamics in a few lines for a terminal.

use haptical_report::{Cell, Table, earned_decimals};

use super::result::{IdentifiedDynamics, NumberEntry, StackedEntry};
use crate::error::Error;
use crate::lines::first_of;

/// Sums that are listed; identified.json has all.
const LISTED: usize = 10;

/// The summary.
pub(super) fn write(
    text: &mut impl std::fmt::Write,
    result: &IdentifiedDynamics,
) -> std::fmt::Result {
    writeln!(text, "{} rows: {}", result.rows, result.answer)?;
    writeln!(
        text,
        "Band: up to {} Hz; {} rows a joint behind the low pass; noise of positions kept out by: {}\n",
        result.band_hz,
        result.band_rows,
        noise(result)
    )?;
    for table in [torques(result), joints(result), bodies(result)] {
        // tables of as many cells as heads are never refused
        let table = table.map_err(|_| std::fmt::Error)?;
        writeln!(text, "{}\n", table.to_terminal())?;
    }
    let delay = &result.torque_delay_s;
    let interval = delay.ci95.map_or_else(String::new, |[low, high]| {
        format!(" [{:.2}, {:.2}]", 1e3 * low, 1e3 * high)
    });
    let delay_ms = 1e3 * delay.value;
    writeln!(
        text,
        "Torques are logged {delay_ms:.2} ms after their positions{interval}."
    )?;
    writeln!(
        text,
        "{} sums of numbers are fixed by the motion (identified.json); each body above is the nearest to the device's own that \
         has them.",
        result.combinations.len()
    )?;
    if !result.not_determined.is_empty() {
        writeln!(
            text,
            "\nNot determined by this motion, kept near the device's own:"
        )?;
        let sums = result.not_determined.iter();
        text.write_str(&first_of(sums, LISTED, "identified.json"))?;
    }
    if !result.unseen.is_empty() {
        writeln!(text, "\nNo torque depends on: {}", result.unseen.join(", "))?;
    }
    Ok(())
}

pub(super) fn noise(result: &IdentifiedDynamics) -> String {
    match (result.instruments, result.period_s) {
        ("repetition", Some(period_s)) => {
            format!("the motion's repetition after {period_s:.3} s")
        }
        ("commands", _) => "the commands".to_owned(),
        _ => "nothing".to_owned(),
    }
}

/// Torques that are left, joint by joint.
pub(super) fn torques(result: &IdentifiedDynamics) -> Result<Table, Error> {
    let columns = "torque | unit | measured | before [%] | after [%] | base parameters [%] | not fitted: before [%] | after [%]";
    let title = "Torques not explained, ||tau - model|| / ||tau||";
    let mut table = Table::with_heads(title.to_owned(), columns);
    let unseen = result.torques_validate.as_deref().unwrap_or_default();
    let row = |head: [Cell; 3], own: StackedEntry, other: Option<StackedEntry>| {
        let percents = [
            Some(own.before),
            Some(own.after),
            Some(own.base),
            other.map(|own| own.before),
            other.map(|own| own.after),
        ];
        let percents = percents.map(|own| Cell::number_or_missing(own, 1));
        head.into_iter().chain(percents).collect()
    };
    for own in &result.torques {
        let other = unseen.iter().find(|other| other.channel == own.channel);
        let head = [
            (&own.channel).into(),
            own.unit.into(),
            Cell::number(own.rms, 3),
        ];
        table.push(row(head, own.percent, other.map(|own| own.percent)))?;
    }
    let (own, other) = (result.stacked_percent, result.stacked_percent_validate);
    let head = ["all".into(), "".into(), Cell::Missing];
    table.push(row(head, own, other))?;
    Ok(table)
}

/// Friction, armature and offset.
pub(super) fn joints(result: &IdentifiedDynamics) -> Result<Table, Error> {
    let columns = "joint | Coulomb | of the load | viscous | turns over | armature | offset";
    let title = "Joints, with half the width of 95 % intervals; SI units, rad or m";
    let mut table = Table::with_heads(title.to_owned(), columns);
    for own in &result.joints {
        let transition = own.transition.iter().next();
        let transition = transition.map_or_else(String::new, |(name, size)| {
            let what = name.split('_').next().unwrap_or_default();
            let digits = (2.0 - size.log10().floor()).clamp(0.0, 9.0) as usize;
            format!("{what} {size:.digits$}")
        });
        let name = match own.name.is_empty() {
            true => own.joint.to_string(),
            false => own.name.clone(),
        };
        table.push(vec![
            name.into(),
            in_words(&own.coulomb).into(),
            (own.of_load.as_ref()).map_or(Cell::Missing, |own| in_words(own).into()),
            in_words(&own.viscous).into(),
            transition.into(),
            in_words(&own.armature).into(),
            in_words(&own.offset).into(),
        ])?;
    }
    Ok(table)
}

/// Masses and centres.
pub(super) fn bodies(result: &IdentifiedDynamics) -> Result<Table, Error> {
    let columns = "row | mass before [kg] | mass [kg] | centre of mass [m]";
    let mut table = Table::with_heads("Bodies".to_owned(), columns);
    for own in &result.bodies {
        let [x, y, z] = own.centre_of_mass_m;
        table.push(vec![
            format!("{}", own.row).into(),
            Cell::number_or_missing(own.nominal_mass_kg, 3),
            in_words(&own.mass_kg).into(),
            format!("{x:.4}, {y:.4}, {z:.4}").into(),
        ])?;
    }
    Ok(table)
}

/// A number with half the width of its interval, to the digits that this leaves.
pub(super) fn in_words(own: &NumberEntry) -> String {
    let Some([low, high]) = own.ci95 else {
        return "not determined".to_owned();
    };
    let half = 0.5 * (high - low);
    let decimals = earned_decimals(half).unwrap_or(4);
    format!("{:.decimals$} ± {half:.decimals$}", own.value)
}
