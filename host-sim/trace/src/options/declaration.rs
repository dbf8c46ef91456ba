//! How the options are declared, and scaled by name.

/// A number that a sweep can scale.
pub trait Scale {
    /// The number times a factor; a count is rounded, and at least 1.
    fn scaled(&self, factor: f64) -> Self;
}

impl Scale for f64 {
    fn scaled(&self, factor: f64) -> Self {
        self * factor
    }
}

impl Scale for usize {
    fn scaled(&self, factor: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at least 1, a small count"
        )]
        let scaled = (*self as f64 * factor).round().max(1.0) as Self;
        scaled
    }
}

/// Declares the structs of the options with their defaults, and [`TraceOptions`](super::TraceOptions) with its names.
macro_rules! options {
    ($(
        $(#[doc = $group_doc:literal])+
        $group:ident: $Group:ident {
            $( $(#[doc = $doc:literal])+ $name:ident: $Number:ty = $default:expr, )+
        }
    )+) => {
        $(
            $(#[doc = $group_doc])+
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $Group {
                $(
                    $(#[doc = $doc])+
                    #[doc = concat!("\n\nDefault: ", stringify!($default))]
                    pub $name: $Number,
                )+
            }

            impl Default for $Group {
                fn default() -> Self {
                    Self { $( $name: $default, )+ }
                }
            }
        )+

        /// The thresholds of a trace, by what they decide.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct TraceOptions {
            $( $(#[doc = $group_doc])+ pub $group: $Group, )+
        }

        impl TraceOptions {
            /// The names of all options, as in `search.min_t`.
            pub const NAMES: &[&str] = &[$($( concat!(stringify!($group), ".", stringify!($name)), )+)+];

            /// These options with the one of this name multiplied by a factor; a count is rounded, and at least 1.
            /// `None` for an unknown name.
            #[must_use]
            pub fn scaled(&self, name: &str, factor: f64) -> Option<Self> {
                let mut options = *self;
                $($(
                    if name == concat!(stringify!($group), ".", stringify!($name)) {
                        options.$group.$name = Scale::scaled(&self.$group.$name, factor);
                        return Some(options);
                    }
                )+)+
                None
            }

            /// The option of this name as it is printed; `None` for an unknown name.
            #[must_use]
            pub fn value(&self, name: &str) -> Option<String> {
                $($(
                    if name == concat!(stringify!($group), ".", stringify!($name)) {
                        return Some(self.$group.$name.to_string());
                    }
                )+)+
                None
            }
        }
    };
}

pub(super) use options;
