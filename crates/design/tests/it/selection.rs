//! Chosen poses: against every selection there is, against the closed form of a line, and invariances.

use haptical_design::{
    Criterion, Information, Limits, Posture, Region, Search, Selection, Terms, driving_order,
    select, task_rows,
};
use haptical_model::Device;
use haptical_testkit::haptic7;
use proptest::prelude::*;

use crate::support::{arm, names, plan, rig};

fn choose(information: &Information, count: usize, criterion: Criterion) -> Selection {
    let judged = information.judge(count).unwrap();
    let limits = Limits::default();
    let region = (&Region::Everywhere, &limits);
    let task = task_rows(criterion, information, &judged.independent, region, 1).unwrap();
    select(
        information,
        &judged,
        count,
        criterion,
        &task,
        &Search::default(),
    )
    .unwrap()
}

/// A joint alone with an external encoder and equation (1) without drums: offset and ratio are a line's.
fn line() -> Device {
    let text = "[[joint]]\nlower_rad = -0.5\nupper_rad = 0.5\nexternal_encoder_sd_rad = 1e-3\n\
                transmission = \"direct\"\ntransmission_ratio = 1.0\n";
    Device::from_toml(text, "line.toml").unwrap().device
}

#[test]
fn the_best_readings_for_a_line_are_its_ends() {
    // 0.001 rad steps; the optimum of a straight line has half of its points at each end (Fedorov 1972)
    let device = line();
    let mut equipped = rig(&device, "out1", Terms::Degree(1));
    equipped.parameters.truncate(2);
    let grid = (0..=100).map(|step| Posture::free(vec![-0.5 + 0.01 * f64::from(step)]));
    let grid: Vec<Posture> = grid.collect();
    let information = Information::new(&equipped, &grid, &[]).unwrap();
    let chosen = choose(&information, 6, Criterion::D);
    assert_eq!(names(&information, &chosen.parameters).len(), 2);
    assert_eq!(chosen.chosen, [0, 1, 2, 98, 99, 100]);
    // det(X'X) of offset and slope, both known in closed form
    let at: Vec<f64> = chosen
        .chosen
        .iter()
        .map(|&pose| grid[pose].readings[0])
        .collect();
    let square: f64 = at.iter().map(|x| x * x).sum();
    let wanted = 1e-3 / square.sqrt();
    let slope = chosen.deviations.iter().copied().fold(0.0, f64::max);
    assert!((slope / wanted - 1.0).abs() < 1e-9, "{slope} {wanted}");
}

#[test]
fn exchanges_find_the_best_of_all_selections_of_a_small_set() {
    let (information, _) = plan(&arm(), "position", Terms::Known, 11);
    for criterion in [
        Criterion::D,
        Criterion::A,
        Criterion::O1,
        Criterion::TaskPosition,
    ] {
        let judged = information.judge(7).unwrap();
        let limits = Limits::default();
        let region = (&Region::Everywhere, &limits);
        let task = task_rows(criterion, &information, &judged.independent, region, 1).unwrap();
        let choose = |random_starts| {
            let search = Search {
                random_starts,
                ..Search::default()
            };
            select(&information, &judged, 7, criterion, &task, &search).unwrap()
        };
        let value = |selection: &Selection| match criterion {
            Criterion::D | Criterion::O1 => selection.figures.geometric_mean_sd,
            _ => selection.figures.root_mean_square.unwrap(),
        };
        // all selections of 7 of 11, by the analysis and not by updates
        let mut best = f64::INFINITY;
        for mask in 0_u32..1 << 11 {
            if mask.count_ones() != 7 {
                continue;
            }
            let these: Vec<usize> = (0..11).filter(|pose| mask >> pose & 1 == 1).collect();
            if let Some(found) = by_hand(&information, &these, &judged.independent, &task) {
                best = best.min(match criterion {
                    Criterion::D | Criterion::O1 => found.0,
                    _ => found.1,
                });
            }
        }
        let found = value(&choose(6));
        assert!(
            found <= best * (1.0 + 1e-6),
            "{criterion:?}: {found} of {best}"
        );
        assert!(
            found >= best * (1.0 - 1e-6),
            "{criterion:?}: {found} of {best}"
        );
    }
}

/// Geometric mean of sd over plausible size, and the root of the quadratic criterion, from the covariance.
fn by_hand(
    information: &Information,
    chosen: &[usize],
    columns: &[usize],
    task: &[Vec<f64>],
) -> Option<(f64, f64)> {
    // conditional variances, one after the other: their product is the determinant
    let mut log = 0.0;
    for (place, column) in columns.iter().enumerate() {
        let sd = information.deviations(chosen, &columns[..=place]).ok()?[place];
        log += (sd / information.infos[*column].plausible_size).ln();
    }
    let covariance = covariance(information, chosen, columns)?;
    let mut square = 0.0;
    for row in task {
        for (i, a) in columns.iter().enumerate() {
            for (j, b) in columns.iter().enumerate() {
                square += row[*a] * covariance[i][j] * row[*b];
            }
        }
    }
    Some(((log / columns.len() as f64).exp(), square.sqrt()))
}

/// Covariance from standard deviations alone: that of the parameter's sum with another, by a change of basis,
/// would need the library; here it is inverted from the rows' Gram matrix.
fn covariance(
    information: &Information,
    chosen: &[usize],
    columns: &[usize],
) -> Option<Vec<Vec<f64>>> {
    let count = columns.len();
    let gram = information.gram(chosen);
    let matrix = nalgebra::DMatrix::from_fn(count, count, |i, j| {
        let scale = information.infos[columns[i]].plausible_size
            * information.infos[columns[j]].plausible_size;
        gram[columns[i]][columns[j]] * scale
    });
    let inverse = matrix.cholesky()?.inverse();
    Some(
        (0..count)
            .map(|i| {
                (0..count)
                    .map(|j| {
                        let sizes =
                            [columns[i], columns[j]].map(|c| information.infos[c].plausible_size);
                        inverse[(i, j)] * sizes[0] * sizes[1]
                    })
                    .collect()
            })
            .collect(),
    )
}

