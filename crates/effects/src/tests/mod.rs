//! What every effect has to fulfil, at every place of two devices.

mod absent;
mod compare;
mod laws;
mod names;
mod parallel_axes;
mod rig;
mod runs;
mod statics;
mod tracker;

use haptical_calibration::Channel;
use haptical_model::Device;

use self::rig::{AnyEffect, amplitudes, rigs, values};
use crate::device::{effects_of, entry, is_law};
use crate::structure::JOINT_COMPLIANCE;
use crate::{Context, Effect, Hook, Need, Role, Shape, Signal, Spec, catalogue, drive_catalogue};

/// Effects of a device.
type Catalogue = fn(&Device) -> Vec<Box<dyn Effect>>;

#[test]
fn effects_that_positions_show_conform() {
    every_effect_conforms(catalogue);
}

#[test]
fn effects_that_torques_show_conform() {
    every_effect_conforms(drive_catalogue);
}

/// Checks every effect at every place where a recording can test it: each is tested somewhere.
fn every_effect_conforms(catalogue: Catalogue) {
    let mut tested: Vec<&Spec> = Vec::new();
    let mut listed: Vec<&Spec> = Vec::new();
    for rig in rigs() {
        let context = rig.context();
        for effect in &catalogue(&rig.device) {
            listed.push(effect.spec());
            if effect.untestable(&context).is_none() {
                let effect = effect.as_ref();
                tested.push(effect.spec());
                assert_is_felt(effect, &context);
                assert_adds_nothing_at_zero_size(effect, &context);
                assert_parameters_survive_the_way_through_amplitudes(effect, &context);
                assert_whole_numbers_are_whole(effect, &context);
                assert_typical_sizes_are_plausible(effect, &context);
                assert_derivative_agrees_with_differences(effect, &context);
                assert_changes_smoothly_with_its_shape(effect, &context);
                assert_reaches_its_hook_alone(effect, &context);
            }
        }
    }
    for spec in listed {
        assert!(tested.contains(&spec), "{} is tested nowhere", spec.name);
    }
}

#[test]
fn every_effect_of_the_registry_is_at_some_place() {
    let all: Vec<_> = rigs()
        .iter()
        .flat_map(|rig| everything(&rig.device))
        .collect();
    for spec in crate::specs() {
        let is_found = all.iter().any(|effect| effect.spec() == spec);
        // findings of other parts have no law
        let has_none = matches!(spec.hook, Hook::Readings | Hook::BaseModel | Hook::Command)
            || ["unbalanced-gravity", "grip-force"].contains(&spec.name)
            // the laws of a moving arm and of currents are other crates'
            || spec.needs.contains(&Need::Inertia)
            || spec.needs.contains(&Need::Current)
            || *spec == crate::force::PAYLOAD_ON_LINK;
        assert_ne!(is_found, has_none, "{}", spec.name);
    }
}

/// Effects on positions and on torques.
fn everything(device: &Device) -> Vec<Box<dyn Effect>> {
    let mut effects = catalogue(device);
    effects.extend(drive_catalogue(device));
    effects
}

/// Largest magnitude of a signal.
fn size(signal: &Signal) -> f64 {
    let all = signal.parts.iter().flat_map(|(_, values)| values);
    all.fold(0.0, |size, value| size.max(value.abs()))
}

/// Largest magnitude of the difference of two signals.
fn distance(one: &Signal, other: &Signal) -> f64 {
    let mut difference = one.clone();
    difference.add(other, -1.0);
    size(&difference)
}

/// An axis that wobbles is tilted across the axis before it, and a slide has none.
fn follows_a_slide(effect: &AnyEffect, context: &Context<'_>) -> bool {
    let slides = |joint: usize| context.device.joints[joint].unit() == "m";
    effect.name() == "axis-wobble"
        && effect
            .joint()
            .is_some_and(|joint| joint > 0 && slides(joint - 1))
}

/// A hundredth of the least that an encoder here resolves, \[rad\] or \[m\]: no effect of a size that a
/// device can show stays below.
const NOTHING: f64 = 1e-8;

fn assert_is_felt(effect: &AnyEffect, context: &Context<'_>) {
    let (amplitudes, shape) = amplitudes(effect, context);
    let felt = size(&effect.signal(context, &amplitudes, shape));
    assert!(
        felt > NOTHING,
        "{}: {} adds {felt:e}",
        context.device.name,
        effect.label()
    );
    for shape in effect.shapes(context) {
        let zero = vec![0.0; effect.spec().amplitudes];
        let columns = effect.derivative(context, &zero, shape);
        assert_eq!(
            columns.len(),
            effect.spec().amplitudes,
            "{}",
            effect.label()
        );
        for (index, column) in columns.iter().enumerate() {
            let label = effect.label();
            let values = column.parts.iter().flat_map(|(_, values)| values);
            assert!(values.clone().all(|value| value.is_finite()), "{label}");
            // per unit of amplitude: a count, 1/300 of a stiffness, 1 rad, 1 m
            let felt = size(column);
            assert!(
                felt > 1e-4,
                "{label}: amplitude {index} at shape {shape} adds {felt:e}"
            );
        }
    }
}

