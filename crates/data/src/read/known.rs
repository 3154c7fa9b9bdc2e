//! Files of other programs that are taken for a log: what they are, and what makes a log of them.

use crate::error::place::Place;
use crate::error::{DataError, Fault};

/// How such a file begins, what it is, what to do.
type Known = (&'static [u8], &'static str, &'static str);

const TO_IMPORT: &str = "its columns must be named: `haptical import --guess FILE` proposes how, then `haptical import --columns` writes the log";

const KNOWN: [Known; 14] = [
    (
        b"#ROSBAG V",
        "a ROS 1 bag",
        "convert it to ROS 2: rosbags-convert --src FILE.bag --dst FOLDER --dst-storage mcap (pip install rosbags), and give the \
         .mcap file in FOLDER",
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file",
        "save its arrays in Python, numpy.savez(\"log.npz\", q=file[\"q\"][:], ...) with h5py, and give log.npz to `haptical import \
         --guess`",
    ),
    (
        b"MATLAB 7.3",
        "a MATLAB file of version 7.3",
        "save it in MATLAB with save(..., '-v7'), and give it to `haptical import --guess`",
    ),
    (b"MATLAB 5.0", "a MATLAB file", TO_IMPORT),
    (b"\x93NUMPY", "an array of NumPy", TO_IMPORT),
    (
        b"PK\x03\x04",
        "a spreadsheet (.xlsx), arrays of NumPy (.npz) or another zip archive",
        TO_IMPORT,
    ),
    (
        b"\xd0\xcf\x11\xe0",
        "an old spreadsheet (.xls)",
        "save it as .xlsx or CSV, and give it to `haptical import --guess`",
    ),
    (
        b"ARROW1",
        "an Arrow (Feather) file",
        "save it as Parquet: pandas.read_feather(\"FILE\").to_parquet(\"log.parquet\", compression=\"snappy\")",
    ),
    (
        b"ULog\x01",
        "a log of PX4 (ULog)",
        "convert it: ulog2csv FILE (pip install pyulog), and give its topic to `haptical import --guess`",
    ),
    (
        b"TDSm",
        "a recording of LabVIEW (TDMS)",
        "save its channels in Python, nptdms.TdmsFile.read(\"FILE\").as_dataframe().to_csv(\"log.csv\"), and give log.csv to \
         `haptical import --guess`",
    ),
    (
        b"MDF     ",
        "a measurement of ASAM (MDF)",
        "save its channels in Python, asammdf.MDF(\"FILE\").to_dataframe().to_csv(\"log.csv\"), and give log.csv to `haptical import \
         --guess`",
    ),
    (
        b"\x02P",
        "a recording of markers (C3D)",
        "save the markers' places in Python, ezc3d.c3d(\"FILE\")[\"data\"][\"points\"], with numpy.savez, and give them to `haptical \
         import --guess`",
    ),
    (
        b"[{",
        "a JSON list",
        "write one object a line: jq -c '.[]' FILE > log.jsonl",
    ),
    (
        b"[\n",
        "a JSON list",
        "write one object a line: jq -c '.[]' FILE > log.jsonl",
    ),
];

/// What a file is that is known by its first bytes and is no log, and what makes one of it.
///
/// ```
/// let (what, next) = haptical_data::known_file(b"#ROSBAG V2.0\n").unwrap();
/// assert!(what.contains("ROS 1") && next.contains("rosbags-convert"));
/// assert!(haptical_data::known_file(b"t_s,theta1_rad\n").is_none());
/// ```
pub fn known_file(first: &[u8]) -> Option<(&'static str, &'static str)> {
    // pickles begin with their version, and run what they hold
    if matches!(first, [0x80, 2..=5, ..]) {
        let next =
            "it can hold programs, so it is not read; save the log in Python as CSV or Parquet";
        return Some(("a pickle of Python", next));
    }
    let known = KNOWN.iter().find(|(magic, _, _)| first.starts_with(magic));
    known.map(|(_, what, next)| (*what, *next))
}

/// Refuses a file that begins as one that is known and not read as a log.
pub(crate) fn refuse(first: &[u8], name: &str) -> Result<(), DataError> {
    match known_file(first) {
        None => Ok(()),
        Some((what, next)) => Err(Place::file(name).error(Fault::NotALog {
            what: format!("this is {what}, which is no log"),
            advice: next.to_owned(),
        })),
    }
}
