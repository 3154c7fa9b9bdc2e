//! `cargo xtask laws`: every law on every scene, against the list of those that are broken.

use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::catalogue::named;
use crate::laws::broken::{self, Broken};
use crate::laws::judge::Pair;
use crate::laws::{Allows, LAWS, Law};
use crate::scene::{Made, Scene};
use crate::workers::each;

/// Of the pairs of a scene and a law one in so many is asked with `--quick`.
const QUICK: usize = 3;
/// Scenes whose answers take seconds are left out with `--quick`.
const SLOW: [&str; 2] = ["hand-", "arm-two-hands"];

/// Arguments of `laws`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: cargo xtask laws --only moving")]
pub struct LawsArguments {
    /// Only scenes whose name contains this.
    #[arg(long)]
    only: Option<String>,
    /// Only laws whose name contains this.
    #[arg(long)]
    law: Option<String>,
    /// One pair of scene and law in three, without slow scenes.
    #[arg(long)]
    quick: bool,
    /// Writes the list of laws that are broken.
    #[arg(long, conflicts_with = "quick")]
    record: bool,
}

/// Runs the job: an error where a law is broken that is not in the list, or holds that is in it.
pub fn laws(arguments: &LawsArguments) -> Result<()> {
    let start = Instant::now();
    let asked = asked(arguments);
    ensure!(!asked.is_empty(), "no law and scene of these names");
    let outcomes = each(&asked, |(scene, laws)| outcomes(scene, laws));
    let mut outcome: Vec<Outcome> = Vec::new();
    for ((scene, _), found) in asked.iter().zip(outcomes) {
        outcome.extend(found.with_context(|| scene.name)?);
    }
    let list = broken::read()?;
    let (mut holds, mut news, mut cured) = (0, 0, 0);
    for own in &outcome {
        let listed = list.iter().any(|other| own.is(other));
        match (&own.broken, listed) {
            (None, false) => holds += 1,
            (Some(_), true) => {}
            (Some(why), false) => {
                news += 1;
                println!("BROKEN  {:24} {:28} {why}", own.law, own.scene);
            }
            (None, true) => {
                cured += 1;
                println!(
                    "HOLDS   {:24} {:28} and is listed as broken",
                    own.law, own.scene
                );
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{} pairs of a scene and a law in {seconds:.1} s: {holds} hold, {news} are broken and not listed, {cured} hold and are listed",
        outcome.len()
    );
    if arguments.record {
        return record(&list, &outcome);
    }
    if news + cured > 0 {
        bail!(
            "{} is not what the answers say; where that is meant: cargo xtask laws --record",
            broken::FILE
        );
    }
    Ok(())
}

/// Each scene with its laws.
fn asked(arguments: &LawsArguments) -> Vec<(Scene, Vec<&'static Law>)> {
    let part = arguments.law.as_deref().unwrap_or_default();
    let scenes = named(arguments.only.as_deref().unwrap_or_default());
    let scenes = scenes.into_iter().enumerate().map(|(index, scene)| {
        let is_slow = SLOW.iter().any(|start| scene.name.starts_with(start));
        let laws = LAWS.iter().enumerate().filter(|(place, law)| {
            let is_in_turn = !is_slow && (index + place).is_multiple_of(QUICK);
            law.name.contains(part) && (!arguments.quick || is_in_turn)
        });
        (scene, laws.map(|(_, law)| law).collect::<Vec<_>>())
    });
    scenes.filter(|(_, laws)| !laws.is_empty()).collect()
}

/// How a law fares on a scene.
struct Outcome {
    law: &'static str,
    scene: &'static str,
    broken: Option<String>,
}

impl Outcome {
    fn is(&self, other: &Broken) -> bool {
        other.law == self.law && other.scene == self.scene
    }
}

/// Answers a scene as it is and with each change.
fn outcomes(scene: &Scene, laws: &[&'static Law]) -> Result<Vec<Outcome>> {
    let made = (scene.make)()?;
    let mut changes = Vec::new();
    for law in laws {
        let changed = (law.change)(&made).with_context(|| law.name)?;
        changes.extend(changed.map(|changed| (law, changed)));
    }
    let of_identification = |law: &Law| {
        matches!(
            law.allows,
            Allows::SameIdentification | Allows::NoNarrowerInterval
        )
    };
    let asks = changes.iter().any(|(law, _)| of_identification(law)) && made.is_of_postures();
    let before = answer(&made, asks)?;
    if !before["diagnose"]["refused"].is_null() {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    for (law, changed) in changes {
        let asks = asks && of_identification(law);
        let after = match law.allows {
            Allows::SameBits => on_three_threads(&changed)?,
            _ => answer(&changed, asks)?,
        };
        let bits = serde_json::json!({"diagnose": before["diagnose"]});
        let pair = Pair {
            truth: scene.truth,
            before: if law.allows == Allows::SameBits {
                &bits
            } else {
                &before
            },
            after: &after,
        };
        found.push(Outcome {
            law: law.name,
            scene: scene.name,
            broken: pair.broken(law.allows),
        });
    }
    Ok(found)
}

/// The diagnosis, with the identification where it is asked.
fn answer(made: &Made, with_identification: bool) -> Result<Value> {
    match with_identification {
        true => made.answer(),
        false => made.without_identification().answer(),
    }
}

fn on_three_threads(made: &Made) -> Result<Value> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build()?;
    pool.install(|| answer(made, false))
}

/// The list with what was found in the place of what it said of these pairs.
fn record(list: &[Broken], outcome: &[Outcome]) -> Result<()> {
    let mut kept: Vec<Broken> = Vec::new();
    for own in outcome {
        if let Some(why) = &own.broken {
            kept.push(Broken {
                law: own.law.to_owned(),
                scene: own.scene.to_owned(),
                why: why.clone(),
            });
        }
    }
    let not_asked = |other: &&Broken| !outcome.iter().any(|own| own.is(other));
    kept.extend(list.iter().filter(not_asked).cloned());
    kept.sort();
    broken::write(&kept)?;
    println!("{} laws are broken: {}", kept.len(), broken::FILE);
    Ok(())
}
