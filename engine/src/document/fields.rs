//! A small sorted map: a node has a handful of parameters and wires, and a tree map would take a kilobyte for each.

/// A name in a document: an id, a port, a `node.port`, a node type. Up to 15 bytes lie in place, longer ones are shared by
/// all clones.
pub type Name = ecow::EcoString;

/// Values by name, sorted; for few names. Lookup O(log n), insertion O(n).
#[derive(Clone, Debug, PartialEq)]
pub struct Fields<V>(Box<[(Name, V)]>);

impl<V> Default for Fields<V> {
    fn default() -> Self {
        Self(Box::default())
    }
}

impl<V> Fields<V> {
    /// Without names.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    fn find(&self, name: &str) -> Result<usize, usize> {
        self.0.binary_search_by(|(n, _)| n.as_str().cmp(name))
    }

    /// The value of that name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&V> {
        self.find(name).ok().and_then(|i| self.0.get(i)).map(|(_, v)| v)
    }

    /// The value of that name, to change.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut V> {
        self.find(name).ok().and_then(|i| self.0.get_mut(i)).map(|(_, v)| v)
    }

    /// True if there is a value of that name.
    #[must_use]
    pub fn contains_key(&self, name: &str) -> bool {
        self.find(name).is_ok()
    }

    /// Sets a value; gives the one before.
    pub fn insert(&mut self, name: impl Into<Name>, value: impl Into<V>) -> Option<V> {
        let (name, value) = (name.into(), value.into());
        match self.find(&name) {
            Ok(i) => Some(std::mem::replace(&mut self.0[i].1, value)),
            Err(i) => {
                self.change(|all| {
                    all.reserve_exact(1);
                    all.insert(i, (name, value));
                });
                None
            }
        }
    }

    fn change<R>(&mut self, change: impl FnOnce(&mut Vec<(Name, V)>) -> R) -> R {
        let mut all = std::mem::take(&mut self.0).into_vec();
        let result = change(&mut all);
        self.0 = all.into_boxed_slice();
        result
    }

    /// Takes a value away.
    pub fn remove(&mut self, name: &str) -> Option<V> {
        self.find(name).ok().map(|i| self.change(|all| all.remove(i).1))
    }

    /// Names and values in order of names.
    pub fn iter(&self) -> impl Iterator<Item = (&Name, &V)> {
        self.0.iter().map(|(n, v)| (n, v))
    }

    /// Names in order.
    pub fn keys(&self) -> impl Iterator<Item = &Name> {
        self.0.iter().map(|(n, _)| n)
    }

    /// Values in order of names.
    pub fn values(&self) -> impl Iterator<Item = &V> {
        self.0.iter().map(|(_, v)| v)
    }

    /// Number of names.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// True if there is no name.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<V> FromIterator<(Name, V)> for Fields<V> {
    fn from_iter<I: IntoIterator<Item = (Name, V)>>(iter: I) -> Self {
        let mut fields = Self::new();
        for (name, value) in iter {
            fields.insert(name, value);
        }
        fields
    }
}

impl<'a, V> IntoIterator for &'a Fields<V> {
    type Item = (&'a Name, &'a V);
    type IntoIter = std::iter::Map<std::slice::Iter<'a, (Name, V)>, fn(&'a (Name, V)) -> (&'a Name, &'a V)>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter().map(|(n, v)| (n, v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn behaves_like_a_sorted_map(steps in proptest::collection::vec(("[a-e]{1,2}", proptest::option::of(0u8..9)), 0..40)) {
            let (mut a, mut b) = (Fields::new(), BTreeMap::new());
            for (name, value) in steps {
                match value {
                    Some(v) => prop_assert_eq!(a.insert(&*name, v), b.insert(Name::from(name), v)),
                    None => prop_assert_eq!(a.remove(&name), b.remove(name.as_str())),
                }
            }
            prop_assert!(a.iter().eq(b.iter()) && a.len() == b.len());
        }
    }
}
