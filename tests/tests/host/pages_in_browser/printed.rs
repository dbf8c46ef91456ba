//! A page on paper: Chromium prints it, `pdftotext` (poppler-utils) reads what is on each sheet; without it, only the number of sheets is checked.

use std::path::Path;
use std::process::Command;

/// Size of a sheet without Chromium's margins (0.4 inches), CSS pixels of 1/96 inch; paper is Letter, 8.5 by 11 inches.
pub const SHEET_PX: [f64; 2] = [96.0 * (8.5 - 0.8), 96.0 * (11.0 - 0.8)];

/// Prints a page; `height_px` is what it takes on a screen as wide as a sheet, with everything unfolded.
pub fn check(browser: &str, page: &Path, height_px: f64) {
    let pdf = page.with_extension("pdf");
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-pdf-header-footer",
            "--virtual-time-budget=10000",
        ])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--print-to-pdf={}", pdf.display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let bytes = std::fs::read(&pdf).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    assert!(bytes.starts_with(b"%PDF-"), "{}", pdf.display());
    let sheets = sheets(&bytes);
    // Words are 12 pixels high in place of 16, so that lines and their length shrink to 9/16 at least. Nothing that stays together is
    // higher than half a sheet, so that at least half of each is used.
    let full = height_px / SHEET_PX[1];
    let bounds = (9.0 / 16.0 * full - 1.0)..=(2.0 * full + 1.0);
    assert!(bounds.contains(&(sheets as f64)), "{sheets} sheets, {bounds:?}");
    let Some(words) = words(&pdf) else {
        eprintln!("no pdftotext: what is on paper was not read");
        return;
    };
    assert_eq!(words.len(), sheets);
    check_words(&words);
}

/// Number of the sheets of a PDF: its objects of that type, not of type `/Pages`.
fn sheets(bytes: &[u8]) -> usize {
    let key = b"/Type /Page";
    bytes.windows(key.len() + 1).filter(|window| window.starts_with(key) && window[key.len()] != b's').count()
}

/// What is on each sheet.
fn words(pdf: &Path) -> Option<Vec<String>> {
    let output = Command::new("pdftotext").args(["-layout"]).arg(pdf).arg("-").output().ok()?;
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.trim_end_matches('\u{c}').split('\u{c}').map(str::to_owned).collect())
}

/// What is folded away is printed, controls are not, and a legend is on the sheet of a picture that it explains.
fn check_words(sheets: &[String]) {
    let all = sheets.join("\n");
    for folded in [
        "Candidates tested",
        "The held-out data are used for one decision only",
        "at the noise of the sensors",
    ] {
        assert!(all.contains(folded), "{folded}");
    }
    for control in ["SVG", "CSV", "Without one cause", "magnification division", "Drag over"] {
        assert!(!all.contains(control), "{control}");
    }
    let is_on = |sheet: &&String, words: &str| sheet.contains(words);
    let legends = [("counter-clockwise", "One division is"), ("before, mean", "time, s")];
    for (legend, picture) in legends {
        let with_legend: Vec<&String> = sheets.iter().filter(|sheet| is_on(sheet, legend)).collect();
        assert!(!with_legend.is_empty(), "{legend}");
        assert!(with_legend.iter().all(|sheet| is_on(sheet, picture)), "{legend} without {picture}");
    }
}
