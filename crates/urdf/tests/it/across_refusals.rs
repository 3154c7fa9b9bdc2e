//! Refusals and warnings of chains between two links, and the origins that a corrected file changes.

use haptical_urdf::{BaseAndTip, UrdfError, chain_ends, corrected_urdf, device_from_urdf};

/// A waist with a head, and an arm on either side with a hand.
const FIGURE: &str = r#"<robot name="figure">
  <link name="pelvis"/> <link name="trunk"><inertial><mass value="9"/></inertial></link> <link name="head"/>
  <link name="left_arm"/> <link name="left_hand"/> <link name="left_finger"/> <link name="right_arm"/>
  <link name="right_hand"/> <link name="plate"/>
  <joint name="waist" type="revolute"><origin xyz="0 0 0.1"/><parent link="pelvis"/><child link="trunk"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>
  <joint name="neck" type="continuous"><origin xyz="0 0 0.5"/><parent link="trunk"/><child link="head"/></joint>
  <joint name="left_shoulder" type="revolute"><origin xyz="0 0.2 0.4"/><parent link="trunk"/><child link="left_arm"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="1.5"/></joint>
  <joint name="left_wrist" type="continuous"><origin xyz="0 0 -0.3"/><parent link="left_arm"/><child link="left_hand"/>
    <axis xyz="1 0 0"/></joint>
  <joint name="left_nail" type="fixed"><origin xyz="0 0 -0.1"/><parent link="left_hand"/><child link="left_finger"/></joint>
  <joint name="right_shoulder" type="continuous"><origin xyz="0 -0.2 0.4"/><parent link="trunk"/><child link="right_arm"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="right_wrist" type="continuous"><origin xyz="0 0 -0.3"/><parent link="right_arm"/><child link="right_hand"/>
    <axis xyz="1 0 0"/></joint>
  <joint name="screws" type="fixed"><origin xyz="0 0 -0.1" rpy="0.5 0 0"/><parent link="pelvis"/><child link="plate"/></joint>
</robot>"#;

fn refusal(ends: BaseAndTip<'_>) -> UrdfError {
    device_from_urdf(FIGURE, "figure.urdf", ends).unwrap_err()
}

#[test]
fn what_is_refused_is_typed_and_said() {
    let alone = BaseAndTip {
        base: Some("left_hand"),
        tip: None,
        further_tips: &[],
    };
    let error = refusal(alone);
    assert!(matches!(error, UrdfError::TipMissing { .. }));
    assert_eq!(
        error.to_string(),
        "figure.urdf: the base `left_hand` was named without a tip: name the tip too, with --tip; branches end at \
         `head`, `right_hand`, `plate`"
    );
    let error = refusal(BaseAndTip::between("head", "head"));
    assert!(matches!(error, UrdfError::SameLink { .. }));
    assert_eq!(
        error.to_string(),
        "figure.urdf: `head` is base and tip: name two links with joints that move between them"
    );
    let error = refusal(BaseAndTip::between("left_finger", "left_hand"));
    assert!(matches!(error, UrdfError::Unmoved { .. }));
    assert_eq!(
        error.to_string(),
        "figure.urdf: no joint between `left_finger` and `left_hand` moves: name another --tip"
    );
    for ends in [
        BaseAndTip::between("nose", "head"),
        BaseAndTip::between("head", "nose"),
    ] {
        let error = refusal(ends);
        assert!(matches!(error, UrdfError::UnknownLink { .. }));
        let said = error.to_string();
        assert!(
            said.starts_with("figure.urdf: there is no link `nose`; the links are `pelvis`, "),
            "{said}"
        );
    }
    let apart = FIGURE.replace(
        "<link name=\"plate\"/>",
        "<link name=\"plate\"/><link name=\"table\"/>",
    );
    let named = |base, tip| {
        device_from_urdf(
            &apart,
            "apart.urdf",
            BaseAndTip {
                base,
                tip,
                further_tips: &[],
            },
        )
        .unwrap_err()
    };
    assert_eq!(
        named(Some("table"), Some("head")).to_string(),
        "apart.urdf: no joints lead from `table` to `head`: they are in separate trees"
    );
    assert_eq!(
        named(Some("table"), None).to_string(),
        "apart.urdf: no joint moves between `table` and any other link"
    );
    // a joint with more variables on the way, and only there
    let floating = FIGURE.replace("\"neck\" type=\"continuous\"", "\"neck\" type=\"floating\"");
    let error = device_from_urdf(
        &floating,
        "f.urdf",
        BaseAndTip::between("head", "left_hand"),
    )
    .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("joint `neck` is floating or planar")
    );
    assert!(
        device_from_urdf(
            &floating,
            "f.urdf",
            BaseAndTip::between("right_hand", "left_hand")
        )
        .is_ok()
    );
}

