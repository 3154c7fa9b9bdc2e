//! The guides of docs/guides and the console blocks of the crates' READMEs are run as they are: every command, and every
//! line that they show.

use std::path::{Path, PathBuf};

use haptical_model::{Device, Evaluation};

use crate::{haptical, text};

/// What a number may differ from the guide's: a held-out error moves by a per cent when a search stops elsewhere, a wrong model
/// by far more.
const RELATIVE: f64 = 0.03;

/// Folders of fixtures/ that a page may name.
const FOLDERS: [&str; 9] = [
    "bad",
    "devices",
    "effects",
    "instruments",
    "logs",
    "measured",
    "rigs",
    "tables",
    "urdf",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A fenced block: its language and its lines.
struct Block {
    language: String,
    lines: Vec<String>,
}

fn blocks(guide: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut open: Option<Block> = None;
    for line in guide.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(language), None) => {
                open = Some(Block {
                    language: language.to_owned(),
                    lines: Vec::new(),
                });
            }
            (Some(_), Some(block)) => found.push(block),
            (None, Some(mut block)) => {
                block.lines.push(line.to_owned());
                open = Some(block);
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    found
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Whether a printed line is what the guide shows: the same words, numbers within the tolerance.
fn is_shown(printed: &str, shown: &str) -> bool {
    let words =
        |line: &str| -> Vec<String> { line.split_whitespace().map(str::to_owned).collect() };
    let (printed, shown) = (words(printed), words(shown));
    let alike = |(have, want): (&String, &String)| match (have.parse::<f64>(), want.parse::<f64>())
    {
        (Ok(have), Ok(want)) => (have - want).abs() <= RELATIVE * want.abs(),
        // numbers within brackets, and words
        _ => have == want,
    };
    printed.len() == shown.len() && printed.iter().zip(&shown).all(alike)
}

/// A fresh folder with a copy of the fixtures.
fn sandbox() -> tempfile::TempDir {
    let sandbox = tempfile::tempdir().unwrap();
    for folder in FOLDERS {
        copy(
            &root().join("fixtures").join(folder),
            &sandbox.path().join("fixtures").join(folder),
        );
    }
    sandbox
}

/// Runs a guide in a folder of its own.
fn run(name: &str) {
    let guide = std::fs::read_to_string(root().join("docs/guides").join(name)).unwrap();
    let sandbox = sandbox();
    let (mut commands, mut shown) = (0, 0);
    let mut printed = String::new();
    for block in blocks(&guide) {
        match block.language.as_str() {
            "sh" => {
                printed.clear();
                for line in &block.lines {
                    let arguments = line.strip_prefix("haptical ");
                    let arguments = arguments.unwrap_or_else(|| panic!("{name}: not ours: {line}"));
                    let output = haptical()
                        .current_dir(sandbox.path())
                        .args(arguments.split_whitespace())
                        .output()
                        .unwrap();
                    let said = text(&output.stderr);
                    // a watch or a doctor that finds what the guide shows says so
                    let finds = ["watch ", "doctor "]
                        .iter()
                        .any(|own| arguments.starts_with(own));
                    let is_alarm = output.status.code() == Some(4) && finds;
                    assert!(
                        output.status.success() || is_alarm,
                        "{name}: {line}\n{said}"
                    );
                    printed.push_str(&text(&output.stdout));
                    printed.push('\n');
                    commands += 1;
                }
            }
            "text" => {
                // in the order in which the guide shows them
                let mut rest = printed.lines();
                for line in &block.lines {
                    let found = rest.any(|own| is_shown(own, line));
                    assert!(
                        found,
                        "{name}: not printed, or not in this order:\n{line}\n{printed}"
                    );
                    shown += 1;
                }
            }
            // what runs on a robot
            "toml" | "python" | "cpp" => {}
            other => panic!("{name}: a block of `{other}`"),
        }
    }
    assert!(commands >= 3, "{name}: {commands} commands");
    assert!(shown >= 2, "{name}: {shown} lines are shown");
}

/// A command of a console block, with the lines shown below it.
struct Shown<'l> {
    arguments: &'l str,
    lines: Vec<&'l str>,
}

/// The commands `haptical` of a console block: `$ haptical ...`, then printed lines, `...` for lines left out.
fn console(block: &Block) -> Vec<Shown<'_>> {
    let mut found = Vec::new();
    let mut is_ours = false;
    for line in &block.lines {
        if let Some(command) = line.strip_prefix("$ ") {
            let arguments = command.strip_prefix("haptical ");
            is_ours = arguments.is_some();
            found.extend(arguments.map(|arguments| Shown {
                arguments,
                lines: Vec::new(),
            }));
        } else if is_ours
            && line != "..."
            && let Some(command) = found.last_mut()
        {
            command.lines.push(line);
        }
    }
    found
}

