//! The chain behind a cable as a model of distances.

use haptical_batch::DistanceModel;
use haptical_model::Device;
use haptical_model::kinematics::Parameter;

/// The chain behind a cable, with its parameters; none where chain or cable are not plain, or a number is refused.
pub(crate) fn cable_model(
    device: &Device,
    index: usize,
    parameters: &[(usize, Parameter)],
) -> Option<DistanceModel> {
    let cable = device.cables.get(index);
    if !device.is_plain_table() || cable.is_some_and(|cable| !cable.is_plain()) {
        return None;
    }
    let anchor_m = cable.map_or([0.0; 3], |cable| cable.anchor_m);
    let motions = device.motions();
    let model = DistanceModel::new(device.convention, &device.links, &motions, anchor_m);
    model.ok()?.with_parameters(parameters).ok()
}
