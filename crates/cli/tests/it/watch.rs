//! `haptical watch` from outside: pipes, exit status, the page, Ctrl-C. Its guide has the rest.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::{haptical, text};

/// A joint at 10 Hz with an external encoder of 0.1 mrad noise, off by `shift_rad` from row `from` on.
fn rows(count: u64, from: u64, shift_rad: f64) -> String {
    let mut text = "t_s,theta1_rad,out1_rad\n".to_owned();
    let mut seed = 7_u64;
    for row in 0..count {
        let mut noise = 0.0;
        for _ in 0..4 {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            noise += (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        }
        let angle_rad = (0.07 * row as f64).sin();
        let out_rad = angle_rad + 1.7e-4 * noise + if row < from { 0.0 } else { shift_rad };
        writeln!(text, "{},{angle_rad},{out_rad}", row as f64 / 10.0).unwrap();
    }
    text
}

fn device(folder: &Path) {
    std::fs::write(folder.join("one.toml"), "[[joint]]\nname = \"one\"\n").unwrap();
}

#[test]
fn a_pipe_gives_json_lines_and_the_answer_as_exit_status() {
    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    for (count, shift_rad, status, verdict) in [
        (4000, 0.0, 0, "true"),
        (4000, 3e-4, 4, "untrue"),
        (100, 0.0, 3, "not-judged"),
    ] {
        let output = haptical()
            .current_dir(folder.path())
            .args([
                "watch",
                "--device",
                "one.toml",
                "--reference-s",
                "100",
                "--page",
                "watch.html",
                "-",
            ])
            .write_stdin(rows(count, 3000, shift_rad))
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(status),
            "{}",
            text(&output.stderr)
        );
        let lines: Vec<Value> = text(&output.stdout)
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        let end = lines.last().unwrap();
        assert_eq!(
            (
                end["event"].as_str(),
                end["verdict"].as_str(),
                end["rows"].as_u64()
            ),
            (Some("end"), Some(verdict), Some(count))
        );
        let alarms = lines.iter().filter(|line| line["event"] == "alarm").count();
        assert_eq!(alarms, usize::from(status == 4));
        let page = std::fs::read_to_string(folder.path().join("watch.html")).unwrap();
        assert!(page.contains("Is the calibration true?"));
    }
}

/// The rows of [`rows`] with a play of a width in front of the external encoder.
fn with_play(count: u64, width_rad: f64) -> String {
    let plain = rows(count, count, 0.0);
    let mut lines = plain.lines();
    let mut text = format!("{}\n", lines.next().unwrap());
    let mut link_rad = 0.0;
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [t_s, theta_rad, out_rad] = cells[..] else {
            panic!("{line}");
        };
        let half_rad = 0.5 * width_rad;
        link_rad = f64::clamp(link_rad, theta_rad - half_rad, theta_rad + half_rad);
        let out_rad = out_rad - theta_rad + link_rad;
        writeln!(text, "{t_s},{theta_rad},{out_rad}").unwrap();
    }
    text
}

