//! Room for numbers that starts at a cache line, so that no vector load crosses two.

/// Bytes of a cache line, and of the widest vector register.
const LINE_BYTES: usize = 64;
/// Numbers in a cache line.
const LINE: usize = LINE_BYTES / size_of::<f64>();

/// Numbers, zero at first, whose first one is at the start of a cache line.
#[derive(Debug, Default)]
pub struct Aligned {
    data: Vec<f64>,
    start: usize,
}

impl Clone for Aligned {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len());
        copy.as_mut_slice().copy_from_slice(self.as_slice());
        copy
    }
}

impl Aligned {
    /// Room for `length` numbers.
    pub fn zeros(length: usize) -> Self {
        let data = vec![0.0; length + LINE];
        // only speed hangs on the alignment: a platform that cannot tell it gets the plain start
        let start = data.as_ptr().align_offset(LINE_BYTES).min(LINE);
        let mut data = data;
        data.truncate(start + length);
        Self { data, start }
    }

    /// Makes room for at least `length` numbers; what was in it is lost if it must grow.
    pub fn reserve(&mut self, length: usize) {
        if self.len() < length {
            *self = Self::zeros(length);
        }
    }

    fn len(&self) -> usize {
        self.data.len() - self.start
    }

    /// All numbers.
    pub fn as_slice(&self) -> &[f64] {
        &self.data[self.start..]
    }

    /// All numbers, to be written.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.data[self.start..]
    }
}
