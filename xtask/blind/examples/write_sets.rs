//! Writes trials of a suite to folders: `--suite s1 --count 40 --seed 7 --out DIR [--first N]`.

use std::error::Error;
use std::path::PathBuf;

use xtask_blind::{Suite, write_moving, write_trial};

/// The value after a flag.
fn flag(name: &str) -> Option<String> {
    let mut words = std::env::args().skip_while(|word| word != name);
    words.nth(1)
}

fn main() -> Result<(), Box<dyn Error>> {
    let number = |name: &str, default: u64| -> Result<u64, Box<dyn Error>> {
        Ok(flag(name).map_or(Ok(default), |text| text.parse())?)
    };
    let suite = Suite::named(&flag("--suite").unwrap_or_else(|| "s1".to_owned()))?;
    let (first, count) = (number("--first", 0)?, number("--count", 8)?);
    let seed = number("--seed", 1)?;
    let out = PathBuf::from(flag("--out").unwrap_or_else(|| "target/blind".to_owned()));
    for index in first..first + count {
        if suite == Suite::Moving {
            write_moving(index, seed, &out)?;
            continue;
        }
        let trial = suite.draw(index, seed)?;
        let folder = out.join(format!("{index:03}-{}", trial.truth.name));
        write_trial(&trial, &folder, true)?;
    }
    Ok(())
}
