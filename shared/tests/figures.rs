//! The figures for people against libm, over the whole range of each, and the table of `docs/firmware.md` that has the errors. `BLESS=1`
//! writes the table again.

use std::fs;
use std::path::Path;

use shared::figures::{EncoderSignals, Thermistor, ThermistorSettings, rms};

/// A row of the table: figure, range of its inputs, unit of the error, and the greatest error.
struct Row {
    figure: &'static str,
    range: &'static str,
    unit: &'static str,
    error: f64,
}

/// Amplitude limits of the settings for 12 bits.
const LIMITS: [u16; 2] = [1050, 1950];

/// Signals of a converter of 12 bits on a grid of angles and amplitudes.
fn signals() -> impl Iterator<Item = EncoderSignals> {
    let amplitudes = (1..=2047).step_by(6);
    amplitudes.flat_map(|amplitude| {
        (0..720).map(move |half_degrees| {
            let angle = (f64::from(half_degrees) / 2.0).to_radians();
            #[expect(clippy::cast_possible_truncation, reason = "at most 2047 counts")]
            let [sine, cosine] = [libm::sin(angle), libm::cos(angle)]
                .map(|part| libm::rint(f64::from(amplitude) * part) as i32);
            EncoderSignals { sine, cosine, limits: LIMITS }
        })
    })
}

/// The greatest error over pairs of a figure and its exact value.
fn greatest(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    pairs.map(|(figure, exact)| (figure - exact).abs()).fold(0.0, f64::max)
}

fn exact_amplitude(signals: &EncoderSignals) -> f64 {
    libm::hypot(f64::from(signals.sine), f64::from(signals.cosine))
}

fn amplitude() -> f64 {
    greatest(signals().map(|s| (f64::from(s.figures().amplitude_counts), exact_amplitude(&s))))
}

fn level() -> f64 {
    greatest(
        signals()
            .map(|s| (f64::from(s.figures().level_db), 20.0 * libm::log10(exact_amplitude(&s) / 1500.0))),
    )
}

fn phase() -> f64 {
    greatest(signals().map(|s| {
        let exact = libm::atan2(f64::from(s.sine), f64::from(s.cosine)).to_degrees();
        let off = f64::from(s.figures().phase_deg) - exact;
        // −180° is 180°.
        ((off + 180.0).rem_euclid(360.0) - 180.0, 0.0)
    }))
}

fn health() -> f64 {
    greatest(signals().map(|s| {
        let exact = 100.0 * (1.0 - (exact_amplitude(&s) - 1500.0).abs() / 450.0);
        (f64::from(s.figures().health_percent), exact.max(0.0))
    }))
}

/// Relative, over sums of squares from 1 to the largest one.
fn root() -> f64 {
    greatest((0..6300).map(|k| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁶³")]
        let sum = libm::exp2(f64::from(k) / 100.0) as u64;
        (f64::from(rms(sum, 20_000)) / libm::sqrt(sum as f64 / 20_000.0), 1.0)
    }))
}

fn temperature() -> f64 {
    let settings =
        ThermistorSettings { resistance_25_ohm: 1e4, beta_k: 3950.0, series_ohm: 1e4, full_counts: 4096 };
    let thermistor = Thermistor::new(&settings, 80_000).unwrap();
    greatest((1..4096u16).filter_map(|counts| {
        let ratio = f64::from(counts) / f64::from(4096 - counts);
        let exact = 1.0 / (1.0 / 298.15 + libm::log(ratio) / 3950.0) - 273.15;
        Some((f64::from(thermistor.temperature_mc(counts)?) / 1e3, exact))
    }))
}

fn rows() -> [Row; 6] {
    let row = |figure, range, unit, error| Row { figure, range, unit, error };
    let signals = "12 bits: amplitudes of 1 to 2047 counts, every half degree";
    [
        row("amplitude of the signals", signals, "counts", amplitude()),
        row("level of the signals", signals, "dB", level()),
        row("phase of the signals", signals, "°", phase()),
        row("health of the signals", signals, "%", health()),
        row("rms", "sums of squares up to 2⁶³, 20,000 values", "of the value", root()),
        row(
            "temperature of a thermistor",
            "β = 3950 K, 10 kΩ, 12 bits: every count from −40 °C to 150 °C",
            "K",
            temperature(),
        ),
    ]
}

/// An error with two digits, rounded up.
fn two_digits(value: f64) -> String {
    let unit = libm::pow(10.0, libm::floor(libm::log10(value)) - 1.0);
    let rounded = libm::ceil(value / unit - 1e-9) * unit;
    if rounded < 1e-3 { format!("{rounded:.1e}") } else { format!("{rounded:.*}", digits(unit)) }
}

fn digits(unit: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 4")]
    let digits = (-libm::log10(unit)).round().max(0.0) as usize;
    digits
}

/// Each error is above 0, as an exact function would not be that of `micromath`, and below what a person reads.
#[test]
fn the_errors_of_the_figures_are_those_of_the_page() {
    let rows = rows();
    for (row, most) in rows.iter().zip([0.05, 0.05, 0.3, 0.05, 1e-4, 0.5]) {
        let Row { figure, error, .. } = row;
        assert!(*error > 1e-7 && *error < most, "{figure}: {error}, at most {most}");
    }
    let shown: Vec<String> = rows
        .iter()
        .map(|row| format!("| {} | {} | {} {} |", row.figure, row.range, two_digits(row.error), row.unit))
        .collect();
    let table = format!("| figure | range | greatest error |\n|---|---|---|\n{}\n", shown.join("\n"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("firmware.md");
    let text = fs::read_to_string(&path).unwrap();
    let start = text.find("| figure | range | greatest error |").expect("the table of the figures");
    let end = start + text[start..].find("\n\n").expect("text behind the table") + 1;
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, format!("{}{table}{}", &text[..start], &text[end..])).unwrap();
    } else {
        assert_eq!(text[start..end], table, "docs/firmware.md: BLESS=1 rewrites the table");
    }
}
