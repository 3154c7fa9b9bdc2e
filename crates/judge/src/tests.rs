//! The judge on sums of columns that are orthogonal but for one.

use std::convert::Infallible;

use super::*;

/// Each effect explains so much by itself. The first imitates the second and the third together.
struct Sums {
    worth: [f64; 4],
    refused: Vec<usize>,
    asked: usize,
}

impl Sums {
    fn explained(&self, taken: &[usize]) -> f64 {
        let has = |effect: usize| taken.contains(&effect);
        let [imitation, second, third, fourth] = self.worth;
        let parts = [(1, second), (2, third)];
        let of_parts: f64 = parts
            .iter()
            .map(|(effect, worth)| f64::from(u8::from(has(*effect))) * worth)
            .sum();
        let of_pair = match has(0) {
            true => of_parts.max(imitation),
            false => of_parts,
        };
        of_pair + f64::from(u8::from(has(3))) * fourth
    }
}

impl Forward for Sums {
    type State = Vec<usize>;
    type Further = usize;
    type Error = Infallible;

    fn proposals(&mut self, state: &Vec<usize>) -> Proposals<Self> {
        self.asked += 1;
        let open =
            (0..4).filter(|effect| !state.contains(effect) && !self.refused.contains(effect));
        Ok(open
            .map(|further| {
                let with = [state.as_slice(), &[further]].concat();
                let merit = self.explained(&with) - self.explained(state);
                Proposal { further, merit }
            })
            .collect())
    }

    fn rule(&mut self, state: &Vec<usize>, best: Proposal<usize>) -> Ruled<Self> {
        if best.merit < 1.0 {
            return Ok(Ruling::Ended);
        }
        if best.further == 3 {
            self.refused.push(3);
            return Ok(Ruling::Refused);
        }
        Ok(Ruling::Taken([state.as_slice(), &[best.further]].concat()))
    }
}

impl Backward for Sums {
    type State = Vec<usize>;
    type Error = Infallible;

    fn effects(&self, state: &Vec<usize>) -> usize {
        state.len()
    }

    fn without(&mut self, state: &Vec<usize>, effect: usize) -> Less<Self> {
        let mut less = state.clone();
        less.remove(effect);
        let worth = self.explained(state) - self.explained(&less);
        Ok(Without { state: less, worth })
    }
}

impl Needless for Sums {
    fn is_needless(
        &mut self,
        _: &Vec<usize>,
        effect: usize,
        all: &[Without<Vec<usize>>],
    ) -> Result<bool, Infallible> {
        Ok(all[effect].worth < 1.0)
    }
}

impl InPlace for Sums {
    type Name = usize;
    type Fit = ();

    fn in_place(&mut self, without: &Vec<usize>, whole: &Vec<usize>, _: usize) -> Others<Self> {
        let found = self.proposals(without)?;
        let others = found
            .into_iter()
            .filter(|found| !whole.contains(&found.further));
        Ok(others
            .map(|found| Other {
                name: found.further,
                merit: found.merit,
                fit: (),
            })
            .collect())
    }
}

fn sums() -> Sums {
    Sums {
        worth: [12.0, 8.0, 7.0, 5.0],
        refused: Vec::new(),
        asked: 0,
    }
}

#[test]
fn the_best_is_taken_first_and_a_refused_one_is_passed_over() {
    let mut sums = sums();
    // 12 of the imitation; then 15 of the two that it imitates are 3 more, and 5 of the one that is refused
    let Ok(found) = select(&mut sums, Vec::new());
    assert_eq!(found[0], 0);
    assert_eq!(sums.refused, [3]);
    assert!(!found.contains(&3));
}

#[test]
fn what_later_effects_explain_is_taken_out_the_least_first() {
    let mut sums = sums();
    let Ok(kept) = without_needless(&mut sums, vec![0, 1, 2], 1);
    assert_eq!(kept.state, [1, 2]);
    assert_eq!(kept.worth, Some(vec![8.0, 7.0]));
    // all three could go at first; once the imitation is out, which is worth nothing, the others are needed
    sums.worth = [12.0, 6.2, 6.3, 0.0];
    let Ok(kept) = without_needless(&mut sums, vec![0, 1, 2], 1);
    assert_eq!(kept.state, [1, 2]);
    // the last one stays, whatever it is worth
    sums.worth = [0.5; 4];
    let Ok(kept) = without_needless(&mut sums, vec![1, 2], 1);
    assert_eq!((kept.state.len(), kept.worth), (1, Some(vec![0.5])));
    let Ok(kept) = without_needless(&mut sums, vec![1], 1);
    assert_eq!(kept.worth, None);
}

