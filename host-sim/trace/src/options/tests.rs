use super::*;

#[test]
fn an_option_is_scaled_by_its_name_alone() {
    let default = TraceOptions::default();
    let doubled = default.scaled("search.min_t", 2.0).unwrap();
    assert_eq!(doubled.search.min_t.to_bits(), 7.0f64.to_bits());
    assert_eq!(doubled.scaled("search.min_t", 0.5), Some(default));
    assert_eq!(default.scaled("min_t", 2.0), None);
    for name in TraceOptions::NAMES {
        assert_ne!(default.scaled(name, 2.0).unwrap(), default, "{name}");
        assert_ne!(default.scaled(name, 2.0).unwrap().value(name), default.value(name));
    }
}

#[test]
fn a_count_is_rounded_and_at_least_one() {
    let options = TraceOptions::default();
    assert_eq!(options.scaled("exclusion.max_count", 0.1).unwrap().exclusion.max_count, 1);
    // 0.75 × 5 = 3.75.
    assert_eq!(options.scaled("search.fitted_candidates", 0.75).unwrap().search.fitted_candidates, 4);
}
