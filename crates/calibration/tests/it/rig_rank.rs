//! How much each rig fixes: counts of geometry against the judgement, and what is refused.

use haptical_calibration::{
    CalibrationError, DeviceProblem, HeldOut, Options, Weights, calibrate, candidate_parameters,
    channels, identifiability_at, prepare_device,
};
use haptical_identification::{Identifiability, IdentifiabilityRules, Status};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{ContactPair, Device, PlanePair, Recording};

use crate::chain::pseudo_random;
use crate::rig_scene::{
    Target, add_touches, placement, plain, readings, table, touches, tracked, two_points,
    unknown_tracker,
};

pub(crate) fn judge(device: &Device, recording: &Recording) -> Identifiability {
    let prepared = prepare_device(device, recording).unwrap();
    let channels = channels(&prepared, recording).unwrap();
    let parameters = candidate_parameters(&prepared);
    let weights = Weights::stated(&prepared, &channels);
    let rules = IdentifiabilityRules::default();
    identifiability_at(
        &prepared,
        recording,
        &channels,
        &parameters,
        &weights,
        &rules,
    )
    .unwrap()
}

fn statuses<'j>(judged: &'j Identifiability, name: &str) -> &'j Status {
    let index = judged.names.iter().position(|other| other == name).unwrap();
    &judged.statuses[index]
}

/// A point of n joints has 4 n + 3 numbers: four for each axis, three for the tool's tip. A socket adds its three
/// coordinates, and takes away six for the place of the whole and one for its size.
#[test]
fn touches_fix_as_much_as_geometry_allows() {
    let device = table(5);
    let expected = 4 * 5 + 3;
    let points = two_points(&device);
    let mut one = plain(vec![Vec::new(); 5]);
    add_touches(
        &mut one,
        &touches(&device, &Target::Point(points[0]), 40, 1),
        "left",
        false,
    );
    let judged = judge(&device, &one);
    assert_eq!((judged.rank, judged.is_clear()), (expected + 3 - 7, true));
    for axis in ["x", "y", "z"] {
        assert!(statuses(&judged, &format!("contact.left.{axis}")).is_independent());
    }
    // where the whole is placed is what is dependent
    for name in ["alpha0", "theta0", "d0"] {
        assert!(
            matches!(statuses(&judged, name), Status::Dependent { .. }),
            "{name}"
        );
    }

    // a second socket at a known distance fixes the size
    let mut two = one.clone();
    add_touches(
        &mut two,
        &touches(&device, &Target::Point(points[1]), 40, 2),
        "right",
        false,
    );
    let unpaired = judge(&device, &two);
    assert_eq!(unpaired.rank, expected + 6 - 7);
    let mut paired = device.clone();
    paired.contact_pairs = vec![ContactPair {
        a: "left".to_owned(),
        b: "right".to_owned(),
        distance_m: 0.05,
        sd_m: 1e-5,
    }];
    assert_eq!(judge(&paired, &two).rank, expected + 6 - 6);

    // a plane has three numbers, and the same seven directions stay open
    let normal = Vector3::new(0.2, -0.1, 1.0).normalize();
    let target = Target::Plane(normal, normal.dot(&points[0]));
    let mut plane = plain(vec![Vec::new(); 5]);
    add_touches(&mut plane, &touches(&device, &target, 80, 3), "table", true);
    assert_eq!(judge(&device, &plane).rank, expected + 3 - 7);

    // a tracker at an unknown place sees sizes: the place alone is open
    let mut tracked_device = device.clone();
    unknown_tracker(&mut tracked_device);
    let mut seen = plain(readings(&device, 60, 1.5, 4));
    let mut truth = tracked_device.clone();
    truth.surroundings.tracker_base = Some(placement(1, 1.0, 0.0));
    truth.surroundings.tracker_tool = Some(placement(2, 0.1, 0.0));
    tracked(&truth, &mut seen, 0.0, 1);
    assert_eq!(judge(&tracked_device, &seen).rank, 4 * 5 + 6);
    seen.orientation_wxyz = None;
    assert_eq!(judge(&tracked_device, &seen).rank, 4 * 5 + 3);
}

/// The residuals' size must not seem to tell what touches cannot: the rank is the same 5 mm away from the
/// solution, but for the turn of the base about its own first axis.
#[test]
fn the_rank_of_touches_hardly_depends_on_the_residuals() {
    let device = table(5);
    let points = two_points(&device);
    let mut recording = plain(vec![Vec::new(); 5]);
    add_touches(
        &mut recording,
        &touches(&device, &Target::Point(points[0]), 40, 1),
        "left",
        false,
    );
    add_touches(
        &mut recording,
        &touches(&device, &Target::Point(points[1]), 40, 2),
        "right",
        false,
    );
    let mut paired = device.clone();
    paired.contact_pairs = vec![ContactPair {
        a: "left".to_owned(),
        b: "right".to_owned(),
        distance_m: 0.05,
        sd_m: 1e-5,
    }];
    let exact = judge(&paired, &recording).rank;
    for (row, link) in paired.links.iter_mut().enumerate() {
        link.a_m += 5e-3 * pseudo_random(3, row as u64);
        link.alpha_rad += 1e-2 * pseudo_random(4, row as u64);
    }
    let away = judge(&paired, &recording).rank;
    assert!(away - exact <= 1, "{away} for {exact}");
}

