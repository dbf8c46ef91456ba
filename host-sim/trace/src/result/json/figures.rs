//! Channels and figures of entries.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::ser::{Error, SerializeMap, Serializer};
use serde_json::{Map, Value};

use crate::fit::fit_data::FitAndValidationRms;
use crate::stages::residual_unit;
use files::log::Unit;
use model::effects::Stage;

/// A residual channel: what a stage predicts from the measured signal upstream of it.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Motor less what the loop gives from the command.
    Motor,
    /// Table less what the mechanics give from the motor.
    Table,
    /// Tool less what the structure gives from the tables.
    Tool,
    /// Drive force less what the motion requires.
    Force,
}

impl From<Stage> for Channel {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Motor => Self::Motor,
            Stage::Table => Self::Table,
            Stage::Tool => Self::Tool,
            Stage::Force => Self::Force,
        }
    }
}

/// Rms on the fitted logs and on the held-out logs; `null` without the channel.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct Rms {
    fit: Option<f64>,
    validate: Option<f64>,
}

impl From<FitAndValidationRms> for Rms {
    fn from(FitAndValidationRms { fit, validate }: FitAndValidationRms) -> Self {
        Self { fit: number(fit), validate: number(validate) }
    }
}

/// A number; `None`, in JSON `null`, if it is not known.
pub(super) fn number(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Suffixes of the keys: linear and rotary positions, forces and torques.
const UNITS: [&str; 4] = ["um", "mdeg", "n", "nm"];

/// The figures of a struct, whose keys get the unit as suffix: `rms` becomes `rms_um`.
#[derive(Clone, Debug)]
pub struct InUnit<F> {
    unit: &'static str,
    figures: F,
}

impl<F> InUnit<F> {
    /// Figures in the unit of a stage's residual on an axis with this unit.
    pub const fn of(unit: Unit, stage: Stage, figures: F) -> Self {
        Self { unit: residual_unit(unit, stage).1, figures }
    }

    /// The unit.
    pub const fn unit(&self) -> &'static str {
        self.unit
    }
}

impl<F: Serialize> Serialize for InUnit<F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Value::Object(figures) = serde_json::to_value(&self.figures).map_err(S::Error::custom)? else {
            return Err(S::Error::custom("figures are a struct"));
        };
        let mut map = serializer.serialize_map(Some(figures.len()))?;
        for (key, value) in figures {
            map.serialize_entry(&format!("{key}_{}", self.unit), &value)?;
        }
        map.end()
    }
}

impl<F: JsonSchema> JsonSchema for InUnit<F> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}InUnit", F::schema_name()).into()
    }

    fn inline_schema() -> bool {
        true
    }

    /// The figures in one of the units.
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let figures = F::json_schema(generator);
        let none = Map::new();
        let properties = figures.get("properties").and_then(Value::as_object).unwrap_or(&none);
        let in_unit = |unit: &str| {
            let key = |key: &String| format!("{key}_{unit}");
            let required: Vec<String> = properties.keys().map(key).collect();
            let properties: Map<String, Value> =
                properties.iter().map(|(name, schema)| (key(name), schema.clone())).collect();
            json_schema!({ "type": "object", "properties": properties, "required": required })
        };
        json_schema!({ "oneOf": UNITS.map(in_unit) })
    }
}
