//! Tests of xtask-blind.

mod besides;
mod dynamics;
mod effects;
mod files;
mod geometry;
mod measured;
mod motion;
mod noise;
mod score;
mod seal;
mod suites;
