//! The force test on synthetic recordings and against mechanics by another route.

mod absent;
mod arm;
mod carried;
mod found;
mod mechanics;
mod of_device;
mod second;
mod slide;
mod trust;

use haptical_calibration::Channel;
use haptical_effects::{Context, Stream};
use haptical_model::{Device, Recording};

use self::arm::arm;
use super::answer::ForceAnswer;

/// The answer to a recording of the arm.
fn examined(recording: &Recording) -> ForceAnswer {
    examined_as(&arm(), recording)
}

/// The answer where something sees the handle: a hand may hold it.
fn examined_held(recording: &Recording) -> ForceAnswer {
    let device = arm();
    let tracker = Stream {
        channel: Channel::Position,
        axis: 0,
        unit: "m",
    };
    let context = Context::new(&device, recording, &[tracker]).unwrap();
    crate::force::examine(&context, None, &[]).unwrap()
}

fn examined_as(device: &Device, recording: &Recording) -> ForceAnswer {
    let context = Context::new(device, recording, &[]).unwrap();
    crate::force::examine(&context, None, &[]).unwrap()
}
