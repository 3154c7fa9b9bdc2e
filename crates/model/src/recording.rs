//! A recording in memory: the measured columns of one log, with the rows they came from.

pub(crate) mod joined;

/// Measurements of one device, column by column, all in SI units.
///
/// Every column has [`Recording::len`] entries. A reading that is absent (an empty cell of the log)
/// is `NaN`; the motor-side readings are always finite. Rows keep the order of the log, and rows of
/// one `run` belong to one uninterrupted recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// Line of the log that each row came from (1 is the header), for error messages.
    pub line: Vec<u64>,
    /// Time \[s\], strictly increasing within a run.
    pub time_s: Option<Vec<f64>>,
    /// Recording that each row belongs to.
    pub run: Option<Vec<i64>>,
    /// Motor-side encoder readings divided by the nominal transmission ratio, one column per joint
    /// (\[rad\], or \[m\] for a prismatic joint).
    pub joint: Vec<Vec<f64>>,
    /// External encoder readings of each joint's output axis (\[rad\] or \[m\]), where there are any.
    pub output: Vec<Option<Vec<f64>>>,
    /// Distances that the cable encoders measure \[m\], in the order of the device's cables.
    pub cable_m: Vec<Option<Vec<f64>>>,
    /// Handle position from an external tracker, x, y, z \[m\].
    pub position_m: Option<[Vec<f64>; 3]>,
    /// Handle orientation from an external tracker, unit quaternion w, x, y, z.
    pub orientation_wxyz: Option<[Vec<f64>; 4]>,
    /// Joint-side drive torques \[N m\].
    pub torque_nm: Vec<Option<Vec<f64>>>,
    /// Force of the hand on the handle in the end-effector frame \[N\].
    pub force_n: Option<[Vec<f64>; 3]>,
    /// Device temperature \[degC\].
    pub temperature_degc: Option<Vec<f64>>,
    /// Name of the hand that a row's positions, orientations, touches and forces are of; none where the device has
    /// but one.
    pub hand: Option<Vec<String>>,
    /// Text identifiers of touched points (`contact`) and planes (`plane`); empty text is none.
    pub contact: Option<Vec<String>>,
    /// See [`Recording::contact`].
    pub plane: Option<Vec<String>>,
    /// Text identifiers of what is on the hand and is seen, or touches (`tool`); empty text is the handle itself, or
    /// the tracker's one tool.
    pub tool: Option<Vec<String>>,
    /// Any other numeric column, by its header, kept as a covariate.
    pub covariates: Vec<(String, Vec<f64>)>,
    /// What the effects of a device ([`crate::Device::effects`]) add to the readings. Worked out on a whole recording: a play
    /// knows where its joint was before.
    pub added: Vec<AddedReadings>,
}

/// What kind of effect adds to a reading: a model of the channel treats them in different ways.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum AddedBy {
    /// One that follows the motion.
    #[default]
    Motion,
    /// Friction of a drive, which may have another size on another day.
    Friction,
    /// One that is a share of the reading itself.
    Reading,
}

/// What one effect adds to the readings of one axis of a channel, linear about the values of its numbers at which it was
/// worked out.
#[derive(Debug, Clone, PartialEq)]
pub struct AddedReadings {
    /// Position of the effect within [`crate::Device::effects`].
    pub effect: usize,
    /// Channel by name: `out2`, `position`.
    pub channel: String,
    /// Axis of a channel with several.
    pub axis: usize,
    /// What kind of effect adds it.
    pub by: AddedBy,
    /// What it adds at [`AddedReadings::at`], row by row, in the channel's unit.
    pub readings: Vec<f64>,
    /// Values of its numbers ([`crate::DeviceEffect::fitted`]).
    pub at: Vec<f64>,
    /// Derivatives by each of its numbers, row by row.
    pub slopes: Vec<Vec<f64>>,
}

impl Recording {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.joint.first().map_or(0, Vec::len)
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The run that a row belongs to; 0 where the recording has no runs, and so is one.
    ///
    /// # Panics
    /// If the recording has runs and the row is not below [`Recording::len`].
    pub fn run_at(&self, row: usize) -> i64 {
        self.run.as_ref().map_or(0, |runs| runs[row])
    }

    /// Whether a tracker saw a position or an orientation at a row.
    ///
    /// # Panics
    /// If the recording has such readings and the row is not below [`Recording::len`].
    pub fn is_seen_by_tracker(&self, row: usize) -> bool {
        let position = self.position_m.iter().flatten();
        let mut all = position.chain(self.orientation_wxyz.iter().flatten());
        all.any(|column| column[row].is_finite())
    }

