//! The paper's tables as data: fixtures/paper/tables.toml, never merged with anything of ours.

use anyhow::{Context, Result, ensure};
use haptical_model::transmission::CapstanError;
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
    /// k10 with the minus sign that the print lost (docs/assumptions.md).
    table4_k10: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Table4 {
    #[serde(rename = "Re")]
    pub(crate) ratio_deviation: [f64; 3],
    pub(crate) ro_mm: [f64; 3],
    pub(crate) ri_mm: [f64; 3],
    pub(crate) beta_o_deg: [f64; 3],
    pub(crate) beta_i_deg: [f64; 3],
    pub(crate) k0_to_k10: [f64; 11],
}

#[derive(Debug, Clone, Deserialize)]
struct Table5 {
    alpha1_6_mrad: [f64; 6],
    a0_7_mm: [f64; 8],
    d1_7_mm: [f64; 7],
    theta1_7_mrad: [f64; 7],
}

/// What the text says of the experiment.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Text {
    pub(crate) improvement_full_percent: f64,
    pub(crate) improvement_kinematics_only_percent: f64,
}

#[derive(Debug, Clone, Deserialize)]
struct File {
    table1: Table1,
    table2: Table2,
    table3: Table3,
    table4: Table4,
    table5: Table5,
    text: Text,
    corrected: Corrected,
}

/// One published parameter of Table 3, in SI units.
#[derive(Debug, Clone)]
pub struct Published {
    /// The parameter: `alpha1`, `a0`.
    pub name: String,
    /// The deviation that the paper simulates \[rad or m\].
    pub assigned: f64,
    pub(crate) identified: f64,
    pub(crate) improvement_percent: f64,
}

/// The published figures that the simulation needs.
#[derive(Debug, Clone)]
pub struct Paper {
    pub(crate) twists_over_pi: Vec<f64>,
    pub(crate) table2: Table2,
    /// The 28 parameters of Table 3.
    pub table3: Vec<Published>,
    /// alpha0 and alpha7: assigned, not identified.
    pub(crate) unidentified: Vec<(String, f64)>,
    /// Identified on hardware: capstans and polynomial, its k10 corrected.
    pub(crate) table4: Table4,
    /// Identified on hardware: names and deviations in SI units.
    pub(crate) table5: Vec<(String, f64)>,
    pub(crate) text: Text,
    /// Deviations of the parallelogram's L1 and L2, with the unit corrected to metres.
    pub(crate) length_deviations_m: [f64; 2],
}

/// A capstan's errors as printed: R_e, r_o \[mm\], beta_o \[deg\], r_i \[mm\], beta_i \[deg\].
pub(crate) fn capstan([ratio, ro_mm, beta_o_deg, ri_mm, beta_i_deg]: [f64; 5]) -> CapstanError {
    let [beta_o, beta_i] = [beta_o_deg, beta_i_deg].map(f64::to_radians);
    CapstanError::from_polar(0.0, ratio, ro_mm * 1e-3, beta_o, ri_mm * 1e-3, beta_i)
}

impl Paper {
    /// The tables as printed, but for the figures that are corrected.
    pub fn load() -> Result<Self> {
        let file: File = toml::from_str(TABLES).context("fixtures/paper/tables.toml")?;
        let (printed, measured) = (&file.table3, &file.table5);
        let groups: [(&str, usize, &Rows, &[f64]); 4] = [
            ("alpha", 1, &printed.alpha1_6_mrad, &measured.alpha1_6_mrad),
            ("a", 0, &printed.a0_7_mm, &measured.a0_7_mm),
            ("d", 1, &printed.d1_7_mm, &measured.d1_7_mm),
            ("theta", 1, &printed.theta1_7_mrad, &measured.theta1_7_mrad),
        ];
        let (mut table3, mut table5) = (Vec::new(), Vec::new());
        for (symbol, first, rows, deviations) in groups {
            for (index, (&assigned, deviation)) in rows.assigned.iter().zip(deviations).enumerate()
            {
                let name = format!("{symbol}{}", first + index);
                // printed in milliradians and millimetres
                table3.push(Published {
                    name: name.clone(),
                    assigned: assigned * 1e-3,
                    identified: rows.identified[index] * 1e-3,
                    improvement_percent: rows.i_percent[index],
                });
                table5.push((name, deviation * 1e-3));
            }
        }
        ensure!(
            table3.len() == 28,
            "Table 3 has 28 rows, the fixture {}",
            table3.len()
        );
        let mut table4 = file.table4;
        table4.k0_to_k10[10] = file.corrected.table4_k10;
        Ok(Self {
            table4,
            table5,
            text: file.text,
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
