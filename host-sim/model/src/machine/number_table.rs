//! A table of a machine file whose values are optional numbers.

/// Declares the struct of such a table, with the method `all`, which returns its keys and values.
macro_rules! number_table {
    ($(#[$table_doc:meta])* $Table:ident { $( $(#[$key_doc:meta])* $key:ident, )+ }) => {
        $(#[$table_doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $Table {
            $(
                $(#[$key_doc])*
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $key: Option<f64>,
            )+
        }

        impl $Table {
            /// All keys with their values, in the order of a written file.
            pub fn all(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> {
                [$( (stringify!($key), self.$key), )+].into_iter()
            }
        }
    };
}

pub(super) use number_table;
