//! A log that grows, is cut, is replaced, has rows that are none: what a watch makes of it.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use haptical::watch::{Feed, Watch, WatchEvent, WatchOptions, WatchVerdict};
use haptical::{Device, Error};

const HEADER: &str = "t_s,theta1_rad,out1_rad\n";

/// Rows of a joint at 10 Hz whose external encoder has noise of 0.1 mrad, and is off by `shift_rad`.
struct Rows {
    seed: u64,
    row: u64,
}

impl Rows {
    fn new() -> Self {
        Self { seed: 1, row: 0 }
    }

    fn noise(&mut self) -> f64 {
        let mut sum = 0.0;
        for _ in 0..4 {
            self.seed = self
                .seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            sum += (self.seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
        sum * 1e-4 * 3.0_f64.sqrt()
    }

    fn text(&mut self, rows: usize, shift_rad: f64) -> String {
        let mut text = String::new();
        for _ in 0..rows {
            let time_s = self.row as f64 / 10.0;
            let angle_rad = (0.7 * time_s).sin();
            let out_rad = angle_rad + shift_rad + self.noise();
            writeln!(text, "{time_s},{angle_rad},{out_rad}").unwrap();
            self.row += 1;
        }
        text
    }
}

fn watch() -> Watch {
    let device = Device::from_toml("[[joint]]\nname = \"one\"\n", "one.toml").unwrap();
    let options = WatchOptions {
        reference_s: 100.0,
        false_alarms_per_hour: 0.01,
        ..WatchOptions::default()
    };
    Watch::new(device, options).unwrap()
}

/// Looks until nothing new comes.
fn drain(feed: &mut Feed, watch: &mut Watch, is_last: bool) -> Vec<WatchEvent> {
    let mut events = Vec::new();
    loop {
        let fed = feed.look(watch, is_last).unwrap();
        events.extend(fed.events);
        if fed.ended || !(fed.grew || is_last) {
            return events;
        }
    }
}

fn append(path: &Path, text: &str) {
    let mut file = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(path)
        .unwrap();
    file.write_all(text.as_bytes()).unwrap();
}

fn notes(events: &[WatchEvent]) -> String {
    let notes = events.iter().filter_map(|event| match event {
        WatchEvent::Note { text } => Some(text.as_str()),
        _ => None,
    });
    notes.collect::<Vec<_>>().join("\n")
}

fn alarms(events: &[WatchEvent]) -> usize {
    events
        .iter()
        .filter(|event| matches!(event, WatchEvent::Alarm(_)))
        .count()
}

#[test]
fn a_growing_file_is_judged_and_the_change_is_placed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let (mut rows, mut watch) = (Rows::new(), watch());
    append(&path, &(HEADER.to_owned() + &rows.text(3000, 0.0)));
    let mut feed = Feed::open(&path).unwrap();
    let events = drain(&mut feed, &mut watch, false);
    assert!(
        matches!(events[..], [WatchEvent::Reference(_)]),
        "{events:?}"
    );
    assert_eq!(watch.verdict(), WatchVerdict::True);
    let held = watch.held();
    append(&path, &rows.text(20_000, 0.0));
    assert_eq!(drain(&mut feed, &mut watch, false), []);
    append(&path, &rows.text(3000, 2e-4));
    let events = drain(&mut feed, &mut watch, false);
    assert_eq!(alarms(&events), 1);
    let WatchEvent::Alarm(alarm) = &events[0] else {
        panic!("{events:?}")
    };
    // row 23000 is in line 23002, at 2300 s
    assert!((alarm.since_s - 2300.0).abs() < 3.0, "{alarm:?}");
    assert!(
        alarm.since_ci95_s[0] <= 2300.0 && 2300.0 <= alarm.since_ci95_s[1],
        "{alarm:?}"
    );
    // the blocks alone begin 4.4 s earlier; the joint is on one side for 4.5 s, and for as long a change may not have shown
    let before_s = alarm.since_s - alarm.since_ci95_s[0];
    assert!((8.0..12.0).contains(&before_s), "{alarm:?}");
    assert!(alarm.line.abs_diff(23_002) < 30, "{alarm:?}");
    assert!(alarm.seen_s < 2320.0);
    let channel = &alarm.channels[0];
    assert_eq!(
        (channel.channel.as_str(), channel.unit.as_str()),
        ("out1", "rad")
    );
    // prediction minus measurement
    let after = watch.state();
    assert!(
        after.channels[0].shift_ci95[0] < -1.5e-4 && after.channels[0].shift_ci95[1] > -2.5e-4,
        "{after:?}"
    );
    assert!(
        events
            .iter()
            .any(|event| matches!(event, WatchEvent::Cause(_)))
    );
    assert!(watch.held() <= held + 20_000, "{} {held}", watch.held());
    let page = after.page(60).unwrap();
    assert!(
        page.contains("<meta http-equiv=\"refresh\" content=\"60\">")
            && page.contains("NOT TRUE since")
    );
    assert!(!after.page(0).unwrap().contains("refresh"));
}

/// A last line without its end, `0.1` of `0.12345`, is a row of other numbers.
#[test]
fn half_a_row_is_never_judged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let (mut rows, mut watch) = (Rows::new(), watch());
    append(&path, HEADER);
    let mut feed = Feed::open(&path).unwrap();
    let text = rows.text(2000, 0.0);
    for part in text.as_bytes().chunks(997) {
        append(&path, std::str::from_utf8(part).unwrap());
        let _ = drain(&mut feed, &mut watch, false);
    }
    append(&path, "200.0,0.1,0.1");
    let events = drain(&mut feed, &mut watch, true);
    assert!(
        notes(&events).contains("the last line has no end and is not judged"),
        "{events:?}"
    );
    let state = watch.state();
    assert_eq!(
        (
            state.rows,
            state.left_out.unreadable,
            state.left_out.out_of_order
        ),
        (2000, 0, 0)
    );
}

