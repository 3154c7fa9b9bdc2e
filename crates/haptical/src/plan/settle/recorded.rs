//! What a recording says of how the next one can be made: its rate, the forces on the handle, the temperature.

use haptical_model::{Recording, Statics};

use crate::device::Device;

/// Time between rows above which they are single postures \[s\].
const SINGLE_POSTURES_S: f64 = 0.25;
/// Share of the recorded forces on the handle above the one that is asked for again.
const PRESS_QUANTILE: f64 = 0.95;
/// Smallest force that is worth pressing \[N\].
const LEAST_PRESS_N: f64 = 0.1;

/// Temperature at the end of a recording.
pub(super) fn last_degc(recording: &Recording) -> Option<f64> {
    let column = recording.temperature_degc.as_ref()?;
    let mut known = column.iter().rev();
    known.find(|degc| degc.is_finite()).copied()
}

/// Loads of a motion that nobody has made yet come from masses and forces alone.
pub(super) fn torques_unknown(device: &Device, recording: &Recording) -> Option<String> {
    let has_torques = recording.torque_nm.iter().any(Option::is_some);
    let is_known = Statics::new(&device.model).has_weights() || recording.force_n.is_some();
    (has_torques && !is_known).then(|| {
        format!(
            "{}: it has no masses with gravity, and the log no forces: the torques of a further motion are not known, and \
             effects of torque count as ones that it does not show",
            device.source().label
        )
    })
}

/// Rows per second of a motion; none of single postures.
pub(super) fn rate_hz(recording: &Recording) -> Option<f64> {
    let times = recording.time_s.as_ref()?;
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_unstable_by(f64::total_cmp);
    let middle = *steps.get(steps.len() / 2)?;
    (middle < SINGLE_POSTURES_S).then_some(1.0 / middle)
}

/// The force to press with: as asked for, or nearly the largest that was recorded.
pub(super) fn press_n(recording: &Recording, asked_n: Option<f64>) -> Option<f64> {
    let [x, y, z] = recording.force_n.as_ref()?;
    let newtons = asked_n.or_else(|| {
        let rows = x.iter().zip(y).zip(z);
        let mut sizes: Vec<f64> = rows.map(|((x, y), z)| x.hypot(*y).hypot(*z)).collect();
        sizes.retain(|size| size.is_finite());
        sizes.sort_unstable_by(f64::total_cmp);
        let place = (PRESS_QUANTILE * sizes.len() as f64) as usize;
        // tenths of a newton: nobody presses more exactly
        sizes.get(place).map(|size| (10.0 * size).round() / 10.0)
    });
    newtons.filter(|newtons| *newtons >= LEAST_PRESS_N)
}
