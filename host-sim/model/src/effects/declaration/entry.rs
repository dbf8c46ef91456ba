//! The entry of an effect in a file, before its kind is known.

use serde::de::{self, IntoDeserializer};
use serde::{Deserialize, Deserializer};

/// Value of a key of an effect's entry.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum EntryValue {
    /// Value of a parameter.
    Number(f64),
    /// Name of an effect, axis or channel.
    Text(String),
    /// Values of a list.
    List(Vec<f64>),
}

impl<E: de::Error> IntoDeserializer<'_, E> for EntryValue {
    type Deserializer = ValueDeserializer<E>;

    fn into_deserializer(self) -> ValueDeserializer<E> {
        ValueDeserializer { value: self, error: std::marker::PhantomData }
    }
}

/// Deserializes an [`EntryValue`].
pub struct ValueDeserializer<E> {
    value: EntryValue,
    error: std::marker::PhantomData<E>,
}

impl<'de, E: de::Error> Deserializer<'de> for ValueDeserializer<E> {
    type Error = E;

    fn deserialize_any<V: de::Visitor<'de>>(self, visitor: V) -> Result<V::Value, E> {
        match self.value {
            EntryValue::Number(number) => visitor.visit_f64(number),
            EntryValue::Text(text) => visitor.visit_string(text),
            EntryValue::List(list) => visitor.visit_seq(de::value::SeqDeserializer::new(list.into_iter())),
        }
    }

    fn deserialize_option<V: de::Visitor<'de>>(self, visitor: V) -> Result<V::Value, E> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: de::Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, E> {
        match self.value {
            EntryValue::Text(text) => text.into_deserializer().deserialize_enum(name, variants, visitor),
            EntryValue::Number(number) => Err(E::invalid_type(de::Unexpected::Float(number), &visitor)),
            EntryValue::List(_) => Err(E::invalid_type(de::Unexpected::Seq, &visitor)),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct
        newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}
