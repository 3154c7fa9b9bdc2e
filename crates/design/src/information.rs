//! The information of each pose of a rig about the parameters: weighted derivatives, pose by pose.

use haptical_calibration::{
    Channel, DeviceProblem, GaugedProblem, ScaleOfLengths, Weights, open_length_scales,
    parameter_infos, preference_order, variance_by_held,
};
use haptical_identification::{
    Identifiability, IdentifiabilityRules, Matrix, ParameterInfo, Reduction, Status, analyse,
    evaluate_jacobian,
};
use haptical_linalg::RANK_TOLERANCE;
use haptical_model::{LengthScale, ParameterId};

use crate::posture::recording;
use crate::{DesignError, Equipped, Posture};

/// Weighted derivatives of a rig's readings at poses, with respect to all parameters that could be free.
///
/// A reading's row is its derivative over its standard deviation, so that the sum of the rows' outer
/// products is Fisher's information matrix (Seber & Wild 2003, section 2.8).
#[derive(Debug, Clone)]
pub struct Information {
    /// The device with the rig.
    pub equipped: Equipped,
    /// Names, units and plausible sizes of the parameters.
    pub infos: Vec<ParameterInfo>,
    order: Vec<usize>,
    rules: IdentifiabilityRules,
    /// Scales of the rig's instruments, which no reading of the rig shows.
    scales: Vec<LengthScale>,
    /// Row by row; those that are there whatever is chosen come first.
    rows: Vec<f64>,
    /// Derivatives by the scales, row by row.
    by_scale: Vec<f64>,
    /// First row of each pose, and the end.
    first: Vec<usize>,
}

impl Information {
    /// The information of `postures`; `measured` are poses that were measured already and count always.
    ///
    /// # Errors
    /// [`DesignError::Pose`], [`DesignError::Calibration`] where the device has no value.
    pub fn new(
        equipped: &Equipped,
        postures: &[Posture],
        measured: &[Posture],
    ) -> Result<Self, DesignError> {
        let has_reference = equipped.channels.iter().any(|channel| is_once(*channel));
        let home = Posture::free(vec![0.0; equipped.device.joints.len()]);
        let reference: &[Posture] = if has_reference { &[home] } else { &[] };
        let all: Vec<Posture> = [reference, measured, postures].concat();
        let mut recording = recording(equipped, &all)?;
        add_references(equipped, &mut recording);
        let weights = Weights::stated(&equipped.device, &equipped.channels);
        let parameters = &equipped.parameters;
        let scales = open_length_scales(&equipped.device, &equipped.channels, parameters);
        let of_scales = scales
            .iter()
            .map(|scale| ParameterId::Surrounding(scale.parameter));
        let both: Vec<ParameterId> = parameters.iter().copied().chain(of_scales).collect();
        let problem = DeviceProblem::new(
            &equipped.device,
            &recording,
            &equipped.channels,
            &both,
            &weights,
        )?;
        let free: Vec<usize> = (0..both.len()).collect();
        let gauged = GaugedProblem::new(&problem)?;
        let (jacobian, _) = evaluate_jacobian(&gauged, &problem.start(), &free)?;
        let always = all.len() - postures.len();
        let mut of_row: Vec<Vec<usize>> = vec![Vec::new(); all.len()];
        for (channel, (mut residual, _)) in problem.layout() {
            for (row, residuals) in of_row.iter_mut().enumerate() {
                if channel.has_reading(&recording, row) {
                    residuals.extend(residual..residual + channel.width());
                    residual += channel.width();
                }
            }
        }
        let (own, others) = free.split_at(parameters.len());
        let mut rows = Vec::with_capacity(jacobian.rows() * own.len());
        let mut by_scale = Vec::with_capacity(jacobian.rows() * others.len());
        let mut first = vec![0];
        for (row, residuals) in of_row.iter().enumerate() {
            for &residual in residuals {
                rows.extend(own.iter().map(|&column| jacobian[(residual, column)]));
                by_scale.extend(others.iter().map(|&column| jacobian[(residual, column)]));
            }
            let end = first.last().copied().unwrap_or(0) + residuals.len();
            match row < always {
                true => first[0] = end,
                false => first.push(end),
            }
        }
        Ok(Self {
            infos: parameter_infos(&equipped.device, parameters),
            order: preference_order(parameters),
            rules: IdentifiabilityRules {
                singular_values: false,
                ..IdentifiabilityRules::default()
            },
            equipped: equipped.clone(),
            scales,
            rows,
            by_scale,
            first,
        })
    }

