//! A device file that holds a fit, read again and replayed on the log of that fit before it is written.

use crate::device::Device;
use crate::log::Log;
use crate::replay::replay;
use crate::units::Shown;

/// Share of a channel's root mean square by which a replay may leave more than the fit.
const SHARE: f64 = 0.01;
/// The same of the channel's noise, where a fit leaves next to nothing: a computed log has no noise.
const SHARE_OF_NOISE: f64 = 1e-3;

/// What a fit leaves of a channel, on the rows that it used.
#[derive(Debug, Clone)]
pub(crate) struct Left {
    pub(crate) channel: String,
    pub(crate) unit: String,
    pub(crate) rms: f64,
    /// None where no row was held out.
    pub(crate) held_out: Option<f64>,
    pub(crate) noise_floor: f64,
}

impl Left {
    /// Whether a replay that leaves so much misses the fit. It may leave less: a fit takes large effects to the first order along the
    /// chain, and the device of a file as they are.
    pub(crate) fn is_missed_by(&self, rms: f64) -> bool {
        let most = (1.0 + SHARE) * self.rms + SHARE_OF_NOISE * self.noise_floor;
        // a replay without a number is no replay
        rms.is_nan() || rms > most
    }
}

/// Comments of a file of a fit: what the fit leaves, and what the file does not hold. A reader takes them for those of the
/// provenance, with which they go when another file is made of it.
pub(crate) fn comments(left: &[Left], not_in_file: &[String]) -> String {
    let mut text = String::new();
    for own in left {
        let shown = Shown::fine(&own.unit);
        let size = |rms: f64| format!("{rms:e} {} ({})", own.unit, shown.text(rms));
        let held_out = own
            .held_out
            .map(|rms| format!("; held out, rms_after = {}", size(rms)));
        text += &format!(
            "# provenance: fit of {}: rms_fit = {}, on all its rows{}\n",
            own.channel,
            size(own.rms),
            held_out.unwrap_or_default()
        );
    }
    for words in not_in_file {
        text += &format!("# provenance: not in this file: {words}\n");
    }
    text
}

