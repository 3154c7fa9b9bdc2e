//! The gap, channel by channel: one record from which verdict, sentence and table are made.

use serde::Serialize;

use super::floor::{Floor, NoReduction};
use super::{HeldOutAnswer, Verdict};
use crate::answer::CauseAnswer;
use crate::noise::NoiseSource;
use crate::thresholds::answer::{KEPT_FLOORS, KEPT_SHARE};
use haptical_linalg::jackknife_sd;
use haptical_metrics::gap_reduction_percent;
use haptical_motion::{PARTS, Unseen};

/// The gap: [`Gap::new`] makes its channels agree with the verdict.
#[derive(Debug, Clone, Serialize)]
pub struct Gap {
    /// One entry per channel, a position's axes together.
    pub channels: Vec<ChannelGap>,
}

/// One channel's gap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelGap {
    /// `out2`, `cable`.
    pub channel: String,
    /// Joint (from 1) of an external encoder.
    pub joint: Option<usize>,
    /// Whether the verdict finds a gap in it.
    pub has_gap: bool,
    /// Whether the sizes are of rows that the fit did not see: so where the causes are checked on such rows.
    pub held_out: bool,
    /// Root mean square of the base model's residuals.
    pub rms_before: f64,
    /// The same with the causes in the model.
    pub rms_after: f64,
    /// What the fit leaves on all its rows. Where a corrected device holds the fit to 1 %, it is what that device, replayed, leaves on
    /// all rows of the log, those that the fit left out included. None where nothing is fitted, or where a replay has more rows than a
    /// fit behind a low pass.
    pub rms_fit: Option<f64>,
    /// Root mean square of the noise.
    pub noise_floor: f64,
    /// 95 % interval of it.
    pub noise_floor_ci95: [f64; 2],
    /// What it was estimated from.
    pub noise_source: NoiseSource,
    /// Unit of the three.
    pub unit: String,
    /// Share of all channels' structured energy.
    pub share_of_gap: f64,
    /// Share of the gap that was closed, noise taken out; none without a gap, or where the floor is none.
    pub reduction_percent: Option<f64>,
    /// 95 % interval of it.
    pub reduction_ci95: Option<[f64; 2]>,
    /// Why there is no share.
    pub no_reduction: Option<NoReduction>,
}

impl ChannelGap {
    /// A gap on the rows that were fitted; its share is its squared size over that of the noise, before shares are taken.
    pub(crate) fn fitted(
        channel: String,
        joint: Option<usize>,
        [rms_before, rms_after]: [f64; 2],
        floor: &Floor,
        unit: &str,
    ) -> Self {
        let why_unknown = floor.why_unknown();
        let reduction = gap_reduction_percent(rms_before, rms_after, floor.rms);
        let has_gap = rms_before > floor.ci95()[1];
        let reduction_percent = reduction.filter(|_| has_gap && why_unknown.is_none());
        let no_reduction = why_unknown.unwrap_or(NoReduction::WithinNoise);
        Self {
            channel,
            joint: joint.map(|joint| joint + 1),
            has_gap,
            held_out: false,
            rms_before,
            rms_after,
            rms_fit: Some(rms_after),
            noise_floor: floor.rms,
            noise_floor_ci95: floor.ci95(),
            noise_source: floor.source,
            unit: unit.to_owned(),
            share_of_gap: ((rms_before / floor.rms).powi(2) - 1.0).max(0.0),
            no_reduction: reduction_percent.is_none().then_some(no_reduction),
            reduction_percent,
            reduction_ci95: None,
        }
    }

    /// How many times its noise a channel keeps next to the causes, where that is a gap of its own: a large effect of one channel does not
    /// excuse a gap of another.
    pub fn keeps(&self) -> Option<f64> {
        let times = self.rms_after / self.noise_floor;
        let beyond = |rms: f64| rms.powi(2) - self.noise_floor.powi(2);
        let is_share = beyond(self.rms_after) > KEPT_SHARE * beyond(self.rms_before);
        let is_known = self.has_gap && self.no_reduction.is_none();
        (is_known && times > KEPT_FLOORS && is_share).then_some(times)
    }

