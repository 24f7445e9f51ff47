//! Named values in their order, as plain data.

use serde::{Serialize, Serializer};

/// Pairs as an object that keeps their order: for `#[serde(serialize_with)]`.
///
/// # Errors
/// Those of the serializer.
pub fn as_map<S: Serializer, K: Serialize, V: Serialize>(
    list: &[(K, V)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(list.iter().map(|(name, value)| (name, value)))
}

/// The same as a value of its own.
#[derive(Clone, Debug)]
pub struct Object<K, V>(pub Vec<(K, V)>);

impl<K: Serialize, V: Serialize> Serialize for Object<K, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        as_map(&self.0, serializer)
    }
}
