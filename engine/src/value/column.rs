//! A column: many items of one type in one allocation, immutable, with the gaps that failed items left.
//! Digest and size are made once, when the column is built.

use super::cells::{ColumnData, Items, Single, Typed, digest};
use super::digest::digest_number;
use super::item::{Item, Json};
use crate::stop::{Pending, Stoppable};
use std::any::{Any, TypeId};
use std::sync::Arc;

/// Items of one type with optional gaps. Clones share the data.
#[derive(Clone)]
pub struct Column(Data);

/// One number, which is what most columns of parameters are, takes no memory beside the column.
#[derive(Clone)]
enum Data {
    Number(f64),
    Shared(Arc<dyn ColumnData>),
}

impl Column {
    fn data(&self) -> &dyn ColumnData {
        match &self.0 {
            Data::Number(v) => v,
            Data::Shared(data) => &**data,
        }
    }

    /// A column without gaps. O(n): the digest is made here.
    #[must_use]
    pub fn new<T: Item>(items: Vec<T>) -> Self {
        Self::build(items, None)
    }

    /// A column of one item: what [`Column::new`] makes of a list of one, without the list.
    #[must_use]
    pub fn single<T: Item>(item: T) -> Self {
        if let Some(v) = (&item as &dyn Any).downcast_ref::<f64>() {
            return Self(Data::Number(*v));
        }
        let digest = digest(std::slice::from_ref(&item), None);
        let bytes = size_of::<Single<T>>() + item.heap_bytes();
        Self(Data::Shared(Arc::new(Single { digest, bytes, item })))
    }

    /// A column without gaps of items that somebody else owns: `owner` is kept as long as they are looked at, and must
    /// give the same items every time. One item alone is copied. O(n): the digest is made here.
    #[must_use]
    pub fn lent<T: Item>(owner: impl AsRef<[T]> + Send + Sync + 'static) -> Self {
        match owner.as_ref() {
            [one] => Self::single(one.clone()),
            _ => Self::typed(Items::Lent(Box::new(owner)), None),
        }
    }

    /// The same with gaps: `valid` tells per item whether it is there, and is kept as well. O(n). Items that it does not
    /// tell of are gaps.
    #[must_use]
    pub fn lent_with_gaps<T: Item>(
        owner: impl AsRef<[T]> + Send + Sync + 'static,
        valid: impl AsRef<[bool]> + Send + Sync + 'static,
    ) -> Self {
        let (told, items) = (valid.as_ref(), owner.as_ref().len());
        let valid = match told.len() == items {
            true if !told.contains(&false) => return Self::lent(owner),
            true => Items::Lent(Box::new(valid)),
            false => Items::Own(padded(told.to_vec(), items).into()),
        };
        Self::typed(Items::Lent(Box::new(owner)), Some(valid))
    }

    fn typed<T: Item>(items: Items<T>, valid: Option<Items<bool>>) -> Self {
        let digest = digest(&items, valid.as_deref());
        let bytes = size_of::<Typed<T>>()
            + size_of_val(&*items)
            + items.iter().map(Item::heap_bytes).sum::<usize>()
            + valid.as_ref().map_or(0, |v| v.len());
        Self(Data::Shared(Arc::new(Typed { items, valid, digest, bytes })))
    }

    /// A column of items of which some are gaps: `valid` tells per item whether it is there. What stands in a gap is never
    /// looked at. O(n) for the digest; both lists are kept as they are. Items that `valid` does not tell of are gaps.
    #[must_use]
    pub fn with_valid<T: Item>(items: Vec<T>, valid: Vec<bool>) -> Self {
        let valid = padded(valid, items.len());
        Self::build(items, Some(valid))
    }

    /// A column in which `None` is a gap. O(n).
    #[must_use]
    pub fn with_gaps<T: Item>(items: Vec<Option<T>>) -> Self {
        let valid: Vec<bool> = items.iter().stoppable().map(Option::is_some).collect();
        // Not in place: such a list would have to be shrunk, which copies it as a whole.
        let mut all = Vec::with_capacity(items.len());
        all.extend(Pending::new(items).each().stoppable().map(Option::unwrap_or_default));
        Self::build(all, Some(valid))
    }

