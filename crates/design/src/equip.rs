//! A device with the sensors of a rig, and what a calibration from them could free.

use haptical_calibration::{Channel, candidate_parameters};
use haptical_model::{
    Cable, Device, Joint, ParameterId, Tracker, TransmissionError, TransmissionKind,
};

use crate::{DesignError, Measure, Rig, Tracking};

/// Terms of equation (1) that a joint without drums can have: offset, ratio, output eccentricity.
const TERMS_WITHOUT_DRUMS: usize = 4;

/// A device with the sensors of a rig.
#[derive(Debug, Clone)]
pub struct Equipped {
    /// The rig.
    pub rig: Rig,
    /// The device, its sensors those of the rig.
    pub device: Device,
    /// What is measured.
    pub channels: Vec<Channel>,
    /// What a calibration could free.
    pub parameters: Vec<ParameterId>,
    terms: Terms,
}

/// What of the transmissions is to be planned for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Terms {
    /// Nothing: they are known, as in the second step of a two-step calibration.
    Known,
    /// Equation (1) of capstans, and of other joints what their external encoder shows; parallelograms as a
    /// polynomial of this degree.
    Degree(usize),
}

/// Degree of a parallelogram's polynomial. The same encoder identifies higher ones.
pub const DEGREE: usize = 4;

/// Puts the sensors of a rig around a device.
///
/// ```
/// use haptical_design::{Rig, Terms, equip};
/// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/devices/haptic7.toml");
/// let device = haptical_model::Device::load(path.as_ref())?.device;
/// let equipped = equip(&device, &Rig::parse("cable,cable2:0.4,0,0.3")?, Terms::Known)?;
/// assert_eq!(equipped.device.cables.len(), 2);
/// assert_eq!(equipped.channels.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DesignError::Measure`] for a joint that the device does not have, a chain that it does not have, or a
/// cable that is neither in the file nor given a place.
pub fn equip(device: &Device, rig: &Rig, terms: Terms) -> Result<Equipped, DesignError> {
    let mut equipped = Equipped {
        rig: rig.clone(),
        device: device.clone(),
        channels: Vec::new(),
        parameters: Vec::new(),
        terms,
    };
    // one tracker place and one hand are planned for; each further run or tool adds its own numbers
    equipped.device.surroundings.run_bases.clear();
    equipped.device.surroundings.tools.clear();
    let mut measures: Vec<&Measure> = rig.measures.iter().collect();
    // cables in the order of their numbers, so that the second finds the first
    measures.sort_by_key(|measure| match measure {
        Measure::Cable { index, .. } => *index,
        _ => 0,
    });
    for measure in measures {
        equipped.add(measure)?;
    }
    equipped.channels.sort_unstable();
    equipped.channels.dedup();
    equipped.name_parameters();
    Ok(equipped)
}

impl Equipped {
    /// Whether anything that it measures depends on the chain.
    pub fn sees_chain(&self) -> bool {
        self.channels.iter().any(|channel| channel.sees_chain())
    }

    pub(crate) fn refuse(&self, message: impl Into<String>) -> DesignError {
        DesignError::Measure {
            item: self.rig.name.clone(),
            message: message.into(),
        }
    }

    fn add(&mut self, measure: &Measure) -> Result<(), DesignError> {
        let joints = self.device.joints.len();
        let is_output = matches!(measure, Measure::Outputs | Measure::Output { .. });
        if !is_output && !self.device.has_links() {
            return Err(
                self.refuse("the device file has no [[link]], so that only out can be seen")
            );
        }
        match *measure {
            Measure::Outputs => {
                let described = self.device.joints.iter().enumerate();
                let described = described.filter(|(_, joint)| joint.output_sd_rad().is_some());
                let described: Vec<usize> = described.map(|(joint, _)| joint).collect();
                if described.is_empty() {
                    let what = "no joint has an external encoder: name them, as out1,out2";
                    return Err(self.refuse(what));
                }
                for joint in described {
                    self.channels.push(Channel::Output { joint });
                }
            }
            Measure::Output { joint } if joint < joints => {
                let known = self.device.joints.iter().find_map(Joint::output_sd_rad);
                let own = &mut self.device.joints[joint];
                if own.output_sd_rad().is_none() {
                    own.external_encoder_sd_rad = known;
                }
                self.channels.push(Channel::Output { joint });
            }
            Measure::Cable {
                index,
                anchor_m,
                unknown,
            } => self.add_cable(index, anchor_m, unknown)?,
            Measure::Tracker(Tracking {
                orientation,
                base_known,
                tool_known,
            }) => {
                let stated = self.device.tracker;
                self.device.tracker = Some(Tracker {
                    base_known,
                    base_per_run: false,
                    tool_known,
                    scale_sd: stated.and_then(|tracker| tracker.scale_sd),
                    position_sd_m: stated.and_then(|tracker| tracker.position_sd_m),
                    rotation_sd_rad: stated.and_then(|tracker| tracker.rotation_sd_rad),
                });
                self.channels.push(Channel::Position);
                if orientation {
                    self.channels.push(Channel::Orientation);
                }
                self.place_tracker(base_known, tool_known);
            }
            Measure::Fixture { joint: Some(joint) } | Measure::Output { joint }
                if joint >= joints =>
            {
                let what = format!("there is no joint {}: the device has {joints}", joint + 1);
                return Err(self.refuse(what));
            }
            Measure::Fixture { joint } => {
                let one = |joint| Channel::Fixture { joint };
                match joint {
                    Some(joint) => self.channels.push(one(joint)),
                    None => self.channels.extend((0..joints).map(one)),
                }
            }
            Measure::Contact { distance_m, .. } => {
                self.channels.push(Channel::Contact);
                if distance_m.is_some() {
                    self.channels.push(Channel::ContactPair { index: 0 });
                }
            }
            Measure::Plane { planes } => {
                self.channels.push(Channel::Plane);
                if planes > 1 {
                    self.channels.push(Channel::PlanePair { index: 0 });
                }
            }
            Measure::Output { .. } => {}
        }
        Ok(())
    }

