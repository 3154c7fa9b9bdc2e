//! The poses to measure next, and the uncertainty that they will leave.

pub(crate) mod candidates;
pub(crate) mod change;
pub(crate) mod criterion;
pub(crate) mod exchange;
pub(crate) mod gains;
pub(crate) mod next_poses;
pub(crate) mod state;
pub(crate) mod whitened;

use haptical_identification::Identifiability;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::select::criterion::Score;
use crate::select::exchange::search;
use crate::select::state::State;
use crate::select::whitened::Whitened;
use crate::{Criterion, DesignError, Information, Search};

/// Figures of merit of a set of poses, without units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Geometric mean of the standard deviations over plausible sizes along the axes of the confidence
    /// ellipsoid, det(M)^(-1/(2 L)) of the scaled information matrix: what D makes small.
    pub geometric_mean_sd: f64,
    /// Observability index O1: 1 / (geometric mean sd * sqrt(readings)).
    pub o1: f64,
    /// Root of the quadratic criterion, where there is one: root mean square of sd over plausible size for A,
    /// of the handle's position error in m or of the force's angle in rad for a task.
    pub root_mean_square: Option<f64>,
}

/// Poses chosen among candidates.
#[derive(Debug, Clone)]
pub struct Selection {
    /// What was made best.
    pub criterion: Criterion,
    /// Chosen candidates, ascending.
    pub chosen: Vec<usize>,
    /// Parameters that the rig identifies, by index: those that the criterion is about. Combinations and
    /// invisible ones are held.
    pub parameters: Vec<usize>,
    /// Their standard deviations with the chosen poses (Cramér-Rao).
    pub deviations: Vec<f64>,
    /// Figures of the chosen poses.
    pub figures: Figures,
    /// Medians of the same figures over random choices of as many poses; none where these fix too little.
    pub random: Option<Figures>,
    /// Score of the start and after each exchange: never falls.
    pub history: Vec<f64>,
}

/// Random choices that a selection is compared with.
const RANDOM_CHOICES: usize = 15;

/// Chooses `count` of the poses of `information`. `judged` says which parameters are free
/// ([`Information::judge`]), `task` is from [`crate::task_rows`].
///
/// ```
/// use haptical_design::{
///     Criterion, Information, Limits, Rig, Search, Terms, equip, postures, select, task_rows,
/// };
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let mut equipped = equip(&device, &Rig::parse("cable")?, Terms::Known)?;
/// let candidates = postures(&mut equipped, &Limits::default(), 200, 1)?;
/// let information = Information::new(&equipped, &candidates, &[])?;
/// let judged = information.judge(40)?;
/// let chosen = select(&information, &judged, 40, Criterion::D, &[], &Search::default())?;
/// assert_eq!(chosen.chosen.len(), 40);
/// assert!(chosen.figures.o1 > chosen.random.map_or(0.0, |random| random.o1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError::NothingIdentifiable`], [`DesignError::TooFewCandidates`], [`DesignError::TooFewPoses`].
pub fn select(
    information: &Information,
    judged: &Identifiability,
    count: usize,
    criterion: Criterion,
    task: &[Vec<f64>],
    settings: &Search,
) -> Result<Selection, DesignError> {
    if count == 0 || count > information.poses() {
        return Err(DesignError::TooFewCandidates {
            poses: count,
            candidates: information.poses(),
        });
    }
    let rows = Whitened::new(information, judged)?;
    let score = Score::new(criterion, &rows, task);
    let found = search(&rows, &score, count, settings);
    let found = found.ok_or_else(|| too_few(information, &rows, count))?;
    let sizes: Vec<f64> = information
        .infos
        .iter()
        .map(|info| info.plausible_size)
        .collect();
    let shift = rows.log_det_shift(&sizes);
    let figures = |chosen: &[usize]| {
        let mut flags = vec![false; rows.poses()];
        chosen.iter().for_each(|&pose| flags[pose] = true);
        let state = State::new(&rows, score.weight(), flags, 0.0)?;
        Some(figures(&state, shift, score.weight().is_some()))
    };
    // fewer readings than parameters fix them by rounding alone
    let of_chosen = found
        .chosen
        .iter()
        .map(|&pose| information.readings(Some(pose)));
    let readings = information.readings(None) + of_chosen.sum::<usize>();
    let is_enough = readings >= rows.columns.len();
    let of_found = is_enough.then(|| figures(&found.chosen)).flatten();
    let of_found = of_found.ok_or_else(|| too_few(information, &rows, count))?;
    Ok(Selection {
        criterion,
        deviations: information.deviations(&found.chosen, &rows.columns)?,
        random: of_random(rows.poses(), count, settings.seed, figures),
        figures: of_found,
        history: found.history,
        chosen: found.chosen,
        parameters: rows.columns,
    })
}

