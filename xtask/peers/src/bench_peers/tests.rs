//! Foundations of the comparison: files, agreement of costs, missing peers, ratios, load.

use anyhow::Result;
use haptical_calibration::DeviceProblem;
use haptical_identification::{Settings, solve};

use super::agreement::check_costs;
use super::bars::verdicts;
use super::contender::{Answer, Contender, Label};
use super::files::{DataSet, read};
use super::kinematics::{Poses, check_values};
use super::load::{Ticks, of_process};
use super::ours::{COLD, WARM, solvers};
use super::ratio::MedianRatio;
use super::report::{PeerRecord, Results, pairs, presence, write};
use super::rounds::{Comparison, Plan, compare, repeats};

/// The distance of a pose from the numbers of the file alone, by the paper's eqs. (3) to (5).
fn distance_m(table: &[f64], joints_rad: &[f64]) -> f64 {
    let mut position = [0.0; 3];
    for row in (0..8).rev() {
        let [a, alpha, d, theta] = [0, 1, 2, 3].map(|index| table[4 * row + index]);
        let turn = theta + if row > 0 { joints_rad[row - 1] } else { 0.0 };
        let [x, y, z] = position;
        let u = x + a;
        let v = alpha.cos() * y - alpha.sin() * z;
        let w = alpha.sin() * y + alpha.cos() * z + d;
        position = [
            turn.cos() * u - turn.sin() * v,
            turn.sin() * u + turn.cos() * v,
            w,
        ];
    }
    position.iter().map(|each| each * each).sum::<f64>().sqrt()
}

#[test]
fn a_written_file_reads_back_and_means_the_same_device() {
    let set = DataSet::simulate(40).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("distances.bin");
    set.write(&path).unwrap();
    let numbers = read(&path).unwrap();
    assert_eq!(numbers, set.numbers().unwrap());
    assert_eq!(numbers.len(), 2 + 32 + 28 + 8 * 40);
    assert_eq!((numbers[0], numbers[1]), (40.0, set.sd_m));
    // with the solution in place of the nominal values the distances are those measured
    let (channels, weights) = (DataSet::channels(), set.weights());
    let problem =
        DeviceProblem::new(&set.nominal, &set.recording, &channels, &set.free, &weights).unwrap();
    let all: Vec<usize> = (0..28).collect();
    let fit = solve(&problem, &problem.start(), &all, &Settings::default()).unwrap();
    let mut table = numbers[2..34].to_vec();
    let cost = |table: &[f64]| -> f64 {
        let poses = numbers[62..].chunks(8);
        let residual = |pose: &[f64]| (distance_m(table, &pose[..7]) - pose[7]) / numbers[1];
        poses.map(|pose| residual(pose).powi(2)).sum()
    };
    let start = cost(&table);
    let found = set.free.iter().zip(&fit.parameters);
    for (place, (parameter, value)) in numbers[34..62].iter().zip(found) {
        // home angles are in the file's table and not in the device's
        table[*place as usize] += value - parameter.value(&set.nominal);
    }
    assert!(start > 1e3 * fit.cost, "{start}, {}", fit.cost);
    assert!((cost(&table) - fit.cost).abs() < 1e-9 * fit.cost);
}

#[test]
fn a_file_that_is_cut_off_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.bin");
    std::fs::write(&path, [0; 12]).unwrap();
    assert!(read(&path).is_err());
}

#[test]
fn costs_that_differ_are_refused_by_name() {
    let costs = |last: f64| [("ours".to_owned(), 200.0), ("theirs".to_owned(), last)];
    check_costs("work", 1e-9, &costs(200.0 * (1.0 + 9e-10))).unwrap();
    let error = check_costs("work", 1e-9, &costs(200.0 * (1.0 + 1e-8)))
        .unwrap_err()
        .to_string();
    assert!(error.contains("theirs: 200.000002"), "{error}");
    assert!(!error.contains("ours: 200 "), "{error}");
    // the lowest decides, whoever has it
    let error = check_costs("work", 1e-9, &costs(200.0 * (1.0 - 1e-8)))
        .unwrap_err()
        .to_string();
    assert!(error.contains("ours: 200 ("), "{error}");
    assert!(check_costs("work", 1e-9, &costs(f64::NAN)).is_err());
}

#[test]
fn all_of_ours_find_the_same() {
    let set = DataSet::simulate(200).unwrap();
    let mut costs = Vec::new();
    for mut ours in solvers(&set, 1e-10, 1).unwrap() {
        let answer = ours.run(2).unwrap();
        assert_eq!(answer.solve_s.len(), 2);
        costs.push((ours.label().name.clone(), answer.cost.unwrap()));
    }
    assert!(costs.len() >= 3);
    check_costs("200 poses", 1e-9, &costs).unwrap();
    // 200 residuals of unit variance, 28 parameters
    assert!((100.0..260.0).contains(&costs[0].1), "{costs:?}");
}

