//! A day of rows at 1 kHz through the watch, as text: what it holds does not grow.

use std::fmt::Write as _;

use anyhow::Result;
use haptical::Device;
use haptical::watch::{Watch, WatchOptions, WatchVerdict};
use haptical_report::Table;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use xtask_output::{Output, Progress, cells};

const DAY_S: u32 = 86_400;
const RATE_HZ: u32 = 1000;
/// Seconds at which it is told what is held.
const TOLD_S: [u32; 4] = [600, 3600, 21_600, DAY_S];

pub(super) fn day(output: &mut Output) -> Result<()> {
    let device = Device::from_toml("[[joint]]\nname = \"one\"\n", "one.toml")?;
    let mut watch = Watch::new(device, WatchOptions::default())?;
    watch.begin("day.csv");
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    // a sum of two uniform numbers, 0.1 mrad
    let mut noise = || {
        let bits = rng.next_u64();
        let parts = [bits >> 32, bits & 0xFFFF_FFFF].map(|part| part as f64 / 4_294_967_296.0);
        2.4e-4 * (parts[0] + parts[1] - 1.0)
    };
    let progress = Progress::new("a day at 1 kHz", (DAY_S / 600) as usize);
    let mut told = Vec::new();
    let mut text = String::new();
    for second in 0..DAY_S {
        text.clear();
        text.push_str("t_s,theta1_rad,out1_rad\n");
        for row in 0..RATE_HZ {
            let time_s = f64::from(second) + f64::from(row) / f64::from(RATE_HZ);
            let angle_rad = (0.5 * time_s).sin();
            writeln!(
                text,
                "{time_s:.3},{angle_rad:.6},{:.6}",
                angle_rad + noise()
            )?;
        }
        watch.text(&text)?;
        if TOLD_S.contains(&(second + 1)) {
            told.push((second + 1, watch.state().rows, watch.held()));
        }
        if (second + 1).is_multiple_of(600) {
            progress.step();
        }
    }
    drop(progress);
    let mut table = Table::with_heads("A day at 1 kHz", "hours | rows | numbers and lines held");
    for (second, rows, held) in &told {
        table.push(cells! {
            f64::from(*second) / 3600.0 => 2, *rows as f64 => 0, *held as f64 => 0,
        })?;
    }
    output.table("watch-day", table)?;
    let held = |at: usize| told.get(at).map_or(0, |told| told.2);
    // the places of the last parts fill their ring in little more than an hour
    output.verdict(
        held(3) <= held(2) && watch.verdict() == WatchVerdict::True,
        format!(
            "a day at 1 kHz is {} rows without an alarm, and holds no more than after six hours",
            watch.state().rows
        ),
    );
    Ok(())
}
