//! Streams of noise for the tests.

use haptical_monitor::{Event, Monitor, Settings};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// AR(1) noise of standard deviation 1.
pub(crate) struct Noise {
    rng: ChaCha8Rng,
    memory: f64,
    last: f64,
}

impl Noise {
    pub(crate) fn new(seed: u64, memory: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let last = StandardNormal.sample(&mut rng);
        Self { rng, memory, last }
    }

    pub(crate) fn next(&mut self) -> f64 {
        let shock: f64 = StandardNormal.sample(&mut self.rng);
        self.last = self.memory * self.last + (1.0 - self.memory * self.memory).sqrt() * shock;
        self.last
    }
}

pub(crate) fn settings(components: usize) -> Settings {
    Settings {
        floors: vec![0.0; components],
        tolerances: vec![0.0; components],
        reference_rows: 1000,
        miss: 0.05,
    }
}

/// A monitor of one component whose reference is complete, one row a second and a false alarm in 100 hours.
pub(crate) fn watching(settings: Settings, noise: &mut Noise) -> Monitor {
    let mut monitor = Monitor::new(settings).unwrap();
    monitor.set_rows_between_false_alarms(3.6e5).unwrap();
    for row in 0..100_000 {
        if monitor.push(f64::from(row), &[noise.next()]).unwrap() == Some(Event::Referenced) {
            return monitor;
        }
    }
    panic!("no reference");
}
