//! Place of a gap: channel, joint, covariates and region, in words; a number of an earlier model, the tool, or what single postures depend
//! on, where no effect and no free function shows it.

use haptical_calibration::Channel;
use haptical_effects::{Context, Effect, Family, Follows, Hook, Stream, spec};

use crate::answer::{Asked, Dependence, Place as Answer};
use crate::engine::{Cause, Engine};
use crate::force::answer::ForceAnswer;
use crate::judge::{BaseTerm, Findings};
use crate::noise::without_lines;
use crate::select::{Covariate, Place, Selection, inner_range, score};
use crate::thresholds::dependence::{
    ALSO, BIN_SHARE, DEPENDENCE_P, EVIDENCE_PER_RANK, PLACE_BINS, PLACE_KNOTS, PLACED_P,
};
use crate::thresholds::lines::MOST_OF_A_GAP;

/// Where it lies, with the covariate that a picture should show.
#[derive(Debug, Clone)]
pub(crate) struct Located {
    pub(crate) answer: Answer,
    pub(crate) stream: usize,
    pub(crate) covariate: Covariate,
}

impl Located {
    /// In a stream, at a joint from 0; none where there is no such stream.
    pub(crate) fn new(
        context: &Context<'_>,
        stream: usize,
        joint: Option<usize>,
        covariate: Covariate,
        region: String,
    ) -> Option<Self> {
        let channel = context.streams.get(stream)?.channel.name();
        Some(Self {
            answer: Answer::new(channel, joint, region, []),
            stream,
            covariate,
        })
    }

    /// With columns that it depends on, and the share that each explains.
    pub(crate) fn depending(mut self, on: impl IntoIterator<Item = (String, f64)>) -> Self {
        self.answer = self.answer.depending(on);
        self
    }

    /// Whether a gap of postures at which nothing is touched depends on nothing that was asked.
    pub(crate) fn is_nowhere(&self) -> bool {
        let dependence = &self.answer.dependence;
        self.answer.depends_on.is_empty() && !dependence.is_empty() && !self.is_of_touches()
    }

    /// Whether the postures were found by touch.
    pub(crate) fn is_of_touches(&self) -> bool {
        let mut dependence = self.answer.dependence.iter();
        dependence.any(|found| found.asked == Asked::Approach)
    }

    /// What the residuals depend on, surely.
    pub(crate) fn told(&self) -> impl Iterator<Item = &Dependence> {
        let dependence = self.answer.dependence.iter();
        dependence.filter(|found| found.p_adjusted < DEPENDENCE_P)
    }

    /// With what single postures were asked.
    pub(crate) fn with_dependence(mut self, dependence: Vec<Dependence>) -> Self {
        self.answer.dependence = dependence;
        self
    }
}

/// The torque that shows most of the torques' gap.
pub(crate) fn in_torques(force: &ForceAnswer) -> Option<Answer> {
    let largest = force.largest()?;
    let joint = largest.joint?;
    let place = match largest.channel.trim_end_matches(char::is_numeric) {
        "torque" => format!("in the torque of joint {joint}"),
        "tracking" => format!("between the command and the torque of joint {joint}"),
        _ => format!("between the motor and the link of joint {joint}"),
    };
    let region = match force.depends_on.first() {
        Some(first) => format!(
            "{place}; it follows {} ({:.0} % of it)",
            first.words,
            100.0 * first.share
        ),
        None => place,
    };
    let on = (force.depends_on.iter()).map(|own| (own.column.clone(), own.share));
    Some(Answer::new(
        largest.channel.clone(),
        Some(joint - 1),
        region,
        on,
    ))
}

/// By the first cause, or by free functions of every covariate where there is none.
pub(crate) fn locate(findings: &Findings<'_>) -> Option<Located> {
    let selection = &findings.selection;
    match selection.causes().first() {
        Some(cause) if findings.adequacy.is_adequate => by_cause(selection, cause),
        _ => by_line(selection.engine()).or_else(|| by_free_functions(selection)),
    }
}

