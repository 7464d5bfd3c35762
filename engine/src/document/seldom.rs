//! What most nodes and wires do not have (remarks, tree operations, keys of other programs) costs them one pointer.

use std::ops::{Deref, DerefMut};

/// A value that is nearly always the default, and then takes no memory of its own. It is read and changed as the value.
#[derive(Clone, Debug)]
pub struct Seldom<T>(Option<Box<T>>);

/// A type with a default that lives for ever.
pub trait Nothing: Default + 'static {
    /// The default.
    fn nothing() -> &'static Self;
    /// True if nothing would be lost with this value.
    fn is_nothing(&self) -> bool;
}

impl<T> Default for Seldom<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T: Nothing> From<T> for Seldom<T> {
    fn from(value: T) -> Self {
        Self((!value.is_nothing()).then(|| Box::new(value)))
    }
}

impl<T: Nothing> Deref for Seldom<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_deref().unwrap_or_else(|| T::nothing())
    }
}

impl<T: Nothing> DerefMut for Seldom<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.get_or_insert_default()
    }
}

impl<T: Nothing> Seldom<T> {
    /// Gives the memory back if there is nothing in it.
    pub(crate) fn shrink(&mut self) {
        if self.0.as_ref().is_some_and(|value| value.is_nothing()) {
            self.0 = None;
        }
    }
}

impl<T: Nothing + PartialEq> PartialEq for Seldom<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}
