//! The choice in the words of what torques are examined for.

use super::choose::Chosen;
use super::fit::Fitted;
use super::rows::{JointRows, Rows};
use super::terms::{Term, half_play, yielded};
use crate::effect::delay::ENCODER_LATENCY;
use crate::examined::{ChannelFit, Examined, Finding, NearRival};
use haptical_linalg::dot;

use crate::thresholds::between::{FAR_RIVAL_NATS, HARDENING_SD, SURE_YIELD_SDS};

pub(super) fn examined(rows: &Rows, chosen: &Chosen) -> Examined {
    let mut channels = Vec::new();
    let mut findings = Vec::new();
    let (mut before_nats, mut after_nats) = (0.0, 0.0);
    for (at, own) in rows.joints.iter().enumerate() {
        let (bare, fitted) = (&chosen.bare[at], &chosen.fitted[at]);
        let rms = |rest: &[f64]| rms(rest, &fitted.weights);
        let [before, after] = [rms(&bare.rest), rms(&fitted.rest)];
        let energy = |rms: f64| 0.5 * own.count() as f64 * ((rms / own.noise).powi(2) - 1.0);
        before_nats += energy(before);
        after_nats += energy(after);
        channels.push(ChannelFit {
            joint: own.joint,
            rms_before: before,
            rms_after: after,
            noise: own.noise,
            scale: None,
            before: bare.rest.clone(),
            after: fitted.rest.clone(),
            depends_on: Vec::new(),
            share_of_posture: 0.0,
            share_of_friction: [0.0; 2],
        });
        if !chosen.nats[at].is_empty() {
            findings.extend(of_joint(own, fitted, (chosen, at)));
        }
    }
    findings.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    Examined {
        channels,
        findings,
        before_nats,
        after_nats,
        freedom: rows.joints.iter().map(|own| own.count() as f64).sum(),
        edge_hz: rows.edge_hz,
        numbers: rows.joints.len(),
        tried: chosen.tried,
        jitter: rows.jitter,
        time_s: rows.time_s.clone(),
        ..Examined::default()
    }
}

/// Root mean square of rows with weights.
pub(super) fn rms(rest: &[f64], weights: &[f64]) -> f64 {
    let square: f64 = rest
        .iter()
        .zip(weights)
        .map(|(own, weight)| weight * own * own)
        .sum();
    (square / weights.iter().sum::<f64>().max(1e-300)).sqrt()
}

/// A delay as a finding: a reading is late, never early, so that its sign says which one it is. One that all share is told of each
/// encoder on a link, or once of all motors' encoders.
fn delayed(
    rows: &JointRows,
    (delay_s, sd): (f64, f64),
    (chosen, [at, index]): (&Chosen, [usize; 2]),
) -> Option<Finding> {
    let is_shared = chosen.shared_s.is_some();
    let is_of_motors = delay_s < 0.0;
    if is_of_motors && is_shared && at > 0 {
        return None;
    }
    // a gear that lags in proportion to its speed has the same column
    let lag = (!is_shared && !is_of_motors).then_some(NearRival {
        effect: "viscous-lag",
        joint: Some(rows.joint),
        behind_nats: 0.0,
        share: 1.0,
    });
    Some(Finding {
        effect: if is_of_motors {
            ENCODER_LATENCY.name
        } else {
            Term::Delay.name()
        },
        joint: Some(rows.joint).filter(|_| !(is_of_motors && is_shared)),
        nats: chosen.nats[at][index],
        numbers: vec![("delay_s", delay_s.abs(), sd)],
        rivals: lag.into_iter().collect(),
        is_told: true,
        change: None,
    })
}

fn of_joint(rows: &JointRows, fitted: &Fitted, (chosen, at): (&Chosen, usize)) -> Vec<Finding> {
    let mut first = 0;
    let mut found = Vec::new();
    for (index, term) in fitted.terms.iter().enumerate() {
        let own = first;
        let value = |k: usize| fitted.coefficients[own + k];
        let sd = |k: usize| fitted.covariance[(own + k, own + k)].max(0.0).sqrt();
        let stiffness = |k: usize| {
            let relative = sd(k) / value(k);
            (
                "stiffness_nm_per_rad",
                1.0 / value(k),
                relative.abs() / value(k).abs(),
            )
        };
        let numbers = match term {
            Term::Shape => {
                first += 3;
                continue;
            }
            Term::Delay => {
                first += 1;
                let (delay_s, sd) = chosen.shared_s.unwrap_or((value(0), sd(0)));
                found.extend(delayed(rows, (delay_s, sd), (chosen, [at, index])));
                continue;
            }
            Term::Spring => {
                first += 1;
                vec![stiffness(0)]
            }
            Term::Hardening { share, load_nm } => {
                first += 1;
                let at_rest = 1.0 / value(0);
                // tau = k x (1 + c x^2)
                let per_rad2 = share * (at_rest / load_nm).powi(2);
                let whole = rows.of_load(|load| yielded(load, *share, *load_nm) / at_rest);
                let secant = dot(&rows.load, &rows.load) / dot(&rows.load, &whole);
                let secant_sd = sd(0) / value(0) * secant;
                vec![
                    stiffness(0),
                    ("hardening_per_rad2", per_rad2, HARDENING_SD * per_rad2),
                    ("secant_stiffness_nm_per_rad", secant, secant_sd),
                ]
            }
            Term::Play { flight_nm, yields } => {
                first += term.columns_count();
                let beyond = if *yields { value(1) } else { 0.0 };
                let half_rad = half_play(value(0), beyond, *flight_nm);
                let is_sure = *yields && beyond > SURE_YIELD_SDS * sd(1);
                let mut numbers = vec![("width_rad", 2.0 * half_rad, 2.0 * sd(0))];
                numbers.extend(is_sure.then(|| stiffness(1)));
                numbers
            }
        };
        let near = chosen.rivals[at][index]
            .iter()
            .filter(|own| own.behind < FAR_RIVAL_NATS);
        let rivals = near.map(|rival| NearRival {
            effect: rival.name.0.name(),
            joint: Some(rows.joint),
            behind_nats: rival.behind,
            share: 1.0 - rival.behind / chosen.nats[at][index].max(1e-300),
        });
        found.push(Finding {
            effect: term.name(),
            joint: Some(rows.joint),
            nats: chosen.nats[at][index],
            numbers,
            rivals: rivals.collect(),
            is_told: true,
            change: None,
        });
    }
    found
}
