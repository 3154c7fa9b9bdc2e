//! A budget as a page and as lines.

use haptical_report::{Block, Cell, Document, Section, Table};

use super::{Budget, Contribution};
use crate::error::Error;
use crate::files::{NewFile, sealed_json};

/// Parts that the lines name.
const NAMED: usize = 6;
/// Numbers of the fit that the page lists.
const LISTED: usize = 15;
/// Micrometres in a metre.
const UM: f64 = 1e6;

impl Budget {
    /// Names of the files.
    pub const FILES: [&str; 2] = ["budget.json", "budget.html"];

    /// The files, as they are written.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn files(&self) -> Result<Vec<NewFile<'static>>, Error> {
        let [json, page] = Self::FILES;
        let mut files = vec![(page, self.page()?.into_bytes())];
        let mut sealed = self.clone();
        sealed.provenance = self.provenance.with_outputs(&files);
        files.insert(0, (json, sealed_json(&sealed)?.into_bytes()));
        Ok(files)
    }

    fn answer(&self) -> String {
        let worst = &self.worst.combined;
        format!(
            "Expanded uncertainty of the handle's position: {:.1} µm at worst, {:.1} µm in the middle of {} postures (k = {:.2}, {:.0} %).",
            self.expanded_worst_m * UM,
            self.expanded_median_m * UM,
            self.postures,
            worst.coverage_factor,
            100.0 * self.level
        )
    }

    fn agreement(&self) -> String {
        let [low, high] = self.draws.simulated.interval;
        let word = if self.draws.agreement.holds {
            "agree"
        } else {
            "DO NOT agree"
        };
        format!(
            "{} draws give [{:.1}, {:.1}] µm about the estimate and {word} with the law to {:.2} µm (JCGM 101, clause 8); an end of so many \
             scatters by {:.2} µm.",
            self.draws.simulated.trials,
            low * UM,
            high * UM,
            self.draws.agreement.tolerance * UM,
            self.draws.agreement.scatter * UM
        )
    }

    fn page(&self) -> Result<String, Error> {
        let [x, y, z] = self.worst.position_m.map(|value| value * 1e3);
        let [dx, dy, dz] = self.worst.direction;
        let [ux, uy, uz] = self.worst.expanded_xyz_m.map(|value| value * UM);
        let facts = vec![
            format!(
                "worst posture: line {} of the postures, handle at ({x:.1}, {y:.1}, {z:.1}) mm",
                self.worst.line
            ),
            format!("direction in which it is known least: ({dx:.3}, {dy:.3}, {dz:.3})"),
            format!("expanded uncertainty of x, y, z there: {ux:.1}, {uy:.1}, {uz:.1} µm"),
            self.agreement(),
        ];
        let mut sections = vec![
            Section::new(
                "Answer",
                vec![Block::Paragraph(self.answer()), Block::List(facts)],
            ),
            Section::new("Budget at the worst posture", vec![self.table()?.into()]),
        ];
        let fitted = self
            .worst
            .contributions
            .iter()
            .find(|part| !part.parameters.is_empty());
        if let Some(fitted) = fitted {
            sections.push(Section::new("Identified parameters", self.fitted(fitted)?));
        }
        if !self.instruments.is_empty() {
            sections.push(Section::new(
                "Instruments",
                vec![self.instruments()?.into()],
            ));
        }
        if !self.warnings.is_empty() {
            sections.push(Section::new(
                "Warnings",
                vec![Block::List(self.warnings.clone())],
            ));
        }
        sections.push(Section::new(
            "How this came about",
            vec![self.provenance.table()?.into()],
        ));
        let lead = format!(
            "{}, identified from {}: {}.",
            self.device, self.log, self.measurand
        );
        Ok(Document::new("Uncertainty budget", lead, sections).to_html())
    }

    fn table(&self) -> Result<Table, Error> {
        let heads = "contribution | type | distribution | u_i | unit | c_i [m per unit] | c_i u_i [µm] | share [%] | degrees of freedom";
        let mut rows: Vec<Vec<Cell>> = Vec::new();
        for part in &self.worst.contributions {
            rows.push(vec![
                (&part.name).into(),
                part.kind.into(),
                part.distribution.into(),
                scientific(part.standard_uncertainty),
                (&part.unit).into(),
                scientific(part.sensitivity),
                Cell::number(part.contribution_m * UM, 3),
                Cell::number(100.0 * part.share, 1),
                degrees(part.degrees_of_freedom),
            ]);
        }
        let all = &self.worst.combined;
        rows.push(vec![
            format!(
                "combined: k = {:.2}, U = {:.2} µm",
                all.coverage_factor,
                all.expanded_uncertainty * UM
            )
            .into(),
            "".into(),
            "".into(),
            "".into(),
            "".into(),
            "".into(),
            Cell::number(all.standard_uncertainty * UM, 3),
            Cell::number(100.0, 1),
            degrees(all.degrees_of_freedom),
        ]);
        Ok(Table::with_heads("Contributions", heads).with_rows(rows)?)
    }

    fn fitted(&self, part: &Contribution) -> Result<Vec<Block>, Error> {
        let heads = "parameter | u_i | unit | c_i [m per unit] | c_i u_i [µm]";
        let rows = part.parameters.iter().take(LISTED).map(|own| {
            vec![
                (&own.name).into(),
                Cell::scientific(own.standard_uncertainty, 3),
                (&own.unit).into(),
                Cell::scientific(own.sensitivity, 3),
                Cell::number(own.contribution_m * UM, 3),
            ]
        });
        let table = Table::with_heads("Largest of the fit", heads).with_rows(rows)?;
        let words = "They are correlated: their squares do not add up to the line above, which has their whole covariance.";
        let mut blocks = vec![Block::Paragraph(words.to_owned()), table.into()];
        if !self.worst.correlations.is_empty() {
            let list = self.worst.correlations.iter();
            let list = list.map(|(one, other, size)| format!("{one} and {other}: {size:+.3}"));
            blocks.push(Block::List(list.collect()));
        }
        Ok(blocks)
    }

    fn instruments(&self) -> Result<Table, Error> {
        let heads = "instrument | certificate | date | due | acts on | as";
        let rows = self.instruments.iter().map(|own| {
            let text = |text: &Option<String>| Cell::from(text.as_deref().unwrap_or(""));
            vec![
                (&own.name).into(),
                text(&own.certificate),
                text(&own.date),
                text(&own.due),
                (&own.acts_on).into(),
                match own.acts_as {
                    super::ActsAs::Offset => "offset",
                    super::ActsAs::Scale => "scale",
                }
                .into(),
            ]
        });
        Ok(Table::with_heads("Certificates", heads).with_rows(rows)?)
    }
}

