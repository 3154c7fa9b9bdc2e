//! `haptical` alone: what can be done with the files of the folder.

mod found;

use std::path::Path;

use haptical::files::shell_word;
use serde::Serialize;

use self::found::{Found, FoundLog};
use crate::failure::Failure;
use crate::terminal;

/// What is said of a folder that has neither a device nor a log.
const BEGIN: &str = "\
No device and no log in this folder. To begin:
  haptical init demo --example gap        two recordings with a gap to find
  haptical init demo                      a template for a device of your own, and a log
  haptical init demo --example urdf-arm   an arm described by a URDF, and a tracker
  haptical init demo --example moving-arm positions and torques of an arm, which carries something
  haptical init demo --example data-set   ten episodes in LeRobot's format: which can be used?
";
const END: &str = "\nAll commands: haptical --help\n";

/// A command, and what it is for.
#[derive(Debug, Serialize)]
struct Step {
    what: &'static str,
    command: String,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Said<'f> {
    #[serde(flatten)]
    found: &'f Found,
    next: &'f [Step],
}

/// Says what can be done next in the folder in which the command runs.
pub(crate) fn run(json: bool) -> Result<(), Failure> {
    let found = Found::in_folder(Path::new("."));
    let next = steps(&found);
    let said = Said {
        found: &found,
        next: &next,
    };
    terminal::tell(json, &said, text(&found, &next))
}

fn text(found: &Found, steps: &[Step]) -> String {
    let mut text = String::new();
    if steps.is_empty() {
        text.push_str(BEGIN);
    } else {
        text.push_str("In this folder:\n");
        let logs: Vec<&str> = found.logs.iter().map(|log| log.name.as_str()).collect();
        let names = |names: &[String]| names.join(", ");
        let mut line = |what: &str, names: &str| {
            if !names.is_empty() {
                text.push_str(&format!("  {what:<8} {names}\n"));
            }
        };
        line("device", &names(&found.devices));
        line("rig", &names(&found.rigs));
        line("log", &logs.join(", "));
        line("data set", &names(&found.data_sets));
        line("table", &names(&found.tables));
        line("fit", &names(&found.fits));
        let gaps = found.gaps.iter();
        let gaps: Vec<String> = gaps
            .map(|gap| format!("{} ({})", gap.folder, gap.verdict))
            .collect();
        line("gap", &names(&gaps));
        text.push_str("\nNext:\n");
        for step in steps {
            text.push_str(&format!("  {}\n      {}\n", step.what, step.command));
        }
    }
    text.push_str(END);
    text
}

fn steps(found: &Found) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut step = |what, command| steps.push(Step { what, command });
    let device = chosen(&found.devices);
    if let Some(data_set) = chosen(&found.data_sets) {
        step(
            "See which joints and episodes of the data set are sound",
            format!("haptical doctor {} --out doctor", shell_word(data_set)),
        );
    }
    if let (None, Some(table)) = (found.logs.first(), chosen(&found.tables)) {
        step(
            "Make a log of a table of another maker",
            format!("haptical import --guess {}", shell_word(table)),
        );
    }
    match (device, found.logs.first()) {
        (Some(device), Some(log)) => of_pair(found, device, log, &mut step),
        (Some(device), None) => {
            step(
                "Choose the poses to record",
                format!(
                    "haptical plan --device {} --poses 60 --out plan",
                    shell_word(device)
                ),
            );
        }
        (None, Some(log)) => {
            let path = if found.logs.len() > 1 { "." } else { &log.name };
            step(
                "Without a device: see which joints and recordings are sound",
                format!("haptical doctor {} --out doctor", shell_word(path)),
            );
            step(
                "Describe the device: put its URDF or MJCF here, or change this template",
                "haptical init template".to_owned(),
            );
        }
        (None, None) => {}
    }
    steps
}

/// The steps of a device and its log.
fn of_pair(
    found: &Found,
    device: &str,
    log: &FoundLog,
    step: &mut impl FnMut(&'static str, String),
) {
    let rig =
        chosen(&found.rigs).map_or_else(String::new, |rig| format!(" --rig {}", shell_word(rig)));
    let (device, name) = (shell_word(device), shell_word(&log.name));
    let second = found.logs.get(1);
    let second = second.map_or_else(String::new, |log| {
        format!(" --validate {}", shell_word(&log.name))
    });
    if found.fits.is_empty() && found.gaps.is_empty() {
        step(
            "See what the log could identify",
            format!("haptical check {device} {name}{rig}"),
        );
    }
    if found.fits.is_empty() && log.has_references {
        step(
            "Calibrate",
            format!("haptical identify --device {device}{rig} --log {name} --out fit"),
        );
    }
    if found.gaps.is_empty() && (log.has_references || log.has_drives) {
        step(
            "Find what is still wrong, and its cause",
            format!("haptical diagnose --device {device}{rig} --log {name}{second} --out gap"),
        );
    }
    let mut settled = None;
    for gap in &found.gaps {
        let folder = shell_word(&gap.folder);
        if gap.verdict == "named" && gap.has_model {
            settled = Some(format!("{folder}/corrected.toml"));
        }
        if gap.is_open {
            step(
                "Choose the recording that tells the candidates apart",
                format!(
                    "haptical plan --device {device}{rig} --settle {folder}/gap.json --log {name} --out next"
                ),
            );
        }
    }
    let fit = chosen(&found.fits).map(|folder| format!("{}/identified.toml", shell_word(folder)));
    if let Some(model) = settled.or(fit) {
        step(
            "Put it into a simulator, or a controller",
            format!("haptical export --device {model} --format mjcf --out model.xml"),
        );
        step(
            "Compute a result again, and compare",
            "haptical verify .".to_owned(),
        );
    }
}

/// The first of some names.
fn chosen(names: &[String]) -> Option<&str> {
    names.first().map(String::as_str)
}
