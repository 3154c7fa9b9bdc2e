//! Four questions before any verdict: may there be one?

use serde::Serialize;

/// Whether a question is answered with yes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answered {
    /// It is.
    Yes,
    /// Nothing of the log says so.
    #[default]
    Unknown,
    /// It is not.
    No,
}

impl Answered {
    /// In a word.
    pub fn words(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Unknown => "unknown",
            Self::No => "no",
        }
    }
}

/// A question's answer, with what it rests on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// The answer.
    pub answer: Answered,
    /// What it rests on, with its figures.
    pub why: String,
    /// What to do where the answer is no.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
}

impl Default for Check {
    /// Nobody asked.
    fn default() -> Self {
        Self::unknown("not asked of such a log")
    }
}

impl Check {
    /// A yes.
    pub fn yes(why: impl Into<String>) -> Self {
        Self::new(Answered::Yes, why)
    }

    /// Neither.
    pub fn unknown(why: impl Into<String>) -> Self {
        Self::new(Answered::Unknown, why)
    }

    /// A no, with what mends it.
    pub fn no(why: impl Into<String>, next: impl Into<String>) -> Self {
        Self {
            next: Some(next.into()),
            ..Self::new(Answered::No, why)
        }
    }

    fn new(answer: Answered, why: impl Into<String>) -> Self {
        Self {
            answer,
            why: why.into(),
            next: None,
        }
    }

    /// The worse of two answers; the first of equal ones.
    fn or_worse(self, other: Self) -> Self {
        match other.answer > self.answer {
            true => other,
            false => self,
        }
    }
}

/// What is asked of every log and every view of it before it gets a verdict.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Admission {
    /// Whether log and device belong together.
    pub belongs: Check,
    /// Whether the base model's numbers are some that a device can have.
    pub credible_base: Check,
    /// Whether something else than what the model leaves says how large the noise is.
    pub known_noise: Check,
    /// Whether rows, their rate and the motion suffice.
    pub enough: Check,
}

impl Admission {
    fn all(&self) -> [&Check; 4] {
        [
            &self.belongs,
            &self.credible_base,
            &self.known_noise,
            &self.enough,
        ]
    }

    /// The first question that is answered with no: nothing gets a name then, nor "no gap".
    ///
    /// ```
    /// use haptical_judge::{Admission, Check};
    /// let admission = Admission {
    ///     enough: Check::no("2 s of a log", "record 10 s"),
    ///     ..Admission::default()
    /// };
    /// assert_eq!(admission.refusal().map(|check| check.why.as_str()), Some("2 s of a log"));
    /// ```
    pub fn refusal(&self) -> Option<&Check> {
        let mut all = self.all().into_iter();
        all.find(|check| check.answer == Answered::No)
    }

    /// Of two views of a log, question by question the worse answer.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            belongs: self.belongs.or_worse(other.belongs),
            credible_base: self.credible_base.or_worse(other.credible_base),
            known_noise: self.known_noise.or_worse(other.known_noise),
            enough: self.enough.or_worse(other.enough),
        }
    }
}
