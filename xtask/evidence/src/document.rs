//! The committed evidence: a page of tables for each part of the job, and one page of claims made from them.

use anyhow::{Result, bail};
use xtask_paper::rows;

/// The page of claims, from the root of the repository.
pub(super) const CLAIMS: &str = "docs/evidence.md";
/// Longest claim of that page, in characters; the part's page has the rest.
const LONGEST_CLAIM: usize = 200;

const LEAD: &str = "`cargo xtask evidence` writes this page and the tables that it links to; `--only PART` computes one \
     part again, `--check` says whether what is committed is stale. Settings and causes are with the tables. \
     The last digits depend on the exponentials of the platform: x86-64 Linux here.";

/// What `--only` names, and the headings of its sections.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) name: &'static str,
    sections: &'static [&'static str],
}

/// All parts, in the order of the page of claims.
pub(super) const PARTS: [Part; 13] = rows! {
    Part {name sections}
    "solver", &["Solver against certified problems", "Moré, Garbow & Hillstrom's problems"];
    "intervals", &["Intervals"];
    "noise-memory", &["Noise with memory"];
    "effects", &["Effects"];
    "basin", &["Convergence basin"];
    "parallel-joints", &["Parallel joints"];
    "poses", &["Chosen poses"];
    "watch", &["Watch"];
    "formats", &["Parquet and bags of ROS 2"];
    "fuzz", &["Fuzzing"];
    "python", &["Python package"];
    "licences", &["Licences"];
    "coverage", &["Line coverage"];
};

impl Part {
    /// Its page, from the root of the repository.
    pub(super) fn path(&self) -> String {
        format!("docs/evidence/{}.md", self.name)
    }

    /// Its page with the sections of a run in the place of those that are committed; none if the run has none.
    pub(super) fn page(&self, committed: &str, run: &str) -> Option<String> {
        let of_run: Vec<Option<&str>> = self.find(run);
        if of_run.iter().all(Option::is_none) {
            return None;
        }
        let held = self.find(committed);
        let sections = of_run.into_iter().zip(held);
        let sections: Vec<&str> = sections.filter_map(|(new, old)| new.or(old)).collect();
        Some(format!(
            "# Evidence: {}\n\nWritten by `cargo xtask evidence --only {}`; [evidence.md](../evidence.md) has the claims.\n\n## {}\n",
            self.name,
            self.name,
            sections.join("\n\n## ")
        ))
    }

    /// Its sections in a text, in its order.
    fn find<'t>(&self, text: &'t str) -> Vec<Option<&'t str>> {
        let find = |wanted: &&str| sections(text).find(|section| heading(section) == *wanted);
        self.sections.iter().map(find).collect()
    }
}

/// Each section from its heading on.
fn sections(text: &str) -> impl Iterator<Item = &str> {
    text.split("\n## ").skip(1).map(str::trim)
}

fn heading(section: &str) -> &str {
    section.lines().next().unwrap_or_default()
}

/// Refuses a run with a section that is in no part: no page would hold it.
pub(super) fn assert_placed(run: &str) -> Result<()> {
    let placed = |name: &str| PARTS.iter().any(|part| part.sections.contains(&name));
    match sections(run).map(heading).find(|name| !placed(name)) {
        Some(name) => bail!("the section `{name}` is in no part of document.rs"),
        None => Ok(()),
    }
}

/// Refuses a committed text that is not what this run makes.
pub(super) fn check(path: &str, committed: &str, made: &str) -> Result<()> {
    if committed.trim() == made.trim() {
        return Ok(());
    }
    let differs = committed
        .lines()
        .zip(made.lines())
        .find(|(old, new)| old != new);
    let (old, new) = differs.unwrap_or(("a page", "longer or shorter"));
    bail!(
        "{path} is stale: `{old}` is `{new}` in this run; `cargo xtask evidence` writes it again"
    );
}

