//! A request for a plan as the flags of the command, as results record them.

use haptical_design::{Limits, Region, Request, Spread, Terms};

/// Flags as `--flag=value`, defaults included; files are not among them.
pub(super) fn from_request(request: &Request) -> Vec<String> {
    let Limits {
        spread,
        workspace_m,
        cable_m,
        link_radius_m,
    } = &request.limits;
    let rigs = request.rigs.iter();
    let mut flags: Vec<String> = rigs.map(|rig| format!("--measure={}", rig.name)).collect();
    if request.chooses {
        flags.push(format!("--poses={}", request.poses));
    }
    let criterion = serde_json::to_value(request.criterion).unwrap_or_default();
    let criterion = criterion.as_str().unwrap_or_default();
    flags.push(format!("--criterion={criterion}"));
    flags.extend(region(&request.region));
    flags.push(format!("--candidates={}", request.candidates));
    flags.push(format!("--seed={}", request.seed));
    let spread = match spread {
        Spread::Uniform => "uniform",
        Spread::Normal => "normal",
    };
    flags.push(format!("--spread={spread}"));
    let sides = workspace_m.as_ref();
    flags.extend(sides.map(|sides| format!("--workspace={}", list(sides.as_flattened()))));
    if *cable_m != Limits::default().cable_m {
        flags.push(format!("--cable-length={}", list(cable_m)));
    }
    flags.extend(link_radius_m.map(|radius| format!("--link-radius={radius}")));
    if request.terms == Terms::Known {
        flags.push("--known-transmissions".to_owned());
    }
    flags
}

fn list(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(",")
}

fn region(region: &Region) -> Option<String> {
    let words = match region {
        Region::Everywhere => return None,
        Region::Ball {
            centre_m: [x, y, z],
            radius_m,
        } => list(&[*x, *y, *z, *radius_m]),
        Region::Joints(ranges) => {
            let range = |[low, high]: &[f64; 2]| format!("{low}:{high}");
            ranges.iter().map(range).collect::<Vec<_>>().join(",")
        }
    };
    Some(format!("--region={words}"))
}
