//! Place of a gap that no effect and no free function shows: a number of an earlier model, the tool, or what single
//! postures depend on.

use haptical_calibration::Channel;
use haptical_effects::{Context, Family, Hook, Stream, spec};

use crate::answer::place::{Located, hook_words, stream_of};
use crate::answer::{Asked, Dependence};
use crate::engine::Engine;
use crate::judge::earlier_model::BaseTerm;
use crate::select::Selection;
use crate::select::generic::{Covariate, Place};
use crate::thresholds::dependence::PLACED_P;

/// By the strongest base term that an earlier model lacks.
pub(crate) fn of_base_term(engine: &Engine<'_>, term: &BaseTerm) -> Option<Located> {
    let context = &engine.context;
    let own = term.joint.filter(|_| term.in_drive);
    let stream = own
        .and_then(|joint| context.output_stream(joint))
        .or_else(|| context.streams.iter().position(Stream::shows_handle))
        .unwrap_or(0);
    let covariate = Covariate::Angle(term.joint.unwrap_or(0));
    if term.is_tool() {
        return of_tool(context, stream, term);
    }
    let sensor = spec(term.name).filter(|spec| spec.family == Family::Place);
    if let Some(hook) = sensor.map(|spec| spec.hook) {
        let place = Place { hook, joint: None };
        let stream = context
            .streams_of(Channel::Position)
            .next()
            .unwrap_or(stream);
        let words = hook_words(context, place);
        let region = format!("{words}: the earlier model has another place");
        return Located::new(context, stream, None, Covariate::Time, region);
    }
    let words = match term.joint {
        Some(joint) if term.in_drive => format!("in the drive of joint {}", joint + 1),
        Some(joint) => format!("in the geometry of link {}", joint + 1),
        None => "in the geometry of the base row".to_owned(),
    };
    let region = format!("{words}: the earlier model has other values there");
    let located = Located::new(context, stream, term.joint, covariate, region)?;
    Some(located.depending([(covariate.column(context), 1.0)]))
}

/// Behind the last joint, in the handle's frame.
fn of_tool(context: &Context<'_>, stream: usize, term: &BaseTerm) -> Option<Located> {
    let joint = context.device.joints.len();
    let parts: Vec<String> = ["shift_x_m", "shift_y_m", "shift_z_m"]
        .iter()
        .filter_map(|name| term.parameters.get(*name))
        .map(|part| format!("{:.2}", 1e3 * part.value))
        .collect();
    let region = format!(
        "behind joint {joint}: what the last link carries sits ({}) mm elsewhere in the handle's frame than in the \
         earlier model, whose other numbers hold",
        parts.join(", ")
    );
    let last = joint.checked_sub(1)?;
    Located::new(context, stream, Some(last), Covariate::Angle(last), region)
}

/// Of touches: by what their residuals depend on, posture by posture.
pub(crate) fn by_dependence(
    selection: &Selection<'_>,
    dependence: Vec<Dependence>,
) -> Option<Located> {
    let context = &selection.engine().context;
    let told = || {
        dependence
            .iter()
            .filter(|found| found.p_adjusted < PLACED_P)
    };
    let surest = told().next();
    let joint = surest.and_then(|found| found.joint);
    let alone = surest.and_then(|found| found.channel.as_ref());
    let alone = alone.and_then(|name| {
        context
            .streams
            .iter()
            .position(|s| s.channel.name() == *name)
    });
    let stream = alone.or_else(|| stream_of(selection, Hook::Joint, None))?;
    let region = match surest {
        None if context.streams.iter().any(Stream::is_touch) => {
            "no joint's angle or torque, no direction of approach and no drift explains it: no place can be told"
                .to_owned()
        }
        None => {
            "no joint's angle, torque or direction and no drift explains it, so that no place can be told: noise \
             larger than stated looks like this"
                .to_owned()
        }
        Some(found) => {
            let place = match (joint, found.asked) {
                (Some(joint), _) => format!("at joint {joint}"),
                (None, Asked::Course) => "in no joint alone".to_owned(),
                (None, _) => "at the handle".to_owned(),
            };
            format!(
                "{place}; it depends on {} (probability by chance {:.1e}), which explains {:.0} % of it",
                found.on,
                found.p_adjusted,
                100.0 * found.share
            )
        }
    };
    let of_joint = joint.map_or(0, |joint| joint - 1);
    let covariate = match surest.map(|found| (found.asked, found.column.as_str())) {
        Some((Asked::Torque, _)) => Covariate::Torque(of_joint),
        Some((Asked::Course, "t_s")) => Covariate::Time,
        Some((Asked::Course, "temp_degc")) => Covariate::Temperature,
        _ => Covariate::Angle(of_joint),
    };
    let columns: Vec<(String, f64)> = told()
        .map(|found| (found.column.clone(), found.share))
        .collect();
    let mut located = Located::new(context, stream, None, covariate, region)?.depending(columns);
    located.answer.joint = joint;
    Some(located.with_dependence(dependence))
}
