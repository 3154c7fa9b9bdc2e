//! Layout of whitened streams, one after the other in a vector.

use std::ops::Range;

/// Where the entries of streams are in a vector over all of them.
pub(crate) trait Layout {
    /// Squared share of a direction that must survive a projection to count.
    const SURVIVING: f64;

    /// Entries of all streams.
    fn count(&self) -> usize;

    /// Entries of a stream.
    fn range(&self, stream: usize) -> Range<usize>;
}