/// Runs the console blocks of a README in a folder of their own and returns how many commands there are, with the folder.
/// A command whose first shown line is an error fails, every other succeeds.
fn run_console(readme: &Path) -> (usize, Option<tempfile::TempDir>) {
    let page = std::fs::read_to_string(readme).unwrap();
    let blocks = blocks(&page);
    let consoles = blocks.iter().filter(|block| block.language == "console");
    let commands: Vec<Shown<'_>> = consoles.flat_map(console).collect();
    if commands.is_empty() {
        return (0, None);
    }
    let sandbox = sandbox();
    for command in &commands {
        let output = haptical()
            .current_dir(sandbox.path())
            .args(command.arguments.split_whitespace())
            .output()
            .unwrap();
        let fails = command
            .lines
            .first()
            .is_some_and(|line| line.starts_with("error: "));
        let place = format!("{}: haptical {}", readme.display(), command.arguments);
        let printed = text(if fails {
            &output.stderr
        } else {
            &output.stdout
        });
        // a doctor that finds what the page shows says so
        let finds = output.status.code() == Some(4) && command.arguments.starts_with("doctor ");
        assert_eq!(
            !output.status.success() && !finds,
            fails,
            "{place}\n{}",
            text(&output.stderr)
        );
        let mut rest = printed.lines();
        for line in &command.lines {
            assert!(
                rest.any(|own| is_shown(own, line)),
                "{place}: not printed, or not in this order:\n{line}\n{printed}"
            );
        }
    }
    (commands.len(), Some(sandbox))
}

#[test]
fn console_blocks_of_the_crates_readmes_are_true() {
    let mut commands = 0;
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let readme = entry.unwrap().path().join("README.md");
        if readme.exists() {
            commands += run_console(&readme).0;
        }
    }
    assert!(commands >= 10, "{commands} commands");
}

#[test]
fn the_table_names_every_guide() {
    let folder = root().join("docs/guides");
    let table = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut guides = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name == "README.md" {
            continue;
        }
        assert!(table.contains(&format!("]({name})")), "{name}");
        let lines = std::fs::read_to_string(folder.join(&name)).unwrap();
        assert!(lines.lines().count() <= 120, "{name} is long");
        guides += 1;
    }
    // that of the real sets is run in real_sets.rs
    assert_eq!(guides, 26, "add a test for the new guide");
}

#[test]
fn numbers_that_differ_are_seen() {
    assert!(is_shown(
        "│ cable │ µm │  10.06 │",
        "│ cable │ µm │ 10.06 │"
    ));
    assert!(is_shown(
        "│ cable │ µm │  10.061 │",
        "│ cable │ µm │ 10.06 │"
    ));
    assert!(!is_shown(
        "│ cable │ µm │  12.06 │",
        "│ cable │ µm │ 10.06 │"
    ));
    assert!(!is_shown(
        "│ cable2 │ µm │ 10.06 │",
        "│ cable │ µm │ 10.06 │"
    ));
    assert!(!is_shown(
        "51 of 55 parameters",
        "51 of 55 parameters identified"
    ));
}

#[test]
fn one_cable() {
    run("cable.md");
}

#[test]
fn tables_of_any_kind() {
    run("import.md");
}

#[test]
fn two_cables() {
    run("two-cables.md");
}

#[test]
fn a_tracker_in_its_own_frame() {
    run("tracker.md");
}

#[test]
fn several_reflectors_on_one_hand() {
    run("reflectors.md");
}

#[test]
fn a_tracker_place_for_each_run() {
    run("stands.md");
}

#[test]
fn a_tool_that_is_put_on() {
    run("balls.md");
}

#[test]
fn a_ball_in_sockets() {
    run("sockets.md");
}

#[test]
fn plates() {
    run("planes.md");
}

#[test]
fn a_homing_fixture() {
    run("homing-fixture.md");
}

#[test]
fn a_camera_in_the_hand() {
    run("camera.md");
}

#[test]
fn two_arms() {
    run("two-arms.md");
}