fn assert_adds_nothing_at_zero_size(effect: &AnyEffect, context: &Context<'_>) {
    let zero = vec![0.0; effect.spec().amplitudes];
    for shape in effect.shapes(context) {
        let added = size(&effect.signal(context, &zero, shape));
        assert_eq!(added, 0.0, "{} at shape {shape}", effect.label());
    }
}

/// Rounding of a few operations.
const ROUNDING: f64 = 1e-12;

fn assert_parameters_survive_the_way_through_amplitudes(effect: &AnyEffect, context: &Context<'_>) {
    let (label, spec) = (effect.label(), effect.spec());
    for factor in [0.3, 1.0, 3.0] {
        for phase_rad in [-2.5, 0.0, 0.7, 3.0] {
            for shape in effect.shapes(context).into_iter().chain([0.07]) {
                let mut given = values(effect, context, factor);
                for (value, parameter) in given.iter_mut().zip(spec.parameters) {
                    match parameter.role {
                        Role::Phase => *value = phase_rad,
                        // the other joint is the effect's own, where it is not the shape
                        Role::Number
                            if parameter.name == "from_joint" && spec.shape != Shape::Given => {}
                        Role::Transition | Role::Number => *value = shape,
                        _ => {}
                    }
                }
                let (amplitudes, shape) = effect.amplitudes(context, &given);
                assert_eq!(amplitudes.len(), spec.amplitudes, "{label}");
                assert!(
                    effect.is_possible(context, &amplitudes),
                    "{label}: {given:?}"
                );
                let found = effect.values(context, &amplitudes, shape);
                assert_eq!(found.len(), spec.parameters.len(), "{label}");
                for (given, found) in given.iter().zip(&found) {
                    let error = (given - found).abs();
                    assert!(
                        error <= ROUNDING * given.abs().max(1.0),
                        "{label}: {given} {found}"
                    );
                }
            }
        }
    }
}

/// Reported and further numbers together give the same signal again, whatever the amplitudes.
fn assert_whole_numbers_are_whole(effect: &AnyEffect, context: &Context<'_>) {
    // each run and axis has a phase of its own, which no number says
    if effect.name() == "periodic-disturbance" {
        return;
    }
    let (amplitudes, first) = amplitudes(effect, context);
    let shapes = effect.shapes(context).into_iter();
    let is_event = effect.spec().shape == Shape::Event;
    for shape in shapes.map(|shape| if is_event { first } else { shape }) {
        for sign in [1.0, -1.0] {
            let mut given: Vec<f64> = amplitudes.iter().map(|own| sign * own).collect();
            for (index, own) in given.iter_mut().enumerate().skip(1) {
                *own = *own * 0.8 + 0.3 * amplitudes[0] * (index as f64).cos();
            }
            if !effect.is_possible(context, &given) {
                continue;
            }
            let values = effect.values(context, &given, shape);
            let further = effect.further(context, &given, shape);
            assert_eq!(
                further.len(),
                effect.spec().further.len(),
                "{}",
                effect.label()
            );
            let (again, there) = effect.whole(context, &values, &further);
            let before = effect.signal(context, &given, shape);
            let after = effect.signal(context, &again, there);
            let (error, scale) = (distance(&before, &after), size(&before));
            assert!(
                error <= 1e-9 * scale,
                "{}: {given:?} at {shape} comes back as {again:?} at {there}: {error:e} of {scale:e}",
                effect.label()
            );
            assert_a_file_holds_it(effect, context, &given, shape);
        }
    }
}

/// What is written into a device file and read again adds the same to every stream: no sign, side or shape is lost.
fn assert_a_file_holds_it(
    effect: &AnyEffect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
) {
    // a joint's compliance is a number of the base model, with a key of its own
    if is_law(effect.spec()).is_err() || effect.name() == JOINT_COMPLIANCE.name {
        return;
    }
    let mut device = context.device.clone();
    let original = device.to_new_toml().unwrap();
    device.effects = vec![entry(effect, context, amplitudes, shape)];
    let label = effect.label();
    let text = device.to_toml(&original, "device.toml").unwrap();
    let again = Device::from_toml(&text, "again.toml").unwrap().device;
    let before = effect.exact_signal(context, amplitudes, shape);
    let own = effects_of(&again).unwrap();
    assert_eq!(own.len(), 1, "{label}");
    let (found, there) = own[0].amplitudes(context);
    let after = own[0].effect.exact_signal(context, &found, there);
    let (error, scale) = (distance(&before, &after), size(&before));
    assert!(
        error <= 1e-9 * scale,
        "{label}: {amplitudes:?} at {shape} differ by {error:e} of {scale:e} behind a file:\n{text}"
    );
}

