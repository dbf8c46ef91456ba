//! The tracer in headless Chromium, from the one file of `lost-motion app`: files are dropped on the page, and what it shows is what the
//! commands print. Without Chromium or the target of browsers, the tests say so and pass.

mod traced;

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{OnceLock, mpsc};
use std::time::Duration;

use serde_json::{Value, json};
use tests::program::lost_motion;

use crate::pages_in_browser::chromium;

/// Time after which a page that says nothing is broken, s.
const LONGEST_S: u64 = 240;

/// What the script of a test may use: files by name from base64, and the end of work.
const HELPERS: &str = r#"
const dropped = (named) => {
  const data = new DataTransfer();
  for (const [name, text] of Object.entries(named)) {
    data.items.add(new File([Uint8Array.from(atob(text), (character) => character.charCodeAt(0))], name));
  }
  document.getElementById("drop").dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
};
const pause = () => new Promise((done) => setTimeout(done, 20));
// A page that begins with something else after its work is not yet idle.
const idle = async () => { for (let still = 0; still < 10; still += 1) { await pause(); if (!document.getElementById("work").hidden) still = 0; } };
const click = async (id) => { document.getElementById(id).click(); await idle(); };
const shown = (id) => document.getElementById(id).textContent;
const file = async (name) => {
  const link = [...document.querySelectorAll("a[download]")].find((link) => link.download === name);
  return link ? (await fetch(link.href)).text() : null;
};
"#;

/// The page with the tracer, built once; `None` after a line that says what is missing.
fn app() -> Option<&'static (PathBuf, &'static str)> {
    static APP: OnceLock<Option<(PathBuf, &str)>> = OnceLock::new();
    let made = || {
        let Some(browser) = chromium() else {
            eprintln!("no Chromium: the tracer in a browser was not tested");
            return None;
        };
        let page = Path::new(env!("CARGO_TARGET_TMPDIR")).join("lost-motion.html");
        let done = Command::new(lost_motion()).args(["app", "--out"]).arg(&page).output().unwrap();
        if String::from_utf8_lossy(&done.stderr).contains("target may not be installed") {
            eprintln!("no target wasm32-unknown-unknown: the tracer in a browser was not tested");
            return None;
        }
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        Some((page, browser))
    };
    APP.get_or_init(made).as_ref()
}

struct Browser(Child);

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        drop(self.0.kill());
        drop(self.0.wait());
    }
}

/// Opens the page and runs a script (the body of an async function) in it; what the script returns.
fn run(script: &str, files: &[(&str, Vec<u8>)]) -> Option<Value> {
    let (page, browser) = app()?;
    let folder = tempfile::tempdir().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let files: serde_json::Map<String, Value> =
        files.iter().map(|(name, bytes)| ((*name).to_owned(), base64(bytes).into())).collect();
    let harness = format!(
        "<script>{{ {HELPERS}const files = {};\nconst errors = [];\naddEventListener('error', (event) => errors.push(event.message));\n\
         (async () => {{ {script} }})().then((seen) => ({{ seen, errors }}), (error) => ({{ errors: [...errors, String(error.stack)] }}))\n\
         .then((result) => fetch('http://127.0.0.1:{}', {{ method: 'POST', mode: 'no-cors', body: JSON.stringify(result) }})); }}</script>",
        Value::from(files),
        listener.local_addr().unwrap().port(),
    );
    let tested = folder.path().join("tested.html");
    fs::write(&tested, fs::read_to_string(page).unwrap().replace("</body>", &format!("{harness}</body>")))
        .unwrap();
    let started = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1000,1000"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}", tested.display()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let _browser = Browser(started.unwrap());
    let result: Value = serde_json::from_str(&posted(listener)).unwrap();
    assert_eq!(result["errors"], json!([]), "{result}");
    Some(result["seen"].clone())
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

/// The body of the request that the page posts. A browser also opens connections on which it says nothing.
fn posted(listener: TcpListener) -> String {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let sender = sender.clone();
            // After the test nobody receives.
            std::thread::spawn(move || body(stream).map(|body| drop(sender.send(body))));
        }
    });
    receiver.recv_timeout(Duration::from_secs(LONGEST_S)).expect("the page says what it saw")
}

