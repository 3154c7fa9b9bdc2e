//! A model identified earlier, put where a recording was made.

use haptical_calibration::{
    Channel, FitRequest, Options, Weights, fit_parameters, prepare_device, with_unseen_places,
};
use haptical_identification::Interrupt;
use haptical_model::{Device, ParameterId, Recording, SurroundingParameter};

use crate::DiagnosisError;
use crate::engine::base::Base;

/// The earlier model placed in the recording: the device is the model's, and what was touched is the
/// recording's, placed as the model has it best. Nobody puts a socket back to a tenth of a millimetre, and the
/// same name may be another place.
pub(crate) fn placed(
    model: &Device,
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> Result<Base, DiagnosisError> {
    let mut there = match model.mounts(recording) {
        Ok(_) => model.clone(),
        // a run or a tool of which the model has no place
        Err(_) => with_unseen_places(model, recording)?,
    };
    if channels.iter().any(|channel| is_touched(*channel)) {
        let (own, rig) = (&mut there.surroundings, &device.surroundings);
        own.contacts.clone_from(&rig.contacts);
        own.planes.clone_from(&rig.planes);
        own.plane_pairs.clone_from(&rig.plane_pairs);
        own.contact_sd_m = rig.contact_sd_m;
        own.plane_sd_m = rig.plane_sd_m;
        there.contact_pairs.clone_from(&device.contact_pairs);
        there = prepare_device(&there, recording)?;
        let places = places(&there);
        let weights = Weights::stated(&there, channels);
        let options = Options {
            starts: 0,
            unfinished: true,
            ..Options::default()
        };
        let what = "places of what was touched";
        let fit = fit_parameters(&FitRequest {
            what,
            device: &there,
            recording,
            channels,
            parameters: &places,
            unsupported: &[],
            weights: &weights,
            options: &options,
            start: None,
            yielded: None,
        })?;
        there = fit.device;
    }
    Ok(Base {
        device: there,
        channels: channels.to_vec(),
        parameters: Vec::new(),
        free: Vec::new(),
        anchor: None,
        unfinished: None,
        interrupt: Interrupt::default(),
    })
}

/// Numbers of touched points and planes.
pub(crate) fn places(device: &Device) -> Vec<ParameterId> {
    let all = device.surrounding_parameters().into_iter();
    let touched = all.filter(|parameter| {
        use SurroundingParameter::{Contact, Plane};
        matches!(parameter, Contact { .. } | Plane { .. })
    });
    touched.map(ParameterId::Surrounding).collect()
}

/// Whether a channel is about places that are touched.
fn is_touched(channel: Channel) -> bool {
    match channel {
        Channel::Contact
        | Channel::ContactPair { .. }
        | Channel::Plane
        | Channel::PlanePair { .. } => true,
        Channel::Output { .. }
        | Channel::Cable { .. }
        | Channel::Position
        | Channel::Orientation
        | Channel::Fixture { .. } => false,
    }
}