    /// Adds the information of another recording of the same device, whatever is chosen: every pose of `known`.
    ///
    /// Parameters are matched by their names; what this rig's parameters lack is taken as known.
    ///
    /// ```
    /// use haptical_design::{Information, Posture, Rig, Terms, equip};
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
    /// let device = haptical_model::Device::load(path.as_ref())?.device;
    /// let of = |rig: &str, angle: f64| {
    ///     let equipped = equip(&device, &Rig::parse(rig)?, Terms::Degree(4))?;
    ///     Information::new(&equipped, &[Posture::free(vec![angle; 7])], &[])
    /// };
    /// let cable = of("cable", 0.3)?;
    /// let both = cable.clone().knowing(&of("out2", 0.2)?);
    /// assert_eq!((both.poses(), both.readings(None)), (1, cable.readings(None) + 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn knowing(mut self, known: &Self) -> Self {
        let theirs: Vec<Option<usize>> = self
            .infos
            .iter()
            .map(|info| known.infos.iter().position(|other| other.name == info.name))
            .collect();
        let mut rows = Vec::new();
        let poses = (0..known.poses()).map(Some);
        for row in std::iter::once(None)
            .chain(poses)
            .flat_map(|pose| known.rows_of(pose))
        {
            rows.extend(
                theirs
                    .iter()
                    .map(|column| column.map_or(0.0, |column| row[column])),
            );
        }
        let added = rows.len() / self.parameters().max(1);
        rows.append(&mut self.rows);
        self.rows = rows;
        // what is known by other means does not rest on these scales
        let mut by_scale = vec![0.0; added * self.scales.len()];
        by_scale.append(&mut self.by_scale);
        self.by_scale = by_scale;
        self.first.iter_mut().for_each(|first| *first += added);
        self
    }

    /// Number of poses.
    pub fn poses(&self) -> usize {
        self.first.len() - 1
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.infos.len()
    }

    /// Readings that a pose gives; those that are always there for none.
    pub fn readings(&self, pose: Option<usize>) -> usize {
        pose.map_or(self.first[0], |pose| {
            self.first[pose + 1] - self.first[pose]
        })
    }

    fn row(&self, row: usize) -> &[f64] {
        let width = self.parameters();
        &self.rows[row * width..(row + 1) * width]
    }

    /// The rows of a pose, or those that are always there.
    pub(crate) fn rows_of(&self, pose: Option<usize>) -> impl Iterator<Item = &[f64]> {
        let (start, end) = pose.map_or((0, self.first[0]), |pose| {
            (self.first[pose], self.first[pose + 1])
        });
        (start..end).map(|row| self.row(row))
    }

    /// Reduced rows of chosen poses and those that are always there, the chosen times a factor.
    pub(crate) fn reduce(
        &self,
        chosen: impl Iterator<Item = usize>,
        factor: f64,
    ) -> Result<Reduction, DesignError> {
        let always = self.rows_of(None).map(|row| (row, 1.0));
        let chosen = chosen.flat_map(|pose| self.rows_of(Some(pose)).map(|row| (row, factor)));
        let rows: Vec<(&[f64], f64)> = always.chain(chosen).collect();
        // a matrix without rows has no reduction
        let count = rows.len().max(1);
        let mut matrix = Matrix::zeros(count, self.parameters());
        for (index, (row, factor)) in rows.iter().enumerate() {
            for (column, value) in row.iter().enumerate() {
                matrix[(index, column)] = value * factor;
            }
        }
        Ok(Reduction::new(&matrix, &vec![0.0; count])?)
    }

    /// Judges every parameter for `count` poses of the kind of these: their mean information times `count`.
    ///
    /// # Errors
    /// Refusals of the analysis.
    pub fn judge(&self, count: usize) -> Result<Identifiability, DesignError> {
        let factor = (count as f64 / self.poses().max(1) as f64).sqrt();
        self.analyse(&self.reduce(0..self.poses(), factor)?)
    }

    /// Fisher's information matrix of chosen poses, over all parameters.
    ///
    /// # Panics
    /// For a pose that is not there.
    pub fn gram(&self, chosen: &[usize]) -> Vec<Vec<f64>> {
        let width = self.parameters();
        let mut gram = vec![vec![0.0; width]; width];
        let poses = std::iter::once(None).chain(chosen.iter().copied().map(Some));
        for row in poses.flat_map(|pose| self.rows_of(pose)) {
            for (line, left) in gram.iter_mut().zip(row) {
                let entries = line.iter_mut().zip(row);
                entries.for_each(|(entry, right)| *entry += left * right);
            }
        }
        gram
    }

    /// The scales of instruments that the lengths of this rig rest on.
    pub fn length_scales(&self) -> Vec<ScaleOfLengths> {
        let scales = self.scales.iter();
        let named = scales.map(|scale| ScaleOfLengths::of_instrument(&self.equipped.device, scale));
        named.collect()
    }

    /// Standard deviations that the scales of instruments give the parameters `columns`, `chosen` poses measured: they go beyond
    /// what [`Information::deviations`] and [`Information::judge`] give, which is by the noise alone.
    ///
    /// # Errors
    /// Refusals of the linear algebra.
    ///
    /// # Panics
    /// For a pose that is not there.
    pub fn deviations_by_scale(
        &self,
        chosen: &[usize],
        columns: &[usize],
    ) -> Result<Vec<f64>, DesignError> {
        let (width, scales) = (columns.len(), self.scales.len());
        if scales == 0 {
            return Ok(vec![0.0; width]);
        }
        let poses = chosen
            .iter()
            .map(|&pose| (self.first[pose], self.first[pose + 1]));
        let rows: Vec<usize> = std::iter::once((0, self.first[0]))
            .chain(poses)
            .flat_map(|(start, end)| start..end)
            .collect();
        let matrix = Matrix::from_fn(rows.len().max(1), width + scales, |index, column| {
            let Some(&row) = rows.get(index) else {
                return 0.0;
            };
            match column.checked_sub(width) {
                None => self.row(row)[columns[column]],
                Some(scale) => self.by_scale[row * scales + scale],
            }
        });
        let reduction = Reduction::new(&matrix, &vec![0.0; rows.len().max(1)])?;
        let all: Vec<usize> = (0..width + scales).collect();
        let (own, others) = all.split_at(width);
        let sizes: Vec<f64> = self.scales.iter().map(|scale| scale.sd).collect();
        let variances = variance_by_held(&reduction, own, others, &sizes)?;
        Ok(variances.into_iter().map(f64::sqrt).collect())
    }

    /// What a judgement of all these poses says, the scales of instruments counted in the standard deviations of what it identifies.
    ///
    /// # Errors
    /// Refusals of the linear algebra.
    pub(crate) fn with_scales(&self, judged: &Identifiability) -> Result<Vec<Status>, DesignError> {
        let is_fixed =
            |index: &usize| matches!(judged.statuses[*index], Status::Identifiable { .. });
        let fixed: Vec<usize> = (0..judged.statuses.len()).filter(is_fixed).collect();
        let poses: Vec<usize> = (0..self.poses()).collect();
        let added = self.deviations_by_scale(&poses, &fixed)?;
        let mut statuses = judged.statuses.clone();
        for (index, added) in fixed.into_iter().zip(added) {
            if let Status::Identifiable { standard_deviation } = &mut statuses[index] {
                *standard_deviation = standard_deviation.hypot(added);
            }
        }
        Ok(statuses)
    }

    fn analyse(&self, reduction: &Reduction) -> Result<Identifiability, DesignError> {
        Ok(analyse(reduction, &self.infos, &self.order, &self.rules)?)
    }

    /// Standard deviations that chosen poses give the parameters `columns`, the others known (Cramér-Rao).
    ///
    /// # Errors
    /// [`DesignError::Identification`] where the poses do not fix them.
    ///
    /// # Panics
    /// For a pose that is not there.
    pub fn deviations(&self, chosen: &[usize], columns: &[usize]) -> Result<Vec<f64>, DesignError> {
        let reduction = self.reduce(chosen.iter().copied(), 1.0)?;
        let covariance = reduction.covariance(columns, RANK_TOLERANCE)?;
        let diagonal = (0..columns.len()).map(|index| covariance[(index, index)].sqrt());
        Ok(diagonal.collect())
    }
}

