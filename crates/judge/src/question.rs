//! What a kind of rows has to answer to be judged.

/// Models that grow by one effect after the other.
pub trait Forward {
    /// A fitted model with the effects that were taken.
    type State;
    /// A further effect, worked out as far as the comparison of proposals needs.
    type Further;
    /// Why a fit fails; [`Infallible`](std::convert::Infallible) where none does.
    type Error;

    /// Further effects; none where the model needs none or may have no more.
    ///
    /// # Errors
    /// Where a fit fails.
    fn proposals(&mut self, state: &Self::State) -> Proposals<Self>;

    /// Rules on the best proposal.
    ///
    /// # Errors
    /// Where a fit fails.
    fn rule(&mut self, state: &Self::State, best: Proposal<Self::Further>) -> Ruled<Self>;
}

/// What is proposed, or why a fit fails.
pub type Proposals<Q> = Result<Vec<Proposal<<Q as Forward>::Further>>, <Q as Forward>::Error>;

/// What becomes of the best proposal, or why a fit fails.
pub type Ruled<Q> = Result<Ruling<<Q as Forward>::State>, <Q as Forward>::Error>;

/// A further effect.
#[derive(Debug, Clone)]
pub struct Proposal<F> {
    /// The effect.
    pub further: F,
    /// By how much it explains more than its numbers would explain of noise, in the rows' unit.
    pub merit: f64,
}

impl<F> Proposal<F> {
    /// The proposal of an effect that was compared with others already; nothing without one.
    pub fn of_best(best: Option<F>, merit: impl FnOnce(&F) -> f64) -> Vec<Self> {
        let proposal = best.map(|further| Self {
            merit: merit(&further),
            further,
        });
        proposal.into_iter().collect()
    }
}

/// What becomes of a proposal.
#[derive(Debug, Clone)]
pub enum Ruling<S> {
    /// The effect is taken; the model with it.
    Taken(S),
    /// It is not taken, and not proposed again; others may be.
    Refused,
    /// It is not taken, and with it none.
    Ended,
}

/// Models that can do without one of their effects.
pub trait Backward {
    /// A fitted model with effects, which are numbered from 0.
    type State;
    /// Why a fit fails.
    type Error;

    /// Number of effects in a model.
    fn effects(&self, state: &Self::State) -> usize;

    /// The model without an effect, fitted anew.
    ///
    /// # Errors
    /// Where a fit fails.
    fn without(&mut self, state: &Self::State, effect: usize) -> Less<Self>;
}

/// A model without one of its effects, or why its fit fails.
pub type Less<Q> = Result<Without<<Q as Backward>::State>, <Q as Backward>::Error>;

/// A model without one of its effects.
#[derive(Debug, Clone)]
pub struct Without<S> {
    /// The model, fitted anew.
    pub state: S,
    /// What the effect explains with the others in the model, its numbers allowed for.
    pub worth: f64,
}

/// Models of which needless effects are taken out.
pub trait Needless: Backward {
    /// Whether an effect explains too little, given the model without each of its effects.
    ///
    /// # Errors
    /// Where a test fails.
    fn is_needless(
        &mut self,
        state: &Self::State,
        effect: usize,
        all: &[Without<Self::State>],
    ) -> Result<bool, Self::Error>;

    /// A model from which an effect was just taken, fitted with more care where the comparison was quick.
    ///
    /// # Errors
    /// Where the fit fails.
    fn refitted(&mut self, state: Self::State) -> Result<Self::State, Self::Error> {
        Ok(state)
    }
}

/// Models whose effects have rivals.
pub trait InPlace: Backward {
    /// What an effect is called, with its place.
    type Name: PartialEq;
    /// What else is known of a rival.
    type Fit;

    /// What may be in the place of an effect, which `without` lacks.
    ///
    /// # Errors
    /// Where a fit fails.
    fn in_place(
        &mut self,
        without: &Self::State,
        whole: &Self::State,
        effect: usize,
    ) -> Others<Self>;
}

/// What may be in the place of an effect, or why a fit fails.
pub type Others<Q> =
    Result<Vec<Other<<Q as InPlace>::Name, <Q as InPlace>::Fit>>, <Q as Backward>::Error>;

/// An effect in another's place.
#[derive(Debug, Clone)]
pub struct Other<N, F> {
    /// Its name and place.
    pub name: N,
    /// What it explains there, its numbers allowed for.
    pub merit: f64,
    /// What else is known of it.
    pub fit: F,
}
