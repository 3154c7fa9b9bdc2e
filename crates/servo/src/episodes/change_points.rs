//! Where a series of one number an episode changes its level.

use std::ops::Range;

use super::scale::{median, scatter};
use crate::thresholds::{CRISP, LEVEL_Z, MOST_SCAN, NEIGHBOURS, STEP_SCATTERS};

/// A change of level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// First place after it.
    pub(super) at: usize,
    /// Median after less that before.
    pub(super) size: f64,
    /// Its standard deviation.
    pub(super) sd: f64,
}

/// The changes of a series, each of at least a size, in their order: the clearest stretch at another level, then those of its parts.
pub(super) fn change_points(values: &[f64], least: f64) -> Vec<Step> {
    let mut found: Vec<Step> = Vec::new();
    let mut parts: Vec<Range<usize>> = std::iter::once(0..values.len()).collect();
    while let Some(part) = parts.pop() {
        let (here, start) = (&values[part.clone()], part.start);
        let Some(stretch) = stretch(here, least) else {
            continue;
        };
        let borders = [0, stretch.start, stretch.end, here.len()];
        found.extend(borders[1..3].iter().filter_map(|at| {
            let step = step(here, *at, least)?;
            Some(Step {
                at: start + at,
                ..step
            })
        }));
        parts.extend(
            borders
                .windows(2)
                .map(|pair| start + pair[0]..start + pair[1]),
        );
    }
    found.sort_by_key(|step| step.at);
    found
}

/// The stretch of places whose mean differs most, by the squares that it takes; it may reach to the end. None where it is no change.
fn stretch(values: &[f64], least: f64) -> Option<Range<usize>> {
    let count = values.len();
    if count < 2 * NEIGHBOURS {
        return None;
    }
    // one odd episode is none; this leaves steps where they are
    let mut smooth = values.to_vec();
    for at in 1..count - 1 {
        smooth[at] = median(&mut values[at - 1..=at + 1].to_vec());
    }
    let mut sums = vec![0.0];
    let middle = median(&mut smooth.clone());
    for value in &smooth {
        sums.push(sums[sums.len() - 1] + value - middle);
    }
    let all = count as f64;
    // squares that a mean of the stretch and one of the others take more than one of all
    let gain = |at: &Range<usize>| {
        let (inside, total, length) = (sums[at.end] - sums[at.start], sums[count], at.len() as f64);
        (inside / length - (total - inside) / (all - length)).powi(2) * length * (all - length)
            / all
    };
    let stride = count.div_ceil(MOST_SCAN);
    let is_long = |at: &Range<usize>| {
        let behind = count - at.end;
        at.len() >= NEIGHBOURS && (behind == 0 || behind >= NEIGHBOURS)
    };
    let best_of = |starts: &mut dyn Iterator<Item = usize>, ends: &dyn Fn() -> Vec<usize>| {
        let ends = ends();
        let pairs = starts.flat_map(|start| ends.iter().map(move |end| start..*end));
        let whole = pairs.filter(|at| at.start >= NEIGHBOURS && at.end > at.start && is_long(at));
        whole
            .map(|at| (gain(&at), at))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|best| best.1)
    };
    let rough = best_of(&mut (NEIGHBOURS..count).step_by(stride), &|| {
        (NEIGHBOURS..count).step_by(stride).chain([count]).collect()
    })?;
    let near = |at: usize| at.saturating_sub(stride)..=(at + stride).min(count);
    let best = best_of(&mut near(rough.start), &|| near(rough.end).collect())?;
    // a stretch that ends must be there at its end, too; else the change is where it begins
    let ends = best.end == count || step(values, best.end, least).is_some();
    let best = if ends { best } else { best.start..count };
    step(values, best.start, least).map(|_| best)
}

/// The change at a place, between the places next to it on either side; none where it is not large and crisp.
fn step(values: &[f64], at: usize, least: f64) -> Option<Step> {
    if at < NEIGHBOURS || at + NEIGHBOURS > values.len() {
        return None;
    }
    let middle = |part: &[f64]| median(&mut part.to_vec());
    // what the levels are on either side, up to the next change: those that are nearer to this side's border
    let (before, after) = values.split_at(at);
    let borders = [
        middle(&before[at - NEIGHBOURS..]),
        middle(&after[..NEIGHBOURS]),
    ];
    let size = borders[1] - borders[0];
    let is_own = |value: &&f64, side: usize| (**value - borders[side]).abs() <= 0.5 * size.abs();
    let lengths = [
        before
            .iter()
            .rev()
            .take_while(|value| is_own(value, 0))
            .count()
            .max(NEIGHBOURS),
        after
            .iter()
            .take_while(|value| is_own(value, 1))
            .count()
            .max(NEIGHBOURS),
    ];
    let size_of_levels = middle(&after[..lengths[1]]) - middle(&before[at - lengths[0]..]);
    let scatter = scatter(values);
    // a median's variance is pi/2 of a mean's
    let parts = 1.0 / lengths[0] as f64 + 1.0 / lengths[1] as f64;
    let sd = scatter * (std::f64::consts::FRAC_PI_2 * parts).sqrt();
    let is_crisp = size / size_of_levels >= CRISP;
    let is_large = size_of_levels.abs() >= (STEP_SCATTERS * scatter).max(LEVEL_Z * sd).max(least);
    // near an end the places are few, and the change may be nearer to it still: then they are odd ones
    let nearer =
        |value: f64, side: usize| (value - borders[side]).abs() < (value - borders[1 - side]).abs();
    let is_inside = at > NEIGHBOURS && at + NEIGHBOURS < values.len();
    let is_here = is_inside || (nearer(before[at - 1], 0) && nearer(after[0], 1));
    (is_large && is_crisp && is_here).then_some(Step {
        at,
        size: size_of_levels,
        sd,
    })
}

#[cfg(test)]
mod tests {
    use super::change_points;

    #[test]
    fn steps_are_placed_and_slopes_and_outliers_are_none() {
        let noise = |place: usize| 0.01 * (1.7 * place as f64).sin();
        let series = |of: &dyn Fn(usize) -> f64| {
            (0..40)
                .map(|place| of(place) + noise(place))
                .collect::<Vec<_>>()
        };
        let stepped = series(&|place| match place {
            12..30 => 0.5,
            _ => 0.0,
        });
        let places: Vec<usize> = change_points(&stepped, 0.02)
            .iter()
            .map(|step| step.at)
            .collect();
        assert_eq!(places, [12, 30]);
        assert!(change_points(&series(&|place| 0.02 * place as f64), 0.02).is_empty());
        assert!(change_points(&series(&|place| f64::from(place == 20)), 0.02).is_empty());
        assert!(change_points(&stepped, 0.6).is_empty());
        let short = series(&|place| if (5..9).contains(&place) { 0.1 } else { 0.0 });
        let places: Vec<usize> = change_points(&short[..14], 0.02)
            .iter()
            .map(|step| step.at)
            .collect();
        assert_eq!(places, [5, 9]);
    }
}