/// The device file has a play of 1.8 mrad, the log one of 3.2 mrad: the answer is that play, with its new width and what it had.
#[test]
fn a_play_that_has_grown_is_named_with_its_new_width() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    for fit in ["", "fit = true\n"] {
        let device = "[[joint]]\nname = \"one\"\nexternal_encoder_sd_rad = 1e-4\n";
        let play = "[[effect]]\nname = \"backlash\"\njoint = 1\nwidth_rad = 1.8e-3\n";
        write("one.toml", &format!("{device}{play}{fit}"));
        write("was.csv", &with_play(4000, 1.8e-3));
        write("is.csv", &with_play(2000, 3.2e-3));
        let words = "watch --device one.toml --once --reference-s 100 --reference was.csv --lines json --out alarm is.csv";
        let output = haptical()
            .current_dir(folder.path())
            .args(words.split(' '))
            .output()
            .unwrap();
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(4), "{said}");
        let mut lines = said
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap());
        let cause = lines.find(|line| line["event"] == "cause").unwrap();
        assert_eq!(cause["effect"], "backlash", "{cause}");
        let answer = cause["answer"].as_str().unwrap();
        assert!(
            answer.contains("more than the 1.80 mrad of the earlier model"),
            "{answer}"
        );
        let gap = std::fs::read_to_string(folder.path().join("alarm/gap.json")).unwrap();
        let gap: Value = serde_json::from_str(&gap).unwrap();
        let own = &gap["causes"][0];
        let width_rad = own["parameters"]["width_rad"]["value"].as_f64().unwrap();
        assert!((width_rad - 3.2e-3).abs() < 5e-5, "{own}");
        assert_eq!(
            (&own["joint"], &own["earlier"]["width_rad"]),
            (&1.into(), &1.8e-3.into())
        );
        let corrected =
            std::fs::read_to_string(folder.path().join("alarm/corrected.toml")).unwrap();
        let widths = corrected.lines().filter(|line| {
            line.starts_with("width_rad = 0.0032") || line.starts_with("width_rad = 0.0031")
        });
        assert_eq!(widths.count(), 1, "{corrected}");
    }
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    std::fs::write(folder.path().join("log.csv"), rows(300, 300, 0.0)).unwrap();
    for (arguments, said) in [
        (
            vec!["watch", "--device", "one.toml", "none.csv"],
            "cannot be read",
        ),
        (
            vec![
                "watch",
                "--device",
                "one.toml",
                "--once",
                "--tolerance",
                "cable=1e-4",
                "log.csv",
            ],
            "no such channel",
        ),
        (
            vec![
                "watch",
                "--device",
                "one.toml",
                "--once",
                "--tolerance",
                "cable",
                "log.csv",
            ],
            "as in cable=1e-4",
        ),
        (
            vec![
                "watch",
                "--device",
                "one.toml",
                "--once",
                "--reference",
                "log.csv",
                "log.csv",
            ],
            "300 rows are too few for a reference, which needs 1600: record at least 160 s",
        ),
    ] {
        let output = haptical()
            .current_dir(folder.path())
            .args(&arguments)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            text(&output.stderr).contains(said),
            "{}",
            text(&output.stderr)
        );
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_with_a_summary() {
    use std::io::Read as _;
    use std::process::{Command, Stdio};

    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    std::fs::write(folder.path().join("log.csv"), rows(3000, 3000, 0.0)).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_haptical"))
        .current_dir(folder.path())
        .args([
            "watch",
            "--device",
            "one.toml",
            "--reference-s",
            "100",
            "--every-s",
            "0.1",
            "log.csv",
        ])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // until a second state says that all rows were read
    let mut output = child.stdout.take().unwrap();
    let mut said = String::new();
    let mut byte = [0];
    while !said.contains("\"rows\":3000") {
        assert_eq!(output.read(&mut byte).unwrap(), 1, "{said}");
        said.push(char::from(byte[0]));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    output.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let last: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    assert_eq!(
        (last["event"].as_str(), last["verdict"].as_str()),
        (Some("end"), Some("true"))
    );
}

/// An arm that rests shows one error of the model for as long as it rests: that is no alarm. An alarm at the end of a log, with too
/// few rows to seek its cause, ends with its answer.
#[test]
fn a_rest_is_no_alarm_and_an_alarm_at_the_end_is_answered() {
    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    let resting = |rest: std::ops::Range<usize>| {
        let plain = rows(4000, 4000, 0.0);
        let mut lines = plain.lines();
        let mut text = format!("{}\n", lines.next().unwrap());
        let mut held = (0.0, 0.0);
        for (row, line) in lines.enumerate() {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let [t_s, theta_rad, out_rad] = cells[..] else {
                panic!("{line}");
            };
            // a reading of 1.7 standard deviations that stays
            if row <= rest.start {
                held = (theta_rad, theta_rad + 1.7e-4);
            }
            let (theta_rad, out_rad) = match rest.contains(&row) {
                true => held,
                false => (theta_rad, out_rad),
            };
            writeln!(text, "{t_s},{theta_rad},{out_rad}").unwrap();
        }
        text
    };
    let watched = |log: String| {
        let output = haptical()
            .current_dir(folder.path())
            .args(["watch", "--device", "one.toml", "--reference-s", "100", "-"])
            .write_stdin(log)
            .output()
            .unwrap();
        let lines: Vec<Value> = text(&output.stdout)
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        (output.status.code(), lines.last().unwrap()["event"].clone())
    };
    assert_eq!(watched(resting(2000..3000)), (Some(0), "end".into()));
    assert_eq!(watched(rows(3004, 2980, 5e-3)), (Some(4), "end".into()));
}

/// Rows that cannot be read are none that are true, and a file of another program is named.
#[test]
fn what_is_left_out_is_not_answered_for() {
    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    let sound = rows(4000, 4000, 0.0);
    let bad = sound
        .lines()
        .enumerate()
        .map(|(place, line)| match place > 3000 {
            true => format!("{},nan\n", line.rsplit_once(',').unwrap().0),
            false => format!("{line}\n"),
        });
    std::fs::write(folder.path().join("bad.csv"), bad.collect::<String>()).unwrap();
    std::fs::write(folder.path().join("old.bag"), "#ROSBAG V2.0\n").unwrap();
    for (file, said) in [
        ("bad.csv", "1000 rows of 4000 are left out"),
        ("old.bag", "a ROS 1 bag"),
    ] {
        let output = haptical()
            .current_dir(folder.path())
            .args(["watch", "--device", "one.toml", "--reference-s", "100"])
            .args(["--once", "--lines", "text", file])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(3), "{file}");
        let all = format!("{}{}", text(&output.stdout), text(&output.stderr));
        assert!(all.contains(said), "{file}: {all}");
    }
}

