//! Spectral lines of what a base model leaves.

use haptical_calibration::Channel;

use super::{Context, Stream};

/// Relative difference up to which two frequencies are those of one line.
const SAME_LINE: f64 = 0.02;

/// A disturbance of one frequency in a channel's readings, as it was found in them.
///
/// Its phase in each run is the recording's: nothing says that a disturbance and a clock start together.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Channel.
    pub channel: Channel,
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Phase in the middle of each run \[rad\].
    pub phase_rad: Vec<f64>,
}

impl Context<'_> {
    /// The streams of a channel, one for each axis.
    pub fn streams_of(&self, channel: Channel) -> impl Iterator<Item = usize> {
        let streams = self.streams.iter().enumerate();
        let own = streams.filter(move |(_, stream): &(usize, &Stream)| stream.channel == channel);
        own.map(|(index, _)| index)
    }

    /// Frequencies of the lines of a channel \[Hz\].
    pub fn lines_of(&self, channel: Channel) -> Vec<f64> {
        let own = self.lines.iter().filter(|line| line.channel == channel);
        own.map(|line| line.frequency_hz).collect()
    }

    /// Cosine and sine at a frequency, at every row, with the phases of the channel's line there; without one, of
    /// phase 0 in the middle of each run. Zero without times.
    pub fn oscillation(&self, channel: Channel, frequency_hz: f64) -> [Vec<f64>; 2] {
        let [mut cosines, mut sines] = [(); 2].map(|()| vec![0.0; self.rows()]);
        let Some(time_s) = &self.recording.time_s else {
            return [cosines, sines];
        };
        let near = |line: &&Line| {
            line.channel == channel && (line.frequency_hz / frequency_hz - 1.0).abs() < SAME_LINE
        };
        let distance = |line: &Line| (line.frequency_hz - frequency_hz).abs();
        let lines = self.lines.iter().filter(near);
        let line = lines.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        for (index, run) in self.runs.iter().enumerate() {
            let phase = line.and_then(|line| line.phase_rad.get(index));
            let phase = phase.copied().unwrap_or(0.0);
            let middle_s = 0.5 * (time_s[run.start] + time_s[run.end - 1]);
            for row in run.clone() {
                let turned = std::f64::consts::TAU * frequency_hz * (time_s[row] - middle_s);
                (sines[row], cosines[row]) = (turned + phase).sin_cos();
            }
        }
        [cosines, sines]
    }

    /// Time within runs \[s\]; 0 without times.
    pub fn moving_s(&self) -> f64 {
        let time_s = self.recording.time_s.as_deref();
        time_s.map_or(0.0, |time_s| {
            let moving = self.runs.iter().filter(|run| run.len() > 1);
            let length = |run: &std::ops::Range<usize>| time_s[run.end - 1] - time_s[run.start];
            moving.map(length).sum()
        })
    }

    /// The longest run \[s\]; 0 without times.
    pub fn longest_run_s(&self) -> f64 {
        let time_s = self.recording.time_s.as_deref();
        time_s.map_or(0.0, |time_s| {
            let length = |run: &std::ops::Range<usize>| time_s[run.end - 1] - time_s[run.start];
            self.runs.iter().map(length).fold(0.0, f64::max)
        })
    }
}