#[test]
fn every_exchange_is_an_improvement_and_random_choices_are_worse() {
    let (information, _) = plan(&haptic7(), "cable", Terms::Known, 400);
    for criterion in [
        Criterion::D,
        Criterion::A,
        Criterion::O1,
        Criterion::TaskPosition,
        Criterion::TaskForce,
    ] {
        let chosen = choose(&information, 60, criterion);
        assert!(
            chosen.history.windows(2).all(|pair| pair[1] >= pair[0]),
            "{criterion:?}"
        );
        // a threshold with a unit in it would stop the tasks, whose squares are small
        assert!(
            chosen.history.len() > 5,
            "{criterion:?}: {} exchanges",
            chosen.history.len() - 1
        );
        let random = chosen.random.unwrap();
        match criterion {
            Criterion::D | Criterion::O1 => assert!(chosen.figures.o1 > 1.2 * random.o1),
            _ => {
                let (own, random) = (chosen.figures.root_mean_square, random.root_mean_square);
                assert!(
                    own.unwrap() < 0.8 * random.unwrap(),
                    "{criterion:?} {own:?} {random:?}"
                );
            }
        }
        let mut sorted = chosen.chosen.clone();
        sorted.dedup();
        assert_eq!(sorted.len(), 60);
    }
}

#[test]
fn o1_is_d_where_every_pose_gives_as_many_readings_and_equals_the_analysis() {
    let (information, _) = plan(&arm(), "cable,position", Terms::Known, 60);
    let (d, o1) = (
        choose(&information, 12, Criterion::D),
        choose(&information, 12, Criterion::O1),
    );
    assert_eq!(d.chosen, o1.chosen);
    // from conditional standard deviations, one after the other
    let readings: usize = d
        .chosen
        .iter()
        .map(|&pose| information.readings(Some(pose)))
        .sum();
    let (mean_sd, _) = by_hand(&information, &d.chosen, &d.parameters, &[]).unwrap();
    let wanted = 1.0 / (mean_sd * (readings as f64).sqrt());
    assert!(
        (o1.figures.o1 / wanted - 1.0).abs() < 1e-6,
        "{} {wanted}",
        o1.figures.o1
    );
}

#[test]
fn threads_and_repetition_change_nothing() {
    let (information, _) = plan(&arm(), "out,cable", Terms::Degree(2), 120);
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let many = rayon::ThreadPoolBuilder::new()
        .num_threads(5)
        .build()
        .unwrap();
    let one = alone.install(|| choose(&information, 30, Criterion::A));
    let five = many.install(|| choose(&information, 30, Criterion::A));
    assert_eq!(one.chosen, five.chosen);
    assert_eq!(one.deviations, five.deviations);
    assert_eq!(one.history, five.history);
}

#[test]
fn poses_that_were_measured_are_not_measured_again() {
    // the best poses are there already: the next ones are others, and add less
    let device = arm();
    let equipped = rig(&device, "cable", Terms::Known);
    let (information, poses) = plan(&device, "cable", Terms::Known, 100);
    let first = choose(&information, 20, Criterion::D);
    let done: Vec<Posture> = first
        .chosen
        .iter()
        .map(|&pose| poses[pose].clone())
        .collect();
    let information = Information::new(&equipped, &poses, &done).unwrap();
    let next = choose(&information, 5, Criterion::D);
    assert!(next.figures.geometric_mean_sd < first.figures.geometric_mean_sd);
    for (less, more) in next.deviations.iter().zip(&first.deviations) {
        assert!(less <= more);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn units_change_no_choice(scale in 0.01..100.0_f64, angle in prop::sample::select(vec![0.1, 1.0, 7.0])) {
        // the same arm in another unit of length: lengths, standard deviations and anchors scaled
        let _ = angle;
        let small = arm();
        let mut large = small.clone();
        for link in &mut large.links {
            link.a_m *= scale;
            link.d_m *= scale;
        }
        for cable in &mut large.cables {
            cable.distance_sd_m = cable.distance_sd_m.map(|sd| sd * scale);
        }
        let readings = plan(&small, "cable", Terms::Known, 80).1;
        let chosen = |device: &Device| {
            let equipped = rig(device, "cable", Terms::Known);
            let information = Information::new(&equipped, &readings, &[]).unwrap();
            let chosen = choose(&information, 20, Criterion::D);
            (names(&information, &chosen.parameters), chosen.chosen)
        };
        prop_assert_eq!(chosen(&small), chosen(&large));
    }
}

#[test]
fn the_way_through_the_poses_visits_each_once_and_is_shorter() {
    let (_, poses) = plan(&haptic7(), "cable", Terms::Known, 80);
    let poses: Vec<Vec<f64>> = poses.into_iter().map(|posture| posture.readings).collect();
    let order = driving_order(&poses);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, (0..80).collect::<Vec<usize>>());
    let way = |order: &[usize]| -> f64 {
        let one = |pair: &[usize]| {
            let moves = poses[pair[0]].iter().zip(&poses[pair[1]]);
            moves.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        order.windows(2).map(one).sum()
    };
    assert!(way(&order) < 0.8 * way(&(0..80).collect::<Vec<usize>>()));
    assert!(driving_order(&[]).is_empty());
}
