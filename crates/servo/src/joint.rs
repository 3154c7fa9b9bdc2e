//! One joint from its log to an answer.

use haptical_judge::{Closed, Evidence, closed_share, verdict};
use haptical_linalg::jackknife_sd;

use crate::answer::{Course, Finding, JointAnswer, Number, Verdict};
use crate::change::{self, Change};
use crate::effect::{friction, gain, lag, latency, offset, saturation};
use crate::log::{JointLog, Series, Untested, range, rms};
use crate::next::next;
use crate::noise::{floor, rounding};
use crate::predict::Model;
use crate::select::{Judged, Law, Selection, parts, select};
use crate::thresholds::{
    ABOVE_FLOOR, ALL_CLOSED, AS_GOOD, CLOSED, DROOP_GAIN, LAW_SHARE, OFFSET_COUNTS, REFUSED,
    REFUSED_AT_NOISE, RESOLUTION, WIDE_RAD,
};

/// Says how a joint answers its command, and what of that changed within the log.
///
/// # Errors
/// [`Untested`] where the log cannot say.
pub fn diagnose_joint(log: &JointLog<'_>) -> Result<JointAnswer, Untested> {
    let mut series = Series::new(log)?;
    if !series.moves() {
        let changes = change::of_a_still_joint(&series);
        return match changes.is_empty() {
            true => Err(Untested::Still),
            false => Ok(still(&series, &changes)),
        };
    }
    let bare = errors(&series);
    let changes = change::find(&series);
    for change in &changes {
        change.undo(&mut series);
    }
    // a change may be what a position does not follow its command for
    series.check_related()?;
    let selection = select(&series);
    Ok(Joint {
        series: &series,
        selection: &selection,
        changes,
        bare,
    }
    .answer())
}

/// Why the log of a joint cannot say how it answers its command, without a fit of its laws; none where it can.
///
/// ```
/// use haptical_servo::{JointLog, Untested, untested};
///
/// let log = JointLog { response: &[0.1, 0.2], ..JointLog::default() };
/// assert_eq!(untested(&log), Some(Untested::NoCommand));
/// ```
pub fn untested(log: &JointLog<'_>) -> Option<Untested> {
    let mut series = match Series::new(log) {
        Ok(series) => series,
        Err(why) => return Some(why),
    };
    if !series.moves() {
        let is_still = change::of_a_still_joint(&series).is_empty();
        return is_still.then_some(Untested::Still);
    }
    for change in &change::find(&series) {
        change.undo(&mut series);
    }
    series.check_related().err()
}

fn errors(series: &Series) -> Vec<f64> {
    let pairs = series.response.iter().zip(&series.command);
    pairs
        .map(|(response, command)| response - command)
        .collect()
}

/// The answer of a joint whose command stands, but which does not.
fn still(series: &Series, changes: &[Change]) -> JointAnswer {
    let before = errors(series);
    let mut calm = series.clone();
    for change in changes {
        change.undo(&mut calm);
    }
    let middle = crate::log::mean(&errors(&calm));
    let after: Vec<f64> = errors(&calm).iter().map(|error| error - middle).collect();
    let sizes = [&before, &after].map(|values| rms(values));
    let share = 1.0 - (sizes[1] / sizes[0].max(1e-300)).powi(2);
    JointAnswer {
        verdict: Verdict::Named,
        causes: changes.iter().map(|own| own.finding(share)).collect(),
        rms_before: sizes[0],
        rms_after: sizes[1],
        noise_floor: floor(series),
        closed: share,
        closed_ci95: [share, share],
        course: course(series, before, after),
        next: Some("move the joint: at rest an offset is all that a change can show".to_owned()),
        warnings: series.warnings.clone(),
        tried: 1,
        model: None,
    }
}

/// The verdict on causes that close a share of the gap on unseen rows: of what changed within the log unseen rows show little.
pub(crate) fn judged(has_gap: bool, closed: f64, causes: &[Finding]) -> Verdict {
    verdict(Evidence {
        has_gap,
        is_supported: closed >= CLOSED || causes.iter().any(|cause| cause.since.is_some()),
        probability: causes.first().map(Finding::probability),
    })
}