#[test]
fn rows_that_are_none_are_left_out_and_counted() {
    let (mut rows, mut watch) = (Rows::new(), watch());
    watch.begin("log.csv");
    watch
        .text(&(HEADER.to_owned() + &rows.text(1000, 0.0)))
        .unwrap();
    let bad = "1e9,0.1\nNaN,NaN,NaN\n100.0,x,0.1\n5.0,0.1,0.1\n6.0,0.1,0.1\n";
    let next = rows.text(100, 0.0);
    watch.text(&format!("{HEADER}{bad}{next}")).unwrap();
    let state = watch.state();
    assert_eq!(
        (
            state.rows,
            state.left_out.unreadable,
            state.left_out.out_of_order
        ),
        (1100, 3, 2)
    );
    assert!(
        state
            .left_out
            .first
            .unwrap()
            .starts_with("log.csv, line 2: ")
    );
    // a clock that was set back goes on from there
    let mut again = Rows::new();
    watch
        .text(&(HEADER.to_owned() + &again.text(100, 0.0)))
        .unwrap();
    assert_eq!(watch.state().rows, 1100 + 100 - 19);
    assert_eq!(watch.state().left_out.out_of_order, 2 + 19);
}

#[test]
fn a_file_that_is_cut_or_replaced_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let (mut rows, mut watch) = (Rows::new(), watch());
    append(&path, &(HEADER.to_owned() + &rows.text(1500, 0.0)));
    let mut feed = Feed::open(&path).unwrap();
    let _ = drain(&mut feed, &mut watch, false);
    std::fs::write(&path, HEADER.to_owned() + &rows.text(10, 0.0)).unwrap();
    let events = drain(&mut feed, &mut watch, false);
    assert!(
        notes(&events).contains("log.csv: the file was cut"),
        "{events:?}"
    );
    assert_eq!(watch.state().rows, 1510);
    if cfg!(unix) {
        // what was still written to the old file counts
        append(&path, &rows.text(5, 0.0));
        std::fs::rename(&path, folder.path().join("log.1")).unwrap();
        append(&path, &(HEADER.to_owned() + &rows.text(7, 0.0)));
        let events = drain(&mut feed, &mut watch, false);
        assert!(
            notes(&events).contains("another file has taken its place"),
            "{events:?}"
        );
        assert_eq!(watch.state().rows, 1522);
    }
}

