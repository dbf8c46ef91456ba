//! Step 4, the search: [`search`] takes the baseline of an axis and adds the effects that its fit logs support; [`fit_together`] fits these
//! [`hypotheses`] beside the models of the other axes.
//!
//! [`effect_search`] adds one effect per [`round`]. The [`residual_shape`] gives the knots of maps and the periods of
//! harmonics with which candidates start. A round ranks the [`candidates`], compares them on [`held_out`] data and
//! with the closed loop ([`loop_check`]), adds one [`provisional`]ly where several hide each other, and reports an
//! [`ambiguity`]. Effects that the fit of the mechanics hides are an [`assumption`].

pub mod alternatives;
pub mod ambiguity;
pub mod assumption;
pub mod candidates;
pub mod companion;
pub mod effect_search;
pub mod held_out;
pub mod hypotheses;
pub mod local_defect;
pub mod loop_check;
pub mod mass_check;
pub mod missing_effects;
pub mod other_form;
pub mod position_spectrum;
pub mod provisional;
pub mod refinement;
pub mod residual_samples;
pub mod residual_shape;
pub mod round;
pub mod scale_noise_check;
pub mod scale_waves;
pub mod several_of_kind;

pub use hypotheses::{Hypotheses, SearchedAxis, fit_together, search};
