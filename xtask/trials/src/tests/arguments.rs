//! Arguments of the job, and the trials that they ask for.

use clap::Parser;
use xtask_blind::Suite;

use crate::Arguments;
use crate::plan::Plan;
use crate::seed::SeedRule;

#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

fn parsed(words: &str) -> Result<Arguments, String> {
    let words = std::iter::once("blind-check").chain(words.split_whitespace());
    match Line::try_parse_from(words) {
        Ok(line) => Ok(line.arguments),
        Err(error) => Err(error.to_string()),
    }
}

fn plan(words: &str) -> Result<Plan, String> {
    Plan::new(&parsed(words)?).map_err(|error| format!("{error:#}"))
}

fn count(plan: &Plan, suite: Suite) -> u64 {
    let of_suite = plan.0.iter().filter(|part| part.suite == suite);
    of_suite.map(|part| part.count).sum()
}

/// At least as many as the project has set itself for a scored batch.
#[test]
fn a_scored_batch_is_as_large_as_promised() {
    let whole = plan("").unwrap();
    assert!(whole.is_whole());
    for (suite, least) in [
        (Suite::Clean, 300),
        (Suite::Singles, 300),
        (Suite::Withheld, 150),
        (Suite::Unknown, 100),
        (Suite::Pairs, 100),
    ] {
        assert!(count(&whole, suite) >= least, "{}", suite.name());
    }
    for suite in Suite::ALL {
        assert!(count(&whole, suite) > 0, "{} is not tried", suite.name());
    }
    assert!(plan("--seed commit").unwrap().is_whole());
    for part in [
        "--share 0.5",
        "--first 1",
        "--suite s0",
        "--quick",
        "--count 5",
    ] {
        assert!(!plan(part).unwrap().is_whole(), "{part}");
    }
}

#[test]
fn trials_are_those_asked_for() {
    let two = plan("--suite s4,s1n --first 17 --count 2").unwrap();
    let expected = [
        (Suite::NearSingles, 17),
        (Suite::NearSingles, 18),
        (Suite::Pairs, 17),
        (Suite::Pairs, 18),
    ];
    assert_eq!(two.trials(), expected);
    assert_eq!(two.words(), "s1n 2, s4 2");
    let whole = plan("").unwrap();
    let half = plan("--share 0.5").unwrap();
    assert_eq!(2 * count(&half, Suite::Clean), count(&whole, Suite::Clean));
    let tiny = plan("--share 0.001").unwrap();
    assert!(tiny.0.iter().all(|part| part.count == 1));
}

/// Every kind of clean recording and a third of the strong effects come up in a quick check, and every suite.
#[test]
fn a_quick_check_meets_every_kind() {
    let quick = plan("--quick").unwrap();
    assert_eq!(count(&quick, Suite::Clean) % 6, 0);
    let singles = xtask_blind::KINDS
        .iter()
        .filter(|kind| kind.group == xtask_blind::Group::Single);
    assert!(3 * count(&quick, Suite::Singles) >= singles.count() as u64);
    assert!(quick.0.iter().all(|part| part.count > 0));
    assert_eq!(quick.0.len(), plan("").unwrap().0.len());
}

#[test]
fn what_cannot_be_done_is_refused() {
    for (words, said) in [
        ("--suite s1,s11", "s10"),
        ("--suite s1,s1", "twice"),
        ("--count 0", "nothing to try"),
        ("--share 0", "--share"),
        ("--share 1.5", "--share"),
        ("--share NaN", "--share"),
        ("--first 18446744073709551615 --count 2", "--first"),
        ("--quick --count 3", "--quick"),
        ("--quick --record", "--record"),
        ("--seed yesterday", "neither a number nor `commit`"),
        ("--seed -1", "-1"),
    ] {
        let error = plan(words).expect_err(words);
        assert!(error.contains(said), "{words}: {error}");
    }
}

#[test]
fn a_seed_is_a_number_or_the_commit() {
    assert_eq!("4294967295".parse(), Ok(SeedRule::Number(4_294_967_295)));
    assert_eq!("commit".parse(), Ok(SeedRule::Commit));
    assert!("0x1f".parse::<SeedRule>().is_err());
}