/// Whether a channel is read once, at the start, whatever poses follow.
fn is_once(channel: Channel) -> bool {
    matches!(
        channel,
        Channel::Fixture { .. } | Channel::ContactPair { .. } | Channel::PlanePair { .. }
    )
}

/// Puts the readings of fixtures into the first row, which has nothing else but them.
fn add_references(equipped: &Equipped, recording: &mut haptical_model::Recording) {
    if !equipped.channels.iter().any(|channel| is_once(*channel)) {
        return;
    }
    let blank = |column: &mut Vec<f64>| {
        if let Some(first) = column.first_mut() {
            *first = f64::NAN;
        }
    };
    let columns = recording.output.iter_mut().chain(&mut recording.cable_m);
    columns.flatten().for_each(blank);
    let axes = recording.position_m.iter_mut().flatten();
    let parts = recording.orientation_wxyz.iter_mut().flatten();
    axes.chain(parts).for_each(blank);
    for channel in &equipped.channels {
        if let Channel::Fixture { joint } = *channel {
            let unit = equipped.device.joints[joint].unit();
            let column = (0..recording.len()).map(|row| if row == 0 { 0.0 } else { f64::NAN });
            let name = format!("fixture{}_{unit}", joint + 1);
            recording.covariates.push((name, column.collect()));
        }
    }
}
