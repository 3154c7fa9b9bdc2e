//! Development probe: `probe FOLDER...`, each with device.toml, log.csv.gz, truth.json.
#![allow(clippy::print_stdout, reason = "example")]
use haptical_data::{JointShape, LogShape, read_log};
use haptical_diagnosis::{Options, diagnose};
use haptical_model::{Device, JointType};
use std::path::Path;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let verbose = args.iter().any(|a| a == "-v");
    for folder in args[1..].iter().filter(|a| !a.starts_with('-')) {
        let folder = Path::new(folder);
        let mut path = folder.join("device.toml");
        if !path.exists() {
            path = "/work/shared/devices/haptic7.toml".into();
        }
        let text = std::fs::read_to_string(&path)?;
        let device = Device::from_toml(&text, "d")?.device;
        let shape = LogShape {
            joints: device
                .joints
                .iter()
                .map(|j| JointShape {
                    name: j.name.clone(),
                    prismatic: j.joint_type == JointType::Prismatic,
                    lower: j.lower_rad,
                    upper: j.upper_rad,
                })
                .collect(),
            cable_count: device.cables.len().max(usize::from(device.has_links())),
        };
        let recording = read_log(&folder.join("log.csv.gz"), &shape)?.recording;
        let truth: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json"))?)?;
        let without: Vec<String> = truth["without"]
            .as_array()
            .map(|v| {
                v.iter()
                    .filter_map(|x| x.as_str().map(str::to_owned))
                    .collect()
            })
            .unwrap_or_default();
        let t0 = std::time::Instant::now();
        let answer = match diagnose(
            &device,
            &recording,
            &Options {
                without,
                ..Options::default()
            },
        ) {
            Ok(answer) => answer,
            Err(error) => {
                println!("{} ERROR {error}", folder.display());
                continue;
            }
        };
        let causes: Vec<String> = answer
            .causes
            .iter()
            .map(|c| {
                format!(
                    "{}@{} p{:.2} conf{:?} {} {:?}",
                    c.effect,
                    c.joint.unwrap_or(0),
                    c.probability,
                    c.confusable_with,
                    if c.plausible { "" } else { "IMPL" },
                    c.parameters
                        .iter()
                        .map(|(k, v)| format!(
                            "{k}={:.3e}[{:.3e},{:.3e}]",
                            v.value, v.ci95[0], v.ci95[1]
                        ))
                        .collect::<Vec<_>>()
                )
            })
            .collect();
        let right: Vec<Vec<String>> = serde_json::from_value(truth["right"].clone())?;
        let answered: Vec<String> = answer
            .causes
            .iter()
            .flat_map(|c| std::iter::once(c.effect.clone()).chain(c.confusable_with.clone()))
            .chain(
                (answer.verdict == haptical_diagnosis::Verdict::Unknown)
                    .then(|| "unknown".to_owned()),
            )
            .collect();
        let clean = right.is_empty();
        let ok = if clean {
            answer.verdict == haptical_diagnosis::Verdict::NoGap
        } else {
            right.iter().all(|g| g.iter().any(|n| answered.contains(n)))
                && (right[0][0] == "unknown"
                    || answer.verdict != haptical_diagnosis::Verdict::Unknown)
        };
        println!(
            "{} {} [{} j{}] {:?} U={:.4} {:.0}ms {}",
            if ok { "ok " } else { "BAD" },
            folder.file_name().unwrap_or_default().to_string_lossy(),
            truth["device"].as_str().unwrap_or(""),
            truth["joint"],
            answer.verdict,
            answer.unexplained_share,
            t0.elapsed().as_secs_f64() * 1e3,
            causes.join(" | ")
        );
        if verbose || !ok {
            println!("      {:?}", answer.warnings);
            for c in answer.candidates.iter().take(5) {
                println!(
                    "      cand {}@{} share {:.3} nats {:.1} p {:.3}",
                    c.effect,
                    c.joint.unwrap_or(0),
                    c.share,
                    c.nats_behind,
                    c.probability
                );
            }
            if verbose {
                for n in &answer.noise {
                    println!("      {n:?}");
                }
            }
        }
    }
    Ok(())
}
