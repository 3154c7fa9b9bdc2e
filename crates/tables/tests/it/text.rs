//! Texts in the dialects of other programs: what a wrong guess would read silently.

use haptical_tables::{Cells, Reading, table_from_bytes};

use crate::support::{numbers, read, table};

#[test]
fn separators_are_found() {
    for text in [
        "a,b,c\n1,2.5,3\n4,5,6\n",
        "a;b;c\n1;2.5;3\n4;5;6\n",
        "a\tb\tc\n1\t2.5\t3\n4\t5\t6\n",
        "a b  c\n1 2.5   3\n  4 5 6\n",
        "a|b|c\n1|2.5|3\n4|5|6\n",
        "a, b, c\n1, 2.5, 3\n4, 5, 6\n",
        "a;b;c\r\n1;2,5;3\r\n4;5;6\r\n",
        "a b c\n1,0 2,5 3,0\n4,0 5,0 6,0\n",
        "a,b,c\n\"1\",\"2,5\",3\n\"4\",\"5,0\",6\n",
    ] {
        let table = table(text);
        let wanted = [
            ("a", &[1.0, 4.0][..]),
            ("b", &[2.5, 5.0]),
            ("c", &[3.0, 6.0]),
        ];
        assert_eq!(numbers(&table), wanted, "{text}");
    }
}

/// A spreadsheet's error is a cell, also where its line looks like a comment.
#[test]
fn cells_without_a_value_are_no_reading_and_drop_nothing() {
    for word in [
        "#N/A",
        "#DIV/0!",
        "None",
        "1.#QNAN",
        "-1.#IND",
        "NULL",
        "-nan(ind)",
    ] {
        let table = table(&format!("a,b\n1,2\n{word},3\n4,{word}\n"));
        let found = numbers(&table);
        let [(_, a), (_, b)] = found.as_slice() else {
            panic!("{word}: {found:?}");
        };
        assert_eq!((a[0], a[2], b[0], b[1]), (1.0, 4.0, 2.0, 3.0), "{word}");
        assert!(a[1].is_nan() && b[2].is_nan(), "{word}");
    }
}

/// 1,234 in a table of semicolons is 1.234, never 1234; a thousands sign beside it is no number.
#[test]
fn a_decimal_comma_is_no_thousand() {
    let german = table("q;x\n0,5;1,234\n-0,25;2,500\n");
    assert_eq!(numbers(&german)[1].1, [1.234, 2.5]);
    assert_eq!(german.dialect.unwrap().decimal, ',');
    let thousands = table("q;x\n0,5;1.234,5\n-0,25;2,5\n");
    assert!(matches!(&thousands.columns[1].cells, Cells::Texts(cells) if cells[0] == "1.234,5"));
    // both signs in one table: neither is taken for the other
    let mixed = table("q;x\n0.5;1,5\n0.25;2,5\n");
    assert_eq!(numbers_of(&mixed.columns[0].cells), Some(vec![0.5, 0.25]));
    assert_eq!(numbers_of(&mixed.columns[1].cells), None);
}

fn numbers_of(cells: &Cells) -> Option<Vec<f64>> {
    cells.numbers().map(<[f64]>::to_vec)
}

#[test]
fn units_comments_and_preambles_are_no_rows() {
    let text = "Messung 3\n# comment\nt;q1;x\n[s];(deg);mm\n% another\n0;10;300\n1;11;301\n";
    let table = table(text);
    assert_eq!(numbers(&table)[1], ("q1", &[10.0, 11.0][..]));
    let units: Vec<Option<&str>> = table
        .columns
        .iter()
        .map(|column| column.unit.as_deref())
        .collect();
    assert_eq!(units, [Some("s"), Some("deg"), Some("mm")]);
    assert_eq!(table.lines, [6, 7]);
    assert!(table.notes[0].contains("preamble"), "{:?}", table.notes);
}

