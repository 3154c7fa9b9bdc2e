//! Which recording tells the candidates of a diagnosis apart: expected odds, and the choice of its pieces.
//!
//! Of two candidates A and B let A be true, with the size that the diagnosis found. On the rows of a recording A adds s
//! to the readings, whitened by the noise. What the base model's columns X and B's columns E can imitate of s tells nothing;
//! the rest, M s with M = 1 - P_[X E], is what B leaves unexplained. The log-likelihood of A over B is then normal with mean
//! D = s' M s / 2 and variance 2 D: Atkinson & Fedorov (1975) choose rows for the largest such D (T-optimal designs), and Box
//! & Hill (1967) weigh it by the odds so far. docs/diagnosis.md, "The next recording", derives both.

mod choose;
mod gram;
mod hedge;
mod hypothesis;
mod question;
mod settler;

pub use self::choose::{inseparable, score};
pub use self::gram::Odds;
pub use self::question::{Candidate, Question};
pub use self::settler::{Pieces, Settler};
