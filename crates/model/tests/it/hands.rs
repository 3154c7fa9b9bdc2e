//! Tools on a hand and tracker places of runs: read, named, set, written and read again; what is odd is refused.

use haptical_model::{Device, Mount, ParameterId, Recording, SurroundingParameter};

const FILE: &str = r#"
[[link]]
a_m = 0.1
alpha_rad = 0.3
d_m = 0.2
[[link]]
a_m = 0.3
alpha_rad = -0.4
d_m = 0.1
[[joint]]
[tracker]
base = "per-run"
tool = "unknown"
[[tracker.base_of_run]]
run = -3
xyz_m = [1.0, 2.0, 3.0]
wxyz = [0.6, 0.0, 0.8, 0.0]
[[tool]]
id = "ball" # on the wrist
xyz_m = [0.01, 0.02, 0.03]
[[tool]]
id = "probe"
xyz_m = [0.1, 0.2, 0.3]
wxyz = [0.8, 0.6, 0.0, 0.0]
[[tool]]
id = "late"
from_line = 5
"#;

fn load(text: &str) -> Device {
    let loaded = Device::from_toml(text, "hand.toml").unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    loaded.device
}

fn names(device: &Device) -> Vec<String> {
    let all = device.surrounding_parameters().into_iter();
    all.map(|parameter| parameter.name(device)).collect()
}

#[test]
fn parameters_are_named_by_run_and_tool_and_only_what_turns_has_turns() {
    let device = load(FILE);
    let expected = [
        "tracker_base.-3.x",
        "tracker_base.-3.y",
        "tracker_base.-3.z",
        "tracker_base.-3.rx",
        "tracker_base.-3.ry",
        "tracker_base.-3.rz",
        "tool.ball.x",
        "tool.ball.y",
        "tool.ball.z",
        "tool.probe.x",
        "tool.probe.y",
        "tool.probe.z",
        "tool.probe.rx",
        "tool.probe.ry",
        "tool.probe.rz",
    ];
    assert_eq!(names(&device), expected);
    let parameter = device.parameter("tool.probe.y").unwrap();
    assert_eq!(parameter.value(&device), 0.2);
    assert_eq!(parameter.key(&device), "tool[probe].xyz_m[1]");
    let parameter = device.parameter("tracker_base.-3.rx").unwrap();
    assert_eq!(parameter.unit(&device), "rad");
    assert_eq!(parameter.key(&device), "tracker.base_of_run[-3].wxyz");
}

#[test]
fn what_a_calibration_set_is_written_and_read_again() {
    let mut device = load(FILE);
    for (index, parameter) in device.surrounding_parameters().into_iter().enumerate() {
        parameter.set(&mut device, 0.01 * (index as f64 + 1.0));
    }
    let late = SurroundingParameter::Tool { tool: 2, index: 0 };
    assert!(late.value(&device).is_nan(), "it has no place");
    let settled = Device {
        surroundings: device.surroundings.settled(),
        ..device.clone()
    };
    let text = device.to_toml(FILE, "hand.toml").unwrap();
    let again = load(&text);
    assert_eq!(again.surroundings, settled.surroundings);
    assert_eq!(again.tracker, device.tracker);
    let text = device.to_new_toml().unwrap();
    let again = load(&text);
    assert_eq!(again.surroundings, settled.surroundings);
    assert_eq!(again.tracker, device.tracker);
    let moved = |index: usize| {
        let parameter = ParameterId::Surrounding(SurroundingParameter::Tool { tool: 0, index });
        parameter.value(&again)
    };
    assert_eq!([moved(0), moved(1), moved(2)], [0.07, 0.08, 0.09]);
}

#[test]
fn rows_are_about_their_own_tool_and_run() {
    let mut device = load(FILE);
    let ids = ["", "ball", "probe"];
    let recording = Recording {
        line: vec![2, 3, 4],
        joint: vec![vec![0.0; 3]],
        position_m: Some([(); 3].map(|()| vec![0.0; 3])),
        tool: Some(ids.map(str::to_owned).to_vec()),
        run: Some(vec![-3; 3]),
        ..Recording::default()
    };
    let mounts = device.mounts(&recording).unwrap();
    let mount = |tool: Option<usize>| Mount {
        base: Some(0),
        tool,
    };
    assert_eq!(mounts, [mount(None), mount(Some(0)), mount(Some(1))]);
    let lost = device.mounts(&Recording {
        run: Some(vec![-3, -3, 4]),
        ..recording.clone()
    });
    let lost = lost.unwrap_err();
    assert_eq!((lost.row, lost.column, lost.id.as_str()), (2, "run", "4"));
    // a place that nobody knows is no place on the handle
    let late = Recording {
        tool: None,
        line: vec![2, 5, 6],
        ..recording.clone()
    };
    assert_eq!(device.tool_at(&late, 0), "");
    assert_eq!(device.tool_at(&late, 1), "late");
    let lost = device.mounts(&late).unwrap_err();
    assert_eq!(
        (lost.row, lost.column, lost.id.as_str()),
        (1, "tool", "late")
    );
    // of one place and no tool there is nothing to tell apart
    device.tracker.as_mut().unwrap().base_per_run = false;
    let plain = Recording {
        tool: None,
        line: vec![2, 3, 4],
        ..recording
    };
    assert!(device.mounts(&plain).unwrap().is_empty());
}

#[test]
fn a_rig_file_brings_tools_to_a_device() {
    let device = "[[joint]]\n[[tool]]\nid = \"old\"\n";
    let rig = "[[tool]]\nid = \"new\"\nfrom_line = 7\n";
    let (text, warnings) = Device::with_rig(device, "one.toml", rig, "rig.toml").unwrap();
    assert!(warnings.is_empty());
    let tools = load(&text).surroundings.tools;
    assert_eq!(tools.len(), 1);
    assert_eq!((tools[0].id.as_str(), tools[0].from_line), ("new", Some(7)));
}

#[test]
fn odd_sections_are_refused_with_their_place() {
    let refused = |text: &str| {
        let text = format!("[[joint]]\n{text}");
        Device::from_toml(&text, "odd.toml")
            .unwrap_err()
            .to_string()
    };
    for (text, expected) in [
        ("[tracker]\nbase = \"per run\"\n", "per-run"),
        ("[[tool]]\n", "`id`"),
        ("[[tool]]\nid = \"\"\n", "the handle itself"),
        ("[[tool]]\nid = \"a\"\n[[tool]]\nid = \"a\"\n", "again"),
        (
            "[[tool]]\nid = \"a\"\nfrom_line = 1\n",
            "line 1 has the names",
        ),
        ("[[tool]]\nid = \"a\"\nfrom_line = 2.5\n", "2.5"),
        (
            "[[tool]]\nid = \"a\"\nwxyz = [1.0, 1.0, 0.0, 0.0]\n",
            "unit quaternion",
        ),
        (
            "[tracker]\n[[tracker.base_of_run]]\nxyz_m = [0.0, 0.0, 0.0]\n",
            "`run`",
        ),
        ("[tracker]\n[[tracker.base_of_run]]\nrun = 1\n", "`xyz_m`"),
        (
            "[tracker]\n[[tracker.base_of_run]]\nrun = 1\nxyz_m = [0.0, 0.0, 0.0]\n[[tracker.base_of_run]]\nrun = 1\n",
            "1 again",
        ),
    ] {
        let found = refused(text);
        assert!(found.contains(expected), "{text}{found}");
        assert!(found.contains("odd.toml"), "{found}");
    }
}
