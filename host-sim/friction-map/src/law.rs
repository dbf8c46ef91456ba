//! Friction as a function of velocity.

use super::term::Term;

/// The sum of Coulomb friction, viscous friction and further terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// The terms in addition to Coulomb and viscous friction.
    pub terms: Vec<Term>,
    /// Coulomb friction, the viscous coefficient, then the size of each term, in the units of the map.
    pub sizes: Vec<f64>,
    /// Shape of each term; 1 if it has none.
    pub shapes: Vec<f64>,
    /// Highest speed of the map.
    pub top_speed: f64,
}

impl Law {
    /// Coulomb and viscous friction of size 0.
    #[must_use]
    pub fn declared(top_speed: f64) -> Self {
        Self { terms: Vec::new(), sizes: vec![0.0; 2], shapes: Vec::new(), top_speed }
    }

    /// This law with an additional term of size 0.
    #[must_use]
    pub fn with(&self, term: Term) -> Self {
        let mut law = self.clone();
        law.terms.push(term);
        law.sizes.push(0.0);
        law.shapes.push(1.0);
        law
    }

    /// This law without one of its terms, and that term.
    ///
    /// # Panics
    /// If there is no such term.
    #[must_use]
    pub fn without(&self, index: usize) -> (Self, Term) {
        let mut law = self.clone();
        let term = law.terms.remove(index);
        law.sizes.remove(index + 2);
        law.shapes.remove(index);
        (law, term)
    }

    /// Drive force at a velocity; friction has the sign of the velocity.
    #[must_use]
    pub fn force(&self, velocity: f64) -> f64 {
        self.basis(velocity).iter().zip(&self.sizes).map(|(basis, size)| basis * size).sum()
    }

    /// Derivatives of the force with respect to the sizes.
    #[must_use]
    pub fn basis(&self, velocity: f64) -> Vec<f64> {
        let terms = self.terms.iter().zip(&self.shapes);
        let of_terms = terms.map(|(term, &shape)| term.basis(velocity, shape, self.top_speed));
        [velocity.signum(), velocity].into_iter().chain(of_terms).collect()
    }

    /// Derivatives of the force with respect to the sizes, then to the logarithms of the free shapes (central differences).
    #[must_use]
    pub fn gradient(&self, velocity: f64) -> Vec<f64> {
        const STEP: f64 = 1e-5;
        let mut row = self.basis(velocity);
        for (i, (term, &shape)) in self.terms.iter().zip(&self.shapes).enumerate() {
            if term.parameter_count() == 2 {
                let at = |shape: f64| term.basis(velocity, shape, self.top_speed);
                let rise = at(shape * (1.0 + STEP)) - at(shape * (1.0 - STEP));
                row.push(self.sizes[i + 2] * rise / (2.0 * STEP));
            }
        }
        row
    }
}
