//! The messages of a bag of rosbag2 in SQLite (`.db3`).
//!
//! Tables `topics` (id, name, type, serialization_format) and `messages` (topic_id, timestamp, data) as the storage plugin
//! `rosbag2_storage_sqlite3` of ROS 2 makes them in all its versions.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom, Write};

use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags};

use super::topics::Topics;
use super::{LARGEST_RECORD_BYTES, Message, Messages, is_wanted, not_a_log};
use crate::error::place::Place;
use crate::error::{DataError, Fault};

/// Bytes of a file's head that say whether it is written ahead: then 2, else 1 (SQLite's file format, section 1.3).
const WRITE_AHEAD: [u64; 2] = [18, 19];
/// How a compressed message begins.
const ZSTD_MAGIC: [u8; 4] = *b"\x28\xb5\x2f\xfd";

/// Name, type and encoding of a topic that counts.
struct Topic {
    name: String,
    schema: String,
    encoding: String,
}

/// The messages that count, by the time of recording.
pub(super) fn read_topics(reader: impl Read, mut found: Messages<'_>) -> Result<Topics, DataError> {
    let name = found.name;
    let ahead = format!("{name}-wal");
    if std::fs::metadata(&ahead).is_ok_and(|ahead| ahead.len() > 0) {
        let what = format!("the bag was not closed: its last messages are in `{ahead}`");
        let next = "write them back: sqlite3 BAG.db3 \"PRAGMA wal_checkpoint(TRUNCATE)\"";
        return Err(not_a_log(name, what, next));
    }
    let file = copy(reader, name)?;
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let bag = Connection::open_with_flags(file.path(), flags);
    let bag = bag.map_err(|error| damaged(name, &error))?;
    let most = i32::try_from(LARGEST_RECORD_BYTES).unwrap_or(i32::MAX);
    let limited = bag.set_limit(Limit::SQLITE_LIMIT_LENGTH, most);
    limited.map_err(|error| damaged(name, &error))?;
    // what a stranger's file declares is not run
    let unsure = bag.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON");
    unsure.map_err(|error| damaged(name, &error))?;
    if !has_tables(&bag).map_err(|error| damaged(name, &error))? {
        let what =
            "an SQLite database without the tables `topics` and `messages` of a bag of ROS 2";
        let next = "give the .db3 file that `ros2 bag record` wrote";
        return Err(not_a_log(name, what.to_owned(), next));
    }
    let topics = topics(&bag).map_err(|error| damaged(name, &error))?;
    let wanted: Vec<String> = topics.keys().map(i64::to_string).collect();
    let query = format!(
        "SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({}) ORDER BY timestamp",
        wanted.join(",")
    );
    let mut statement = bag.prepare(&query).map_err(|error| damaged(name, &error))?;
    let mut rows = statement.query([]).map_err(|error| damaged(name, &error))?;
    while let Some(row) = rows.next().map_err(|error| damaged(name, &error))? {
        let parts = row.get::<_, i64>(0).and_then(|topic| {
            let data = row.get_ref(2)?.as_blob()?;
            Ok((topic, row.get::<_, i64>(1)?, data))
        });
        let (topic, recorded_ns, data) = parts.map_err(|error| damaged(name, &error))?;
        let Some(topic) = topics.get(&topic) else {
            continue;
        };
        if data.starts_with(&ZSTD_MAGIC) {
            let what = "the messages are compressed one by one, which is not read".to_owned();
            let next = "convert it: rosbags-convert --src BAG --dst NEW, where BAG is its folder";
            return Err(not_a_log(name, what, next));
        }
        found.add(&Message {
            schema: &topic.schema,
            encoding: &topic.encoding,
            topic: &topic.name,
            recorded_ns,
            data,
        })?;
    }
    Ok(found.topics)
}

/// A copy that SQLite opens: what is read may be a pipe. It stands alone, without the log of one that is written ahead.
fn copy(mut reader: impl Read, name: &str) -> Result<tempfile::NamedTempFile, DataError> {
    let unreadable = |source| Place::file(name).error(Fault::Unreadable { source });
    let mut file = tempfile::NamedTempFile::new().map_err(unreadable)?;
    std::io::copy(&mut reader, &mut file).map_err(unreadable)?;
    for place in WRITE_AHEAD {
        let written = (file.seek(SeekFrom::Start(place))).and_then(|_| file.write_all(&[1]));
        written.map_err(unreadable)?;
    }
    file.flush().map_err(unreadable)?;
    Ok(file)
}

fn has_tables(bag: &Connection) -> rusqlite::Result<bool> {
    let query = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')";
    let tables: i64 = bag.query_row(query, [], |row| row.get(0))?;
    Ok(tables == 2)
}

/// The topics that count, by their numbers.
fn topics(bag: &Connection) -> rusqlite::Result<BTreeMap<i64, Topic>> {
    let mut statement = bag.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let rows = statement.query_map([], |row| {
        let topic = Topic {
            name: row.get(1)?,
            schema: row.get(2)?,
            encoding: row.get(3)?,
        };
        Ok((row.get(0)?, topic))
    })?;
    let counts = |row: &rusqlite::Result<(i64, Topic)>| match row {
        Ok((_, topic)) => is_wanted(&topic.schema),
        Err(_) => true,
    };
    rows.filter(counts).collect()
}

fn damaged(name: &str, error: &rusqlite::Error) -> DataError {
    Place::file(name).error(Fault::Damaged {
        format: "SQLite",
        what: error.to_string(),
    })
}
