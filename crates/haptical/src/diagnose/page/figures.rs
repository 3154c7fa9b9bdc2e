//! Figures of a diagnosis: waterfall of the gap, residual before and after, candidates by place.

use haptical_diagnosis::{ChannelGap, Diagnosis, Trace, Verdict};
use haptical_report::{BarRow, BarRows, Block, Figure, HeatCell, HeatMap, Mark, Series};

use crate::diagnose::quantity::axis_label;
use crate::diagnose::words::{column, joints, main_channel, placed, record};
use crate::error::Error;
use crate::page::{FIGURE_PX, drawn, thinned};
use crate::units::{Shown, decimals};

/// Colours beside those of before and after: causes in turn, noise.
const CAUSES: [usize; 4] = [3, 5, 6, 7];
const NOISE: usize = 2;
/// Most rows of the picture of candidates.
const MOST_ROWS: usize = 10;
/// Odds of 100 to 1 in nats: candidates nearer than this are confusable.
const HUNDRED_TO_ONE: f64 = 4.605_170_185_988_092;
/// Most distant candidate whose nats are written out.
const FARTHEST_NATS: f64 = 999.0;

/// Root mean squares from before to the noise, as causes are added.
struct Budget {
    title: String,
    label: String,
    /// Before, after each cause, and so on: one more than there are causes.
    levels: Vec<f64>,
    floor: f64,
    unit: &'static str,
    note: &'static str,
}

/// The waterfall; without a gap each channel as a multiple of its noise.
pub(super) fn gap(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let channels = &diagnosis.gap.channels;
    if channels.is_empty() {
        return Ok(None);
    }
    let is_judged = diagnosis.admission.refusal().is_none();
    if !is_judged && channels.iter().all(|gap| !gap.has_gap) {
        // neither a share that is left nor a noise can be shown of what is not judged
        return Ok(None);
    }
    let budget = match budgeted(diagnosis) {
        Some(channel) if diagnosis.verdict != Verdict::NoGap => budget(diagnosis, channel),
        _ => return beside_noise(channels).map(Some),
    };
    let mut bars = BarRows::new(budget.title, budget.label);
    bars.connected = true;
    // Three digits, but none that the noise floor has not.
    let text = |size: f64| {
        let digits = decimals(size.max(budget.floor)).saturating_sub(1);
        format!("{size:.digits$} {}", budget.unit)
    };
    let mut row = |name: String, from: f64, to: f64, colour: usize, value: String| {
        bars.rows.push(BarRow {
            name,
            from,
            to,
            colour,
            value: value.trim_end().to_owned(),
        });
    };
    let before = budget.levels[0];
    let (name, value) = ("before".to_owned(), text(before));
    row(name, 0.0, before, Series::BEFORE, value);
    let causes = diagnosis.causes.iter().zip(budget.levels.windows(2));
    for ((cause, pair), colour) in causes.zip(CAUSES.into_iter().cycle()) {
        let name = placed(cause);
        let step = pair[1] - pair[0];
        let sign = if step > 0.0 { "+" } else { "−" };
        let value = format!("{sign}{}", text(step.abs()));
        row(name, pair[0], pair[1], colour, value);
    }
    let after = budget.levels.last().copied().unwrap_or(before);
    let floor = budget.floor;
    let left = (after - floor).max(0.0);
    let name = "left unexplained".to_owned();
    row(name, floor + left, floor, Series::AFTER, text(left));
    row("noise floor".to_owned(), floor, 0.0, NOISE, text(floor));
    Ok(Some(Block::Svg {
        caption: budget.note.to_owned(),
        svg: bars.to_svg(FIGURE_PX.0)?,
    }))
}

/// The channel whose gap is drawn: the main one, or where how much of that closes is not known the largest of which it is.
fn budgeted(diagnosis: &Diagnosis) -> Option<&ChannelGap> {
    let main = main_channel(diagnosis);
    let is_known = |gap: &&ChannelGap| gap.reduction_percent.is_some();
    let known = diagnosis.gap.channels.iter().filter(is_known);
    let largest = known.max_by(|a, b| a.share_of_gap.total_cmp(&b.share_of_gap));
    main.filter(is_known).or(largest).or(main)
}