fn assert_typical_sizes_are_plausible(effect: &AnyEffect, context: &Context<'_>) {
    let parameters = effect.spec().parameters.iter();
    for (parameter, value) in parameters.zip(values(effect, context, 1.0)) {
        let label = format!("{} {}: {value}", effect.label(), parameter.name);
        assert!(parameter.is_plausible(value, 1.0), "{label}");
        let absurd = match parameter.role {
            Role::Size | Role::Transition => value * 1e4,
            Role::Inverse => value / 1e4,
            Role::Phase | Role::Instant | Role::Number => continue,
        };
        if parameter.plausible[1] == f64::MAX {
            continue;
        }
        assert!(!parameter.is_plausible(absurd, 1.0), "{label}");
    }
}

/// Central differences of smooth contributions, steps of 1e-4 of the amplitude: third derivatives and
/// rounding stay below.
const DIFFERENCES: f64 = 1e-6;

fn assert_derivative_agrees_with_differences(effect: &AnyEffect, context: &Context<'_>) {
    let (amplitudes, first) = amplitudes(effect, context);
    let shapes = if effect.spec().shape == Shape::Event {
        vec![first]
    } else {
        effect.shapes(context)
    };
    if effect.spec().hook == Hook::Timing || effect.name() == "tracker-latency" {
        assert_linear_in_the_limit(effect, context, &amplitudes);
        return;
    }
    for shape in shapes {
        let columns = effect.derivative(context, &amplitudes, shape);
        for (index, column) in columns.iter().enumerate() {
            let difference = finite_difference(effect, context, &amplitudes, shape, index);
            let (label, scale) = (effect.label(), size(column));
            let error = distance(column, &difference);
            if effect.spec().shape == Shape::Sides {
                assert_differs_at_reversals_alone(&label, column, &difference);
            } else {
                assert!(
                    error <= DIFFERENCES * scale,
                    "{label} {index}: {error:e} of {scale:e}"
                );
            }
        }
    }
}

fn finite_difference(
    effect: &AnyEffect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
    index: usize,
) -> Signal {
    let step = 1e-4 * amplitudes[index].abs();
    let moved = |change: f64| {
        let mut moved = amplitudes.to_vec();
        moved[index] += change;
        effect.signal(context, &moved, shape)
    };
    let mut difference = Signal::default();
    difference.add(&moved(step), 0.5 / step);
    difference.add(&moved(-step), -0.5 / step);
    difference
}

/// What the chain's curvature adds to a delay's linear column at 3 ms: joints move by up to 1e-2 rad
/// meanwhile, several of them at once.
const CURVED: f64 = 2e-2;

/// The contribution of late motors, and of a late tracker, evaluates the chain again, their column is the linear one: they differ by
/// what is of second order in the delay, and not at all in the external encoders.
fn assert_linear_in_the_limit(effect: &AnyEffect, context: &Context<'_>, amplitudes: &[f64]) {
    for factor in [1.0, 0.1, 0.01] {
        let delay = [factor * amplitudes[0]];
        let columns = effect.derivative(context, &delay, 0.0);
        let difference = finite_difference(effect, context, &delay, 0.0, 0);
        let scale = size(&columns[0]);
        for (stream, values) in &columns[0].parts {
            let share = match context.streams[*stream].channel {
                Channel::Output { .. } => 0.0,
                _ => factor * CURVED,
            };
            let pairs = values.iter().zip(difference.on(*stream).unwrap());
            let error = pairs.fold(0.0, |most: f64, (one, other)| most.max((one - other).abs()));
            assert!(
                error <= (share + DIFFERENCES) * scale,
                "stream {stream}, factor {factor}: {error:e} of {scale:e}"
            );
        }
    }
}

/// A play's column is its output per width, which differs from the derivative while the play is crossed.
/// Crossing 1 mrad, or 1 mm of a slide of 80 mm, takes less than a tenth of the rows.
fn assert_differs_at_reversals_alone(label: &str, column: &Signal, difference: &Signal) {
    for (stream, values) in &column.parts {
        let other = difference.on(*stream).unwrap();
        let scale = size(column);
        let differing = values
            .iter()
            .zip(other)
            .filter(|(one, other)| (*one - *other).abs() > DIFFERENCES * scale)
            .count();
        assert!(
            10 * differing < values.len(),
            "{label}: {differing} of {}",
            values.len()
        );
    }
}

