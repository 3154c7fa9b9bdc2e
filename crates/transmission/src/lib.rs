//! transmission
#![no_std]
