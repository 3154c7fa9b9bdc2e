//! Spectral lines of residuals, faster than the device moves: no noise of one stays at one frequency
//! (docs/diagnosis.md, "Spectral lines").

use std::borrow::Cow;
use std::f64::consts::{LN_2, TAU};
use std::ops::Range;

use haptical_calibration::Channel;
use haptical_effects::{Context, Line};
use haptical_metrics::median;

use super::rounding::Counts;
use super::spectrum::Spectrum;
use crate::thresholds::lines::{
    COHERENT, ENOUGH_SPECTRA, FAR, FASTER_THAN_MOTION, FINENESS, LINE_P, MOST_LINES, NEAR_BINS,
    ROUGH_LEVEL, SLOW_BINS, TOUCHED_BINS,
};

/// The lines of every channel, strongest first.
pub(crate) fn lines(context: &Context<'_>, residual: &[Vec<f64>]) -> Vec<Line> {
    let Some(time_s) = context
        .recording
        .time_s
        .as_ref()
        .filter(|_| context.ordered)
    else {
        return Vec::new();
    };
    let slowest_hz = FASTER_THAN_MOTION * motion_hz(context, time_s);
    let streams: Vec<Vec<Series>> =
        haptical_parallel::map(residual, |values| series(values, time_s, &context.runs));
    let peaks: Vec<Vec<Peak>> =
        haptical_parallel::map(&streams, |runs| peaks(runs, slowest_hz, residual.len()));
    let mut channels: Vec<Channel> = context.streams.iter().map(|s| s.channel).collect();
    channels.dedup();
    let of_channel = |channel: Channel| {
        let axes: Vec<usize> = context.streams_of(channel).collect();
        let own: Vec<&[Series]> = axes.iter().map(|axis| streams[*axis].as_slice()).collect();
        let beyond_rounding = |axis: &usize| {
            let saw = saw(context, *axis);
            peaks[*axis]
                .iter()
                .filter(move |peak| peak.amplitude > saw)
                .cloned()
        };
        let mut found: Vec<Peak> = axes.iter().flat_map(beyond_rounding).collect();
        found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        let mut kept: Vec<Peak> = Vec::new();
        for peak in found {
            let is_other = |k: &Peak| (k.hz - peak.hz).abs() > TOUCHED_BINS as f64 * peak.bin_hz;
            if kept.iter().all(is_other) && kept.len() < MOST_LINES {
                kept.push(peak);
            }
        }
        let lines = kept.iter().filter_map(|peak| refined(channel, &own, peak));
        lines.collect::<Vec<Line>>()
    };
    channels.into_iter().flat_map(of_channel).collect()
}

/// Amplitude up to which an oscillation of a stream may be rounding.
fn saw(context: &Context<'_>, stream: usize) -> f64 {
    let counts = Counts::new(context, &context.streams[stream]);
    counts.map_or(0.0, |counts| counts.saw())
}

/// A stream's values without its channel's lines, each as large as they are in each run.
pub(crate) fn without_lines<'v>(
    context: &Context<'_>,
    stream: usize,
    values: &'v [f64],
) -> Cow<'v, [f64]> {
    let channel = context.streams[stream].channel;
    let mut values = Cow::Borrowed(values);
    let Some(time_s) = &context.recording.time_s else {
        return values;
    };
    for line in context.lines.iter().filter(|line| line.channel == channel) {
        let runs = series(&values, time_s, &context.runs);
        for (run, rows) in runs.iter().zip(&context.runs) {
            let [re, im] = run.amplitude(line.frequency_hz);
            for row in rows.clone() {
                let turned = TAU * line.frequency_hz * (time_s[row] - run.middle_s);
                let (sin, cos) = turned.sin_cos();
                values.to_mut()[row] -= re * cos - im * sin;
            }
        }
    }
    values
}

/// Readings of one stream in one run.
struct Series {
    middle_s: f64,
    time_s: Vec<f64>,
    value: Vec<f64>,
    window: Vec<f64>,
}

