//! The messages of a bag of rosbag2 in SQLite (`.db3`).
//!
//! Tables `topics` (id, name, type, serialization_format) and `messages` (topic_id, timestamp, data) as the storage plugin
//! `rosbag2_storage_sqlite3` of ROS 2 makes them in all its versions.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;

use super::topics::Topics;
use super::{LARGEST_RECORD_BYTES, Message, Messages, is_wanted, not_a_log};
use crate::error::place::Place;
use crate::error::{DataError, Fault};
use crate::sqlite::{Broken, Cell, Database, Record, Table, Value};

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
    let damaged = |Broken(what)| {
        Place::file(name).error(Fault::Damaged {
            format: "SQLite",
            what,
        })
    };
    let mut bag = Database::open(file, LARGEST_RECORD_BYTES).map_err(damaged)?;
    let of_topics = bag.table("topics").map_err(damaged)?;
    let of_messages = bag.table("messages").map_err(damaged)?;
    let (Some(of_topics), Some(of_messages)) = (of_topics, of_messages) else {
        let what =
            "an SQLite database without the tables `topics` and `messages` of a bag of ROS 2";
        let next = "give the .db3 file that `ros2 bag record` wrote";
        return Err(not_a_log(name, what.to_owned(), next));
    };
    let topics = topics(&mut bag, &of_topics).map_err(damaged)?;
    let rows = rows(&mut bag, &of_messages, &topics).map_err(damaged)?;
    for (recorded_ns, topic, cell) in rows {
        let Some(topic) = topics.get(&topic) else {
            continue;
        };
        let data = data(&mut bag, &of_messages, cell).map_err(damaged)?;
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
            data: &data,
        })?;
    }
    Ok(found.topics)
}

/// A copy to go back and forth in: what is read may be a pipe.
fn copy(mut reader: impl Read, name: &str) -> Result<File, DataError> {
    let unreadable = |source| Place::file(name).error(Fault::Unreadable { source });
    let mut file = tempfile::tempfile().map_err(unreadable)?;
    std::io::copy(&mut reader, &mut file).map_err(unreadable)?;
    Ok(file)
}

/// The topics that count, by their numbers.
fn topics(bag: &mut Database<File>, table: &Table) -> Result<BTreeMap<i64, Topic>, Broken> {
    let mut topics = BTreeMap::new();
    for cell in bag.rows(table)? {
        let mut row = bag.record(cell)?;
        let id = integer(bag, (table, &mut row), "id")?;
        let topic = Topic {
            name: text(bag, (table, &mut row), "name")?,
            schema: text(bag, (table, &mut row), "type")?,
            encoding: text(bag, (table, &mut row), "serialization_format")?,
        };
        if is_wanted(&topic.schema) {
            topics.insert(id, topic);
        }
    }
    Ok(topics)
}

/// Messages of the topics by the time of recording: that, the topic, and where the row is.
fn rows(
    bag: &mut Database<File>,
    table: &Table,
    topics: &BTreeMap<i64, Topic>,
) -> Result<Vec<(i64, i64, Cell)>, Broken> {
    let mut found = Vec::new();
    for cell in bag.rows(table)? {
        let mut row = bag.record(cell)?;
        let topic = integer(bag, (table, &mut row), "topic_id")?;
        if topics.contains_key(&topic) {
            let recorded_ns = integer(bag, (table, &mut row), "timestamp")?;
            found.push((recorded_ns, topic, cell));
        }
    }
    // messages of one time stay in the order of their numbers
    found.sort_by_key(|row| row.0);
    Ok(found)
}

fn data(bag: &mut Database<File>, table: &Table, cell: Cell) -> Result<Vec<u8>, Broken> {
    let mut row = bag.record(cell)?;
    match bag.named((table, &mut row), "data")? {
        Value::Blob(data) => Ok(data),
        _ => Err(Broken("`data` of a message is no blob".to_owned())),
    }
}

fn integer(
    bag: &mut Database<File>,
    row: (&Table, &mut Record),
    column: &str,
) -> Result<i64, Broken> {
    match bag.named(row, column)? {
        Value::Integer(value) => Ok(value),
        _ => Err(Broken(format!("`{column}` is no whole number"))),
    }
}

fn text(
    bag: &mut Database<File>,
    row: (&Table, &mut Record),
    column: &str,
) -> Result<String, Broken> {
    match bag.named(row, column)? {
        Value::Text(value) => Ok(value),
        _ => Err(Broken(format!("`{column}` is no text"))),
    }
}
