//! An example of an arm that moves: positions and torques, and a description that lacks something.

use super::{Contents, command};

/// An invented arm of seven joints.
const DESCRIPTION: &str = include_str!("../../assets/arm7.xml");
/// Eight seconds that MuJoCo simulated, with 1 kg beyond the flange and other armatures.
const LOG: &[u8] = include_bytes!("../../assets/arm7-loaded.csv.gz");

pub(super) fn moving() -> Contents {
    Contents {
        files: vec![
            (
                "arm7.xml",
                DESCRIPTION.into(),
                "the arm as it was designed (MJCF); put your own in its place",
            ),
            (
                "log.csv.gz",
                LOG.into(),
                "8 s of a motion that MuJoCo simulated: joint positions and torques at 250 Hz",
            ),
        ],
        next: vec![
            command("haptical diagnose --device =arm7.xml --log =log.csv.gz --out =gap"),
            command(
                "haptical export --device =gap/corrected.toml --format mjcf --mjcf =arm7.xml --out =corrected.xml",
            ),
        ],
    }
}