fn series(values: &[f64], time_s: &[f64], runs: &[Range<usize>]) -> Vec<Series> {
    let sizes: Vec<f64> = values
        .iter()
        .filter(|v| v.is_finite())
        .map(|v| v.abs())
        .collect();
    let far = FAR * median(&sizes).unwrap_or(0.0);
    let of_run = |run: &Range<usize>| {
        let (start_s, end_s) = (time_s[run.start], time_s[run.end - 1]);
        let known: Vec<usize> = run.clone().filter(|&row| values[row].is_finite()).collect();
        let share = |row: usize| (time_s[row] - start_s) / (end_s - start_s).max(1e-300);
        let window = |row: usize| 0.5 - 0.5 * (TAU * share(row)).cos();
        Series {
            middle_s: 0.5 * (start_s + end_s),
            time_s: known.iter().map(|&row| time_s[row]).collect(),
            value: known
                .iter()
                .map(|&row| values[row].clamp(-far, far))
                .collect(),
            window: known.iter().map(|&row| window(row)).collect(),
        }
    };
    runs.iter().map(of_run).collect()
}

impl Series {
    /// Complex amplitude of an oscillation, its phase that in the middle of the run.
    fn amplitude(&self, hz: f64) -> [f64; 2] {
        let weight: f64 = self.window.iter().sum();
        if weight <= 0.0 {
            return [0.0; 2];
        }
        let values = self.value.iter().zip(&self.window);
        let mean = values.map(|(value, window)| value * window).sum::<f64>() / weight;
        let (mut re, mut im) = (0.0, 0.0);
        let rows = self.time_s.iter().zip(&self.value).zip(&self.window);
        for ((time_s, value), window) in rows {
            let (sin, cos) = (TAU * hz * (time_s - self.middle_s)).sin_cos();
            let windowed = window * (value - mean);
            re += windowed * cos;
            im -= windowed * sin;
        }
        [2.0 * re / weight, 2.0 * im / weight]
    }

    fn length_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }
}

/// Frequency of the fastest joint's motion: that of a wave of the same speed and the same range (root mean squares).
fn motion_hz(context: &Context<'_>, time_s: &[f64]) -> f64 {
    let of_joint = |column: &Vec<f64>| {
        let (mut speed, mut range, mut count) = (0.0, 0.0, 0.0);
        for run in &context.runs {
            let rows = &column[run.clone()];
            let mean = rows.iter().sum::<f64>() / rows.len().max(1) as f64;
            range += rows.iter().map(|q| (q - mean).powi(2)).sum::<f64>();
            for row in run.start + 1..run.end {
                let step_s = (time_s[row] - time_s[row - 1]).max(1e-300);
                speed += ((column[row] - column[row - 1]) / step_s).powi(2);
                count += 1.0;
            }
        }
        let range = range / context.rows().max(1) as f64;
        match range > 0.0 && count > 0.0 {
            true => (speed / count / range).sqrt() / TAU,
            false => 0.0,
        }
    };
    context
        .recording
        .joint
        .iter()
        .map(of_joint)
        .fold(0.0, f64::max)
}

#[derive(Debug, Clone)]
pub(crate) struct Peak {
    pub(crate) hz: f64,
    bin_hz: f64,
    pub(crate) amplitude: f64,
    /// Probability that noise has as high a peak anywhere.
    pub(crate) p_value: f64,
}

/// The peak of a stream's residuals that is least likely in noise of any smooth spectrum, however slow, and whether or not
/// one oscillation holds it, of those that are more than rounding; none without times, or of a few rows.
pub(crate) fn surest_peak(context: &Context<'_>, stream: usize, values: &[f64]) -> Option<Peak> {
    let time_s = context.recording.time_s.as_ref();
    let time_s = time_s.filter(|_| context.ordered)?;
    let runs = series(values, time_s, &context.runs);
    surest(&spectrum(&runs)?, saw(context, stream))
}

fn surest(spectrum: &Spectrum, least_amplitude: f64) -> Option<Peak> {
    if spectrum.segments < ENOUGH_SPECTRA {
        return None;
    }
    let peaks = (SLOW_BINS..spectrum.power.len()).filter_map(|bin| peak(spectrum, bin));
    peaks
        .filter(|peak| peak.amplitude >= least_amplitude)
        .map(|peak| Peak {
            p_value: (ROUGH_LEVEL * spectrum.power.len() as f64 * peak.p_value).min(1.0),
            ..peak
        })
        .min_by(|a, b| a.p_value.total_cmp(&b.p_value))
}

