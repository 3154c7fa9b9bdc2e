//! The paper's tables as data: fixtures/paper/tables.toml, never merged with anything of ours.

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

const TABLES: &str = include_str!("../../../fixtures/paper/tables.toml");

/// One row group of Table 2 or 3.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Rows {
    pub(crate) assigned: Vec<f64>,
    pub(crate) identified: Vec<f64>,
    pub(crate) i_percent: Vec<f64>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) struct Table2 {
    #[serde(rename = "Re")]
    pub(crate) ratio_deviation: Rows,
    pub(crate) ro_mm: Rows,
    pub(crate) ri_mm: Rows,
    pub(crate) beta_o_deg: Rows,
    pub(crate) beta_i_deg: Rows,
    pub(crate) parallelogram_assigned: ParallelogramAssigned,
    pub(crate) k0_to_k10: Vec<f64>,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct ParallelogramAssigned {
    pub(crate) ro4_mm: f64,
    pub(crate) ri4_mm: f64,
    pub(crate) beta_o4_deg: f64,
    pub(crate) beta_i4_deg: f64,
    #[serde(rename = "Re4")]
    pub(crate) ratio_deviation: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Table3 {
    alpha1_6_mrad: Rows,
    a0_7_mm: Rows,
    d1_7_mm: Rows,
    theta1_7_mrad: Rows,
    alpha0_mrad_assigned: f64,
    alpha7_mrad_assigned: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct Table1 {
    alpha_rad_over_pi: Vec<f64>,
}

#[derive(Debug, Clone, Deserialize)]
struct Corrected {
    #[serde(rename = "table2_dL_m")]
    length_deviations_m: [f64; 2],
}

#[derive(Debug, Clone, Deserialize)]
struct File {
    table1: Table1,
    table2: Table2,
    table3: Table3,
    corrected: Corrected,
}

/// One published parameter of Table 3, in SI units.
#[derive(Debug, Clone)]
pub(crate) struct Published {
    pub(crate) name: String,
    pub(crate) assigned: f64,
    pub(crate) identified: f64,
    pub(crate) improvement_percent: f64,
}

/// The published figures that the simulation needs.
#[derive(Debug, Clone)]
pub(crate) struct Paper {
    pub(crate) twists_over_pi: Vec<f64>,
    pub(crate) table2: Table2,
    pub(crate) table3: Vec<Published>,
    /// alpha0 and alpha7: assigned, not identified.
    pub(crate) unidentified: Vec<(String, f64)>,
    /// Deviations of the parallelogram's L1 and L2, with the unit corrected to metres.
    pub(crate) length_deviations_m: [f64; 2],
}

impl Paper {
    pub(crate) fn load() -> Result<Self> {
        let file: File = toml::from_str(TABLES).context("fixtures/paper/tables.toml")?;
        let mut table3 = Vec::new();
        for (symbol, first, rows) in [
            ("alpha", 1, &file.table3.alpha1_6_mrad),
            ("a", 0, &file.table3.a0_7_mm),
            ("d", 1, &file.table3.d1_7_mm),
            ("theta", 1, &file.table3.theta1_7_mrad),
        ] {
            for (index, &assigned) in rows.assigned.iter().enumerate() {
                table3.push(Published {
                    name: format!("{symbol}{}", first + index),
                    // printed in milliradians and millimetres
                    assigned: assigned * 1e-3,
                    identified: rows.identified[index] * 1e-3,
                    improvement_percent: rows.i_percent[index],
                });
            }
        }
        ensure!(
            table3.len() == 28,
            "Table 3 has 28 rows, the fixture {}",
            table3.len()
        );
        Ok(Self {
            twists_over_pi: file.table1.alpha_rad_over_pi,
            table2: file.table2,
            table3,
            unidentified: vec![
                ("alpha0".to_owned(), file.table3.alpha0_mrad_assigned * 1e-3),
                ("alpha7".to_owned(), file.table3.alpha7_mrad_assigned * 1e-3),
            ],
            length_deviations_m: file.corrected.length_deviations_m,
        })
    }
}