#[test]
fn a_missing_peer_is_in_the_table_without_numbers() {
    let results = Results {
        peers: vec![
            PeerRecord {
                name: "SciPy",
                state: Ok("SciPy 1.0; Python 3".to_owned()),
            },
            PeerRecord {
                name: "Ceres",
                state: Err("no header: apt-get install libceres-dev".to_owned()),
            },
        ],
        comparisons: vec![Comparison {
            work: "200 poses".to_owned(),
            ours_s: vec![1.0, 1.0, 1.0],
            other_s: vec![2.0, 4.0, 3.0],
            ratios: vec![2.0, 4.0, 3.0],
            ..Comparison::default()
        }],
        ..Results::default()
    };
    let table = presence(&results).unwrap();
    let csv = table.to_csv().unwrap();
    assert!(csv.contains("Ceres,missing,\n"), "{csv}");
    assert!(csv.contains("SciPy,here,\n"), "{csv}");
    assert!(table.to_terminal().contains("apt-get install libceres-dev"));
    let table = pairs("200 poses", &results.comparisons).unwrap();
    assert_eq!(table.rows().len(), 1);
    assert!(table.to_csv().unwrap().contains(",3000000,3,"));
    assert!(
        pairs("another work", &results.comparisons)
            .unwrap()
            .rows()
            .is_empty()
    );
    let folder = tempfile::tempdir().unwrap();
    let terminal = write(&results, folder.path(), "command", false).unwrap();
    assert!(terminal.iter().any(|text| text.contains("missing")));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Ceres: missing: no header"));
    for file in ["peers.svg", "peers.json"] {
        assert!(folder.path().join(file).exists(), "{file}");
    }
    // no peer at all is a report too
    let nothing = Results::default();
    write(&nothing, folder.path(), "command", false).unwrap();
}

#[test]
fn the_median_of_ratios_has_the_interval_of_its_order_statistics() {
    let ratios: Vec<f64> = [9, 3, 14, 1, 12, 5, 7, 15, 2, 10, 4, 13, 6, 8, 11]
        .map(f64::from)
        .into();
    let ratio = MedianRatio::new(&ratios).unwrap();
    // n = 15: P(B < 4) = 576 / 32768, P(B < 5) = 1941 / 32768 is too much
    assert_eq!((ratio.median, ratio.low, ratio.high), (8.0, 4.0, 12.0));
    assert!((ratio.confidence - (1.0 - 2.0 * 576.0 / 32768.0)).abs() < 1e-15);
    let few = MedianRatio::new(&[2.0, 5.0, 3.0]).unwrap();
    assert_eq!(
        (few.median, few.low, few.high, few.confidence),
        (3.0, 2.0, 5.0, 0.75)
    );
    let five = MedianRatio::new(&[2.0, 5.0, 3.0, 1.0, 9.0]).unwrap();
    assert_eq!((five.low, five.high, five.confidence), (1.0, 9.0, 0.9375));
    assert_eq!(MedianRatio::new(&[4.0]).unwrap().confidence, 0.0);
    assert!(MedianRatio::new(&[]).is_err());
}

/// Takes the times it is told, in turn.
struct Told {
    label: Label,
    cost: f64,
    times_s: Vec<f64>,
    asked: usize,
}

impl Contender for Told {
    fn label(&self) -> &Label {
        &self.label
    }

    fn run(&mut self, _repeats: usize) -> Result<Answer> {
        let solve_s = vec![self.times_s[self.asked]];
        self.asked += 1;
        Ok(Answer {
            cost: Some(self.cost),
            solve_s,
            ..Answer::default()
        })
    }
}

fn told(cost: f64, times_s: &[f64]) -> Told {
    Told {
        label: Label::new("test", "told", 1),
        cost,
        times_s: times_s.to_vec(),
        asked: 0,
    }
}

#[test]
fn ratios_are_taken_pair_by_pair() {
    let plan = Plan {
        rounds: 3,
        keep_disturbed: true,
        agreement: 1e-9,
    };
    // the machine slows down: the ratio of medians would be the same only by chance
    let (mut ours, mut other) = (told(1.0, &[1.0, 2.0, 10.0]), told(1.0, &[2.0, 6.0, 20.0]));
    let compared = compare("work", (&mut ours, 1), (&mut other, 1), plan).unwrap();
    assert_eq!(compared.ratios, [2.0, 3.0, 2.0]);
    assert_eq!(compared.ratio().unwrap().median, 2.0);
    assert_eq!((compared.discarded, ours.asked), (0, 3));
    let (mut ours, mut other) = (told(1.0, &[1.0]), told(1.0 + 1e-8, &[1.0]));
    let error = compare("work", (&mut ours, 1), (&mut other, 1), plan).unwrap_err();
    assert!(error.to_string().contains("test: told"), "{error}");
}

