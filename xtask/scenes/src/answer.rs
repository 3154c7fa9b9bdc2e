//! The whole answer of a scene as one JSON value.

use anyhow::Result;
use haptical::{Device, Diagnose, Log, diagnose, identify, identify_dynamics};
use serde_json::{Map, Number, Value, json};

use crate::scene::{Identified, Made};

/// Digits of a recorded number: finer than every tolerance.
const DIGITS: usize = 12;
/// What says how a file came about, not what was found.
const OF_FILES: [&str; 4] = ["arguments", "inputs", "outputs", "haptical_version"];

impl Made {
    /// Identifies and diagnoses; a refusal is an answer.
    pub(crate) fn answer(&self) -> Result<Value> {
        let device = self.device.open()?;
        let log = self.log.log("log.csv", &device)?;
        let second = self.validate.as_ref();
        let second = second.map(|own| own.log("second.csv", &device));
        let second = second.transpose()?;
        let mut answer = Map::new();
        if let Some(found) = self.identified(&device, &log, second.as_ref())? {
            answer.insert("identify".to_owned(), found);
        }
        let gap = self.diagnosed(&device, &log, second.as_ref())?;
        answer.insert("diagnose".to_owned(), gap);
        Ok(trimmed(Value::Object(answer)))
    }

    fn identified(
        &self,
        device: &Device,
        log: &Log,
        second: Option<&Log>,
    ) -> Result<Option<Value>> {
        let found = match &self.identify {
            Identified::Nothing => return Ok(None),
            Identified::Geometry(ask) => {
                identify(device, log, ask).map(|found| serde_json::to_value(&found.result))
            }
            Identified::Dynamics => identify_dynamics(device, log, second, None)
                .map(|found| serde_json::to_value(&found.result)),
        };
        Ok(Some(found.unwrap_or_else(|error| Ok(refused(&error)))?))
    }

    /// gap.json, and corrected.toml as `corrected`.
    pub(crate) fn diagnosed(
        &self,
        device: &Device,
        log: &Log,
        second: Option<&Log>,
    ) -> Result<Value> {
        let model = self.model.as_ref();
        let model = model.map(|text| Device::from_toml(text, "model.toml"));
        let model = model.transpose()?;
        let also = self.also.as_ref().map(|own| own.log("also.csv", device));
        let also = also.transpose()?;
        let ask = Diagnose {
            model: model.as_ref(),
            also: also.iter().collect(),
            validate: second,
            without: self.without.iter().map(|name| (*name).to_owned()).collect(),
            joint_compliance: self.joint_compliance,
            ..Diagnose::default()
        };
        let gap = match diagnose(device, log, &ask) {
            Ok(gap) => gap,
            Err(error) => return Ok(refused(&error)),
        };
        let mut value = serde_json::to_value(&gap)?;
        if let (Value::Object(value), Some(text)) = (&mut value, gap.corrected_toml()) {
            let corrected: toml::Table = toml::from_str(text)?;
            value.insert("corrected".to_owned(), serde_json::to_value(corrected)?);
        }
        Ok(value)
    }
}

fn refused(error: &haptical::Error) -> Value {
    json!({"refused": error.name(), "words": error.to_string()})
}

/// Without what says how a file came about, numbers with as many digits as are compared.
pub(crate) fn trimmed(value: Value) -> Value {
    match value {
        Value::Object(fields) => {
            let fields = fields.into_iter();
            // the thresholds of gap.json are a version, and those of identified.json the numbers themselves
            let is_version = |key: &str, own: &Value| key == "thresholds" && own.is_string();
            let kept = fields
                .filter(|(key, own)| !OF_FILES.contains(&key.as_str()) && !is_version(key, own));
            Value::Object(kept.map(|(key, own)| (key, trimmed(own))).collect())
        }
        Value::Array(items) => Value::Array(items.into_iter().map(trimmed).collect()),
        Value::Number(number) => Value::Number(rounded(number)),
        other => other,
    }
}

fn rounded(number: Number) -> Number {
    let decimals = DIGITS - 1;
    let short = number.as_f64().filter(|_| number.is_f64());
    let short = short.and_then(|own| format!("{own:.decimals$e}").parse().ok());
    short.and_then(Number::from_f64).unwrap_or(number)
}
