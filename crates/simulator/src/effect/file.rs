//! Reads `effects.toml`.

use serde::Deserialize;
use toml::{Table, Value};

use crate::effect::Effect;
use crate::effect::error::EffectError;
use crate::effect::names::{did_you_mean, known, simulated_effects};

/// The key of the list of effects.
const EFFECT: &str = "effect";
/// The key of an effect's name.
const NAME: &str = "name";

/// The effects of a file, not yet checked.
pub(crate) fn parse(text: &str, file: &str) -> Result<Vec<Effect>, EffectError> {
    let table: Table = text
        .parse()
        .map_err(|error: toml::de::Error| EffectError::Syntax {
            file: file.to_owned(),
            what: error.to_string().trim_end().to_owned(),
        })?;
    let wrong_key = |key: &str| EffectError::Key {
        file: file.to_owned(),
        key: key.to_owned(),
    };
    if let Some(key) = table.keys().find(|key| *key != EFFECT) {
        return Err(wrong_key(key));
    }
    let effects = match table.get(EFFECT) {
        None => return Ok(Vec::new()),
        Some(Value::Array(effects)) => effects,
        Some(_) => return Err(wrong_key(EFFECT)),
    };
    effects
        .iter()
        .enumerate()
        .map(|(index, effect)| match effect {
            Value::Table(effect) => one(effect, file, index + 1),
            _ => Err(wrong_key(EFFECT)),
        })
        .collect()
}

fn one(effect: &Table, file: &str, number: usize) -> Result<Effect, EffectError> {
    let all = simulated_effects();
    let file = file.to_owned();
    let Some(Value::String(name)) = effect.get(NAME) else {
        return Err(EffectError::NoName {
            file,
            number,
            names: all.join(", "),
        });
    };
    let Some(known) = known(name) else {
        return Err(EffectError::Unknown {
            file,
            number,
            name: name.clone(),
            nearest: did_you_mean(name, &all),
            names: all.join(", "),
        });
    };
    let parameters = known.parameters.join(", ");
    let wrong = effect
        .keys()
        .find(|key| *key != NAME && !known.parameters.contains(&key.as_str()));
    if let Some(wrong) = wrong {
        return Err(EffectError::Parameter {
            file,
            number,
            name: known.name,
            parameter: wrong.clone(),
            nearest: did_you_mean(wrong, known.parameters),
            parameters,
        });
    }
    // 260 is as good a number as 260.0
    let mut numbers = effect.clone();
    for (key, value) in &mut numbers {
        if let (Value::Integer(whole), true) = (&value, key != "joint") {
            *value = Value::Float(*whole as f64);
        }
    }
    Effect::deserialize(Value::Table(numbers)).map_err(|error| EffectError::Shape {
        file,
        number,
        name: known.name,
        what: error.to_string().trim_end().replace('\n', " "),
        parameters,
    })
}
