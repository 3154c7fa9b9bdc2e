//! The report's sections: which tables and figures, and what is said of them.

use anyhow::Result;
use haptical_metrics::chi_square_p_value;
use haptical_model::Device;
use haptical_report::Table;
use serde_json::json;
use xtask_output::{Output, cells};

use super::{Results, figures, identifiability, ladder, sensitivity, sweeps, table2, table3};
use crate::monte_carlo::{AFTER, OBSERVABLE, gain};

/// Numbers of the paper's effective degrees of freedom: geometry and home pose were inferred from the
/// same 28 errors, 15 free numbers (docs/assumptions.md).
const EFFECTIVE_DEGREES_OF_FREEDOM: f64 = 13.0;

/// Tail probability below which 15 errors together are too small or too large for our noise.
const JOINTLY_IMPOSSIBLE: f64 = 0.005;

pub(crate) fn summary(output: &mut Output, results: &Results) -> Result<()> {
    output.section("Summary");
    let runs = &results.runs;
    let distance = runs.spread(|s| gain(&s.pose.distance_m, AFTER))?;
    let gains = runs.each(|s| gain(&s.pose.distance_m, AFTER));
    let above = gains.iter().filter(|gain| **gain > 99.0).count();
    let text = format!(
        "distance RMS at 200 other poses improves by {:.2} % (median; 95 % of runs {:.2} to \
         {:.2} %; over 99 % in {above} of {} runs)",
        distance.median,
        distance.low,
        distance.high,
        runs.samples.len()
    );
    output.verdict(distance.median > 99.0, text);
    let position = runs.spread(|s| gain(&s.pose.position_m, AFTER))?;
    let observable = runs.spread(|s| gain(&s.pose.position_m, OBSERVABLE))?;
    let after = runs.spread(|s| s.pose.position_m[AFTER])?;
    let before = runs.spread(|s| s.pose.position_m[0])?;
    let text = format!(
        "position RMS from {:.2} mm to {:.3} mm ({:.1} %); without the rotation that no distance \
         shows {:.2} %",
        before.median * 1e3,
        after.median * 1e3,
        position.median,
        observable.median
    );
    output.verdict(observable.median > 99.0, text);
    let before = runs.spread(|s| s.pose.orientation_rad[0])?;
    let after = runs.spread(|s| s.pose.orientation_rad[AFTER])?;
    let turn = runs.spread(|s| gain(&s.pose.orientation_rad, AFTER))?;
    let rest = runs.spread(|s| gain(&s.pose.orientation_rad, OBSERVABLE))?;
    let known = runs.spread(|s| {
        let known_rad = s.orientation_observable_known_rad;
        gain(&[s.pose.orientation_rad[0], known_rad], AFTER)
    })?;
    let text = format!(
        "orientation RMS from {:.2} mrad to {:.2} mrad ({:.0} %); without that rotation and alpha7 \
         {:.1} %, and {:.1} % if the joint angles were known exactly: 200 distances with this \
         noise fix the wrist's angles no better (see the Cramer-Rao column of Table 3), so 99 % \
         is out of reach for the orientation",
        before.median * 1e3,
        after.median * 1e3,
        turn.median,
        rest.median,
        known.median
    );
    output.verdict(rest.median > 99.0, text);
    let failed = runs.failures.len() + results.preset_runs.failures.len();
    let text = format!("{failed} of the runs did not end at a minimum");
    output.verdict(failed == 0, text);
    let runs = runs.failures.iter();
    for (seed, reason) in runs.chain(&results.preset_runs.failures).take(5) {
        output.words(format!("Seed {seed}: {reason}"));
    }
    Ok(())
}