#[test]
fn a_moving_arm() {
    run("moving-arm.md");
}

#[test]
fn armature_damping_and_friction_for_mujoco() {
    run("simulator-parameters.md");
}

#[test]
fn industrial_arms() {
    run("industrial-arms.md");
}

#[test]
fn recorders() {
    run("recorders.md");
}

#[test]
fn two_days() {
    run("worked-yesterday.md");
}

#[test]
fn which_part() {
    run("which-part.md");
    // the names of its table are those that answers have
    let listed = haptical()
        .args(["diagnose", "--list", "--json"])
        .output()
        .unwrap();
    let listed: serde_json::Value = serde_json::from_slice(&listed.stdout).unwrap();
    let mut known: Vec<&str> = listed
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own["name"].as_str().unwrap())
        .collect();
    known.extend(["lost-rows", "repeated-rows"]);
    let guide = std::fs::read_to_string(root().join("docs/guides/which-part.md")).unwrap();
    let rows = guide
        .lines()
        .filter(|line| line.starts_with("| ") && line.matches('|').count() == 4);
    let cells = rows.filter_map(|line| line.split('|').nth(2));
    let names: Vec<&str> = cells
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .collect();
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        assert!(known.contains(&name), "{name}");
    }
}

#[test]
fn a_data_set_of_episodes() {
    run("data-set.md");
}

#[test]
fn an_arm_that_is_off() {
    run("arm-is-off.md");
}

#[test]
fn elastic_joints() {
    run("elastic-joints.md");
}

#[test]
fn from_a_gap_to_a_corrected_simulator() {
    run("corrected.md");
}

#[test]
fn a_calibration_that_is_watched() {
    run("watch.md");
}

#[test]
fn an_uncertainty_budget() {
    run("uncertainty-budget.md");
}

#[test]
fn into_the_robot() {
    run("put-into-robot.md");
}

/// The rows that the guide gives for a passive joint keep a trunk upright, and the arm behind takes the next joint.
#[test]
fn a_joint_that_two_others_drive() {
    let guide = root().join("docs/guides/elastic-joints.md");
    let guide = std::fs::read_to_string(guide).unwrap();
    let blocks = blocks(&guide);
    let coupled = blocks.iter().find(|block| block.language == "toml");
    let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n";
    let yaw = "[[link]]\na_m = 0.0\nalpha_rad = 1.5707963267948966\nd_m = 0.0\n";
    let coupled = coupled.unwrap().lines.join("\n");
    let text = format!(
        "[device]\nname = \"trunk\"\n{yaw}{yaw}{row}{row}{coupled}\n{row}{}",
        "[[joint]]\n".repeat(4)
    );
    let loaded = Device::from_toml(&text, "trunk.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    let mut chain = Evaluation::new(&loaded.device);
    let mut turns = Vec::new();
    for readings in [
        [0.3, 0.0, 0.0, 0.0],
        [0.3, 0.4, -0.9, 0.0],
        [0.3, 0.4, -0.9, 0.2],
    ] {
        chain.move_to(&readings).unwrap();
        turns.push(chain.pose().unwrap().rotation);
    }
    assert!((turns[0] - turns[1]).norm() < 1e-12, "it leans");
    let angle = ((turns[0].transpose() * turns[2]).trace() / 2.0 - 0.5).acos();
    assert!((angle - 0.2).abs() < 1e-12, "{angle}");
}

/// The README's commands, the lines that they print, and the words of its picture, which is the first of a diagnosis.
#[test]
fn the_readme_is_true() {
    let (commands, sandbox) = run_console(&root().join("README.md"));
    assert!(commands >= 9, "{commands} commands");
    let read = |path: PathBuf| std::fs::read_to_string(path).unwrap();
    let page = read(sandbox.unwrap().path().join("demo/gap/gap.html"));
    let words = |text: &str| -> Vec<String> {
        let begin = text.find("<svg").unwrap();
        let end = text[begin..].find("</svg>").unwrap();
        let lines = text[begin..begin + end].lines();
        lines
            .filter(|line| !line.starts_with('<'))
            .map(str::to_owned)
            .collect()
    };
    let (made, shown) = (
        words(&page),
        words(&read(root().join("docs/images/gap.svg"))),
    );
    assert!(made.len() == shown.len() && made.len() > 8, "{made:?}");
    for (made, shown) in made.iter().zip(&shown) {
        assert!(is_shown(made, shown), "{made} {shown}");
    }
}
