//! Files of other programs that are no logs: each is named, with the command that makes one of it.

use haptical_data::read_log_from;

use crate::support::single;

#[test]
fn what_is_known_is_named_with_the_way_out() {
    let cases: [(&[u8], &str, &str); 14] = [
        (b"#ROSBAG V2.0\n", "ROS 1 bag", "rosbags-convert"),
        (b"\x89HDF\r\n\x1a\n\0\0", "HDF5", "numpy.savez"),
        (b"MATLAB 7.3 MAT-file", "version 7.3", "'-v7'"),
        (
            b"MATLAB 5.0 MAT-file",
            "MATLAB file",
            "haptical import --guess",
        ),
        (
            b"\x93NUMPY\x01\0",
            "array of NumPy",
            "haptical import --guess",
        ),
        (b"PK\x03\x04\x14\0", ".xlsx", "haptical import --guess"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1", ".xls)", "save it as .xlsx"),
        (b"ARROW1\0\0", "Feather", "to_parquet"),
        (b"TDSm\x0e\0", "TDMS", "nptdms"),
        (b"MDF     4.10", "MDF", "asammdf"),
        (b"\x02P\0\0", "C3D", "ezc3d"),
        (b"ULog\x01\x12\x35\x01", "PX4", "ulog2csv"),
        (b"\x80\x04\x95\x10", "pickle", "CSV or Parquet"),
        (b"[{\"a\": 1}]", "JSON list", "jq -c"),
    ];
    for (content, what, next) in cases {
        let error = read_log_from(content, "log", &single()).unwrap_err();
        assert_eq!(error.kind(), "not-a-log", "{error}");
        let text = error.to_string();
        assert!(text.contains(what) && text.contains(next), "{text}");
    }
}
