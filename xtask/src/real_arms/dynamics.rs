//! What `identify --with dynamics` leaves of the torques of recordings that it was not fitted to, beside what others found.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};
use serde::Deserialize;
use serde_json::Value;
use xtask_output::{read_json, read_text, said};

use super::Arguments;
use super::sets::HERE;

/// Lines between which the table is.
pub(super) const BEGIN: &str = "<!-- table: cargo xtask real-arms, dynamics -->\n";
pub(super) const END: &str = "<!-- end of table, dynamics -->\n";

const HEAD: &str = "| recording | band | not fitted: `haptical`, joint by joint | all | delay, 95 % interval | seconds | reference, and its band | published |\n\
     | --- | --- | --- | --- | --- | --- | --- | --- |\n";

#[derive(Debug, Deserialize)]
struct Recordings {
    recording: Vec<Motion>,
}

/// A recording that is fitted, and one that is predicted.
#[derive(Debug, Deserialize)]
struct Motion {
    name: String,
    /// Description of the device and logs, with `{shared}`, `{fetched}` and `{here}`.
    device: String,
    fitted: String,
    unseen: String,
    /// Edge of the band \[Hz\]; none where it is for the log to say.
    band_hz: Option<f64>,
    /// Figures of a plain reference, and published ones.
    reference: String,
    published: String,
}

/// The table, a line for each recording that is asked for.
pub(super) fn table(program: &Path, folders: &Arguments) -> Result<String> {
    let path = Path::new(HERE).join("dynamics.toml");
    let all: Recordings = toml::from_str(&read_text(&path)?)?;
    let mut table = HEAD.to_owned();
    for motion in all.recording.iter().filter(|own| folders.wants(&own.name)) {
        let line = match motion.answer(program, folders)? {
            Ok((result, seconds)) => motion.line(&result, seconds),
            Err(missing) => {
                println!("{}: not run, no {}", motion.name, missing.display());
                format!(
                    "| {} | | not run: its data are not here | | | | {} | {} |\n",
                    motion.name, motion.reference, motion.published
                )
            }
        };
        print!("{line}");
        table.push_str(&line);
    }
    Ok(table)
}

impl Motion {
    /// identified.json with the seconds that it took, or the file that is missing.
    fn answer(&self, program: &Path, folders: &Arguments) -> Result<Result<(Value, f64), PathBuf>> {
        let place = |text: &str| folders.place(text);
        let [device, fitted, unseen] =
            [&self.device, &self.fitted, &self.unseen].map(|own| place(own));
        for file in [&device, &fitted, &unseen] {
            if !Path::new(file).exists() {
                return Ok(Err(file.into()));
            }
        }
        let out = folders.out.join("dynamics");
        std::fs::create_dir_all(&out)?;
        let mut command = Command::new(program);
        command
            .args(["identify", "--with", "dynamics", "--device", &device])
            .args(["--log", &fitted, "--validate", &unseen, "--force", "--out"])
            .arg(&out);
        if let Some(band_hz) = self.band_hz {
            command.args(["--band-hz", &band_hz.to_string()]);
        }
        let start = Instant::now();
        said(&mut command).with_context(|| self.name.clone())?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Ok((read_json(&out.join("identified.json"))?, seconds)))
    }

    fn line(&self, result: &Value, seconds: f64) -> String {
        let torques = result["torques_validate"].as_array().into_iter().flatten();
        let percent = |own: &Value| {
            own["percent"]["after"]
                .as_f64()
                .map(|own| format!("{own:.1}"))
        };
        let each: Vec<String> = torques.filter_map(percent).collect();
        let whole = result["stacked_percent_validate"]["after"].as_f64();
        let whole = whole.map_or("-".to_owned(), |own| format!("{own:.1}"));
        let delay = &result["torque_delay_s"];
        let ms = |own: &Value| 1e3 * own.as_f64().unwrap_or(f64::NAN);
        let ends = &delay["ci95"];
        let whose = if self.band_hz.is_none() {
            " (its own)"
        } else {
            ""
        };
        format!(
            "| {} | {} Hz{whose} | {} | {whole} | {:.1} [{:.1}, {:.1}] ms | {seconds:.1} | {} | {} |\n",
            self.name,
            result["band_hz"],
            each.join(" / "),
            ms(&delay["value"]),
            ms(&ends[0]),
            ms(&ends[1]),
            self.reference,
            self.published
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_unseen_figures_and_not_those_of_the_fit() {
        let motion = Motion {
            name: "arm".to_owned(),
            device: String::new(),
            fitted: String::new(),
            unseen: String::new(),
            band_hz: None,
            reference: "3".to_owned(),
            published: "-".to_owned(),
        };
        let of = |after: f64| serde_json::json!([{"percent": {"before": 50.0, "after": after, "base": 0.5}}]);
        let result = serde_json::json!({
            "band_hz": 8.0, "torques": of(1.0), "torques_validate": of(7.25), "stacked_percent": {"after": 1.0},
            "stacked_percent_validate": {"after": 7.5}, "torque_delay_s": {"value": 0.001, "ci95": [-0.002, 0.004]},
        });
        let wanted = "| arm | 8.0 Hz (its own) | 7.2 | 7.5 | 1.0 [-2.0, 4.0] ms | 0.2 | 3 | - |\n";
        assert_eq!(motion.line(&result, 0.2), wanted);
    }

    #[test]
    fn the_list_of_recordings_is_read() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/real-arms/dynamics.toml");
        let all: Recordings = toml::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        assert!(all.recording.len() > 3);
    }
}
