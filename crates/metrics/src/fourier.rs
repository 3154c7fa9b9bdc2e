//! The discrete Fourier transform of real values, of any length.

use std::fmt;
use std::sync::Arc;

pub use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// y_k = sum_n x_n exp(-2 pi i k n / N), planned once for values of one length N (rustfft).
///
/// ```
/// use haptical_metrics::Fourier;
/// let mut fourier = Fourier::new(3);
/// let found = fourier.transform([1.0, 2.0, 4.0]);
/// assert!((found[0].re - 7.0).abs() < 1e-14 && found[0].im.abs() < 1e-14);
/// assert!((found[1].re + 2.0).abs() < 1e-14 && (found[1].im - 3.0_f64.sqrt()).abs() < 1e-14);
/// ```
pub struct Fourier {
    plan: Arc<dyn Fft<f64>>,
    buffer: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl Fourier {
    /// For `count` values.
    pub fn new(count: usize) -> Self {
        let plan = FftPlanner::new().plan_fft_forward(count);
        Self {
            buffer: vec![Complex::default(); count],
            scratch: vec![Complex::default(); plan.get_inplace_scratch_len()],
            plan,
        }
    }

    /// The transform: as many numbers as it was made for. Values that are missing count as 0, further ones are left out.
    pub fn transform(&mut self, values: impl IntoIterator<Item = f64>) -> &[Complex<f64>] {
        let values = values.into_iter().chain(std::iter::repeat(0.0));
        for (entry, value) in self.buffer.iter_mut().zip(values) {
            *entry = Complex::from(value);
        }
        self.plan
            .process_with_scratch(&mut self.buffer, &mut self.scratch);
        &self.buffer
    }
}

impl fmt::Debug for Fourier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fourier")
            .field("count", &self.buffer.len())
            .finish_non_exhaustive()
    }
}
