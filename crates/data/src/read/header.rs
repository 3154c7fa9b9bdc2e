//! The first line of a log: which column is what, and whether the device's columns are all there.

use csv::StringRecord;

use crate::column::{FORCE, ORIENTATION, POSITION, Role, indexed};
use crate::error::near_miss::{NearMiss, near_miss};
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::read::cell;
use crate::shape::LogShape;

/// A checked header.
#[derive(Debug)]
pub(crate) struct Header {
    /// Its line in the file.
    pub(crate) line: u64,
    /// Its names, trimmed, with their meaning.
    pub(crate) columns: Vec<(String, Role)>,
    /// What is worth a warning.
    pub(crate) warnings: Vec<String>,
}

impl Header {
    /// Checks a header against a device.
    pub(crate) fn new(
        record: &StringRecord,
        line: u64,
        file: &str,
        shape: &LogShape,
    ) -> Result<Self, DataError> {
        let columns: Vec<(String, Role)> = record
            .iter()
            .map(|cell| (cell.trim().to_owned(), Role::parse(cell.trim(), shape)))
            .collect();
        let mut header = Self {
            line,
            columns,
            warnings: Vec::new(),
        };
        header.reject_numbers(file)?;
        header.reject_duplicates(file)?;
        header.reject_wrong_units(file, shape)?;
        header.require_joints(file, shape)?;
        for group in [&POSITION[..], &ORIENTATION[..], &FORCE[..]] {
            header.require_whole(group, file)?;
        }
        header.warn(file, shape);
        Ok(header)
    }

    fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|(column, _)| column == name)
    }

    fn place(&self, file: &str, index: usize) -> Box<Place> {
        Place::cell(file, self.line, index + 1, &self.columns[index].0)
    }

    fn reject_numbers(&self, file: &str) -> Result<(), DataError> {
        let is_number = |name: &str| !matches!(cell::number(name), Err(Fault::NotANumber { .. }));
        let named = || {
            self.columns
                .iter()
                .map(|(name, _)| name)
                .filter(|name| !name.is_empty())
        };
        match named().next() {
            Some(_) if !named().all(|name| is_number(name)) => Ok(()),
            first => Err(Place::line(file, self.line).error(Fault::NoHeader {
                found: first.map_or_else(String::new, |name| cell::shortened(name)),
            })),
        }
    }

    fn reject_duplicates(&self, file: &str) -> Result<(), DataError> {
        let mut sorted: Vec<usize> = (0..self.columns.len())
            .filter(|&index| self.columns[index].1 != Role::Unnamed)
            .collect();
        sorted.sort_by_key(|&index| (&self.columns[index].0, index));
        let duplicate = sorted
            .windows(2)
            .filter(|pair| self.columns[pair[0]].0 == self.columns[pair[1]].0)
            .map(|pair| [pair[0], pair[1]])
            .min_by_key(|pair| pair[1]);
        match duplicate.or_else(|| self.torque_twice()) {
            None => Ok(()),
            Some(pair) => Err(self
                .place(file, pair[1])
                .error(Fault::DuplicateColumn { first: pair[0] + 1 })),
        }
    }

    /// Two columns of one drive, in N and in N m.
    fn torque_twice(&self) -> Option<[usize; 2]> {
        let roles: Vec<Role> = self.columns.iter().map(|(_, role)| *role).collect();
        (0..roles.len()).find_map(|second| {
            let is_torque = matches!(roles[second], Role::Torque(_));
            let first = roles[..second]
                .iter()
                .position(|role| *role == roles[second]);
            first.filter(|_| is_torque).map(|first| [first, second])
        })
    }

    fn reject_wrong_units(&self, file: &str, shape: &LogShape) -> Result<(), DataError> {
        for (index, (name, role)) in self.columns.iter().enumerate() {
            let wrong = match role {
                Role::WrongUnit(joint) => Some(*joint),
                Role::Covariate => self.output_in_another_unit(index, shape),
                _ => None,
            };
            let Some((joint, device)) =
                wrong.and_then(|joint| Some((joint, shape.joints.get(joint)?)))
            else {
                continue;
            };
            let expected = if name.starts_with("theta") {
                Role::Joint(joint).name(shape)
            } else {
                Role::Output(joint).name(shape)
            };
            return Err(self.place(file, index).error(Fault::WrongUnit {
                joint: device.name.clone(),
                prismatic: device.prismatic,
                expected,
            }));
        }
        Ok(())
    }

    /// The joint of a column such as `out1_deg`, unless `out1_rad` is there as well.
    fn output_in_another_unit(&self, index: usize, shape: &LogShape) -> Option<usize> {
        let miss = near_miss(&self.columns[index].0, index + 1, shape)?;
        let (stem, joint, _) = indexed(&miss.wanted)?;
        (stem == "out" && miss.convert && !self.has(&miss.wanted)).then_some(joint)
    }

    fn require_joints(&self, file: &str, shape: &LogShape) -> Result<(), DataError> {
        let required: Vec<String> = (0..shape.joints.len())
            .map(|joint| Role::Joint(joint).name(shape))
            .collect();
        let missing: Vec<String> = required
            .iter()
            .filter(|name| !self.has(name))
            .cloned()
            .collect();
        let Some(first) = missing.first() else {
            return Ok(());
        };
        let mut at = Place::line(file, self.line);
        at.column = Some(first.clone());
        let near_misses = self.near_misses_of(&required, &missing, shape);
        Err(at.error(Fault::MissingColumn {
            missing,
            required,
            near_misses,
        }))
    }

    fn near_misses_of(
        &self,
        required: &[String],
        missing: &[String],
        shape: &LogShape,
    ) -> Vec<NearMiss> {
        let numbered = || self.columns.iter().enumerate();
        if self
            .columns
            .iter()
            .any(|(name, _)| name.starts_with("theta0_"))
        {
            // Counted from 0: every column is off by one.
            let shifted = required.iter().enumerate().filter_map(|(joint, wanted)| {
                let found = format!("theta{joint}_{}", shape.joints.get(joint)?.unit());
                let (index, _) = numbered().find(|(_, (name, _))| *name == found)?;
                let wanted = wanted.clone();
                Some(NearMiss {
                    found,
                    column_number: index + 1,
                    wanted,
                    convert: false,
                })
            });
            return shifted.collect();
        }
        numbered()
            .filter(|(_, (_, role))| *role == Role::Covariate)
            .filter_map(|(index, (name, _))| near_miss(name, index + 1, shape))
            .filter(|miss| missing.contains(&miss.wanted))
            .collect()
    }

    fn require_whole(&self, group: &[&str], file: &str) -> Result<(), DataError> {
        let (present, missing): (Vec<&str>, Vec<&str>) =
            group.iter().partition(|name| self.has(name));
        let first = self
            .columns
            .iter()
            .position(|(name, _)| present.contains(&name.as_str()));
        match first {
            Some(index) if !missing.is_empty() => {
                Err(self.place(file, index).error(Fault::IncompleteGroup {
                    present: present.into_iter().map(str::to_owned).collect(),
                    missing: missing.into_iter().map(str::to_owned).collect(),
                }))
            }
            _ => Ok(()),
        }
    }

    fn warn(&mut self, file: &str, shape: &LogShape) {
        for (index, (name, role)) in self.columns.iter().enumerate() {
            let what = match role {
                Role::Unnamed => "the column has no name; it is left out".to_owned(),
                Role::Covariate if is_beyond(name) => {
                    "the device file has no such joint or cable; kept as a covariate".to_owned()
                }
                Role::Covariate => match near_miss(name, index + 1, shape) {
                    Some(miss) if !self.has(&miss.wanted) => format!(
                        "kept as a covariate; if it is meant as `{}`, {}",
                        miss.wanted,
                        miss.advice()
                    ),
                    _ => continue,
                },
                _ => continue,
            };
            self.warnings
                .push(format!("{}: {what}", self.place(file, index)));
        }
    }
}

/// Whether a name that is no column of this device would be one of a larger device.
fn is_beyond(name: &str) -> bool {
    crate::column::cable_index(name).is_some()
        || matches!(
            indexed(name),
            Some(("theta" | "out", _, "rad" | "m") | ("torque", _, "nm" | "n"))
        )
}
