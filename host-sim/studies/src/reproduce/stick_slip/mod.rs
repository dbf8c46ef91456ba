//! Stick-slip in the circular test (Chattopadhyay 2008).
//!
//! [`table_model`] is the paper's equation of motion, [`contributors`] the other errors of a circle that it lists.

pub mod contributors;
pub mod laps;
pub mod table_model;

use super::ballbar::{Ballbar, from_axis_rad};
use super::{Outcome, Picture, Printed, ReproduceError, Study};
use contributors::{Contributor, SHOWN};
use report::number::{fixed, significant};
use report::plot::{Chart, Ink, Layer};
use report::polar::{division_for, drawing};
use table_model::{Circle, Deviations, RADIUS_M, SPEEDS_RAD_PER_S, TABLES};

/// Printed for the lower speed, µm.
const ERRORS_UM: Printed = Printed::Between(2.0, 3.0);

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold or an integration fails.
pub fn run() -> Result<Study, ReproduceError> {
    let [lower, higher] = SPEEDS_RAD_PER_S;
    let laps = [Stick::at(lower)?, Stick::at(higher)?];
    let bent = SHOWN
        .iter()
        .map(|contributor| Ok((contributor, contributor.ballbar()?)))
        .collect::<Result<Vec<_>, ReproduceError>>()?;
    let mut outcomes = stick_slip_outcomes(&laps);
    outcomes.extend(bent.iter().filter_map(|(contributor, ballbar)| shape(contributor, ballbar)));
    let mut said = vec![said_of_friction()];
    said.extend(bent.iter().map(|(contributor, ballbar)| size(contributor, ballbar)));
    let mut pictures = vec![friction_picture(), deviation_picture(&laps)];
    pictures.push(polar("Stick-slip at 1.5 rad/s", &Contributor::StickSlip.words(), &laps[1].ballbar));
    pictures.extend(
        bent.iter().map(|(contributor, ballbar)| polar(contributor.name(), &contributor.words(), ballbar)),
    );
    Ok(Study {
        paper: "Chattopadhyay 2008",
        title: "Stick-slip in the circular test",
        said,
        outcomes,
        pictures,
        notes: notes(&laps),
    })
}

/// The paper's tables on the circle at one speed.
struct Stick {
    lap: Deviations,
    ballbar: Ballbar,
}

impl Stick {
    fn at(speed_rad_per_s: f64) -> Result<Self, ReproduceError> {
        let lap = Deviations::on(Circle { speed_rad_per_s })?;
        Ok(Self { lap, ballbar: table_model::ballbar(speed_rad_per_s)? })
    }

    /// From the nearest quadrant change to the greatest radial error.
    fn off_axis_degrees(&self) -> f64 {
        from_axis_rad(self.ballbar.positive.greatest_rad()).to_degrees()
    }
}

fn stick_slip_outcomes([lower, higher]: &[Stick; 2]) -> Vec<Outcome> {
    let (slow_um, fast_um) = (lower.lap.swing_um(), higher.lap.swing_um());
    let radial_um = [lower, higher].map(|stick| stick.ballbar.circular_deviation_um());
    let [near, nearer] = [lower, higher].map(Stick::off_axis_degrees);
    // Nearer to an axis than to a diagonal.
    let at_an_axis = || Printed::Below(22.5);
    let more = Printed::Above(1.0);
    vec![
        Outcome::new("deviation of X from end to end, 0.5 rad/s", ERRORS_UM, slow_um[0], "µm"),
        Outcome::new("deviation of Y from end to end, 0.5 rad/s", ERRORS_UM, slow_um[1], "µm"),
        Outcome::new("deviation of X, 1.5 over 0.5 rad/s", more.clone(), fast_um[0] / slow_um[0], ""),
        Outcome::new("deviation of Y, 1.5 over 0.5 rad/s", more.clone(), fast_um[1] / slow_um[1], ""),
        Outcome::new("the same error read radially, 0.5 rad/s", ERRORS_UM, radial_um[0], "µm"),
        Outcome::new("radial error, 1.5 over 0.5 rad/s", more, radial_um[1] / radial_um[0], ""),
        Outcome::new("quadrant change to greatest radial error, 0.5 rad/s", at_an_axis(), near, "°"),
        Outcome::new("quadrant change to greatest radial error, 1.5 rad/s", at_an_axis(), nearer, "°"),
    ]
}

