//! No ring of modules that import each other, in the crates that have been freed of them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::{root, rust_files};

/// Crates whose modules, a folder's module included, must not import each other in a ring.
const WITHOUT_RINGS: [&str; 6] = [
    "batch",
    "calibration",
    "diagnosis",
    "effects",
    "identification",
    "linalg",
];

/// Path of a module or an item within its crate.
type Name = Vec<String>;

/// The modules of a crate with the text of each, and the names that their `use` lines bring in.
#[derive(Default)]
struct Modules {
    text: BTreeMap<Name, String>,
    imports: BTreeMap<(Name, String), Name>,
    /// Imports that are no re-exports.
    used: Vec<(Name, Name)>,
}

impl Modules {
    fn read(source: &Path) -> Self {
        let mut modules = Self::default();
        for file in rust_files(source) {
            let path = file.strip_prefix(source).unwrap().with_extension("");
            let mut name: Name = path
                .iter()
                .map(|part| part.to_string_lossy().into_owned())
                .collect();
            if name
                .last()
                .is_some_and(|last| ["mod", "lib"].contains(&last.as_str()))
            {
                name.pop();
            }
            modules
                .text
                .insert(name, code(&std::fs::read_to_string(&file).unwrap()));
        }
        let texts = modules.text.clone();
        for (module, text) in &texts {
            for statement in text.split(';') {
                // attributes and what precedes it do not matter: a statement's own last `use`
                let Some((before, tree)) = statement.rsplit_once("use ") else {
                    continue;
                };
                let line = before.rsplit('\n').next().unwrap_or_default().trim();
                if !line.is_empty() && !line.starts_with("pub") {
                    continue;
                }
                for (path, alias) in leaves(tree) {
                    let Some(path) = modules.absolute(module, &path) else {
                        continue;
                    };
                    if !line.starts_with("pub") {
                        modules.used.push((module.clone(), path.clone()));
                    }
                    modules.imports.insert((module.clone(), alias), path);
                }
            }
        }
        modules
    }

    /// A path from the root of the crate; none for paths into other crates.
    fn absolute(&self, module: &Name, path: &str) -> Option<Name> {
        let mut parts: Name = path
            .split("::")
            .map(|part| part.trim().to_owned())
            .collect();
        let mut base = module.clone();
        match parts.first().map(String::as_str) {
            Some("crate") => base.clear(),
            Some("self") => {}
            Some("super") => {
                while parts.get(1).is_some_and(|part| part == "super") {
                    parts.remove(0);
                    base.pop();
                }
                base.pop();
            }
            Some(first) => {
                let mut child = base.clone();
                child.push(first.to_owned());
                if !self.text.contains_key(&child) {
                    return None;
                }
                base.extend(parts);
                return Some(base);
            }
            None => return None,
        }
        base.extend(parts.drain(1..));
        Some(base)
    }

    /// The module in which a path ends, through re-exports.
    fn home(&self, path: &Name, depth: usize) -> Name {
        let longest = (0..=path.len())
            .rev()
            .find(|&count| self.text.contains_key(&path[..count]));
        let (module, rest) = path.split_at(longest.unwrap_or(0));
        if let Some((name, further)) = rest.split_first()
            && depth < 8
            && let Some(behind) = self.imports.get(&(module.to_vec(), name.clone()))
            && behind != path
        {
            return self.home(&[behind, further].concat(), depth + 1);
        }
        module.to_vec()
    }

