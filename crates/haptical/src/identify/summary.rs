//! An identification in a few lines for a terminal.

use haptical_calibration::{ChannelReport, Combination, Kept};
use haptical_report::{Cell, Table, earned_decimals};

use super::effects::EffectEntry;
use super::moved;
use super::refused;
use super::result::Identified;
use crate::diagnose::quantity::Quantity;
use crate::diagnose::words::named_at;
use crate::error::Error;
use crate::lines::{first_of, labelled};
use crate::units::Shown;

/// Sums that are listed one by one; identified.json has all.
const LISTED: usize = 5;

/// The summary: channels, what moved most, and what was not identified.
pub(super) fn write(text: &mut impl std::fmt::Write, result: &Identified) -> std::fmt::Result {
    let fixed = result.parameters.len() - result.not_identified.len();
    let combined = match result.combinations.len() {
        0 => String::new(),
        count => format!(", {count} of them only in a combination"),
    };
    writeln!(
        text,
        "{} rows, {} method: {fixed} of {} parameters identified{combined}",
        result.rows,
        result.method,
        result.parameters.len()
    )?;
    let title = format!("Residuals, root mean square; {}", result.held_out);
    // a table of this many columns in each row is never refused
    let table = judged_table(&title, result).map_err(|_| std::fmt::Error)?;
    writeln!(text, "{}", table.to_terminal())?;
    let most = moved::most(&result.moved).map_err(|_| std::fmt::Error)?;
    if let Some(table) = most {
        let note = moved::note(&result.moved, result.next.is_some());
        writeln!(text, "\n{}", table.to_terminal())?;
        text.write_str(&labelled("", &note, 0))?;
    }
    if let Some(force) = force_sentence(result) {
        write!(text, "\n{}", labelled("", &force, 0))?;
    }
    if !result.effects.is_empty() {
        writeln!(text, "\nEffects that were fitted with geometry and drives:")?;
        for effect in &result.effects {
            text.write_str(&labelled("", &effect_line(effect), 2))?;
        }
    }
    if let Some(next) = &result.next {
        writeln!(text, "\n{next}")?;
    }
    combinations(text, result)?;
    if !result.not_identified.is_empty() {
        writeln!(text, "\nNot identified, kept at the nominal value:")?;
        text.write_str(&refused::lines(&result.not_identified))?;
        text.write_str(&labelled("", &result.named_rows, 0))?;
    }
    Ok(())
}

/// What is fixed only together with other numbers.
fn combinations(text: &mut impl std::fmt::Write, result: &Identified) -> std::fmt::Result {
    let count = result.combinations.len();
    if count == 0 {
        return Ok(());
    }
    if moved::says_origins(&result.moved) {
        // sums of numbers that a URDF has not
        return writeln!(
            text,
            "\n{count} numbers are fixed only in a combination with others: identified.json lists the sums."
        );
    }
    writeln!(
        text,
        "\nFixed only in a combination; a single one's interval counts what the others may be:"
    )?;
    let sums = result.combinations.iter().map(in_words);
    text.write_str(&first_of(sums, LISTED, "identified.json"))
}

/// The channel that matters most: one that sees the whole chain, else the external encoder with the largest residual.
pub(super) fn main_channel(result: &Identified) -> Option<&ChannelReport> {
    let by_size = |a: &&ChannelReport, b: &&ChannelReport| a.rms_before.total_cmp(&b.rms_before);
    let channels = || result.channels.iter();
    let chain = channels().find(|channel| channel.joint.is_none());
    chain.or_else(|| channels().max_by(by_size))
}

/// The result in a line.
pub(super) fn answer(result: &Identified) -> String {
    let kept = match result.rejected.as_ref().map(|rejected| rejected.kept) {
        None => "",
        Some(Kept::Nominal) => "The fit is rejected, the given device is kept. ",
        Some(Kept::JointOffsets) => "The fit is rejected, new joint offsets alone are kept. ",
    };
    let count = result.parameters.len();
    let fixed = count - result.not_identified.len();
    let residual = main_channel(result).map_or_else(String::new, |channel| {
        let shown = Shown::fine(&channel.unit);
        format!(
            "; residual of {}: {} before, {} after, noise floor {}",
            channel.channel,
            shown.text(channel.rms_before_good),
            shown.text(channel.rms_after_good),
            shown.text(channel.noise_floor)
        )
    });
    let rows = &result.held_out;
    format!("{kept}{fixed} of {count} parameters identified{residual}; {rows}.")
}

/// An effect with its numbers, and whether the log shows it.
pub(super) fn effect_line(entry: &EffectEntry) -> String {
    let name = named_at(&entry.effect, entry.joint);
    if !entry.shown {
        return format!("{name}: not shown; {}", entry.why);
    }
    let numbers = entry.parameters.iter().filter_map(|(key, number)| {
        let value = number.value?;
        let quantity = Quantity::new(&entry.effect, key, value);
        let words = quantity.words.clone();
        Some(match number.ci95? {
            [Some(low), Some(high)] => format!("{words} {}", quantity.text(value, [low, high])),
            [Some(low), None] => format!("{words} at least {}", quantity.short(low)),
            _ => format!("{words} {}", quantity.short(value)),
        })
    });
    let numbers: Vec<String> = numbers.collect();
    format!("{name}: {}; {}", numbers.join(", "), entry.why)
}

/// Share by which a residual must exceed the noise to be worth a word, and the same in standard deviations of its size.
const LEFT_SHARE: f64 = 1.1;
const LEFT_SD: f64 = 4.0;

