//! kinematics
#![no_std]
