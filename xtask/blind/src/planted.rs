//! What was put into a recording by a generator that has no catalogue of kinds: names, right answers, numbers; and the truth
//! that they make.

use std::collections::BTreeMap;

use crate::gap::ChannelGapTruth;
use crate::trial::TrialId;
use crate::truth::{Besides, EffectTruth, Event, Truth};

/// One effect of a recording.
#[derive(Debug, Clone)]
pub(crate) struct Planted {
    /// Name in the catalogue, or one of its own.
    pub(crate) name: &'static str,
    /// Joint, from 0.
    pub(crate) joint: Option<usize>,
    /// Names of which one must be answered; none where it need not be.
    pub(crate) right: Vec<&'static str>,
    /// Names that may be answered besides, without being put in.
    pub(crate) acceptable: Vec<&'static str>,
    /// Size relative to the strong one.
    pub(crate) size: f64,
    /// Parameters with the catalogue's names.
    pub(crate) parameters: BTreeMap<String, f64>,
    /// Numbers of its law, for readers.
    pub(crate) law: BTreeMap<String, f64>,
    /// Sudden events of each recording.
    pub(crate) events: Vec<Vec<Event>>,
}

impl Default for Planted {
    /// A strong effect without a name.
    fn default() -> Self {
        Self {
            name: "",
            joint: None,
            right: Vec::new(),
            acceptable: Vec::new(),
            size: 1.0,
            parameters: BTreeMap::new(),
            law: BTreeMap::new(),
            events: Vec::new(),
        }
    }
}

/// What one trial is about.
#[derive(Debug, Clone, Default)]
pub(crate) struct Story {
    pub(crate) label: String,
    /// Nominal device.
    pub(crate) device: String,
    pub(crate) planted: Vec<Planted>,
    /// Names that the catalogue must do without; then what they name is not to be found.
    pub(crate) without: Vec<&'static str>,
    /// Columns that an effect in no catalogue depends on.
    pub(crate) depends_on: Vec<String>,
    pub(crate) is_unknown: bool,
}

impl Story {
    /// The truth of the trial at `index` of a suite. A group of right names that is withheld is no group any more; where
    /// none is left, `unknown` is right, and the other names that were put in may be answered.
    pub(crate) fn truth(self, id: TrialId, gap: BTreeMap<String, ChannelGapTruth>) -> Truth {
        let owned = |names: &[&str]| -> Vec<String> {
            names.iter().map(|name| (*name).to_owned()).collect()
        };
        let is_withheld =
            |planted: &Planted| planted.right.iter().any(|name| self.without.contains(name));
        let (withheld, left): (Vec<&Planted>, Vec<&Planted>) = self
            .planted
            .iter()
            .filter(|planted| !planted.right.is_empty())
            .partition(|planted| is_withheld(planted));
        let acceptable = self.planted.iter();
        let acceptable = acceptable.flat_map(|planted| owned(&planted.acceptable));
        let mut acceptable: Vec<String> = acceptable.collect();
        let mut right: Vec<Vec<String>> =
            left.iter().map(|planted| owned(&planted.right)).collect();
        let number = |planted: &&Planted| planted.joint.map(|joint| joint + 1);
        let mut joints: Vec<Option<usize>> = left.iter().map(number).collect();
        if self.is_unknown || !withheld.is_empty() {
            acceptable.extend(right.into_iter().flatten());
            right = vec![vec!["unknown".to_owned()]];
            joints = withheld.first().map(number).into_iter().collect();
        }
        let effects = self.planted.into_iter().map(|planted| EffectTruth {
            effect: planted.name.to_owned(),
            joint: planted.joint.map(|joint| joint + 1),
            size: planted.size,
            parameters: planted.parameters,
            law: planted.law,
            events: planted.events,
        });
        Truth {
            suite: id.suite.to_owned(),
            index: id.index,
            batch_seed: id.seed,
            device: self.device,
            name: self.label,
            effects: effects.collect(),
            right,
            joint: joints.first().copied().flatten(),
            joints,
            without: owned(&self.without),
            acceptable,
            depends_on: self.depends_on,
            gap,
            no_gap_is_right: false,
            implausible: false,
            besides: Besides::default(),
        }
    }
}
