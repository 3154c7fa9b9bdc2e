//! Warnings about a recording and about a result, in sentences.

use haptical_model::kinematics::Convention;
use haptical_model::{Device, ParameterId, Recording};

use crate::checks::sufficiency;
use crate::fit::implausible::{IMPLAUSIBLE, implausible};
use crate::fit::size::held_for_size;
use crate::problem::loads::Loads;
use crate::report::above_floor;
use crate::{CalibrationMethod, Channel, ChannelReport, FittedDevice, ParameterFit, Starts};

/// What is said of branches whose places no number can change: those of a standard row come behind its motion.
fn of_branches(device: &Device) -> Option<String> {
    let rows = 0..device.links.len();
    let is_branching = |row: &usize| {
        let mut behind = rows
            .clone()
            .filter(|other| device.parent(*other) == Some(*row));
        behind.nth(1).is_some()
    };
    let row = rows.clone().find(is_branching)?;
    (device.convention == Convention::Standard).then(|| {
        format!(
            "rows branch behind row {row} in the standard convention, whose numbers come behind each row's motion: where each \
             branch is on row {row} is held; use convention = \"modified\""
        )
    })
}

/// What a recording lacks for this device.
pub(crate) fn of_recording(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Vec<String> {
    let mut warnings = Vec::new();
    let ignored = recording.position_m.is_some() || recording.cable_m.iter().any(Option::is_some);
    if !device.has_links() && ignored {
        warnings.push(
            "the device has no [[link]] rows: positions and distances are ignored, only \
             transmissions are calibrated"
                .to_owned(),
        );
    }
    if device.has_links()
        && device.cables.is_empty()
        && recording.cable_m.iter().any(Option::is_some)
    {
        warnings.push(
            "the device has no [cable_encoder]: cable_m is taken as the distance from frame (-1)'s \
             origin, with noise of 0.1 mm until the residuals show it; add [cable_encoder] with \
             distance_sd_m"
                .to_owned(),
        );
    }
    warnings.extend(of_branches(device));
    warnings.extend(of_loads(device, recording));
    let resting = sufficiency::resting_joints(recording);
    if !resting.is_empty() {
        let numbers: Vec<String> = resting
            .iter()
            .map(|joint| (joint + 1).to_string())
            .collect();
        warnings.push(format!(
            "joint {} does not move in this recording: its parameters merge with its neighbours'",
            numbers.join(", ")
        ));
    }
    for (joint, description) in device.joints.iter().enumerate() {
        let driven = description.transmission != haptical_model::TransmissionKind::Direct;
        if driven && !channels.contains(&Channel::Output { joint }) {
            warnings.push(format!(
                "joint {} has a transmission but no out{} column: its error can only be seen \
                 through the distances, as far as they show it",
                joint + 1,
                joint + 1
            ));
        }
    }
    warnings
}

/// Compliances that are to be fitted without a load.
fn of_loads(device: &Device, recording: &Recording) -> Option<String> {
    let is_asked = device.surroundings.compliance.iter().any(|joint| joint.fit);
    // what is wrong with a row, the fit says
    let loads = Loads::new(device, recording).ok().flatten();
    let is_unloaded = is_asked && loads.is_some_and(|loads| loads.are_none());
    is_unloaded.then(|| {
        "no torque columns and no masses with [gravity]: there is nothing to fit compliances from; log the drives' \
         torques (torqueN_nm), or give the device file [gravity] and its rows' mass_kg and centre_of_mass_m"
            .to_owned()
    })
}

/// Warnings of the searches from other places.
fn of_search(starts: &Starts) -> Vec<String> {
    let mut warnings = Vec::new();
    if starts.replaced {
        warnings.push(format!(
            "the search from the device file's values ended at another minimum ({}); the values are those of the \
             best of {} random starts, which {} of them reached",
            starts.doubt.as_deref().unwrap_or("doubted"),
            starts.tried,
            starts.reached_best
        ));
    }
    if starts.rivals > 0 {
        warnings.push(format!(
            "{} of {} random starts ended at other plausible values that fit as well: this recording does not tell \
             which are the device's; record more poses, farther apart",
            starts.rivals, starts.tried
        ));
    }
    if starts.tried > 0
        && !starts.replaced
        && let Some(doubt) = &starts.doubt_that_remains
    {
        warnings.push(format!(
            "{doubt}; none of {} random starts found a better minimum, so the cause is rather the model or the \
             readings than the search",
            starts.tried
        ));
    }
    warnings
}

/// Joints that seem to yield against their load.
fn of_compliance(whole: &ParameterFit) -> Vec<String> {
    let found = whole.parameters.iter().zip(&whole.estimates);
    found
        .filter_map(|(parameter, estimate)| {
            let ParameterId::Compliance { joint } = parameter else {
                return None;
            };
            let [_, high] = estimate.ci95.filter(|interval| interval[1] < 0.0)?;
            Some(format!(
                "joint {}: its compliance, {:.2e} rad/Nm, is negative beyond its interval (up to {high:.2e}): a joint \
                 that yields against the load; a mass is missing, or the sign of a torque, of a joint or of gravity \
                 is wrong",
                joint + 1,
                estimate.value?
            ))
        })
        .collect()
}

/// The length that was held because no measurement fixes one.
fn of_scale(nominal: &Device, whole: &ParameterFit) -> Option<String> {
    let held: Vec<String> = held_for_size(whole, nominal)
        .into_iter()
        .filter(|parameter| parameter.unit(nominal) == "m")
        .map(|parameter| parameter.name(nominal))
        .collect();
    let verb = match held.as_slice() {
        [] => return None,
        [_] => "is",
        _ => "are",
    };
    Some(format!(
        "touches of unknown points and planes do not tell a device from a larger one: {} {verb} held, and all other \
         lengths are in proportion to it; give the distance of two points ([[contact_pair]]), a cable or a \
         tracker's position",
        held.join(" and ")
    ))
}

/// Readings of rows that the fit did not see.
pub(crate) fn of_wild_held_out(count: usize) -> String {
    format!(
        "readings of held-out rows farther from the model than noise explains: {count}; the fit did not see them, and \
         they are left out of the held-out figures. They are listed as outliers: look whether a sensor failed there"
    )
}

/// Residual of a pair, over its standard deviation, beyond which the pair is not what the rig says.
const PAIR_IS_OFF: f64 = 3.0;

/// Known distances and angles between touched things that the fit contradicts.
fn of_pairs(seen: &[ChannelReport]) -> Vec<String> {
    let pairs = seen.iter().filter(|report| report.is_pair());
    pairs
        .filter_map(|report| {
            let off = *report.after.first()?;
            let sds = off.abs() / report.noise_floor;
            let off = 1e3 * off;
            let what = match report.unit.as_str() {
                "m" => format!("the fitted points' distance is {off:+.3} mm from the stated one"),
                _ => format!("the fitted planes' angle is {off:+.3} mrad from the stated one"),
            };
            (sds > PAIR_IS_OFF).then(|| {
                format!(
                    "{}: {what}, {sds:.1} of its standard deviations: check the stated value and its sd, which two it \
                     names, and whether lengths of the device file are wrong by centimetres",
                    report.channel
                )
            })
        })
        .collect()
}

/// What is said where held-out rows are of a run or a tool of which the fit has no place.
pub(crate) fn of_unseen_places(device: &Device, held_out: &Recording) -> Option<String> {
    let unplaced = device.mounts(held_out).err()?;
    Some(format!(
        "the fit saw no row of {} `{}`: its place was fitted to the held-out rows with the device held, which makes \
         their error a little too small (three or six numbers of as many rows)",
        unplaced.column, unplaced.id
    ))
}

/// Every fold's fit failed: nothing says how the result does elsewhere.
pub(crate) fn of_no_check(folds: usize, reason: Option<&String>) -> String {
    let reason = reason.map_or_else(String::new, |reason| format!(" ({reason})"));
    format!(
        "the result was not checked on rows that the fit did not see: none of {folds} folds could be fitted{reason}; \
         a small residual of so few rows says nothing about other postures"
    )
}

/// What a result has that no good result has: by the rows of the fit, and by those that it is judged on.
pub(crate) fn of_result(
    nominal: &Device,
    fitted: &FittedDevice,
    (seen, channels): (&[ChannelReport], &[ChannelReport]),
    method: CalibrationMethod,
) -> Vec<String> {
    let mut warnings = Vec::new();
    for report in channels.iter().filter(|report| report.outside_range > 0) {
        warnings.push(format!(
            "{}: {} held-out readings lie outside the range that a polynomial was fitted on and \
             were left out",
            report.channel, report.outside_range
        ));
    }
    if let Some(whole) = &fitted.whole {
        warnings.extend(of_scale(nominal, whole));
    }
    if let Some(robust) = &fitted.robust {
        if !robust.settled {
            warnings.push(format!(
                "the weights of the {} loss still moved after {} fits: look at the outliers before you \
                 trust the values",
                robust.loss, robust.rounds
            ));
        }
        if !robust.outliers.is_empty() {
            warnings.push(format!(
                "readings farther from the model than noise explains: {}; the {} loss was used, so they \
                 count little or nothing. They are listed as outliers: look whether a sensor failed there or \
                 the model lacks an effect",
                robust.outliers.len(),
                robust.loss
            ));
        }
    }
    warnings.extend(fitted.whole.iter().flat_map(of_compliance));
    let fits: Vec<&ParameterFit> = match &fitted.whole {
        Some(whole) if method == CalibrationMethod::Joint => vec![whole],
        whole => {
            let steps = fitted
                .transmissions
                .iter()
                .filter_map(|step| step.fit.as_ref());
            whole.iter().chain(steps).collect()
        }
    };
    if let Some(whole) = &fitted.whole {
        warnings.extend(of_search(&whole.starts));
    }
    let found = fits
        .iter()
        .flat_map(|fit| implausible_words(nominal, &fit.device, &fit.parameters, &fit.fitted));
    warnings.extend(implausible_sentence(&found.collect::<Vec<String>>()));
    warnings.extend(of_pairs(seen));
    warnings.extend(of_combinations(&fits));
    warnings.extend(above_floor::sentences(fitted, seen, channels));
    warnings.extend(above_floor::sentences_of_too_little(fitted, seen));
    warnings
}

/// Parameters that a warning names.
const NAMED: usize = 6;

/// A sentence of the parameters that are fixed only together with others; none where there are none.
fn of_combinations(fits: &[&ParameterFit]) -> Option<String> {
    let sums = fits.iter().flat_map(|fit| fit.combinations());
    let names: Vec<String> = sums.map(|sum| sum.terms[0].name.clone()).collect();
    (!names.is_empty()).then(|| {
        let more = match names.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let named = names[..names.len().min(NAMED)].join(", ");
        format!(
            "fixed only in a combination with what the recording does not tell from it: {named}{more}. The intervals \
             count the plausible errors of the others; identified.json lists the combinations, which are known better"
        )
    })
}

/// A sentence of the fitted parameters that lie so far from the device file's values that a unit, a sign or a
/// column is more likely wrong than the device; none where there are none.
///
/// `parameters` of `fitted` at the places `free` are asked; what is around a device has no nominal place.
///
/// ```
/// use haptical_calibration::{candidate_parameters, implausible_deviations};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let nominal = haptical_model::Device::load(path.as_ref())?.device;
/// let parameters = candidate_parameters(&nominal);
/// let free: Vec<usize> = (0..parameters.len()).collect();
/// let mut fitted = nominal.clone();
/// assert!(implausible_deviations(&nominal, &fitted, &parameters, &free).is_none());
/// fitted.links[2].theta_rad += 3.1;
/// let said = implausible_deviations(&nominal, &fitted, &parameters, &free).ok_or("half a turn")?;
/// assert!(said.contains("theta2 by 3.100 rad"), "{said}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn implausible_deviations(
    nominal: &Device,
    fitted: &Device,
    parameters: &[ParameterId],
    free: &[usize],
) -> Option<String> {
    implausible_sentence(&implausible_words(nominal, fitted, parameters, free))
}

fn implausible_sentence(found: &[String]) -> Option<String> {
    (!found.is_empty()).then(|| {
        format!(
            "implausible deviations, over {IMPLAUSIBLE} times what devices show: {}; check units, \
             signs and order of the columns, and that the device file describes this device (the fit \
             may have found a mirror image of it)",
            found.join(", ")
        )
    })
}

fn implausible_words(
    nominal: &Device,
    device: &Device,
    parameters: &[ParameterId],
    free: &[usize],
) -> Vec<String> {
    let asked = free
        .iter()
        .filter_map(|&index| parameters.get(index).copied());
    let found = implausible(nominal, device, asked);
    let words = found.map(|(parameter, moved)| {
        let (name, unit) = (parameter.name(device), parameter.unit(device));
        format!("{name} by {moved:.3} {unit}")
    });
    words.collect()
}
