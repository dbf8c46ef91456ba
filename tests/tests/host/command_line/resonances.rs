//! `resonances`, against a mode that is integrated here, and against SciPy's spectrum.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::import_formats::python;
use super::work_folder::WorkFolder;

const RATE_HZ: f64 = 1600.0;

/// Uniform numbers between −1 and 1.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || random.random_range(-1.0..1.0)
}

/// Sweep of `TEST_RESONANCES`: its acceleration, 75 mm/s² per Hz, grows with its frequency, here from 5 to 133 Hz within 64 s.
fn sweep(seconds: f64) -> f64 {
    let [start_hz, hz_per_s] = [5.0, 2.0];
    let phase = TAU * (start_hz * seconds + 0.5 * hz_per_s * seconds * seconds);
    75.0 * (start_hz + hz_per_s * seconds) * phase.sin()
}

/// Acceleration of a mass on a spring and a damper on a base that is accelerated: with z the travel of the mass over the base,
/// z̈ = −a − 2ζω·ż − ω²·z, the mass has the acceleration −2ζω·ż − ω²·z. By Runge and Kutta, eight steps a sample.
struct Mode {
    omega: f64,
    ratio: f64,
    state: [f64; 2],
}

impl Mode {
    fn new(hz: f64, ratio: f64) -> Self {
        Self { omega: TAU * hz, ratio, state: [0.0; 2] }
    }

    fn after(&mut self, base: impl Fn(f64) -> f64, start_s: f64) -> f64 {
        let force = |[z, v]: [f64; 2]| -2.0 * self.ratio * self.omega * v - self.omega.powi(2) * z;
        let slope = |at: [f64; 2], time_s: f64| [at[1], force(at) - base(time_s)];
        let step = 1.0 / (8.0 * RATE_HZ);
        let moved = |from: [f64; 2], by: [f64; 2], h: f64| [from[0] + h * by[0], from[1] + h * by[1]];
        let mut state = self.state;
        for i in 0..8 {
            let t = start_s + f64::from(i) * step;
            let a = slope(state, t);
            let b = slope(moved(state, a, 0.5 * step), t + 0.5 * step);
            let c = slope(moved(state, b, 0.5 * step), t + 0.5 * step);
            let d = slope(moved(state, c, step), t + step);
            let sum = [0, 1].map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0);
            state = moved(state, sum, step);
        }
        let acceleration = force(state);
        self.state = state;
        acceleration
    }
}

/// A file of 64 s as `AccelQueryHelper.write_to_file` of Klipper writes it, with noise of the sensor in all axes.
fn file(mut x: impl FnMut(usize) -> f64, mut y: impl FnMut(usize) -> f64) -> String {
    let mut noise = noise(7);
    let mut text = "#time,accel_x,accel_y,accel_z\n".to_owned();
    for i in 0..102_400_usize {
        let [a, b, c] = [x(i), y(i), 9810.0].map(|value| value + 60.0 * noise());
        text += &format!("{:.6},{a:.6},{b:.6},{c:.6}\n", 1000.0 + i as f64 / RATE_HZ);
    }
    text
}

/// The peaks of an axis.
fn peaks(folder: &WorkFolder, axis: usize) -> Vec<serde_json::Value> {
    serde_json::from_str::<serde_json::Value>(&folder.read("out.json")).unwrap()["axes"][axis]["peaks"]
        .as_array()
        .unwrap()
        .clone()
}

/// Asserts that the interval of a value contains the true one, and is at most so wide, relative to it.
fn contains(value: &serde_json::Value, truth: f64, most: f64) {
    let [low, high] = ["low", "high"].map(|end| value[end].as_f64().unwrap());
    assert!(low < truth && truth < high && high - low < most * truth, "{truth}: {value}");
}

