//! identification
