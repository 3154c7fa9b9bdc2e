//! Times of a table of rigs and of a choice of poses: `cargo bench -p haptical-design`.
#![allow(missing_docs, reason = "criterion writes functions without text")]

use std::error::Error;

use criterion::{Criterion as Bench, criterion_group, criterion_main};
use haptical_design::{Criterion, Request, Rig, plan};

fn add(bench: &mut Bench) -> Result<(), Box<dyn Error>> {
    let device = haptical_testkit::haptic7();
    let table = Request {
        rigs: vec![Rig::parse("out,cable")?],
        candidates: 500,
        ..Request::default()
    };
    let chosen = |criterion| Request {
        poses: 60,
        chooses: true,
        criterion,
        ..table.clone()
    };
    let mut group = bench.benchmark_group("plan, out and cable, 500 candidates");
    group.sample_size(10);
    let requests = [
        ("table", table.clone()),
        ("60 poses, D", chosen(Criterion::D)),
        ("60 poses, A", chosen(Criterion::A)),
    ];
    for (name, request) in requests {
        // what is timed must have an answer: a refusal would be fast
        plan(&device, &request, &[], &|_| ())?;
        group.bench_function(name, |bencher| {
            bencher.iter(|| plan(&device, &request, &[], &|_| ()));
        });
    }
    group.finish();
    Ok(())
}

fn rigs(bench: &mut Bench) {
    let added = add(bench);
    assert!(added.is_ok(), "{added:?}");
}

criterion_group!(benches, rigs);
criterion_main!(benches);
