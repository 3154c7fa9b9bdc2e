//! Conditions of instruction counts besides the source: compiler, target, lanes of the processor.

use std::process::Command;

/// Where counts were made.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Environment {
    /// `1.95.0`.
    pub(crate) release: String,
    /// `rustc 1.95.0 (59807616e 2026-04-14)`.
    pub(crate) rustc: String,
    /// `x86_64-unknown-linux-gnu`.
    pub(crate) target: String,
    /// What code that chooses its instructions at run time was offered; known once something has run.
    pub(crate) lanes: String,
    /// `valgrind-3.19.0`.
    pub(crate) valgrind: String,
}

impl Environment {
    /// That of this process, lanes empty yet; or why nothing can be counted here.
    pub(crate) fn here() -> Result<Self, String> {
        if cfg!(debug_assertions) {
            return Err("only an optimised build is counted (cargo xtask makes one)".to_owned());
        }
        let valgrind = said("valgrind", "--version")
            .ok_or("valgrind does not run here (apt-get install valgrind)")?;
        let verbose = said("rustc", "-vV").ok_or("rustc does not say its version")?;
        let (rustc, release, target) =
            compiler(&verbose).ok_or("rustc says its version in words that are not understood")?;
        Ok(Self {
            release,
            rustc,
            target,
            lanes: String::new(),
            valgrind,
        })
    }
}

/// First line, release and host of `rustc -vV`.
pub(crate) fn compiler(verbose: &str) -> Option<(String, String, String)> {
    let field = |name: &str| {
        let mut lines = verbose.lines();
        lines.find_map(|line| Some(line.strip_prefix(name)?.trim().to_owned()))
    };
    let first = verbose.lines().next()?.to_owned();
    Some((first, field("release:")?, field("host:")?))
}

fn said(program: &str, argument: &str) -> Option<String> {
    xtask_output::said(Command::new(program).arg(argument)).ok()
}

/// Lanes that this process is offered: valgrind shows its guests AVX2 at most, and nothing that the processor
/// has not. A build that may use AVX2 everywhere says so too.
pub(crate) fn lanes() -> String {
    let everywhere = if cfg!(target_feature = "avx2") {
        ", everywhere"
    } else {
        ""
    };
    format!("{}{everywhere}", offered())
}

/// By the test of the library that chooses them.
#[cfg(target_arch = "x86_64")]
fn offered() -> &'static str {
    match (
        pulp::x86::V3::try_new(),
        std::is_x86_feature_detected!("avx512f"),
    ) {
        (Some(_), true) => "AVX-512",
        (Some(_), false) => "AVX2 and FMA",
        (None, _) => "SSE2",
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn offered() -> &'static str {
    std::env::consts::ARCH
}
