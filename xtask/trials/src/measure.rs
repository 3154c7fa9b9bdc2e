//! A figure, its interval, and the bar that it has to meet.

use haptical_metrics::Bootstrap;
use serde::Serialize;
use xtask_blind::Rate;

/// Resamples of an interval of a figure that is no share.
const REPLICATES: usize = 2000;

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Bar {
    AtMost(f64),
    AtLeast(f64),
    Between(f64, f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Value {
    /// A share of cases, with Wilson's interval.
    Share(Rate),
    /// Anything else, with a bootstrap interval.
    Number(Number),
}

/// A figure that is no share.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub(crate) struct Number {
    pub(crate) value: Option<f64>,
    /// 95 % interval.
    pub(crate) ci95: Option<[f64; 2]>,
    /// Cases that it rests on.
    pub(crate) of: u64,
    /// Decimals worth reading.
    pub(crate) decimals: usize,
    /// Unit, empty for none.
    pub(crate) unit: &'static str,
}

/// A figure under its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Measure {
    /// Heading of the report that it belongs to.
    pub(crate) group: &'static str,
    pub(crate) name: String,
    pub(crate) value: Value,
    pub(crate) bar: Option<Bar>,
    /// Absent without a bar or without a case.
    pub(crate) met: Option<bool>,
}

impl Bar {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
            Self::Between(low, high) => (low..=high).contains(&value),
        }
    }

    /// `at least 90 %`.
    pub(crate) fn words(self, value: &Value) -> String {
        let text = |limit: f64| match value {
            Value::Share(_) => format!("{} %", round(100.0 * limit)),
            Value::Number(number) => with_unit(&round(limit), number.unit),
        };
        match self {
            Self::AtMost(limit) => format!("at most {}", text(limit)),
            Self::AtLeast(limit) => format!("at least {}", text(limit)),
            Self::Between(low, high) => {
                let low = text(low);
                let low = low.split(' ').next().unwrap_or(&low);
                format!("{low} to {}", text(high))
            }
        }
    }
}

/// Up to two decimals, without zeros at the end.
fn round(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn with_unit(text: &str, unit: &str) -> String {
    if unit.is_empty() {
        text.to_owned()
    } else {
        format!("{text} {unit}")
    }
}

impl Value {
    pub(crate) fn value(&self) -> Option<f64> {
        match self {
            Self::Share(rate) => rate.share,
            Self::Number(number) => number.value,
        }
    }

    /// The figure: `97.3 % (292 of 300)`.
    pub(crate) fn words(&self) -> String {
        let words = match self {
            Self::Share(rate) => rate
                .share
                .map(|share| format!("{:.1} % ({} of {})", 100.0 * share, rate.count, rate.of)),
            Self::Number(number) => number.value.map(|value| {
                let text = format!("{value:.*}", number.decimals);
                format!("{} (of {})", with_unit(&text, number.unit), number.of)
            }),
        };
        words.unwrap_or_else(|| "no case".to_owned())
    }

    /// The interval: `94.8 to 98.6 %`.
    pub(crate) fn interval(&self) -> String {
        let (ends, decimals, unit) = match self {
            Self::Share(rate) => (rate.ci95.map(|ends| ends.map(|end| 100.0 * end)), 1, "%"),
            Self::Number(number) => (number.ci95, number.decimals, number.unit),
        };
        ends.map_or_else(String::new, |[low, high]| {
            with_unit(&format!("{low:.decimals$} to {high:.decimals$}"), unit)
        })
    }
}

/// Figures under one heading.
#[derive(Debug)]
pub(crate) struct Group {
    heading: &'static str,
    pub(crate) measures: Vec<Measure>,
}

impl Group {
    pub(crate) fn new(heading: &'static str) -> Self {
        let measures = Vec::new();
        Self { heading, measures }
    }

    pub(crate) fn add(
        &mut self,
        name: impl Into<String>,
        value: Value,
        bar: impl Into<Option<Bar>>,
    ) {
        let measure = Measure::new(self.heading, name, value, bar.into());
        self.measures.push(measure);
    }
}

/// Figures of a heading, or added to a group, a row each: name, value, bar or none.
macro_rules! figures {
    ($heading:literal: $($name:expr, $value:expr, $bar:expr;)+) => {{
        let mut group = Group::new($heading);
        $(group.add($name, $value, $bar);)+
        group.measures
    }};
    ($group:ident: $($name:expr, $value:expr, $bar:expr;)+) => {
        $($group.add($name, $value, $bar);)+
    };
}
pub(crate) use figures;

impl Measure {
    pub(crate) fn new(
        group: &'static str,
        name: impl Into<String>,
        value: Value,
        bar: Option<Bar>,
    ) -> Self {
        let met = bar.zip(value.value()).map(|(bar, value)| bar.holds(value));
        Self {
            group,
            name: name.into(),
            value,
            bar,
            met,
        }
    }

    /// `met`, `falls short`, or nothing to say.
    pub(crate) fn verdict(&self) -> &'static str {
        match (self.met, self.bar) {
            (Some(true), _) => "met",
            (Some(false), _) => "falls short",
            (None, Some(_)) => "not measured",
            (None, None) => "",
        }
    }
}

/// A statistic of `cases` with its 95 % interval by 2000 resamples of them.
pub(crate) fn number<T>(
    cases: &[T],
    decimals: usize,
    unit: &'static str,
    statistic: impl Fn(&[&T]) -> Option<f64>,
) -> Value {
    let all: Vec<&T> = cases.iter().collect();
    let bootstrap = Bootstrap {
        replicates: REPLICATES,
        seed: 1,
        level: 0.95,
        block_length: 1,
    };
    let interval = bootstrap.interval(cases.len(), |rows| {
        let drawn: Vec<&T> = rows.iter().map(|&row| &cases[row]).collect();
        statistic(&drawn)
    });
    Value::Number(Number {
        value: statistic(&all),
        ci95: interval.ok().map(|interval| [interval.low, interval.high]),
        of: cases.len() as u64,
        decimals,
        unit,
    })
}

/// Mean; none without values.
pub(crate) fn mean(values: &[&f64]) -> Option<f64> {
    let sum: f64 = values.iter().copied().sum();
    (!values.is_empty()).then(|| sum / values.len() as f64)
}

/// Quantile of type 7; none without values.
pub(crate) fn quantile(values: &[&f64], at: f64) -> Option<f64> {
    let owned: Vec<f64> = values.iter().map(|value| **value).collect();
    haptical_metrics::quantile(&owned, at).ok()
}
