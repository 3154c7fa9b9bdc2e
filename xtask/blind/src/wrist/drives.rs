//! Cables that drive a wrist: what they lose at reversals and pull along, when all joints move at once.

use crate::laws::{SlipElement, maxwell_slip};
use crate::random::Random;

/// One cable loop: where it reverses it has to be taken up first.
#[derive(Debug, Clone)]
struct Cable {
    /// Half of what is lost at a reversal \[rad\].
    half_width_rad: f64,
    /// Slip elements of the take-up, weights of sum 1, widths relative to the half width.
    elements: Vec<SlipElement>,
    /// How much more is lost where the next joint is bent, per rad: the cable rubs in its bend.
    rubbing_per_rad: f64,
    /// How far it is taken up at first, relative.
    bias: f64,
}

/// What a wrist's cables do to its joints.
#[derive(Debug, Clone)]
pub(crate) struct Wrist {
    cables: Vec<Option<Cable>>,
    /// Turn of a joint per turn of another one's motor, `[joint][motor]`.
    coupling: Vec<Vec<f64>>,
    /// What of a cable's loss a joint shows, `[joint][cable]`: a wrist's cables run over the joints before theirs.
    shows: Vec<Vec<f64>>,
}

/// How strongly a wrist is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Size {
    /// A sound instrument: tenths of a degree to some degrees.
    Fair,
    /// A worn one: up to twenty degrees.
    Worn,
}

impl Size {
    /// Typical play \[rad\] and gain of a coupling.
    const fn typical(self) -> f64 {
        match self {
            Self::Fair => 0.03,
            Self::Worn => 0.15,
        }
    }
}

impl Wrist {
    /// A wrist without errors.
    pub(crate) fn ideal(joints: usize) -> Self {
        let unit = |row: usize| (0..joints).map(|k| f64::from(u8::from(k == row))).collect();
        Self {
            cables: vec![None; joints],
            coupling: vec![vec![0.0; joints]; joints],
            shows: (0..joints).map(unit).collect(),
        }
    }

    /// With play in all cables of the joints from `first` on.
    pub(crate) fn with_play(mut self, first: usize, size: Size, random: &mut Random) -> Self {
        for cable in &mut self.cables[first..] {
            let spread = random.uniform(1.2, 2.2);
            let weights = [(); 3].map(|()| random.uniform(0.5, 1.5));
            *cable = Some(Cable {
                half_width_rad: 0.5 * random.around(size.typical(), 4.0),
                elements: SlipElement::three(weights, spread),
                rubbing_per_rad: random.uniform(0.0, 0.25),
                bias: random.uniform(-0.3, 0.3),
            });
        }
        self
    }

    /// With cables that run over the joint before theirs: what one of them loses turns the other joint too.
    pub(crate) fn with_shared_cables(mut self, first: usize, random: &mut Random) -> Self {
        for cable in first + 1..self.cables.len() {
            self.shows[cable - 1][cable] = random.sign() * random.uniform(0.4, 1.0);
            if random.unit() < 0.5 {
                self.shows[cable][cable - 1] = random.sign() * random.uniform(0.3, 0.6);
            }
        }
        self
    }

    /// With joints that turn others through their cables' ways.
    pub(crate) fn with_coupling(mut self, first: usize, size: Size, random: &mut Random) -> Self {
        let joints = self.cables.len();
        for joint in first..joints {
            for motor in first..joints {
                let is_next = joint.abs_diff(motor) == 1;
                if joint != motor && (is_next || random.unit() < 0.3) {
                    self.coupling[joint][motor] =
                        random.sign() * random.around(size.typical(), 3.0);
                }
            }
        }
        self
    }

    /// Angles of the joints \[rad\] for the motors' \[rad\]; `runs` holds the first row of each run and the number of rows.
    pub(crate) fn joints_rad(&self, motor_rad: &[Vec<f64>], runs: &[usize]) -> Vec<Vec<f64>> {
        let joints = motor_rad.len();
        let lost: Vec<Option<Vec<f64>>> = (0..joints)
            .map(|cable| self.lost_rad(cable, motor_rad, runs))
            .collect();
        let rows = motor_rad.first().map_or(0, Vec::len);
        let at = |joint: usize, row: usize| -> f64 {
            let mut angle = motor_rad[joint][row];
            for other in 0..joints {
                angle += self.coupling[joint][other] * motor_rad[other][row];
                if let Some(lost) = &lost[other] {
                    angle -= self.shows[joint][other] * lost[row];
                }
            }
            angle
        };
        (0..joints)
            .map(|joint| (0..rows).map(|row| at(joint, row)).collect())
            .collect()
    }

    /// What a cable takes up, from run to run.
    fn lost_rad(&self, cable: usize, motor_rad: &[Vec<f64>], runs: &[usize]) -> Option<Vec<f64>> {
        let found = self.cables[cable].as_ref()?;
        let half_rad = found.half_width_rad;
        let widths = SlipElement::widened(&found.elements, half_rad);
        let bend = motor_rad
            .get(cable + 1)
            .or(motor_rad.get(cable.wrapping_sub(1)));
        let mut lost = Vec::new();
        for ends in runs.windows(2) {
            let rows = &motor_rad[cable][ends[0]..ends[1]];
            // a run begins as the one before it ended: somewhere in the play
            let mut input = vec![rows.first().copied().unwrap_or(0.0) - found.bias * half_rad];
            input.extend_from_slice(rows);
            let taken_up = maxwell_slip(&input, &widths);
            for (value, row) in taken_up.into_iter().skip(1).zip(ends[0]..) {
                let bent = bend.map_or(0.0, |bend| bend[row].abs());
                lost.push(value * half_rad * (1.0 + found.rubbing_per_rad * bent));
            }
        }
        Some(lost)
    }

    /// The joint whose cable loses most.
    pub(crate) fn widest(&self) -> Option<usize> {
        let widest = self.widths_rad().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(widest.0)
    }

    /// Total plays \[rad\], joint by joint.
    pub(crate) fn widths_rad(&self) -> impl Iterator<Item = (usize, f64)> {
        let cables = self.cables.iter().enumerate();
        cables.filter_map(|(joint, cable)| Some((joint, 2.0 * cable.as_ref()?.half_width_rad)))
    }
}