    /// The same gap where causes leave this share of its squares beyond noise.
    pub(crate) fn with_left(self, share: f64) -> Self {
        let [before, noise] = [self.rms_before, self.noise_floor].map(|rms| rms * rms);
        let rms_after = (before.min(noise) + share * (before - noise).max(0.0)).sqrt();
        let reduction = gap_reduction_percent(self.rms_before, rms_after, self.noise_floor);
        Self {
            rms_after,
            rms_fit: Some(rms_after),
            reduction_percent: self.reduction_percent.and(reduction),
            ..self
        }
    }

    /// The same gap with the sizes, the floor and the closed share of rows that the fit did not see.
    pub(crate) fn on_unseen(self, seen: &HeldOutAnswer, floor: &Floor) -> Self {
        Self {
            held_out: true,
            rms_before: seen.rms_before,
            rms_after: seen.rms_after,
            noise_floor: floor.rms,
            noise_floor_ci95: floor.ci95(),
            noise_source: floor.source,
            reduction_percent: seen.reduction_percent,
            reduction_ci95: seen.reduction_ci95,
            no_reduction: seen.no_reduction,
            ..self
        }
    }

    /// The same as what a cause does on rows that its fit did not see.
    pub(crate) fn as_held_out(&self) -> HeldOutAnswer {
        HeldOutAnswer {
            channel: self.channel.clone(),
            rms_before: self.rms_before,
            rms_after: self.rms_after,
            noise_floor: self.noise_floor,
            unit: self.unit.clone(),
            reduction_percent: self.reduction_percent,
            reduction_ci95: self.reduction_ci95,
            no_reduction: self.no_reduction,
        }
    }

    /// The same where nothing closes.
    pub(crate) fn without_causes(mut self) -> Self {
        self.rms_after = self.rms_before;
        self.rms_fit = self.rms_fit.map(|_| self.rms_before);
        self.reduction_percent = self.has_gap.then_some(0.0);
        self.reduction_ci95 = None;
        self
    }

    /// Nothing is said of a gap in it.
    pub(crate) fn without_gap(mut self) -> Self {
        self.has_gap = false;
        self.reduction_percent = None;
        self.reduction_ci95 = None;
        self.no_reduction = Some(NoReduction::NoGap);
        self
    }
}

impl Gap {
    /// The channels as the verdict has them: without a gap none shows one, with a gap at least one does, the one where it
    /// was located. Shares add up to 1, or are all 0.
    ///
    /// # Examples
    /// ```
    /// use haptical_diagnosis::{Gap, Verdict};
    /// assert!(Gap::new(Verdict::NoGap, None, Vec::new()).channels.is_empty());
    /// ```
    pub fn new(verdict: Verdict, located: Option<&str>, channels: Vec<ChannelGap>) -> Self {
        let mut channels = channels;
        let total: f64 = channels.iter().map(|gap| gap.share_of_gap).sum();
        for gap in &mut channels {
            gap.share_of_gap = if total > 0.0 {
                gap.share_of_gap / total
            } else {
                0.0
            };
        }
        if verdict == Verdict::NoGap {
            let channels = channels.into_iter().map(ChannelGap::without_gap).collect();
            return Self { channels };
        }
        for gap in &mut channels {
            if gap.rms_before <= gap.noise_floor && gap.reduction_percent.is_some() {
                gap.no_reduction = Some(NoReduction::WithinNoise);
            }
            if gap.no_reduction.is_some() || gap.reduction_percent.is_none() {
                gap.reduction_percent = None;
                gap.reduction_ci95 = None;
                gap.no_reduction.get_or_insert(NoReduction::WithinNoise);
            }
        }
        let main = main_of(located, &channels);
        for (index, gap) in channels.iter_mut().enumerate() {
            gap.has_gap |= Some(index) == main || gap.reduction_percent.is_some();
            if gap.has_gap && gap.no_reduction == Some(NoReduction::NoGap) {
                gap.no_reduction = Some(NoReduction::WithinNoise);
            }
        }
        let channels = channels.into_iter().map(|gap| match gap.has_gap {
            true => gap,
            false => gap.without_gap(),
        });
        Self {
            channels: channels.collect(),
        }
    }

