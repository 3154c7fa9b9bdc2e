//! The proposal as a text for people: a comment with the reason, then the lines.

use std::f64::consts::PI;

use super::layout::Arrangement;
use super::names::Meaning;
use super::units::{Scale, stated};
use super::{Proposal, one_value};
use crate::mapping::{Dimension, Matching, Unit};
use crate::table::{Cells, Table};

const HEAD: &str = "\
# Which columns of these files are which of a log, as it was guessed: read each line and correct it. Then
#   haptical import --columns THIS_FILE FILE... --out log.csv
# Names on the left of a log: t_s, run, theta1_rad (theta3_m of a joint that slides), out1_rad, torque1_nm, x_m, y_m, z_m, cable_m,
# contact, plane, tool, hand, fx_n, temp_degc; any other is a covariate. Units: rad, deg, m, mm, in, s, ms, ns, Nm, ...
";

/// A text as a string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A text in a comment: one line.
fn comment(text: &str) -> String {
    text.chars()
        .map(|letter| if letter.is_control() { ' ' } else { letter })
        .take(300)
        .collect()
}

pub(super) fn toml(
    run: &[Table],
    arrangement: &Arrangement,
    found: &[Proposal],
    unknown: &[(usize, usize, String)],
) -> String {
    let mut text = HEAD.to_owned();
    table(run, &mut text);
    rows(arrangement, &mut text);
    let is_turn = |meaning: &Meaning| {
        matches!(
            meaning,
            Meaning::Quaternion(_)
                | Meaning::Angle(_)
                | Meaning::Vector(_)
                | Meaning::Matrix(_)
                | Meaning::Pose(_)
        )
    };
    let mut straight: Vec<&Proposal> = found.iter().filter(|own| !is_turn(&own.meaning)).collect();
    let place = |own: &Proposal| match &own.meaning {
        Meaning::Log(name) if name == "t_s" || name == "run" => 0,
        Meaning::Joint(..) => 1,
        _ => 2,
    };
    straight.sort_by_key(|own| place(own));
    for own in straight {
        column(run, own, &mut text);
    }
    let turned: Vec<&Proposal> = found.iter().filter(|own| is_turn(&own.meaning)).collect();
    orientation(run, turned, &mut text);
    if !found.iter().any(|own| matches!(&own.meaning, Meaning::Joint(kind, _) if own.meaning.to_string().starts_with("theta") && *kind as u8 <= 1)) {
        text.push_str("\n# NO JOINT WAS FOUND. Each joint of the device needs a column, such as\n# [[column]]\n# log = \"theta1_rad\"\n# from = \"#1\"\n# unit = \"deg\"\n");
        for advice in run.iter().filter_map(one_value::advice) {
            text.push_str(&format!("# {}\n", comment(&advice)));
        }
    }
    if !unknown.is_empty() {
        text.push_str("\n# Left out:\n");
    }
    for (file, place, why) in unknown {
        let name = &run[*file].columns[*place].name;
        let of = if run.len() > 1 {
            format!("file {}, ", file + 1)
        } else {
            String::new()
        };
        text.push_str(&format!(
            "# {of}column {} `{}`: {}\n",
            place + 1,
            comment(name),
            comment(why)
        ));
    }
    text
}

/// How the files are read.
fn table(run: &[Table], text: &mut String) {
    text.push_str("\n[table]\n");
    let dialect = run.iter().find_map(|table| table.dialect.as_ref());
    if let Some(dialect) = dialect {
        let separator = match dialect.separator {
            '\t' => "tab".to_owned(),
            ' ' => "space".to_owned(),
            other => other.to_string(),
        };
        let alike = run
            .iter()
            .filter_map(|table| table.dialect.as_ref())
            .all(|own| own.separator == dialect.separator && own.decimal == dialect.decimal);
        if alike {
            text.push_str(&format!("separator = {}\n", quoted(&separator)));
            let why = match dialect.decimal {
                ',' => {
                    "   # numbers such as 1,234 are read as 1.234: if the comma parts thousands, this is wrong"
                }
                _ => "",
            };
            text.push_str(&format!(
                "decimal = {}{why}\n",
                quoted(&dialect.decimal.to_string())
            ));
        }
        if dialect.is_latin1 {
            text.push_str("encoding = \"latin-1\"   # it is no UTF-8\n");
        }
        if dialect.has_units && run.len() == 1 {
            text.push_str("# the units are those that the file says\n");
        }
    }
    for note in run.iter().flat_map(|table| &table.notes) {
        text.push_str(&format!("# {}\n", comment(note)));
    }
}

