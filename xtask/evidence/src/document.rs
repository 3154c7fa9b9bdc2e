//! Whether the committed document holds the sections of a run.

use anyhow::{Result, bail};

/// What stands before the first section, and each section from its heading on.
fn sections(text: &str) -> impl Iterator<Item = &str> {
    text.split("\n## ").map(str::trim)
}

/// Refuses a document that lacks a section of the run, or has it with other figures.
pub(super) fn check(document: &str, run: &str) -> Result<()> {
    for section in sections(run) {
        if !sections(document).any(|held| held == section) {
            let heading = section.lines().next().unwrap_or_default();
            bail!(
                "docs/evidence.md is stale: its section `{heading}` is not that of this run; \
                 `cargo xtask evidence` writes it again"
            );
        }
    }
    Ok(())
}

/// The document with the sections of a run in the place of its own of the same headings; new ones come last.
pub(super) fn with_sections(document: &str, run: &str) -> String {
    let heading = |section: &str| section.lines().next().unwrap_or_default().to_owned();
    let mut held: Vec<&str> = sections(document).collect();
    // the first is what stands before all sections
    for new in sections(run).skip(1) {
        let place = held
            .iter()
            .skip(1)
            .position(|old| heading(old) == heading(new));
        match place {
            Some(place) => held[place + 1] = new,
            None => held.push(new),
        }
    }
    held.join("\n\n## ") + "\n"
}

/// The text without its figures, which stand in the report alone.
pub(super) fn without_figures(text: &str) -> String {
    let blocks = text
        .split("\n\n")
        .filter(|block| !block.trim_start().starts_with("!["));
    blocks.collect::<Vec<_>>().join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::{check, with_sections, without_figures};

    const DOCUMENT: &str = "# E\n\nlead\n\n## A\n\n1 2\n\n## B\n\n3\n";

    #[test]
    fn a_run_of_some_sections_is_found() {
        assert!(check(DOCUMENT, DOCUMENT).is_ok());
        assert!(check(DOCUMENT, "# E\n\nlead\n\n## B\n\n3\n\n").is_ok());
    }

    #[test]
    fn a_part_replaces_its_own_sections() {
        let new = with_sections(DOCUMENT, "# E\n\nother\n\n## C\n\n4\n\n## A\n\n9\n");
        assert_eq!(new, "# E\n\nlead\n\n## A\n\n9\n\n## B\n\n3\n\n## C\n\n4\n");
        assert!(check(&new, "# E\n\nlead\n\n## A\n\n9\n").is_ok());
    }

    #[test]
    fn figures_stay_in_the_report() {
        let text = "# E\n\nlead\n\n![a](figures/a.svg)\n\n- **yes**: so\n\n";
        assert_eq!(without_figures(text), "# E\n\nlead\n\n- **yes**: so\n\n");
    }

    #[test]
    fn another_figure_is_stale() {
        let stale = check(DOCUMENT, "# E\n\nlead\n\n## A\n\n1 9\n").unwrap_err();
        assert!(stale.to_string().contains("`A`"), "{stale}");
        assert!(check("", DOCUMENT).is_err());
    }
}
