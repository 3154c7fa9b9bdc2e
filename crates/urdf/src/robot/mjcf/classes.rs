//! Default classes of an MJCF: what an element has where it does not say so itself.

use std::collections::BTreeMap;

use crate::robot::xml::{Element, Reader, Result, elements};

/// Name of the outermost class where the file gives it none.
const MAIN: &str = "main";
/// Most classes, and most of them one inside another.
const MOST_CLASSES: usize = 1024;

/// A class: its own defaults by element and attribute, and the class that it refines.
#[derive(Debug)]
struct Class<'d> {
    parent: Option<usize>,
    defaults: BTreeMap<(&'d str, &'d str), &'d str>,
}

/// All classes.
#[derive(Debug, Default)]
pub(crate) struct Classes<'d> {
    classes: Vec<Class<'d>>,
    by_name: BTreeMap<&'d str, usize>,
}

/// A class of a document; the outermost one where nothing is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ClassId(usize);

impl<'d> Classes<'d> {
    pub(crate) const OUTERMOST: ClassId = ClassId(0);

    /// Reads every `<default>`.
    pub(crate) fn read(reader: &Reader<'d, '_>) -> Result<Self> {
        let mut classes = Self::default();
        classes.classes.push(Class {
            parent: None,
            defaults: BTreeMap::new(),
        });
        classes.by_name.insert(MAIN, 0);
        let root = reader.document.root_element();
        let mut open: Vec<(Element<'d, '_>, Option<usize>)> =
            elements(root, "default").map(|node| (node, None)).collect();
        open.reverse();
        while let Some((node, parent)) = open.pop() {
            let own = classes.open(reader, node, parent)?;
            for child in node.children().filter(Element::is_element) {
                let tag = child.tag_name().name();
                if tag == "default" {
                    continue;
                }
                for attribute in child.attributes() {
                    let defaults = &mut classes.classes[own].defaults;
                    defaults.insert((tag, attribute.name()), attribute.value());
                }
            }
            let nested: Vec<_> = elements(node, "default").collect();
            open.extend(nested.into_iter().rev().map(|child| (child, Some(own))));
        }
        Ok(classes)
    }

    fn open(
        &mut self,
        reader: &Reader<'d, '_>,
        node: Element<'d, '_>,
        parent: Option<usize>,
    ) -> Result<usize> {
        let name = node.attribute("class");
        let Some(parent) = parent else {
            // the outermost one may be written in parts, and be called otherwise
            if let Some(name) = name {
                self.by_name.insert(name, 0);
            }
            return Ok(0);
        };
        let name = name.ok_or_else(|| reader.missing(node, "a <default>", "class"))?;
        if self.classes.len() > MOST_CLASSES {
            let message =
                format!("more than {MOST_CLASSES} default classes, the most that are read");
            return Err(reader.tree(node.range().start, message));
        }
        if self.by_name.contains_key(name) {
            let message = format!("there are two default classes `{name}`: rename one");
            return Err(reader.tree(node.range().start, message));
        }
        let own = self.classes.len();
        self.classes.push(Class {
            parent: Some(parent),
            defaults: BTreeMap::new(),
        });
        self.by_name.insert(name, own);
        Ok(own)
    }

    /// The class that an attribute of an element names, or the one around it.
    pub(crate) fn named(
        &self,
        reader: &Reader<'_, '_>,
        node: Element<'_, '_>,
        key: &'static str,
        around: ClassId,
    ) -> Result<ClassId> {
        let Some(name) = node.attribute(key) else {
            return Ok(around);
        };
        let found = self.by_name.get(name).copied().map(ClassId);
        found.ok_or_else(|| {
            let tag = node.tag_name().name();
            let name: String = name.chars().take(60).collect();
            let message = format!("<{tag}>: there is no default class `{name}`, its {key}");
            reader.tree(node.range().start, message)
        })
    }

    /// What a class says of an attribute of an element.
    pub(crate) fn stated(&self, class: ClassId, tag: &str, key: &str) -> Option<&'d str> {
        self.stated_of(class, &[tag], key)
    }

    /// What a class says of an attribute of any of these elements, whose defaults are one.
    pub(crate) fn stated_of(&self, class: ClassId, tags: &[&str], key: &str) -> Option<&'d str> {
        let mut next = Some(class.0);
        while let Some(class) = next.and_then(|index| self.classes.get(index)) {
            let own = |tag: &&str| class.defaults.get(&(*tag, key)).copied();
            if let Some(value) = tags.iter().find_map(own) {
                return Some(value);
            }
            next = class.parent;
        }
        None
    }
}
