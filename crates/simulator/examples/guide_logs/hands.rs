//! Logs of several things on one hand, one after the other, and of a tracker that is set up anew.

use std::path::Path;

use haptical_simulator::model::kinematics::Pose;
use haptical_simulator::model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_simulator::model::{Device, Origin};

use crate::{Answer, Noise, free_postures, poses, record, see, touch, write};

fn place(position_m: [f64; 3], orientation_wxyz: [f64; 4]) -> Pose {
    let origin = Origin {
        position_m,
        orientation_wxyz,
    };
    origin.pose()
}

/// Three reflectors on the handle, seen one after the other at each posture by a laser tracker.
pub(crate) fn reflectors(truth: &Device, path: &Path) -> Answer<()> {
    let base = place([2.1, 0.7, 1.2], [0.7, -0.1, 0.1, 0.7]);
    let on_hand = [
        ("r1", [0.06, 0.01, 0.02]),
        ("r2", [-0.03, 0.055, 0.025]),
        ("r3", [-0.035, -0.05, 0.03]),
    ];
    let mut noise = Noise::new(5);
    let free = free_postures(truth, 120, 15)?;
    let postures: Vec<Vec<f64>> = free.iter().flat_map(|own| vec![own.clone(); 3]).collect();
    let mut recording = record(truth, &postures, &mut noise)?;
    let mut position = [(); 3].map(|()| Vec::new());
    let mut ids = Vec::new();
    for (pose, (id, on_hand_m)) in poses(truth, &postures)?.iter().zip(on_hand.iter().cycle()) {
        let reflector_m = pose.position_m + pose.rotation * Vector3::from(*on_hand_m);
        let seen_m = base.rotation * reflector_m + base.position_m;
        for (column, part) in position.iter_mut().zip(seen_m.iter()) {
            column.push(part + noise.normal(3e-5));
        }
        ids.push((*id).to_owned());
    }
    (recording.position_m, recording.tool) = (Some(position), Some(ids));
    write(&recording, path)
}

/// Four sessions of a tracker that was packed away between them; the marker stayed on.
pub(crate) fn stands(truth: &Device, path: &Path) -> Answer<()> {
    let tool = place([0.03, -0.02, 0.05], [0.5, -0.3, 0.1, 0.8]);
    let bases = [
        place([1.4, -0.6, 1.9], [0.5, 0.1, -0.7, 0.5]),
        place([1.5, -0.4, 1.7], [0.5, 0.1, -0.5, 0.7]),
        place([-0.8, 1.2, 1.5], [0.1, 0.7, 0.1, 0.7]),
        place([1.4, -0.6, 1.9], [0.5, 0.1, -0.7, 0.5]),
    ];
    let mut noise = Noise::new(6);
    let postures = free_postures(truth, 200, 16)?;
    let mut recording = record(truth, &postures, &mut noise)?;
    let run = |row: usize| row * bases.len() / postures.len();
    let places: Vec<(Pose, Pose)> = (0..postures.len())
        .map(|row| {
            let mut base = bases[run(row)];
            // the last one seems to stand where the first one stood
            base.position_m.x += if run(row) == 3 { 1.5e-3 } else { 0.0 };
            (base, tool)
        })
        .collect();
    see(
        &mut recording,
        &poses(truth, &postures)?,
        &places,
        &mut noise,
    );
    recording.run = Some((0..postures.len()).map(|row| run(row) as i64 + 1).collect());
    write(&recording, path)
}

/// Two sockets 200 mm apart: the handle's own ball reaches the right one alone, a longer one that is put on reaches both.
pub(crate) fn balls(truth: &Device, path: &Path) -> Answer<()> {
    let mut longer = truth.clone();
    longer.origins = vec![None; truth.links.len() + 1];
    longer.origins[truth.links.len()] = Some(Origin {
        position_m: [0.012, -0.02, 0.06],
        ..Origin::IDENTITY
    });
    let home = poses(truth, &[vec![0.0; truth.joints.len()]])?;
    let middle = home.first().ok_or("no pose")?.position_m;
    let along = Vector3::new(0.6, 0.1, -0.8).normalize();
    let sockets = [("left", -0.15), ("right", 0.05)];
    let mut noise = Noise::new(7);
    let (mut postures, mut ids) = (Vec::new(), Vec::new());
    for (device, seed) in [(truth, 17), (&longer, 18)] {
        for (id, shift_m) in sockets {
            let socket_m = middle + along * shift_m;
            let starts = free_postures(truth, 1000, seed)?;
            let all = starts.iter().filter_map(|start| {
                let uneven_m = Vector3::zeros().map(|_: f64| noise.normal(2e-5));
                touch(device, start, &Matrix3::identity(), &(socket_m + uneven_m))
            });
            let touched: Vec<Vec<f64>> = all.take(60).collect();
            ids.extend(vec![id.to_owned(); touched.len()]);
            postures.extend(touched);
        }
    }
    let mut recording = record(truth, &postures, &mut noise)?;
    recording.contact = Some(ids);
    write(&recording, path)
}
