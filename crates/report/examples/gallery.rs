//! Writes a page with every kind of figure and table, and each figure as a file of its own, to the
//! folder given as the first argument. The numbers are invented.

use std::path::PathBuf;

use haptical_report::{
    ArmPicture, BarRow, BarRows, Block, Cell, Column, Document, Figure, FigureGrid, HeatCell,
    HeatMap, Mark, ReportError, Section, Series, Table, Tone, histogram, write_atomically,
};

/// Numbers that look random and are the same on every machine: fractions of multiples of a root.
fn scatter(index: i32, seed: f64) -> f64 {
    (f64::from(index) * 0.618_033_988_749_895 + seed * 0.754_877_666_2).fract() - 0.5
}

fn curves() -> Figure {
    let mut figure = Figure::new(
        "Transmission error of seven joints",
        "joint angle [deg]",
        "error [mrad]",
    );
    for joint in 0..7 {
        let curve = (-90..=90).map(|k| {
            let angle = f64::from(k);
            (
                angle,
                (1.0 + f64::from(joint)) * (angle * 0.03 + f64::from(joint)).sin(),
            )
        });
        let mark = if joint == 6 {
            Mark::DashedLine
        } else {
            Mark::Line
        };
        let colour = joint as usize;
        figure.series.push(Series::new(
            format!("joint {}", joint + 1),
            mark,
            colour,
            curve.collect(),
        ));
    }
    let points = (0..40)
        .map(|k| (f64::from(k) * 4.0 - 80.0, 6.0 * scatter(k, 1.0)))
        .collect();
    figure
        .series
        .push(Series::new("samples, joint 1", Mark::Points, 7, points));
    figure
}

fn parameter_names() -> Vec<String> {
    let kinds = [
        ("alpha", 1..=6),
        ("a", 0..=7),
        ("d", 1..=7),
        ("theta", 1..=7),
    ];
    kinds
        .into_iter()
        .flat_map(|(kind, links)| links.map(move |k| format!("{kind}{k}")))
        .collect()
}

fn bars() -> Figure {
    let mut figure = Figure::new("Improvement of each parameter", "", "improvement [%]");
    let names = parameter_names();
    for (colour, label, loss) in [(0, "first run", 12.0), (1, "second run", 25.0)] {
        let bar = |k: usize| {
            (
                k as f64,
                100.0 - loss * (scatter(k as i32, loss) + 0.5).powi(3),
            )
        };
        figure.series.push(Series::new(
            label,
            Mark::Bars,
            colour,
            (0..names.len()).map(bar).collect(),
        ));
    }
    figure.series.push(Series::reference("95 %", 6, 95.0));
    figure.categories = Some(names);
    figure.y_range = Some((70.0, 100.0));
    figure
}

fn log_axis() -> Figure {
    let mut figure = Figure::new("Convergence", "iteration", "cost [m²]");
    figure.y_log = true;
    for (colour, label, rate) in [(0, "Gauss-Newton", 2.2), (1, "Levenberg-Marquardt", 1.1)] {
        let cost = |k: i32| (f64::from(k), 10.0_f64.powf(-rate * f64::from(k)) + 3e-9);
        figure.series.push(Series::new(
            label,
            Mark::Line,
            colour,
            (0..=8).map(cost).collect(),
        ));
    }
    figure
}

fn intervals() -> Figure {
    let mut figure = Figure::new(
        "Estimates with 95 % intervals",
        "",
        "drum eccentricity [mm]",
    );
    figure.categories = Some(
        ["capstan 1", "capstan 2", "capstan 3"]
            .map(str::to_owned)
            .to_vec(),
    );
    for (colour, label) in [(0, "run 1"), (1, "run 2"), (2, "run 3")] {
        let interval = |k: i32| {
            let mid = 0.4 + 0.5 * scatter(k, f64::from(colour));
            (f64::from(k), mid - 0.05, mid, mid + 0.08)
        };
        let all: Vec<_> = (0..3).map(interval).collect();
        figure
            .series
            .push(Series::intervals(label, colour as usize, &all));
    }
    figure
}

fn counts() -> Figure {
    let mut figure = Figure::new("Residuals", "residual [µm]", "number of samples");
    let sum = |k| {
        (0..6)
            .map(|seed| scatter(k, f64::from(seed * seed) * 1.7))
            .sum::<f64>()
            * 1e2
    };
    let values: Vec<f64> = (0..4000).map(sum).collect();
    figure.series.push(Series::new(
        "residuals",
        Mark::Bars,
        2,
        histogram(&values, 30),
    ));
    figure.legend = false;
    figure
}

fn band() -> Figure {
    let mut figure = Figure::new("Distance error along a motion", "time [s]", "error [m]");
    let error = |k: i32| 3e-5 * (f64::from(k) * 0.05).sin() * (-f64::from(k) * 0.01).exp();
    let curves: Vec<_> = (0..200)
        .map(|k| (0.5 * f64::from(k), error(k) - 4e-6, error(k) + 4e-6))
        .collect();
    figure.series.push(Series::band("95 % band", 5, &curves));
    let line = (0..200).map(|k| (0.5 * f64::from(k), error(k))).collect();
    figure
        .series
        .push(Series::new("predicted", Mark::Line, 0, line));
    figure.series.push(Series::reference(
        "resolution of the cable encoder",
        1,
        1.6e-5,
    ));
    figure
}

