//! `lost-motion app`: the tracer as one HTML file.

use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use clap::ValueEnum;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

use super::outputs::{Output, check_outputs, print};
use super::progress::Progress;
use controls::Control;
use files::log::Log;
use files::output::write_whole;
use model::machine::Machine;

/// Seed of the machine of the example.
const SEED: u64 = 2;

const TARGET: &str = "wasm32-unknown-unknown";

/// The page, with a mark for each part that is put in.
const PAGE: &str = include_str!("../../web/page/index.html");

/// Arguments of `app`.
#[derive(clap::Args)]
pub struct Arguments {
    /// HTML file to write.
    #[arg(long)]
    out: PathBuf,
    /// The tracer as WebAssembly, if it is built already. Default: cargo builds it from the sources of this program, for some minutes.
    #[arg(long)]
    wasm: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// A tracer that cannot be built or read, an output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> = arguments.wasm.iter().map(PathBuf::as_path).collect();
    check_outputs(&inputs, &[Output::File("--out", Some(&arguments.out))])?;
    let wasm = match &arguments.wasm {
        Some(path) => path.clone(),
        None => built()?,
    };
    let tracer =
        std::fs::read(&wasm).with_context(|| format!("{}: expected a readable file", wasm.display()))?;
    if !tracer.starts_with(b"\0asm") {
        bail!("{}: expected a module of WebAssembly", wasm.display());
    }
    let progress = Progress::start();
    progress.show("running the machine of the example");
    let page = page(&tracer, &example()?)?;
    drop(progress);
    write_whole(&arguments.out, |out| out.write_all(page.as_bytes()))?;
    let megabytes = page.len() as f64 / 1e6;
    print(&format!(
        "{}: {megabytes:.1} MB. It needs no network: open it in a browser.",
        arguments.out.display()
    ))
}

/// Builds the tracer for browsers; its file.
fn built() -> Result<PathBuf> {
    let host_sim = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = host_sim.parent().unwrap_or(host_sim);
    if !sources.join("Cargo.toml").exists() {
        bail!("--wasm: expected this file, as the sources of this program are not at {}", sources.display());
    }
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| sources.join("target"), PathBuf::from);
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let build = Command::new(cargo)
        .current_dir(sources)
        .args(["build", "--package", "web", "--profile", "web", "--target", TARGET, "--target-dir"])
        .arg(&target)
        .status()
        .context("cargo: expected a program that runs")?;
    if !build.success() {
        bail!("the tracer was not built; it needs the target of browsers: rustup target add {TARGET}");
    }
    Ok(target.join(TARGET).join("web/web.wasm"))
}

/// Logs of a simulated machine with an effect that its file lacks, and the file, as the page reads them.
fn example() -> Result<String> {
    let declared = Machine::parse(demo::MACHINE, "machines/demo.toml")?;
    let [fit, held_out] = demo::logs(&demo::draw(&declared, SEED).truth, SEED)?;
    let [fit, held_out] = [packed(&fit)?, packed(&held_out)?];
    Ok(json!({"fit": fit, "held_out": held_out, "machine": demo::MACHINE}).to_string())
}

/// Logs by the names of their files.
fn packed(logs: &[Log]) -> Result<Value> {
    let mut files = serde_json::Map::new();
    for log in logs {
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        log.write_csv(&mut packed)?;
        files.insert(format!("{}.csv.gz", log.source), BASE64.encode(packed.finish()?).into());
    }
    Ok(files.into())
}

/// The page with its parts.
fn page(tracer: &[u8], example: &str) -> Result<String> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(tracer)?;
    let tracer = BASE64.encode(packed.finish()?);
    let style = [pages::STYLE, include_str!("../../web/page/page.css")].concat();
    let parts = [
        ("style", style.as_str()),
        ("controls", &controls()),
        ("example", example),
        ("tracer", &tracer),
        ("worker", include_str!("../../web/page/worker.js")),
        ("script", include_str!("../../web/page/page.js")),
    ];
    Ok(parts
        .iter()
        .fold(PAGE.to_owned(), |page, (name, part)| page.replace(&format!("<!-- {name} -->"), part)))
}

/// An option for each control.
fn controls() -> String {
    let named = Control::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    named.map(|control| format!("<option>{}</option>", control.get_name())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every mark is replaced, and no part ends the element that it is in.
    #[test]
    fn the_page_has_all_its_parts() {
        let page = page(b"\0asm", "{}").unwrap();
        assert!(!page.contains("<!-- "));
        assert!(
            page.contains("<option>linuxcnc</option>") && page.contains("id=\"example-files\">{}</script>")
        );
        assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
        // What the page loads would be a link or an address.
        assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("src=\""));
    }
}
