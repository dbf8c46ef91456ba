//! The rule by which the mean square of an error is shared among causes.
//!
//! The mean square v(S) of the error with the causes S is a game of cooperation, whose fair shares are the values of Shapley. They take
//! 2ⁿ simulations. Where displacements add up, v is quadratic, no more than two causes act together in a term, and the share of a cause is
//!
//! φ = ½·(v(alone) − v(none) + v(all) − v(all but it))
//!
//! What is left beyond that, by displacements that do not add up, is shared in proportion to |φ|, so that the shares are the whole.

/// What is known of a cause: the mean square of the error with it alone, and with all but it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// With this cause alone.
    pub alone: f64,
    /// With all causes but this one.
    pub without: f64,
}

/// The shares of causes in the mean square of an error, and the part of it that was shared in proportion, 0 to 1 and beyond. A share below
/// zero is that of a cause that makes others smaller.
#[must_use]
pub fn shares(whole: f64, causes: &[Measured]) -> (Vec<f64>, f64) {
    let mut shares: Vec<f64> =
        causes.iter().map(|cause| 0.5 * (cause.alone + whole - cause.without)).collect();
    let left = whole - shares.iter().sum::<f64>();
    let total: f64 = shares.iter().map(|share| share.abs()).sum();
    if total > 0.0 {
        for share in &mut shares {
            *share += left * share.abs() / total;
        }
    }
    (shares, if whole > 0.0 { left.abs() / whole } else { 0.0 })
}

/// The root of a share, with its sign: the squares of these, with their signs, add up to that of the whole.
#[must_use]
pub fn signed_root(share: f64) -> f64 {
    share.signum() * share.abs().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Mean square of the sum of displacements, over their samples.
    fn mean_square(causes: &[Vec<f64>], is_in: impl Fn(usize) -> bool) -> f64 {
        let samples = causes[0].len();
        let at = |i: usize| {
            let of_causes = causes.iter().enumerate().filter(|(cause, _)| is_in(*cause));
            of_causes.map(|(_, values)| values[i]).sum::<f64>().powi(2)
        };
        (0..samples).map(at).sum::<f64>() / samples as f64
    }

    /// The values of Shapley by their definition: the mean over all orders of what a cause adds to those before it.
    fn shapley(causes: &[Vec<f64>]) -> Vec<f64> {
        let count = causes.len();
        let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
        let of = |cause: usize| {
            let others = (0..1_usize << count).filter(|set| set & (1 << cause) == 0);
            others
                .map(|set| {
                    let size = set.count_ones() as usize;
                    let weight = factorial(size) * factorial(count - size - 1) / factorial(count);
                    let [with, without] = [set | 1 << cause, set]
                        .map(|set| mean_square(causes, |other| set & (1 << other) != 0));
                    weight * (with - without)
                })
                .sum()
        };
        (0..count).map(of).collect()
    }

    proptest! {
        /// Displacements that add up: the rule gives the values of Shapley, and they are the whole.
        #[test]
        fn shares_of_displacements_that_add_up_are_those_of_shapley(
            causes in prop::collection::vec(prop::collection::vec(-10.0..10.0_f64, 8), 1..6)
        ) {
            let whole = mean_square(&causes, |_| true);
            let measured: Vec<Measured> = (0..causes.len())
                .map(|cause| Measured {
                    alone: mean_square(&causes, |other| other == cause),
                    without: mean_square(&causes, |other| other != cause),
                })
                .collect();
            let (shares, left) = shares(whole, &measured);
            prop_assert!(left < 1e-9);
            for (share, exact) in shares.iter().zip(shapley(&causes)) {
                prop_assert!((share - exact).abs() < 1e-9 * whole.max(1.0), "{share} {exact}");
            }
        }

        /// Whatever acts together, the shares are the whole.
        #[test]
        fn shares_are_the_whole(
            whole in 0.1..100.0_f64,
            causes in prop::collection::vec((0.0..100.0_f64, 0.0..100.0_f64), 1..8)
        ) {
            let measured: Vec<Measured> =
                causes.into_iter().map(|(alone, without)| Measured { alone, without }).collect();
            let (shares, _) = shares(whole, &measured);
            let total = shares.iter().map(|share| share.abs()).sum::<f64>();
            prop_assume!(total > 1e-6);
            prop_assert!((shares.iter().sum::<f64>() - whole).abs() < 1e-9 * total.max(whole));
        }
    }

    #[test]
    fn a_cause_that_makes_another_smaller_has_a_share_below_zero() {
        let wave = vec![3.0, -3.0, 3.0, -3.0];
        let against: Vec<f64> = wave.iter().map(|value| -0.5 * value).collect();
        let causes = [wave, against];
        let whole = mean_square(&causes, |_| true);
        let measured = [0, 1].map(|cause| Measured {
            alone: mean_square(&causes, |other| other == cause),
            without: mean_square(&causes, |other| other != cause),
        });
        // 9, 2.25 and their product −4.5 each: shares 4.5 and −2.25 of 2.25.
        let (shares, _) = shares(whole, &measured);
        assert_eq!(shares, [4.5, -2.25]);
        assert!((signed_root(shares[1]) + 1.5).abs() < 1e-12);
    }
}
