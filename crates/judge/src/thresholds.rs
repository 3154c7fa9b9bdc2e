//! Numbers that decide.

/// A first cause of this probability is named; one of less is ambiguous. Choice.
pub const NAMED_PROBABILITY: f64 = 0.8;
/// Rivals that are ahead by more than this count as if by this \[nats\]: a sum of exponentials stays finite.
pub(crate) const MOST_AHEAD_NATS: f64 = 50.0;