/// A log with nothing to judge behind a sound reference is not true: whatever is missing, the answer is that nothing was judged.
#[test]
fn nothing_to_judge_is_not_true() {
    let folder = tempfile::tempdir().unwrap();
    device(folder.path());
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let sound = rows(4000, 4000, 0.0);
    write("was.csv", &sound);
    let header = sound.lines().next().unwrap();
    let lines = |count: usize| sound.split_inclusive('\n').take(count).collect::<String>();
    let unreadable: String = (0..60).map(|row| format!("{row},ERR,ERR\n")).collect();
    std::fs::create_dir(folder.path().join("incoming")).unwrap();
    for (name, text, rows) in [
        ("none.csv", String::new(), 0),
        ("header.csv", format!("{header}\n"), 0),
        ("unreadable.csv", format!("{header}\n{unreadable}"), 0),
        ("one.csv", lines(2), 1),
        ("few.csv", lines(101), 100),
        ("-", String::new(), 0),
        ("-", lines(51), 50),
        ("incoming", String::new(), 0),
    ] {
        if name.ends_with("csv") {
            write(name, &text);
        }
        for form in ["text", "json"] {
            let output = haptical()
                .current_dir(folder.path())
                .args(["watch", "--device", "one.toml", "--reference-s", "100"])
                .args(["--reference", "was.csv", "--once", "--lines", form, name])
                .write_stdin(text.clone())
                .output()
                .unwrap();
            let said = self::text(&output.stdout);
            assert_eq!(output.status.code(), Some(3), "{name}: {said}");
            assert!(!said.contains("is true"), "{name}: {said}");
            let why = format!("othing was judged: {rows} rows behind the reference are too few");
            assert!(said.contains(&why), "{name}: {said}");
            if form == "json" {
                let end: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
                assert_eq!(end["verdict"], "not-judged", "{end}");
            }
        }
    }
}

/// Two joints at 100 Hz, read in counts of 0.3 mrad without other noise; every 150 s the second one creeps for four seconds.
fn creeping(seconds: u32, start: f64) -> String {
    let count_rad = 3e-4;
    let read = |angle_rad: f64| count_rad * (angle_rad / count_rad).round();
    let mut text = "t_s,theta1_rad,theta2_rad,out1_rad,out2_rad\n".to_owned();
    let (mut first, mut second) = (0.5 * start, 0.37 * start);
    for row in 0..100 * seconds {
        let t_s = f64::from(row) / 100.0;
        let creeps = (t_s + 20.0 * start) % 150.0 < 4.0;
        second += if creeps { 4e-6 } else { 1.3e-2 };
        first += 9e-3;
        let angles = [
            0.8 * f64::sin(first) + 0.3 * f64::sin(2.55 * first + 1.0),
            0.6 * f64::sin(second),
        ];
        let [a, b] = angles;
        let [c, d] = angles.map(read);
        writeln!(text, "{t_s},{a:.7},{b:.7},{c:.7},{d:.7}").unwrap();
    }
    text
}

/// Of a joint that creeps an encoder has the same error of rounding row after row, the more the more rows a second has.
#[test]
fn counts_of_a_joint_that_creeps_are_no_alarm() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let joint =
        |name: &str| format!("[[joint]]\nname = \"{name}\"\nexternal_encoder_sd_rad = 1e-4\n");
    write("two.toml", &(joint("one") + &joint("two")));
    write("was.csv", &creeping(600, 0.0));
    for (start, zero_rad, status) in [
        (1.0, 0.0, 0),
        (2.0, 0.0, 0),
        (3.0, 0.0, 0),
        (4.0, 0.0, 0),
        (4.0, 1e-4, 4),
    ] {
        let log = creeping(300, start);
        let mut lines = log.lines();
        let mut text = format!("{}\n", lines.next().unwrap());
        for (row, line) in lines.enumerate() {
            let (rest, last) = line.rsplit_once(',').unwrap();
            let moved_rad = if row < 15_000 { 0.0 } else { zero_rad };
            writeln!(text, "{rest},{}", last.parse::<f64>().unwrap() + moved_rad).unwrap();
        }
        write("is.csv", &text);
        let output = haptical()
            .current_dir(folder.path())
            .args(["watch", "--device", "two.toml", "--reference-s", "500"])
            .args([
                "--reference",
                "was.csv",
                "--once",
                "--lines",
                "json",
                "is.csv",
            ])
            .output()
            .unwrap();
        let said = self::text(&output.stdout);
        assert_eq!(output.status.code(), Some(status), "{start}: {said}");
        if status == 4 {
            let mut lines = said
                .lines()
                .map(|line| serde_json::from_str::<Value>(line).unwrap());
            let alarm = lines.find(|line| line["event"] == "alarm").unwrap();
            let [from, to] = [0, 1].map(|end| alarm["since_ci95_s"][end].as_f64().unwrap());
            assert!(from <= 150.0 && 150.0 <= to, "{alarm}");
            assert!(alarm["seen_s"].as_f64().unwrap() < 165.0, "{alarm}");
            assert_eq!(alarm["channels"][0]["channel"], "out2");
        }
    }
}