    /// Which modules each module imports from.
    fn arrows(&self) -> BTreeMap<Name, BTreeSet<Name>> {
        let mut arrows: BTreeMap<Name, BTreeSet<Name>> = BTreeMap::new();
        let mut add = |from: &Name, path: &Name| {
            let to = self.home(path, 0);
            if to != *from {
                arrows.entry(from.clone()).or_default().insert(to);
            }
        };
        for (from, path) in &self.used {
            add(from, path);
        }
        for (from, text) in &self.text {
            for word in text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')) {
                let first = word.split("::").next().unwrap_or_default();
                let imported = self.imports.get(&(from.clone(), first.to_owned()));
                let path = match imported {
                    _ if !word.contains("::") => continue,
                    Some(module) if self.text.contains_key(module) => {
                        let rest = word.split("::").skip(1).map(str::to_owned);
                        module.iter().cloned().chain(rest).collect()
                    }
                    _ if ["crate", "super"].contains(&first) => {
                        match self.absolute(from, word.trim_end_matches(':')) {
                            Some(path) => path,
                            None => continue,
                        }
                    }
                    _ => continue,
                };
                add(from, &path);
            }
        }
        arrows
    }
}

/// Code without comments, `use` lines' groups left as they are, and without unit tests.
fn code(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    let text = lines.collect::<Vec<_>>().join("\n");
    let tests = text.find("#[cfg(test)]\nmod ");
    text[..tests.unwrap_or(text.len())].to_owned()
}

/// The paths of a `use` tree, each with the name that it brings in.
fn leaves(tree: &str) -> Vec<(String, String)> {
    let tree = tree.trim();
    let Some((prefix, group)) = tree.split_once('{') else {
        let (path, alias) = tree.split_once(" as ").unwrap_or((tree, tree));
        let name = alias.rsplit("::").next().unwrap_or_default();
        return vec![(path.trim().to_owned(), name.trim().to_owned())];
    };
    let group = group.trim_end().trim_end_matches('}');
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for letter in group.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if letter == ',' && depth == 0 {
            parts.push(String::new());
        } else if let Some(part) = parts.last_mut() {
            part.push(letter);
        }
    }
    let inner = parts.iter().filter(|part| !part.trim().is_empty());
    let inner = inner.flat_map(|part| leaves(part));
    inner
        .map(|(path, name)| (format!("{prefix}{path}"), name))
        .collect()
}

/// Modules that can be reached from a module by way of its imports.
fn reached(arrows: &BTreeMap<Name, BTreeSet<Name>>, from: &Name) -> BTreeSet<Name> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for next in arrows.get(module).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next);
            }
        }
    }
    seen
}

/// Modules that import themselves by way of others.
fn in_rings(modules: &Modules) -> Vec<String> {
    let arrows = modules.arrows();
    let rings = arrows
        .keys()
        .filter(|module| reached(&arrows, module).contains(*module));
    rings.map(|module| module.join("::")).collect()
}

#[test]
fn modules_do_not_import_each_other_in_rings() {
    for name in WITHOUT_RINGS {
        let modules = Modules::read(&root().join("crates").join(name).join("src"));
        assert!(
            modules.text.len() > 5,
            "{name}: {} modules",
            modules.text.len()
        );
        assert!(
            modules.used.len() > 5,
            "{name}: {} imports",
            modules.used.len()
        );
        let rings = in_rings(&modules);
        assert!(rings.is_empty(), "{name}: in rings: {}", rings.join(", "));
    }
}

#[test]
fn a_ring_through_a_re_export_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "lib.rs",
        "mod a;\nmod b;\npub use a::{A, Again as Other};\n",
    );
    write(
        "a.rs",
        "use std::fmt;\nuse crate::b::{self, B};\npub struct A(B);\n",
    );
    write("b.rs", "// crate::a is said here alone\npub struct B;\n");
    assert!(in_rings(&Modules::read(folder.path())).is_empty());
    write("b.rs", "pub struct B;\nfn f(_: &crate::Other) {}\n");
    assert_eq!(in_rings(&Modules::read(folder.path())), ["a", "b"]);
    // a folder's own module counts as one
    write("lib.rs", "mod a;\nmod b;\npub struct C;\n");
    write("a.rs", "");
    write("b.rs", "use crate::C;\n");
    assert!(in_rings(&Modules::read(folder.path())).is_empty());
    write("lib.rs", "mod a;\nmod b;\nuse b::B;\npub struct C;\n");
    assert_eq!(in_rings(&Modules::read(folder.path())), ["", "b"]);
}
