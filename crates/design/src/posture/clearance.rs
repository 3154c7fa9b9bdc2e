//! Distances between the links of an arm, each a capsule between two frames.

use haptical_model::kinematics::nalgebra::Vector3;

/// Frames nearer than this are one point: a row without length carries no link \[m\].
const SAME_POINT_M: f64 = 1e-6;

/// Least distance between the surfaces of two links that are no neighbours \[m\]; negative where they overlap,
/// infinite where there are no such links. Links joined by less than two radii are neighbours too: they overlap in every
/// posture, by construction. The links are the straight lines between successive frame origins from
/// the robot's base on (frame (-1) belongs to the measurement, not to the arm), with one radius.
pub(crate) fn clearance_m(origins_m: &[[f64; 3]], radius_m: f64) -> f64 {
    let mut corners: Vec<Vector3<f64>> = Vec::with_capacity(origins_m.len());
    for origin in origins_m.iter().skip(1) {
        let corner = Vector3::from(*origin);
        if corners
            .last()
            .is_none_or(|last| (corner - last).norm() > SAME_POINT_M)
        {
            corners.push(corner);
        }
    }
    let links: Vec<[Vector3<f64>; 2]> = corners.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let mut least = f64::INFINITY;
    for (index, link) in links.iter().enumerate() {
        let mut joined_by_m = 0.0;
        for pair in links[index + 1..].windows(2) {
            joined_by_m += (pair[0][1] - pair[0][0]).norm();
            if joined_by_m >= 2.0 * radius_m {
                least = least.min(distance_m(link, &pair[1]));
            }
        }
    }
    least - 2.0 * radius_m
}

/// Distance between two segments (Ericson 2005, Real-Time Collision Detection, section 5.1.9), both longer
/// than nothing.
fn distance_m(a: &[Vector3<f64>; 2], b: &[Vector3<f64>; 2]) -> f64 {
    let (along, across, between) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (aa, bb, ab) = (along.dot(&along), across.dot(&across), along.dot(&across));
    let (ac, bc) = (along.dot(&between), across.dot(&between));
    let determinant = aa * bb - ab * ab;
    // of parallel ones any point serves to begin with
    let start = match determinant > 0.0 {
        true => ((ab * bc - ac * bb) / determinant).clamp(0.0, 1.0),
        false => 0.0,
    };
    let second = (ab * start + bc) / bb;
    let (first, second) = if second < 0.0 {
        ((-ac / aa).clamp(0.0, 1.0), 0.0)
    } else if second > 1.0 {
        (((ab - ac) / aa).clamp(0.0, 1.0), 1.0)
    } else {
        (start, second)
    };
    (between + along * first - across * second).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossed_segments_are_apart_by_their_common_normal() {
        let a = [Vector3::new(-1.0, 0.0, 0.0), Vector3::new(1.0, 0.0, 0.0)];
        let b = [Vector3::new(0.2, -1.0, 0.3), Vector3::new(0.2, 1.0, 0.3)];
        assert!((distance_m(&a, &b) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn the_distance_is_the_least_over_a_fine_grid() {
        // ends, insides and near parallels, against every pair of points of a grid
        let mut state = 1_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        for case in 0..60 {
            let mut point = || Vector3::new(random(), random(), random());
            let a = [point(), point()];
            let shift = point() * 0.2;
            let b = if case % 3 == 0 {
                [a[0] + shift, a[1] + shift]
            } else {
                [point(), point()]
            };
            let at = |line: &[Vector3<f64>; 2], share: f64| line[0] + (line[1] - line[0]) * share;
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                for j in 0..=200 {
                    let (i, j) = (f64::from(i) / 200.0, f64::from(j) / 200.0);
                    least = least.min((at(&a, i) - at(&b, j)).norm());
                }
            }
            let found = distance_m(&a, &b);
            assert!(
                found <= least + 1e-12 && found > least - 0.01,
                "{found} {least}"
            );
        }
    }

    #[test]
    fn neighbours_do_not_count_and_a_folded_arm_overlaps() {
        let straight = [[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
        assert!(clearance_m(&straight, 0.1).is_infinite());
        let mut folded = straight.to_vec();
        folded.push([0.0, 1.0, 0.0]);
        assert!((clearance_m(&folded, 0.1) - 0.8).abs() < 1e-15);
        folded.push([0.0, 0.1, 0.0]);
        assert!(clearance_m(&folded, 0.1) < 0.0);
    }

    #[test]
    fn links_that_a_short_one_joins_are_neighbours() {
        // an elbow of 70 mm between two links with a radius of 50 mm
        let elbow = [
            [9.0; 3],
            [0.0; 3],
            [0.0, 0.0, 0.3],
            [0.07, 0.0, 0.3],
            [0.07, 0.0, 0.6],
        ];
        assert!(clearance_m(&elbow, 0.05).is_infinite());
        assert!((clearance_m(&elbow, 0.03) - 0.01).abs() < 1e-15);
        // what lies behind still counts: back at the first link
        let mut folded = elbow.to_vec();
        folded.extend([[0.5, 0.0, 0.6], [0.0, 0.0, 0.1]]);
        assert!(clearance_m(&folded, 0.05) < 0.0);
    }
}