/// The channel with most of the gap, where one cause (or none) makes its numbers exact. Several
/// causes share all channels' gap by energy, so that their steps add up there only.
fn budget(diagnosis: &Diagnosis, channel: &ChannelGap) -> Budget {
    if diagnosis.causes.len() <= 1 {
        let shown = Shown::fine(&channel.unit);
        let mut levels = vec![channel.rms_before * shown.per_si];
        let after = channel.rms_after * shown.per_si;
        levels.extend(diagnosis.causes.iter().map(|_| after));
        return Budget {
            title: format!("Gap of {}", channel.channel),
            label: format!("root mean square of the residual [{}]", shown.name),
            levels,
            floor: channel.noise_floor * shown.per_si,
            unit: shown.name,
            note: match diagnosis.causes.is_empty() {
                true => "What the model leaves, and what of it is noise.",
                false => {
                    "What the model alone leaves, what the cause takes away, what stays, and what is noise."
                }
            },
        };
    }
    let channels = &diagnosis.gap.channels;
    let mean_square = |size: &dyn Fn(&ChannelGap) -> f64| {
        let known = channels.iter().filter(|channel| channel.noise_floor > 0.0);
        let ratios = known.map(|channel| (size(channel) / channel.noise_floor).powi(2));
        let (sum, count) = ratios.fold((0.0, 0.0), |(sum, count), r| (sum + r, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let before = mean_square(&|channel| channel.rms_before);
    let after = mean_square(&|channel| channel.rms_after);
    let total: f64 = diagnosis.causes.iter().map(|cause| cause.share).sum();
    let mut levels = vec![before.sqrt()];
    let mut done = 0.0;
    for cause in &diagnosis.causes {
        done += cause.share;
        let share = match total > 0.0 {
            true => (done / total).clamp(0.0, 1.0),
            false => 1.0,
        };
        levels.push((before + share * (after - before)).max(0.0).sqrt());
    }
    Budget {
        title: "Gap of all channels together".to_owned(),
        label: "root mean square of the residual, in multiples of the noise".to_owned(),
        levels,
        floor: 1.0,
        unit: "",
        note: "What the model alone leaves, what each cause takes away by its share of the energy, \
               what stays, and what is noise.",
    }
}

/// Each channel's residual as a multiple of its noise.
fn beside_noise(channels: &[ChannelGap]) -> Result<Block, Error> {
    let label = "root mean square of the residual, in multiples of the noise";
    let mut bars = BarRows::new("Every channel beside its noise", label);
    for channel in channels.iter().filter(|channel| channel.noise_floor > 0.0) {
        let ratio = channel.rms_before / channel.noise_floor;
        let shown = Shown::fine(&channel.unit);
        bars.rows.push(BarRow {
            name: channel.channel.clone(),
            from: 0.0,
            to: ratio,
            colour: NOISE,
            value: format!("{ratio:.2} ({})", shown.text(channel.rms_before)),
        });
    }
    if bars.rows.is_empty() {
        return Ok(Block::Paragraph("No channel has a noise level.".to_owned()));
    }
    Ok(Block::Svg {
        caption: "1 is noise alone.".to_owned(),
        svg: bars.to_svg(FIGURE_PX.0)?,
    })
}

/// Residuals before and after over the covariate that matters, with the noise behind them.
pub(super) fn traces(diagnosis: &Diagnosis) -> Result<Vec<Block>, Error> {
    let has_places = |trace: &&Trace| trace.at.iter().any(|at| at.is_finite());
    let traces = diagnosis.traces.iter().filter(has_places);
    traces.map(|trace| trace_figure(diagnosis, trace)).collect()
}

/// What the fit did not see.
fn rows_unseen(diagnosis: &Diagnosis) -> &str {
    match diagnosis.held_out.as_str() {
        "" => "held-out rows",
        named => named,
    }
}

fn trace_figure(diagnosis: &Diagnosis, trace: &Trace) -> Result<Block, Error> {
    let shown = Shown::fine(&trace.unit);
    let points = |residuals: &[f64]| -> Vec<(f64, f64)> {
        let pairs = trace.at.iter().zip(residuals);
        let all = pairs.map(|(&at, &residual)| (at, residual * shown.per_si));
        let finite = all.filter(|(at, residual)| at.is_finite() && residual.is_finite());
        thinned(finite)
    };
    let column = axis_label(&trace.covariate);
    let words = column.split(" [").next().unwrap_or_default();
    let rows = match trace.is_held_out {
        true => format!(", {}", rows_unseen(diagnosis)),
        false => String::new(),
    };
    let mut figure = Figure::new(
        format!("{}: residual over {words}{rows}", trace.channel),
        column.clone(),
        format!("residual [{}]", shown.name),
    );
    let finite = trace.at.iter().filter(|at| at.is_finite());
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = finite.fold(ends, |(low, high), &at| (low.min(at), high.max(at)));
    let channel = record(diagnosis, &trace.channel);
    let floor = channel.map(|channel| 2.0 * channel.noise_floor * shown.per_si);
    if let Some(noise) = floor.filter(|_| high > low) {
        let ends = [(low, -noise, noise), (high, -noise, noise)];
        let band = Series::band("noise (2 standard deviations)", NOISE, &ends);
        figure.series.push(band);
    }
    let mut push = |label: &str, colour, residuals: &[f64]| {
        let series = Series::new(label, Mark::Points, colour, points(residuals));
        figure.series.push(series);
    };
    push("before", Series::BEFORE, &trace.before);
    let caption = if trace.is_held_out {
        push("after", Series::AFTER, &trace.after);
        format!(
            "On {}, which the fit did not see: predicted by the model, and with the causes in it.",
            rows_unseen(diagnosis)
        )
    } else if diagnosis.causes.is_empty() {
        "What the model leaves; no cause was found.".to_owned()
    } else {
        push("after", Series::AFTER, &trace.after);
        "The residual before and after the causes are put into the model.".to_owned()
    };
    figure.series.retain(|series| !series.points.is_empty());
    drawn(&figure, caption)
}

/// Which effects at which joints come near the best candidate.
pub(super) fn candidates(diagnosis: &Diagnosis) -> Result<Option<Block>, Error> {
    let all = &diagnosis.candidates;
    let joints = joints(all.iter().map(|candidate| candidate.joint));
    let mut effects: Vec<(&str, f64)> = Vec::new();
    for candidate in all {
        let mut known = effects.iter_mut();
        match known.find(|(name, _)| *name == candidate.effect) {
            Some((_, best)) => *best = best.min(candidate.nats_behind),
            None => effects.push((&candidate.effect, candidate.nats_behind)),
        }
    }
    effects.sort_by(|a, b| a.1.total_cmp(&b.1));
    effects.truncate(MOST_ROWS);
    if effects.is_empty() {
        return Ok(None);
    }
    let columns = joints.iter().map(|joint| column(*joint)).collect();
    let mut map = HeatMap::new("Candidates: nats behind the best", columns);
    for (effect, _) in effects {
        let cell = |joint: &Option<usize>| {
            let own = all
                .iter()
                .filter(|own| own.effect == effect && own.joint == *joint);
            let found = own.map(|own| own.nats_behind).min_by(f64::total_cmp)?;
            Some(HeatCell {
                shade: (-found.max(0.0) / HUNDRED_TO_ONE).exp(),
                text: nats(found),
            })
        };
        map.rows
            .push((effect.to_owned(), joints.iter().map(cell).collect()));
    }
    Ok(Some(Block::Svg {
        caption: format!(
            "How much worse the data are explained with this effect in the place of the first \
             cause. Dark: near the best; within {HUNDRED_TO_ONE:.1} nats (odds of 100 to 1) the data \
             do not tell it from the best."
        ),
        svg: map.to_svg(map.width_px(FIGURE_PX.0))?,
    }))
}

/// Nats as people read them.
fn nats(behind: f64) -> String {
    match behind {
        _ if behind > FARTHEST_NATS => format!("> {FARTHEST_NATS:.0}"),
        _ if behind < 9.95 => format!("{behind:.1}"),
        _ => format!("{behind:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::named;

    #[test]
    fn one_cause_has_the_numbers_of_its_channel() {
        let diagnosis = named();
        let found = budget(&diagnosis, &diagnosis.gap.channels[1]);
        let wanted = [1.2, 0.11];
        for (level, wanted) in found.levels.iter().zip(wanted) {
            assert!((level - wanted).abs() < 1e-12, "{:?}", found.levels);
        }
        assert!((found.floor - 0.105).abs() < 1e-12 && found.unit == "mrad");
    }

    #[test]
    fn several_causes_share_the_energy_of_all_channels() {
        let mut diagnosis = named();
        let mut second = diagnosis.causes[0].clone();
        diagnosis.causes[0].share = 0.75;
        second.share = 0.25;
        diagnosis.causes.push(second);
        for (channel, before) in diagnosis.gap.channels.iter_mut().zip([1.0, 7.0, 5.0]) {
            channel.rms_before = before * channel.noise_floor;
            channel.rms_after = channel.noise_floor;
        }
        let found = budget(&diagnosis, &diagnosis.gap.channels[1]);
        // Mean squares: (1 + 49 + 25) / 3 = 25 before, 1 after; three quarters of 24 go first.
        let wanted = [5.0, 7.0_f64.sqrt(), 1.0];
        for (level, wanted) in found.levels.iter().zip(wanted) {
            assert!((level - wanted).abs() < 1e-9, "{:?}", found.levels);
        }
        assert_eq!(found.floor, 1.0);
    }

    #[test]
    fn nats_are_short() {
        assert_eq!(
            [0.0, 4.26, 57.7, 3000.0].map(nats),
            ["0.0", "4.3", "58", "> 999"]
        );
    }
}
