//! The declared machine, with the models of its axes.

use super::axis_model::AxisModel;
use super::fit_data::FitData;
use crate::input::signals::Signals;
use crate::options::TraceOptions;
use model::machine::Machine;

/// The declared machine, with the models of its axes and the thresholds with which it is traced.
#[derive(Clone, Debug)]
pub struct DeclaredMachine {
    /// The machine file.
    pub machine: Machine,
    /// Names of the axes, in the order of the file.
    pub names: Vec<String>,
    /// Models of the axes, in this order.
    pub axes: Vec<AxisModel>,
    /// The thresholds.
    pub options: TraceOptions,
}

impl DeclaredMachine {
    /// The models of the axes of a machine.
    #[must_use]
    pub fn new(machine: &Machine, options: &TraceOptions) -> Self {
        let model = |axis| AxisModel::new(axis, machine.rates(), options.model);
        Self {
            machine: machine.clone(),
            names: machine.axis.keys().cloned().collect(),
            axes: machine.axis.values().map(model).collect(),
            options: *options,
        }
    }

    /// The data of one axis, by its index, in logs.
    #[must_use]
    pub fn data<'a>(&'a self, logs: &'a [Signals], axis: usize) -> FitData<'a> {
        let data = FitData::new(logs, &self.names, axis, self.machine.rates(), &self.options);
        FitData { axes: &self.axes, ..data }
    }
}
