//! Runs of neighbouring bins, each with noise of one size.

/// Bins `bounds[i]..bounds[i + 1]` make one run; `gain` is what they explain better than a single run does, in twice the
/// logarithm of the likelihood less the penalties.
#[derive(Debug, PartialEq)]
pub(super) struct Runs {
    pub(super) bounds: Vec<usize>,
    pub(super) gain: f64,
}

/// Least sum over runs of `den ln(num / den) + penalty`, with `num` sums of squares and `den` their degrees of freedom, at
/// least `least` of these in a run; by dynamic programming over the ends (Jackson et al. 2005, IEEE Signal Processing
/// Letters 12).
pub(super) fn runs(num: &[f64], den: &[f64], penalty: f64, least: f64) -> Runs {
    let count = num.len();
    let sums = |values: &[f64]| {
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        sums.extend(values.iter().map(|value| {
            sum += value;
            sum
        }));
        sums
    };
    let (squares, freedom) = (sums(num), sums(den));
    let cost = |first: usize, end: usize| {
        let own = freedom[end] - freedom[first];
        let square = (squares[end] - squares[first]).max(f64::MIN_POSITIVE);
        (own >= least).then(|| own * (square / own).ln() + penalty)
    };
    let mut best = vec![f64::INFINITY; count + 1];
    let mut back = vec![0; count + 1];
    best[0] = 0.0;
    for end in 1..=count {
        for first in 0..end {
            let whole = cost(first, end).map_or(f64::INFINITY, |cost| best[first] + cost);
            if whole < best[end] {
                (best[end], back[end]) = (whole, first);
            }
        }
    }
    if !best[count].is_finite() {
        return Runs {
            bounds: vec![0, count],
            gain: 0.0,
        };
    }
    let mut bounds = vec![count];
    let mut end = count;
    while end > 0 {
        end = back[end];
        bounds.push(end);
    }
    bounds.reverse();
    let single = cost(0, count).unwrap_or(best[count]);
    Runs {
        bounds,
        gain: single - best[count],
    }
}

#[cfg(test)]
mod tests {
    use super::runs;

    #[test]
    fn a_step_in_size_is_found_where_it_is() {
        let num: Vec<f64> = (0..20)
            .map(|bin| if bin < 13 { 10.0 } else { 90.0 })
            .collect();
        let found = runs(&num, &[10.0; 20], 3.0 * 200.0_f64.ln(), 8.0);
        assert_eq!(found.bounds, [0, 13, 20]);
        // 130 of size 1 and 70 of size 9, instead of 200 of size 3.8
        let single = 200.0 * 3.8_f64.ln();
        let expected = single - 70.0 * 9.0_f64.ln() - 3.0 * 200.0_f64.ln();
        assert!((found.gain - expected).abs() < 1e-9, "{}", found.gain);
    }

    #[test]
    fn even_noise_is_one_run() {
        let num: Vec<f64> = (0..20).map(|bin| 10.0 + f64::from(bin % 3)).collect();
        assert_eq!(runs(&num, &[10.0; 20], 15.0, 8.0).bounds, [0, 20]);
    }

    #[test]
    fn no_run_has_fewer_degrees_of_freedom_than_asked() {
        let found = runs(&[1.0, 900.0, 1.0, 1.0], &[4.0; 4], 0.1, 8.0);
        assert!(found.bounds.windows(2).all(|pair| pair[1] - pair[0] >= 2));
    }
}
