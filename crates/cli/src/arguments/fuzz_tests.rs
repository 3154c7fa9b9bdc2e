//! Fuzz target of the command line: any words are parsed, or refused with a next step.

use std::time::Duration;

use clap::Parser;

use super::{Arguments, failure_of};

/// Words that a command line is made of, and others.
const WORDS: [&str; 49] = [
    "identify",
    "diagnose",
    "simulate",
    "check",
    "init",
    "export",
    "play",
    "verify",
    "completions",
    "help",
    "--device",
    "--log",
    "--out",
    "--json",
    "--method",
    "--held-out",
    "--degree",
    "--noise",
    "--input-drum-denominator-m",
    "--paper-preset",
    "--model",
    "--validate",
    "--without",
    "--force",
    "--truth",
    "--effects",
    "--seconds",
    "--rate-hz",
    "--seed",
    "--every",
    "--format",
    "-h",
    "-V",
    "--",
    "-",
    "=",
    "bash",
    "joint",
    "evidence",
    "device.toml",
    "log.csv",
    "backlash",
    "0",
    "-1",
    "nan",
    "1e999",
    "99999999999999999999",
    "",
    "\u{e9}\u{202e}\n",
];

#[test]
fn command_lines() {
    let seconds = std::env::var("HAPTICAL_FUZZ_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok());
    let check = bolero::check!();
    let check = match seconds {
        Some(seconds) => check.with_test_time(Duration::from_secs(seconds)),
        None => check.with_iterations(500),
    };
    check
        .with_type::<(u8, Vec<(u8, bool, u8)>)>()
        .for_each(|(command, picks)| {
            let word = |pick: u8| WORDS[usize::from(pick) % WORDS.len()];
            let mut words = vec!["haptical".to_owned(), word(command % 10).to_owned()];
            for (pick, is_joined, value) in picks.iter().take(12) {
                words.push(if *is_joined {
                    format!("{}={}", word(*pick), word(*value))
                } else {
                    word(*pick).to_owned()
                });
            }
            if let Err(error) = Arguments::try_parse_from(&words)
                && error.use_stderr()
            {
                let refused = failure_of(&error);
                let file = refused.place().file.as_str();
                let parts = [refused.what(), file, refused.next_step()];
                let has_all = parts.iter().all(|part| !part.trim().is_empty());
                assert!(has_all, "{words:?}\n{error}");
            }
        });
}
