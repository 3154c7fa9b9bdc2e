//! Several recordings of one device as one, with a break between them.

use crate::Recording;

/// Why recordings cannot be joined.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotJoined {
    /// One recording has a column that another lacks.
    #[error("recording {without} has no {column}, which recording {with} has")]
    Column {
        /// What is missing: `out2`, `cable`, `torque1`, `position`, the header of another column.
        column: String,
        /// The recording that has it, from 0.
        with: usize,
        /// The one that lacks it, from 0.
        without: usize,
    },
    /// They are not of the same number of joints.
    #[error("recording {index} has {found} joints, the first one has {expected}")]
    Joints {
        /// The recording, from 0.
        index: usize,
        /// Its joints.
        found: usize,
        /// Those of the first one.
        expected: usize,
    },
}

impl Recording {
    /// The rows of several recordings, one after the other, each with runs of its own: nothing with a memory (a play, a
    /// friction loop, coloured noise) and no derivative in time reaches across the break. A tracker that is set up anew
    /// for each run has a place of its own in each recording.
    ///
    /// Runs are numbered through; those of the first recording keep their numbers. What effects of a device add
    /// ([`Recording::added`]) is left out, since it has to be worked out on the whole.
    ///
    /// ```
    /// use haptical_model::Recording;
    /// let rows = |angles: Vec<f64>| Recording {
    ///     line: (2..).take(angles.len()).collect(),
    ///     output: vec![None],
    ///     torque_nm: vec![None],
    ///     joint: vec![angles],
    ///     ..Recording::default()
    /// };
    /// let both = Recording::joined(&[&rows(vec![0.0, 0.1]), &rows(vec![0.5])])?;
    /// assert_eq!((both.joint[0].clone(), both.run), (vec![0.0, 0.1, 0.5], Some(vec![0, 0, 1])));
    /// # Ok::<(), haptical_model::NotJoined>(())
    /// ```
    ///
    /// # Errors
    /// [`NotJoined`] where one has columns that another lacks: a channel that is there in one recording alone would
    /// leave it open what the other one says of it.
    pub fn joined(recordings: &[&Self]) -> Result<Self, NotJoined> {
        let Some((&first, others)) = recordings.split_first() else {
            return Ok(Self::default());
        };
        let names = first.columns();
        for (index, other) in (1..).zip(others) {
            if other.joint.len() != first.joint.len() {
                return Err(NotJoined::Joints {
                    index,
                    found: other.joint.len(),
                    expected: first.joint.len(),
                });
            }
            let own = other.columns();
            let lacks = |have: &[String], want: &[String]| {
                have.iter().find(|name| !want.contains(name)).cloned()
            };
            let missing = |column, with, without| NotJoined::Column {
                column,
                with,
                without,
            };
            if let Some(column) = lacks(&names, &own) {
                return Err(missing(column, 0, index));
            }
            if let Some(column) = lacks(&own, &names) {
                return Err(missing(column, index, 0));
            }
        }
        let mut whole = Self {
            added: Vec::new(),
            ..first.clone()
        };
        if !others.is_empty() && whole.run.is_none() {
            whole.run = Some(vec![0; first.len()]);
        }
        for other in others {
            whole.append(other);
        }
        Ok(whole)
    }

    /// Names of the columns that there are, joints, lines and runs left out.
    fn columns(&self) -> Vec<String> {
        let numbered = |name: &str, columns: &[Option<Vec<f64>>]| -> Vec<String> {
            let there = columns
                .iter()
                .zip(1..)
                .filter(|(column, _)| column.is_some());
            there.map(|(_, number)| format!("{name}{number}")).collect()
        };
        let mut names = numbered("out", &self.output);
        names.extend(numbered("cable", &self.cable_m));
        names.extend(numbered("torque", &self.torque_nm));
        let single = [
            ("time", self.time_s.is_some()),
            ("position", self.position_m.is_some()),
            ("orientation", self.orientation_wxyz.is_some()),
            ("force", self.force_n.is_some()),
            ("temperature", self.temperature_degc.is_some()),
            ("hand", self.hand.is_some()),
            ("contact", self.contact.is_some()),
            ("plane", self.plane.is_some()),
            ("tool", self.tool.is_some()),
        ];
        let there = single.into_iter().filter(|(_, there)| *there);
        names.extend(there.map(|(name, _)| name.to_owned()));
        names.extend(self.covariates.iter().map(|(name, _)| name.clone()));
        names
    }