fn rows(arrangement: &Arrangement, text: &mut String) {
    text.push_str(&format!("\n[rows]\n# {}\n", comment(&arrangement.why)));
    if arrangement.files_per_run > 1 {
        text.push_str(&format!("files_per_run = {}\n", arrangement.files_per_run));
        let word = match arrangement.matching {
            Matching::Row => "row",
            Matching::Repeat => "repeat",
            Matching::Time => "time",
        };
        text.push_str(&format!("match = \"{word}\"\n"));
    }
    if !arrangement.time.is_empty() {
        let list = |words: Vec<&String>| {
            let words: Vec<String> = words.into_iter().map(|word| quoted(word)).collect();
            words.join(", ")
        };
        let names = list(arrangement.time.iter().map(|(name, _)| name).collect());
        let units = list(arrangement.time.iter().map(|(_, unit)| unit).collect());
        text.push_str(&format!("time = [{names}]\ntime_unit = [{units}]\n"));
    }
}

/// The name by which a column is found: its number where another has the same name, or there are no names.
fn source(run: &[Table], own: &Proposal) -> String {
    let table = &run[own.file];
    let name = &table.columns[own.column].name;
    match table.find(name) {
        Ok(_) if table.is_named => name.clone(),
        _ => format!("#{}", own.column + 1),
    }
}

/// The line `file = 2`, where the name is not enough.
fn file(run: &[Table], own: &Proposal) -> String {
    let name = source(run, own);
    let others = run.iter().filter(|table| table.find(&name).is_ok()).count();
    match others > 1 || (run.len() > 1 && name.starts_with('#')) {
        true => format!("file = {}\n", own.file + 1),
        false => String::new(),
    }
}

fn column(run: &[Table], own: &Proposal, text: &mut String) {
    let (log, from) = (quoted(&own.meaning.to_string()), quoted(&source(run, own)));
    text.push_str(&format!(
        "\n# {}\n[[column]]\nlog = {log}\nfrom = {from}\n{}",
        comment(&own.why),
        file(run, own)
    ));
    match &own.scale {
        Scale::None => {}
        Scale::Unit(unit) => text.push_str(&format!("unit = {}\n", quoted(unit))),
        Scale::Counts => text.push_str("counts_per_turn = 0   # SAY how many are a turn of the joint: counts of the encoder times the gear's ratio\nzero_counts = 0\n"),
    }
}

fn orientation(run: &[Table], mut parts: Vec<&Proposal>, text: &mut String) {
    parts.sort_by(|a, b| a.meaning.cmp(&b.meaning));
    let Some(first) = parts.first() else {
        return;
    };
    let order = match &first.meaning {
        Meaning::Vector(_) => run[first.file].euler.clone().unwrap_or_default(),
        _ => String::new(),
    };
    let mut listed = parts.clone();
    listed.sort_by_key(|own| match own.meaning {
        Meaning::Vector(part) => order.find(['x', 'y', 'z'][part.min(2)]),
        _ => None,
    });
    let from: Vec<String> = listed.iter().map(|own| quoted(&source(run, own))).collect();
    let by_size = first.why.rsplit("; ").next().unwrap_or_default();
    let (kind, further, why) = match &first.meaning {
        Meaning::Quaternion(_) => ("quaternion", "order = \"wxyz\"   # `from` lists w first\n".to_owned(), first.why.clone()),
        Meaning::Angle(_) => (
            "euler",
            "order = \"xyz\"\naxes = \"extrinsic\"   # roll, pitch, yaw about fixed axes, as ROS, KUKA (C, B, A) and Fanuc (W, P, R) have it: CHECK\n".to_owned(),
            format!("by their names; {by_size}"),
        ),
        Meaning::Vector(_) if !order.is_empty() => (
            "euler",
            format!("order = {}\naxes = \"intrinsic\"   # CHECK whether the axes are the fixed ones: \"extrinsic\"\n", quoted(&order)),
            format!("Euler angles in the order that the file says; {by_size}"),
        ),
        Meaning::Vector(_) if is_beyond_half_a_turn(run, &parts) => (
            "euler",
            "order = \"xyz\"\naxes = \"extrinsic\"   # CHECK the order, and whether the axes are the moved ones: \"intrinsic\"\n".to_owned(),
            format!("longer than half a turn, so no rotation vector; {by_size}"),
        ),
        Meaning::Vector(_) => (
            "rotation_vector",
            "# UNSURE: rx, ry, rz are a rotation vector on arms of Universal Robots; of others Euler angles, such as\n# kind = \"euler\", order = \"xyz\", axes = \"extrinsic\"\n".to_owned(),
            format!("by their names; {by_size}"),
        ),
        Meaning::Matrix(_) => ("matrix", "layout = \"row\"   # a transposed one is a rotation too: CHECK\n".to_owned(), first.why.clone()),
        _ => ("pose", pose(run, &parts), first.why.clone()),
    };
    text.push_str(&format!(
        "\n# {}\n[orientation]\nkind = \"{kind}\"\nfrom = [{}]\n{}",
        comment(&why),
        from.join(", "),
        file(run, first)
    ));
    if let Scale::Unit(unit) = &first.scale {
        text.push_str(&format!("unit = {}\n", quoted(unit)));
    }
    text.push_str(&further);
    text.push_str("# invert = true   # where the file has the target seen from the camera, and the camera seen from the target is wanted\n");
}

