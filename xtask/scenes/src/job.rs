//! `cargo xtask compare-results`: every scene against its record.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::catalogue::{SCENES, named};
use crate::compare::{Difference, compare, tolerances};
use crate::record;
use crate::scene::root;
use crate::workers::each;

/// Where everything that moved is listed, from the root of the project.
const MOVED: &str = "target/compare-results.txt";

/// Arguments of `compare-results`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask compare-results --only moving --record")]
pub struct Arguments {
    /// Only scenes whose name contains this.
    #[arg(long)]
    only: Option<String>,
    /// Records the answers; what moved is printed and listed all the same.
    #[arg(long)]
    record: bool,
    /// Differences that are listed for each scene.
    #[arg(long, default_value_t = 12)]
    list: usize,
}

/// Runs the job: an error where an answer is not as it was recorded, without `--record`.
pub fn compare_results(arguments: &Arguments) -> Result<()> {
    let scenes = named(arguments.only.as_deref().unwrap_or_default());
    ensure!(
        !scenes.is_empty(),
        "no scene has a name that contains {:?}",
        arguments.only
    );
    let start = Instant::now();
    let (mut moved, mut scenes_moved) = (0, 0);
    let mut all = String::new();
    let answers = each(&scenes, |scene| {
        let start = Instant::now();
        let answer = (scene.make)().and_then(|made| made.answer());
        (answer, start.elapsed().as_secs_f64())
    });
    for (scene, (answer, seconds)) in scenes.iter().zip(answers) {
        let answer = answer.with_context(|| scene.name)?;
        let recorded = record::read(scene.name)?;
        let differences = match &recorded {
            Some(recorded) => compare(recorded, &answer),
            None if arguments.record => Vec::new(),
            None => bail!("{}: no record; --record makes one", scene.name),
        };
        println!(
            "{:28} {seconds:5.1} s  {}",
            scene.name,
            in_words(&differences)
        );
        for difference in &differences {
            writeln!(all, "{} {difference}", scene.name)?;
        }
        list(scene.name, &differences, arguments.list);
        moved += differences.len();
        scenes_moved += usize::from(!differences.is_empty());
        if arguments.record {
            record::write(scene.name, &answer)?;
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{} scenes in {seconds:.1} s: {moved} values of {scenes_moved} scenes moved",
        scenes.len()
    );
    println!("tolerances: {}", tolerances());
    if moved > 0 {
        let path = root(MOVED);
        std::fs::create_dir_all(root("target"))?;
        std::fs::write(&path, all).with_context(|| path.display().to_string())?;
        println!("all of them, a line each: {MOVED}");
    }
    finish(arguments, moved)
}

/// Scenes without records and records without scenes; the page of verdicts.
fn finish(arguments: &Arguments, moved: usize) -> Result<()> {
    for name in record::names()? {
        let is_left = !SCENES.iter().any(|scene| scene.name == name);
        match arguments.record {
            true if is_left => record::remove(&name)?,
            false if is_left => bail!("{name}: a record without a scene; --record removes it"),
            _ => {}
        }
    }
    let page = page()?;
    match arguments.record {
        true => record::write_page(&page),
        false if moved > 0 => bail!("{moved} values moved; where that is meant: --record"),
        false if record::page()? != page => {
            bail!("verdicts.txt is not what the records say; --record writes it")
        }
        false => Ok(()),
    }
}

fn in_words(differences: &[Difference]) -> String {
    match differences.len() {
        0 => "as recorded".to_owned(),
        moved => format!("{moved} values moved"),
    }
}

/// A line a difference: scene, path, recorded, now.
fn list(scene: &str, differences: &[Difference], most: usize) {
    for difference in differences.iter().take(most) {
        println!("    {scene} {difference}");
    }
    if differences.len() > most {
        println!("    {scene} and {} more", differences.len() - most);
    }
}

/// Verdicts and causes of all records.
fn page() -> Result<String> {
    let mut page = "# Verdicts and causes of the golden scenes: written by `cargo xtask compare-results --record`.\n".to_owned();
    for scene in SCENES.iter() {
        let Some(answer) = record::read(scene.name)? else {
            continue;
        };
        let gap = &answer["diagnose"];
        let verdict = gap["verdict"].as_str().or(gap["refused"].as_str());
        writeln!(page, "{}: {}", scene.name, verdict.unwrap_or_default())?;
        for cause in gap["causes"].as_array().into_iter().flatten() {
            writeln!(page, "    {}", cause_in_words(cause))?;
        }
    }
    Ok(page)
}

fn cause_in_words(cause: &Value) -> String {
    let mut said = cause["effect"].as_str().unwrap_or_default().to_owned();
    if let Some(joint) = cause["joint"].as_u64() {
        said += &format!("@{joint}");
    }
    let probability = cause["probability"].as_f64().unwrap_or_default();
    said += &format!(" {:.0} %", 100.0 * probability);
    for (name, own) in cause["parameters"].as_object().into_iter().flatten() {
        let number = |value: &Value| {
            value
                .as_f64()
                .map_or("-".to_owned(), |own| format!("{own:.4e}"))
        };
        let [low, high] = [0, 1].map(|end| number(&own["ci95"][end]));
        said += &format!(", {name} {} [{low}, {high}]", number(&own["value"]));
    }
    let confused = cause["confusable_with"].as_array().into_iter().flatten();
    let confused: Vec<&str> = confused.filter_map(Value::as_str).collect();
    if !confused.is_empty() {
        said += &format!(", or {}", confused.join(", "));
    }
    said
}
