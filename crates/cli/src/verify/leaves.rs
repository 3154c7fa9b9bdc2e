//! The values of a JSON, TOML or CSV text, each with its place in words.

use serde_json::Value;
use toml_edit::{DocumentMut, Item, Table, Value as TomlValue};

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Leaf {
    Number(f64),
    Text(String),
}

/// Places and values in the order of the text.
pub(super) type Leaves = Vec<(String, Leaf)>;

impl std::fmt::Display for Leaf {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            // The shortest digits that give the number back.
            Self::Number(number) => write!(formatter, "{number:?}"),
            Self::Text(text) => write!(formatter, "{text:?}"),
        }
    }
}

impl Leaf {
    /// What is no number that can be compared is a text.
    fn number(number: f64) -> Self {
        if number.is_finite() {
            Self::Number(number)
        } else {
            Self::Text(number.to_string())
        }
    }
}

/// The values of a file by the ending of its name; an error says why it has none.
pub(super) fn leaves(name: &str, bytes: &[u8]) -> Result<Leaves, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "not a text in UTF-8".to_owned())?;
    let mut leaves = Vec::new();
    if name.ends_with(".json") {
        let value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        push_json(&mut leaves, String::new(), &value);
    } else if name.ends_with(".toml") {
        // It refuses what would take the other reader too deep.
        haptical_model::check_toml_syntax(text, name).map_err(|error| error.to_string())?;
        let document: DocumentMut = text.parse().map_err(|_| "not TOML".to_owned())?;
        push_table(&mut leaves, "", document.as_table());
    } else {
        push_csv(&mut leaves, text)?;
    }
    Ok(leaves)
}

fn below(place: &str, key: &str) -> String {
    if place.is_empty() {
        key.to_owned()
    } else {
        format!("{place}.{key}")
    }
}

fn push_json(leaves: &mut Leaves, place: String, value: &Value) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                push_json(leaves, below(&place, key), value);
            }
        }
        Value::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                push_json(leaves, format!("{place}[{index}]"), value);
            }
        }
        Value::String(text) => leaves.push((place, Leaf::Text(text.clone()))),
        other => leaves.push((
            place,
            other
                .as_f64()
                .map_or_else(|| Leaf::Text(other.to_string()), Leaf::Number),
        )),
    }
}

fn push_table(leaves: &mut Leaves, place: &str, table: &Table) {
    for (key, item) in table {
        let place = below(place, key);
        match item {
            Item::None => {}
            Item::Value(value) => push_value(leaves, place, value),
            Item::Table(table) => push_table(leaves, &place, table),
            Item::ArrayOfTables(tables) => {
                for (index, table) in tables.iter().enumerate() {
                    push_table(leaves, &format!("{place}[{index}]"), table);
                }
            }
        }
    }
}

fn push_value(leaves: &mut Leaves, place: String, value: &TomlValue) {
    match value {
        TomlValue::Float(number) => leaves.push((place, Leaf::number(*number.value()))),
        TomlValue::Integer(number) => {
            leaves.push((place, Leaf::Number(*number.value() as f64)));
        }
        TomlValue::String(text) => leaves.push((place, Leaf::Text(text.value().clone()))),
        TomlValue::Boolean(truth) => leaves.push((place, Leaf::Text(truth.value().to_string()))),
        TomlValue::Datetime(time) => leaves.push((place, Leaf::Text(time.value().to_string()))),
        TomlValue::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                push_value(leaves, format!("{place}[{index}]"), value);
            }
        }
        TomlValue::InlineTable(table) => {
            for (key, value) in table {
                push_value(leaves, below(&place, key), value);
            }
        }
    }
}

fn push_csv(leaves: &mut Leaves, text: &str) -> Result<(), String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(text.as_bytes());
    let mut header = csv::StringRecord::new();
    for (index, record) in reader.records().enumerate() {
        let record = record.map_err(|error| error.to_string())?;
        if index == 0 {
            header = record.clone();
        }
        for (column, cell) in record.iter().enumerate() {
            let name = header.get(column).unwrap_or("beyond the header");
            let leaf = cell
                .parse()
                .map_or_else(|_| Leaf::Text(cell.to_owned()), Leaf::number);
            leaves.push((format!("line {}, {name}", index + 1), leaf));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(name: &str, text: &str) -> Vec<String> {
        let leaves = leaves(name, text.as_bytes()).unwrap();
        let show = |(place, leaf): &(String, Leaf)| format!("{place} = {leaf}");
        leaves.iter().map(show).collect()
    }

    #[test]
    fn every_value_has_its_place() {
        let json = r#"{"a": [1, {"b": 2.5e-9}], "c": null, "d": "x"}"#;
        let wanted = ["a[0] = 1.0", "a[1].b = 2.5e-9", "c = \"null\"", "d = \"x\""];
        assert_eq!(listed("x.json", json), wanted);
        let toml =
            "a = [1, 0.5]\n[[link]]\nb = { c = true }\n[[link]]\nd = \"x\"\n[e.f]\ng = 1e-9\n";
        let wanted = [
            "a[0] = 1.0",
            "a[1] = 0.5",
            "link[0].b.c = \"true\"",
            "link[1].d = \"x\"",
            "e.f.g = 1e-9",
        ];
        assert_eq!(listed("x.toml", toml), wanted);
        let csv = "row,channel\n7,out2\n";
        let wanted = [
            "line 1, row = \"row\"",
            "line 1, channel = \"channel\"",
            "line 2, row = 7.0",
            "line 2, channel = \"out2\"",
        ];
        assert_eq!(listed("x.csv", csv), wanted);
    }

    #[test]
    fn what_is_no_text_of_its_kind_says_so() {
        for (name, text) in [("x.json", "{"), ("x.toml", "a = ="), ("x.csv", "a,b\n1\n")] {
            assert!(leaves(name, text.as_bytes()).is_err(), "{name}");
        }
    }
}
