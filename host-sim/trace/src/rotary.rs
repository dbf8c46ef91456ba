//! Keys of rotary axes in results: degrees for mm, N·m for N, and so 1000° for a metre.

/// How keys of linear axes end, and what stands there instead; longer ones first.
const ENDS: [(&str, &str); 13] = [
    ("um_s2_per_m", "mdeg_s2_per_kdeg"),
    ("um_per_m2", "mdeg_per_kdeg2"),
    ("um_per_m", "mdeg_per_kdeg"),
    ("n_per_um", "nm_per_mdeg"),
    ("n_s_per_m", "nm_s_per_kdeg"),
    ("mm_s", "deg_s"),
    ("um", "mdeg"),
    ("mm", "deg"),
    ("percent", "percent"),
    ("ms", "ms"),
    ("rad", "rad"),
    ("hz", "hz"),
    ("n", "nm"),
];

/// The key of a rotary axis's parameter, of which a linear one would have this key. The value is the same.
#[must_use]
pub fn key(linear: &str) -> String {
    let of = |(end, rotary): &(&str, &str)| {
        let name = linear.strip_suffix(end)?;
        (name.is_empty() || name.ends_with('_')).then(|| format!("{name}{rotary}"))
    };
    ENDS.iter().find_map(of).unwrap_or_else(|| linear.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_say_degrees_and_newton_metres() {
        let pairs = [
            ("stiffness_n_per_um", "stiffness_nm_per_mdeg"),
            ("slope_um_per_m", "slope_mdeg_per_kdeg"),
            ("width_um", "width_mdeg"),
            ("period_mm", "period_deg"),
            ("friction_n", "friction_nm"),
            ("velocity_mm_s", "velocity_deg_s"),
            ("damping_ratio", "damping_ratio"),
            ("phase_rad", "phase_rad"),
            ("ms", "ms"),
        ];
        for (linear, rotary) in pairs {
            assert_eq!(key(linear), rotary);
        }
    }
}