/// A sweep shakes a mode of 47.3 Hz in x, and two in y; z has noise alone.
#[test]
fn a_sweep_shows_frequency_and_damping_of_the_modes() {
    let at = |i: usize| i as f64 / RATE_HZ;
    let [mut x, mut low, mut high] = [Mode::new(47.3, 0.06), Mode::new(31.0, 0.05), Mode::new(88.0, 0.04)];
    let text = file(|i| x.after(sweep, at(i)), |i| low.after(sweep, at(i)) + 0.7 * high.after(sweep, at(i)));
    let folder = WorkFolder::with(&[("raw.csv", &text)]);
    let stdout = folder.succeeds("resonances raw.csv --json out.json");
    assert!(
        stdout.contains("x: a resonance at 47.") && stdout.contains("z: no resonance found."),
        "{stdout}"
    );
    let [found] = &peaks(&folder, 0)[..] else { panic!("{stdout}") };
    assert_eq!(found["kind"], "mode");
    // The sweep is quasi-static: it takes 3 s for the 5.7 Hz of this peak, in which a transient decays by e⁻⁵⁰.
    contains(&found["frequency_hz"], 47.3, 0.05);
    contains(&found["damping_ratio"], 0.06, 0.5);
    let mut both = peaks(&folder, 1);
    both.sort_by(|a, b| {
        a["frequency_hz"]["value"].as_f64().unwrap().total_cmp(&b["frequency_hz"]["value"].as_f64().unwrap())
    });
    let [first, second] = &both[..] else { panic!("{stdout}") };
    for (found, hz) in [(first, 31.0), (second, 88.0)] {
        // Each mode also passes on the base at the other's frequency: the sum deviates from single modes by some percent.
        let value = found["frequency_hz"]["value"].as_f64().unwrap();
        assert!((value / hz - 1.0).abs() < 0.02, "{stdout}");
    }
    // SciPy reads the file as Klipper's scripts do, and has the same density.
    let script = "import json, numpy as np, scipy.signal as s\n\
                  d = np.loadtxt('raw.csv', comments='#', delimiter=',')\n\
                  out = json.load(open('out.json'))\n\
                  rate = (len(d) - 1) / (d[-1, 0] - d[0, 0])\n\
                  for i, axis in enumerate(out['axes']):\n\
                  \x20   own = np.array(axis['density_m2_per_s4_per_hz'])\n\
                  \x20   f, p = s.welch(1e-3 * d[:, i + 1], rate, 'hann', 2 * len(own), len(own), detrend='constant')\n\
                  \x20   print(np.max(np.abs(own[2:] / p[2:-1] - 1)), abs(f[1] / axis['step_hz'] - 1))";
    let Some(compared) = python(folder.path(), "numpy, scipy", script) else { return };
    // Bins 0 and 1 differ: what the window makes of the mean is taken away here.
    for number in compared.split_whitespace() {
        assert!(number.parse::<f64>().unwrap() < 1e-6, "{compared}");
    }
}

/// A random acceleration of the base shows the mode, too; a fan of 180 Hz is a forced vibration.
#[test]
fn random_accelerations_show_the_mode_and_a_fan_is_none() {
    let at = |i: usize| i as f64 / RATE_HZ;
    let mut blows = noise(3);
    let mut mode = Mode::new(62.0, 0.08);
    let mut hum = noise(5);
    let text = file(
        |i| {
            let blow = 3000.0 * blows();
            mode.after(|_| blow, at(i))
        },
        |i| 400.0 * (TAU * 180.0 * at(i)).sin() + 30.0 * hum(),
    );
    let folder = WorkFolder::with(&[("raw.csv", &text)]);
    let stdout = folder.succeeds("resonances raw.csv --json out.json");
    let [found] = &peaks(&folder, 0)[..] else { panic!("{stdout}") };
    contains(&found["frequency_hz"], 62.0, 0.06);
    contains(&found["damping_ratio"], 0.08, 0.6);
    let [fan] = &peaks(&folder, 1)[..] else { panic!("{stdout}") };
    assert_eq!(fan["kind"], "narrow", "{stdout}");
    let hz = fan["frequency_hz"].as_f64().unwrap();
    assert!((hz - 180.0).abs() < 0.8, "{stdout}");
    assert!(stdout.contains("y: no resonance found; one further peak is no resolved resonance."), "{stdout}");
}

/// A rigid tool moves with the sweep, whose end at 133 Hz is no resonance.
#[test]
fn the_end_of_a_sweep_is_no_resonance() {
    let at = |i: usize| i as f64 / RATE_HZ;
    let text = file(|i| sweep(at(i)), |_| 0.0);
    let folder = WorkFolder::with(&[("raw.csv", &text)]);
    let stdout = folder.succeeds("resonances raw.csv --json out.json");
    assert!(stdout.contains("x: no resonance found"), "{stdout}");
    assert!(peaks(&folder, 0).iter().all(|peak| peak["kind"] != "mode"), "{stdout}");
}

#[test]
fn a_short_file_is_refused() {
    let folder = WorkFolder::with(&[(
        "raw.csv",
        "#time,accel_x,accel_y,accel_z\n0,1,2,3\n0.001,1,2,3\n0.002,1,2,3\n",
    )]);
    let message = folder.fails("resonances raw.csv", 2);
    assert!(
        message.contains("raw.csv: expected samples of 3 s or more, at 60 Hz or more, found 3 at 1000 Hz"),
        "{message}"
    );
}