    fn add_cable(
        &mut self,
        index: usize,
        anchor_m: Option<[f64; 3]>,
        unknown: bool,
    ) -> Result<(), DesignError> {
        let number = index + 1;
        if index > self.device.cables.len() {
            let what = format!("cable{number} without cable{index}: number them without a gap");
            return Err(self.refuse(what));
        }
        if index == self.device.cables.len() {
            if anchor_m.is_none() && index > 0 {
                let what = "the device file does not have it: give its place";
                return Err(self.refuse(format!("cable{number}: {what}, cable{number}:x,y,z")));
            }
            // as good as the first one
            let first = self.device.cables.first();
            self.device.cables.push(Cable {
                anchor_m: [0.0; 3],
                ..first.copied().unwrap_or_default()
            });
        }
        let cable = &mut self.device.cables[index];
        if let Some(anchor_m) = anchor_m {
            cable.anchor_m = anchor_m;
        }
        if unknown {
            cable.fit.zero = true;
            // frame (-1) is where the first cable leaves its guide
            cable.fit.anchor = index > 0;
        }
        self.channels.push(Channel::Cable { index });
        Ok(())
    }

    fn place_tracker(&mut self, base_known: bool, tool_known: bool) {
        use haptical_model::{Origin, Placement};
        let places = &mut self.device.surroundings;
        if base_known {
            places.tracker_base = None;
        } else if places.tracker_base.is_none() {
            places.tracker_base = Some(Placement::default());
        }
        if tool_known {
            places.tracker_tool = None;
        } else if places.tracker_tool.is_none() {
            // a marker off the handle, not on it: what is found must not hang on a coincidence
            let position_m = [0.03, 0.02, 0.05];
            let start = Origin {
                position_m,
                ..Origin::IDENTITY
            };
            places.tracker_tool = Some(Placement {
                start,
                ..Placement::default()
            });
        }
    }

    /// Names what a calibration could free: again where the device got further numbers.
    pub(crate) fn name_parameters(&mut self) {
        let sees_chain = self.sees_chain();
        self.parameters = if sees_chain {
            candidate_parameters(&self.device)
        } else {
            Vec::new()
        };
        let Terms::Degree(degree) = self.terms else {
            return;
        };
        for joint in 0..self.device.joints.len() {
            let has_output = self.channels.contains(&Channel::Output { joint });
            let described = &mut self.device.joints[joint];
            let kind = described.transmission;
            if !has_output && (kind != TransmissionKind::Capstan || !sees_chain) {
                continue;
            }
            let has_no_error = described.transmission_error == TransmissionError::default();
            if kind == TransmissionKind::Parallelogram && has_no_error {
                described.transmission_error = TransmissionError::Chebyshev {
                    range_rad: [described.lower_rad, described.upper_rad],
                    coefficients: vec![0.0; degree + 1],
                };
            }
            let is_equation = matches!(described.transmission_error, TransmissionError::Capstan(_));
            let has_drums = described.drum_distance_m.is_some();
            let all = self.device.transmission_parameters(joint);
            let count = match is_equation && !has_drums {
                true => TERMS_WITHOUT_DRUMS,
                false => all.len(),
            };
            self.parameters.extend(all.into_iter().take(count));
        }
    }
}
