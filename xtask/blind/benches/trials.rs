//! Time of one trial of a suite: a device, two recordings, the truth: `cargo bench -p xtask-blind`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use xtask_blind::Suite;

fn add(criterion: &mut Criterion) -> anyhow::Result<()> {
    let mut group = criterion.benchmark_group("trial");
    group.sample_size(10);
    for suite in [Suite::Clean, Suite::Singles, Suite::Pairs] {
        // what is timed must be a trial
        suite.draw(0, 1)?;
        group.bench_function(BenchmarkId::from_parameter(suite.name()), |bencher| {
            bencher.iter(|| suite.draw(0, 1));
        });
    }
    group.finish();
    Ok(())
}

fn trials(criterion: &mut Criterion) {
    let added = add(criterion);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, trials);
criterion_main!(benches);