pub(super) fn claims(pages: &[(Part, String)]) -> String {
    let mut text =
        format!("# Evidence\n\n{LEAD}\n\n| claim | holds | computed by `cargo xtask evidence` |\n");
    text.push_str("| :--- | :--- | :--- |\n");
    for (part, page) in pages {
        for line in page.lines() {
            let Some((holds, claim)) = claim(line) else {
                continue;
            };
            let name = part.name;
            text.push_str(&format!(
                "| {} | {holds} | [`--only {name}`](evidence/{name}.md) |\n",
                shortened(claim).replace('|', "\\|")
            ));
        }
    }
    text
}

/// Whether a claim holds, and the claim, of a line such as `- **yes**: every test passed`.
fn claim(line: &str) -> Option<(&str, &str)> {
    line.strip_prefix("- **")?.split_once("**: ")
}

/// A claim up to the last `;`, `:` or `,` that is not too far on.
fn shortened(claim: &str) -> String {
    let Some((end, _)) = claim.char_indices().nth(LONGEST_CLAIM) else {
        return claim.to_owned();
    };
    let cut = claim[..end].rfind([';', ',', ':']).unwrap_or(end);
    format!("{} ...", &claim[..cut])
}

/// The text without its figures, which are in the report alone.
pub(super) fn without_figures(text: &str) -> String {
    let blocks = text
        .split("\n\n")
        .filter(|block| !block.trim_start().starts_with("!["));
    blocks.collect::<Vec<_>>().join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: Part = Part {
        name: "two",
        sections: &["A", "B"],
    };
    const RUN: &str = "# E\n\nlead\n\n## A\n\n1 2\n\n## B\n\n- **yes**: all | found\n";

    #[test]
    fn a_page_takes_the_sections_of_a_run_and_keeps_the_others() {
        let page = TWO.page("", RUN).unwrap();
        assert!(
            page.ends_with("## A\n\n1 2\n\n## B\n\n- **yes**: all | found\n"),
            "{page}"
        );
        let newer = TWO.page(&page, "# E\n\nother\n\n## A\n\n9\n").unwrap();
        assert_eq!(newer, page.replace("1 2", "9"));
        assert_eq!(TWO.page(&page, "# E\n\n## C\n\n9\n"), None);
    }

    #[test]
    fn a_page_that_is_not_of_this_run_is_stale() {
        let page = TWO.page("", RUN).unwrap();
        let newer = TWO.page(&page, &RUN.replace("1 2", "1 3")).unwrap();
        assert!(check("page", &page, &page).is_ok());
        let stale = check("page", &page, &newer).unwrap_err().to_string();
        assert!(stale.contains("`1 2` is `1 3`"), "{stale}");
        assert!(check("page", "", &page).is_err());
    }

    #[test]
    fn every_section_of_a_run_has_a_part() {
        assert!(assert_placed("# E\n\n## Licences\n\nall\n").is_ok());
        assert!(assert_placed(RUN).unwrap_err().to_string().contains("`A`"));
    }

    #[test]
    fn claims_are_a_table_with_links() {
        let page = TWO.page("", RUN).unwrap();
        let claims = claims(&[(TWO, page)]);
        let row = "| all \\| found | yes | [`--only two`](evidence/two.md) |\n";
        assert!(claims.ends_with(row), "{claims}");
    }

    #[test]
    fn a_long_claim_is_cut_between_its_clauses() {
        let long = format!("{}, {}", "a".repeat(150), "b".repeat(150));
        assert_eq!(shortened(&long), format!("{} ...", "a".repeat(150)));
        assert_eq!(shortened("short, enough"), "short, enough");
    }

    #[test]
    fn figures_stay_in_the_report() {
        let text = "# E\n\nlead\n\n![a](figures/a.svg)\n\n- **yes**: so\n\n";
        assert_eq!(without_figures(text), "# E\n\nlead\n\n- **yes**: so\n\n");
    }
}