/// What to do where more than noise is left on rows that the fit did not see.
pub(super) fn next_step(result: &Identified) -> Option<String> {
    let is_left = |channel: &&ChannelReport| {
        let spread = 1.0 + LEFT_SD / (2.0 * channel.readings as f64).sqrt();
        channel.rms_after_good > channel.noise_floor * spread.max(LEFT_SHARE)
    };
    let by_share = |a: &&ChannelReport, b: &&ChannelReport| {
        let share = |channel: &ChannelReport| channel.rms_after_good / channel.noise_floor;
        share(a).total_cmp(&share(b))
    };
    let worst = result.channels.iter().filter(is_left).max_by(by_share)?;
    let shown = Shown::fine(&worst.unit);
    Some(format!(
        "{} keeps {} where the stated noise is {}: run `haptical diagnose` to see which effect is missing.",
        worst.channel,
        shown.text(worst.rms_after_good),
        shown.text(worst.noise_floor)
    ))
}

/// How far the force still leans from the wanted direction, in words.
pub(super) fn force_sentence(result: &Identified) -> Option<String> {
    let force = result.force_direction.as_ref()?;
    let shown = Shown::fine("rad");
    let [low, high] = force.ci95_rad.map(|end| end * shown.per_si);
    let decimals = earned_decimals(0.5 * (high - low)).unwrap_or(4);
    let locked = force.locked_joint.map_or(String::new(), |joint| {
        format!(", joint {joint} locked at home")
    });
    Some(format!(
        "Direction of the handle's force by the identified model: {:.decimals$} {} root mean square (95 % interval \
         {low:.decimals$} to {high:.decimals$}) over {} postures of the log{locked}.",
        force.rms_rad * shown.per_si,
        shown.name,
        force.postures
    ))
}

/// The channels on rows that the fit did not see; a dash in the place of what no such row checks.
pub(super) fn judged_table(title: &str, result: &Identified) -> Result<Table, Error> {
    let mut table = channel_table(title, &result.channels)?;
    for channel in result.unchecked() {
        let mut row = vec![Cell::Missing; table.columns().len()];
        row[0] = channel.channel.as_str().into();
        row[1] = Shown::fine(&channel.unit).name.into();
        row[2] = Cell::number(0.0, 0);
        table.push(row)?;
    }
    Ok(table)
}

/// Before, after and floor of each channel; where a channel has outliers, without and with them.
pub(super) fn channel_table(title: &str, channels: &[ChannelReport]) -> Result<Table, Error> {
    let has_outliers = channels.iter().any(|channel| channel.outliers > 0);
    let row = |channel: &ChannelReport| {
        let shown = Shown::fine(&channel.unit);
        let mut row = vec![
            (&channel.channel).into(),
            shown.name.into(),
            Cell::number(channel.readings as f64, 0),
            shown.cell(channel.rms_before_good),
            shown.cell(channel.rms_after_good),
            shown.cell(channel.noise_floor),
            Cell::number_or_missing(channel.reduction_percent_good, 2),
        ];
        if has_outliers {
            row.insert(5, shown.cell(channel.rms_after));
            row.insert(3, Cell::number(channel.outliers as f64, 0));
        }
        row
    };
    let (own, others, left_out) = match has_outliers {
        true => (
            " outliers |",
            " after, outliers too |",
            "; outliers are left out of before, after and reduction",
        ),
        false => ("", "", ""),
    };
    let columns = format!(
        "channel | unit | readings |{own} before | after |{others} noise floor | reduction [%]"
    );
    let mut table = Table::with_heads(format!("{title}{left_out}"), &columns);
    for channel in channels {
        table.push(row(channel))?;
        let shown = Shown::fine(&channel.unit);
        for hand in &channel.hands {
            let mut own = vec![Cell::Missing; table.columns().len()];
            own[0] = format!("{}, {}", channel.channel, hand.hand).into();
            own[1] = shown.name.into();
            own[2] = Cell::number(hand.readings as f64, 0);
            let before = if has_outliers { 4 } else { 3 };
            own[before] = shown.cell(hand.rms_before);
            own[before + 1] = shown.cell(hand.rms_after);
            table.push(own)?;
        }
    }
    Ok(table)
}

/// A combination as an equation, with half the width of its 95 % interval.
pub(super) fn in_words(sum: &Combination) -> String {
    let shown = Shown::coarse(&sum.unit);
    let terms = sum.terms.iter();
    let terms = sum_in_words(terms.map(|term| (term.name.as_str(), term.coefficient)));
    let half = (sum.ci95[1] - sum.ci95[0]) / 2.0 * shown.per_si;
    let decimals = earned_decimals(half).unwrap_or(6);
    let value = sum.value * shown.per_si;
    let text = format!(
        "{terms} = {value:.decimals$} ± {half:.decimals$} {}",
        shown.name
    );
    text.trim_end().to_owned()
}

/// A sum of numbers with their factors: `a3 - 0.5000 d4`. The first one's sign is its value's.
pub(super) fn sum_in_words<'t>(terms: impl Iterator<Item = (&'t str, f64)>) -> String {
    let term = |(position, (name, factor)): (usize, (&str, f64))| {
        let sign = match (position, factor < 0.0) {
            (0, _) => "",
            (_, true) => " - ",
            (_, false) => " + ",
        };
        let size = factor.abs();
        match (size - 1.0).abs() < 5e-7 {
            true => format!("{sign}{name}"),
            false => format!("{sign}{size:.4} {name}"),
        }
    };
    terms.enumerate().map(term).collect()
}
