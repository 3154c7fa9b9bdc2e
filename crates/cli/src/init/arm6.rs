//! Examples of an arm that a URDF describes: a tracker, or a ball in sockets.

use haptical::files::Source;
use haptical::{Device, Equipment, Log, Truth, simulate_postures};
use haptical_data::{LogShape, read_log_from};
use haptical_design::Rig;

use super::{Contents, LOG_FILE, command, log};
use crate::failure::Failure;

/// The description: no arm that is sold.
const DESCRIPTION: &str = include_str!("../../assets/arm6.urdf");
const DESCRIPTION_FILE: &str = "arm6.urdf";
/// Postures that `haptical plan` chose for each rig, rounded.
const POSES: &str = include_str!("../../assets/arm6-poses.csv");
const TOUCHES: &str = include_str!("../../assets/arm6-touches.csv");
/// Name of the rig file.
const RIG_FILE: &str = "rig.toml";
/// How far the simulated arm is off, as a share of what is plausible (5 mm, 20 mrad), and the seed.
const DEVIATION: f64 = 0.2;
const SEED: u64 = 1;

/// A tracker anywhere in the room.
pub(super) fn tracker() -> Result<Contents, Failure> {
    made(
        "pose:unknown",
        POSES,
        "60 simulated postures: joint angles, and the tool's pose as a tracker sees it",
        "a tracker whose place is unknown, and its noise",
    )
}

/// A ball in two sockets.
pub(super) fn sockets() -> Result<Contents, Failure> {
    made(
        "contact:2:0.05",
        TOUCHES,
        "60 simulated postures with the ball in one of two sockets: joint angles, and which socket",
        "two sockets 50 mm apart, and how well they hold the ball",
    )
}

fn made(
    rig: &str,
    postures: &str,
    of_log: &'static str,
    of_rig: &'static str,
) -> Result<Contents, Failure> {
    let source = Source::text(DESCRIPTION, DESCRIPTION_FILE);
    let device = Device::open(&source, &Equipment::default())?;
    let shape = LogShape::from(&device.model);
    let read = read_log_from(postures.as_bytes(), "postures.csv", &shape);
    let read = read.map_err(Failure::internal)?.recording;
    let postures = Log::from_recording(read, "postures.csv", &device)?;
    let rig = Rig::parse(rig).map_err(Failure::internal)?;
    let truth = Truth::Drawn(DEVIATION);
    let made = simulate_postures(&device, truth, &postures, Some(&rig), SEED)?;
    let log = log(&made.recording, &made.truth)?;
    let rig = made.rig.unwrap_or_default();
    Ok(Contents {
        files: vec![
            (
                DESCRIPTION_FILE,
                DESCRIPTION.into(),
                "the arm as it was designed; put your own in its place",
            ),
            (RIG_FILE, rig.into_bytes(), of_rig),
            (LOG_FILE, log, of_log),
        ],
        next: vec![
            command(
                "haptical identify --device =arm6.urdf --rig =rig.toml --log =log.csv --out =result",
            ),
            command(
                "haptical export --device =result/identified.toml --format urdf --urdf =arm6.urdf --out =calibrated.urdf",
            ),
        ],
    })
}