pub(crate) fn table1(output: &mut Output, results: &Results) -> Result<()> {
    output.section("Table 1: Denavit-Hartenberg parameters");
    let nominal = &results.scenario.nominal;
    let mut table = Table::with_heads(
        "Table 1",
        "row | a [mm] | alpha [deg] | paper's alpha [deg] | d [mm] | home of theta [deg]",
    );
    let mut agree = true;
    for (row, link) in nominal.links.iter().enumerate() {
        let printed = results.paper.twists_over_pi[row] * 180.0;
        agree &= (printed - link.alpha_rad.to_degrees()).abs() < 1e-9;
        let home = row
            .checked_sub(1)
            .map_or(0.0, |joint| nominal.joints[joint].home_rad);
        table.push(cells! {
            row => 0, link.a_m * 1e3 => 1, link.alpha_rad.to_degrees() => 1, printed => 1,
            link.d_m * 1e3 => 1, home.to_degrees() => 1,
        })?;
    }
    let note = "The paper prints the twists and which lengths are zero; the six lengths and the home pose \
                are ours (docs/assumptions.md), inferred from its Tables 2 and 3.";
    output.table("table1", table.with_note(note))?;
    output.verdict(agree, "the twists are those of the paper's Table 1");
    Ok(())
}

pub(crate) fn identifiability(output: &mut Output, results: &Results, seed: u64) -> Result<()> {
    output.section("Identifiability");
    let judged = identifiability::judge(&results.scenario, &results.run.kinematics.device, seed)?;
    output.words(
        "All 32 deviations of the eight rows are offered; the list below is found from the \
         derivatives of 200 distances, by QR in an order of preference and by singular values.",
    );
    let dependent = identifiability::reasons(&judged.nominal);
    output.verdict(
        judged.nominal.rank == 28 && judged.nominal.is_clear(),
        format!("28 of 32 are identifiable; {}", dependent.join("; ")),
    );
    output.value("identifiability", serde_json::to_value(&judged.nominal)?);
    output.table("identifiability_cases", judged.cases)?;
    output.figure(
        "singular_values",
        "Singular values: 28 above the gap, and what lies below it (drawn at 1e-17 where zero).",
        &judged.figure,
    )?;
    output.table("identifiability_list", judged.list)?;
    if let Some(index) = judged.nominal.observability {
        output.words(format!(
            "Observability of the 200 poses, columns scaled by plausible sizes: O1 {:.3}, O2 {:.5}, \
             O3 {:.3}, O4 {:.4}, O5 {:.3}; condition number at unit norm {:.0}.",
            index.o1, index.o2, index.o3, index.o4, index.o5, judged.nominal.condition_unit_norm
        ));
    }
    output.words(
        "Schroer's claim, checked the same way: of a planar parallelogram's five parameters (four \
         lengths and an angle) only one length is identifiable. At the nominal, perfect \
         parallelogram the four lengths act only through L3 - L1 and L2 - L4, so an external encoder \
         sees at most two lengths and the angle. With the ratio and both drums of the capstan before it \
         free too, how many lengths are fixed to a useful size depends on the range of motion: none \
         within +-30 degrees, two within the paper's +-45 (table below; docs/equations.md, Parallelogram \
         error, has one in between). Four lengths are never fixed, and a polynomial stands for their \
         joint effect.",
    );
    output.table("parallelogram_identifiability", judged.schroer)
}

