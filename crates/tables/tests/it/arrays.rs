//! Arrays of NumPy and MATLAB, byte by byte.

use haptical_tables::{Reading, Table, TableError, table_from_bytes};

use crate::support::numbers;

fn read(bytes: Vec<u8>, transpose: bool) -> Result<Table, TableError> {
    let reading = Reading {
        transpose: Some(transpose),
        ..Reading::default()
    };
    table_from_bytes(bytes, "array", &reading)
}

fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn numbers_of_every_kind_are_read() {
    let header =
        |kind: &str| format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2,), }}");
    let cases: [(&str, Vec<u8>); 7] = [
        (
            "<f8",
            [1.0_f64, -2.0]
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect(),
        ),
        (
            ">f8",
            [1.0_f64, -2.0]
                .iter()
                .flat_map(|number| number.to_be_bytes())
                .collect(),
        ),
        (
            "<f4",
            [1.0_f32, -2.0]
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect(),
        ),
        (
            "<i8",
            [1_i64, -2]
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect(),
        ),
        (
            ">i4",
            [1_i32, -2]
                .iter()
                .flat_map(|number| number.to_be_bytes())
                .collect(),
        ),
        (
            "<i2",
            [1_i16, -2]
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect(),
        ),
        ("|i1", vec![1, 0xfe]),
    ];
    for (kind, data) in cases {
        let table = read(npy(&header(kind), &data), false).unwrap();
        assert_eq!(numbers(&table), [("array", &[1.0, -2.0][..])], "{kind}");
    }
}

#[test]
fn the_first_axis_is_the_row_unless_said() {
    let data: Vec<u8> = (0..6)
        .flat_map(|number| f64::from(number).to_le_bytes())
        .collect();
    let header =
        |order: &str| format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': (2, 3), }}");
    let table = read(npy(&header("False"), &data), false).unwrap();
    assert_eq!(numbers(&table)[1], ("array[2]", &[1.0, 4.0][..]));
    let fortran = read(npy(&header("True"), &data), false).unwrap();
    assert_eq!(numbers(&fortran)[1], ("array[2]", &[2.0, 3.0][..]));
    let turned = read(npy(&header("False"), &data), true).unwrap();
    assert_eq!(numbers(&turned)[1], ("array[2]", &[3.0, 4.0, 5.0][..]));
}

/// Matrices one behind the other, as MATLAB keeps them: the last axis is the row, and it is said.
#[test]
fn the_last_axis_of_matrices_is_the_row() {
    let data: Vec<u8> = (0..80)
        .flat_map(|number| f64::from(number).to_le_bytes())
        .collect();
    let header = "{'descr': '<f8', 'fortran_order': True, 'shape': (4, 4, 5), }";
    let table = |reading: Reading| table_from_bytes(npy(header, &data), "array", &reading).unwrap();
    let turned = table(Reading::default());
    // element 2 is row 1, column 2: 4 numbers on in the order of Fortran
    let expected = [4.0, 20.0, 36.0, 52.0, 68.0];
    assert_eq!(numbers(&turned)[1], ("array[2]", &expected[..]));
    assert!(
        turned.notes[0].contains("4 x 4 x 5: its last axis"),
        "{:?}",
        turned.notes
    );
    let kept = table(Reading {
        transpose: Some(false),
        ..Reading::default()
    });
    assert_eq!(kept.columns.len(), 20);
    assert!(kept.notes.is_empty());
}