fn course(series: &Series, before: Vec<f64>, after: Vec<f64>) -> Course {
    Course {
        row: series.row.clone(),
        time_s: series.time_s.clone(),
        before,
        after,
    }
}

struct Joint<'s> {
    series: &'s Series,
    selection: &'s Selection,
    changes: Vec<Change>,
    /// Position less command, as recorded.
    bare: Vec<f64>,
}

impl Joint<'_> {
    fn answer(self) -> JointAnswer {
        let chosen = &self.selection.chosen;
        let rows = self.series.len() as f64;
        let floor = floor(self.series);
        // what neighbours scatter by is partly motion: no more of it is noise than the causes leave
        let floor = floor.min(
            (chosen.unseen_squares() / rows)
                .sqrt()
                .max(rounding(self.series)),
        );
        let before = rms(&self.bare);
        let after = (chosen.unseen_squares() / rows).sqrt();
        let total = (self.bare.iter().map(|e| e * e).sum::<f64>()).max(1e-300);
        let is_gap = before > ABOVE_FLOOR * floor || !self.changes.is_empty();
        let Closed {
            share: closed,
            ci95: closed_ci95,
        } = self.closed(floor);
        let laws: f64 = self.selection.before.iter().sum::<f64>() / total;
        let has_converged = chosen.has_converged();
        let mut causes = match has_converged {
            true => self.laws(closed),
            false => Vec::new(),
        };
        for cause in &mut causes {
            cause.share *= laws;
        }
        causes.sort_by(|a, b| b.share.total_cmp(&a.share));
        let share = (1.0 - laws).max(0.0) / self.changes.len().max(1) as f64;
        let changes = self.changes.iter().map(|change| change.finding(share));
        let causes: Vec<Finding> = changes.chain(causes).collect();
        let verdict = judged(is_gap, closed, &causes);
        let mut warnings = self.series.warnings.clone();
        warnings.extend((!has_converged).then(|| NOT_CONVERGED.to_owned()));
        warnings.extend(self.selection.fitted_rows.map(|fitted| {
            let rows = self.series.len();
            format!("the servo's laws were fitted to {fitted} of {rows} rows, in stretches over the log; what they leave is that of all rows")
        }));
        JointAnswer {
            next: next(verdict, &causes, closed),
            causes: if is_gap { causes } else { Vec::new() },
            verdict,
            rms_before: before,
            rms_after: after,
            noise_floor: floor,
            closed,
            closed_ci95,
            warnings,
            tried: Law::ALL.len() + 4,
            model: has_converged
                .then(|| Model::new(self.series, chosen.terms, &chosen.fit, &self.changes)),
            course: course(self.series, self.bare, chosen.fit.residual.clone()),
        }
    }

    /// Share of the squares beyond noise that close on unseen rows, and its interval.
    fn closed(&self, floor: f64) -> Closed {
        let unseen = &self.selection.chosen.unseen;
        let rows = self.bare.len();
        let squares = parts(rows).map(|part| self.bare[part].iter().map(|e| e * e).sum());
        let squares: Vec<f64> = squares.collect();
        let closed = closed_share(&squares, unseen, floor * floor * rows as f64);
        Closed {
            share: closed.share.max(0.0),
            ci95: closed.ci95.map(|end| end.max(0.0)),
        }
    }

    /// The laws that are missed, with their numbers and rivals.
    fn laws(&self, closed: f64) -> Vec<Finding> {
        let chosen = &self.selection.chosen;
        let total: f64 = self.selection.before.iter().sum::<f64>().max(1e-300);
        let kept = self.selection.kept.iter();
        kept.filter_map(|&(law, gained)| {
            let (effect, numbers, confusable_with) = match law {
                Law::Offset => self.offset()?,
                Law::Timing => self.timing(closed),
                Law::Friction => (
                    friction::NAME,
                    vec![number("width_rad", chosen, |fit| {
                        2.0 * fit.shape.half_width
                    })],
                    vec![friction::DEAD_ZONE, friction::BACKLASH],
                ),
                Law::Saturation => (saturation::NAME, vec![self.limit()], vec![lag::NAME]),
                Law::Gain => self.gain(),
                Law::Droop => self.droop(),
            };
            Some(Finding {
                effect,
                numbers,
                confusable_with,
                share: (gained / total).clamp(0.0, 1.0),
                since: None,
            })
        })
        .collect()
    }

    fn offset(&self) -> Option<Named> {
        let chosen = &self.selection.chosen;
        let own = number("offset_rad", chosen, |fit| fit.offset);
        let is_nothing =
            own.value.abs() < OFFSET_COUNTS * self.series.count || own.ci95[0] * own.ci95[1] <= 0.0;
        if is_nothing {
            return None;
        }
        let columns = std::iter::once(&self.series.command).chain(&self.series.others);
        let widest = columns.map(|column| range(column)).fold(0.0, f64::max);
        let has_droop = Law::Droop.is_in(chosen.terms);
        let is_wide = widest > WIDE_RAD && !has_droop;
        let rivals = match is_wide || self.series.load_nm.is_some() {
            // gravity's torque would have varied, and no droop that follows it is missed
            true => Vec::new(),
            false => vec![lag::NAME],
        };
        Some((offset::NAME, vec![own], rivals))
    }

    /// Delay or lag: both where neither alone does, or where the laws leave a part of the gap that the other may be. A lag with a mass
    /// answers slow commands as a delay does.
    fn timing(&self, closed: f64) -> Named {
        let chosen = &self.selection.chosen;
        let leaves = |alone: &Judged| alone.unseen_squares() / chosen.unseen_squares().max(1e-300);
        let is_worse = |alone: Option<&Judged>| alone.is_none_or(|alone| leaves(alone) > AS_GOOD);
        let is_surely_worse =
            |alone: Option<&Judged>| alone.is_some_and(|alone| alone.leaves_more(REFUSED, chosen));
        if chosen.terms.inertia {
            return (lag::NAME, heavy(chosen), vec![latency::NAME]);
        }
        let delay = number("delay_s", chosen, |fit| fit.shape.delay_s + fit.shape.lag_s);
        let part = number("lag_s", chosen, |fit| fit.shape.lag_s);
        let [delay_alone, lag_alone, heavy_alone] = [
            &self.selection.delay_alone,
            &self.selection.lag_alone,
            &self.selection.heavy_alone,
        ]
        .map(|own| own.as_ref().filter(|own| own.has_converged()));
        if let Some(alone) = delay_alone.filter(|_| !is_worse(delay_alone))
            && is_surely_worse(lag_alone)
            && closed > ALL_CLOSED
        {
            let delay = number("delay_s", alone, |fit| fit.shape.delay_s);
            let rows = self.series.len() as f64;
            let left = (alone.unseen_squares() / rows).sqrt();
            let than = match left > ABOVE_FLOOR * floor(self.series) {
                true => REFUSED,
                false => REFUSED_AT_NOISE,
            };
            let is_refused = heavy_alone.is_some_and(|heavy| heavy.leaves_more(than, alone));
            let rivals = match is_refused {
                true => Vec::new(),
                false => vec![lag::NAME],
            };
            return (latency::NAME, vec![delay], rivals);
        }
        if let Some(alone) = lag_alone.filter(|_| !is_worse(lag_alone))
            && is_surely_worse(delay_alone)
        {
            let lag = number("lag_s", alone, |fit| fit.shape.lag_s);
            return (lag::NAME, vec![lag], vec![latency::NAME]);
        }
        (latency::NAME, vec![delay, part], vec![lag::NAME])
    }

    /// The limit of the speed, as wide as parts of the log differ and as the laws are wrong: how a drive comes to its limit and leaves it is
    /// not known, and in all parts alike.
    fn limit(&self) -> Number {
        let chosen = &self.selection.chosen;
        let limit = number("limit_rad_per_s", chosen, |fit| {
            1.0 / fit.shape.slowness.max(1e-3)
        });
        let bare: f64 = self.bare.iter().map(|e| e * e).sum();
        let noise = floor(self.series).powi(2) * self.bare.len() as f64;
        let left = (chosen.unseen_squares() - noise).max(0.0) / bare.max(1e-300);
        let of_law = 1.96 * LAW_SHARE * left.sqrt() * limit.value;
        let half = (0.5 * (limit.ci95[1] - limit.ci95[0])).hypot(of_law);
        Number {
            ci95: [limit.value - half, limit.value + half],
            ..limit
        }
    }

    fn gain(&self) -> Named {
        let own = number("factor", &self.selection.chosen, |fit| fit.gain);
        let rivals = match (own.value - 1.0).abs() > DROOP_GAIN {
            true => Vec::new(),
            false => vec![lag::NAME],
        };
        (gain::NAME, vec![own], rivals)
    }

    fn droop(&self) -> Named {
        let numbers = match self.series.load_nm {
            Some(_) => vec![number(
                "stiffness_nm_per_rad",
                &self.selection.chosen,
                |fit| fit.droop.first().map_or(0.0, |slope| 1.0 / slope),
            )],
            None => {
                let size = self.selection.droop_size;
                vec![Number {
                    name: "droop_rad",
                    value: size,
                    ci95: [size, size],
                }]
            }
        };
        let rivals = match self.series.load_nm {
            Some(_) => Vec::new(),
            None => vec![gain::NAME],
        };
        (lag::NAME, numbers, rivals)
    }
}