/// The body of a request, if one comes.
fn body(stream: TcpStream) -> Option<String> {
    let mut reader = BufReader::new(stream);
    let mut length = 0;
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end().split_once(": ") {
            Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                length = value.parse().ok()?;
            }
            None if line.trim_end().is_empty() => break,
            _ => {}
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    reader.get_mut().write_all(b"HTTP/1.1 204 No Content\r\n\r\n").ok()?;
    String::from_utf8(body).ok()
}

/// Greatest relative difference of a figure of a trace, its error budget, or a circle in a browser from that of the program. Both compute with the
/// functions of `libm`; sums of a matrix product may have other last bits.
const OF_FIGURES: f64 = 1e-9;

/// Figures below this, most of them µm, are compared with this in their place: what is far below a nanometre has few digits that mean anything.
const SMALL: f64 = 1.0;

/// Asserts that two JSON values have the same shape, words and numbers; the greatest relative difference of their numbers.
fn difference(at: &str, [ours, native]: [&Value; 2], bound: f64) -> f64 {
    let greatest = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0, f64::max);
    match (ours, native) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let difference = (a - b).abs() / a.abs().max(b.abs()).max(SMALL);
            assert!(difference <= bound, "{at}: {a} instead of {b}");
            difference
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let pairs = a.iter().zip(b).enumerate();
            greatest(&mut pairs.map(|(i, (a, b))| difference(&format!("{at}[{i}]"), [a, b], bound)))
        }
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => greatest(
            &mut a.iter().map(|(key, value)| difference(&format!("{at}.{key}"), [value, &b[key]], bound)),
        ),
        _ => {
            assert_eq!(ours, native, "{at}");
            0.0
        }
    }
}