    pub(crate) fn build<T: Item>(mut items: Vec<T>, valid: Option<Vec<bool>>) -> Self {
        let valid = valid.filter(|v| v.contains(&false)).map(|v| Items::Own(v.into_boxed_slice()));
        if items.len() == 1
            && valid.is_none()
            && let Some(item) = items.pop()
        {
            return Self::single(item);
        }
        Self::typed(Items::Own(items.into_boxed_slice()), valid)
    }

    /// The number, if that is all that the column is.
    #[inline]
    pub(crate) fn as_number(&self) -> Option<f64> {
        match &self.0 {
            Data::Number(v) => Some(*v),
            Data::Shared(_) => None,
        }
    }

    /// Items and gaps together.
    #[must_use]
    pub fn len(&self) -> usize {
        if self.as_number().is_some() { 1 } else { self.data().len() }
    }

    /// True if there is no item and no gap.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Name of the item type.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        self.data().type_name()
    }

    pub(crate) fn item_type(&self) -> TypeId {
        if self.as_number().is_some() { TypeId::of::<f64>() } else { self.data().item_type() }
    }

    /// All items as a slice, if they are of type `T`; what stands in a gap means nothing, ask [`Column::is_valid`].
    #[must_use]
    pub fn slice<T: Item>(&self) -> Option<&[T]> {
        let any = match &self.0 {
            Data::Number(v) => return (v as &dyn Any).downcast_ref::<T>().map(std::slice::from_ref),
            Data::Shared(data) => data.as_any(),
        };
        match any.downcast_ref::<Single<T>>() {
            Some(single) => Some(std::slice::from_ref(&single.item)),
            None => any.downcast_ref::<Typed<T>>().map(|typed| &*typed.items),
        }
    }

    /// Item `i`; `None` for a gap, past the end, or if the items are not of type `T`.
    #[must_use]
    pub fn get<T: Item>(&self, i: usize) -> Option<&T> {
        let any = match &self.0 {
            Data::Number(v) => return (v as &dyn Any).downcast_ref::<T>().filter(|_| i == 0),
            Data::Shared(data) => data.as_any(),
        };
        if let Some(single) = any.downcast_ref::<Single<T>>() {
            return (i == 0).then_some(&single.item);
        }
        let typed = any.downcast_ref::<Typed<T>>()?;
        match &typed.valid {
            Some(valid) if !valid.get(i).copied().unwrap_or(false) => None,
            _ => typed.items.get(i),
        }
    }

    /// True if item `i` is there and not a gap.
    #[must_use]
    pub fn is_valid(&self, i: usize) -> bool {
        match self.data().valid() {
            Some(valid) => valid.get(i).copied().unwrap_or(false),
            None => i < self.len(),
        }
    }

    /// True if at least one item is a gap.
    #[must_use]
    pub fn has_gaps(&self) -> bool {
        self.as_number().is_none() && self.data().valid().is_some()
    }

    /// Digest of type, items and gaps.
    #[must_use]
    pub fn digest(&self) -> u128 {
        match &self.0 {
            Data::Number(v) => digest_number(*v),
            Data::Shared(data) => data.digest(),
        }
    }

    /// Memory in bytes, the items' own heap included.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.data().bytes()
    }

    /// A list of the items' JSON, `null` at gaps.
    #[must_use]
    pub fn to_json(&self) -> Json {
        Json::Array((0..self.len()).map(|i| self.item_json(i)).collect())
    }

    /// The JSON of item `i`; `null` for a gap and past the end.
    #[must_use]
    pub fn item_json(&self, i: usize) -> Json {
        if self.is_valid(i) { self.data().item_json(i) } else { Json::Null }
    }

    /// One line about item `i` for people; empty for a gap.
    #[must_use]
    pub fn summary(&self, i: usize) -> String {
        if self.is_valid(i) { self.data().item_summary(i) } else { String::new() }
    }

    /// A column of the items at `order`; `None` and gaps give gaps. Works for any item type. O(n).
    #[must_use]
    pub fn pick(&self, order: &[Option<usize>]) -> Self {
        self.data().pick(order)
    }

    /// The items of a range that lies in the column. O(its length).
    pub(super) fn range(&self, range: std::ops::Range<usize>) -> Self {
        self.data().range(range)
    }

    /// Per item whether it is there; `None`: all are.
    #[must_use]
    pub fn valid(&self) -> Option<&[bool]> {
        self.data().valid()
    }

    /// Version of what [`Column::encode`] writes; 0: items of this type cannot be kept.
    pub(crate) fn format(&self) -> u32 {
        self.data().format()
    }

    /// Appends the items, without their number and the gaps; false if one cannot be kept.
    pub(crate) fn encode(&self, out: &mut Vec<u8>) -> bool {
        self.format() > 0 && self.data().encode(out)
    }

    /// A column of this one's type from what [`Column::encode`] has written.
    pub(crate) fn decode(&self, len: usize, valid: Option<Vec<bool>>, bytes: &mut &[u8]) -> Option<Self> {
        self.data().decode(len, valid, bytes)
    }

    /// All columns one after another; `None` if there is none or their types differ. O(n).
    #[must_use]
    pub fn concat(all: &[Self]) -> Option<Self> {
        match all {
            [one] => Some(one.clone()),
            [first, ..] => first.data().concat(all),
            [] => None,
        }
    }
}

