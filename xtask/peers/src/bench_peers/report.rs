//! Tables, figure and JSON of a comparison.

use std::path::Path;

use anyhow::Result;
use haptical_metrics::median;
use haptical_report::{BarRow, BarRows, Block, Cell, Document, Section, Table, write_atomically};
use serde_json::{Value, json};
use xtask_output::cells;

use super::agreement::COST_AGREEMENT;
use super::bars::{BATCH, ONE_POSE, verdicts};
use super::contender::{Contender, Label};
use super::distance::{LARGE, SMALL};
use super::kinematics::VALUE_AGREEMENT;
use super::load::{DISTURBED, processor};
use super::rounds::Comparison;

/// In the order of the tables.
const WORKS: [&str; 4] = [SMALL.name, LARGE.name, ONE_POSE, BATCH];

/// A peer, there or not.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeerRecord {
    pub(crate) name: &'static str,
    /// Version and how it was built, or why it is missing and what to install.
    pub(crate) state: Result<String, String>,
}

impl PeerRecord {
    pub(crate) fn words(&self) -> String {
        match &self.state {
            Ok(built) => format!("{}: {built}", self.name),
            Err(why) => format!("{}: missing: {why}", self.name),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solution {
    pub(crate) work: String,
    pub(crate) label: Label,
    pub(crate) cost: f64,
    pub(crate) iterations: Option<u64>,
    pub(crate) construction_s: Option<f64>,
}

#[derive(Debug, Clone, Default)]
pub(crate) struct Results {
    pub(crate) peers: Vec<PeerRecord>,
    pub(crate) solutions: Vec<Solution>,
    pub(crate) comparisons: Vec<Comparison>,
    /// Work, ours, time \[s\]: for a run in which every peer is missing.
    pub(crate) alone: Vec<(String, Label, f64)>,
    /// Between Pinocchio's numbers and ours.
    pub(crate) largest_difference: Option<f64>,
    pub(crate) load_before: Option<f64>,
    pub(crate) load_after: Option<f64>,
}

impl Results {
    pub(crate) fn alone(&mut self, work: &str, ours: &dyn Contender, time_s: f64) {
        self.alone
            .push((work.to_owned(), ours.label().clone(), time_s));
    }
}

pub(crate) fn pairs(work: &str, comparisons: &[Comparison]) -> Result<Table> {
    let columns = "ours | other | ours [us] | other [us] | other / ours | interval | confidence [%] | rounds | \
             discarded";
    let mut table = Table::with_heads(format!("{work}: medians"), columns);
    for each in comparisons.iter().filter(|each| each.work == work) {
        let time = |times_s: &[f64]| {
            let median_s = median(times_s).ok();
            Cell::number_or_missing(median_s.map(|time_s| 1e6 * time_s), 2)
        };
        let ratio = each.ratio();
        table.push(cells! {
            each.ours.full(), each.other.full(), time(&each.ours_s), time(&each.other_s),
            ratio.map(|ratio| ratio.median) => 2, ratio.map(|ratio| [ratio.low, ratio.high]) => 2,
            ratio.map(|ratio| 100.0 * ratio.confidence) => 1, each.ratios.len() => 0,
            each.discarded => 0,
        })?;
    }
    Ok(table)
}

/// Times of ours in the runs before the pairs, and a row for each peer that is missing.
pub(crate) fn presence(results: &Results) -> Result<Table> {
    let columns = "who | work | first times of ours [us]";
    let mut table = Table::with_heads("Who takes part", columns);
    for (work, ours, time_s) in &results.alone {
        let time = Cell::number(1e6 * time_s, 2);
        table.push(vec![ours.full().into(), work.as_str().into(), time])?;
    }
    for peer in &results.peers {
        let state = peer.state.as_ref().map_or("missing", |_| "here");
        table.push(vec![peer.name.into(), state.into(), Cell::Missing])?;
        table.notes.push(peer.words());
    }
    Ok(table)
}

fn solutions(results: &Results) -> Result<Table> {
    let columns =
        "work | contender | sum of squares | above the lowest [1] | steps | construction [us]";
    let mut table = Table::with_heads("Solutions", columns);
    for each in &results.solutions {
        let same = results.solutions.iter();
        let same = same.filter(|other| other.work == each.work);
        let lowest = same.map(|other| other.cost).fold(f64::INFINITY, f64::min);
        let iterations = each.iterations.map(|steps| steps as f64);
        table.push(cells! {
            each.work.as_str(), each.label.full(), each.cost => 6,
            Cell::scientific((each.cost - lowest) / lowest, 2), iterations => 0,
            each.construction_s.map(|s| 1e6 * s) => 1,
        })?;
    }
    Ok(table)
}

/// The ratios as bars, on a logarithmic axis; none where there is no ratio.
fn figure(comparisons: &[Comparison]) -> BarRows {
    let mut bars = BarRows::new("How many times as long as ours", "log10(other / ours)");
    let mut works: Vec<&str> = Vec::new();
    for each in comparisons {
        let Some(ratio) = each.ratio() else { continue };
        if works.last() != Some(&each.work.as_str()) {
            works.push(&each.work);
        }
        bars.rows.push(BarRow {
            name: format!("{}, {}", each.work, each.other.full()),
            from: 0.0,
            to: ratio.median.log10(),
            colour: works.len() - 1,
            value: format!(
                "{:.1} ({:.1} to {:.1})",
                ratio.median, ratio.low, ratio.high
            ),
        });
    }
    bars
}

fn comparison_json(each: &Comparison) -> Value {
    let label = |label: &Label| json!({"family": label.family, "name": label.name, "threads": label.threads});
    let ratio = each.ratio();
    json!({
        "work": each.work, "ours": label(&each.ours), "other": label(&each.other),
        "ours_s": each.ours_s, "other_s": each.other_s, "ratios": each.ratios,
        "median_ratio": ratio.map(|ratio| ratio.median),
        "interval": ratio.map(|ratio| [ratio.low, ratio.high]),
        "confidence": ratio.map(|ratio| ratio.confidence), "discarded": each.discarded,
    })
}

fn conditions(results: &Results, keep_disturbed: bool) -> String {
    let discarded: usize = results.comparisons.iter().map(|each| each.discarded).sum();
    let found = results.largest_difference;
    let load = |load: Option<f64>| load.map_or("unknown".to_owned(), |load| load.to_string());
    format!(
        "Tolerance of the cost: {:e} for {}, {:e} for {}. Final costs agree to that, or to {COST_AGREEMENT:e} where it is less; poses and Jacobians to \
         {VALUE_AGREEMENT:e}{}. {discarded} rounds were discarded, because others had used more than {:.0} % of the \
         processors{}. Load average before and after: {} and {}. A ratio is the median of the rounds' ratios, its interval \
         that of their order statistics. Times of pose and Jacobian are for one pose.",
        SMALL.tolerance,
        SMALL.name,
        LARGE.tolerance,
        LARGE.name,
        found.map_or(String::new(), |most| format!(" (found: {most:.1e})")),
        100.0 * DISTURBED,
        if keep_disturbed {
            "; this run keeps such rounds, as asked, so none of its figures may be quoted"
        } else {
            ""
        },
        load(results.load_before),
        load(results.load_after),
    )
}

/// Writes `peers.json`, `peers.svg` and `report.html`, and gives what a terminal shows.
pub(crate) fn write(
    results: &Results,
    directory: &Path,
    command: &str,
    keep_disturbed: bool,
) -> Result<Vec<String>> {
    let conditions = conditions(results, keep_disturbed);
    let present = presence(results)?;
    let mut terminal = vec![present.to_terminal()];
    let who = vec![Block::Table(present), Block::Paragraph(conditions.clone())];
    let mut times = Vec::new();
    for work in WORKS {
        let table = pairs(work, &results.comparisons)?;
        if !table.rows().is_empty() {
            terminal.push(table.to_terminal());
            times.push(Block::Table(table));
        }
    }
    let verdicts = verdicts(&results.comparisons);
    for (good, text) in &verdicts {
        let (good, text) = (*good, text.clone());
        terminal.push(format!("{:>3}: {text}", if good { "yes" } else { "NO" }));
        times.push(Block::Verdict { good, text });
    }
    let figure = figure(&results.comparisons);
    if !figure.rows.is_empty() {
        let svg = figure.to_svg(1100)?;
        write_atomically(&directory.join("peers.svg"), svg.as_bytes())?;
        let caption = "Median ratios, with their intervals behind the bars".to_owned();
        times.push(Block::Svg { caption, svg });
    }
    let solutions = solutions(results)?;
    terminal.push(solutions.to_terminal());
    terminal.push(conditions.clone());
    let processor = processor();
    let lead = format!(
        "Ours and its peers on the same files, in turns (made by `{command}`, version {}, on {processor}). Only ratios \
         within one run mean something; docs/performance.md says what is compared and how.",
        env!("CARGO_PKG_VERSION"),
    );
    let all = json!({
        "command": command,
        "version": env!("CARGO_PKG_VERSION"),
        "processor": processor,
        "conditions": conditions,
        "disturbed_rounds_kept": keep_disturbed,
        "load_average": [results.load_before, results.load_after],
        "peers": results.peers.iter().map(PeerRecord::words).collect::<Vec<_>>(),
        "largest_difference": results.largest_difference,
        "solutions": solutions.to_json(),
        "comparisons": results.comparisons.iter().map(comparison_json).collect::<Vec<_>>(),
        "bars": verdicts.iter().map(|(good, text)| json!({"reached": good, "text": text})).collect::<Vec<_>>(),
    });
    let bytes = serde_json::to_vec_pretty(&all)?;
    write_atomically(&directory.join("peers.json"), &bytes)?;
    let sections = vec![
        Section::new("Who takes part", who),
        Section::new("Times", times),
        Section::new("Solutions", vec![Block::Table(solutions)]),
    ];
    let page = Document::new("Ours and its peers", &lead, sections).to_html();
    write_atomically(&directory.join("report.html"), page.as_bytes())?;
    Ok(terminal)
}
