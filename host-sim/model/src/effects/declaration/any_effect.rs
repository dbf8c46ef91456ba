//! An effect of any kind.

use std::any::Any;

/// An effect of any kind, in a declaration that names another kind: declarations do not know the catalogue, which turns it into an
/// [`Effect`](crate::effects::Effect).
pub struct AnyEffect(Box<dyn Any>);

impl AnyEffect {
    /// Holds an effect.
    #[must_use]
    pub fn new(effect: impl Any) -> Self {
        Self(Box::new(effect))
    }

    /// The effect, if it is of this kind.
    #[must_use]
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.downcast_ref()
    }
}
