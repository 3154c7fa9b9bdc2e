//! Covariates that the residuals of single postures are tested for: angles, torques, the side that a joint came from, the
//! direction of approach, and every other logged column.

use haptical_effects::{Context, Hook, Signal, Stream};
use haptical_model::kinematics::nalgebra::Vector3;

use crate::answer::Asked;
use crate::select::{Covariate, Place, free_function, sides};
use crate::thresholds::dependence::{KNOTS, SLOW_KNOTS};

/// What a residual is asked for.
pub(super) struct Question {
    pub(super) column: String,
    pub(super) joint: Option<usize>,
    /// Stream that is asked alone.
    pub(super) stream: Option<usize>,
    pub(super) asked: Asked,
    pub(super) on: String,
    pub(super) signals: Vec<Signal>,
}

impl Question {
    /// Of all streams.
    fn new(
        (column, asked): (String, Asked),
        joint: Option<usize>,
        on: String,
        signals: Vec<Signal>,
    ) -> Self {
        Self {
            column,
            joint,
            stream: None,
            asked,
            on,
            signals,
        }
    }
}

pub(super) fn questions(context: &Context<'_>) -> Vec<Question> {
    let mut questions = Vec::new();
    let touches = context.streams.iter().any(Stream::is_touch);
    for joint in 0..context.device.joints.len() {
        questions.extend(angle(context, joint));
        questions.extend(torque(context, joint));
        questions.extend(of_encoder(context, joint));
        // touches come in any order where no time says otherwise
        if !touches || context.recording.time_s.is_some() {
            questions.extend(side(context, joint));
        }
    }
    if !context.rotation.is_empty() && touches {
        questions.push(approach(context));
    }
    questions.extend(courses(context));
    questions
}

fn angle(context: &Context<'_>, joint: usize) -> Option<Question> {
    let angle = Covariate::Angle(joint);
    let place = Place::at(Hook::Joint, Some(joint));
    let signals = free_function(context, place, angle, KNOTS)?;
    let column = (angle.column(context), Asked::Angle);
    Some(Question::new(
        column,
        Some(joint),
        angle.words(context),
        signals,
    ))
}

fn torque(context: &Context<'_>, joint: usize) -> Option<Question> {
    let torque = context.torque_nm.get(joint)?.as_ref()?;
    let side: Vec<f64> = torque.iter().map(|torque| torque.signum()).collect();
    let logged = matches!(context.recording.torque_nm.get(joint), Some(Some(_)));
    let source = if logged { "" } else { " (from the masses)" };
    let covariate = Covariate::Torque(joint);
    let on = format!("{} and its side{source}", covariate.words(context));
    let signals = [torque, &side].map(|values| context.downstream(joint, values));
    let column = (covariate.column(context), Asked::Torque);
    Some(Question::new(column, Some(joint), on, signals.into()))
}

/// A play or a friction loop leaves a joint on the side that it came from: the sign of its step from the row
/// before. A joint that did not move is where it was.
fn side(context: &Context<'_>, joint: usize) -> Option<Question> {
    let on = Covariate::Side(joint).words(context);
    let signals = vec![context.downstream(joint, &sides(context, joint)?)];
    let column = (Covariate::Side(joint).column(context), Asked::Side);
    Some(Question::new(column, Some(joint), on, signals))
}

/// An external encoder of its own: by angle, side and time. What the encoder alone sees, the chain need not.
fn of_encoder(context: &Context<'_>, joint: usize) -> Vec<Question> {
    // of single postures with a chain few rows would be asked twice as much
    let is_asked = context.ordered || !context.device.has_links();
    let Some(stream) = context.output_stream(joint).filter(|_| is_asked) else {
        return Vec::new();
    };
    let name = context.streams[stream].name();
    let angle = Covariate::Angle(joint);
    let encoder = Place::at(Hook::ExternalEncoder, Some(joint));
    let question = |covariate: Covariate, asked, signals| {
        let on = format!("{}, in {name} alone", covariate.words(context));
        let column = (covariate.column(context), asked);
        Question {
            stream: Some(stream),
            ..Question::new(column, Some(joint), on, signals)
        }
    };
    let mut questions = Vec::new();
    if let Some(signals) = free_function(context, encoder, angle, KNOTS) {
        questions.push(question(angle, Asked::Angle, signals));
    }
    if let Some(side) = sides(context, joint) {
        let signals = vec![context.encoder(joint, &side)];
        questions.push(question(Covariate::Side(joint), Asked::Side, signals));
    }
    if let Some(signals) = free_function(context, encoder, Covariate::Time, SLOW_KNOTS) {
        questions.push(question(Covariate::Time, Asked::Course, signals));
    }
    questions
}

/// The handle's own axes as the base sees them: a shift that turns with them is another tool's, and so in the
/// base model already.
fn approach(context: &Context<'_>) -> Question {
    let signals = (0..9).map(|index| {
        context.handle(|row| {
            let approach = context.rotation[row].column(2).into_owned();
            let shift = Vector3::ith(index / 3, approach[index % 3]);
            (shift, Vector3::zeros())
        })
    });
    let on = "the direction of approach (the handle's z axis)".to_owned();
    let column = ("contact".to_owned(), Asked::Approach);
    Question::new(column, None, on, signals.collect())
}

/// Time, temperature, and what else the log carries: each as a drift of every joint, and as one of base and
/// links.
fn courses(context: &Context<'_>) -> Vec<Question> {
    let mut questions = Vec::new();
    for slow in [Covariate::Time, Covariate::Temperature] {
        let Some(hats) = slow
            .values(context)
            .and_then(|values| crate::select::hats(&values, SLOW_KNOTS))
        else {
            continue;
        };
        let (column, words) = (slow.column(context), slow.words(context));
        for joint in 0..context.device.joints.len() {
            let signals = hats.iter().map(|hat| context.downstream(joint, hat));
            let on = format!("{words}, as a drift of joint {}", joint + 1);
            let column = (column.clone(), Asked::Course);
            questions.push(Question::new(column, Some(joint), on, signals.collect()));
        }
        questions.extend(of_structure(context, column, &words, &hats));
    }
    for (name, values) in &context.recording.covariates {
        if values.len() == context.rows() && values.iter().all(|value| value.is_finite()) {
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let course = vec![values.iter().map(|value| value - mean).collect()];
            questions.extend(of_structure(context, name.clone(), name, &course));
        }
    }
    questions
}

/// A shift and a turn of the base (or of the tracker) and a growth of the way from base to handle, each by the
/// given courses. None for a device without links.
fn of_structure(
    context: &Context<'_>,
    column: String,
    words: &str,
    courses: &[Vec<f64>],
) -> Option<Question> {
    if !context.device.has_links() {
        return None;
    }
    let mut signals = Vec::new();
    for course in courses {
        for axis in 0..3 {
            signals.push(context.handle(|row| (Vector3::ith(axis, course[row]), Vector3::zeros())));
            signals.push(context.handle(|row| {
                let turn = Vector3::ith(axis, course[row]);
                (turn.cross(&context.way_from_base(row)), turn)
            }));
        }
        signals.push(context.handle(|row| {
            let growth = course[row] * context.way_from_base(row);
            (growth, Vector3::zeros())
        }));
    }
    let on = format!("{words}, as a drift of the base, the tracker or the links' lengths");
    Some(Question::new((column, Asked::Course), None, on, signals))
}
