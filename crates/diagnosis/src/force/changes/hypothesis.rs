//! Where a mass may be that changed between two groups of runs: at the flange or on a link, beside what the drives changed by.

use std::convert::Infallible;

use haptical_judge::{Forward, Proposal, Ruling};

use super::columns::{Columns, Own};
use super::folds::{Fitted, Folds};
use super::gain::is_beyond_chance;
use crate::force::along::Along;
use crate::thresholds::payload::{FLANGE_REACH_M, KINDS_WITH_PAYLOAD};

/// What a drive may change by on all joints at once.
pub(super) const KINDS: [fn(&Own) -> Vec<usize>; 3] = [
    |own| vec![own.offset],
    |own| own.friction.clone().collect(),
    |own| vec![own.gain],
];

/// A place of a mass: the link, its columns beside the common ones, and those of the scales that its torque is read with.
#[derive(Debug, Clone)]
pub(super) struct Carrier {
    pub(super) link: Option<usize>,
    pub(super) columns: Vec<usize>,
    scales: Vec<usize>,
}

impl Carrier {
    /// All its columns.
    pub(super) fn all(&self) -> Vec<usize> {
        [self.columns.as_slice(), &self.scales].concat()
    }

    /// Its torque is read with each joint's scale, which is known to a deviation.
    fn scaled(mut self, folds: &mut Folds, common: &[usize], scale_sds: &[f64]) -> Self {
        let fitted = folds.fit(&[common, &self.columns].concat());
        let numbers: Vec<f64> = self
            .columns
            .iter()
            .map(|&column| fitted.number(column))
            .collect();
        self.scales = folds.scale(&self.columns, &numbers, scale_sds);
        self
    }
}

/// What was found of a payload: its place, the fit with it, and the one with all the same but it.
pub(super) struct Hypothesis {
    pub(super) carrier: Carrier,
    pub(super) fitted: Fitted,
    pub(super) null: Fitted,
    /// First and last link that do as well.
    pub(super) links: [usize; 2],
}

impl Hypothesis {
    /// The place of a mass that does best on unseen blocks, beside the changes of drives that these blocks show with it.
    pub(super) fn found(
        along: &Along<'_>,
        columns: &Columns,
        folds: &mut Folds,
        every: &[usize],
    ) -> Option<Self> {
        let common: Vec<usize> = columns.common.clone().collect();
        know_flange(columns, folds, &common);
        let scale_sds = along.scale_sds();
        let carriers: Vec<Carrier> = carriers(columns)
            .map(|carrier| carrier.scaled(folds, &common, &scale_sds))
            .collect();
        let kinds = KINDS[..KINDS_WITH_PAYLOAD].iter();
        let mut drives = Drives {
            kinds: kinds.map(|kind| columns.every(kind)).collect(),
            carriers: &carriers,
            folds,
            common,
            every,
        };
        let start = Self::beside(&carriers, folds, &drives.common, every);
        let Ok(found) = haptical_judge::select(&mut drives, start);
        found
    }

    /// The same beside some columns: the flange, unless a link does much better.
    fn beside(
        carriers: &[Carrier],
        folds: &Folds,
        common: &[usize],
        every: &[usize],
    ) -> Option<Self> {
        let null = folds.fit(common);
        let gains = |own: &Fitted, other: &Fitted| is_beyond_chance(own.gain_over(other, every));
        let tried = carriers.iter().map(|carrier| {
            let fitted = folds.fit(&[common, &carrier.all()].concat());
            (carrier, fitted)
        });
        let found: Vec<(&Carrier, Fitted)> = tried.filter(|own| gains(&own.1, &null)).collect();
        let better = |best: usize, own: usize| match gains(&found[own].1, &found[best].1) {
            true => own,
            false => best,
        };
        let best = (0..found.len()).reduce(better)?;
        let as_well = found.iter().filter(|own| !gains(&found[best].1, &own.1));
        let links: Vec<usize> = as_well.filter_map(|own| own.0.link).collect();
        let links = [links.iter().min(), links.iter().max()].map(Option::<&usize>::copied);
        let (carrier, fitted) = found.into_iter().nth(best)?;
        let own = carrier.link.unwrap_or_default();
        Some(Self {
            carrier: carrier.clone(),
            fitted,
            null,
            links: links.map(|link| link.unwrap_or(own)),
        })
    }
}

/// What drives changed by with a mass, one kind on all joints after the other.
struct Drives<'d> {
    /// Columns of the kinds that are still to be tried.
    kinds: Vec<Vec<usize>>,
    carriers: &'d [Carrier],
    folds: &'d Folds,
    /// Columns of the base model and of the kinds that were taken.
    common: Vec<usize>,
    every: &'d [usize],
}

impl Forward for Drives<'_> {
    type State = Option<Hypothesis>;
    type Further = Vec<usize>;
    type Error = Infallible;

    fn proposals(
        &mut self,
        found: &Option<Hypothesis>,
    ) -> Result<Vec<Proposal<Vec<usize>>>, Infallible> {
        let Some(found) = found else {
            return Ok(Vec::new());
        };
        let gains = self.kinds.iter().map(|kind| {
            let all = [self.common.as_slice(), kind, &found.carrier.all()].concat();
            let with_kind = self.folds.fit(&all);
            (kind, with_kind.gain_over(&found.fitted, self.every))
        });
        let supported = gains.filter(|(_, gain)| is_beyond_chance(*gain));
        Ok(supported
            .map(|(kind, gain)| Proposal {
                merit: gain.sum,
                further: kind.clone(),
            })
            .collect())
    }

    fn rule(
        &mut self,
        _: &Option<Hypothesis>,
        best: Proposal<Vec<usize>>,
    ) -> Result<Ruling<Option<Hypothesis>>, Infallible> {
        self.kinds.retain(|kind| *kind != best.further);
        self.common.extend(best.further);
        let next = Hypothesis::beside(self.carriers, self.folds, &self.common, self.every);
        Ok(Ruling::Taken(next))
    }
}

/// The flange, and every link that a drive in front of others carries.
fn carriers(columns: &Columns) -> impl Iterator<Item = Carrier> {
    let flange = Carrier {
        link: None,
        columns: columns.flange.clone().collect(),
        scales: Vec::new(),
    };
    let links = columns.links.iter().enumerate().skip(1);
    std::iter::once(flange).chain(links.map(|(link, numbers)| Carrier {
        link: Some(link),
        columns: numbers.iter().map(|(column, _)| *column).collect(),
        scales: Vec::new(),
    }))
}

/// The place of a mass at the flange is known to some centimetres of it: to find its size first.
fn know_flange(columns: &Columns, folds: &mut Folds, common: &[usize]) {
    let mass = columns.flange.start;
    let first = folds.fit(&[common, &[mass]].concat()).number(mass).abs();
    for (number, column) in columns.flange.clone().enumerate().skip(1) {
        let reach = if number < 4 { 1 } else { 2 };
        folds.knowing(column, FLANGE_REACH_M.powi(reach) * first.max(1e-6));
    }
}