/// Each file's times begin anew.
#[test]
fn logs_that_arrive_in_a_folder_are_one_watch() {
    let folder = tempfile::tempdir().unwrap();
    let mut watch = watch();
    let mut feed = Feed::open(folder.path()).unwrap();
    let mut events = Vec::new();
    for number in 0..10 {
        let mut rows = Rows {
            seed: number,
            row: 0,
        };
        let shift_rad = if number < 8 { 0.0 } else { 2e-4 };
        let text = HEADER.to_owned() + &rows.text(400, shift_rad);
        std::fs::write(folder.path().join(format!("{number}.csv")), text).unwrap();
        std::fs::write(folder.path().join(format!("{number}.csv.part")), "half").unwrap();
        events.extend(drain(&mut feed, &mut watch, number == 9));
        assert_eq!(alarms(&events), usize::from(number >= 8));
    }
    assert_eq!(watch.state().rows, 4000);
    let alarm = watch.state().alarm.unwrap();
    assert_eq!(alarm.file.rsplit(['/', '\\']).next(), Some("8.csv"));
}

#[test]
fn json_lines_of_a_pipe_are_rows() {
    let mut rows = Rows::new();
    let mut text = String::new();
    for line in rows.text(3000, 0.0).lines() {
        let cells: Vec<&str> = line.split(',').collect();
        writeln!(
            text,
            "{{\"theta1_rad\":{},\"out1_rad\":{},\"t_s\":{}}}",
            cells[1], cells[2], cells[0]
        )
        .unwrap();
    }
    let mut watch = watch();
    let mut feed = Feed::pipe(std::io::Cursor::new(text), "standard input");
    while !feed.look(&mut watch, false).unwrap().ended {}
    assert_eq!(watch.state().rows, 3000);
    assert_eq!(watch.verdict(), WatchVerdict::True);
}

/// Rows of a joint at 1 kHz whose encoder's error follows the posture, beyond the tolerance.
fn fast(rows: &mut Rows, count: usize, shift_rad: f64) -> String {
    let mut text = HEADER.to_owned();
    for _ in 0..count {
        let time_s = rows.row as f64 / 1000.0;
        let angle_rad = (0.7 * time_s).sin() + 0.6 * (1.9 * time_s).sin();
        let out_rad = angle_rad + shift_rad + rows.noise() + 2e-5 * (4.0 * angle_rad + 0.5).sin();
        writeln!(text, "{time_s},{angle_rad},{out_rad}").unwrap();
        rows.row += 1;
    }
    text
}

/// A log as long as the reference that is asked for is one, though a watch keeps no more than the last rows of those it is set up by.
#[test]
fn a_log_at_1_khz_is_a_reference() {
    let device = "[[joint]]\nname = \"one\"\nexternal_encoder_sd_rad = 1e-4\n";
    let device = Device::from_toml(device, "one.toml").unwrap();
    let options = WatchOptions {
        reference_s: 200.0,
        keep_rows: 5000,
        ..WatchOptions::default()
    };
    let mut watch = Watch::new(device, options).unwrap();
    let mut rows = Rows::new();
    watch.begin_reference();
    watch.begin("good.csv");
    // pieces as a file is read in
    for _ in 0..100 {
        watch.text(&fast(&mut rows, 2000, 0.0)).unwrap();
    }
    let events = watch.end_reference().unwrap();
    assert!(
        matches!(events[..], [WatchEvent::Reference(_)]),
        "{events:?}"
    );
    watch.begin("new.csv");
    for _ in 0..30 {
        let events = watch.text(&fast(&mut rows, 2000, 0.0)).unwrap();
        assert_eq!(alarms(&events), 0);
    }
    assert_eq!(watch.verdict(), WatchVerdict::True);
    let events = watch.text(&fast(&mut rows, 10_000, 1e-3)).unwrap();
    assert_eq!(alarms(&events), 1);
}