    /// Takes the shares of causes out where their channel has none.
    pub(crate) fn agree_with(&self, causes: &mut [CauseAnswer]) {
        for cause in causes {
            let held_out = cause.held_out.take();
            cause.held_out = held_out.map(|held_out| held_out.agreeing(self));
        }
    }

    /// The channel in which the gap lies: where it was located, else the one that shows most of it.
    pub fn main(&self, located: Option<&str>) -> Option<&ChannelGap> {
        self.channels.get(main_of(located, &self.channels)?)
    }
}

fn main_of(located: Option<&str>, channels: &[ChannelGap]) -> Option<usize> {
    let located = located.and_then(|name| channels.iter().position(|gap| gap.channel == name));
    located.or_else(|| {
        let by_share = |a: &usize, b: &usize| {
            let share = |index: usize| channels[index].share_of_gap;
            share(*a).total_cmp(&share(*b))
        };
        (0..channels.len()).max_by(by_share)
    })
}

/// Reduction of a gap's size \[%\] by the share of its squares that closes; below zero where it grows.
pub(crate) fn reduction_percent(closed: f64) -> f64 {
    100.0 * (1.0 - (1.0 - closed.min(1.0)).sqrt())
}

/// The gap of a joint's channel (its name and its unit) on rows that a fit did not see, with the sums of squares that are left in
/// parts of them.
pub(crate) fn held_out(
    (channel, unit): (String, &'static str),
    unseen: &Unseen,
    sums_after: &[f64; PARTS],
) -> HeldOutAnswer {
    let rms = |sums: &[f64; PARTS], without: Option<usize>| {
        let kept = (0..PARTS).filter(|part| Some(*part) != without);
        let (sum, rows) = kept.fold((0.0, 0), |(sum, rows), part| {
            (sum + sums[part], rows + unseen.rows[part])
        });
        (sum / rows.max(1) as f64).sqrt()
    };
    let [rms_before, rms_after] = [&unseen.before, sums_after].map(|sums| rms(sums, None));
    // where no other rows predict those that hold most of the gap, the rest says nothing of it
    let beyond = |(rows, square): (usize, f64)| square - rows as f64 * unseen.noise.powi(2);
    let predicted = (unseen.rows_in_all(), unseen.before.iter().sum::<f64>());
    let is_elsewhere = unseen.left_out.0 > 0
        && (predicted.0 == 0 || beyond(unseen.left_out) > beyond(predicted).max(0.0));
    // within what the noise is known to there is no gap, and no share of one
    let is_gap = rms_before > Floor::of_rows(unseen).ci95()[1];
    let reduction = |without| {
        let [before, after] = [&unseen.before, sums_after].map(|sums| rms(sums, without));
        let share = gap_reduction_percent(before, after, unseen.noise);
        share.filter(|_| is_gap && !is_elsewhere)
    };
    let percent = reduction(None);
    let parts: Option<Vec<f64>> = (0..PARTS).map(|part| reduction(Some(part))).collect();
    let interval = percent.zip(parts).map(|(percent, parts)| {
        let half = 1.96 * jackknife_sd(parts.into_iter());
        [percent - half, (percent + half).min(100.0)]
    });
    HeldOutAnswer {
        channel,
        rms_before,
        rms_after,
        noise_floor: unseen.noise,
        unit: unit.to_owned(),
        reduction_percent: percent,
        reduction_ci95: interval,
        no_reduction: match (is_elsewhere, is_gap) {
            (true, _) => Some(NoReduction::Undetermined),
            (false, true) => None,
            (false, false) => Some(NoReduction::WithinNoise),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_that_is_left_gives_size_and_closed_share_alike() {
        use haptical_calibration::Channel;
        let floor = Floor::new(Channel::Position, 3.0, 1e4, NoiseSource::Motion);
        let gap = |before| {
            let name = "torque1".to_owned();
            ChannelGap::fitted(name, Some(0), [before, before], &floor, "N m").with_left(0.25)
        };
        // 9 + 16 / 4
        assert!((gap(5.0).rms_after - 13.0_f64.sqrt()).abs() < 1e-12);
        assert!((gap(5.0).reduction_percent.unwrap() - 50.0).abs() < 1e-9);
        // no gap has none to close
        let quiet = gap(2.9);
        assert_eq!((quiet.rms_after, quiet.reduction_percent), (2.9, None));
    }
}
