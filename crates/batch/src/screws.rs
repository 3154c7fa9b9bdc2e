//! Twists of a chain's end with respect to every parameter, some postures at a time in lanes.

use haptical_kinematics::nalgebra::{Matrix3, Vector3};
use haptical_kinematics::{Chain, Motion, Parameter, Pose};
use pulp::{Arch, Simd, WithSimd};

use crate::trigonometry::sines_cosines;

/// Postures of a tile.
pub const POSTURES: usize = 64;
/// A number of every posture of a tile.
pub type Lane = [f64; POSTURES];
/// A vector of every posture, coordinate by coordinate.
type Vectors = [Lane; 3];

/// Coordinates beyond which the lanes do not serve \[m\]: well below where [`Chain::pose`] refuses.
const LARGEST_M: f64 = 1e100;
/// Parameters of a row.
const PARAMETERS: usize = 6;

/// Poses of a tile of postures, and the screws of the parameters that were asked for.
///
/// The numbers are those of [`Chain::derivatives`] but for rounding; a posture's numbers do not depend on the postures
/// next to it.
///
/// ```
/// use haptical_batch::{POSTURES, ScrewTile, TwistLanes};
/// use haptical_kinematics::{Chain, Convention, Link, Motion, Parameter};
/// // one turn of 0.3 m
/// let links = [Link { a_m: 0.3, ..Link::default() }];
/// let chain = Chain::new(Convention::Standard, &links, &[Motion::Revolute])?;
/// let mut tile = ScrewTile::default();
/// assert!(tile.sweep(&chain, &[[0.0; POSTURES]], &[(0, Parameter::Theta)]));
/// let mut twist = TwistLanes::default();
/// tile.twist(0, Parameter::Theta, &mut twist);
/// assert_eq!(twist.linear[1][5], 0.3);
/// assert_eq!(twist.angular[2][5], 1.0);
/// # Ok::<(), haptical_kinematics::KinematicsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScrewTile {
    frame: Frames,
    /// Row by row, parameter by parameter.
    screws: Vec<Screw>,
    is_wanted: Vec<bool>,
    sines: Lane,
    cosines: Lane,
}

/// Direction of a motion and, of a turn, a point on its axis.
#[derive(Debug, Clone, Copy)]
struct Screw {
    axis: Vectors,
    point: Vectors,
}

/// Origins and axes x, y, z.
#[derive(Debug, Clone, Copy)]
struct Frames {
    origin: Vectors,
    axes: [Vectors; 3],
}

/// Twists of every posture of a tile in frame (-1).
#[derive(Debug, Clone, Copy)]
pub struct TwistLanes {
    /// Velocity of the end, coordinate by coordinate.
    pub linear: [Lane; 3],
    /// Angular velocity.
    pub angular: [Lane; 3],
}

impl Default for TwistLanes {
    fn default() -> Self {
        Self {
            linear: [[0.0; POSTURES]; 3],
            angular: [[0.0; POSTURES]; 3],
        }
    }
}

impl Default for ScrewTile {
    fn default() -> Self {
        Self {
            frame: Frames::identity(),
            screws: Vec::new(),
            is_wanted: Vec::new(),
            sines: [0.0; POSTURES],
            cosines: [0.0; POSTURES],
        }
    }
}

fn place_of(row: usize, parameter: Parameter) -> usize {
    PARAMETERS * row + parameter as usize
}

impl ScrewTile {
    /// Works a tile out: `variables` has a lane for each moving row, as [`Chain::pose`] takes its numbers; kept are the
    /// screws of `wanted`, pairs of row and parameter. False where a number is not finite or too large for the lanes.
    ///
    /// # Panics
    /// For a pair of a row that the chain has not.
    pub fn sweep(
        &mut self,
        chain: &Chain<'_>,
        variables: &[Lane],
        wanted: &[(usize, Parameter)],
    ) -> bool {
        let count = PARAMETERS * chain.links().len();
        let none = Screw {
            axis: [[0.0; POSTURES]; 3],
            point: [[0.0; POSTURES]; 3],
        };
        self.screws.resize(count, none);
        self.is_wanted.clear();
        self.is_wanted.resize(count, false);
        for &(row, parameter) in wanted {
            self.is_wanted[place_of(row, parameter)] = true;
        }
        let is_near = |lane: &Lane| lane.iter().all(|value| value.abs() <= LARGEST_M);
        let is_served = variables.len() == chain.joint_count()
            && variables.iter().all(is_near)
            && chain.links().iter().all(|link| {
                let mut numbers = Parameter::ALL.into_iter();
                numbers.all(|parameter| link.get(parameter).abs() <= LARGEST_M)
            });
        if !is_served {
            return false;
        }
        Arch::new().dispatch(Sweep {
            tile: self,
            chain,
            variables,
        });
        self.frame.origin.iter().all(is_near)
    }

