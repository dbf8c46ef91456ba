//! Traces of blind cases and measured data, each computed once for all tests of this program.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, OnceLock};

use files::log::Log;
use model::machine::Machine;
use tests::cases;
use trace::{Identification, trace};

/// A trace that a test may be computing: others that need it wait.
type Shared = Arc<OnceLock<Arc<Traced>>>;

/// By the files of the logs.
static TRACES: LazyLock<Mutex<HashMap<Vec<PathBuf>, Shared>>> = LazyLock::new(Mutex::default);

/// Logs and their trace.
pub struct Traced {
    pub fit: Vec<Log>,
    pub validate: Vec<Log>,
    pub trace: Identification,
}

/// The trace of a blind case.
pub fn of_case(folder: &Path) -> Arc<Traced> {
    of_logs(folder, &cases::logs(folder, "fit_"), &cases::logs(folder, "validate_"))
}

/// The trace of a measured log, of which the last quarter is held out.
pub fn of_measured(folder: &Path, log: &str) -> Arc<Traced> {
    of_logs(folder, &[folder.join(log)], &[])
}

fn of_logs(folder: &Path, fit: &[PathBuf], validate: &[PathBuf]) -> Arc<Traced> {
    let entry = TRACES.lock().unwrap().entry([fit, validate].concat()).or_default().clone();
    let traced = entry.get_or_init(|| {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let [fit, validate] = [fit, validate]
            .map(|paths| paths.iter().map(|path| Log::read(path).unwrap()).collect::<Vec<_>>());
        let trace = trace(&machine, &fit, &validate, &|_| {}).unwrap();
        Arc::new(Traced { fit, validate, trace })
    });
    traced.clone()
}