fn peaks(runs: &[Series], slowest_hz: f64, streams: usize) -> Vec<Peak> {
    let Some(spectrum) = spectrum(runs) else {
        return Vec::new();
    };
    let bins = spectrum.power.len();
    let first = SLOW_BINS.max((slowest_hz / spectrum.bin_hz).ceil() as usize);
    let tries = (bins * streams) as f64;
    (first..bins)
        .filter_map(|bin| peak(&spectrum, bin))
        .filter(|peak| tries * peak.p_value < LINE_P)
        .collect()
}

fn spectrum(runs: &[Series]) -> Option<Spectrum> {
    let runs: Vec<(Vec<f64>, Vec<f64>)> = runs
        .iter()
        .map(|run| (run.time_s.clone(), run.value.clone()))
        .collect();
    Spectrum::new(&runs)
}

/// A peak at a bin with its probability there; none where a neighbour is higher.
fn peak(spectrum: &Spectrum, bin: usize) -> Option<Peak> {
    let power = &spectrum.power;
    let around = bin - TOUCHED_BINS..(bin + TOUCHED_BINS + 1).min(power.len());
    let is_highest = power[around].iter().all(|other| *other <= power[bin]);
    let level = level(power, bin).filter(|level| *level > 0.0 && is_highest)?;
    Some(Peak {
        hz: bin as f64 * spectrum.bin_hz,
        bin_hz: spectrum.bin_hz,
        amplitude: ((power[bin] - level) / spectrum.of_unit).max(0.0).sqrt(),
        p_value: chance(power[bin] / level, spectrum.segments),
    })
}

/// Mean power of the noise at a bin, by the louder of its two sides: a spectrum falls or rises smoothly.
fn level(power: &[f64], bin: usize) -> Option<f64> {
    let touched = TOUCHED_BINS + 1;
    let below = &power[bin.saturating_sub(NEAR_BINS).max(1)..bin + 1 - touched];
    let above = &power[(bin + touched).min(power.len())..(bin + NEAR_BINS + 1).min(power.len())];
    let sides = [below, above].into_iter();
    let sides = sides.filter(|side| side.len() >= touched);
    let medians = sides.filter_map(|side| median(side).ok());
    medians.reduce(f64::max).map(|median| median / LN_2)
}

/// Probability that the lower median of `count` powers of noise of mean 1 exceeds `power`.
fn chance(power: f64, count: usize) -> f64 {
    // of exponential deviates at least as many as are not below the median
    let (one, other) = ((-power).exp(), 1.0 - (-power).exp());
    let least = count - (count - 1) / 2;
    let mut ways = 1.0;
    let mut sum = 0.0;
    for k in 0..=count {
        if k >= least {
            sum += ways * one.powi(k as i32) * other.powi((count - k) as i32);
        }
        ways *= (count - k) as f64 / (k + 1) as f64;
    }
    sum
}

/// The line at a peak: its frequency by the runs' length, its phase in each run. None where no single oscillation
/// holds the peak's power.
fn refined(channel: Channel, axes: &[&[Series]], peak: &Peak) -> Option<Line> {
    let square = |[re, im]: [f64; 2]| re * re + im * im;
    let readings: f64 = axes
        .iter()
        .flat_map(|runs| runs.iter())
        .map(|run| run.value.len() as f64)
        .sum();
    let runs = || axes.iter().flat_map(|runs| runs.iter());
    let energy = |hz: f64| -> f64 {
        runs()
            .map(|run| run.value.len() as f64 * square(run.amplitude(hz)))
            .sum()
    };
    let longest_s = runs().map(Series::length_s).fold(0.0, f64::max);
    let step_hz = 1.0 / (FINENESS * longest_s.max(1.0 / peak.bin_hz));
    let steps = (peak.bin_hz / step_hz).ceil() as i32;
    let tried: Vec<(f64, f64)> = haptical_parallel::map(-steps..=steps, |step| {
        let hz = peak.hz + f64::from(step) * step_hz;
        (hz, energy(hz))
    });
    let (hz, most) = tried
        .into_iter()
        .reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let [below, above] = [hz - step_hz, hz + step_hz].map(energy);
    let curvature = 2.0 * most - below - above;
    let shift = if curvature > 0.0 {
        0.5 * (above - below) / curvature
    } else {
        0.0
    };
    let hz = hz + step_hz * shift.clamp(-1.0, 1.0);
    // by the mean square of all axes
    let amplitude = (energy(hz) / readings.max(1.0) * axes.len() as f64).sqrt();
    if amplitude < COHERENT.sqrt() * peak.amplitude {
        return None;
    }
    let amplitudes: Vec<Vec<[f64; 2]>> = axes
        .iter()
        .map(|runs| runs.iter().map(|run| run.amplitude(hz)).collect())
        .collect();
    Some(Line {
        channel,
        frequency_hz: hz,
        phase_rad: phases(&amplitudes),
    })
}