/// Said where the laws were not fitted to their end.
const NOT_CONVERGED: &str =
    "the fit of the servo's laws did not converge: it has no intervals, and no law is named";

/// The numbers of a lag with a mass.
fn heavy(judged: &Judged) -> Vec<Number> {
    let lag = number("lag_s", judged, |fit| fit.shape.lag_s);
    let inertia = number("inertia_s", judged, |fit| fit.shape.inertia_s);
    // without a mass that shows it is a lag
    let natural = (inertia.ci95[0] > 0.0).then(|| Number {
        name: "natural_rad_per_s",
        value: 1.0 / inertia.value,
        ci95: [1.0 / inertia.ci95[1], 1.0 / inertia.ci95[0]],
    });
    std::iter::once(lag).chain(natural).collect()
}

type Named = (&'static str, Vec<Number>, Vec<&'static str>);

/// A number with the interval of what the parts of the log differ by (delete-a-part jackknife, Efron & Tibshirani 1993, 11).
fn number(name: &'static str, judged: &Judged, of: impl Fn(&crate::fit::Fit) -> f64) -> Number {
    let value = of(&judged.fit);
    let sd = jackknife_sd(judged.folds.iter().map(of)).max(RESOLUTION * value.abs());
    Number {
        name,
        value,
        ci95: [value - 1.96 * sd, value + 1.96 * sd],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_that_has_not_converged_names_nothing() {
        let time_s: Vec<f64> = (0..1200).map(|row| 0.02 * f64::from(row)).collect();
        let course = |t: f64| 0.6 * (1.3 * t).sin() + 0.3 * (2.9 * t).cos();
        let command: Vec<f64> = time_s.iter().map(|t| course(*t)).collect();
        let response: Vec<f64> = time_s.iter().map(|t| course(t - 0.07)).collect();
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&command),
            response: &response,
            ..JointLog::default()
        };
        let series = Series::new(&log).unwrap();
        let mut selection = select(&series);
        let answer = |selection: &Selection| {
            let joint = Joint {
                series: &series,
                selection,
                changes: Vec::new(),
                bare: errors(&series),
            };
            joint.answer()
        };
        let found = answer(&selection);
        assert_eq!(found.causes[0].effect, latency::NAME);
        assert!(found.model.is_some() && found.warnings.is_empty());
        selection.chosen.folds[3].has_converged = false;
        let found = answer(&selection);
        assert_eq!((found.verdict, found.causes.len()), (Verdict::Unknown, 0));
        assert!(found.model.is_none() && found.warnings == [NOT_CONVERGED]);
    }
}
