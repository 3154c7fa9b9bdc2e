//! Tables of a diagnosis: the channels, what their residuals depend on, what is odd, the noise.

mod admission;
mod causes;
mod unseen;

use haptical_diagnosis::{ChannelGap, Diagnosis, Verdict};
use haptical_report::{Cell, Table};

use crate::error::Error;
use crate::units::Shown;

pub(super) use self::admission::{adjusted, admission};
pub(super) use self::causes::{candidates, causes, parameters};
pub(super) use self::unseen::{detectable, invisible, untestable};

/// Before, after, floor and closed share, channel by channel; without a gap, residual and floor.
pub(super) fn channels(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let title = "Root mean square of the residual, channel by channel";
    let has_gap = diagnosis.verdict != Verdict::NoGap;
    let row = |channel: &ChannelGap| {
        let shown = Shown::fine(&channel.unit);
        let mut row = vec![
            (&channel.channel).into(),
            shown.name.into(),
            shown.cell(channel.rms_before),
            shown.cell(channel.noise_floor),
            interval(channel, shown),
            channel.noise_source.words().into(),
        ];
        if has_gap {
            row.insert(3, shown.cell(channel.rms_after));
            let of_fit = channel.rms_fit.map(|rms| shown.cell(rms));
            row.insert(4, of_fit.unwrap_or("".into()));
            row.push(Cell::number(100.0 * channel.share_of_gap, 1));
            row.push(match channel.no_reduction {
                Some(why) => why.words().into(),
                None => Cell::number_or_missing(channel.reduction_percent, 1),
            });
            row.push(Cell::interval_or_missing(channel.reduction_ci95, 1));
        }
        row
    };
    let rows = diagnosis.gap.channels.iter().map(row);
    if !has_gap {
        let columns = "channel | unit | residual | noise floor | 95 % interval | by";
        return Ok(Table::with_heads(title, columns).with_rows(rows)?);
    }
    let columns = "channel | unit | before | after | after, all rows of the fit | noise floor | 95 % interval | by | share of the gap [%] | gap closed [%] | 95 % \
             interval [%]";
    let table = Table::with_heads(title, columns).with_rows(rows)?;
    let table = table.with_note(
        "Before: the model alone. After: with the causes in it. Gap closed: of what lies above the \
         noise floor, or why that is not known. By: what the noise floor is estimated from.",
    );
    let names = |is_held_out: bool| {
        let channels = diagnosis.gap.channels.iter();
        let names = channels.filter(|own| own.held_out == is_held_out);
        let names: Vec<&str> = names.map(|own| own.channel.as_str()).collect();
        names.join(", ")
    };
    let (unseen, of_fit) = (names(true), names(false));
    if unseen.is_empty() || of_fit.is_empty() {
        return Ok(table);
    }
    Ok(table.with_note(format!(
        "The sizes of {unseen} are of rows that the fit did not see, those of {of_fit} of the rows that were fitted."
    )))
}

/// Upper end of a floor's interval, in floors, beyond which it is not written.
const TELLS_NOTHING: f64 = 100.0;

/// The interval of a channel's noise floor.
fn interval(channel: &ChannelGap, shown: Shown) -> Cell {
    let [low, high] = channel.noise_floor_ci95;
    // of one or two degrees of freedom the upper end is a number that says nothing
    if high > TELLS_NOTHING * channel.noise_floor {
        return format!("{} or more", shown.text(low)).into();
    }
    format!("{} to {}", shown.text(low), shown.text(high)).into()
}

/// Of touches: every dependence of the residuals that was tested; none for other recordings.
pub(super) fn dependence(diagnosis: &Diagnosis) -> Result<Option<Table>, Error> {
    let found = diagnosis.place.iter().flat_map(|place| &place.dependence);
    let rows = found.map(|found| {
        vec![
            (&found.column).into(),
            (&found.on).into(),
            Cell::scientific(found.p_value, 2),
            Cell::scientific(found.p_adjusted, 2),
            Cell::number(100.0 * found.share, 1),
        ]
    });
    let columns = "column | it depends on | p | p, all together | share [%]";
    let table = Table::with_heads("What the residuals of the touches depend on", columns)
        .with_rows(rows)?;
    let table = table.with_note(
        "p: probability that chance gives as much, errors within one posture allowed to go together; all \
         together: by Holm's method.",
    );
    Ok((!table.rows().is_empty()).then_some(table))
}

/// Odd values of the model.
pub(super) fn plausibility(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let title = "Values of the model that a sound device hardly has: an effect may hide in them";
    let hints = diagnosis.plausibility.iter();
    let rows = hints.map(|hint| vec![(&hint.parameter).into(), (&hint.why).into()]);
    Ok(Table::with_heads(title, "parameter | what is odd").with_rows(rows)?)
}

/// Noise of each channel.
pub(super) fn noise(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let columns = "channel | of the stated noise | correlation of successive rows | left out as outliers [%] | \
             estimated from";
    let rows = diagnosis.noise.iter().map(|entry| {
        vec![
            (&entry.channel).into(),
            Cell::number(entry.ratio, 3),
            Cell::number(entry.colour, 2),
            Cell::number(100.0 * entry.outlier_share, 2),
            (&entry.from).into(),
        ]
    });
    Ok(Table::with_heads("", columns).with_rows(rows)?)
}
