//! Advice: the next recording that separates confusable effects.

use haptical_effects::{Effect, Family, spec};

use crate::answer::{Asked, CauseAnswer, IN_NO_CATALOGUE, Located, Verdict};
use crate::judge::Findings;
use crate::select::Covariate;

/// The next experiment in words; none where there is no gap.
pub(crate) fn next_experiment(
    findings: &Findings<'_>,
    verdict: Verdict,
    causes: &[CauseAnswer],
    place: Option<&Located>,
) -> Option<String> {
    if findings.base_terms.is_tool() {
        return Some(CONFIRM_TOOL.to_owned());
    }
    let first = findings.first();
    // what is done about the tracker's clock comes before what confirms that there is a delay
    let ahead = causes.first().and_then(CauseAnswer::ahead);
    if let (Verdict::Named | Verdict::Ambiguous, Some(ahead)) = (verdict, ahead) {
        return Some(ahead.words());
    }
    let confused_with = causes.first().map(|cause| cause.confusable_with.as_slice());
    match (verdict, confused_with.unwrap_or_default()) {
        (Verdict::NoGap, _) => None,
        (Verdict::Named, _) | (Verdict::Ambiguous, []) => first.map(confirm),
        (Verdict::Ambiguous, confused_with) => Some(separate(first, confused_with)),
        (Verdict::Unknown, _) => Some(match place {
            Some(place) => explore_place(place),
            None => explore(None),
        }),
    }
}

/// A recording that would contradict a wrong name.
fn confirm(effect: &dyn Effect) -> String {
    let joint = effect.joint().map_or(0, |joint| joint + 1);
    match effect.spec().family {
        Family::Load if effect.joint().is_some() => format!(
            "to confirm: hold joint {joint} still and load it both ways with a known weight; the error must \
             follow the torque and vanish with it"
        ),
        Family::Load | Family::Tool => {
            "to confirm: hold the device still and push the handle in each direction with known force".to_owned()
        }
        Family::Loop => format!(
            "to confirm: move slowly to and fro over one place{}, at two speeds; the width of the loop must not \
             depend on the speed",
            at_joint(joint)
        ),
        Family::Lag => {
            "to confirm: repeat the motion at a third of the speed; the error must fall to a third".to_owned()
        }
        Family::Step => {
            "to confirm: return to home now and then and look whether the reading comes back; check the encoder's \
             cable and supply, then home the device again"
                .to_owned()
        }
        Family::Drift => {
            "to confirm: record through a cycle of warming and cooling; what follows the temperature returns, a \
             drift in time does not"
                .to_owned()
        }
        Family::Shape | Family::Coupling => format!(
            "to confirm: sweep{} slowly through its whole range without load, with all other joints at rest",
            at_joint(joint)
        ),
        Family::Exit => {
            "to confirm: move the cable encoder to a second known place; an error of the exit turns with the \
             cable's angle, one of the device does not"
                .to_owned()
        }
        Family::Periodic => {
            "to confirm: record the device at rest, and at another speed; the frequency must stay".to_owned()
        }
        Family::Place => {
            "to confirm: return to one posture in each run; what the tracker reads there must differ by the shift"
                .to_owned()
        }
        Family::Stated => "to confirm: check the stated number against a standard".to_owned(),
        Family::Wobble => format!(
            "to confirm: turn joint {joint} alone through its range with a dial gauge on the next link"
        ),
    }
}

fn at_joint(joint: usize) -> String {
    if joint == 0 {
        String::new()
    } else {
        format!(" at joint {joint}")
    }
}

/// The cheapest experiment that separates what is confused.
fn separate(first: Option<&dyn Effect>, confused_with: &[String]) -> String {
    let names = confused_with.iter().map(|name| match name.as_str() {
        IN_NO_CATALOGUE => "an effect in no catalogue",
        known => known,
    });
    let names = names.collect::<Vec<_>>().join(", ");
    let Some(first) = first else {
        return "repeat the recording with a wider range and different speeds".to_owned();
    };
    let drifts = |name: &String| spec(name).is_some_and(|spec| spec.family == Family::Drift);
    let how = match first.spec().family {
        Family::Drift => "record a cycle of warming and cooling, and home the device in between",
        Family::Step if confused_with.iter().any(drifts) => {
            "record longer, returning to home every ten seconds: a step stays, a drift goes on"
        }
        Family::Step => {
            "repeat under a light and a heavy load: a cable slips at peaks of torque, an encoder does not"
        }
        Family::Loop => {
            "move to and fro at two speeds, with stops: a play keeps its width, a lag does not"
        }
        Family::Lag => "repeat the motion at a third and at three times the speed",
        Family::Load => "repeat the motion with a known weight on the handle, and without",
        Family::Exit => {
            "put the cable encoder in a second known place, or measure one distance with a gauge"
        }
        Family::Shape | Family::Coupling | Family::Wobble => {
            "widen the range of that joint as far as it goes, and move it alone"
        }
        Family::Tool => "push the handle with known forces while the device stands still",
        Family::Periodic => {
            "repeat the motion at another speed, and at rest: what comes from outside keeps its frequency"
        }
        Family::Place => "return to one posture in each run, and measure the handle there",
        Family::Stated => "check the stated number against a standard",
    };
    let joint = first
        .joint()
        .map_or(String::new(), |joint| format!("@{}", joint + 1));
    format!("to tell {}{joint} from {names}: {how}", first.name())
}