fn program(arguments: &[&str], folder: &Path) {
    let done = Command::new(lost_motion()).args(arguments).current_dir(folder).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// The log of a circle on a machine with backlash, in a folder.
fn circle_log(folder: &Path) -> String {
    let host_sim = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("host-sim");
    let machine = fs::read_to_string(host_sim.join("machines/demo.toml")).unwrap();
    let with_backlash = format!("{machine}\n[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 12.0\n");
    fs::write(folder.join("m.toml"), with_backlash).unwrap();
    let motion = host_sim.join("motions/circle.toml");
    program(
        &["simulate", "--machine", "m.toml", "--motion", motion.to_str().unwrap(), "--out", "circle.csv"],
        folder,
    );
    fs::read_to_string(folder.join("circle.csv")).unwrap()
}

/// Somebody who has the page and the log of a circle drops it, and reads what it is made of within a minute.
#[test]
fn a_dropped_circle_is_taken_apart() {
    let folder = tempfile::tempdir().unwrap();
    let log = circle_log(folder.path());
    let script = "const start = performance.now(); dropped(files); await idle();
        return { seconds: (performance.now() - start) / 1000, sentences: shown('sentences'), json: await file('circle.json'), page: await file('report.html') };";
    let Some(seen) = run(script, &[("circle.csv", log.into_bytes())]) else { return };
    assert!(seen["seconds"].as_f64().unwrap() < 60.0, "{}", seen["seconds"]);
    program(&["circle", "circle.csv", "--json", "c.json"], folder.path());
    let native = serde_json::from_str(&fs::read_to_string(folder.path().join("c.json")).unwrap()).unwrap();
    let ours: Value = serde_json::from_str(seen["json"].as_str().unwrap()).unwrap();
    difference("circle", [&ours, &native], OF_FIGURES);
    assert!(
        seen["sentences"].as_str().unwrap().contains("µm") && seen["page"].as_str().unwrap().contains("<svg"),
        "{seen}"
    );
}

/// Of a log without a header, columns are chosen by hand; of a table of radii, the radius is asked for.
#[test]
fn files_of_other_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let log = circle_log(folder.path());
    let halsampler: String =
        log.lines().skip(1).map(|line| format!("{}\n", line.replace(',', " "))).collect();
    let columns: Vec<String> = log.lines().next().unwrap().split(',').map(str::to_owned).collect();
    let script = format!(
        "dropped(files); await idle();
         const rows = [...document.querySelectorAll('.columns tbody tr')], names = {};
         const before = {{ rows: rows.length, hidden: document.getElementById('run-section').hidden }};
         rows.forEach((row, index) => {{ row.querySelector('select').value = names[index]; }});
         document.querySelector('.columns button').click(); await idle();
         return {{ before, list: shown('list'), sentences: shown('sentences') }};",
        json!(columns)
    );
    let Some(seen) = run(&script, &[("x.log", halsampler.into_bytes())]) else { return };
    assert_eq!(seen["before"], json!({"rows": columns.len(), "hidden": true}));
    assert!(seen["list"].as_str().unwrap().contains("Hz"), "{seen}");
    assert!(seen["sentences"].as_str().unwrap().contains("µm"), "{seen}");

    // 8 µm of ovality: the radius is 4 µm greater at 0° and smaller at 90°.
    let radii = |angle: f64| 4.0 * (2.0 * angle.to_radians()).cos();
    let turn = |from: i32, sign: i32| (0..=720).map(move |i| f64::from(from + sign * i) / 2.0);
    let rows = turn(0, 1).chain(turn(720, -1)).map(|angle| format!("{angle},{:.3}\n", radii(angle)));
    let table = format!("angle_deg,radius_um\n{}", rows.collect::<String>());
    let script = "dropped(files); await idle(); document.getElementById('radius').value = '100'; await click('circle');
        return { problem: shown('problem'), json: await file('circle.json') };";
    let Some(seen) = run(script, &[("ballbar.csv", table.clone().into_bytes())]) else { return };
    fs::write(folder.path().join("ballbar.csv"), table).unwrap();
    program(&["circle", "ballbar.csv", "--radius", "100", "--json", "b.json"], folder.path());
    let native = serde_json::from_str(&fs::read_to_string(folder.path().join("b.json")).unwrap()).unwrap();
    let ours: Value =
        serde_json::from_str(seen["json"].as_str().unwrap_or_else(|| panic!("{seen}"))).unwrap();
    difference("ballbar", [&ours, &native], OF_FIGURES);
}

/// The example: searched, compensated, files taken away; a search that is cancelled can be started again.
#[test]
fn the_example_is_traced_and_compensated() {
    let script = "await click('example');
        document.getElementById('trace').click(); await pause(); document.getElementById('cancel').click(); await idle();
        const cancelled = document.getElementById('result-section').hidden;
        await click('trace'); await click('compensate');
        return { cancelled, problem: shown('problem'), sentences: shown('sentences'), remedy: shown('remedy'), json: await file('trace.json'), model: await file('machine.toml'),
            names: [...document.querySelectorAll('#remedy-files a')].map((link) => link.download), sideways: document.documentElement.scrollWidth - document.documentElement.clientWidth };";
    let Some(seen) = run(script, &[]) else { return };
    assert_eq!(seen["cancelled"], true);
    let trace: Value =
        serde_json::from_str(seen["json"].as_str().unwrap_or_else(|| panic!("{seen}"))).unwrap();
    let name = trace["effects"][0]["name"].as_str();
    let name = name.unwrap_or_else(|| panic!("{trace}"));
    assert!(seen["model"].as_str().unwrap().contains(&format!("name = \"{name}\"")), "{seen}");
    assert!(seen["remedy"].as_str().unwrap().contains("µm"), "{seen}");
    assert!(seen["names"].as_array().unwrap().contains(&json!("compensation.toml")), "{seen}");
    assert_eq!(seen["sideways"], 0);
}