    /// Adds the rows of a recording with the same columns, in runs of their own.
    fn append(&mut self, other: &Self) {
        let last = self.run.iter().flatten().copied().max().unwrap_or(-1);
        let lowest = other.run.iter().flatten().copied().min().unwrap_or(0);
        let numbers = (0..other.len()).map(|row| other.run_at(row) - lowest + last + 1);
        self.run.get_or_insert_default().extend(numbers);
        self.line.extend_from_slice(&other.line);
        extend(&mut self.time_s, &other.time_s);
        for (own, column) in self.joint.iter_mut().zip(&other.joint) {
            own.extend_from_slice(column);
        }
        for (columns, more) in [
            (&mut self.output, &other.output),
            (&mut self.cable_m, &other.cable_m),
            (&mut self.torque_nm, &other.torque_nm),
        ] {
            for (own, column) in columns.iter_mut().zip(more) {
                extend(own, column);
            }
        }
        extend_axes(&mut self.position_m, &other.position_m);
        extend_axes(&mut self.orientation_wxyz, &other.orientation_wxyz);
        extend_axes(&mut self.force_n, &other.force_n);
        extend(&mut self.temperature_degc, &other.temperature_degc);
        extend(&mut self.hand, &other.hand);
        extend(&mut self.contact, &other.contact);
        extend(&mut self.plane, &other.plane);
        extend(&mut self.tool, &other.tool);
        for (name, column) in &mut self.covariates {
            let mut more = other.covariates.iter();
            if let Some((_, rows)) = more.find(|(own, _)| own == name) {
                column.extend_from_slice(rows);
            }
        }
    }
}

fn extend<T: Clone>(column: &mut Option<Vec<T>>, more: &Option<Vec<T>>) {
    if let (Some(column), Some(more)) = (column, more) {
        column.extend_from_slice(more);
    }
}

fn extend_axes<const N: usize>(axes: &mut Option<[Vec<f64>; N]>, more: &Option<[Vec<f64>; N]>) {
    if let (Some(axes), Some(more)) = (axes, more) {
        for (axis, rows) in axes.iter_mut().zip(more) {
            axis.extend_from_slice(rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: usize, run: Option<Vec<i64>>) -> Recording {
        let column = |from: f64| {
            (0..count)
                .map(|row| from + row as f64)
                .collect::<Vec<f64>>()
        };
        Recording {
            line: (2..).take(count).collect(),
            time_s: Some(column(0.0)),
            run,
            joint: vec![column(10.0)],
            output: vec![Some(column(20.0))],
            cable_m: vec![None],
            force_n: Some([column(1.0), column(2.0), column(3.0)]),
            torque_nm: vec![Some(column(30.0))],
            tool: Some(vec!["a".to_owned(); count]),
            covariates: vec![("load".to_owned(), column(40.0))],
            ..Recording::default()
        }
    }

    #[test]
    fn runs_are_numbered_through_and_every_column_keeps_its_rows() {
        let (first, second) = (rows(3, Some(vec![4, 4, 9])), rows(2, Some(vec![-1, 3])));
        let whole = Recording::joined(&[&first, &second, &rows(1, None)]).unwrap();
        assert_eq!(whole.run, Some(vec![4, 4, 9, 10, 14, 15]));
        // each part is what it was, but for the numbers of its runs
        for (part, from) in [(&first, 0), (&second, 3)] {
            let indices: Vec<usize> = (from..from + part.len()).collect();
            let own = Recording {
                run: part.run.clone(),
                ..whole.select(&indices)
            };
            assert_eq!(own, *part);
        }
        assert_eq!(Recording::joined(&[&first]).unwrap(), first);
    }

    #[test]
    fn a_column_of_one_recording_alone_is_named() {
        let (full, mut less) = (rows(2, None), rows(2, None));
        less.output[0] = None;
        let refused = |a: &Recording, b: &Recording| Recording::joined(&[a, b]).unwrap_err();
        let column = |column: &str, with, without| NotJoined::Column {
            column: column.to_owned(),
            with,
            without,
        };
        assert_eq!(refused(&full, &less), column("out1", 0, 1));
        assert_eq!(refused(&less, &full), column("out1", 1, 0));
        let mut other = rows(2, None);
        other.covariates[0].0 = "tension".to_owned();
        assert_eq!(refused(&full, &other), column("load", 0, 1));
    }
}
