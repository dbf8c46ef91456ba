//! The results of a trace for people: its page and its sentences. [`friction_map`] is the page of a steady-state friction
//! map, [`verification_page`] that of motions before and after a change, [`improvement_page`] that of several rounds.
//!
//! | file | |
//! |---|---|
//! | [`trace_page`] | the page: its sections in their order |
//! | [`sentences`] | sentences about what was found and what was not |
//! | `caveats` | sentences about the evidence against a model or an effect |
//! | `data_faults` | sentences about faults of the data |
//! | `parameters` | an effect with its parameters, in a few words |
//! | `laws` | laws of residuals in sentences |
//! | `tables` | tables of residuals, and of effects found compared with the truth |
//! | `axis_view` | the plotted residuals |
//! | `residual_plots` | residuals over time and over a `variable` |
//! | `circle_plots` | a circle, from `contour::circle_fit` and `radial_deviation` |
//! | [`circle_page`] | a single circle, and the parts of its deviation |
//! | [`positions_page`] | a positioning test: figures, deviation over position, and its parts |
//! | [`volume_page`] | geometric errors of three axes, over the position of each |
//! | [`certificate`] | the verdict in one sentence, limits, machine and logs |
//! | [`budget_page`], `budget_circle` | the contribution of each cause to the error at the tool; the circle without each |
//! | [`before_after`] | motions before, as predicted, and after a compensation |
//! | [`ranking`] | the candidates of each round |

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod axis_view;
pub mod before_after;
mod budget_circle;
pub mod budget_page;
mod caveats;
pub mod certificate;
pub mod circle_page;
mod circle_plots;
mod data_faults;
pub mod friction_map;
pub mod improvement_page;
pub mod laws;
mod parameters;
pub mod positions_page;
mod radial_deviation;
pub mod ranking;
mod residual_plots;
pub mod sentences;
mod tables;
pub mod trace_page;
mod variable;
pub mod verification_page;
pub mod volume_page;

#[cfg(test)]
mod tests;
