//! Presliding: friction builds up over micrometres.

use serde::{Deserialize, Serialize};

use super::{Coordinate, Kind, Stage, Surroundings};

/// Where the machine file declares none: bristles of stiffness σ0 and damping σ1 (`LuGre`), which the
/// table bends before it slides. At a reversal friction then turns over a way of Coulomb friction/σ0
/// instead of at once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Presliding {
    /// σ0.
    pub stiffness_n_per_um: f64,
    /// σ1.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
}

impl Kind for Presliding {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let is_declared = around.axis.mechanics.presliding_stiffness_n_per_um.is_some();
        let slides = around.axis.mechanics.coulomb_n.is_some_and(|coulomb_n| coulomb_n > 0.0);
        let ways_um: &[f64] =
            if around.shows_friction_alone() && slides && !is_declared { &[5.0, 20.0] } else { &[] };
        let coulomb_n = around.axis.mechanics.coulomb_n.unwrap_or(0.0);
        let over = |way_um: &f64| Self { stiffness_n_per_um: coulomb_n / way_um, damping_n_s_per_m: 0.0 };
        ways_um.iter().map(over).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            // Far from here the derivative is another one: no step goes beyond a factor of two.
            Coordinate::between(
                self.stiffness_n_per_um,
                0.05 * self.stiffness_n_per_um,
                0.5 * self.stiffness_n_per_um,
                2.0 * self.stiffness_n_per_um,
            )
            .stepwise(),
            Coordinate::between(self.damping_n_s_per_m, 100.0, 0.0, 2.0 * self.damping_n_s_per_m + 500.0)
                .stepwise(),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { stiffness_n_per_um: x[0], damping_n_s_per_m: x[1] }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("stiffness_n_per_um", self.stiffness_n_per_um), ("damping_n_s_per_m", self.damping_n_s_per_m)]
    }
}
