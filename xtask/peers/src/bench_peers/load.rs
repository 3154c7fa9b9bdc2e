//! Use of the machine by others while a round ran; a round that was disturbed is not counted.

use std::fs;

/// Share of the processors' time above which a round counts as disturbed.
pub(crate) const DISTURBED: f64 = 0.10;

/// Processor times in ticks, from the machine's start.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Ticks {
    /// All, idle included.
    pub(crate) total: u64,
    /// Not idle, not waiting, not stolen.
    pub(crate) busy: u64,
    /// Taken by other guests of the host.
    pub(crate) stolen: u64,
    /// Used by this process and the given ones.
    pub(crate) own: u64,
}

impl Ticks {
    /// Reads the counters; none where the system has no `/proc`.
    pub(crate) fn now(processes: &[u32]) -> Option<Self> {
        let mut ticks = Self::of_machine(&fs::read_to_string("/proc/stat").ok()?)?;
        ticks.own = of_process(&fs::read_to_string("/proc/self/stat").ok()?)?;
        for process in processes {
            let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
            ticks.own += of_process(&stat)?;
        }
        Some(ticks)
    }

    /// The first line of `/proc/stat`: user, nice, system, idle, iowait, irq, softirq, steal (proc(5)).
    pub(crate) fn of_machine(stat: &str) -> Option<Self> {
        let words = stat
            .lines()
            .next()?
            .strip_prefix("cpu ")?
            .split_whitespace();
        let times: Vec<u64> = words.map_while(|word| word.parse().ok()).collect();
        let &[user, nice, system, idle, waiting, irq, softirq, stolen, ..] = &times[..] else {
            return None;
        };
        let busy = user + nice + system + irq + softirq;
        Some(Self {
            total: busy + idle + waiting + stolen,
            busy,
            stolen,
            own: 0,
        })
    }

    /// Share of all processors' time since `before` that others used or that was stolen, whichever
    /// is more; none where no tick went by.
    pub(crate) fn foreign_share(&self, before: &Self) -> Option<f64> {
        let since = |now: u64, then: u64| now.saturating_sub(then) as f64;
        let total = since(self.total, before.total);
        let others = since(self.busy, before.busy) - since(self.own, before.own);
        (total > 0.0).then(|| others.max(since(self.stolen, before.stolen)).max(0.0) / total)
    }
}

/// User and system time of a process: fields 14 and 15 of its `stat`, counted after the name, which may
/// hold blanks (proc(5)).
pub(crate) fn of_process(stat: &str) -> Option<u64> {
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11).map(str::parse);
    let (user, system): (u64, u64) = (times.next()?.ok()?, times.next()?.ok()?);
    Some(user + system)
}

/// Running processes over the last minute, for the report.
pub(crate) fn load_average() -> Option<f64> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// Name of the processor, for the report.
pub(crate) fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    name.map_or("unknown", |name| name.trim_start_matches([' ', '\t', ':']))
        .to_owned()
}
