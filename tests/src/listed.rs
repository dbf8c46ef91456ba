//! Tests with a list of their names, which can be compared with a catalogue.

/// One test per effect, under its name, and the list of these names.
#[macro_export]
macro_rules! tested {
    ($($module:ident: $($name:ident),+;)+) => {
        $($(
            #[test]
            fn $name() {
                $module::$name();
            }
        )+)+

        const TESTED: &[&str] = &[$($(stringify!($name)),+),+];
    };
}