    /// Pose of a posture's end.
    ///
    /// # Panics
    /// For a posture beyond the tile.
    pub fn pose(&self, posture: usize) -> Pose {
        let vector = |of: &Vectors| Vector3::from(of.each_ref().map(|lane| lane[posture]));
        Pose {
            position_m: vector(&self.frame.origin),
            rotation: Matrix3::from_columns(&self.frame.axes.each_ref().map(vector)),
        }
    }

    /// Twists of the end by a parameter that the last sweep was asked for.
    ///
    /// # Panics
    /// For a row that the chain has not.
    pub fn twist(&self, row: usize, parameter: Parameter, into: &mut TwistLanes) {
        let screw = &self.screws[place_of(row, parameter)];
        if matches!(parameter, Parameter::A | Parameter::B | Parameter::D) {
            into.linear = screw.axis;
            into.angular = [[0.0; POSTURES]; 3];
        } else {
            Arch::new().dispatch(Turn {
                screw,
                end: &self.frame.origin,
                into,
            });
        }
    }
}

impl TwistLanes {
    /// Adds others times a number.
    pub fn add(&mut self, other: &Self, factor: f64) {
        for (own, other) in self.parts_mut().zip(other.parts()) {
            for (own, other) in own.iter_mut().zip(other) {
                *own += factor * other;
            }
        }
    }

    /// Multiplies each posture's twist by its own number.
    pub fn scale(&mut self, factors: &Lane) {
        for own in self.parts_mut() {
            for (own, factor) in own.iter_mut().zip(factors) {
                *own *= factor;
            }
        }
    }

    /// Products with other lanes, summed over the six coordinates.
    pub fn dot(&self, other: &Self, into: &mut Lane) {
        Arch::new().dispatch(Dot {
            a: self,
            b: other,
            into,
        });
    }

    fn parts(&self) -> impl Iterator<Item = &Lane> {
        self.linear.iter().chain(&self.angular)
    }

    fn parts_mut(&mut self) -> impl Iterator<Item = &mut Lane> {
        self.linear.iter_mut().chain(&mut self.angular)
    }
}

impl Frames {
    fn identity() -> Self {
        let unit = |axis: usize| {
            let mut vectors = [[0.0; POSTURES]; 3];
            vectors[axis] = [1.0; POSTURES];
            vectors
        };
        Self {
            origin: [[0.0; POSTURES]; 3],
            axes: [unit(0), unit(1), unit(2)],
        }
    }

    /// Multiplies the frames from the right by a constant transform.
    #[inline(always)]
    fn place(&mut self, constant: &Pose) {
        let old = *self;
        self.axes =
            [0, 1, 2].map(|column| old.rotate(constant.rotation.column(column).into_owned()));
        let offset = old.rotate(constant.position_m);
        for (own, offset) in self.origin.iter_mut().zip(&offset) {
            for (own, offset) in own.iter_mut().zip(offset) {
                *own += offset;
            }
        }
    }

    /// A direction of the frames in frame (-1).
    #[inline(always)]
    fn rotate(&self, of: Vector3<f64>) -> Vectors {
        let mut made = [[0.0; POSTURES]; 3];
        for (coordinate, made) in made.iter_mut().enumerate() {
            let [x, y, z] = self.axes.each_ref().map(|axis| &axis[coordinate]);
            for posture in 0..POSTURES {
                made[posture] = x[posture] * of.x + y[posture] * of.y + z[posture] * of.z;
            }
        }
        made
    }

    #[inline(always)]
    fn slide(&mut self, axis: usize, length_m: &Lane) {
        for (own, along) in self.origin.iter_mut().zip(&self.axes[axis]) {
            for posture in 0..POSTURES {
                own[posture] += along[posture] * length_m[posture];
            }
        }
    }

