//! The worked examples of JCGM 100 and JCGM 101 (fixtures/gum/examples.toml).

use std::collections::BTreeMap;

use haptical_metrics::budget::{
    Distribution, Group, Input, agreement, combined, covariance_of, simulated,
};
use serde_json::Value;

/// Keys and numbers of a section. The file holds one number or list a line.
fn section(wanted: &str) -> BTreeMap<String, Vec<f64>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fixtures/gum/examples.toml"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let mut found = BTreeMap::new();
    let mut is_wanted = false;
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(name) = line
            .strip_prefix('[')
            .and_then(|rest| rest.split(']').next())
            && !line.contains('=')
        {
            is_wanted = name == wanted;
        } else if is_wanted
            && let Some((key, value)) = line.split_once('=')
            && let Ok(value) = serde_json::from_str::<Value>(value.trim())
        {
            let numbers = match value {
                Value::Array(all) => all.iter().filter_map(Value::as_f64).collect(),
                Value::Number(one) => one.as_f64().into_iter().collect(),
                _ => continue,
            };
            found.insert(key.trim().to_owned(), numbers);
        }
    }
    assert!(!found.is_empty(), "{wanted}");
    found
}

fn normal(standard_uncertainty: f64, degrees: f64) -> Input {
    Input::new(
        Distribution::Normal {
            standard_uncertainty,
        },
        degrees,
    )
}

/// Whether a number is that of the document: half of its last digit.
fn is_printed(own: f64, printed: f64, digit: f64) {
    assert!(
        (own - printed).abs() <= 0.5 * digit * (1.0 + 1e-9),
        "{own} is not {printed}"
    );
}

