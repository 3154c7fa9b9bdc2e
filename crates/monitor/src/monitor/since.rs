//! Since when something is another, and what moved.

use super::{ComponentState, FARTHEST, LEVEL, Monitor, Shift};
use crate::change::{Change, Shape, change};
use crate::reference::Feature;

/// A feature that is read too seldom to be judged.
const UNREAD: Feature = Feature {
    mean: 0.0,
    sd: 1.0,
    margin: 1.0,
    widened: 1.0,
    share: 1.0,
};

impl Monitor {
    /// The block of the ring that raised the alarm: the change is in no later one.
    fn alarmed_at(&self) -> Option<usize> {
        let row = self.alarm_row?;
        let after = self.marks.iter().position(|mark| mark.row > row);
        after.map(|after| after.saturating_sub(1))
    }

    /// Since when the features are others, with the time that was given with its first row, and the number of that row; none
    /// before a block was judged. The interval holds the change in 95 % of changes; where it ends with the last block, it ends with the
    /// last row. It begins earlier by `hidden`, in the unit of the times: for as long a change may not show, as it is none at the postures
    /// ([`Course`](crate::Course)); 0 for one that is the same at each.
    pub fn change(&self, hidden: f64) -> Option<(Change, [f64; 3], u64)> {
        let flat: Vec<f64> = self.ring.iter().copied().collect();
        let features = self.reference.as_ref()?.features.iter();
        let features: Vec<Feature> = features
            .flat_map(|own| own.unwrap_or([UNREAD; 2]))
            .collect();
        let blocks = flat.chunks_exact(features.len().max(1));
        let found = change(blocks, &features, self.alarmed_at(), LEVEL)?;
        let time = |block: usize| {
            self.marks
                .get(block)
                .or(self.marks.back())
                .map(|mark| mark.time)
        };
        // a change within a block makes the block after it the first whole one
        let shows = time(found.interval[0].saturating_sub(1))?;
        let times = [
            (shows - hidden).max(self.marks.front()?.time),
            time(found.first)?,
            match self.marks.get(found.interval[1] + 1) {
                Some(mark) => mark.time,
                None => self.last_time,
            },
        ];
        let row = self.marks.get(found.first)?.row;
        Some((found, times, row))
    }

    /// The first block of the ring that is another in every row of it, and its first row, which may not be there yet: a change
    /// comes within its first block.
    pub fn whole_since(&self, change: &Change) -> (usize, u64) {
        let last = self.blocks_kept().saturating_sub(1);
        let next = (change.first + 1).min(last);
        let sure = match change.shape {
            Shape::Step => change.interval[1] + 1,
            Shape::Ramp => change.first,
        };
        let row = self.marks.get(sure).map_or(self.rows + 1, |mark| mark.row);
        (next, row)
    }

    /// What moved since a block of the ring, components with most of the evidence first.
    pub fn shifts(&self, since: usize) -> Vec<Shift> {
        let (Some(reference), Some(detector)) = (&self.reference, &self.detector) else {
            return Vec::new();
        };
        let all = detector.evidence().max(f64::MIN_POSITIVE);
        let mut found = Vec::new();
        for (component, features) in reference.features.iter().enumerate() {
            let Some([of_mean, of_size]) = features else {
                continue;
            };
            let (mean, count) = self.ring_mean(2 * component, since);
            let (size, _) = self.ring_mean(2 * component + 1, since);
            let (scale, centre) = (self.scales[component], self.centres[component]);
            let rms = |cube_root: f64| scale * cube_root.max(0.0).powf(1.5);
            let (rms_before, rms_since) =
                (rms(of_size.mean), rms(of_size.mean + size * of_size.sd));
            // what scatters more says less of its mean
            let grown = (rms_since / rms_before.max(f64::MIN_POSITIVE)).clamp(1.0, FARTHEST);
            let half_width =
                grown * 1.96 * scale * of_mean.sd * of_mean.widened / count.max(1.0).sqrt();
            let shift = Shift {
                component,
                mean_before: centre + scale * of_mean.mean,
                mean_since: centre + scale * (of_mean.mean + mean * of_mean.sd),
                half_width,
                rms_before,
                rms_since,
                share: detector.of(component) / all,
            };
            let mut shift = match self.unclipped.beyond(component, since) {
                None => shift,
                Some(beyond) => Shift {
                    mean_since: centre + scale * beyond.mean,
                    half_width: half_width.max(1.96 * scale * beyond.sd * of_mean.widened),
                    rms_since: rms_since.max(scale * beyond.rms),
                    ..shift
                },
            };
            // one block, in which the change may have come at any row: its farthest reading may be what all are from now on
            let only =
                (since + 1 == self.blocks_kept()).then(|| self.unclipped.extreme(component, since));
            if let Some(extreme) = only.flatten() {
                let far = (centre + scale * extreme - shift.mean_since).abs();
                shift.half_width = shift.half_width.max(far);
            }
            found.push(shift);
        }
        found.sort_by(|a, b| b.share.total_cmp(&a.share));
        found
    }

    /// Blocks of the ring.
    fn blocks_kept(&self) -> usize {
        self.ring.len() / (2 * self.scales.len()).max(1)
    }

    /// Mean of a standardised feature from a block of the ring on, and of how many.
    fn ring_mean(&self, feature: usize, since: usize) -> (f64, f64) {
        let width = 2 * self.scales.len();
        let own = self
            .ring
            .iter()
            .skip(since * width + feature)
            .step_by(width.max(1));
        let (mut sum, mut count) = (0.0, 0.0);
        for value in own.filter(|value| value.is_finite()) {
            sum += value;
            count += 1.0;
        }
        (sum / f64::max(count, 1.0), count)
    }

    /// Where a component stands over the last `blocks` blocks; none while nothing was judged.
    pub fn state(&self, component: usize, blocks: usize) -> Option<ComponentState> {
        let features = self.reference.as_ref()?.features.get(component)?.as_ref()?;
        let width = 2 * self.scales.len();
        let since = (self.ring.len() / width).saturating_sub(blocks);
        let (mean, count) = self.ring_mean(2 * component, since);
        let scale = self.scales[component];
        let half_width = 1.96 * scale * features[0].sd * features[0].widened / count.sqrt();
        let (shift, half_width) = match self.unclipped.beyond(component, since) {
            None => (scale * features[0].sd * mean, half_width),
            Some(beyond) => (
                scale * (beyond.mean - features[0].mean),
                half_width.max(1.96 * scale * beyond.sd * features[0].widened),
            ),
        };
        (count > 0.0).then_some(ComponentState {
            shift,
            half_width,
            scale,
        })
    }
}