#[test]
fn planes_at_a_known_angle_and_a_fixture_pull_the_device_right() {
    let device = table(5);
    let mut recording = plain(vec![Vec::new(); 5]);
    let point = two_points(&device)[0];
    let normals = [Vector3::new(0.1, 0.0, 1.0).normalize(), Vector3::y()];
    let normals = [
        normals[0],
        (normals[1] - normals[0] * normals[0].dot(&normals[1])).normalize(),
    ];
    for ((id, normal), seed) in ["table", "wall"].iter().zip(normals).zip(1..) {
        let target = Target::Plane(normal, normal.dot(&point));
        add_touches(
            &mut recording,
            &touches(&device, &target, 60, seed),
            id,
            true,
        );
    }
    let free = judge(&device, &recording).rank;
    let mut squared = device.clone();
    squared.surroundings.plane_pairs = vec![PlanePair {
        a: "table".to_owned(),
        b: "wall".to_owned(),
        angle_rad: std::f64::consts::FRAC_PI_2,
        sd_rad: 1e-5,
    }];
    // the rank is that of one plane and three numbers more; the angle is no new direction, but a check
    assert_eq!(free, 4 * 5 + 3 + 6 - 7);
    assert_eq!(judge(&squared, &recording).rank, free);
    // the normals' angle comes out as stated even where the start says otherwise
    let prepared = prepare_device(&squared, &recording).unwrap();
    let found: Vec<Vector3<f64>> = prepared
        .surroundings
        .planes
        .iter()
        .map(|plane| plane.normal_and_slopes().0)
        .collect();
    assert!(found[0].dot(&found[1]).abs() < 1e-9);

    // a fixture tells a joint's offset that touches alone cannot
    let name = "theta1";
    assert!(!matches!(
        statuses(&judge(&device, &recording), name),
        Status::Identifiable { .. }
    ));
    let mut column = vec![f64::NAN; recording.len()];
    column[3] = recording.joint[0][3] + device.links[1].theta_rad;
    recording
        .covariates
        .push(("fixture1_rad".to_owned(), column));
    let judged = judge(&device, &recording);
    assert_eq!(judged.rank, free + 1);
    assert!(matches!(
        statuses(&judged, name),
        Status::Identifiable { .. }
    ));
}

#[test]
fn what_a_rig_cannot_serve_is_refused_in_words() {
    let device = table(4);
    let point = two_points(&device)[0];
    let mut recording = plain(vec![Vec::new(); 4]);
    add_touches(
        &mut recording,
        &touches(&device, &Target::Point(point), 40, 1),
        "socket",
        false,
    );
    let options = Options {
        held_out: HeldOut::None,
        ..Options::default()
    };
    let mut paired = device.clone();
    paired.contact_pairs = vec![ContactPair {
        a: "socket".to_owned(),
        b: "sokcet".to_owned(),
        distance_m: 0.05,
        sd_m: 1e-4,
    }];
    let refused = calibrate(&paired, &recording, &options).unwrap_err();
    let said = refused.to_string();
    assert!(matches!(refused, CalibrationError::Rig { .. }), "{said}");
    assert!(
        said.contains("`sokcet`") && said.contains("`socket`"),
        "{said}"
    );
    paired.contact_pairs[0].b = "socket".to_owned();
    let said = calibrate(&paired, &recording, &options)
        .unwrap_err()
        .to_string();
    assert!(said.contains("twice"), "{said}");

    let mut thin = recording.clone();
    thin.plane = Some(vec![String::new(); 40]);
    thin.plane.as_mut().unwrap()[..3].fill("table".to_owned());
    let said = calibrate(&device, &thin, &options).unwrap_err().to_string();
    assert!(
        said.contains("`table`") && said.contains("3 rows"),
        "{said}"
    );

    // one socket and no length: one is held, and it is said which
    let calibration = calibrate(&device, &recording, &options).unwrap();
    let said = calibration.warnings.join("\n");
    assert!(
        said.contains("do not tell a device from a larger one"),
        "{said}"
    );
    let longest = (1..5)
        .max_by(|a, b| device.links[*a].a_m.total_cmp(&device.links[*b].a_m))
        .unwrap();
    assert!(said.contains(&format!("a{longest} is held")), "{said}");
    assert_eq!(
        calibration.device.links[longest].a_m.to_bits(),
        device.links[longest].a_m.to_bits()
    );

    // a device that was not prepared
    let channels = channels(&device, &recording).unwrap();
    let weights = Weights::stated(&device, &channels);
    let refused = DeviceProblem::new(&device, &recording, &channels, &[], &weights).unwrap_err();
    assert!(
        matches!(refused, CalibrationError::UnknownTouch { line: 2, .. }),
        "{refused}"
    );

    for count in [0, 1, 101] {
        let options = Options {
            held_out: HeldOut::Folds(count),
            ..Options::default()
        };
        let refused = calibrate(&device, &recording, &options).unwrap_err();
        assert!(
            matches!(refused, CalibrationError::Option { .. }),
            "{refused}"
        );
    }
}
