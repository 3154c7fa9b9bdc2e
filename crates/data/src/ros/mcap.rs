//! The messages of an MCAP file.

use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mcap::McapError;
use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;

use super::decompress::WholeChunk;
use super::topics::Topics;
use super::{LARGEST_RECORD_BYTES, Message, Messages, is_wanted};
use crate::error::place::Place;
use crate::error::{DataError, Fault};

/// The messages that count, from the first to the last; of a file that grows to the last whole one.
pub(super) fn read_topics(
    reader: impl Read,
    mut found: Messages<'_>,
    is_growing: bool,
) -> Result<Topics, DataError> {
    let name = found.name;
    let options = LinearReaderOptions::default()
        .with_record_length_limit(LARGEST_RECORD_BYTES)
        .with_validate_chunk_crcs(true);
    let mut messages = MessageReader::new_with_options(reader, options);
    for decompressor in [WholeChunk::lz4(), WholeChunk::zstd()] {
        let added = messages.add_decompressor(decompressor);
        added.map_err(|error| failed(name, error))?;
    }
    loop {
        // a library that meets what it does not expect may panic; its reader is dropped then
        let next = catch_unwind(AssertUnwindSafe(|| messages.next())).map_err(|_| {
            let (format, what) = ("MCAP", "its parts contradict".to_owned());
            Place::file(name).error(Fault::Damaged { format, what })
        })?;
        let message = match next {
            None => break,
            Some(Err(error)) if is_growing && is_end(&error) => break,
            Some(message) => message.map_err(|error| failed(name, error))?,
        };
        let channel = &message.channel;
        let schema = channel.schema.as_deref().map(|schema| schema.name.as_str());
        let Some(schema) = schema.filter(|schema| is_wanted(schema)) else {
            continue;
        };
        found.add(&Message {
            schema,
            encoding: &channel.message_encoding,
            topic: &channel.topic,
            recorded_ns: i64::try_from(message.log_time).unwrap_or(i64::MAX),
            data: &message.data,
        })?;
    }
    Ok(found.topics)
}

/// Whether a file ended within a record, a chunk, or without its last bytes.
fn is_end(error: &McapError) -> bool {
    match error {
        McapError::UnexpectedEof | McapError::UnexpectedEoc => true,
        McapError::Io(source) => source.kind() == std::io::ErrorKind::UnexpectedEof,
        _ => false,
    }
}

fn failed(name: &str, error: McapError) -> DataError {
    let at = Place::file(name);
    match error {
        McapError::Io(source) if source.kind() != std::io::ErrorKind::UnexpectedEof => {
            at.error(Fault::Unreadable { source })
        }
        McapError::UnsupportedCompression(codec) => at.error(Fault::NotALog {
            what: format!("a chunk is compressed with `{codec}`, which is not read"),
            advice: "write the recording with lz4, zstd or no compression".to_owned(),
        }),
        other => at.error(Fault::Damaged {
            format: "MCAP",
            what: other.to_string(),
        }),
    }
}
