//! A motion of an hour with many shapes.

/// Longest duration, s. The simulator ends a motion after one hour; what is added takes a few seconds at most.
const DURATION_S: f64 = 3570.0;
/// Largest distance from the origin in each axis, mm.
const FAR_MM: f64 = 95.0;

/// Reproducible choices (Knuth's linear congruential generator; the upper bits are used).
struct Choice(u64);

impl Choice {
    /// Uniform in 0 to 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }

    fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.uniform()
    }

    fn one_of(&mut self, values: &[f64]) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let index = (self.uniform() * values.len() as f64) as usize;
        values[index.min(values.len() - 1)]
    }
}

/// The path so far.
struct Path {
    text: String,
    at_mm: [f64; 2],
    duration_s: f64,
}

/// Rounded to micrometres, as in the file.
fn rounded(mm: f64) -> f64 {
    (1e3 * mm).round() / 1e3
}

impl Path {
    /// A block of a length at a feed (mm/s) and an acceleration (m/s²), and its duration with a trapezoid of the speed.
    fn block(&mut self, shape: &str, length_mm: f64, [feed, acceleration]: [f64; 2]) {
        self.text += &format!(
            "[[block]]\n{shape}\nfeed_mm_per_min = {:?}\nacceleration_m_per_s2 = {acceleration:?}\n\n",
            60.0 * feed
        );
        let ramps_mm = feed * feed / (1e3 * acceleration);
        self.duration_s += if length_mm > ramps_mm {
            length_mm / feed + feed / (1e3 * acceleration)
        } else {
            2.0 * (length_mm / (1e3 * acceleration)).sqrt()
        };
    }

    fn line(&mut self, to_mm: [f64; 2], speed: [f64; 2]) {
        let to_mm = to_mm.map(|mm| rounded(mm.clamp(-FAR_MM, FAR_MM)));
        let length_mm = (to_mm[0] - self.at_mm[0]).hypot(to_mm[1] - self.at_mm[1]);
        if length_mm > 0.5 {
            self.block(
                &format!("line_to_mm = {{ x = {:?}, y = {:?} }}", to_mm[0], to_mm[1]),
                length_mm,
                speed,
            );
            self.at_mm = to_mm;
        }
    }

    /// Turns about a point at an angle from the current one, if they stay within the travel.
    fn circle(&mut self, radius_mm: f64, angle: f64, turns: f64, [feed, acceleration]: [f64; 2]) {
        let centre = [self.at_mm[0] + radius_mm * angle.cos(), self.at_mm[1] + radius_mm * angle.sin()];
        let centre = centre.map(rounded);
        if centre.iter().any(|mm| mm.abs() + radius_mm > FAR_MM) {
            return;
        }
        let arc = format!(
            "arc = {{ plane = [\"x\", \"y\"], centre_mm = {{ x = {:?}, y = {:?} }}, turns = {turns:?} }}",
            centre[0], centre[1]
        );
        let feed = feed.min((1e3 * acceleration * radius_mm).sqrt());
        self.block(&arc, std::f64::consts::TAU * radius_mm * turns.abs(), [feed, acceleration]);
        if turns.fract() != 0.0 {
            self.at_mm = [0, 1].map(|axis| rounded(2.0 * centre[axis] - self.at_mm[axis]));
        }
    }

    fn pause(&mut self, duration_s: f64) {
        self.text += &format!("[[block]]\ndwell_s = {duration_s:.2}\n\n");
        self.duration_s += duration_s;
    }
}

/// The text of the motion file.
pub fn of_one_hour() -> String {
    let head = "name = \"one hour\"\nfeed_mm_per_min = 3000.0\nacceleration_m_per_s2 = 2.0\n\
                start_mm = { x = 0.0, y = 0.0 }\n\n";
    let mut path = Path { text: head.to_owned(), at_mm: [0.0; 2], duration_s: 0.0 };
    let mut choice = Choice(5);
    while path.duration_s < DURATION_S {
        let feed = choice.one_of(&[5.0, 13.0, 25.0, 50.0, 75.0, 100.0]);
        let speed = [feed, choice.one_of(&[0.5, 1.0, 2.0, 3.0])];
        match choice.uniform() {
            kind if kind < 0.35 => {
                let to = [choice.within(-FAR_MM, FAR_MM), choice.within(-FAR_MM, FAR_MM)];
                path.line(to, speed);
            }
            kind if kind < 0.5 => {
                let by = choice.within(5.0, 60.0) * choice.one_of(&[-1.0, 1.0]);
                let [x, y] = path.at_mm;
                path.line(if choice.uniform() < 0.5 { [x + by, y] } else { [x, y + by] }, speed);
            }
            kind if kind < 0.9 => {
                let radius_mm = choice.one_of(&[2.0, 5.0, 10.0, 20.0, 40.0]);
                let angle = choice.within(0.0, std::f64::consts::TAU);
                let turns = choice.one_of(&[1.0, 1.0, 2.0, -1.0, -2.0, 0.5, -0.5]);
                path.circle(radius_mm, angle, turns, speed);
            }
            _ => path.pause(choice.within(0.1, 1.0)),
        }
    }
    path.text
}