/// What the paper says of a contributor's shape, without a figure or with the angle of it.
fn shape(contributor: &Contributor, ballbar: &Ballbar) -> Option<Outcome> {
    let jump = from_axis_rad(ballbar.positive.jump_rad()).to_degrees();
    match contributor {
        Contributor::Squareness { .. } => {
            let share = ballbar.positive.oval_share().min(ballbar.negative.oval_share());
            Some(Outcome::new("squareness: share of the oval in the error", Printed::Above(0.5), share, ""))
        }
        Contributor::Backlash { width_um } => {
            let [x, y] = ballbar.reversal_um();
            let share = 0.5 * (x + y) / width_um;
            Some(Outcome::new("backlash: reversal value over its width", Printed::Above(0.5), share, ""))
        }
        Contributor::MasterSlaveChangeover { .. } => {
            let printed = Printed::Figure { value: 45.0, tolerance: 0.5 };
            Some(Outcome::new("changeover: the glitch, from an axis", printed, jump, "°"))
        }
        _ => None,
    }
}

/// Why nothing swings up by itself.
fn said_of_friction() -> String {
    let most_m_per_s = SPEEDS_RAD_PER_S[1] * RADIUS_M;
    let [x, y] = TABLES.each_ref().map(|table| {
        let fall = table_model::steepest_fall_n_s_per_m(&table.friction(), most_m_per_s);
        format!("{} against {} N·s/m", significant(fall, 3), significant(table.damping_n_s_per_m, 4))
    });
    format!(
        "The steepest fall of friction with speed against the damping of the drive: {x} on X, {y} on Y. Neither table \
         swings up by itself. What is left is friction turning over at each reversal on a drive that gives way, which is \
         where the error stands."
    )
}

/// Circular deviation and reversal value of a contributor in a sentence.
fn size(contributor: &Contributor, ballbar: &Ballbar) -> String {
    let [x, y] = ballbar.reversal_um();
    let expected = contributor.expected_um().map_or(String::new(), |expected| {
        format!(
            "; in closed form {} and {} µm",
            significant(expected.circular_deviation_um, 3),
            significant(expected.reversal_um, 3)
        )
    });
    format!(
        "{}, {}: circular deviation G {} µm, reversal value B {} µm on X and {} µm on Y{expected}.",
        contributor.name(),
        contributor.words(),
        significant(ballbar.circular_deviation_um(), 3),
        rounded(x),
        rounded(y),
    )
}

/// To 0.01 µm: what the reading of a reversal value leaves of an oval is no value.
fn rounded(um: f64) -> String {
    fixed(um, 2)
}

fn friction_picture() -> Picture {
    let friction = TABLES[0].friction();
    let most = SPEEDS_RAD_PER_S[1] * RADIUS_M;
    let point = |i: i32| {
        let v = most * f64::from(i) / 300.0;
        (1e3 * v, friction.coefficient(v))
    };
    let caption = "The coefficient of friction as it is printed, over the speeds of the circle at 1.5 rad/s.";
    let chart = Chart {
        size: (960, 220),
        title: "Coefficient of friction over velocity",
        description: caption,
        x: "velocity, mm/s",
        y: "coefficient μ",
        noise: 0.0,
        layers: vec![Layer { ink: Ink::After, points: (-300..=300).map(point).collect(), is_marked: false }],
    };
    Picture {
        title: "Friction that falls and rises".to_owned(),
        svg: chart.svg(),
        caption: caption.to_owned(),
        keys: Vec::new(),
    }
}

/// The paper's third figure: both tables over a lap, at both speeds, over the angle so that they compare.
fn deviation_picture(laps: &[Stick; 2]) -> Picture {
    let inks = [[Ink::Before, Ink::After], [Ink::Third, Ink::Fourth]];
    let layer = |(stick, ink, axis): (&Stick, Ink, usize)| {
        let degrees = |time_s: f64| 360.0 * time_s / stick.lap.circle.lap_s();
        let points = stick.lap.points.iter().step_by(5).map(|(t, x)| (degrees(*t), 1e6 * x[axis])).collect();
        Layer { ink, points, is_marked: false }
    };
    let lines = laps.iter().zip(inks).flat_map(|(stick, ink)| [(stick, ink[0], 0), (stick, ink[1], 1)]);
    let caption = "How far each table stands off its drive, over a lap that begins at +X.";
    let chart = Chart {
        size: (960, 260),
        title: "Deviation of both tables over a lap",
        description: caption,
        x: "angle, °",
        y: "deviation, µm",
        noise: 0.0,
        layers: lines.map(layer).collect(),
    };
    let keys = [
        ("before", "X, 0.5 rad/s"),
        ("after", "Y, 0.5 rad/s"),
        ("cw", "X, 1.5 rad/s"),
        ("ccw", "Y, 1.5 rad/s"),
    ];
    Picture {
        title: "Deviations of the tables (the paper's Figure 3)".to_owned(),
        svg: chart.svg(),
        caption: caption.to_owned(),
        keys: keys.map(|(class, words)| (class, words.to_owned())).to_vec(),
    }
}