pub(crate) fn table2(output: &mut Output, results: &Results) -> Result<()> {
    output.section("Table 2: transmissions");
    let printed = ("table2", "Table 2: capstans, eq. (1) as printed");
    let preset = (
        "table2_preset",
        "Table 2: capstans, input drums over 2.9 mm (--paper-preset)",
    );
    for ((file, title), run, runs) in [
        (printed, &results.run, &results.runs),
        (preset, &results.preset_run, &results.preset_runs),
    ] {
        let made = table2::table2(&results.paper, run, runs, title)?;
        let chi = (1..).zip(&made.chi_squares);
        let chi = chi.map(|(joint, statistic)| format!("capstan {joint} {statistic:.2}"));
        let chi: Vec<String> = chi.collect();
        let sum: f64 = made.chi_squares.iter().sum();
        let larger = chi_square_p_value(sum, 15.0)?;
        output.terminal_table(&made.table, &[0, 1, 2, 3, 4, 7, 8, 11, 12]);
        output.table(file, made.table)?;
        output.figure(file, title, &made.figure)?;
        let text = format!(
            "{title}: {} of {} published values are possible",
            made.possible, made.rows
        );
        output.verdict(made.possible == made.rows, text);
        output.verdict(
            (JOINTLY_IMPOSSIBLE..=1.0 - JOINTLY_IMPOSSIBLE).contains(&larger),
            format!(
                "{title}: the 15 published errors together have chi-square {sum:.1} under our \
                 covariance ({}); 15 is expected, and errors this small or smaller have probability \
                 {:.1e}, this large or larger {larger:.2}",
                chi.join(", "),
                1.0 - larger
            ),
        );
        output.value(
            &format!("{file}_summary"),
            json!({
                "possible": made.possible,
                "rows": made.rows,
                "chi_square": made.chi_squares,
                "probability_of_larger": larger,
            }),
        );
    }
    let samples = &results.runs.samples;
    let capstans = samples.iter().flat_map(|sample| &sample.capstans);
    let fixed = capstans.map(|capstan| capstan.standard_deviations[2] * 1e6);
    let fixed: Vec<f64> = fixed.collect();
    let published = &results.paper.table2.ri_mm;
    let pairs = published.identified.iter().zip(&published.assigned);
    let errors = pairs.map(|(found, assigned)| (found - assigned) * 1e3);
    let errors: Vec<f64> = errors.collect();
    output.words(format!(
        "The r_i puzzle. With eq. (1) as printed the input drum's eccentricity acts through r_i / D: \
         5 um over 67.5 mm is 0.07 mrad, below the 0.105 mrad of the encoder's noise, so 200 samples \
         fix r_i to {:.2} um (median Cramer-Rao sd), while the published errors are {:.3} um rms. Each \
         alone is possible, all of them together are not: see the joint verdict. The published \
         precision of r_i and the ripple of the published polynomial both ask for a denominator of \
         about 3 mm instead of the drum distance (docs/assumptions.md, A9). No reading of the printed \
         equation gives that: it is an inconsistency of the paper, kept visible here by showing both.",
        haptical_metrics::median(&fixed)?,
        haptical_metrics::rms(&errors)?,
    ));
    Ok(())
}

pub(crate) fn table3(output: &mut Output, results: &Results) -> Result<()> {
    output.section("Table 3: kinematic parameters");
    let nominal = &results.scenario.nominal;
    let made = table3::table3(&results.paper, nominal, &results.run, &results.runs)?;
    output.words(
        "\"Two steps\" is the procedure of Figure 6: what step 1 gets wrong leaks into step 2. \
         \"Angles known\" leaves that leak out; the published errors are compared with it, because \
         their size shows no leak: 9.1 um of cable noise explains them best (docs/assumptions.md, A24), \
         9.87 um was stated.",
    );
    output.terminal_table(&made.table, &[0, 1, 2, 3, 4, 6, 7, 8, 10, 13, 14]);
    output.table("table3", made.table)?;
    let caption = "Improvement of each kinematic parameter.";
    output.figure("table3", caption, &made.figure)?;
    let chi = made.chi_square;
    let effective = chi_square_p_value(chi.median, EFFECTIVE_DEGREES_OF_FREEDOM)?;
    let text = format!(
        "{} of {} published errors of Table 3 are possible under this model and noise",
        made.possible,
        made.medians.len()
    );
    output.verdict(made.possible == made.medians.len(), text);
    output.words(format!(
        "Chi-square of the paper's 28 errors under our covariance: {:.1} (95 % of designs {:.1} to \
         {:.1}); p {:.2} for 28 degrees of freedom. This is no independent test: lengths and home \
         pose were inferred from those same errors. With about 13 effective degrees of freedom p is \
         {:.2}. The one figure that was not fitted is the cable's noise: the likelihood of the errors \
         over all geometries is largest at 9.1 um (docs/assumptions.md, A24), the paper states 9.87 um.",
        chi.median, chi.low, chi.high, made.p_value, effective
    ));
    let weak = made.medians.iter().filter(|(_, known, _)| *known < 97.0);
    let said = |(name, known, both): &(String, f64, f64)| format!("{name} {known:.0} ({both:.0})");
    let names: Vec<String> = weak.clone().map(said).collect();
    let expected = [
        "alpha4", "alpha5", "alpha6", "theta3", "theta4", "theta5", "theta6", "theta7",
    ];
    let text = format!(
        "weakest, median I at known angles (after both steps): {}; all others at least 97 %",
        names.join(", ")
    );
    output.verdict(weak.map(|(name, ..)| name.as_str()).eq(expected), text);
    output.value(
        "table3_summary",
        json!({
            "possible": made.possible,
            "chi_square": [chi.median, chi.low, chi.high],
            "p_value_28_degrees_of_freedom": made.p_value,
            "p_value_13_degrees_of_freedom": effective,
        }),
    );
    Ok(())
}