#[test]
fn rivals_are_sorted_by_how_far_they_are_behind() {
    let mut sums = sums();
    let whole = vec![0];
    let Ok(without) = sums.without(&whole, 0);
    assert_eq!(without.worth, 12.0);
    let Ok(found) = rivals(&mut sums, &whole, 0, &without, 2.0);
    let names: Vec<usize> = found.iter().map(|rival| rival.name).collect();
    assert_eq!(names, [1, 2, 3]);
    assert_eq!(found[0].behind, 2.0);
}

/// Names that stand in several places of a list.
struct Repeated;

impl Backward for Repeated {
    type State = ();
    type Error = Infallible;

    fn effects(&self, (): &()) -> usize {
        1
    }

    fn without(&mut self, (): &(), _: usize) -> Less<Self> {
        let worth = 5.0;
        Ok(Without { state: (), worth })
    }
}

impl InPlace for Repeated {
    type Name = &'static str;
    type Fit = ();

    fn in_place(&mut self, (): &(), (): &(), _: usize) -> Others<Self> {
        let all = [("lag", 1.0), ("play", 2.0), ("lag", 3.0), ("play", 1.5)];
        let other = |(name, merit)| Other {
            name,
            merit,
            fit: (),
        };
        Ok(all.map(other).into())
    }
}

#[test]
fn a_name_counts_once_by_its_best() {
    let Ok(without) = Repeated.without(&(), 0);
    let Ok(found) = rivals(&mut Repeated, &(), 0, &without, 1.0);
    let found: Vec<_> = found
        .iter()
        .map(|rival| (rival.name, rival.behind))
        .collect();
    assert_eq!(found, [("lag", 2.0), ("play", 3.0)]);
}

#[test]
fn a_name_is_as_likely_as_it_is_ahead() {
    assert_eq!(probability([0.0, 0.0]), 1.0 / 3.0);
    assert!((probability([9.0_f64.ln()]) - 0.9).abs() < 1e-12);
    // one that is far ahead leaves it nothing, and a number
    let beaten = probability([-1e9]);
    assert!(beaten > 0.0 && beaten < 1e-20);
}

#[test]
fn ranks_count_the_sizes_of_those_against() {
    assert_eq!(Gain::new(&[5.0, -1.0, 8.0]).ranks_against, 1.0);
    assert_eq!(Gain::new(&[2.0, 1.0, -3.0]).ranks_against, 3.0);
}

#[test]
fn noise_is_no_part_of_what_is_closed() {
    // 9 of 10 squares in a part are the gap's, and 8 of these 9 are closed
    let closed = closed_share(&[10.0; 5], &[2.0; 5], 5.0);
    for value in [closed.share, closed.ci95[0], closed.ci95[1]] {
        assert!((value - 8.0 / 9.0).abs() < 1e-12, "{closed:?}");
    }
}

#[test]
fn a_gain_that_no_part_is_against_is_sure_by_its_signs() {
    let gain = Gain::between(&[2.0, 3.0, 400.0, 2.5], &[1.0; 4]);
    assert!(gain.deviations() < 1.1);
    assert_eq!(gain.deviations_by_sign(), 2.0);
    assert_eq!(
        Gain::new(&[-1.0; 4]).deviations_by_sign(),
        f64::NEG_INFINITY.max(-4.0 / f64::MIN_POSITIVE)
    );
    assert_eq!(gain.share_gaining(), 1.0);
}

#[test]
fn the_interval_of_a_share_is_as_wide_as_its_parts_differ() {
    let even = closed_share(&[10.0; 8], &[3.0; 8], 8.0);
    assert!((even.ci95[1] - even.ci95[0]).abs() < 1e-12);
    let one_part_closes = [[10.0; 7].as_slice(), &[80.0]].concat();
    let uneven = closed_share(&one_part_closes, &[9.0; 8], 8.0);
    assert!(uneven.ci95[0] < 0.2 && uneven.ci95[1] == 1.0);
    // more is left than there was
    assert!(closed_share(&[2.0; 8], &[3.0; 8], 8.0).share < 0.0);
}

#[test]
fn a_verdict_has_a_gap_a_support_and_a_name() {
    let found = Evidence {
        has_gap: true,
        is_supported: true,
        probability: Some(0.8),
    };
    let of = |change: fn(&mut Evidence)| {
        let mut changed = found;
        change(&mut changed);
        verdict(changed)
    };
    assert_eq!(verdict(found), Verdict::Named);
    assert_eq!(of(|own| own.has_gap = false), Verdict::NoGap);
    assert_eq!(of(|own| own.is_supported = false), Verdict::Unknown);
    assert_eq!(of(|own| own.probability = None), Verdict::Unknown);
    assert_eq!(of(|own| own.probability = Some(0.79)), Verdict::Ambiguous);
}
