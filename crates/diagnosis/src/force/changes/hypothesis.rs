//! Where a mass may be that changed between two groups of runs: at the flange or on a link, beside what the drives changed by.

use std::convert::Infallible;

use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};

use super::columns::{Columns, Place};
use super::folds::{Fitted, Folds, Sum};
use super::gain::is_beyond_chance;
use crate::force::along::Along;
use crate::thresholds::payload::{FLANGE_REACH_M, KINDS_WITH_PAYLOAD};

/// What was found of a payload: its place, the fit with it, and the one with all the same but it.
pub(super) struct Hypothesis {
    pub(super) place: Place,
    pub(super) fitted: Fitted,
    pub(super) null: Fitted,
    /// First and last link that do as well.
    pub(super) links: [usize; 2],
}

impl Hypothesis {
    /// The place of a mass that does best on unseen blocks, beside the changes of drives that these blocks show with it.
    pub(super) fn found(along: &Along<'_>, columns: &Columns, folds: &mut Folds) -> Option<Self> {
        let common: Vec<usize> = columns.common.clone().collect();
        // a mass at the flange is within some centimetres of it: the mass in kg is fitted first
        let flange = columns.places[0].columns();
        let with_mass = folds.fit(&[&*common, &flange[..1]].concat());
        let first_kg = with_mass.number(flange[0]).abs().max(1e-6);
        for (number, column) in flange.into_iter().enumerate().skip(1) {
            let reach = if number < 4 { 1 } else { 2 };
            folds.knowing(column, FLANGE_REACH_M.powi(reach) * first_kg);
        }
        // the flange, and every link but the first, which one drive alone carries
        let places = columns.places.iter().filter(|place| place.link != Some(0));
        let mut places: Vec<Place> = places.cloned().collect();
        let scale_sds = along.scale_sds();
        // a mass's torque is read with each joint's scale, which is known to a deviation
        let scaled = places.iter().flat_map(|place| {
            let fitted = folds.fit(&[&*common, &place.columns()].concat());
            let terms = place.columns().into_iter();
            let terms = terms.map(|column| (column, fitted.number(column)));
            let terms: Vec<(usize, f64)> = terms.collect();
            let scales = scale_sds.iter().enumerate();
            scales.map(move |(channel, &sd)| (terms.clone(), sd, Some(channel)))
        });
        let scaled: Vec<Sum> = scaled.collect();
        let scales = folds.add_sums(&scaled);
        for (place, scales) in places.iter_mut().zip(scales.chunks(scale_sds.len())) {
            place.scales = scales.to_vec();
        }
        let kinds = 0..KINDS_WITH_PAYLOAD;
        let mut drives = Drives {
            kinds: kinds.map(|kind| columns.every(kind)).collect(),
            places: &places,
            folds,
            common,
        };
        let start = drives.best();
        let Ok(found) = haptical_judge::select(&mut drives, start);
        found
    }
}

/// What the drives changed in addition to a mass, one kind on all joints after the other.
struct Drives<'d> {
    /// Columns of the kinds that are still to be tried.
    kinds: Vec<Vec<usize>>,
    places: &'d [Place],
    folds: &'d Folds,
    /// Columns of the base model and of the kinds that were taken.
    common: Vec<usize>,
}

impl Drives<'_> {
    /// The place of a mass: the flange, unless a link does much better.
    fn best(&self) -> Option<Hypothesis> {
        let null = self.folds.fit(&self.common);
        let gains =
            |fitted: &Fitted, other: &Fitted| is_beyond_chance(fitted.gain_over(other, None));
        let with = |place: &Place| self.folds.fit(&[&*self.common, &place.all()].concat());
        let tried = self.places.iter().map(|place| (place, with(place)));
        let found: Vec<(&Place, Fitted)> =
            tried.filter(|(_, fitted)| gains(fitted, &null)).collect();
        let better = |best: usize, other: usize| match gains(&found[other].1, &found[best].1) {
            true => other,
            false => best,
        };
        let best = (0..found.len()).reduce(better)?;
        let as_well = found
            .iter()
            .filter(|(_, fitted)| !gains(&found[best].1, fitted));
        let links: Vec<usize> = as_well.filter_map(|(place, _)| place.link).collect();
        let links = [links.iter().min(), links.iter().max()].map(Option::<&usize>::copied);
        let (place, fitted) = found.into_iter().nth(best)?;
        let chosen = place.link.unwrap_or_default();
        Some(Hypothesis {
            place: place.clone(),
            fitted,
            null,
            links: links.map(|link| link.unwrap_or(chosen)),
        })
    }
}

impl Forward for Drives<'_> {
    type State = Option<Hypothesis>;
    type Further = Vec<usize>;
    type Error = Infallible;

    fn proposals(&mut self, found: &Option<Hypothesis>) -> Proposals<Self> {
        let Some(found) = found else {
            return Ok(Vec::new());
        };
        let proposal = |kind: &Vec<usize>| {
            let all = [self.common.as_slice(), kind, &found.place.all()].concat();
            let gain = self.folds.fit(&all).gain_over(&found.fitted, None);
            is_beyond_chance(gain).then(|| Proposal {
                merit: gain.sum,
                further: kind.clone(),
            })
        };
        Ok(self.kinds.iter().filter_map(proposal).collect())
    }

    fn rule(&mut self, _: &Option<Hypothesis>, best: Proposal<Vec<usize>>) -> Ruled<Self> {
        self.kinds.retain(|kind| *kind != best.further);
        self.common.extend(best.further);
        Ok(Ruling::Taken(self.best()))
    }
}
