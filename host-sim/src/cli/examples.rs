//! Examples below the help of each verb.

/// Verbs with lines that can be typed.
pub const ALL: [(&str, &[&str]); 27] = [
    (
        "trace",
        &[
            "lost-motion trace --machine M.toml --fit circle.csv --fit travel.csv --validate corner.csv --model better.toml",
            "lost-motion trace --machine M.toml --fit circle.csv --report report --serial 4711 --operator \"A. Smith\" --date today",
            "lost-motion trace --machine M.toml --fit circle.csv --limit G=8 --limit corner=15 --check",
            "lost-motion trace --machine M.toml --fit scope.csv --map \"x_command_mm=X cmd\" --rate 1000",
        ],
    ),
    (
        "circle",
        &[
            "lost-motion circle circle.csv --report report",
            "lost-motion circle cw.csv ccw.csv --json circle.json",
            "lost-motion circle ballbar.csv --radius 100 --feed 1000",
        ],
    ),
    (
        "positions",
        &[
            "lost-motion positions --fit x.csv --validate later.csv --report report",
            "lost-motion positions --fit laser.txt --map \"target_mm=Nominal position\" --map measured_mm=Laser --model found.toml",
        ],
    ),
    (
        "volume",
        &[
            "lost-motion volume --survey survey.toml --report report",
            "lost-motion volume --survey survey.toml --out errors.csv --step 25 --format linuxcnc --out-dir remedy",
        ],
    ),
    (
        "budget",
        &[
            "lost-motion budget --model better.toml",
            "lost-motion budget --model better.toml --motion pocket.toml --report report",
        ],
    ),
    (
        "history",
        &[
            "lost-motion trace --machine M.toml --fit circle.csv --date 2026-11-27 --json traces/2026-11-27.json",
            "lost-motion history traces --report report",
            "lost-motion history traces --limit x.backlash.width_um=8 --check",
        ],
    ),
    (
        "init",
        &[
            "lost-motion init --log circle.csv --log travel.csv --out M.toml",
            "lost-motion init --log circle.csv --set x.lead_mm=10 --out M.toml",
        ],
    ),
    (
        "import",
        &[
            "lost-motion import scope.csv --map \"x_command_mm=X cmd\" --unit x_command_mm=inch --rate 1000 --out log.csv",
            "lost-motion import samples.txt --preset halsampler --map x_command_mm=1 --map x_motor_mm=2 --rate 1000 --out log.parquet",
        ],
    ),
    (
        "resonances",
        &[
            "lost-motion resonances raw_data_x.csv",
            "lost-motion resonances raw_data_x.csv --json resonances.json",
        ],
    ),
    ("app", &["lost-motion app --out lost-motion.html"]),
    (
        "compensate",
        &[
            "lost-motion compensate --model better.toml --out C.toml",
            "lost-motion compensate --model better.toml --out C.toml --format linuxcnc --out-dir hal",
        ],
    ),
    (
        "verify",
        &[
            "lost-motion verify --machine M.toml --before circle.csv --after again.csv",
            "lost-motion verify --machine M.toml --before circle.csv --after again.csv --predicted C.toml --limit G=8 --check",
        ],
    ),
    (
        "tune",
        &[
            "lost-motion tune --machine better.toml --motion circle.toml --out tuned.toml",
            "lost-motion tune --machine M.toml --measured response_x.json --measured response_y.json --out tuned.toml",
        ],
    ),
    ("gcode", &["lost-motion gcode --motion circle.toml --format linuxcnc --out circle.ngc"]),
    (
        "plan",
        &[
            "lost-motion plan --model better.toml --within circle.csv --out P.toml",
            "lost-motion plan --model better.toml --within circle.csv --out P.toml --gcode P.ngc --format linuxcnc",
            "lost-motion plan --model better.toml --travel x=-50..200 --speed-mm-per-s 80 --acceleration-m-per-s2 2 --out P.toml",
        ],
    ),
    (
        "margins",
        &[
            "lost-motion margins --machine better.toml",
            "lost-motion margins --machine better.toml --compensation C.toml --json margins.json",
        ],
    ),
    (
        "simulate",
        &[
            "lost-motion simulate --machine M.toml --motion circle.toml --out circle.csv",
            "lost-motion simulate --machine M.toml --motion circle.toml --compensation C.toml --out again.csv",
        ],
    ),
    (
        "improve",
        &[
            "lost-motion improve --machine M.toml --plant true.toml --fit travel.toml --motion circle.toml --out better",
        ],
    ),
    (
        "record",
        &[
            "lost-motion record --port emulated --motion circle.toml --out circle.csv",
            "lost-motion record --port /dev/ttyACM0 --machine M.toml --motion circle.toml --out circle.csv.gz --yes",
        ],
    ),
    (
        "board",
        &[
            "lost-motion board ports",
            "lost-motion board status --port emulated",
            "lost-motion board stop --port emulated      also while another program holds the port",
            "lost-motion board upload --port /dev/ttyACM0 --machine M.toml",
            "lost-motion board response --port emulated --axis x --force-n 80 --out FRF.json",
            "lost-motion board anticogging --port /dev/ttyACM0 --axis x --machine M.toml --out C.toml",
        ],
    ),
    (
        "demo",
        &["lost-motion demo --seed 7 --report report", "lost-motion demo --machines 20 --second-simulator"],
    ),
    ("compare", &["lost-motion compare --hours 0.1 --report report"]),
    ("reproduce", &["lost-motion reproduce --report report"]),
    ("sensors", &["lost-motion sensors --report report"]),
    (
        "self-test",
        &[
            "lost-motion self-test --cases 5 --seed 3 --report report",
            "lost-motion self-test --cases 2 --kind textbook,coarse --keep cases --no-trace",
        ],
    ),
    ("completions", &["lost-motion completions bash"]),
    ("man", &["lost-motion man --out-dir man"]),
];
