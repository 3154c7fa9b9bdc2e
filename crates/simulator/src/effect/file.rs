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
        .map_err(|error: toml::de::Error| EffectError::new(file, error.to_string().trim_end()))?;
    let wrong_key = |key: &str| {
        let what = format!("`{key}` is not known; write each effect as a table [[effect]]");
        EffectError::new(file, what)
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
    let names = all.join(", ");
    let refuse = |what: String| EffectError::new(format!("{file}, effect {number}"), what);
    let Some(Value::String(name)) = effect.get(NAME) else {
        let what = format!("`name` is missing; the names are: {names}");
        return Err(refuse(what));
    };
    let Some(known) = known(name) else {
        let nearest = did_you_mean(name, &all);
        let what = format!("`{name}` cannot be simulated; {nearest}the names are: {names}");
        return Err(refuse(what));
    };
    let parameters = known.keys.join(", ");
    let refuse = |what: String| {
        let place = format!("{file}, effect {number} (`{name}`)");
        EffectError::new(place, format!("{what}its parameters are: {parameters}"))
    };
    let mut keys = effect.keys();
    if let Some(wrong) = keys.find(|key| *key != NAME && !known.keys.contains(&key.as_str())) {
        let nearest = did_you_mean(wrong, known.keys);
        return Err(refuse(format!("no parameter `{wrong}`; {nearest}")));
    }
    // 260 is as good a number as 260.0
    let mut numbers = effect.clone();
    for (key, value) in &mut numbers {
        if let (Value::Integer(whole), true) = (&value, key != "joint") {
            *value = Value::Float(*whole as f64);
        }
    }
    Effect::deserialize(Value::Table(numbers)).map_err(|error| {
        let what = error.to_string().trim_end().replace('\n', " ");
        refuse(format!("{what}; "))
    })
}