fn scientific(value: Option<f64>) -> Cell {
    value.map_or_else(|| "".into(), |value| Cell::scientific(value, 3))
}

fn degrees(value: Option<f64>) -> Cell {
    value.map_or_else(|| "infinite".into(), |value| Cell::number(value, 1))
}

impl std::fmt::Display for Budget {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(formatter, "{}", self.answer())?;
        writeln!(
            formatter,
            "contribution at the worst posture          c_i u_i [µm]   share [%]   degrees of freedom"
        )?;
        for part in self.worst.contributions.iter().take(NAMED) {
            let degrees = part
                .degrees_of_freedom
                .map_or("infinite".to_owned(), |own| format!("{own:.1}"));
            writeln!(
                formatter,
                "{:<42} {:>12.3}   {:>9.1}   {degrees}",
                part.name,
                part.contribution_m * UM,
                100.0 * part.share
            )?;
        }
        let all = &self.worst.combined;
        let effective = all
            .degrees_of_freedom
            .map_or("infinite".to_owned(), |own| format!("{own:.1}"));
        writeln!(
            formatter,
            "{:<42} {:>12.3}   {:>9.1}   {effective}",
            "combined",
            all.standard_uncertainty * UM,
            100.0
        )?;
        writeln!(formatter, "{}", self.agreement())
    }
}