/// What confirms another tool.
const CONFIRM_TOOL: &str = "to confirm: look at what the last link carries, and measure it; then put the shift into the \
                            last row of the earlier model, whose other numbers hold";

/// By what single postures depend on, surest first; of a motion by the covariate.
fn explore_place(place: &Located) -> String {
    let first = place.told().next().map(|found| found.asked);
    let mut sides = place.told().filter(|found| found.asked == Asked::Side);
    match first {
        Some(Asked::Course) => explore_drift(place),
        _ if place.is_of_touches() => explore_postures(place),
        _ if place.is_nowhere() => explore(None),
        _ if place.answer.dependence.is_empty() => explore(Some(place)),
        Some(Asked::Side) => explore_sides(place.answer.joint),
        _ => match sides.next() {
            Some(side) => format!(
                "{}; then {}",
                explore(Some(place)),
                explore_sides(side.joint)
            ),
            None => format!(
                "{}; single postures show no play or friction by themselves: {}",
                explore(Some(place)),
                explore_sides(place.answer.joint)
            ),
        },
    }
}

/// A drift that no effect of the catalogue has the course of.
fn explore_drift(place: &Located) -> String {
    let columns = &place.answer.depends_on;
    let temperature = match columns.iter().any(|column| column == "temp_degc") {
        true => "keep the log of the temperature",
        false => "log the temperature of device and room (temp_degc)",
    };
    let column = columns.first().map_or("t_s", String::as_str);
    format!(
        "something moves with {column} while the device is measured: {temperature}, let the device and the tracker \
         warm up first, and repeat one posture every few minutes through the whole recording; what that posture \
         shows is the drift, of the tracker and its stand if a mark on the robot's base shows it too"
    )
}

/// Each posture from both sides: what a play or a friction loop differs by.
fn explore_sides(joint: Option<usize>) -> String {
    let which = joint.map_or("every joint".to_owned(), |joint| format!("joint {joint}"));
    format!(
        "come to each posture twice, with {which} from below and from above, each way as a run of its own; a play \
         or a friction loop shows as a difference of the two runs"
    )
}

/// What touched postures cannot show, and how they would.
fn explore_postures(place: &Located) -> String {
    let joint = place.answer.joint;
    let which = joint.map_or("every joint".to_owned(), |joint| format!("joint {joint}"));
    format!(
        "the postures of this log have no direction of motion, so play and friction loops cannot be distinguished from \
         noise: touch the same points again, coming to each posture twice, with {which} from below and from above, \
         each way as a run of its own; a play shows as a difference of the two runs that no load changes"
    )
}

/// An experiment that takes the covariates of an unknown effect apart.
fn explore(place: Option<&Located>) -> String {
    let Some(place) = place else {
        return "repeat the same motion twice: what repeats is the device, what does not is the recording"
            .to_owned();
    };
    match place.covariate {
        Covariate::Angle(own) | Covariate::MotorPhase(own) | Covariate::Side(own) => format!(
            "move joint {} alone, slowly, to and fro over the place where the error is largest, once without and once \
             with load; then look at its drive there",
            own + 1
        ),
        Covariate::Speed(_) | Covariate::CableSpeed => {
            "repeat the same path at a third of the speed, and stop now and then".to_owned()
        }
        Covariate::Torque(_) | Covariate::Force => {
            "hold the device still and load it step by step both ways, then repeat the motion without load".to_owned()
        }
        Covariate::Time | Covariate::Temperature => {
            "repeat the motion after half an hour at rest, and again warm; home the device in between".to_owned()
        }
        Covariate::Length(_) | Covariate::ExitAngle => {
            "put the cable encoder in a second known place and repeat the motion".to_owned()
        }
    }
}