/// A ballbar picture.
fn polar(name: &str, words: &str, ballbar: &Ballbar) -> Picture {
    let (positive, negative) = (ballbar.positive.outline(), ballbar.negative.outline());
    let most = numerics::max_abs(positive.iter().chain(&negative).map(|point| point.1));
    let division_um = division_for(most);
    let [x, y] = ballbar.reversal_um();
    let caption = format!(
        "{name}, {words}: G {} µm, B {} µm on X and {} µm on Y, greatest distance of the directions H {} µm. One division is \
         {} µm.",
        significant(ballbar.circular_deviation_um(), 3),
        rounded(x),
        rounded(y),
        rounded(ballbar.hysteresis_um()),
        significant(division_um, 1),
    );
    let title = format!("{name}: radial deviation over the angle");
    let lines = [("cw", &negative[..]), ("ccw", &positive[..])];
    Picture {
        title: name.to_owned(),
        svg: drawing(&title, &caption, &lines, division_um, ["X", "Y"]),
        caption,
        keys: vec![("cw", "clockwise".to_owned()), ("ccw", "counter-clockwise".to_owned())],
    }
}

/// What the print leaves open.
fn notes([lower, higher]: &[Stick; 2]) -> Vec<String> {
    let words = |[x, y]: [f64; 2]| format!("{} µm on X and {} µm on Y", significant(x, 3), significant(y, 3));
    let (slow_um, fast_um) = (lower.lap.swing_um(), higher.lap.swing_um());
    let radial_um = [lower, higher].map(|stick| significant(stick.ballbar.circular_deviation_um(), 3));
    let turning_degrees = [lower, higher].map(|stick| {
        let path_m_per_s = RADIUS_M * stick.lap.circle.speed_rad_per_s;
        significant((1.0 / (TABLES[0].friction().alpha * path_m_per_s)).asin().to_degrees(), 2)
    });
    vec![
        format!(
            "Which error is 2 to 3 µm is not printed; the figure that it is read from shows the deviations of X and Y over \
             time, of which the text is kept but not the picture. From end to end they are {} at 0.5 rad/s and {} at 1.5 \
             rad/s: Y is beyond 3 µm at the lower speed already. Half of that, an amplitude, would be below 2 µm on both \
             axes.",
            words(slow_um),
            words(fast_um),
        ),
        format!(
            "Read radially, as a circular deviation about the least-squares circle, the error is {} and {} µm at the two \
             speeds: less than printed at the lower one. There the friction of X and Y, which point against the motion \
             together, shift the table along the circle and not off it, but for the quadrant changes.",
            radial_um[0], radial_um[1],
        ),
        "α is printed in s²/m², β in s/m, and v without unit. tanh αv has to change its sign with v, so α is read in s/m \
         and v counts in m/s; counted in mm/s, the square alone would make a coefficient of 200 at 50 mm/s."
            .to_owned(),
        "The inertia of X has a minus in equation 10 and a plus in 14. Equations 2 and 8 lead to the plus, which is \
         integrated. Beside the friction the sign has no weight: reversed, each deviation runs backwards in time with the \
         same least and greatest values."
            .to_owned(),
        "The two speeds of the figure are printed as 0.5 and 0.5 rad/s; before that, 0.5 and 1.5, which is what was run."
            .to_owned(),
        "The start is not printed. From rest Y meets its whole friction at once and swings to nearly twice its deviation, \
         as a spring with 1 % of damping does; here a lap passes before one is kept."
            .to_owned(),
        format!(
            "The greatest error is said to stand where a speed is close to zero, without a figure: it counts as agreeing \
             when it is nearer to an axis than to a diagonal. Friction turns over while the speed rises to 1/α = 20 mm/s, \
             which takes {}° of the lap at 0.5 rad/s, so that it agrees by little there, and {}° at 1.5.",
            turning_degrees[0], turning_degrees[1],
        ),
        "Glitches of the master–slave changeover are said to come every 45 degrees. The axes change parts where their \
         speeds are equal, which is on the diagonals, 45 degrees from either axis: four times a lap, not eight."
            .to_owned(),
        "Of the contributors the paper gives no sizes: those here were chosen to be seen at one scale. The figures are the \
         circular deviation G of ISO 230-4 in the worse direction, and B as ISO 230-2 has it, read from 3 to 20 degrees \
         beside each axis's reversals; what ISO 230-4 itself compares the directions with is their greatest distance H. \
         The paper's friction is not yet turned over at 3 degrees: its B is what a rounded crossing leaves, and no lost \
         motion."
            .to_owned(),
    ]
}