/// From hand to hand: names, limits and order are those of the joints, and nothing weighs anything.
#[test]
fn a_base_that_moves_has_neither_masses_nor_gravity() {
    let read = device_from_urdf(
        FIGURE,
        "figure.urdf",
        BaseAndTip::between("left_finger", "right_hand"),
    )
    .unwrap();
    let joints = read.device.joints.iter();
    let joints: Vec<_> = joints
        .map(|joint| (joint.name.as_str(), joint.lower_rad))
        .collect();
    let none = f64::NEG_INFINITY;
    let (left, right) = (
        [("left_wrist", none), ("left_shoulder", -2.0)],
        [("right_shoulder", none), ("right_wrist", none)],
    );
    assert_eq!(joints, [left, right].concat());
    assert_eq!(read.device.gravity_mps2, None);
    assert!(read.device.bodies.iter().all(Option::is_none));
    assert_eq!(
        read.warnings,
        [
            "figure.urdf: the base `left_finger` moves with respect to the root `pelvis`, so gravity has no fixed \
             direction in frame (-1): masses and gravity are left out; for joints that yield to their torque log the \
             torques, in columns torque1_nm, ...",
            "figure.urdf: left out, because they move beside the chain: `waist`, `neck`"
        ]
    );
    // the device file has them neither
    let written = read.device.to_new_toml().unwrap();
    let again = haptical_model::Device::from_toml(&written, "again.toml")
        .unwrap()
        .device;
    assert_eq!(again, read.device);
    // nothing weighs, so nothing is said of it
    let light = FIGURE.replace("<mass value=\"9\"/>", "");
    let light = light.replace("<inertial></inertial>", "");
    let read = device_from_urdf(
        &light,
        "light.urdf",
        BaseAndTip::between("left_finger", "right_hand"),
    )
    .unwrap();
    assert_eq!(read.warnings.len(), 1, "{:?}", read.warnings);
    assert_eq!(read.device.gravity_mps2, None);
}

#[test]
fn gravity_is_turned_into_the_frame_of_a_base_that_is_fixed() {
    let read =
        device_from_urdf(FIGURE, "figure.urdf", BaseAndTip::between("plate", "head")).unwrap();
    // the plate is turned by 0.5 rad about x: down is along -z turned back
    let (sine, cosine) = 0.5_f64.sin_cos();
    let gravity = read.device.gravity_mps2.unwrap();
    for (found, expected) in gravity.into_iter().zip([0.0, -9.81 * sine, -9.81 * cosine]) {
        assert!((found - expected).abs() < 1e-14, "{gravity:?}");
    }
    let root =
        device_from_urdf(FIGURE, "figure.urdf", BaseAndTip::between("pelvis", "head")).unwrap();
    assert_eq!(
        root,
        device_from_urdf(FIGURE, "figure.urdf", BaseAndTip::to("head")).unwrap()
    );
}

#[test]
fn chains_from_a_base_are_listed() {
    let ends = |base| {
        let ends = chain_ends(FIGURE, "figure.urdf", base).unwrap();
        ends.into_iter()
            .map(|end| (end.tip, end.joints))
            .collect::<Vec<_>>()
    };
    let told = [
        ("trunk", 2),
        ("head", 3),
        ("right_arm", 3),
        ("right_hand", 4),
        ("plate", 3),
        ("left_arm", 1),
    ];
    let mut told = told.map(|(tip, joints)| (tip.to_owned(), joints)).to_vec();
    let mut found = ends(Some("left_finger"));
    told.sort();
    found.sort();
    assert_eq!(found, told);
    assert!(ends(None).contains(&("left_finger".to_owned(), 3)));
    assert!(chain_ends(FIGURE, "figure.urdf", Some("nose")).is_err());
}

/// Lines of a joint's origin in a text.
fn origin<'t>(text: &'t str, joint: &str) -> &'t str {
    let own = &text[text.find(&format!("<joint name=\"{joint}\"")).unwrap()..];
    let own = &own[own.find("<origin").unwrap()..];
    &own[..own.find("/>").unwrap()]
}

/// Which joint takes up what: the base row goes to what is fixed to the base or to an added link, the turning point to
/// the first joint downwards, the end of a chain upwards to the handle.
#[test]
fn a_corrected_file_changes_the_origins_that_it_should() {
    let changed = |base: &str, tip: &str, row: usize| {
        let ends = BaseAndTip::between(base, tip);
        let mut device = device_from_urdf(FIGURE, "figure.urdf", ends)
            .unwrap()
            .device;
        device.links[row].b_m += 0.01;
        let corrected = corrected_urdf(FIGURE, "figure.urdf", ends, &device).unwrap();
        let moved = |joint: &&str| {
            let [before, now] = [FIGURE, &corrected.text].map(|text| numbers(origin(text, joint)));
            before
                .iter()
                .zip(&now)
                .any(|(before, now)| (before - now).abs() > 1e-3)
        };
        let all = [
            "waist",
            "left_shoulder",
            "left_wrist",
            "left_nail",
            "right_shoulder",
            "right_wrist",
        ];
        let moved: Vec<&str> = all.into_iter().filter(|joint| moved(joint)).collect();
        (moved, corrected.base, corrected.tip)
    };
    let told = |moved: &[&'static str], base: &str, tip: &str| {
        (moved.to_vec(), base.to_owned(), tip.to_owned())
    };
    // rows: left_wrist 1, left_shoulder 2, right_shoulder 3, right_wrist 4; a row's numbers are behind its motion
    let fingers = |row| changed("left_finger", "right_hand", row);
    assert_eq!(
        fingers(0),
        told(&["left_nail"], "left_finger", "right_hand_handle")
    );
    assert_eq!(
        fingers(1),
        told(&["left_wrist"], "left_finger", "right_hand_handle")
    );
    assert_eq!(
        fingers(2),
        told(&["right_shoulder"], "left_finger", "right_hand_handle")
    );
    assert_eq!(
        fingers(3),
        told(&["right_wrist"], "left_finger", "right_hand_handle")
    );
    assert_eq!(fingers(4), told(&[], "left_finger", "right_hand_handle"));
    // nothing is fixed to the hand: the base is a link of its own
    assert_eq!(
        changed("left_hand", "right_hand", 0),
        told(&[], "left_hand_base", "right_hand_handle")
    );
    // upwards to the end: the shoulder stays, the handle's link takes it
    assert_eq!(
        changed("left_finger", "trunk", 2),
        told(&[], "left_finger", "trunk_handle")
    );
}

fn numbers(origin: &str) -> Vec<f64> {
    let words = origin.split(['"', ' ']);
    let mut numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    numbers.resize(6, 0.0);
    numbers
}