/// By a spectral line that holds most of the gap.
fn by_line(engine: &Engine<'_>) -> Option<Located> {
    let context = &engine.context;
    let mut gap = 0.0;
    let mut lost: Vec<f64> = Vec::new();
    for (stream, values) in engine.start.residual.iter().enumerate() {
        let variance = engine.floor[stream].powi(2).max(1e-300);
        let energy = |values: &[f64]| -> f64 {
            let usable = values.iter().zip(&engine.usable[stream]);
            let usable = usable.filter(|(_, usable)| **usable);
            usable.map(|(value, _)| value * value / variance).sum()
        };
        let readings = engine.usable[stream].iter().filter(|usable| **usable);
        gap += (energy(values) - readings.count() as f64).max(0.0);
        lost.push(energy(values) - energy(&without_lines(context, stream, values)));
    }
    let stream = (0..lost.len()).max_by(|a, b| lost[*a].total_cmp(&lost[*b]))?;
    let share = lost[stream] / gap.max(1e-300);
    let line_hz = context.lines_of(context.streams[stream].channel);
    let first_hz = line_hz.first().filter(|_| share > MOST_OF_A_GAP)?;
    let channel = context.streams[stream].channel.name();
    let joint = context.streams[stream].joint();
    let region = format!("in what {channel} reads: it oscillates at {first_hz:.3} Hz");
    let time = Covariate::Time;
    let located = Located::new(context, stream, joint, time, region)?;
    Some(located.depending([(time.column(context), share.min(1.0))]))
}

fn by_cause(selection: &Selection<'_>, cause: &Cause) -> Option<Located> {
    let context = &selection.engine().context;
    let effect = selection.effect(cause);
    let cable = effect.further_cable().map(|index| Channel::Cable { index });
    let stream = match cable {
        Some(channel) => context.streams_of(channel).next(),
        None => stream_of(selection, effect.spec().hook, effect.joint()),
    }?;
    let joint = effect.joint();
    let covariate = law_covariate(effect);
    let mut depends_on = vec![covariate.column(context)];
    if effect.spec().follows == Follows::Run && context.recording.run.is_some() {
        depends_on = vec!["run".to_owned()];
    }
    if effect.spec().follows == Follows::OtherAngle
        && let Some(joint) = joint
    {
        depends_on.push(Covariate::Angle(joint).column(context));
    }
    let place = match effect.further_cable() {
        Some(cable) => format!("in measuring cable {} or its encoder", cable + 1),
        None => hook_words(context, Place::at(effect.spec().hook, joint)),
    };
    let region = format!("{place}; it follows {}", covariate.words(context));
    let located = Located::new(context, stream, joint, covariate, region)?;
    Some(located.depending(depends_on.into_iter().map(|column| (column, 1.0))))
}

/// The covariate that an effect's law is a function of.
fn law_covariate(effect: &dyn Effect) -> Covariate {
    let joint = effect.joint().unwrap_or(0);
    match effect.spec().follows {
        Follows::Angle => Covariate::Angle(joint),
        Follows::OtherAngle => Covariate::Angle(effect.other_joint().unwrap_or(joint)),
        Follows::Speed => Covariate::Speed(joint),
        Follows::Torque => Covariate::Torque(joint),
        Follows::Force => Covariate::Force,
        Follows::Temperature => Covariate::Temperature,
        Follows::Time | Follows::Run => Covariate::Time,
        Follows::Length => Covariate::Length(effect.further_cable().unwrap_or(0)),
        Follows::ExitAngle => Covariate::ExitAngle,
        Follows::CableSpeed => Covariate::CableSpeed,
    }
}

