//! Pages in headless Chromium: at 390, 768 and 1280 pixels nothing scrolls sideways and no script fails; the slider of a circle changes what is
//! drawn, and the pointer shows the deviation under it. `run.sh all` installs Chromium; without it, the test says so and passes.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Loads a page in frames of these widths, moves the first slider and the pointer, and writes what it saw as JSON.
const HARNESS: &str = r#"<!doctype html><body><script>
const seen = [];
const widths = [390, 768, 1280];
const settled = () => new Promise((done) => setTimeout(done, 200));
async function look(width) {
  const frame = document.createElement("iframe");
  frame.style.cssText = `width:${width}px;height:900px;border:0`;
  const errors = [];
  document.body.append(frame);
  await new Promise((done) => { frame.onload = done; frame.src = "PAGE"; });
  const inside = frame.contentWindow, page = frame.contentDocument;
  inside.addEventListener("error", (event) => errors.push(event.message));
  await settled();
  const result = { width, errors, scroll: page.documentElement.scrollWidth };
  const slider = page.querySelector("input[type=range]");
  if (slider) {
    const svg = page.querySelector("svg[data-division]"), line = svg.querySelector("polyline");
    const span = () => { const box = line.getBBox(); return box.width; };
    const said = () => slider.parentElement.querySelector("output").textContent;
    result.before = span();
    slider.value = 2;
    slider.dispatchEvent(new inside.Event("input"));
    result.after = span();
    result.division = said();
    const box = svg.getBoundingClientRect();
    svg.dispatchEvent(new inside.PointerEvent("pointermove", { clientX: box.left + 0.9 * box.width, clientY: box.top + 0.5 * box.height }));
    result.hover = said();
  }
  seen.push(result);
  frame.remove();
}
(async () => {
  for (const width of widths) await look(width);
  document.body.innerHTML = "<pre id=result></pre>";
  document.getElementById("result").textContent = JSON.stringify(seen);
})();
</script>"#;

fn chromium() -> Option<&'static str> {
    let runs = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(runs)
}

/// What was seen of a page at each width.
fn seen(browser: &str, page: &Path) -> Vec<Value> {
    let folder = page.parent().unwrap();
    let harness = folder.join("harness.html");
    fs::write(&harness, HARNESS.replace("PAGE", page.file_name().unwrap().to_str().unwrap())).unwrap();
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", "--dump-dom"])
        .args(["--virtual-time-budget=20000", "--window-size=1400,1000"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}", harness.display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let result = dom.split_once("<pre id=\"result\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let (json, _) = result.unwrap_or_else(|| panic!("{dom}\n{}", String::from_utf8_lossy(&output.stderr)));
    serde_json::from_str(&json.replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")).unwrap()
}

fn check(browser: &str, page: &Path, has_circle: bool) {
    for seen in seen(browser, page) {
        let width = seen["width"].as_f64().unwrap();
        assert_eq!(seen["errors"], serde_json::json!([]), "{seen}");
        assert!(seen["scroll"].as_f64().unwrap() <= width, "{}: {seen}", page.display());
        assert_eq!(seen.get("before").is_some(), has_circle, "{seen}");
        if has_circle {
            // A magnification of 4: the line goes farther out.
            assert!(seen["after"].as_f64().unwrap() > 1.02 * seen["before"].as_f64().unwrap(), "{seen}");
            assert!(seen["division"].as_str().unwrap().starts_with("division "), "{seen}");
            let hover = seen["hover"].as_str().unwrap();
            assert!(hover.starts_with("0.0°") || hover.starts_with("360.0°"), "{seen}");
            assert!(hover.contains("wise") && hover.contains(" µm"), "{seen}");
        }
    }
}

#[test]
fn pages_do_not_scroll_sideways_and_their_circles_are_magnified() {
    let Some(browser) = chromium() else {
        eprintln!("no Chromium: the pages were not looked at");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [of_demo, of_circle, of_budget] = ["demo", "circle", "budget"].map(|name| folder.path().join(name));
    let run = |arguments: &[&str]| {
        let done = Command::new(tests::program::lost_motion()).args(arguments).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join("host-sim");
    let log = folder.path().join("circle.csv");
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let machine = text(&root.join("machines/demo.toml"));
    run(&["demo", "--seed", "2", "--report", &text(&of_demo)]);
    let motion = text(&root.join("motions/circle.toml"));
    run(&["simulate", "--machine", &machine, "--motion", &motion, "--out", &text(&log)]);
    run(&["circle", &text(&log), "--report", &text(&of_circle)]);
    run(&["budget", "--model", &machine, "--report", &text(&of_budget)]);
    check(browser, &of_demo.join("report.html"), true);
    check(browser, &of_circle.join("report.html"), true);
    check(browser, &of_budget.join("report.html"), false);
}
