//! Single effects: what is tried, and the largest sizes.

// `effect`
/// Square of a column, over that of the effect's largest, that is rounding.
pub(crate) const UNFELT: f64 = 1e-18;
/// How far the size of a friction is known beyond which of its many laws it follows.
pub(crate) const FRICTION_LAW_SD: f64 = 0.05;
/// The same of cogging: magnets and slots are no sines.
pub(crate) const COGGING_LAW_SD: f64 = 0.02;
/// The same of a weight or a torque's scale: it is measured by bodies that are off themselves.
pub(crate) const BODIES_LAW_SD: f64 = 0.5 * super::plausible::MASS;
/// Mass that may be missing from the body that carries a payload, over the mass of that body by the file: some files are a little light.
pub(crate) const MOST_MISSING: f64 = 1.2;
/// The same of a link's mass: what it has more of need not be at its centre.
pub(crate) const LINK_LAW_SD: f64 = 0.3;
/// The same of a push, whose point is not known.
pub(crate) const PUSH_LAW_SD: f64 = 0.1;

// `effect::link_inertia`
/// Most that a mass is too small, as a share of it.
pub(crate) const MOST_MISSING_MASS: f64 = 5.0;
/// Most that a centre of mass is off, and as a share of the length of a rod with the link's inertia: from one end of it to the other.
/// Beyond it is no longer this link's (assumption A200).
pub(crate) const MOST_CENTRE_M: f64 = 0.5;
pub(crate) const MOST_OF_ROD: f64 = 1.0;

// `effect::torque_gain`
/// Most of a reading that is too much; a torque that is not there at all, or of the wrong sign, is no scale of it.
pub(crate) const MOST_GAIN: f64 = 0.95;

// `effect::joint_offset`
/// Largest angle, or travel, that is a zero of the same joint \[rad\] or \[m\].
pub(crate) const MOST_OFFSET_RAD: f64 = 0.5;

// `effect::cross_coupling`
/// A drive loads a joint by less than its own torque.
pub(crate) const MOST_COUPLING: f64 = 1.0;

// `effect::gravity_spring`
/// Travel from which on a sine is not taken for a constant.
pub(crate) const LEAST_TRAVEL_RAD: f64 = 1.0;

// `effect::motor_cogging`
/// Repetitions in a turn of the joint that are tried at most, and in 2 pi metres of a slide: two in a turn of a screw of 5 mm.
pub(crate) const HIGHEST_ORDER: f64 = 400.0;
pub(crate) const HIGHEST_OF_SLIDE: f64 = 2500.0;
/// And at least in what the joint turns: what repeats less often may be a weight or a spring.
pub(crate) const LEAST_PERIODS: f64 = 3.0;
/// Best of a scan that are fitted with the base model.
pub(crate) const COGGING_KEPT: usize = 2;
/// Most orders of a scan.
pub(crate) const MOST_ORDERS: usize = 1500;

// `effect::friction::load`
/// Most of its load that a drive's friction is.
pub(crate) const MOST_OF_LOAD: f64 = 0.8;

// `effect::friction::presliding`
/// Travels that are tried, as the joint's at its fastest in so many seconds.
pub(crate) const PRESLIDING_S: [f64; 5] = [0.001, 0.003, 0.008, 0.02, 0.05];
/// The shortest: what is shorter is part of the base model.
pub(crate) const SHORTEST_PRESLIDING_S: f64 = 5e-4;

// `effect::friction::stribeck`
/// Speeds at which the higher friction has fallen to 1/e that are tried, as shares of the joint's fastest.
pub(crate) const STRIBECK_SPEEDS: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.35];
/// Lowest such speed, in turnovers of the base model's friction: what is slower is how that turns over.
pub(crate) const STRIBECK_TURNOVERS: f64 = 3.0;

// `effect::contact`
/// Rows between the nodes of the force's course, of few and of many.
pub(crate) const CONTACT_NODE_ROWS: [f64; 2] = [2.0, 1.0];
/// Torques that many nodes ask for at least: three components a row are all that three torques are.
pub(crate) const TORQUES_OF_MANY: usize = 5;
/// Most nodes: a longer contact has them further apart. A slow course needs few, and one that begins at once many.
pub(crate) const MOST_CONTACT_NODES: [usize; 2] = [60, 120];
/// A force at the flange is felt by several joints: the second most has this share of the squares of the most, at least.
pub(crate) const FELT_BY_TWO: f64 = 0.03;
/// A surface pushes in one direction: the mean force over the mean of its size, at least.
pub(crate) const ONE_WAY: f64 = 0.5;
/// Farthest that what touches is from the flange \[m\]: a tool is longer than a hand, and shorter than a link.
pub(crate) const FARTHEST_M: f64 = 0.4;

// `effect::torque_saturation`
/// Shares of the largest torque at which it may set in.
pub(crate) const SATURATION_LIMITS: [f64; 12] = [
    0.95, 0.85, 0.75, 0.65, 0.55, 0.47, 0.4, 0.34, 0.28, 0.22, 0.16, 0.1,
];
/// Longest share of the log that it may last.
pub(crate) const LONGEST_SATURATION: f64 = 0.4;
/// Least share of samples that stand at the end of what is read.
pub(crate) const LEAST_FLAT: f64 = 0.003;
/// How far about the end they are, and how far above it there are none to speak of, in standard deviations of a reading.
pub(crate) const END_SDS: f64 = 3.0;
pub(crate) const ABOVE_SDS: f64 = 5.0;
/// Most readings above, per reading at the end: noise has tails.
pub(crate) const MOST_ABOVE: f64 = 0.02;
/// How much denser readings are there than below.
pub(crate) const DENSER_AT_END: f64 = 3.0;
/// A smoothed reading that is this near to the end, in standard deviations of one, holds readings that ended.
pub(crate) const NEAR_END_SDS: f64 = 2.0;
/// Least of what is missing that is missing on the right side, over what is on the wrong one.
pub(crate) const RIGHT_SIDE: f64 = 1.5;
/// Most nodes of what is missing.
pub(crate) const MOST_MISSING_NODES: usize = 120;
/// How far the share of the excess that is lost may be from all of it.
pub(crate) const NEAR_ALL: f64 = 0.15;