    /// Turns two axes in their plane, the first towards the second.
    #[inline(always)]
    fn turn(&mut self, [first, second]: [usize; 2], sines: &Lane, cosines: &Lane) {
        for coordinate in 0..3 {
            let (f, s) = (self.axes[first][coordinate], self.axes[second][coordinate]);
            let turned = &mut self.axes[first][coordinate];
            for posture in 0..POSTURES {
                turned[posture] = f[posture] * cosines[posture] + s[posture] * sines[posture];
            }
            let turned = &mut self.axes[second][coordinate];
            for posture in 0..POSTURES {
                turned[posture] = s[posture] * cosines[posture] - f[posture] * sines[posture];
            }
        }
    }
}

/// Axis along or about which a parameter moves.
const fn axis_of(parameter: Parameter) -> usize {
    match parameter {
        Parameter::A | Parameter::Alpha => 0,
        Parameter::B | Parameter::Beta => 1,
        Parameter::D | Parameter::Theta => 2,
    }
}

struct Sweep<'a, 'c> {
    tile: &'a mut ScrewTile,
    chain: &'a Chain<'c>,
    variables: &'a [Lane],
}

impl WithSimd for Sweep<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            tile,
            chain,
            variables,
        } = self;
        let ScrewTile {
            frame,
            screws,
            is_wanted,
            sines,
            cosines,
        } = tile;
        *frame = Frames::identity();
        let mut moving = variables.iter();
        for (row, (link, motion)) in chain.links().iter().zip(chain.motions()).enumerate() {
            if let Some(origin) = chain.origin(row) {
                frame.place(origin);
            }
            let moved = match motion {
                Motion::Fixed => None,
                _ => moving.next(),
            };
            for parameter in chain.convention().order() {
                let axis = axis_of(parameter);
                let is_slide = matches!(parameter, Parameter::A | Parameter::B | Parameter::D);
                let place = place_of(row, parameter);
                if is_wanted[place] {
                    screws[place].axis = frame.axes[axis];
                    if !is_slide {
                        screws[place].point = frame.origin;
                    }
                }
                let constant = link.get(parameter);
                let mut values = [constant; POSTURES];
                let variable = moved.filter(|_| motion.variable() == Some(parameter));
                if let Some(variable) = variable {
                    for (value, variable) in values.iter_mut().zip(variable) {
                        *value += variable;
                    }
                } else if constant == 0.0 {
                    continue;
                }
                if is_slide {
                    frame.slide(axis, &values);
                    continue;
                }
                if variable.is_some() {
                    sines_cosines(&values, sines, cosines);
                } else {
                    let (sine, cosine) = libm::sincos(constant);
                    (*sines, *cosines) = ([sine; POSTURES], [cosine; POSTURES]);
                }
                frame.turn([(axis + 1) % 3, (axis + 2) % 3], sines, cosines);
            }
        }
        if let Some(origin) = chain.origin(chain.links().len()) {
            frame.place(origin);
        }
    }
}

struct Turn<'a> {
    screw: &'a Screw,
    end: &'a Vectors,
    into: &'a mut TwistLanes,
}

impl WithSimd for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Screw { axis, point } = self.screw;
        self.into.angular = *axis;
        for (coordinate, into) in self.into.linear.iter_mut().enumerate() {
            let (a, b) = ((coordinate + 1) % 3, (coordinate + 2) % 3);
            for (posture, into) in into.iter_mut().enumerate() {
                let arm = |of: usize| self.end[of][posture] - point[of][posture];
                *into = axis[a][posture] * arm(b) - axis[b][posture] * arm(a);
            }
        }
    }
}

struct Dot<'a> {
    a: &'a TwistLanes,
    b: &'a TwistLanes,
    into: &'a mut Lane,
}

impl WithSimd for Dot<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { a, b, into } = self;
        for (posture, into) in into.iter_mut().enumerate() {
            let linear = a.linear[0][posture] * b.linear[0][posture]
                + a.linear[1][posture] * b.linear[1][posture]
                + a.linear[2][posture] * b.linear[2][posture];
            let angular = a.angular[0][posture] * b.angular[0][posture]
                + a.angular[1][posture] * b.angular[1][posture]
                + a.angular[2][posture] * b.angular[2][posture];
            *into = linear + angular;
        }
    }
}