/// As many entries as there are items; those that were missing say no.
fn padded(mut valid: Vec<bool>, items: usize) -> Vec<bool> {
    valid.resize(items, false);
    valid
}

impl std::fmt::Debug for Column {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.type_name(), self.to_json())
    }
}

impl PartialEq for Column {
    fn eq(&self, other: &Self) -> bool {
        self.digest() == other.digest()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_keeps_its_place() {
        let c = Column::with_gaps(vec![Some(1.0), None, Some(3.0)]);
        assert_eq!((c.len(), c.get::<f64>(0), c.get::<f64>(1), c.get::<f64>(2)), (3, Some(&1.0), None, Some(&3.0)));
        assert_eq!(c.to_json(), serde_json::json!([1.0, null, 3.0]));
    }

    #[test]
    fn what_stands_in_a_gap_makes_no_difference() {
        let gaps = Column::with_gaps(vec![Some(1.0), None, Some(3.0)]);
        let own = Column::with_valid(vec![1.0, 2.0, 3.0], vec![true, false, true]);
        let items: &'static [f64] = &[1.0, f64::NAN, 3.0];
        let lent = Column::lent_with_gaps(items, [true, false, true]);
        assert_eq!(lent.slice::<f64>().map(<[f64]>::as_ptr), Some(items.as_ptr()));
        assert_eq!((&own, &lent), (&gaps, &gaps));
        assert_eq!((own.pick(&[Some(1), Some(2)]), lent.get::<f64>(1)), (gaps.pick(&[Some(1), Some(2)]), None));
        assert_eq!(Column::lent_with_gaps(&items[..1], [true]), Column::new(vec![1.0]));
        // Items that nothing is said of are gaps.
        let short = Column::with_gaps(vec![Some(1.0), None, None]);
        assert_eq!(Column::lent_with_gaps(items, [true]), short);
        assert_eq!(Column::with_valid(vec![1.0, 2.0, 3.0], vec![true]), short);
    }

    #[test]
    fn numbers_are_equal_by_bits_and_any_nan_is_one() {
        assert_eq!(Column::new(vec![f64::NAN]), Column::single(-f64::NAN));
        assert_ne!(Column::single(0.0), Column::single(-0.0));
    }

    #[test]
    fn digest_tells_type_gap_and_order() {
        let all = [
            Column::new(vec![0.0]),
            Column::new(vec![0i64]),
            Column::with_gaps::<f64>(vec![None]),
            Column::new(vec![1.0, 2.0]),
            Column::new(vec![2.0, 1.0]),
            Column::new::<f64>(vec![]),
        ];
        for (i, a) in all.iter().enumerate() {
            for (j, b) in all.iter().enumerate() {
                assert_eq!(a == b, i == j, "{a:?} {b:?}");
            }
        }
        assert_eq!(Column::new(vec![1.0]), Column::with_gaps(vec![Some(1.0)]));
    }

    #[test]
    fn concat_keeps_gaps() {
        let c =
            Column::concat(&[Column::new(vec![1.0]), Column::with_gaps(vec![None, Some(2.0)]), Column::new(vec![3.0])]);
        assert_eq!(c.map(|c| c.to_json()), Some(serde_json::json!([1.0, null, 2.0, 3.0])));
        assert!(Column::concat(&[Column::new(vec![1.0]), Column::new(vec![1i64])]).is_none());
    }
}