#[test]
fn an_end_gauge() {
    let data = section("end_gauge");
    let part = |name: &str| normal(data[name][0], data[name][1]);
    let of_d = [
        "repeated_observations",
        "random_comparator",
        "systematic_comparator",
    ];
    let of_d: Vec<Group> = of_d
        .iter()
        .map(|name| Group::single(1.0, &part(name)))
        .collect();
    let d = combined(&of_d, 0.95).unwrap();
    is_printed(
        d.standard_uncertainty,
        data["measured_difference_d"][0],
        0.1,
    );
    // the document goes on with 9.7, rounded
    let rounded = (data["measured_difference_d"][0] / d.standard_uncertainty).powi(4);
    is_printed(
        d.degrees_of_freedom.unwrap() * rounded,
        data["measured_difference_d"][1],
        0.1,
    );
    let names = [
        "standard_ls",
        "measured_difference_d",
        "expansion_difference",
        "temperature_difference",
    ];
    let groups: Vec<Group> = names
        .iter()
        .map(|name| Group::single(1.0, &part(name)))
        .collect();
    let found = combined(&groups, data["level"][0]).unwrap();
    is_printed(found.standard_uncertainty, data["combined_nm"][0], 1.0);
    let degrees = found.degrees_of_freedom.unwrap();
    assert_eq!(degrees.floor(), data["effective_degrees"][0], "{degrees}");
    is_printed(found.coverage_factor, data["coverage_factor"][0], 0.01);
    // the document multiplies 2.92 by 32
    is_printed(
        found.coverage_factor * found.standard_uncertainty.round(),
        data["expanded_nm"][0],
        1.0,
    );
    let mut second = groups.clone();
    second.extend(
        data["second_order_nm"]
            .iter()
            .map(|u| Group::single(1.0, &normal(*u, f64::INFINITY))),
    );
    let found = combined(&second, 0.99).unwrap();
    is_printed(
        found.standard_uncertainty,
        data["combined_second_order_nm"][0],
        1.0,
    );
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn resistance_reactance_and_impedance() {
    let data = section("impedance");
    let columns = ["voltage_v", "current_ma", "phase_rad"].map(|name| data[name].clone());
    let means = columns.each_ref().map(|column| mean(column));
    let mut covariance = Vec::new();
    for a in 0..3 {
        for b in 0..3 {
            let pairs = columns[a].iter().zip(&columns[b]);
            let sum: f64 = pairs.map(|(x, y)| (x - means[a]) * (y - means[b])).sum();
            covariance.push(sum / (5.0 * 4.0));
        }
    }
    let deviation = |index: usize| covariance[4 * index].sqrt();
    let correlation = |a: usize, b: usize| covariance[3 * a + b] / (deviation(a) * deviation(b));
    for (index, digit) in [1e-4, 1e-4, 1e-5].into_iter().enumerate() {
        is_printed(means[index], data["means"][index], digit);
        is_printed(deviation(index), data["deviations_of_means"][index], digit);
    }
    for (at, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        is_printed(correlation(a, b), data["correlations"][at], 0.01);
    }
    let [volt, milliampere, phase] = means;
    let ohm = 1e3 * volt / milliampere;
    let (sine, cosine) = phase.sin_cos();
    let results = [ohm * cosine, ohm * sine, ohm];
    let of = |along: f64, across: f64| {
        vec![along * ohm / volt, -along * ohm / milliampere, across * ohm]
    };
    let sensitivities = [of(cosine, -sine), of(sine, cosine), of(1.0, 0.0)];
    for index in 0..3 {
        is_printed(results[index], data["results_ohm"][index], 1e-3);
        let group = Group {
            sensitivities: sensitivities[index].clone(),
            covariance: covariance.clone(),
            degrees_of_freedom: 4.0,
        };
        let found = combined(&[group], 0.95).unwrap();
        is_printed(
            found.standard_uncertainty,
            data["uncertainties_ohm"][index],
            // of the readings as printed 0.295 is 0.2956: the document's own were not rounded
            2e-3,
        );
        assert_eq!(found.degrees_of_freedom.unwrap().round(), 4.0);
    }
    let covariance = |a: usize, b: usize| {
        covariance_of(&sensitivities[a], &sensitivities[b], &covariance).unwrap()
    };
    for (at, (a, b)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        let own = covariance(a, b) / (covariance(a, a) * covariance(b, b)).sqrt();
        is_printed(own, data["correlations_of_results"][at], 1e-3);
    }
}

#[test]
fn a_thermometer_s_line() {
    let data = section("thermometer");
    let reference = data["reference_degc"][0];
    let x: Vec<f64> = data["readings_degc"]
        .iter()
        .map(|reading| reading - reference)
        .collect();
    let y = &data["corrections_degc"];
    let (count, sum, squares) = (
        x.len() as f64,
        x.iter().sum::<f64>(),
        x.iter().map(|x| x * x).sum::<f64>(),
    );
    let product: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
    let determinant = count * squares - sum * sum;
    let slope = (count * product - sum * y.iter().sum::<f64>()) / determinant;
    let intercept = mean(y) - slope * sum / count;
    let left: f64 = x
        .iter()
        .zip(y)
        .map(|(x, y)| (y - intercept - slope * x).powi(2))
        .sum();
    let variance = left / (count - 2.0);
    let covariance = [squares, -sum, -sum, count].map(|entry| variance * entry / determinant);
    is_printed(intercept, data["intercept_degc"][0], 1e-4);
    is_printed(slope, data["slope"][0], 1e-5);
    is_printed(covariance[0].sqrt(), data["intercept_degc"][1], 1e-4);
    is_printed(covariance[3].sqrt(), data["slope"][1], 1e-5);
    is_printed(
        covariance[1] / (covariance[0] * covariance[3]).sqrt(),
        data["correlation"][0],
        1e-3,
    );
    let at = data["at_degc"][0] - reference;
    is_printed(intercept + slope * at, data["correction_degc"][0], 1e-4);
    let group = Group {
        sensitivities: vec![1.0, at],
        covariance: covariance.to_vec(),
        degrees_of_freedom: count - 2.0,
    };
    let found = combined(&[group], 0.95).unwrap();
    is_printed(found.standard_uncertainty, data["correction_degc"][1], 1e-4);
    is_printed(
        found.degrees_of_freedom.unwrap(),
        data["degrees_of_freedom"][0],
        1e-9,
    );
    // without the correlation it would be 1.8 times as large
    let alone = [1.0, at].into_iter().zip([covariance[0], covariance[3]]);
    let alone: Vec<Group> = alone
        .map(|(c, v)| Group::single(c, &normal(v.sqrt(), 9.0)))
        .collect();
    assert!(
        combined(&alone, 0.95).unwrap().standard_uncertainty > 1.7 * found.standard_uncertainty
    );
}

#[test]
fn a_hardness() {
    let data = section("hardness");
    let parts = data["parts"]
        .iter()
        .map(|u| Group::single(1.0, &normal(*u, f64::INFINITY)));
    let found = combined(&parts.collect::<Vec<_>>(), 0.95).unwrap();
    is_printed(found.standard_uncertainty, data["combined"][0], 0.01);
    assert_eq!(found.degrees_of_freedom, None);
    assert!((found.coverage_factor - 1.959_963_984_540_054).abs() < 1e-8);
}

/// The interval of the sum of four rectangular inputs is known: 2 sqrt(3) (2 - (3/5)^(1/4)) (JCGM 101, 9.2.3.5).
#[test]
fn four_inputs_by_draws() {
    let data = section("additive");
    let sum = |x: &[f64]| x.iter().sum::<f64>();
    let run = |inputs: &[Input]| {
        let groups: Vec<Group> = inputs
            .iter()
            .map(|input| Group::single(1.0, input))
            .collect();
        let law = combined(&groups, 0.95).unwrap();
        let draws = simulated(inputs, (&[], f64::INFINITY), sum, 400_000, 0.95, 7).unwrap();
        let agrees = agreement(0.0, &law, &draws, 2).unwrap();
        (law, draws, agrees)
    };
    let (law, draws, agrees) = run(&[normal(1.0, f64::INFINITY); 4]);
    is_printed(law.expanded_uncertainty, data["normal_interval"][0], 0.01);
    assert!((draws.interval[1] - data["normal_interval"][0]).abs() < 0.02 && agrees.holds);
    let flat =
        |half_width: f64| Input::new(Distribution::Rectangular { half_width }, f64::INFINITY);
    let root = 3.0_f64.sqrt();
    let (_, draws, agrees) = run(&[flat(root); 4]);
    let known = 2.0 * root * (2.0 - 0.6_f64.powf(0.25));
    is_printed(known, data["rectangular_interval"][0], 0.01);
    assert!(
        draws
            .interval
            .iter()
            .all(|end| (end.abs() - known).abs() < 0.015),
        "{draws:?}"
    );
    assert!(draws.shortest[1] - draws.shortest[0] <= draws.interval[1] - draws.interval[0]);
    assert!((agrees.tolerance - data["rectangular_tolerance"][0]).abs() < 1e-12 && agrees.holds);
    assert!(
        (agrees.distances[1] - data["rectangular_distance"][0]).abs() < 0.015,
        "{agrees:?}"
    );
    // draws with other seeds scatter as is said
    let inputs = [normal(1.0, f64::INFINITY); 4];
    let again =
        (0..40).map(|seed| simulated(&inputs, (&[], 1.0), sum, 10_000, 0.95, seed).unwrap());
    let again: Vec<_> = again.collect();
    let ends: Vec<f64> = again.iter().map(|own| own.interval[1]).collect();
    let middle = mean(&ends);
    let seen = ends.iter().map(|end| (end - middle).powi(2)).sum::<f64>() / 39.0;
    let ratio = seen.sqrt() / agreement(0.0, &law, &again[0], 2).unwrap().scatter;
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
    let (law, draws, agrees) = run(&[flat(root), flat(root), flat(root), flat(10.0 * root)]);
    is_printed(law.standard_uncertainty, data["wide_uncertainty"][0], 0.1);
    is_printed(law.expanded_uncertainty, data["wide_law_interval"][0], 0.1);
    assert!(
        (draws.interval[1] - data["wide_interval"][0]).abs() < 0.1 && !agrees.holds,
        "{draws:?}"
    );
}

/// Draws of a correlated group have its covariance, and the tails of Student's distribution.
#[test]
fn draws_of_a_group_are_as_its_covariance() {
    let covariance = [4.0, -1.2, -1.2, 0.5];
    let known = |model: fn(&[f64]) -> f64, degrees| {
        simulated(&[], (&covariance, degrees), model, 200_000, 0.95, 3).unwrap()
    };
    let variance = known(|x| x[0] + 2.0 * x[1], f64::INFINITY)
        .standard_uncertainty
        .powi(2);
    assert!((variance - (4.0 - 4.8 + 2.0)).abs() < 0.02, "{variance}");
    // t of 4 degrees of freedom: 2.776
    let high = known(|x| x[0], 4.0).interval[1];
    assert!((high - 2.0 * 2.776).abs() < 0.08, "{high}");
    let arcsine = Input::new(Distribution::Arcsine { half_width: 1.0 }, f64::INFINITY);
    let triangular = Input::new(Distribution::Triangular { half_width: 1.0 }, f64::INFINITY);
    for input in [arcsine, triangular, normal(0.3, 2.5)] {
        let found = simulated(&[input], (&[], 1.0), |x| x[0], 200_000, 0.5, 4).unwrap();
        let quartile = match input.distribution {
            Distribution::Arcsine { .. } => 0.5_f64.sqrt(),
            Distribution::Triangular { .. } => 1.0 - 0.5_f64.sqrt(),
            // Student's of 2.5 degrees of freedom, by scipy.stats.t.ppf(0.75, 2.5)
            _ => 0.3 * 0.785_013_7,
        };
        assert!(
            (found.interval[1] - quartile).abs() < 6e-3,
            "{input:?} {found:?}"
        );
    }
}

#[test]
fn budgets_that_are_none_are_refused() {
    let own = Group::single(1.0, &normal(1.0, 0.0));
    assert!(combined(&[own], 0.95).is_err());
    assert!(combined(&[], 0.95).is_err());
    let group = |covariance: Vec<f64>| Group {
        sensitivities: vec![1.0, -1.0],
        covariance,
        degrees_of_freedom: 1.0,
    };
    assert!(group(vec![1.0; 3]).variance().is_err());
    assert!(group(vec![1.0, 2.0, 2.0, 1.0]).variance().is_err());
    assert!(group(vec![1.0, f64::NAN, 0.0, 1.0]).variance().is_err());
    assert!(simulated(&[], (&[1.0, 2.0, 2.0, 1.0], 1.0), |x| x[0], 10_000, 0.95, 1).is_err());
    assert!(simulated(&[], (&[], 1.0), |_| 0.0, 100, 0.95, 1).is_err());
    assert!(simulated(&[], (&[], 1.0), |_| f64::NAN, 10_000, 0.95, 1).is_err());
    let law = combined(&[Group::single(1.0, &normal(0.0996, 10.0))], 0.95).unwrap();
    let draws = simulated(
        &[normal(0.0996, 10.0)],
        (&[], 1.0),
        |x| x[0],
        10_000,
        0.95,
        1,
    )
    .unwrap();
    let tolerance = agreement(0.0, &law, &draws, 2).unwrap().tolerance;
    assert!((tolerance - 0.005).abs() < 1e-12, "{tolerance}");
}