#[test]
fn names_may_be_in_a_comment_or_nowhere() {
    let named = table("# t q1 q2\n0 1 2\n1 3 4\n");
    assert_eq!(numbers(&named)[2], ("q2", &[2.0, 4.0][..]));
    let unnamed = table("# of a day in March\n0 1 2\n1 3 4\n");
    assert!(!unnamed.is_named);
    assert_eq!(numbers(&unnamed)[2], ("#3", &[2.0, 4.0][..]));
    assert!(unnamed.find("q1").unwrap_err().what.contains("no header"));
}

#[test]
fn latin_1_and_utf_16_are_read() {
    let latin1 = b"Pr\xfcfling;q [\xb0]\n1;90\n2;45\n";
    let table = table_from_bytes(latin1.to_vec(), "table.txt", &Reading::default()).unwrap();
    assert_eq!(table.columns[0].name, "Prüfling");
    assert_eq!(table.columns[1].unit.as_deref(), Some("°"));
    assert!(table.notes[0].contains("Latin-1"), "{:?}", table.notes);
    let utf16: Vec<u8> = [0xff, 0xfe]
        .into_iter()
        .chain("a;b\n1;2\n3;4\n".encode_utf16().flat_map(u16::to_le_bytes))
        .collect();
    let table = table_from_bytes(utf16, "table.txt", &Reading::default()).unwrap();
    assert_eq!(numbers(&table)[1], ("b", &[2.0, 4.0][..]));
    let strict = Reading {
        encoding: Some("utf-8".into()),
        ..Reading::default()
    };
    assert_eq!(
        table_from_bytes(latin1.to_vec(), "table.txt", &strict)
            .unwrap_err()
            .kind,
        "not-text"
    );
}

/// NumPy's arrays printed into cells, over several lines.
#[test]
fn lists_in_cells_become_columns() {
    let text = ",joints,markers\n0,[ 9.6e-01 -8.5e-01\n 0.5],\"[[-1.8  2.2]\n [-3.0 1.6]]\"\n1,[ 1. 2. 3.],\"[[4 5]\n [6 7]]\"\n";
    // the first list is not quoted, so it goes over a line only in quotation marks
    let text = text.replace("[ 9.6e-01 -8.5e-01\n 0.5]", "\"[ 9.6e-01 -8.5e-01\n 0.5]\"");
    let table = table(&text);
    let names: Vec<&str> = table
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(names[1..4], ["joints[1]", "joints[2]", "joints[3]"]);
    assert_eq!(numbers(&table)[6], ("markers[3]", &[-3.0, 6.0][..]));
}

#[test]
fn what_does_not_fit_is_refused_with_its_line() {
    let ragged = read("a;b\n1;2\n3\n4;5\n", &Reading::default()).unwrap_err();
    assert_eq!((ragged.kind, ragged.line), ("cell-count", Some(3)));
    assert_eq!(read("", &Reading::default()).unwrap_err().kind, "no-rows");
    let none = Reading {
        header: Some(true),
        ..Reading::default()
    };
    assert_eq!(read("x;y\nu;v\n", &none).unwrap().columns[0].cells.len(), 1);
    let units = Reading {
        units_row: Some(true),
        ..Reading::default()
    };
    assert_eq!(read("1;2\n3;4\n", &units).unwrap_err().kind, "no-units");
    for (bytes, word) in [
        (&b"PAR1\x15"[..], ""),
        (b"\x89MCAP0\r\n", "import bag"),
        (b"#ROSBAG V2.0\n", "rosbags-convert"),
        (b"a\0b\n", "zero"),
    ] {
        let error = table_from_bytes(bytes.to_vec(), "file", &Reading::default()).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
}

#[test]
fn json_lines_are_a_table() {
    let table = table(
        "{\"t\": 1, \"arm\": {\"q\": [0.5, 1]}, \"who\": \"a\"}\n{\"t\": 2, \"arm\": {\"q\": [0.25, null]}}\n",
    );
    let names: Vec<&str> = table
        .columns
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    assert_eq!(names, ["arm.q[1]", "arm.q[2]", "t", "who"]);
    assert!(table.columns[1].cells.numbers().unwrap()[1].is_nan());
}
