//! What a comparison found, and the row of the table that a description gets.

/// What came of one comparison.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum State {
    /// Equal; the largest differences.
    Equal(Worst),
    /// Not equal or not compared, and haptical says why.
    Said(String),
    /// Haptical refused, with its words.
    Refused(String),
    /// A peer refused, with its words.
    PeerRefused(String),
    /// A difference that haptical does not name.
    Different(Worst, String),
}

/// Largest differences.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Worst {
    /// Of positions \[m\] and of entries of rotations.
    pub(crate) pose: Option<f64>,
    /// Of torques, as a share of the joint's largest.
    pub(crate) torque: Option<f64>,
}

impl Worst {
    /// The larger of each.
    fn or(self, other: Self) -> Self {
        let larger = |one: Option<f64>, other: Option<f64>| match (one, other) {
            (Some(one), Some(other)) => Some(one.max(other)),
            (one, other) => one.or(other),
        };
        Self {
            pose: larger(self.pose, other.pose),
            torque: larger(self.torque, other.torque),
        }
    }
}

/// Which text was compared with what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// The file as it is.
    Given,
    /// The file with a calibration in it.
    Corrected,
    /// A new URDF.
    NewUrdf,
    /// A new MJCF.
    NewMjcf,
}

impl Part {
    /// Its name in the table.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Given => "file",
            Self::Corrected => "corrected",
            Self::NewUrdf => "new URDF",
            Self::NewMjcf => "new MJCF",
        }
    }
}

/// One comparison.
#[derive(Debug, Clone)]
pub(crate) struct Finding {
    pub(crate) part: Part,
    /// With whom: a peer, or haptical itself.
    pub(crate) with: String,
    pub(crate) state: State,
}

/// A description, or one of its trees.
#[derive(Debug, Clone, Default)]
pub(crate) struct Row {
    /// Path in the folder, and the base where it is not the root.
    pub(crate) file: String,
    /// Joints of a log.
    pub(crate) joints: usize,
    pub(crate) findings: Vec<Finding>,
}

/// How a row ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verdict {
    /// Everything is equal.
    Equal,
    /// Haptical names what is not.
    Said,
    /// Haptical refused the file.
    Refused,
    /// No peer took the file.
    PeerRefused,
    /// A silent difference.
    Different,
}

impl Row {
    pub(crate) fn add(&mut self, finding: Finding) {
        let is_known = self.findings.iter().any(|own| {
            own.part == finding.part && own.with == finding.with && own.state == finding.state
        });
        if !is_known {
            self.findings.push(finding);
        }
    }

    /// What is worst, with its words.
    pub(crate) fn verdict(&self) -> (Verdict, String) {
        let words = |pick: fn(&State) -> Option<&String>| -> Vec<String> {
            let mut all: Vec<String> = Vec::new();
            for own in self.findings.iter().filter_map(|own| pick(&own.state)) {
                if !all.contains(own) {
                    all.push(own.clone());
                }
            }
            all
        };
        let different = words(|state| match state {
            State::Different(_, words) => Some(words),
            _ => None,
        });
        if !different.is_empty() {
            return (Verdict::Different, different.join("; "));
        }
        let given = |state: fn(&State) -> bool| {
            let mut own = self.findings.iter();
            own.any(|own| own.part == Part::Given && state(&own.state))
        };
        if let Some(own) = self.findings.iter().find(|own| own.part == Part::Given)
            && let State::Refused(words) = &own.state
        {
            return (Verdict::Refused, words.clone());
        }
        let refused = words(|state| match state {
            State::PeerRefused(words) => Some(words),
            _ => None,
        });
        if !given(|state| matches!(state, State::Equal(_) | State::Said(_))) {
            return (Verdict::PeerRefused, refused.join("; "));
        }
        let said = words(|state| match state {
            State::Said(words) | State::Refused(words) => Some(words),
            _ => None,
        });
        match said.is_empty() {
            true => (Verdict::Equal, String::new()),
            false => (Verdict::Said, said.join("; ")),
        }
    }

    /// Whether the file is equal to a peer in all that was compared, whatever its exports are.
    pub(crate) fn is_equal_as_it_is(&self) -> bool {
        let given = || self.findings.iter().filter(|own| own.part == Part::Given);
        given().any(|own| matches!(own.state, State::Equal(_)))
            && given().all(|own| matches!(own.state, State::Equal(_) | State::PeerRefused(_)))
    }

    /// Largest differences of all that was compared.
    pub(crate) fn worst(&self) -> Worst {
        let worst = self.findings.iter().filter_map(|own| match &own.state {
            State::Equal(worst) | State::Different(worst, _) => Some(*worst),
            _ => None,
        });
        worst.fold(Worst::default(), Worst::or)
    }
}