/// A minute and a half at 100 Hz of a calibrated arm is a reference, a further minute is true, and a joint whose zero has moved by 1 mrad is named.
/// What the calibration leaves follows the posture, so that blocks of a second still share a part of it.
#[test]
fn a_calibrated_arm_is_watched_at_100_rows_a_second() {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/devices");
    let nominal = fixtures.join("haptic7.toml").display().to_string();
    let run = |words: &str| {
        let output = haptical()
            .current_dir(folder.path())
            .args(words.split(' '))
            .args([
                "--device",
                if words.starts_with("watch") {
                    "id/identified.toml"
                } else {
                    &nominal
                },
            ])
            .output()
            .unwrap();
        (
            output.status.code(),
            text(&output.stdout) + &text(&output.stderr),
        )
    };
    let truth = std::fs::read_to_string(fixtures.join("haptic7-deviating.toml")).unwrap();
    let moved = truth.replace("theta_offset_rad = 0.0017", "theta_offset_rad = 0.0027");
    assert_ne!(truth, moved);
    std::fs::write(folder.path().join("truth.toml"), truth).unwrap();
    std::fs::write(folder.path().join("moved.toml"), moved).unwrap();
    for (truth, seconds, seed, name) in [
        ("truth", 120, 2, "base"),
        ("truth", 90, 3, "good"),
        ("truth", 60, 11, "clean"),
        ("moved", 60, 12, "off"),
    ] {
        let words = format!(
            "simulate --truth {truth}.toml --seconds {seconds} --rate-hz 100 --seed {seed} --out {name}.csv"
        );
        assert_eq!(run(&words).0, Some(0));
    }
    assert_eq!(run("identify --log base.csv --out id").0, Some(0));
    let watched = |log: &str| {
        run(&format!(
            "watch --reference good.csv --once --lines text {log}"
        ))
    };
    let (status, said) = watched("clean.csv");
    assert_eq!(status, Some(0), "{said}");
    let (status, said) = watched("off.csv");
    assert_eq!(status, Some(4), "{said}");
    assert!(said.contains("joint-offset at joint 2"), "{said}");
}

/// Noise that has grown to what the device file states is an alarm, as it was less in the reference, and no gap: both are said.
#[test]
fn an_alarm_without_a_gap_says_what_both_mean() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "one.toml",
        "[[joint]]\nname = \"one\"\nexternal_encoder_sd_rad = 2.5e-4\n",
    );
    write("was.csv", &rows(4000, 4000, 0.0));
    let plain = rows(1500, 1500, 0.0);
    let mut lines = plain.lines();
    let mut noisy = format!("{}\n", lines.next().unwrap());
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [t_s, theta_rad, out_rad] = cells[..] else {
            panic!("{line}");
        };
        let out_rad = theta_rad + 2.5 * (out_rad - theta_rad);
        writeln!(noisy, "{t_s},{theta_rad},{out_rad}").unwrap();
    }
    write("is.csv", &noisy);
    let output = haptical()
        .current_dir(folder.path())
        .args(["watch", "--device", "one.toml", "--reference-s", "100"])
        .args([
            "--reference",
            "was.csv",
            "--once",
            "--lines",
            "json",
            "is.csv",
        ])
        .output()
        .unwrap();
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(4), "{said}");
    let mut lines = said
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let cause = lines.find(|line| line["event"] == "cause").unwrap();
    assert_eq!(cause["verdict"], "no-gap", "{cause}");
    assert_eq!(cause["effect"], Value::Null, "{cause}");
    let answer = cause["answer"].as_str().unwrap();
    assert!(
        answer.contains("The alarm and the diagnosis differ"),
        "{answer}"
    );
    assert!(!answer.contains("No gap"), "{answer}");
}