fn too_few(information: &Information, rows: &Whitened, count: usize) -> DesignError {
    let parameters = rows.columns.len();
    let all = rows.first.last().copied().unwrap_or(0) - rows.first[0];
    let each = all as f64 / rows.poses() as f64;
    DesignError::TooFewPoses {
        poses: count,
        readings: information.readings(None) + (each * count as f64) as usize,
        parameters,
        // half as many again as there are parameters, and enough for each of them: encoders do not pay for links
        advised: usize::max(
            (1.5 * parameters as f64 / each.max(f64::MIN_POSITIVE)).ceil() as usize,
            enough(rows, count),
        ),
    }
}

/// Fewest of the candidates, in their order, that fix every parameter; `count` are too few, all are enough.
fn enough(rows: &Whitened, count: usize) -> usize {
    let (mut few, mut many) = (count, rows.poses());
    while many > few + 1 {
        let middle = few + (many - few) / 2;
        let flags = (0..rows.poses()).map(|pose| pose < middle).collect();
        match State::new(rows, None, flags, 0.0) {
            Some(_) => many = middle,
            None => few = middle,
        }
    }
    many
}

fn figures(state: &State<'_>, shift: f64, has_task: bool) -> Figures {
    let parameters = state.parameters() as f64;
    let geometric_mean_sd = (-(state.log_det + shift) / (2.0 * parameters)).exp();
    Figures {
        geometric_mean_sd,
        o1: 1.0 / (geometric_mean_sd * (state.readings as f64).sqrt()),
        root_mean_square: has_task.then(|| state.trace.max(0.0).sqrt()),
    }
}

/// Medians over random choices.
fn of_random(
    poses: usize,
    count: usize,
    seed: u64,
    figures: impl Fn(&[usize]) -> Option<Figures>,
) -> Option<Figures> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // beyond the streams of the search's starts
    random.set_stream(u64::MAX);
    let mut order: Vec<usize> = (0..poses).collect();
    let mut all = Vec::new();
    for _ in 0..RANDOM_CHOICES {
        order.shuffle(&mut random);
        all.extend(figures(&order[..count]));
    }
    let median = |of: &dyn Fn(&Figures) -> f64| {
        let mut values: Vec<f64> = all.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let has_task = all.first()?.root_mean_square.is_some();
    Some(Figures {
        geometric_mean_sd: median(&|figures| figures.geometric_mean_sd)?,
        o1: median(&|figures| figures.o1)?,
        root_mean_square: match has_task {
            true => median(&|figures| figures.root_mean_square.unwrap_or(f64::NAN)),
            false => None,
        },
    })
}

/// Poses in an order to drive through: from home on always to the nearest one that is left, by the largest
/// move of a joint.
///
/// ```
/// let order = haptical_design::driving_order(&[vec![3.0], vec![-1.0], vec![1.5]]);
/// assert_eq!(order, [1, 2, 0]);
/// ```
pub fn driving_order(poses: &[Vec<f64>]) -> Vec<usize> {
    let mut left: Vec<usize> = (0..poses.len()).collect();
    let mut order = Vec::with_capacity(poses.len());
    let mut at: Vec<f64> = poses
        .first()
        .map_or_else(Vec::new, |pose| vec![0.0; pose.len()]);
    while !left.is_empty() {
        let way = |pose: usize| {
            let moves = poses[pose].iter().zip(&at);
            moves
                .map(|(to, from)| (to - from).abs())
                .fold(0.0, f64::max)
        };
        let ways = left
            .iter()
            .enumerate()
            .map(|(place, &pose)| (place, way(pose)));
        let nearest = ways.reduce(|best, other| if other.1 < best.1 { other } else { best });
        let pose = left.remove(nearest.map_or(0, |(place, _)| place));
        at.clone_from(&poses[pose]);
        order.push(pose);
    }
    order
}