pub(crate) fn figures(output: &mut Output, results: &Results) -> Result<()> {
    output.section("Figure 7: parallelogram");
    let (figure, table) = figures::figure7(&results.scenario, &results.paper, &results.run)?;
    let caption = "Literal eq. (1): the ripple of the input drum is invisible.";
    output.figure("figure7", caption, &figure)?;
    output.table("figure7", table)?;
    let mut preset = results.scenario.clone();
    preset.truth.joints[3].input_drum_denominator_m =
        Some(crate::scenario::PRESET_DENOMINATORS_M[3]);
    let (figure, table) = figures::figure7(&preset, &results.paper, &results.preset_run)?;
    output.figure(
        "figure7_preset",
        "Input drum over 2.6 mm: a ripple of the printed size appears, but with the assigned phase of -120 \
         deg; the printed polynomial's is -50 deg (docs/assumptions.md, A10).",
        &figure,
    )?;
    output.table("figure7_preset", table)?;
    output.section("Figure 8: pose errors");
    let grid = figures::figure8(&results.run);
    output.grid("figure8", "200 poses that the fit did not see.", &grid)?;
    let table = figures::pose_table(&results.run, &results.runs)?;
    output.terminal_table(&table, &[0, 1, 2, 3, 4, 7]);
    output.table("figure8", table)?;
    output.figure(
        "far_from_home",
        "Errors before calibration grow with the distance from home.",
        &figures::far_from_home(&results.run),
    )?;
    let (table, positive, share, rank) = figures::far_from_home_table(&results.runs)?;
    output.table("far_from_home", table)?;
    let text = format!(
        "errors grow with the distance from home: the rank correlation's 95 % interval over the \
         runs is above zero; {share:.1} % of poses exceed 8 mm, on average farther from home \
         than {rank:.0} % of all poses"
    );
    output.verdict(positive, text);
    output.figure(
        "distance_improvement",
        "Improvement of the distance's RMS over all runs.",
        &figures::improvement_histogram(&results.runs),
    )
}

pub(crate) fn choices(output: &mut Output, results: &Results) -> Result<()> {
    let (scenario, paper, seeds) = (&results.scenario, &results.paper, results.seeds);
    output.section("What the authors chose without showing");
    let (table, figure) = sweeps::degrees(scenario, seeds)?;
    output.table("degrees", table)?;
    let caption = "Degree of the polynomial, medians over seeds.";
    output.figure("degrees", caption, &figure)?;
    let (table, figure) = sweeps::poses(scenario, paper, seeds)?;
    output.table("poses", table)?;
    output.figure("poses", "Number of poses, medians over seeds.", &figure)?;
    output.table("methods", sweeps::methods(scenario, paper, seeds)?)?;
    let (table, figure) = ladder::ladder(scenario, seeds)?;
    output.terminal_table(&table, &[0, 1, 2, 4, 5, 6, 7]);
    output.table("ladder", table)?;
    let caption = "Offsets alone are what the vendors' software calibrates.";
    output.figure("ladder", caption, &figure)
}

pub(crate) fn sensitivity(output: &mut Output, results: &Results, nominal: &Device) -> Result<()> {
    output.section("Sensitivity");
    let table = sensitivity::table(nominal, &results.paper, results.seeds)?;
    output.words(
        "Each number that the paper does not print, changed by about its uncertainty, one at a time \
         (docs/assumptions.md has the sources).",
    );
    output.table("sensitivity", table)
}
