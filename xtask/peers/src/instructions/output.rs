//! Counts for people and as JSON.

use anyhow::Result;
use haptical_report::Table;
use serde_json::{Value, json};
use xtask_output::cells;

use super::compare::{Comparison, Row, TOLERANCE_PERCENT};
use super::environment::Environment;
use super::workloads::Workload;

#[derive(Debug)]
pub(crate) struct Results<'r> {
    pub(crate) environment: &'r Environment,
    pub(crate) workloads: &'r [Workload],
    /// In the order of the workloads.
    pub(crate) counts: &'r [(&'static str, u64)],
    /// With the committed counts, or why there is none.
    pub(crate) comparison: Result<&'r Comparison, &'r String>,
}

pub(crate) fn nothing_counted(why: &str, as_json: bool) -> Result<()> {
    if as_json {
        let value = json!({ "compared": false, "why_not": why, "workloads": [] });
        println!("{}", serde_json::to_string_pretty(&value)?);
    } else {
        println!("not compared: {why}");
    }
    Ok(())
}

impl Results<'_> {
    pub(crate) fn print(&self, as_json: bool) -> Result<()> {
        if as_json {
            println!("{}", serde_json::to_string_pretty(&self.to_json())?);
            return Ok(());
        }
        println!("{}", self.table()?.to_terminal());
        let Environment {
            rustc,
            target,
            lanes,
            valgrind,
            ..
        } = self.environment;
        println!("{rustc}, {target}, lanes: {lanes}, {valgrind}, one thread");
        match self.comparison {
            Err(why) => println!("not compared: {why}"),
            Ok(_) => println!("compared: {TOLERANCE_PERCENT} % either way is the same"),
        }
        Ok(())
    }

    fn rows(&self) -> impl Iterator<Item = (&Workload, u64, Option<&Row>)> {
        self.workloads
            .iter()
            .zip(self.counts)
            .enumerate()
            .map(|(index, (workload, (_, count)))| {
                let row = self.comparison.ok().and_then(|all| all.rows.get(index));
                (workload, *count, row)
            })
    }

    fn table(&self) -> Result<Table> {
        let columns = "workload | instructions | committed | ratio | each | of | ";
        let mut table = Table::with_heads("Instructions", columns);
        for (workload, count, row) in self.rows() {
            let committed = row.and_then(|row| row.committed).map(|count| count as f64);
            let ratio = committed.map(|committed| count as f64 / committed);
            table.push(cells! {
                workload.name, count => 0, committed => 0, ratio => 3,
                count as f64 / workload.units as f64 => 1, workload.unit,
                row.map_or("not compared", |row| row.verdict.word()),
            })?;
        }
        Ok(table)
    }

    pub(crate) fn to_json(&self) -> Value {
        let workloads: Vec<Value> = self
            .rows()
            .map(|(workload, count, row)| {
                let committed = row.and_then(|row| row.committed);
                json!({
                    "name": workload.name,
                    "what": workload.what,
                    "unit": workload.unit,
                    "units": workload.units,
                    "instructions": count,
                    "instructions_per_unit": count as f64 / workload.units as f64,
                    "committed": committed,
                    "ratio": committed.map(|committed| count as f64 / committed as f64),
                    "verdict": row.map(|row| row.verdict),
                })
            })
            .collect();
        json!({
            "compared": self.comparison.is_ok(),
            "why_not": self.comparison.err(),
            "tolerance_percent": TOLERANCE_PERCENT,
            "rustc": self.environment.rustc,
            "target": self.environment.target,
            "lanes": self.environment.lanes,
            "valgrind": self.environment.valgrind,
            "left_over": self.comparison.ok().map(|all| &all.left_over),
            "workloads": workloads,
        })
    }
}
