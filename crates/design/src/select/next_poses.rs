//! The chosen poses of a plan, in the order in which they are driven to, and the uncertainty that they will leave.

use serde::Serialize;

use crate::{
    Criterion, DesignError, Figures, Information, Posture, Request, Search, driving_order, select,
    task_rows,
};

/// The chosen poses.
#[derive(Debug, Clone, Serialize)]
pub struct NextPoses {
    /// The rig that they are for.
    pub measure: String,
    /// What they are best for.
    pub criterion: Criterion,
    /// How many they are.
    pub count: usize,
    /// From how many they were chosen.
    pub candidates: usize,
    /// Their figures of merit.
    pub figures: Figures,
    /// Medians over random choices of as many candidates.
    pub random: Option<Figures>,
    /// Exchanges of the search.
    pub exchanges: usize,
    /// The standard deviation that they will leave of each parameter that the rig identifies.
    pub parameters: Vec<Predicted>,
    /// The poses, each near the one before: not part of plan.json, but of poses.csv.
    #[serde(skip)]
    pub postures: Vec<Posture>,
}

/// Standard deviation that the chosen poses give a parameter.
#[derive(Debug, Clone, Serialize)]
pub struct Predicted {
    /// Name.
    pub name: String,
    /// Unit of the two numbers.
    pub unit: String,
    /// Plausible size of its deviation from nominal.
    pub plausible_size: f64,
    /// Standard deviation (Cramér-Rao, and the scales of instruments).
    pub standard_deviation: f64,
}

impl NextPoses {
    /// Chooses poses for a rig among its candidates.
    pub(crate) fn choose(
        request: &Request,
        information: &Information,
        candidates: &[Posture],
    ) -> Result<Self, DesignError> {
        let (count, criterion) = (request.poses, request.criterion);
        let judged = information.judge(count)?;
        let place = (&request.region, &request.limits);
        let task = task_rows(
            criterion,
            information,
            &judged.independent,
            place,
            request.seed,
        )?;
        let search = Search {
            seed: request.seed,
            ..Search::default()
        };
        let selection = select(information, &judged, count, criterion, &task, &search)?;
        let chosen = selection.chosen.iter();
        let chosen: Vec<&Posture> = chosen.map(|&pose| &candidates[pose]).collect();
        let readings: Vec<Vec<f64>> = chosen.iter().map(|pose| pose.readings.clone()).collect();
        let order = driving_order(&readings);
        let by_scale = information.deviations_by_scale(&selection.chosen, &selection.parameters)?;
        let deviations = selection.deviations.iter().zip(by_scale);
        let deviations = deviations.map(|(by_noise, by_scale)| by_noise.hypot(by_scale));
        let parameters = selection.parameters.iter().zip(deviations);
        let parameters = parameters.map(|(&index, standard_deviation)| {
            let info = &information.infos[index];
            Predicted {
                name: info.name.clone(),
                unit: info.unit.clone(),
                plausible_size: info.plausible_size,
                standard_deviation,
            }
        });
        Ok(Self {
            measure: information.equipped.rig.name.clone(),
            criterion,
            count,
            candidates: candidates.len(),
            figures: selection.figures,
            random: selection.random,
            exchanges: selection.history.len() - 1,
            parameters: parameters.collect(),
            postures: order.iter().map(|&pose| chosen[pose].clone()).collect(),
        })
    }
}