/// The stream in which an effect at a place shows most plainly.
pub(crate) fn stream_of(
    selection: &Selection<'_>,
    hook: Hook,
    joint: Option<usize>,
) -> Option<usize> {
    let context = &selection.engine().context;
    if matches!(hook, Hook::Transmission | Hook::ExternalEncoder)
        && let Some(stream) = joint.and_then(|joint| context.output_stream(joint))
    {
        return Some(stream);
    }
    let chain = |stream: &usize| context.streams[*stream].shows_handle();
    let by_excess = |a: &usize, b: &usize| {
        selection.before[*a]
            .excess()
            .total_cmp(&selection.before[*b].excess())
    };
    (0..context.streams.len())
        .filter(chain)
        .max_by(by_excess)
        .or_else(|| (0..context.streams.len()).max_by(by_excess))
}

pub(crate) fn hook_words(context: &Context<'_>, place: Place) -> String {
    match (place.hook, place.joint) {
        (Hook::Transmission, Some(joint)) => match context.output_stream(joint) {
            Some(_) => format!(
                "in the drive of joint {}, in front of its external encoder",
                joint + 1
            ),
            None => format!("in the drive of joint {}", joint + 1),
        },
        (Hook::ExternalEncoder, Some(joint)) => {
            format!("in the external encoder of joint {} alone", joint + 1)
        }
        (Hook::Joint, Some(joint)) => match context.output_stream(joint) {
            Some(_) => format!("at joint {}, behind its encoders", joint + 1),
            None => format!("at joint {}, behind its encoder", joint + 1),
        },
        (Hook::CableSensor, _) => "in the measuring cable or its encoder".to_owned(),
        (Hook::Tracker, _) => "in what the tracker reads alone".to_owned(),
        (Hook::Timing, _) => "in the timing of the motor encoders".to_owned(),
        (_, Some(joint)) => format!("in the structure at joint {}", joint + 1),
        _ => "in the structure: base, links or handle".to_owned(),
    }
}

fn by_free_functions(selection: &Selection<'_>) -> Option<Located> {
    let engine = selection.engine();
    let context = &engine.context;
    let evidence = |place: Place, covariate: Covariate| {
        let found = score(&engine.system, context, place, covariate, PLACE_KNOTS)?;
        Some(found.score - EVIDENCE_PER_RANK * found.rank as f64)
    };
    let all = places(context).into_iter();
    let all = all.flat_map(|place| covariates(place).into_iter().map(move |of| (place, of)));
    let tried = all.filter_map(|(place, of)| Some((place, of, evidence(place, of)?)));
    let mut tried: Vec<(Place, Covariate, f64)> = tried.collect();
    tried.sort_by(|a, b| b.2.total_cmp(&a.2));
    let &(place, covariate, best) = tried.first()?;
    let stream = stream_of(selection, place.hook, place.joint)?;
    let total: f64 = selection.before.iter().map(|s| s.excess().max(0.0)).sum();
    let there = tried.iter().filter(|(other, _, _)| *other == place);
    let there = there.map(|(_, covariate, evidence)| (*covariate, *evidence));
    let joints = (0..context.device.joints.len()).filter(|&joint| Some(joint) != place.joint);
    let angles = joints.map(Covariate::Angle);
    let angles = angles.filter_map(|angle| Some((angle, evidence(place, angle)?)));
    let mut others: Vec<(Covariate, f64)> = there.chain(angles).collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    let covariate = others.first().map_or(covariate, |(first, _)| *first);
    let region = match peak(engine, stream, covariate) {
        Some(peak) => format!(
            "{}; depends on {} near {} ({})",
            hook_words(context, place),
            short(&covariate.column(context)),
            in_unit(context, covariate, peak),
            covariate.words(context)
        ),
        None => format!(
            "{}; depends on {}",
            hook_words(context, place),
            covariate.words(context)
        ),
    };
    let near = others.iter().filter(|(_, own)| *own >= ALSO * best);
    let shares = near.map(|(other, own)| {
        let share = (own / total.max(1e-300)).clamp(0.0, 1.0);
        (other.column(context), share)
    });
    let located = Located::new(context, stream, place.joint, covariate, region)?;
    Some(located.depending(shares))
}

