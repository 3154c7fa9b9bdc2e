//! Times of a table, a figure and a page: `cargo bench -p haptical-report`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use haptical_report::{
    Block, Cell, Column, Document, Figure, Mark, ReportError, Section, Series, Table,
};

/// Points of the figure, as residuals of a log that was thinned.
const POINTS: u32 = 1000;
/// Rows of the table, as the parameters of a device.
const ROWS: u32 = 50;

fn table() -> Result<Table, ReportError> {
    let columns = [("parameter", ""), ("value", "mm"), ("interval", "mm")];
    let columns = columns.map(|(name, unit)| Column::new(name, unit)).to_vec();
    let mut table = Table::new("Parameters", columns);
    for row in 0..ROWS {
        let value = f64::from(row).sin();
        table.push(vec![
            format!("a{row}").into(),
            Cell::number(value, 4),
            Cell::interval(value - 0.1, value + 0.1, 4),
        ])?;
    }
    Ok(table)
}

fn figure() -> Figure {
    let mut figure = Figure::new("Residuals", "time [s]", "error [mrad]");
    for (colour, label) in ["before", "after"].into_iter().enumerate() {
        let size = 1.0 / (1 + colour) as f64;
        let points = (0..POINTS).map(|k| (0.06 * f64::from(k), size * (0.7 * f64::from(k)).sin()));
        let series = Series::new(label, Mark::Line, colour, points.collect());
        figure.series.push(series);
    }
    figure
}

fn page(criterion: &mut Criterion) {
    let (table, figure) = (table(), figure());
    assert!(table.is_ok(), "{table:?}");
    let (Ok(table), Ok(svg)) = (table, figure.to_svg(860, 460)) else {
        return;
    };
    let mut group = criterion.benchmark_group("report");
    group.bench_function("table of 50 rows for the terminal", |bencher| {
        bencher.iter(|| black_box(&table).to_terminal());
    });
    group.bench_function("table of 50 rows as CSV", |bencher| {
        bencher.iter(|| black_box(&table).to_csv());
    });
    group.bench_function("figure of 2 lines of 1000 points", |bencher| {
        bencher.iter(|| black_box(&figure).to_svg(860, 460));
    });
    let caption = "Residuals before and after".to_owned();
    let blocks = vec![Block::Table(table), Block::Svg { caption, svg }];
    let document = Document::new("Report", "", vec![Section::new("Residuals", blocks)]);
    group.bench_function("page with both", |bencher| {
        bencher.iter(|| black_box(&document).to_html());
    });
    group.finish();
}

criterion_group!(benches, page);
criterion_main!(benches);
