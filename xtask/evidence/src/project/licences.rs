//! Licences of everything that the workspace is built from, against what may be shipped with it.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use cargo_metadata::MetadataCommand;
use haptical_report::Table;
use spdx::{Expression, LicenseReq};
use xtask_output::{Output, cells, or_none, root};

/// Licences under which a dependency may come: permissive ones, whose only demand is that their text is kept, if that.
const ALLOWED: [&str; 9] = [
    "MIT",
    "Apache-2.0",
    "Zlib",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "0BSD",
    "Unicode-3.0",
    "Unlicense",
    "CC0-1.0",
];

/// Whether an expression can be met by allowed licences alone.
fn is_allowed(expression: &Expression) -> bool {
    expression.evaluate(|requirement: &LicenseReq| {
        // an exception only permits more
        let name = requirement.license.id().map(|id| id.name);
        name.is_some_and(|name| ALLOWED.contains(&name))
    })
}

/// A licence as crates state it; a slash is the old way to write `OR`.
fn parse(licence: &str) -> Result<Expression> {
    let written = licence.replace('/', " OR ");
    Expression::parse(&written).with_context(|| format!("the licence \"{licence}\""))
}

pub(crate) fn section(output: &mut Output) -> Result<()> {
    let metadata = MetadataCommand::new()
        .manifest_path(root().join("Cargo.toml"))
        .other_options(vec!["--locked".to_owned()])
        .exec()
        .context("cargo metadata")?;
    let mut licences: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let metadata = metadata.packages.iter();
    for package in metadata.filter(|package| package.source.is_some()) {
        let licence = package.license.clone().unwrap_or_default();
        let name = format!("{} {}", package.name, package.version);
        licences.entry(licence).or_default().push(name);
    }
    let columns = "licence | packages | allowed";
    let mut table = Table::with_heads(
        "Licences of all dependencies, those of tests and jobs included",
        columns,
    );
    let mut refused = Vec::new();
    for (licence, packages) in &licences {
        let allowed = parse(licence).is_ok_and(|expression| is_allowed(&expression));
        if !allowed {
            refused.extend(packages.iter().map(|name| format!("{name} ({licence})")));
        }
        let answer = if allowed { "yes" } else { "no" };
        table.push(cells! { licence.as_str(), packages.len() => 0, answer })?;
    }
    output.section("Licences");
    output.words(format!(
        "Every package that `Cargo.lock` names, by the licence that it states, as an SPDX expression. Allowed: {}. Advisories \
         (security notices) are not looked at: they need a connection to their database.",
        ALLOWED.join(", ")
    ));
    output.table("licences", table)?;
    let text = format!(
        "packages under a licence that is not allowed: {}",
        or_none(&refused)
    );
    output.verdict(refused.is_empty(), text);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_met_and_demands_are_not() {
        let allowed =
            |licence: &str| parse(licence).is_ok_and(|expression| is_allowed(&expression));
        assert!(allowed("MIT OR GPL-3.0-only") && allowed("MIT/Apache-2.0"));
        assert!(allowed("Apache-2.0 WITH LLVM-exception OR MIT"));
        assert!(!allowed("GPL-3.0-only") && !allowed("MIT AND LGPL-2.1-or-later"));
        assert!(!allowed("") && !allowed("proprietary"));
    }
}
