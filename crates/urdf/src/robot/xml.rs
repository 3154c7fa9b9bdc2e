//! An XML document with its name: elements, attributes, checked numbers, and complaints with line and column.

use haptical_model::Position;
use roxmltree::{Document, Node, ParsingOptions, TextPos};

use crate::UrdfError;
use crate::numbers::{ONE_NUMBER, THREE_NUMBERS, number, three};
use crate::robot::limits::too_many;
use crate::robot::places::place_of;

pub(crate) type Result<T> = std::result::Result<T, UrdfError>;

/// Most nodes of a document: a humanoid with its meshes and materials has some ten thousand.
const MOST_NODES: u32 = 1_000_000;
/// Most links, and most joints.
const MOST_PARTS: usize = 4096;

/// A document and its name, for positions.
#[derive(Clone, Copy)]
pub(crate) struct Reader<'d, 'input> {
    pub(crate) document: &'d Document<'input>,
    pub(crate) file: &'d str,
}

pub(crate) type Element<'d, 'input> = Node<'d, 'input>;

/// The elements of a text; `file` names it in errors.
pub(crate) fn document<'input>(text: &'input str, file: &str) -> Result<Document<'input>> {
    if let Some((byte, message)) = too_many(text) {
        return Err(UrdfError::Xml {
            at: place_of(text, file, byte),
            message,
        });
    }
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| UrdfError::Xml {
        at: position(file, error.pos()),
        message: error.to_string(),
    })
}

fn position(file: &str, at: TextPos) -> Box<Position> {
    Box::new(Position {
        file: file.to_owned(),
        line: at.row as usize,
        column: at.col as usize,
    })
}

impl Reader<'_, '_> {
    pub(crate) fn position_at(&self, byte: usize) -> Box<Position> {
        place_of(self.document.input_text(), self.file, byte)
    }

    pub(crate) fn tree(&self, byte: usize, message: String) -> UrdfError {
        let at = self.position_at(byte);
        UrdfError::Tree { at, message }
    }

    pub(crate) fn count(&self, what: &str, found: usize, place: usize) -> Result<()> {
        if found <= MOST_PARTS {
            return Ok(());
        }
        let message = format!("more than {MOST_PARTS} {what}, the most that are read");
        Err(self.tree(place, message))
    }

    pub(crate) fn name(&self, element: Element<'_, '_>) -> Result<String> {
        let kind = element.tag_name().name();
        let name = self.required(element, &format!("a <{kind}>"), "name")?;
        Ok(name.to_owned())
    }

    pub(crate) fn required<'n>(
        &self,
        element: Element<'n, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<&'n str> {
        let value = element.attribute(key);
        value.ok_or_else(|| self.missing(element, place, key))
    }

    pub(crate) fn missing(
        &self,
        element: Element<'_, '_>,
        place: &str,
        what: &'static str,
    ) -> UrdfError {
        UrdfError::Missing {
            at: self.position_at(element.range().start),
            place: place.to_owned(),
            what,
        }
    }

    pub(crate) fn refuse(
        &self,
        element: Element<'_, '_>,
        place: &str,
        what: &'static str,
        found: &str,
        allowed: &str,
    ) -> UrdfError {
        let allowed = if found.contains("${") {
            "this is xacro: expand it first (`xacro file.xacro > file.urdf`)"
        } else {
            allowed
        };
        UrdfError::Value {
            at: self.position_at(element.range().start),
            place: place.to_owned(),
            what,
            // whoever wrote a megabyte need not read it again
            found: found.chars().take(60).collect(),
            allowed: allowed.to_owned(),
        }
    }

    pub(crate) fn not_negative_mass(
        &self,
        element: Element<'_, '_>,
        place: &str,
        mass_kg: f64,
    ) -> Result<()> {
        if mass_kg >= 0.0 {
            return Ok(());
        }
        let found = mass_kg.to_string();
        let allowed = "a mass is not negative";
        Err(self.refuse(element, place, "the mass", &found, allowed))
    }

    pub(crate) fn one(
        &self,
        element: Element<'_, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<f64>> {
        let Some(text) = element.attribute(key) else {
            return Ok(None);
        };
        let refuse = || self.refuse(element, place, key, &format!("\"{text}\""), ONE_NUMBER);
        number(text).map(Some).ok_or_else(refuse)
    }

    pub(crate) fn vector(
        &self,
        element: Element<'_, '_>,
        place: &str,
        key: &'static str,
    ) -> Result<Option<[f64; 3]>> {
        let Some(text) = element.attribute(key) else {
            return Ok(None);
        };
        let refuse = || self.refuse(element, place, key, &format!("\"{text}\""), THREE_NUMBERS);
        three(text).map(Some).ok_or_else(refuse)
    }
}

/// Child elements of one name.
pub(crate) fn elements<'d, 'input>(
    node: Node<'d, 'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'input>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}
