//! A result as JSON with the limits that it was judged by.

use serde::Serialize;

use super::judgement::Judgement;

/// The JSON of a result, with a key `limits` beside its own.
#[derive(Clone, Debug, Serialize)]
pub struct Limited<T> {
    /// The result.
    #[serde(flatten)]
    pub result: T,
    /// The limits that were asked for; may be empty.
    pub limits: Vec<Judgement>,
}
