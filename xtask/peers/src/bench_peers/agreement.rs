//! Agreement of all contenders on the solution: before that no time says anything.

use anyhow::{Result, bail};

/// Largest relative difference between final costs; of searches that stop by a larger share of the cost, that one.
pub(crate) const COST_AGREEMENT: f64 = 1e-9;

/// Refuses final costs that differ from the lowest by more than a share of it, or are none, and says whose.
pub(crate) fn check_costs(work: &str, share: f64, costs: &[(String, f64)]) -> Result<()> {
    let lowest = costs.iter().map(|(_, cost)| *cost);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    // false for a NaN
    let agrees = |cost: f64| (cost - lowest).abs() <= share * lowest;
    let off: Vec<String> = costs
        .iter()
        .filter(|(_, cost)| !agrees(*cost))
        .map(|(name, cost)| format!("{name}: {cost} ({:.1e} above)", (cost - lowest) / lowest))
        .collect();
    if off.is_empty() {
        return Ok(());
    }
    bail!(
        "{work}: final costs differ by more than {share:e}, so no times are reported; the lowest is \
         {lowest}, but {}",
        off.join("; ")
    )
}
