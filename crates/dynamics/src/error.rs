//! Says what was wrong with an input, where, and what was expected.

/// Every reason for which a function of this crate refuses to answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsError {
    /// A tree without bodies has no joint.
    #[error("the tree has no body; at least one is needed")]
    EmptyTree,
    /// A body hangs on itself or on one that comes later.
    #[error("body {body} hangs on body {parent}; a parent comes before its children")]
    Parent {
        /// Body, counted from 0.
        body: usize,
        /// What it names as its parent.
        parent: usize,
    },
    /// A placement that is not finite, too far away, or whose matrix is not a rotation.
    #[error("the placement of joint {body} is not a finite position with a rotation matrix")]
    Placement {
        /// Body behind the joint, counted from 0.
        body: usize,
    },
    /// A joint's axis is not a finite vector of length 1.
    #[error("the axis of joint {body} has the length {length}; 1 is needed")]
    Axis {
        /// Body behind the joint, counted from 0.
        body: usize,
        /// The axis's length.
        length: f64,
    },
    /// A mass is negative, infinite or not a number.
    #[error("body {body} has a mass of {mass_kg} kg; a finite number of at least 0 is needed")]
    Mass {
        /// Body, counted from 0.
        body: usize,
        /// Its mass.
        mass_kg: f64,
    },
    /// A first moment or an inertia is infinite, not a number, or not symmetric.
    #[error("the {quantity} of body {body} is not a finite one, or not symmetric")]
    Inertia {
        /// Body, counted from 0.
        body: usize,
        /// Which of its numbers.
        quantity: &'static str,
    },
    /// An armature is negative, infinite or not a number.
    #[error("joint {body} has an armature of {value}; a finite number of at least 0 is needed")]
    Armature {
        /// Body behind the joint, counted from 0.
        body: usize,
        /// What it was.
        value: f64,
    },
    /// An input or output slice has the wrong length.
    #[error("{buffer} has {got} entries; {expected} are needed")]
    Length {
        /// Which slice.
        buffer: &'static str,
        /// Entries needed.
        expected: usize,
        /// Length of the slice.
        got: usize,
    },
    /// A number for a joint is infinite or not a number.
    #[error("the {quantity} of joint {joint} is {value}; a finite number is needed")]
    NonFiniteJoint {
        /// Which of the joint's numbers.
        quantity: &'static str,
        /// Joint, counted from 0.
        joint: usize,
        /// What it was.
        value: f64,
    },
    /// A vector has a component that is infinite or not a number.
    #[error("{vector} is {value:?}; finite components are needed")]
    NonFiniteVector {
        /// Which vector.
        vector: &'static str,
        /// Its components.
        value: [f64; 3],
    },
    /// A wrench acts on a body that the tree has not.
    #[error("a wrench acts on body {body}; the tree has {bodies} bodies, counted from 0")]
    WrenchBody {
        /// The body it names.
        body: usize,
        /// Bodies of the tree.
        bodies: usize,
    },
    /// Nothing resists a joint's acceleration: what it carries has no inertia about its axis.
    #[error(
        "nothing that joint {joint} moves has inertia about its axis; its acceleration is free"
    )]
    NoInertia {
        /// Joint, counted from 0.
        joint: usize,
    },
    /// The inputs are finite, the result is too large to be represented.
    #[error("{quantity} is too large to be represented")]
    Overflow {
        /// Which result.
        quantity: &'static str,
    },
}
