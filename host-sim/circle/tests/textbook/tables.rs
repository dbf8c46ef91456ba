//! Tables of a ballbar's radius.

use circle::measured::Measured;
use circle::radius_table::Nominal;
use circle::{Analysis, analyse};
use files::table::Table;

use super::generator::Circle;
use super::judge::sweep;

/// The table of a circle: its radius over the nominal angle, in both directions.
pub fn table(circle: &Circle) -> String {
    let samples = circle.samples();
    let noise = circle.noise(2, samples.len());
    let mut csv = "time_s,angle_deg,radius_mm\n".to_owned();
    for ((time_s, theta, at), noise) in samples.iter().zip(noise) {
        let Some(at) = at else { continue };
        let [x, y] = circle.displacement(*at);
        let radius_um =
            (1e3 * circle.radius_mm * theta.cos() + x).hypot(1e3 * circle.radius_mm * theta.sin() + y);
        let angle_deg = theta.to_degrees().rem_euclid(360.0);
        csv += &format!("{time_s:.6},{angle_deg:.6},{:.7}\n", 1e-3 * (radius_um + noise));
    }
    csv
}

/// What a table shows.
pub fn of_table(csv: &str, nominal: Nominal) -> Analysis {
    let table = Table::parse(csv.as_bytes(), "ballbar.csv").unwrap();
    let tables = vec![(table, "ballbar.csv".to_owned())];
    analyse(Measured::of_radius_tables(tables, nominal).unwrap()).unwrap()
}

fn of_circle(circle: &Circle) -> Analysis {
    let nominal = Nominal { radius_mm: Some(circle.radius_mm), ..Nominal::default() };
    of_table(&table(circle), nominal)
}

/// As for logs; the radius alone separates the parts by their angle, direction and time.
#[test]
fn parts_of_a_radius_are_found_under_white_noise() {
    let coverage = sweep(60, 0.0, of_circle);
    assert!(coverage.all > 150, "{coverage:?}");
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}

#[test]
fn parts_of_a_radius_are_found_under_correlated_noise() {
    let coverage = sweep(60, 0.03, of_circle);
    assert!((0.90..=0.999).contains(&coverage.fraction()), "{coverage:?}");
}
