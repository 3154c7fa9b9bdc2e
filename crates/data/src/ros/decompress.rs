//! Decompression of MCAP's chunks in Rust: LZ4 frames and Zstandard.

use std::io::{self, Read};

use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use mcap::{McapError, McapResult};

/// Decompresses a chunk as a whole.
pub(super) struct WholeChunk {
    name: &'static str,
    decode: fn(&[u8]) -> io::Result<Vec<u8>>,
    output: Option<Vec<u8>>,
    written: usize,
}

impl WholeChunk {
    pub(super) fn lz4() -> Self {
        Self::new("lz4", |chunk| {
            read_limited(lz4_flex::frame::FrameDecoder::new(chunk))
        })
    }

    pub(super) fn zstd() -> Self {
        Self::new("zstd", |chunk| {
            let decoder = ruzstd::decoding::StreamingDecoder::new(chunk);
            read_limited(decoder.map_err(|error| invalid(&error))?)
        })
    }

    fn new(name: &'static str, decode: fn(&[u8]) -> io::Result<Vec<u8>>) -> Self {
        Self {
            name,
            decode,
            output: None,
            written: 0,
        }
    }
}

fn invalid(error: &impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error.to_string())
}

fn read_limited(decoder: impl Read) -> io::Result<Vec<u8>> {
    let mut output = Vec::new();
    let most = super::LARGEST_RECORD_BYTES;
    decoder.take(most as u64 + 1).read_to_end(&mut output)?;
    if output.len() > most {
        return Err(invalid(&format!("a chunk of more than {} MiB", most >> 20)));
    }
    Ok(output)
}

impl Decompressor for WholeChunk {
    /// The reader hands over no more than the chunk has.
    fn next_read_size(&self) -> usize {
        if self.output.is_some() { 0 } else { usize::MAX }
    }

    fn decompress(&mut self, source: &[u8], target: &mut [u8]) -> McapResult<DecompressResult> {
        let (output, consumed) = match &mut self.output {
            Some(output) => (output, 0),
            none => {
                let decoded = (self.decode)(source)
                    .map_err(|error| McapError::DecompressionError(error.to_string()))?;
                (none.insert(decoded), source.len())
            }
        };
        let rest = output.get(self.written..).unwrap_or_default();
        let wrote = rest.len().min(target.len());
        target[..wrote].copy_from_slice(&rest[..wrote]);
        self.written += wrote;
        Ok(DecompressResult { consumed, wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        self.output = None;
        self.written = 0;
        Ok(())
    }

    fn name(&self) -> &'static str {
        self.name
    }
}