fn waterfall() -> BarRows {
    let mut bars = BarRows::new("Waterfall of a gap", "root mean square residual [mrad]");
    bars.connected = true;
    for (name, from, to, colour) in [
        ("before", 0.0, 1.2, 1),
        ("capstan-compliance, joint 2", 1.2, 0.35, 0),
        ("backlash, joint 3", 0.35, 0.13, 5),
        ("left unexplained", 0.13, 0.105, 4),
        ("noise floor", 0.105, 0.0, 2),
    ] {
        bars.rows.push(BarRow {
            name: name.to_owned(),
            from,
            to,
            colour,
            value: format!("{:.3}", from.max(to)),
        });
    }
    bars
}

fn heat() -> HeatMap {
    let columns = (1..=4).map(|joint| format!("joint {joint}")).collect();
    let mut map = HeatMap::new("Candidates by place", columns);
    for (row, name) in ["capstan-compliance", "joint-compliance", "backlash"]
        .into_iter()
        .enumerate()
    {
        let cell = |column: usize| {
            let shade = (scatter(column as i32, 2.0 + row as f64) + 0.5).powi(2);
            (shade > 0.05).then(|| HeatCell {
                shade,
                text: format!("{:.0} %", 100.0 * shade),
            })
        };
        map.rows.push((name.to_owned(), (0..4).map(cell).collect()));
    }
    map
}

fn table() -> Result<Table, ReportError> {
    let columns = vec![
        Column::new("parameter", ""),
        Column::new("estimate", "mm"),
        Column::new("95 % interval", "mm"),
        Column::new("cost", "m²"),
    ];
    let mut table = Table::new("Drum parameters", columns);
    for (name, value) in [
        ("eccentricity, outer drum", 0.2005),
        ("eccentricity, inner drum", 0.005),
    ] {
        let interval = Cell::interval(value - 0.0012, value + 0.0012, 4);
        let row = vec![
            name.into(),
            Cell::number(value, 4),
            interval,
            Cell::scientific(2.7e-9, 2),
        ];
        table.push(row)?;
    }
    table.push(vec![
        "home angle <theta_0>".into(),
        Cell::Missing,
        Cell::Missing,
        Cell::Missing,
    ])?;
    table
        .notes
        .push("A dash marks a parameter that the distances do not determine.".to_owned());
    Ok(table)
}

fn arm() -> ArmPicture {
    let before = vec![[0.0; 3], [0.0, 0.0, 0.4], [0.3, 0.0, 0.5], [0.5, 0.1, 0.2]];
    let mut after = before.clone();
    (after[2][2], after[3][1]) = (0.502, 0.104);
    ArmPicture {
        title: "What moved".to_owned(),
        names: ["as given".to_owned(), "as identified".to_owned()],
        up: [0.0, 0.0, 1.0],
        before,
        after,
        notes: vec![
            (2, "elbow: 2.0 mm".to_owned()),
            (3, "handle: 4.0 mm, 0.20°".to_owned()),
        ],
    }
}

#[allow(clippy::print_stdout, reason = "an example talks to the terminal")]
fn main() -> Result<(), ReportError> {
    let folder = PathBuf::from(
        std::env::args()
            .nth(1)
            .unwrap_or_else(|| "gallery".to_owned()),
    );
    let grid = FigureGrid::new(
        "Four views of one fit",
        2,
        vec![band(), counts(), log_axis(), intervals()],
    );
    let drawings = [
        (
            "curves",
            "Eight series share the palette and the legend.",
            curves().to_svg(960, 540)?,
        ),
        (
            "bars",
            "Two bar series over 28 names.",
            bars().to_svg(1100, 480)?,
        ),
        ("grid", "Panels.", grid.to_svg(1100, 820)?),
        ("log", "A logarithmic axis.", log_axis().to_svg(640, 420)?),
        (
            "intervals",
            "Error bars side by side.",
            intervals().to_svg(640, 420)?,
        ),
        ("waterfall", "Bars in rows.", waterfall().to_svg(860)?),
        ("heat", "Shaded cells.", heat().to_svg(860)?),
        ("arm", "An arm that moved.", arm().to_svg(440, 330)?),
    ];
    let mut blocks = Vec::new();
    for (name, caption, svg) in drawings {
        write_atomically(&folder.join(format!("{name}.svg")), svg.as_bytes())?;
        blocks.push(Block::Svg {
            caption: caption.to_owned(),
            svg,
        });
    }
    let table = table()?;
    println!("{}", table.to_terminal());
    let results = vec![
        Block::Verdict {
            good: true,
            text: "A condition that holds.".to_owned(),
        },
        Block::Verdict {
            good: false,
            text: "A condition that does not hold.".to_owned(),
        },
        Block::Notice {
            tone: Tone::Neutral,
            label: "note".to_owned(),
            text: "A sentence that stands out.".to_owned(),
        },
        Block::Table(table),
        Block::Command {
            purpose: "A command to copy:".to_owned(),
            command: "cargo run -p haptical-report --example gallery".to_owned(),
        },
        Block::Folded {
            summary: "What is folded away".to_owned(),
            blocks: vec![Block::Paragraph("Opened by a click.".to_owned())],
        },
        Block::List(vec![
            "First remark".to_owned(),
            "Second remark, with a < b".to_owned(),
        ]),
    ];
    let page = Document::new(
        "Gallery of figures and tables",
        "Every kind of block that a report can hold. All numbers are invented.",
        vec![
            Section::new("Results", results),
            Section::new("Figures", blocks),
        ],
    );
    let path = folder.join("index.html");
    write_atomically(&path, page.to_html().as_bytes())?;
    println!("wrote {}", path.display());
    Ok(())
}