    /// The positions that a joint was commanded to, row by row (\[rad\], or \[m\] for a slide): the column `command1_rad` or
    /// `command1_m` of joint 0. `NaN` where a row has none; none where the log has no such column.
    ///
    /// # Examples
    /// ```
    /// use haptical_model::Recording;
    ///
    /// let recording = Recording {
    ///     covariates: vec![("command2_rad".to_owned(), vec![0.1, 0.2])],
    ///     ..Recording::default()
    /// };
    /// assert_eq!(recording.command(1), Some(&[0.1, 0.2][..]));
    /// assert_eq!(recording.command(0), None);
    /// ```
    pub fn command(&self, joint: usize) -> Option<&[f64]> {
        let number = joint + 1;
        self.covariate(&[format!("command{number}_rad"), format!("command{number}_m")])
    }

    /// Velocities of a joint that the log states \[rad/s\] (\[m/s\] of a slide): `velocity3_rad_per_s`.
    pub fn velocity(&self, joint: usize) -> Option<&[f64]> {
        let number = joint + 1;
        self.covariate(&[
            format!("velocity{number}_rad_per_s"),
            format!("velocity{number}_m_per_s"),
        ])
    }

    /// Current of a joint's motor \[A\]: `current3_a`.
    pub fn current(&self, joint: usize) -> Option<&[f64]> {
        self.covariate(&[format!("current{}_a", joint + 1)])
    }

    /// Voltage of the drives' supply \[V\]: `supply_v`.
    pub fn supply(&self) -> Option<&[f64]> {
        self.covariate(&["supply_v".to_owned()])
    }

    fn covariate(&self, names: &[String]) -> Option<&[f64]> {
        let mut columns = self.covariates.iter();
        let own = columns.find(|(name, _)| names.contains(name));
        own.map(|(_, column)| column.as_slice())
    }

    /// Writes the joint readings of a row into `readings`, one for each joint.
    ///
    /// # Panics
    /// If the row is not below [`Recording::len`].
    pub fn read_joints(&self, row: usize, readings: &mut [f64]) {
        for (reading, column) in readings.iter_mut().zip(&self.joint) {
            *reading = column[row];
        }
    }

    /// The rows at `indices`, in that order.
    ///
    /// # Panics
    /// If an index is not below [`Recording::len`].
    #[must_use]
    pub fn select(&self, indices: &[usize]) -> Self {
        let numbers = |column: &Vec<f64>| take(column, indices);
        let texts = |column: &Vec<String>| take(column, indices);
        let many = |columns: &[Option<Vec<f64>>]| {
            let columns = columns.iter();
            columns.map(|column| column.as_ref().map(numbers)).collect()
        };
        let covariates = self.covariates.iter();
        Self {
            line: take(&self.line, indices),
            time_s: self.time_s.as_ref().map(numbers),
            run: self.run.as_ref().map(|column| take(column, indices)),
            joint: self.joint.iter().map(numbers).collect(),
            output: many(&self.output),
            cable_m: many(&self.cable_m),
            position_m: self
                .position_m
                .as_ref()
                .map(|axes| axes.each_ref().map(numbers)),
            orientation_wxyz: self
                .orientation_wxyz
                .as_ref()
                .map(|parts| parts.each_ref().map(numbers)),
            torque_nm: many(&self.torque_nm),
            force_n: self
                .force_n
                .as_ref()
                .map(|axes| axes.each_ref().map(numbers)),
            temperature_degc: self.temperature_degc.as_ref().map(numbers),
            hand: self.hand.as_ref().map(texts),
            contact: self.contact.as_ref().map(texts),
            plane: self.plane.as_ref().map(texts),
            tool: self.tool.as_ref().map(texts),
            covariates: covariates
                .map(|(name, column)| (name.clone(), numbers(column)))
                .collect(),
            added: self.added.iter().map(|own| own.select(indices)).collect(),
        }
    }
}

impl AddedReadings {
    fn select(&self, indices: &[usize]) -> Self {
        Self {
            effect: self.effect,
            channel: self.channel.clone(),
            axis: self.axis,
            by: self.by,
            readings: take(&self.readings, indices),
            at: self.at.clone(),
            slopes: self
                .slopes
                .iter()
                .map(|slope| take(slope, indices))
                .collect(),
        }
    }
}

fn take<T: Clone>(column: &[T], indices: &[usize]) -> Vec<T> {
    indices.iter().map(|&index| column[index].clone()).collect()
}

/// Whether a column has more than one value: where it has not, nothing was measured. Cells that are empty do not count.
///
/// ```
/// use haptical_model::varies;
///
/// assert!(varies(&[f64::NAN, 0.1, 0.2]));
/// assert!(!varies(&[0.1, f64::NAN, 0.1]) && !varies(&[]));
/// ```
pub fn varies(values: &[f64]) -> bool {
    let mut known = values.iter().filter(|value| value.is_finite());
    let first = known.next();
    known.any(|value| Some(value) != first)
}