#[test]
fn a_bar_is_judged_by_the_fastest_way_and_only_where_all_have_a_ratio() {
    let pair = |name: &str, ratios: &[f64]| {
        let label = |family, name: &str| Label::new(family, name, 1);
        Comparison {
            work: "200 poses".to_owned(),
            ours: label("ours", "solve"),
            other: label("Ceres", name),
            ratios: ratios.to_vec(),
            ..Comparison::default()
        }
    };
    let mut pairs = vec![pair("slow", &[40.0; 3]), pair("fast", &[16.0, 14.0, 15.5])];
    let (reached, text) = verdicts(&pairs).remove(0);
    assert!(
        reached && text.contains("Ceres: fast takes 15.50"),
        "{text}"
    );
    pairs[1].ratios = vec![14.9; 3];
    assert!(!verdicts(&pairs)[0].0);
    // the fast one was disturbed in every round
    pairs[1].ratios.clear();
    assert_eq!(verdicts(&pairs), []);
}

#[test]
fn a_warm_start_is_judged_by_its_own_bar_alone() {
    let pair = |ours, ratio: f64| {
        let label = |family| Label::new(family, "solve", 1);
        Comparison {
            work: "100 000 poses".to_owned(),
            ours: label(ours),
            other: label("Ceres"),
            ratios: vec![ratio; 3],
            ..Comparison::default()
        }
    };
    // 25 would pass the cold bar of 15 and fails the warm one of 30
    let found = verdicts(&[pair(COLD, 14.0), pair(WARM, 25.0)]);
    assert_eq!(found.len(), 2);
    assert!(
        !found[0].0 && found[0].1.contains("14.00 times as long as ours: solve"),
        "{found:?}"
    );
    assert!(
        !found[1].0
            && found[1]
                .1
                .contains("25.00 times as long as ours, warm start"),
        "{found:?}"
    );
    let found = verdicts(&[pair(COLD, 16.0), pair(WARM, 31.0)]);
    assert!(found.iter().all(|(reached, _)| *reached), "{found:?}");
}

#[test]
fn repeats_fill_a_tenth_of_a_second() {
    assert_eq!(
        (repeats(1e-3), repeats(5.0), repeats(0.0)),
        (100, 1, 20_000)
    );
}

#[test]
fn labels_say_threads_only_where_there_are_several() {
    let mut label = Label::new("Ceres", "dense QR", 1);
    assert_eq!(label.full(), "Ceres: dense QR");
    label.threads = 2;
    assert_eq!(label.full(), "Ceres: dense QR (2 threads)");
}

#[test]
fn foreign_load_is_what_is_neither_ours_nor_idle() {
    let before = Ticks::of_machine("cpu  100 0 50 1000 10 0 0 5 0 0\ncpu0 1\n").unwrap();
    assert_eq!((before.total, before.busy, before.stolen), (1165, 150, 5));
    let mut now = Ticks::of_machine("cpu  130 0 60 1050 10 5 5 5 0 0\n").unwrap();
    now.own = 40;
    // 50 busy of 100, 40 of them ours
    assert_eq!(now.foreign_share(&before), Some(0.1));
    now.own = 60;
    assert_eq!(now.foreign_share(&before), Some(0.0));
    now.stolen += 30;
    assert_eq!(now.foreign_share(&before), Some(0.3));
    assert_eq!(before.foreign_share(&before), None);
    assert_eq!(Ticks::of_machine("cpu  1 2 3\n"), None);
    let stat = "12 (a (b) c) R 1 2 3 4 5 6 7 8 9 10 70 30 0 0 20";
    assert_eq!(of_process(stat), Some(100));
    assert_eq!(of_process("no process"), None);
}

#[test]
fn answers_without_times_are_refused() {
    let line = r#"{"cost":2.5,"iterations":3,"construction_s":[],"solve_s":[0.5,0.25]}"#;
    let answer = Answer::from_json(line).unwrap();
    assert_eq!((answer.cost, answer.iterations), (Some(2.5), Some(3)));
    assert_eq!(answer.solve_s, [0.5, 0.25]);
    for bad in [
        "",
        "{}",
        r#"{"solve_s":[]}"#,
        r#"{"solve_s":[-1.0]}"#,
        r#"{"solve_s":["nan"]}"#,
    ] {
        assert!(Answer::from_json(bad).is_err(), "{bad}");
    }
}

#[test]
fn poses_that_are_not_ours_are_refused() {
    let set = DataSet::simulate(2).unwrap();
    let mut values = Poses::new(&set).unwrap().values().unwrap();
    assert_eq!(values.len(), 2 * 54);
    let say = |values: &[f64]| serde_json::json!({ "values": values }).to_string();
    let ours = values.clone();
    // JSON is read to the last bit but one
    assert!(check_values("peer", &say(&values), &ours).unwrap() < 1e-15);
    // the last column of the rotation of the first pose against the file's own chain
    let numbers = set.numbers().unwrap();
    let position: f64 = [3, 7, 11]
        .map(|index| ours[index] * ours[index])
        .iter()
        .sum();
    assert!((position.sqrt() - distance_m(&numbers[2..34], &numbers[62..69])).abs() < 1e-12);
    values[60] += 2e-10;
    let error = check_values("peer", &say(&values), &ours)
        .unwrap_err()
        .to_string();
    assert!(error.contains("number 6 of pose 1"), "{error}");
    assert!(check_values("peer", &say(&values[1..]), &ours).is_err());
}