#[test]
fn what_is_no_array_of_numbers_is_refused() {
    let header = |kind: &str, shape: &str| {
        format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}")
    };
    for (bytes, kind, word) in [
        (
            npy(&header("'<f8'", "(3,)"), &[0; 16]),
            "damaged",
            "fewer numbers",
        ),
        (
            npy(&header("'<U4'", "(1,)"), &[0; 16]),
            "not-a-table",
            "astype",
        ),
        (
            npy(&header("[('q', '<f8')]", "(1,)"), &[0; 8]),
            "not-a-table",
            "named parts",
        ),
        (
            npy(&header("'<f8'", "(99999999999, 99999999999)"), &[]),
            "too-large",
            "",
        ),
        (npy(&header("'<f8'", "(4000000000,)"), &[]), "too-large", ""),
        (npy("{}", &[]), "damaged", "descr"),
        (
            npy(&header("'<f8'", "(1, 5000)"), &[0; 40000]),
            "too-many-columns",
            "transpose",
        ),
        (b"\x93NUMPY\x01\0\xff\xff".to_vec(), "damaged", "header"),
    ] {
        let error = read(bytes, false).unwrap_err();
        assert_eq!(error.kind, kind, "{error}");
        assert!(error.to_string().contains(word), "{error}");
    }
}

/// Flat columns and lists, of files that pyarrow wrote; texts are left out and named.
#[cfg(feature = "parquet")]
#[test]
fn columns_of_parquet_are_read() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/tests/fixtures/snappy.parquet"
    );
    let Ok(bytes) = std::fs::read(path) else {
        println!("skipped: the fixtures of haptical-data are not here");
        return;
    };
    let table = read(bytes, false).unwrap();
    let csv = std::fs::read(std::path::Path::new(path).with_file_name("log.csv")).unwrap();
    let csv = read(csv, false).unwrap();
    for name in ["t_s", "theta2_rad", "x_m"] {
        let cells = |table: &Table| format!("{:?}", table.columns[table.find(name).unwrap()].cells);
        assert_eq!(cells(&table), cells(&csv), "{name}");
    }
    assert!(table.notes[0].contains("contact"), "{:?}", table.notes);
}

/// An element of a MAT-file.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = kind.to_le_bytes().to_vec();
    bytes.extend(u32::try_from(data.len()).unwrap().to_le_bytes());
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn matrix(class: u32, shape: [i32; 2], name: &str, rest: &[u8]) -> Vec<u8> {
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let shape: Vec<u8> = shape.iter().flat_map(|size| size.to_le_bytes()).collect();
    element(
        14,
        &[
            element(6, &flags),
            element(5, &shape),
            element(1, name.as_bytes()),
            rest.to_vec(),
        ]
        .concat(),
    )
}

fn mat(elements: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1]);
    bytes.extend(b"IM");
    bytes.extend(elements.concat());
    bytes
}

/// MATLAB keeps small whole numbers in few bytes, and names of four letters within the tag.
#[test]
fn matlab_s_small_kinds_and_structures_are_read() {
    let bytes: Vec<u8> = element(2, &[1, 2, 3, 4, 5, 6]);
    let q = matrix(6, [2, 3], "q", &bytes);
    let row = matrix(6, [1, 3], "t", &element(2, &[7, 8, 9]));
    let text = matrix(4, [1, 2], "who", &element(2, b"ab"));
    let mut small = matrix(
        7,
        [3, 1],
        "",
        &element(
            7,
            &[1.5_f32, 2.5, 3.5]
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect::<Vec<u8>>(),
        ),
    );
    let fields = [
        vec![5, 0, 4, 0],
        8_u32.to_le_bytes().to_vec(),
        element(1, b"tau\0\0\0\0\0"),
    ]
    .concat();
    let data = matrix(
        2,
        [1, 1],
        "data",
        &[fields, std::mem::take(&mut small)].concat(),
    );
    let table = read(mat(&[q, row, text, data]), false).unwrap();
    assert_eq!(
        numbers(&table),
        [
            ("q[1]", &[1.0, 2.0][..]),
            ("q[2]", &[3.0, 4.0]),
            ("q[3]", &[5.0, 6.0]),
            ("t", &[7.0, 8.0, 9.0]),
            ("data.tau", &[1.5, 2.5, 3.5]),
        ]
    );
    assert!(table.notes[0].contains("who"), "{:?}", table.notes);
}