fn places(context: &Context<'_>) -> Vec<Place> {
    let mut places = Vec::new();
    let chain = context.streams.iter().any(Stream::shows_handle);
    for joint in 0..context.device.joints.len() {
        let measured = context.output_stream(joint).is_some();
        let hooks = [
            (Hook::Transmission, measured || chain),
            (Hook::ExternalEncoder, measured && chain),
            (Hook::Joint, measured && chain),
        ];
        let there = hooks.into_iter().filter(|(_, exists)| *exists);
        places.extend(there.map(|(hook, _)| Place::at(hook, Some(joint))));
    }
    let cable = context.cable.as_ref();
    places.extend(cable.map(|_| Place::at(Hook::CableSensor, None)));
    places
}

fn covariates(place: Place) -> Vec<Covariate> {
    match place.joint {
        Some(joint) => vec![
            Covariate::Angle(joint),
            Covariate::Speed(joint),
            Covariate::Torque(joint),
            Covariate::Time,
            Covariate::Temperature,
        ],
        None => vec![
            Covariate::Length(0),
            Covariate::CableSpeed,
            Covariate::ExitAngle,
            Covariate::Time,
            Covariate::Temperature,
            Covariate::Force,
        ],
    }
}

/// Where along a covariate the base model's residual is largest: the centre of the interval around
/// its largest mean, if that stands out from the others.
fn peak(engine: &Engine<'_>, stream: usize, covariate: Covariate) -> Option<f64> {
    let values = covariate.values(&engine.context)?;
    let (low, high) = inner_range(&values)?;
    let width = (high - low) / PLACE_BINS as f64;
    let (mut sums, mut counts) = (vec![0.0; PLACE_BINS], vec![0.0; PLACE_BINS]);
    let residual = &engine.start.residual[stream];
    for ((value, residual), usable) in values.iter().zip(residual).zip(&engine.usable[stream]) {
        if *usable && (low..=high).contains(value) {
            let bin = (((value - low) / width) as usize).min(PLACE_BINS - 1);
            sums[bin] += residual;
            counts[bin] += 1.0;
        }
    }
    let means: Vec<f64> = sums
        .iter()
        .zip(&counts)
        .map(|(sum, count)| if *count >= 4.0 { sum / count } else { 0.0 })
        .collect();
    let size = (means.iter().map(|m| m * m).sum::<f64>() / PLACE_BINS as f64).sqrt();
    let by_size = |a: &usize, b: &usize| means[*a].abs().total_cmp(&means[*b].abs());
    let top = (0..PLACE_BINS).max_by(by_size)?;
    // of few postures no interval may have enough
    if size == 0.0 || means[top].abs() < 2.0 * size {
        return None;
    }
    let (mut weight, mut moment) = (0.0, 0.0);
    for bin in top.saturating_sub(2)..(top + 3).min(PLACE_BINS) {
        let share = (means[bin] / means[top]).max(0.0);
        if share > BIN_SHARE {
            weight += share;
            moment += share * (low + width * (bin as f64 + 0.5));
        }
    }
    Some(moment / weight)
}

/// A column's name without its unit.
fn short(column: &str) -> &str {
    column.rsplit_once('_').map_or(column, |(name, _)| name)
}

fn in_unit(context: &Context<'_>, covariate: Covariate, value: f64) -> String {
    let slides = |joint: usize| context.device.joints[joint].unit() == "m";
    let unit = match covariate {
        Covariate::Angle(joint) | Covariate::MotorPhase(joint) if slides(joint) => "m",
        Covariate::Speed(joint) if slides(joint) => "m/s",
        Covariate::Torque(joint) if slides(joint) => "N",
        Covariate::Angle(_) | Covariate::MotorPhase(_) | Covariate::ExitAngle => "rad",
        Covariate::Speed(_) => "rad/s",
        Covariate::Side(_) => "from below",
        Covariate::Torque(_) => "N m",
        Covariate::Time => "s",
        Covariate::Temperature => "K from its mean",
        Covariate::Length(_) => "m",
        Covariate::CableSpeed => "m/s",
        Covariate::Force => "N",
    };
    format!("{value:.2} {unit}")
}

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
        let place = Place::at(hook, None);
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
