//! Tables in all five forms.

use haptical_report::{Cell, Column, ReportError, Table};
use proptest::prelude::*;

fn sample() -> Table {
    let columns = vec![
        Column::new("parameter", ""),
        Column::new("estimate", "mm"),
        Column::new("interval", "mm"),
        Column::new("cost", ""),
    ];
    let mut table = Table::new("Drums | all", columns);
    let rows = [
        (
            "outer, \"A\"",
            Cell::number(-0.20049, 3),
            Cell::interval(-0.3, 0.125, 2),
        ),
        ("inner", Cell::number(12.0, 3), Cell::Missing),
        ("<home>", Cell::Missing, Cell::number(0.5, 1)),
    ];
    for (name, estimate, interval) in rows {
        table
            .push(vec![
                name.into(),
                estimate,
                interval,
                Cell::scientific(2.71828e-9, 3),
            ])
            .unwrap();
    }
    table.notes.push("A note.".to_owned());
    table
}

#[test]
fn terminal_lines_are_of_one_width_with_numbers_at_the_right() {
    let text = sample().to_terminal();
    let expected = "\
Drums | all
┌────────────┬───────────────┬───────────────┬─────────┐
│ parameter  │ estimate [mm] │ interval [mm] │    cost │
├────────────┼───────────────┼───────────────┼─────────┤
│ outer, \"A\" │        -0.200 │ -0.30 to 0.12 │ 2.72e-9 │
│ inner      │        12.000 │             – │ 2.72e-9 │
│ <home>     │             – │           0.5 │ 2.72e-9 │
└────────────┴───────────────┴───────────────┴─────────┘
A note.";
    assert_eq!(text, expected);
}

#[test]
fn a_rounded_zero_has_no_minus_and_large_numbers_get_an_exponent() {
    let mut table = Table::new("", vec![Column::new("x", "")]);
    for value in [-0.0004, -0.0, 1e300, -0.0006] {
        table.push(vec![Cell::number(value, 3)]).unwrap();
    }
    let text = table.to_terminal();
    assert!(!text.contains("-0.000"), "{text}");
    assert!(
        text.contains("-0.001") && text.contains("1.000e300"),
        "{text}"
    );
}

#[test]
fn markdown_escapes_bars_and_tags() {
    let text = sample().to_markdown();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "**Drums \\| all**");
    assert_eq!(
        lines[2],
        "| parameter | estimate [mm] | interval [mm] | cost |"
    );
    assert_eq!(lines[3], "| :--- | ---: | ---: | ---: |");
    assert_eq!(lines[6], "| &lt;home> | – | 0.5 | 2.72e-9 |");
    assert_eq!(lines.last(), Some(&"A note."));
}

#[test]
fn csv_keeps_all_digits_splits_intervals_and_quotes() {
    let text = sample().to_csv().unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "parameter,estimate [mm],interval low [mm],interval high [mm],cost"
    );
    assert_eq!(
        lines[1],
        "\"outer, \"\"A\"\"\",-0.20049,-0.3,0.125,2.71828e-9"
    );
    assert_eq!(lines[2], "inner,12,,,2.71828e-9");
    assert_eq!(lines[3], "<home>,,0.5,0.5,2.71828e-9");
    assert_eq!(lines.len(), 4);
}

#[test]
fn json_holds_raw_numbers() {
    let mut table = sample();
    table
        .push(vec![
            "count".into(),
            Cell::number(3.0, 0),
            Cell::Missing,
            Cell::Missing,
        ])
        .unwrap();
    let value = table.to_json();
    assert_eq!(value["columns"][1]["unit"], "mm");
    assert_eq!(value["rows"][0][1].as_f64(), Some(-0.20049));
    assert_eq!(value["rows"][0][2][1].as_f64(), Some(0.125));
    assert!(value["rows"][1][2].is_null());
    assert_eq!(value["rows"][3][1].as_i64(), Some(3));
    assert_eq!(value["rows"][0][3].as_f64(), Some(2.71828e-9));
    assert_eq!(value["notes"][0], "A note.");
    assert_eq!(value["title"], "Drums | all");
}

#[test]
fn html_escapes_and_marks_number_columns() {
    let html = sample().to_html().into_string();
    assert!(
        html.contains("&lt;home&gt;") && !html.contains("<home>"),
        "{html}"
    );
    assert!(
        html.contains("<td class=\"number\" data-label=\"estimate [mm]\">-0.200</td>"),
        "{html}"
    );
    assert!(
        html.contains("<td class=\"text short\" data-label=\"parameter\">inner</td>"),
        "{html}"
    );
    assert!(html.contains("10<sup>\u{2212}9</sup></span>"), "{html}");
    assert!(html.contains("<span class=\"unit\">[mm]</span>"), "{html}");
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    let mut table = sample();
    let narrow = table.push(vec!["one".into()]).unwrap_err();
    assert!(
        matches!(
            narrow,
            ReportError::RowWidth {
                expected: 4,
                got: 1,
                ..
            }
        ),
        "{narrow}"
    );
    let row = |cell| vec!["x".into(), Cell::Missing, cell, Cell::Missing];
    let nan = table.push(row(Cell::number(f64::NAN, 2))).unwrap_err();
    assert!(
        matches!(&nan, ReportError::NonFinite { index: 3, .. }),
        "{nan}"
    );
    assert!(nan.to_string().contains("interval"), "{nan}");
    assert!(
        table
            .push(row(Cell::interval(0.0, f64::INFINITY, 2)))
            .is_err()
    );
    assert_eq!(table.rows().len(), 3);
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let mut table = Table::new("a\u{1b}[31mb", vec![Column::new("x", "")]);
    table.push(vec!["c\u{1b}[0m\u{7}d".into()]).unwrap();
    assert!(!table.to_terminal().contains(['\u{1b}', '\u{7}']));
    assert!(!table.to_html().into_string().contains('\u{1b}'));
    assert!(!table.to_markdown().contains('\u{1b}'));
}

#[test]
fn a_table_without_rows_has_its_head() {
    let table = Table::new("Empty", vec![Column::new("x", "m")]);
    assert!(table.to_terminal().contains("x [m]"));
    assert_eq!(table.to_csv().unwrap(), "x [m]\n");
    assert_eq!(table.to_json()["rows"].as_array().map(Vec::len), Some(0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn csv_numbers_read_back_exactly(values in prop::collection::vec(prop::num::f64::NORMAL, 1..10)) {
        let mut table = Table::new("", vec![Column::new("x", "")]);
        for &value in &values {
            table.push(vec![Cell::number(value, 1)]).unwrap();
        }
        let text = table.to_csv().unwrap();
        let read: Vec<f64> = text.lines().skip(1).map(|line| line.parse().unwrap()).collect();
        prop_assert_eq!(read, values);
    }

    #[test]
    fn any_text_gives_one_csv_record_per_row(cells in prop::collection::vec(".*", 1..6)) {
        let mut table = Table::new("", vec![Column::new("x", ""), Column::new("y", "")]);
        for cell in &cells {
            table.push(vec![cell.as_str().into(), "end".into()]).unwrap();
        }
        let text = table.to_csv().unwrap();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let read: Vec<String> =
            reader.records().map(|record| record.unwrap()[0].to_owned()).collect();
        prop_assert_eq!(read, cells);
        let _ = (table.to_terminal(), table.to_markdown(), table.to_html());
    }
}
