//! The tracer for a page in a browser. It is not a second program: it calls the crates that the commands call.
//!
//! | | |
//! |---|---|
//! | [`request`] | the request of the page, with the bytes of the files |
//! | [`log_file`] | a dropped file as a log, or what is missing to read it |
//! | [`machine_file`] | a machine file from logs, as `lost-motion init` |
//! | [`traced`] | a trace, as `lost-motion trace` |
//! | [`circle_alone`] | the parts of a circle, as `lost-motion circle` |
//! | [`compensation`] | a compensation as files of a control, as `lost-motion compensate --format` |
//! | [`interface`] | the functions that the page calls |
//!
//! A request is answered by a function of its bytes alone: no state is kept between requests, and no data are sent anywhere. The page and
//! its scripts are in `page/`; `lost-motion app` joins them with this crate as WebAssembly in one file.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod circle_alone;
pub mod compensation;
pub mod interface;
pub mod log_file;
pub mod machine_file;
pub mod request;
pub mod traced;

use serde_json::{Value, json};

use request::{Request, Task};
use trace::Progress;

/// The answer to a request as JSON: `{"ok": …}`, or `{"error": "one line"}`.
#[must_use]
pub fn answer(request: &[u8], progress: &Progress<'_>) -> Vec<u8> {
    let answer = match done(request, progress) {
        Ok(value) => json!({"ok": value}),
        Err(error) => json!({"error": error}),
    };
    answer.to_string().into_bytes()
}

fn done(request: &[u8], progress: &Progress<'_>) -> Result<Value, String> {
    let Request { task, files } = Request::parse(request)?;
    match task {
        Task::Look => Ok(files.iter().map(log_file::look).collect()),
        Task::Init(request) => machine_file::of_logs(&request, &files, progress),
        Task::Trace(request) => traced::of_logs(&request, &files, progress),
        Task::Circle(request) => circle_alone::of_files(&request, &files),
        Task::Compensate(request) => compensation::of_model(&request, progress),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(text: &str, files: &[u8]) -> Value {
        let length = u32::try_from(text.len()).unwrap().to_le_bytes();
        let request = [&length, text.as_bytes(), files].concat();
        serde_json::from_slice(&answer(&request, &|_| {})).unwrap()
    }

    #[test]
    fn a_log_is_looked_at_and_an_unknown_table_has_its_columns_listed() {
        let ours = "time_s,x_command_mm\n0,1\n0.5,2\n1,3\n";
        let theirs = "10 1.5\n11 2.5\n12 3.5\n13 4.5\n";
        let files = format!(
            r#"[{{"name":"a.csv","length":{}}},{{"name":"b.txt","length":{}}}]"#,
            ours.len(),
            theirs.len()
        );
        let seen =
            asked(&format!(r#"{{"task":"look","files":{files}}}"#), [ours, theirs].concat().as_bytes());
        let [log, unknown] = &seen["ok"].as_array().unwrap()[..] else { panic!("{seen}") };
        assert_eq!(
            (&log["kind"], &log["rate_hz"], &log["seconds"]),
            (&json!("log"), &json!(2.0), &json!(1.5))
        );
        assert_eq!(log["axes"], json!([{"name": "x", "unit": "mm", "columns": ["x_command_mm"]}]));
        assert_eq!(unknown["kind"], "unknown");
        assert_eq!(unknown["columns"][1], json!({"name": "2", "unit": null, "first": [1.5, 2.5, 3.5]}));
    }

    /// The page has a choice beside each column, and no flags.
    #[test]
    fn what_a_table_lacks_is_said_in_words_of_the_page() {
        let table = "10 1.5\n11 2.5\n12 3.5\n13 4.5\n";
        let said = |map: &str, text: &str| {
            let file = format!(r#"{{"name":"b.txt","length":{},"map":[{map}]}}"#, text.len());
            let seen = asked(&format!(r#"{{"task":"look","files":[{file}]}}"#), text.as_bytes());
            assert_eq!(seen["ok"][0]["kind"], "unknown", "{seen}");
            seen["ok"][0]["error"].as_str().unwrap().to_owned()
        };
        assert_eq!(said("", table), "No column has a known name. Choose below what each column is.");
        let timeless = said(r#""x_command_mm=2""#, table);
        assert!(timeless.contains("a column of times, or the samples per second"), "{timeless}");
        let ballbar = said("", "Deviation;Run\n1;2\n2;3\n3;4\n");
        let letter = said("", "Dear all,\nthe log is attached.\n");
        for words in [timeless, ballbar, letter] {
            assert!(!words.contains("--") && !words.contains("lost-motion"), "{words}");
        }
    }

    #[test]
    fn what_cannot_be_done_is_one_line() {
        let refused = |text: &str| asked(text, b"")["error"].as_str().unwrap().to_owned();
        let message = refused(r#"{"task":"trace","machine":"name = 3","files":[]}"#);
        assert!(message.starts_with("machine file: ") && message.lines().count() == 1, "{message}");
        let message = refused(r#"{"task":"compensate","model":"","control":"abacus","files":[]}"#);
        assert!(message.contains("abacus"), "{message}");
        let message = refused(r#"{"task":"circle","radius_mm":-1.0,"files":[]}"#);
        assert_eq!(message, "expected a radius above 0 mm, found -1");
    }
}