/// The phase of each run, by all axes, such that the axis that shows most has phase 0 in the run that shows most.
fn phases(amplitudes: &[Vec<[f64; 2]>]) -> Vec<f64> {
    let square = |[re, im]: [f64; 2]| re * re + im * im;
    let runs = amplitudes.first().map_or(0, Vec::len);
    let of_run = |run: usize| amplitudes.iter().map(|axis| square(axis[run])).sum::<f64>();
    let loudest = (0..runs)
        .max_by(|a, b| of_run(*a).total_cmp(&of_run(*b)))
        .unwrap_or(0);
    let by_size =
        |a: &&Vec<[f64; 2]>, b: &&Vec<[f64; 2]>| square(a[loudest]).total_cmp(&square(b[loudest]));
    let main = amplitudes.iter().max_by(by_size);
    let start = main.map_or(0.0, |axis| axis[loudest][1].atan2(axis[loudest][0]));
    let turned = |run: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for axis in amplitudes {
            let ([a, b], [c, d]) = (axis[run], axis[loudest]);
            re += a * c + b * d;
            im += b * c - a * d;
        }
        start + im.atan2(re)
    };
    (0..runs).map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normal deviates by the sum of twelve uniforms, coloured.
    fn coloured(count: usize, colour: f64, seed: u64) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut value = 0.0;
        let mut next = || {
            let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
            value = colour * value + (1.0 - colour * colour).sqrt() * normal;
            value
        };
        (0..200).for_each(|_| {
            next();
        });
        (0..count).map(|_| next()).collect()
    }

    fn surest_of(values: Vec<f64>) -> Option<Peak> {
        let time_s = (0..values.len()).map(|row| 0.01 * row as f64).collect();
        surest(&Spectrum::new(&[(time_s, values)])?, 0.0)
    }

    /// Control of false alarms: of noise alone one in a hundred streams may have a probability below one in a hundred.
    #[test]
    fn noise_of_a_smooth_spectrum_has_no_sure_peak() {
        for (rows, colour) in [
            (300, 0.0),
            (300, 0.9),
            (2400, 0.0),
            (2400, 0.5),
            (2400, 0.95),
        ] {
            let p =
                (0..400).filter_map(|seed| Some(surest_of(coloured(rows, colour, seed))?.p_value));
            let p: Vec<f64> = p.collect();
            let below = |limit: f64| p.iter().filter(|p| **p < limit).count();
            eprintln!(
                "{rows} {colour}: {} {} {} of {}",
                below(1e-3),
                below(1e-2),
                below(0.05),
                p.len()
            );
            // binomial: 400 at 0.01 exceed 12 once in 1000
            assert!(
                below(0.01) <= 12,
                "{rows} rows, colour {colour}: {} of {}",
                below(0.01),
                p.len()
            );
        }
    }

    /// A line whose phase wanders is no single oscillation, and no noise.
    #[test]
    fn a_line_of_wandering_phase_is_a_sure_peak() {
        let noise = coloured(2400, 0.0, 5);
        let wander = coloured(2400, 0.999, 6);
        let value = |row: usize| {
            let phase = TAU * 12.5 * 0.01 * row as f64 + wander[row];
            noise[row] + 0.8 * phase.cos()
        };
        let peak = surest_of((0..2400).map(value).collect()).unwrap();
        assert!(
            (peak.hz - 12.5).abs() < 0.5 && peak.p_value < 1e-4,
            "{peak:?}"
        );
    }
}