/// Whether three angles are longer than a rotation vector gets.
fn is_beyond_half_a_turn(run: &[Table], parts: &[&Proposal]) -> bool {
    let numbers = parts.iter().map(|own| {
        let unit = match &own.scale {
            Scale::Unit(unit) => Unit::parse(unit),
            _ => None,
        };
        let numbers = run[own.file].columns[own.column].cells.numbers();
        (
            unit.map_or(1.0, |unit| unit.factor),
            numbers.unwrap_or_default(),
        )
    });
    let numbers: Vec<(f64, &[f64])> = numbers.collect();
    let rows = numbers.iter().map(|(_, numbers)| numbers.len());
    (0..rows.min().unwrap_or(0)).any(|row| {
        let squares = numbers
            .iter()
            .map(|(factor, numbers)| (factor * numbers[row]).powi(2));
        squares.sum::<f64>().sqrt() > 1.01 * PI
    })
}

/// Layout and unit of a 4 x 4 matrix, by where its 0, 0, 0, 1 are.
fn pose(run: &[Table], parts: &[&Proposal]) -> String {
    let cell = |element: usize| {
        let own = parts.get(element)?;
        match &run[own.file].columns[own.column].cells {
            Cells::Numbers(numbers) => numbers.iter().copied().find(|number| !number.is_nan()),
            Cells::Texts(_) => None,
        }
    };
    let is_last =
        |elements: [usize; 4]| elements.map(cell) == [Some(0.0), Some(0.0), Some(0.0), Some(1.0)];
    let (layout, why) = match (is_last([12, 13, 14, 15]), is_last([3, 7, 11, 15])) {
        (true, false) => ("row", "its last four elements are 0, 0, 0, 1"),
        (false, true) => (
            "column",
            "its 4th, 8th, 12th and 16th element are 0, 0, 0, 1",
        ),
        _ => ("row", "UNSURE"),
    };
    let place: [usize; 3] = if layout == "row" {
        [3, 7, 11]
    } else {
        [12, 13, 14]
    };
    let largest = place.iter().filter_map(|&element| {
        let own = parts.get(element)?;
        let numbers = run[own.file].columns[own.column].cells.numbers()?;
        Some(
            numbers
                .iter()
                .fold(0.0, |most: f64, number| most.max(number.abs())),
        )
    });
    let said = parts
        .get(place[0])
        .and_then(|own| stated(&run[own.file].columns[own.column]));
    let unit = match said.filter(|(_, unit)| unit.dimension == Dimension::Length) {
        Some((word, _)) => format!(
            "unit = {}   # of the position, as the file says\n",
            quoted(word)
        ),
        None if largest.fold(0.0, f64::max) > 20.0 => {
            "unit = \"mm\"   # of the position, which is far in m\n".to_owned()
        }
        None => String::new(),
    };
    format!("layout = \"{layout}\"   # {why}\n{unit}")
}