/// What a device file leaves of each channel that is replayed, by the way of `haptical simulate --replay`, on all rows of a log. On
/// those that the fit used, where `has` says so, it must be no more than the fit leaves. Nothing where the log has no such channel.
///
/// # Errors
/// Why the file does not hold its fit.
pub(crate) fn reproduced(
    text: &str,
    name: &str,
    log: &Log,
    left: &[Left],
    has: &dyn Fn(&str, usize) -> bool,
) -> Result<Vec<(String, f64)>, String> {
    let device = Device::from_toml(text, name)
        .map_err(|error| format!("it would not be read again: {error}"))?;
    let is_replayed = |own: &&Left| {
        let of = |begin: &str| own.channel.starts_with(begin);
        of("out") || of("cable") || of("position") || of("orientation")
    };
    let wanted: Vec<&Left> = left.iter().filter(is_replayed).collect();
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let replayed = replay(&device, log)
        .map_err(|error| format!("it cannot be replayed on the log of its fit: {error}"))?;
    let (mut found, mut misses) = (Vec::new(), Vec::new());
    for own in wanted {
        let channel = (replayed.channels.iter()).find(|channel| channel.channel == own.channel);
        let rows = channel.map_or(&[][..], |channel| &channel.residuals);
        // sums of squares and their numbers: of the rows of the fit, of others
        let mut sums = [(0.0, 0.0); 2];
        for (row, values) in rows {
            let sum = &mut sums[usize::from(!has(&own.channel, *row))];
            sum.0 += values.iter().map(|value| value * value).sum::<f64>();
            sum.1 += values.len() as f64;
        }
        let [(square, count), (others, further)] = sums;
        let rms = f64::sqrt(square / count);
        if own.is_missed_by(rms) {
            let [is, fit] = [rms, own.rms].map(|size| Shown::fine(&own.unit).text(size));
            misses.push(format!("{} is {is} in place of {fit}", own.channel));
        }
        let whole = (square + others) / (count + further);
        found.push((own.channel.clone(), whole.sqrt()));
    }
    match misses.is_empty() {
        true => Ok(found),
        false => Err(format!(
            "replayed on the log of its fit it does not leave what the fit leaves: {}",
            misses.join(", ")
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptical_model::Recording;

    const DEVICE: &str = "[[joint]]\nexternal_encoder_sd_rad = 1e-4\n";

    /// An encoder that reads 1 mrad more than its motor, and an offset in the file of as much as is given.
    fn replayed_with(
        offset_rad: f64,
        rms: f64,
        left_out: Option<usize>,
    ) -> Result<Vec<(String, f64)>, String> {
        let device = Device::from_toml(DEVICE, "one.toml").unwrap();
        let joint: Vec<f64> = (0..50).map(|row| 0.02 * f64::from(row)).collect();
        let output = joint.iter().enumerate().map(|(row, angle)| {
            let wild = if Some(row) == left_out { 0.3 } else { 0.0 };
            Some(angle + 1e-3 + wild)
        });
        let recording = Recording {
            line: (2..).take(50).collect(),
            output: vec![output.collect()],
            torque_nm: vec![None],
            joint: vec![joint],
            ..Recording::default()
        };
        let log = Log::from_recording(recording, "log.csv", &device).unwrap();
        let text = format!("{DEVICE}[joint.transmission_error]\noffset_rad = {offset_rad:?}\n");
        let left = [Left {
            channel: "out1".to_owned(),
            unit: "rad".to_owned(),
            rms,
            held_out: None,
            noise_floor: 1e-4,
        }];
        reproduced(&text, "file.toml", &log, &left, &|_, row| {
            Some(row) != left_out
        })
    }

    #[test]
    fn a_file_holds_its_fit_within_one_percent_of_a_channel() {
        for rms in [0.991e-3, 1e-3, 1.2e-3] {
            let found = replayed_with(0.0, rms, None).unwrap();
            assert!((found[0].1 / 1e-3 - 1.0).abs() < 1e-9, "{found:?}");
        }
        let why = replayed_with(0.0, 0.98e-3, None).unwrap_err();
        assert!(
            why.ends_with("out1 is 1.000 mrad in place of 0.9800 mrad"),
            "{why}"
        );
        let why = replayed_with(-1e-3, 1e-3, None).unwrap_err();
        assert!(
            why.contains("out1 is 2.000 mrad in place of 1.000 mrad"),
            "{why}"
        );
        // of a fit that leaves nothing the noise is the measure
        assert!(replayed_with(1e-3 + 5e-8, 0.0, None).is_ok());
        assert!(replayed_with(1e-3 + 5e-7, 0.0, None).is_err());
    }

    /// A reading that the fit left out does not decide, and counts in what the device leaves of the whole log: 49 times 1 mrad, and
    /// 301 mrad.
    #[test]
    fn a_reading_that_the_fit_left_out_is_the_files_prediction() {
        let found = replayed_with(0.0, 1e-3, Some(7)).unwrap();
        let whole = ((49.0 * 1e-6 + 0.301 * 0.301) / 50.0_f64).sqrt();
        assert!((found[0].1 / whole - 1.0).abs() < 1e-9, "{found:?} {whole}");
        assert!(replayed_with(-1e-3, 1e-3, Some(7)).is_err());
    }

    #[test]
    fn a_file_that_would_not_be_read_says_so() {
        let device = Device::from_toml(DEVICE, "one.toml").unwrap();
        let recording = Recording {
            line: vec![2],
            joint: vec![vec![0.0]],
            output: vec![Some(vec![0.0])],
            torque_nm: vec![None],
            ..Recording::default()
        };
        let log = Log::from_recording(recording, "log.csv", &device).unwrap();
        let text = format!("{DEVICE}[[effect]]\nname = \"backlash\"\njoint = 1\nwidth = 1e-3\n");
        let why = reproduced(&text, "file.toml", &log, &[], &|_, _| true).unwrap_err();
        assert!(why.starts_with("it would not be read again: "), "{why}");
        assert!(why.contains("`width_rad`"), "{why}");
    }

    #[test]
    fn comments_go_with_the_provenance() {
        let left = [Left {
            channel: "out1".to_owned(),
            unit: "rad".to_owned(),
            rms: 1.25e-4,
            held_out: Some(1.5e-4),
            noise_floor: 1e-4,
        }];
        let text = comments(&left, &["outliers: said of the readings".to_owned()]);
        let line = "fit of out1: rms_fit = 1.25e-4 rad (0.1250 mrad), on all its rows; held out";
        assert!(text.contains(line), "{text}");
        assert!(
            text.contains("held out, rms_after = 1.5e-4 rad (0.1500 mrad)"),
            "{text}"
        );
        assert!(text.contains("not in this file: outliers: said of the readings\n"));
        assert_eq!(crate::files::without_comments(&(text + DEVICE)), DEVICE);
    }
}
