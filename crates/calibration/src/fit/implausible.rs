//! Fitted values too far from the device file's to be the device's.

use haptical_model::{Device, ParameterId};

use crate::ParameterFit;

/// Deviation, in plausible sizes, beyond which a value is more likely a wrong unit, a swapped column
/// or a mirror image of the device than the device: half a decimetre, a fifth of a radian.
pub(crate) const IMPLAUSIBLE: f64 = 10.0;

/// Parameters that moved by more than is plausible, with the move.
pub(crate) fn implausible(
    nominal: &Device,
    device: &Device,
    parameters: impl Iterator<Item = ParameterId>,
) -> impl Iterator<Item = (ParameterId, f64)> {
    parameters.filter_map(|parameter| {
        let before = match parameter {
            ParameterId::Link { .. } => parameter.value(nominal),
            // nobody knows beforehand where these are
            ParameterId::Surrounding(_) => return None,
            // a transmission's nominal error is zero, whatever form it now has
            _ => 0.0,
        };
        let moved = parameter.value(device) - before;
        let limit = IMPLAUSIBLE * parameter.plausible_size(device);
        (moved.abs() > limit).then_some((parameter, moved))
    })
}

/// Names of a fit's link parameters among these.
pub(crate) fn implausible_links(nominal: &Device, fit: &ParameterFit) -> Vec<String> {
    let fitted = fit.fitted.iter().map(|&index| fit.parameters[index]);
    let links = fitted.filter(|parameter| matches!(parameter, ParameterId::Link { .. }));
    implausible(nominal, &fit.device, links)
        .map(|(parameter, _)| parameter.name(nominal))
        .collect()
}
