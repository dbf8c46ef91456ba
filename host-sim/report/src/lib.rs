//! Components of report pages, and the pages of a trace and of a friction map.
//!
//! A page is one HTML file without scripts and without references to other files; the same result gives the same
//! bytes. Other studies build their own pages from the same components.
//!
//! | components of pages | |
//! |---|---|
//! | [`page`] | the page as a file: head, stylesheet, writing |
//! | [`markup`] | HTML elements that several sections use |
//! | [`plot`] | line charts |
//! | [`polar`] | a circle as in ballbar reports, from `circle_fit` and `radial_deviation` |
//!
//! | the page of a trace | |
//! |---|---|
//! | [`trace_page`] | the sections in their order |
//! | [`sentences`] | the results in sentences |
//! | `caveats` | sentences on evidence against a model or an effect |
//! | `parameters` | an effect with its parameters, in a few words |
//! | `tables` | tables of residuals, and of effects found compared with the truth |
//! | `axis_view` | the plotted residuals |
//! | `residual_plots` | residuals over time and over a `variable` |
//! | [`ranking`] | the candidates of each round |
//!
//! [`friction_map`] is the page of a steady-state friction map.

mod axis_view;
mod caveats;
mod circle_fit;
pub mod friction_map;
pub mod markup;
pub mod page;
mod parameters;
pub mod plot;
pub mod polar;
mod radial_deviation;
pub mod ranking;
mod residual_plots;
pub mod sentences;
mod tables;
pub mod trace_page;
mod variable;

#[cfg(test)]
mod tests;
