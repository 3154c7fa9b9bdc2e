//! A chosen recording as text for a terminal.

use super::{ExpectedOdds, Settled};

/// Pairs that are listed; plan.json has all.
const LISTED: usize = 8;
/// Odds above which their size no longer matters.
const SURE: f64 = 1000.0;

/// `20 : 1`, `1 : 3`, `over 1000 : 1`.
pub(super) fn odds(odds: f64) -> String {
    let whole = |odds: f64| match odds < 9.95 {
        true => format!("{odds:.1}"),
        false => format!("{odds:.0}"),
    };
    match odds {
        _ if odds > SURE => format!("over {SURE} : 1"),
        _ if odds >= 1.0 => format!("{} : 1", whole(odds)),
        _ if odds > 1.0 / SURE => format!("1 : {}", whole(1.0 / odds)),
        _ => format!("below 1 : {SURE}"),
    }
}

/// What to record and what it settles.
pub(super) fn answer(settled: &Settled) -> String {
    let named = settled.candidates.join(", ");
    let Some(least) = settled.least_odds else {
        return format!(
            "No motion of those tried is expected to tell {named} apart with these sensors: another sensor may, or a look at the \
             parts that they name."
        );
    };
    let how_long = settled.duration_s.map(|own| format!(" ({own:.0} s)"));
    let expect = match least {
        _ if least > SURE => "Then expect",
        _ if least > 1.0 => "Then expect at least",
        _ => "That is not enough: expect",
    };
    let pairs = match settled.inseparable.is_empty() {
        true => "",
        false => ", but for the pairs below that no motion is expected to tell apart",
    };
    format!(
        "Record {} rows{}. {expect} {} for whichever is true of {named} over each other one{pairs}.",
        settled.rows,
        how_long.unwrap_or_default(),
        odds(least)
    )
}

/// Answer, odds pair by pair, pieces, what no motion is expected to tell apart, what to do then.
pub(super) fn write(text: &mut impl std::fmt::Write, settled: &Settled) -> std::fmt::Result {
    writeln!(text, "{}\n", settled.answer)?;
    let mut pairs: Vec<&ExpectedOdds> = settled.odds.iter().collect();
    pairs.sort_by(|a, b| a.after.total_cmp(&b.after));
    let names = pairs.iter().map(|pair| pair.if_true.chars().count());
    let width = names.max().unwrap_or(0).max("if it is".len());
    let mut line = |name: &str, before: &str, after: &str, over: &str| {
        writeln!(text, "{name:<width$}  {before:<16}{after:<16}{over}")
    };
    line("if it is", "odds now", "then expect", "over")?;
    for pair in pairs.iter().take(LISTED) {
        let (before, after) = (odds(pair.before), odds(pair.after));
        line(&pair.if_true, &before, &after, &pair.over)?;
    }
    if let Some(random) = settled.least_odds_at_random {
        writeln!(text, "as many motions at random: {} at least", odds(random))?;
    }
    for [is_true, other] in &settled.inseparable {
        writeln!(
            text,
            "not promised: if it is {is_true}, no motion of those tried is expected to rule out {other} at 4 : 1"
        )?;
    }
    if let Some(degc) = settled.start_degc {
        writeln!(
            text,
            "\nstart while the device is as warm as at the end of the log ({degc:.1} degC): what follows the temperature then \
             differs from what follows the time"
        )?;
    }
    writeln!(text)?;
    for (piece, number) in settled.pieces.iter().zip(1..) {
        writeln!(text, "{number:>3}. {piece}")?;
    }
    writeln!(
        text,
        "\nnext     move along poses.csv, record it with the same sensors, then: haptical diagnose --log log.csv --log next.csv"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odds_are_told_either_way() {
        let said = [1e9, 20.3, 3.21, 1.0, 0.5, 0.02, 1e-9].map(odds);
        let wanted = [
            "over 1000 : 1",
            "20 : 1",
            "3.2 : 1",
            "1.0 : 1",
            "1 : 2.0",
            "1 : 50",
            "below 1 : 1000",
        ];
        assert_eq!(said, wanted);
    }
}
