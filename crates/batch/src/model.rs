//! The model of the distances: a chain, an anchor, and the parameters among the chain's numbers.

use haptical_kinematics::{Chain, Convention, Link, Motion, Parameter};

use crate::BatchError;

/// A serial chain whose end is at a measured distance from a fixed anchor
/// (Baser & Konukseven eqs. (3) to (5)).
///
/// The parameter vector holds absolute values in m and rad: by default `a`, `alpha`, `d` and `theta`
/// of every row, row by row in this order, so that parameter `4 row + k` is the k-th of them.
///
/// ```
/// use haptical_batch::DistanceModel;
/// use haptical_kinematics::{Convention, Link, Motion};
/// let links = [Link { a_m: 0.3, ..Link::default() }; 2];
/// let model = DistanceModel::new(Convention::Standard, &links, &[Motion::Revolute; 2], [0.0; 3])?;
/// assert_eq!(model.start(), [0.3, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0]);
/// # Ok::<(), haptical_batch::BatchError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DistanceModel {
    pub(crate) convention: Convention,
    pub(crate) links: Vec<Link>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) anchor_m: [f64; 3],
    pub(crate) parameters: Vec<(usize, Parameter)>,
}

/// The parameters of a row, in the order of the default parameter vector.
const OF_A_ROW: [Parameter; 4] = [
    Parameter::A,
    Parameter::Alpha,
    Parameter::D,
    Parameter::Theta,
];

impl DistanceModel {
    /// A chain of `links`, first row at frame (-1), with one motion per row; the anchor is in m in
    /// frame (-1).
    ///
    /// # Errors
    /// [`BatchError::Chain`] as [`Chain::new`], [`BatchError::Anchor`].
    pub fn new(
        convention: Convention,
        links: &[Link],
        motions: &[Motion],
        anchor_m: [f64; 3],
    ) -> Result<Self, BatchError> {
        Chain::new(convention, links, motions)?;
        if anchor_m.iter().any(|coordinate| !coordinate.is_finite()) {
            return Err(BatchError::Anchor { anchor_m });
        }
        let rows = 0..links.len();
        Ok(Self {
            convention,
            links: links.to_vec(),
            motions: motions.to_vec(),
            anchor_m,
            parameters: rows
                .flat_map(|row| OF_A_ROW.map(|parameter| (row, parameter)))
                .collect(),
        })
    }

    /// The same chain with another parameter vector: these parameters in this order.
    ///
    /// # Errors
    /// [`BatchError::Parameter`] for a row that the chain has not, or a parameter listed twice.
    pub fn with_parameters(
        mut self,
        parameters: &[(usize, Parameter)],
    ) -> Result<Self, BatchError> {
        let rows = self.links.len();
        for (index, &(row, parameter)) in parameters.iter().enumerate() {
            if row >= rows || parameters[..index].contains(&(row, parameter)) {
                return Err(BatchError::Parameter {
                    row,
                    parameter,
                    rows,
                });
            }
        }
        self.parameters = parameters.to_vec();
        Ok(self)
    }

    /// Row and parameter of each entry of the parameter vector.
    pub fn parameters(&self) -> &[(usize, Parameter)] {
        &self.parameters
    }

    /// The chain's own values of the parameters, in m and rad.
    pub fn start(&self) -> Vec<f64> {
        self.parameters
            .iter()
            .map(|&(row, parameter)| self.links[row].get(parameter))
            .collect()
    }

    /// One motion per row.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }
}
