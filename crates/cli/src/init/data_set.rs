//! Ten episodes of a humanoid's arm as a LeRobot data set, with three faults put in.

use super::{Contents, command};

// 59 kB: three joints of a public recording (MIT; fixtures/measured/README.md has its origin, and what was planted)
const DATA: &[u8] = include_bytes!("../../assets/data-set/file-000.parquet");
const INFO: &[u8] = include_bytes!("../../assets/data-set/info.json");
const LICENCE: &[u8] = include_bytes!("../../assets/data-set/LICENSE");

pub(super) fn faults() -> Contents {
    Contents {
        files: vec![
            (
                "data/chunk-000/file-000.parquet",
                DATA.to_vec(),
                "commands and positions of three joints, 30 rows a second",
            ),
            (
                "meta/info.json",
                INFO.to_vec(),
                "the data set's description",
            ),
            ("LICENSE", LICENCE.to_vec(), "licence of the recording"),
        ],
        next: vec![command("haptical doctor =.")],
    }
}
