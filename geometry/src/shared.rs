//! Arrays that several may hold: our own, or lent by somebody who keeps them as they are.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::any::Any;
use std::ops::Deref;
use std::sync::Arc;

/// Whoever keeps a lent array: it stays where and as it is while this lives.
pub type Owner = Arc<dyn Any + Send + Sync>;

/// The large arrays of meshes, curves and panel sets. A clone shares the items, O(1); reading is a slice's. Items that a
/// program outside lends stay in its memory.
pub struct Shared<T: 'static>(Held<T>);

enum Held<T: 'static> {
    Own(Arc<Vec<T>>),
    /// An empty array has no owner.
    Lent(&'static [T], Option<Owner>),
}

impl<T> Shared<T> {
    /// Items that `owner` keeps. O(1).
    #[must_use]
    pub fn lent(items: &'static [T], owner: Owner) -> Self {
        Self(Held::Lent(items, Some(owner)))
    }
}

impl<T: Clone> Shared<T> {
    /// The items to be changed: as they are if nobody else holds them, a copy otherwise. O(1) or O(n); where many items are
    /// made, a `Vec` is made first, since every call looks who else is there.
    pub fn to_mut(&mut self) -> &mut Vec<T> {
        if let Held::Lent(items, _) = self.0 {
            self.0 = Held::Own(Arc::new(items.to_vec()));
        }
        match &mut self.0 {
            Held::Own(items) => Arc::make_mut(items),
            Held::Lent(..) => unreachable!("it was made our own above"),
        }
    }
}

impl<T> Deref for Shared<T> {
    type Target = [T];
    #[inline]
    fn deref(&self) -> &[T] {
        match &self.0 {
            Held::Own(items) => items,
            Held::Lent(items, _) => items,
        }
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(match &self.0 {
            Held::Own(items) => Held::Own(items.clone()),
            Held::Lent(items, owner) => Held::Lent(items, owner.clone()),
        })
    }
}

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(Held::Lent(&[], None))
    }
}

impl<T> From<Vec<T>> for Shared<T> {
    fn from(items: Vec<T>) -> Self {
        Self(Held::Own(Arc::new(items)))
    }
}

impl<T> FromIterator<T> for Shared<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        items.into_iter().collect::<Vec<T>>().into()
    }
}

impl<'a, T> IntoIterator for &'a Shared<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: PartialEq, S: AsRef<[T]>> PartialEq<S> for Shared<T> {
    fn eq(&self, other: &S) -> bool {
        **self == *other.as_ref()
    }
}

impl<T> AsRef<[T]> for Shared<T> {
    fn as_ref(&self) -> &[T] {
        self
    }
}

impl<T: Serialize> Serialize for Shared<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        (**self).serialize(to)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Shared<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Vec::deserialize(from).map(Self::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_until_one_is_changed() {
        let all: Shared<i32> = (0..3).collect();
        let mut other = all.clone();
        assert_eq!(all.as_ptr(), other.as_ptr());
        other.to_mut().push(3);
        assert_eq!((&*all, &*other), (&[0, 1, 2][..], &[0, 1, 2, 3][..]));
        let at = other.as_ptr();
        other.to_mut()[0] = 7;
        assert_eq!((other.as_ptr(), other[0]), (at, 7));
    }

    #[test]
    fn what_is_lent_stays_where_it_is_and_is_let_go() {
        static ITEMS: [u8; 3] = [1, 2, 3];
        let owner: Owner = Arc::new(());
        let left = Arc::downgrade(&owner);
        let mut lent = Shared::lent(&ITEMS, owner);
        let other = lent.clone();
        assert_eq!((lent.as_ptr(), other.as_ptr()), (ITEMS.as_ptr(), ITEMS.as_ptr()));
        lent.to_mut()[0] = 9;
        assert_eq!((&*lent, &*other), (&[9, 2, 3][..], &ITEMS[..]));
        assert!(left.upgrade().is_some());
        drop(other);
        assert!(left.upgrade().is_none(), "nobody looks at it any more");
    }
}