fn assert_changes_smoothly_with_its_shape(effect: &AnyEffect, context: &Context<'_>) {
    // the phase of a line is proportional to its shape
    if !matches!(effect.spec().shape, Shape::Continuous(_)) {
        return;
    }
    let (amplitudes, _) = amplitudes(effect, context);
    let grid = effect.shapes(context);
    for pair in grid.windows(2) {
        let middle = (pair[0] * pair[1]).sqrt();
        let near = |factor: f64| effect.signal(context, &amplitudes, middle * factor);
        let (here, near, far) = (near(1.0), near(1.001), near(1.002));
        let (step, double) = (distance(&near, &here), distance(&far, &here));
        let label = format!("{} at {middle}", effect.label());
        assert!(step > 0.0, "{label}: the shape does nothing");
        // twice the step, twice the change; a state is never steeper than once per logarithm of its
        // transition
        assert!(
            (double / step - 2.0).abs() < 0.02,
            "{label}: {step:e} {double:e}"
        );
        // a play that is taken up, (peak - b - x) / b, goes by (peak - x) / b, which is 2 on the other side
        let steepest = match effect.other_joint() {
            Some(_) => 2.0,
            None => 1.0,
        };
        assert!(
            step < steepest * 0.002 * size(&here),
            "{label}: {step:e} of {:e}",
            size(&here)
        );
    }
}

/// Whether a hook reaches a stream, by the definition of [`Hook`].
fn reaches(effect: &AnyEffect, channel: Channel) -> bool {
    let (hook, joint) = (effect.spec().hook, effect.joint());
    let index = effect.further_cable().unwrap_or(0);
    let chain = !matches!(channel, Channel::Output { .. });
    let own = matches!(channel, Channel::Output { joint: of } if Some(of) == joint);
    match hook {
        Hook::Transmission => own || chain,
        Hook::ExternalEncoder => own,
        Hook::Joint | Hook::Structure => chain,
        Hook::CableSensor => channel == Channel::Cable { index },
        Hook::Tracker => matches!(channel, Channel::Position | Channel::Orientation),
        Hook::Timing => true,
        Hook::Torque | Hook::ForceSensor | Hook::Readings | Hook::BaseModel | Hook::Command => {
            false
        }
    }
}

fn assert_reaches_its_hook_alone(effect: &AnyEffect, context: &Context<'_>) {
    let label = effect.label();
    let (amplitudes, shape) = amplitudes(effect, context);
    let signal = effect.signal(context, &amplitudes, shape);
    for (index, stream) in context.streams.iter().enumerate() {
        let felt = signal
            .on(index)
            .is_some_and(|values| values.iter().any(|v| *v != 0.0));
        let reached = reaches(effect, stream.channel);
        assert!(reached || !felt, "{label} leaks into {}", stream.name());
        // the first cable and a joint's own encoder feel whatever reaches them
        let plain = stream.channel == Channel::Cable { index: 0 } || stream.joint().is_some();
        let must = reached && plain && !follows_a_slide(effect, context);
        assert!(felt || !must, "{label} does not reach {}", stream.name());
    }
    let hook = effect.spec().hook;
    for joint in 0..context.device.joints.len() {
        let stream = context.torque_stream(joint).unwrap();
        let felt = signal
            .on(stream)
            .is_some_and(|values| values.iter().any(|v| *v != 0.0));
        let own = hook == Hook::Torque && effect.joint().is_none_or(|own| own == joint);
        // what the sensor reads along any axis, and what hangs at the handle, moves every joint of these chains
        assert_eq!(
            felt,
            own || hook == Hook::ForceSensor,
            "{label} on torque {joint}"
        );
    }
    let streams = context.streams.len() + context.device.joints.len();
    for (stream, values) in &signal.parts {
        assert!(*stream < streams, "{label}");
        assert_eq!(values.len(), context.rows(), "{label}");
    }
}

#[test]
fn a_name_stands_once_at_a_place_and_parameter() {
    for rig in rigs() {
        let effects = everything(&rig.device);
        let mut seen: Vec<String> = effects
            .iter()
            .map(|effect| {
                let parameters: Vec<&str> =
                    effect.spec().parameters.iter().map(|p| p.name).collect();
                let from = effect.other_joint();
                format!(
                    "{} {:?} {parameters:?} {from:?}",
                    effect.label(),
                    effect.spec().hook
                )
            })
            .collect();
        let count = seen.len();
        seen.sort();
        seen.dedup();
        assert_eq!(seen.len(), count, "{}", rig.name);
    }
}
