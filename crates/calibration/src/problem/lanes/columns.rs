//! The columns of a cable's derivatives, and which of them are equal.

use haptical_model::ParameterId;

use crate::problem::lanes::plan::{CablePlan, JointPlan};

/// A column: the derivative with respect to one of the entries, or that times a transmission's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColumnSource {
    Entry(usize),
    Product {
        entry: usize,
        joint: usize,
        index: usize,
    },
}

/// Columns of a cable with respect to free parameters.
///
/// A transmission's constant term moves the joint as its joint offset does, so both have one column, which only the
/// external encoder's rows tell apart: it is reduced once.
#[derive(Debug)]
pub(crate) struct CableColumns {
    /// Entries of the model's vector whose derivatives are needed.
    pub(crate) entries: Vec<usize>,
    /// Columns that differ.
    pub(crate) distinct: Vec<ColumnSource>,
    /// How many of these are products.
    pub(crate) products: usize,
    /// Which of the distinct ones each column is.
    pub(crate) of: Vec<usize>,
}

impl CableColumns {
    /// None where a parameter has no effect that the plan knows.
    pub(crate) fn new(
        plan: &CablePlan,
        joints: &[JointPlan],
        parameters: &[ParameterId],
        chosen: impl ExactSizeIterator<Item = usize>,
    ) -> Option<Self> {
        if plan.variables.iter().all(Option::is_none) {
            // of the chain alone: no two are equal
            let own = |parameter| plan.links.iter().position(|each| *each == Some(parameter));
            let entries: Vec<usize> = chosen.map(own).collect::<Option<_>>()?;
            return Some(Self {
                distinct: (0..entries.len()).map(ColumnSource::Entry).collect(),
                products: 0,
                of: (0..entries.len()).collect(),
                entries,
            });
        }
        let mut entries = Vec::with_capacity(chosen.len());
        let (mut distinct, mut of) = (
            Vec::with_capacity(chosen.len()),
            Vec::with_capacity(chosen.len()),
        );
        for parameter in chosen {
            let (wanted, term) = match parameters.get(parameter)? {
                ParameterId::Transmission { joint, index } => {
                    let is_constant = joints.get(*joint)?.constant == Some(*index);
                    let term = (!is_constant).then_some((*joint, *index));
                    ((*plan.variables.get(*joint)?)?, term)
                }
                _ => {
                    let own = plan.links.iter().position(|each| *each == Some(parameter));
                    (own?, None)
                }
            };
            let entry = place(&mut entries, wanted);
            let source = match term {
                None => ColumnSource::Entry(entry),
                Some((joint, index)) => ColumnSource::Product {
                    entry,
                    joint,
                    index,
                },
            };
            of.push(place(&mut distinct, source));
        }
        let is_product = |source: &&ColumnSource| matches!(source, ColumnSource::Product { .. });
        Some(Self {
            products: distinct.iter().filter(is_product).count(),
            entries,
            distinct,
            of,
        })
    }
}

/// Where something is among the known, at their end if it was not there.
fn place<T: PartialEq>(known: &mut Vec<T>, wanted: T) -> usize {
    let found = known.iter().position(|each| *each == wanted);
    found.unwrap_or_else(|| {
        known.push(wanted);
        known.len() - 1
    })
}
