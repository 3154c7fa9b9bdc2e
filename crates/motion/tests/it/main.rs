//! The library as a stranger uses it.

mod arm;
mod found;
