//! Tests of plans on devices whose answers are known otherwise.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on fails there"
)]

mod candidates;
mod identifiability;
mod plan;
mod refusals;
mod selection;
mod support;
mod task;
mod touches;