fn refusal(device: &str, text: &str) -> Error {
    let device = Device::from_toml(device, "one.toml").unwrap();
    let mut watch = Watch::new(device, WatchOptions::default()).unwrap();
    watch.begin("log.csv");
    watch.text(text).and_then(|_| watch.finish()).unwrap_err()
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let joint = "[[joint]]\nname = \"one\"\n";
    let no_times = "theta1_rad,out1_rad\n".to_owned() + &"0.1,0.1\n".repeat(300);
    assert_eq!(refusal(joint, &no_times).name(), "no-times");
    let torques: String = (0..300).map(|row| format!("{row},0.1,0.5\n")).collect();
    let refused = refusal(joint, &format!("t_s,theta1_rad,torque1_nm\n{torques}"));
    assert_eq!(refused.name(), "nothing-to-watch");
    assert!(
        refused.next_step().contains("haptical diagnose"),
        "{refused}"
    );
    assert_eq!(refusal(joint, "t_s,angle\n0,1\n").name(), "missing-column");
    let device = Device::from_toml(joint, "one.toml").unwrap();
    let options = WatchOptions {
        false_alarms_per_hour: 0.0,
        ..WatchOptions::default()
    };
    assert!(
        Watch::new(device, options)
            .unwrap_err()
            .what()
            .contains("--false-alarms-per-hour")
    );
}

#[test]
fn a_whole_log_can_be_the_reference() {
    let (mut rows, mut watch) = (Rows::new(), watch());
    watch.begin_reference();
    watch.begin("good.csv");
    watch
        .text(&(HEADER.to_owned() + &rows.text(4000, 0.0)))
        .unwrap();
    let events = watch.end_reference().unwrap();
    let [WatchEvent::Reference(reference)] = &events[..] else {
        panic!("{events:?}")
    };
    assert_eq!(reference.rows, 4000);
    // it knows its mean better than one of the first rows
    assert!(reference.channels[0].margin < 1.5e-5, "{reference:?}");
    watch.begin("new.csv");
    let events = watch
        .text(&(HEADER.to_owned() + &rows.text(1000, 5e-5)))
        .unwrap();
    assert_eq!(alarms(&events), 1);
    let mut short = self::watch();
    short.begin_reference();
    short.begin("good.csv");
    short
        .text(&(HEADER.to_owned() + &rows.text(300, 0.0)))
        .unwrap();
    let refused = short.end_reference().unwrap_err();
    assert_eq!(refused.name(), "short-reference");
    assert!(refused.what().contains("300 rows are too few"), "{refused}");
}

/// An encoder that is taken off leaves nothing to judge by, which is no calibration that is true.
#[test]
fn a_channel_that_is_no_longer_read_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    let mut rows = Rows::new();
    std::fs::write(&path, HEADER.to_owned() + &rows.text(6000, 0.0)).unwrap();
    let (mut feed, mut watch) = (Feed::open(&path).unwrap(), watch());
    drain(&mut feed, &mut watch, false);
    assert_eq!(watch.verdict(), WatchVerdict::True);
    let without: String = rows
        .text(1000, 0.0)
        .lines()
        .filter_map(|line| Some(format!("{},\n", line.rsplit_once(',')?.0)))
        .collect();
    append(&path, &without);
    drain(&mut feed, &mut watch, true);
    let state = watch.state();
    let [ceased] = state.ceased.as_slice() else {
        panic!("{:?}", state.ceased);
    };
    assert_eq!(
        (ceased.channel.as_str(), ceased.last_read_s),
        ("out1", 599.9)
    );
    assert_eq!(state.verdict, WatchVerdict::NotJudged);
    assert!(state.summary().contains("No reading of out1 since"));
}
