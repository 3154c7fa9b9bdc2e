//! Whether a log may be answered (A310).

/// Share of what a channel varies by that the model, causes included, may miss. Choice: a device file's lengths are known to a few
/// percent, and readings of no relation to the joints are missed by all of it.
pub(crate) const MOST_MISSED: f64 = 0.2;
/// Least root mean square by which a channel varies to be asked \[rad or m\]: below it a wrong zero or play is a large part of it.
pub(crate) const LEAST_SPREAD: f64 = 0.01;
/// Least length of a motion whose torques are judged \[s\]: of 2 s of an elastic rope three causes had names.
pub(crate) const LEAST_MOTION_S: f64 = 5.0;
/// Readings that are needed for each fitted number.
pub(crate) const READINGS_PER_NUMBER: f64 = 3.0;
