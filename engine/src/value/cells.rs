//! What a column holds: many items, one, or a number; and all that can be done with it whatever the items are.
//! Each kind says where its items are; the rest is the same for all.

use super::column::Column;
use super::digest::{Digester, digest_number};
use super::item::{Item, Json};
use crate::stop::{self, STRIDE, Stoppable};
use std::any::{Any, TypeId};
use std::ops::Range;

/// Items of one type, and what was found out about them when they came.
trait Cells: Send + Sync + 'static {
    type Item: Item;
    fn items(&self) -> &[Self::Item];
    /// Which are none, if there are gaps.
    fn valid(&self) -> Option<&[bool]>;
    fn digest(&self) -> u128;
    /// Memory, the items' own heap included.
    fn bytes(&self) -> usize;
}

/// [`Cells`] of a type that only they know.
pub(super) trait ColumnData: Send + Sync {
    fn as_any(&self) -> &dyn Any;
    fn item_type(&self) -> TypeId;
    fn type_name(&self) -> &'static str;
    fn len(&self) -> usize;
    fn valid(&self) -> Option<&[bool]>;
    fn digest(&self) -> u128;
    fn bytes(&self) -> usize;
    fn item_json(&self, i: usize) -> Json;
    fn item_summary(&self, i: usize) -> String;
    fn pick(&self, order: &[Option<usize>]) -> Column;
    fn range(&self, range: Range<usize>) -> Column;
    fn concat(&self, all: &[Column]) -> Option<Column>;
    fn format(&self) -> u32;
    fn encode(&self, out: &mut Vec<u8>) -> bool;
    fn decode(&self, len: usize, valid: Option<Vec<bool>>, bytes: &mut &[u8]) -> Option<Column>;
}

/// Many items.
pub(super) struct Typed<T: Send + 'static> {
    pub items: Items<T>,
    /// Present only if there is at least one gap.
    pub valid: Option<Items<bool>>,
    pub digest: u128,
    pub bytes: usize,
}

/// Where the items of a column are.
pub(super) enum Items<T> {
    Own(Box<[T]>),
    Lent(Box<dyn AsRef<[T]> + Send + Sync>),
}

impl<T> std::ops::Deref for Items<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        match self {
            Self::Own(items) => items,
            Self::Lent(owner) => (**owner).as_ref(),
        }
    }
}

/// One item without a gap, which most columns are: one allocation, and nothing but the item in it.
pub(super) struct Single<T> {
    pub digest: u128,
    pub bytes: usize,
    pub item: T,
}

impl<T: Send + 'static> Drop for Typed<T> {
    fn drop(&mut self) {
        if let Items::Own(items) = &mut self.items {
            stop::let_go(std::mem::take(items).into_vec());
        }
    }
}

impl<T: Item> Cells for Typed<T> {
    type Item = T;

    fn items(&self) -> &[T] {
        &self.items
    }

    fn valid(&self) -> Option<&[bool]> {
        self.valid.as_deref()
    }

    fn digest(&self) -> u128 {
        self.digest
    }

    fn bytes(&self) -> usize {
        self.bytes
    }
}

impl<T: Item> Cells for Single<T> {
    type Item = T;

    fn items(&self) -> &[T] {
        std::slice::from_ref(&self.item)
    }

    fn valid(&self) -> Option<&[bool]> {
        None
    }

    fn digest(&self) -> u128 {
        self.digest
    }

    fn bytes(&self) -> usize {
        self.bytes
    }
}

/// A number is a column of one.
impl Cells for f64 {
    type Item = f64;

    fn items(&self) -> &[f64] {
        std::slice::from_ref(self)
    }

    fn valid(&self) -> Option<&[bool]> {
        None
    }

    fn digest(&self) -> u128 {
        digest_number(*self)
    }

    fn bytes(&self) -> usize {
        0
    }
}

impl<C: Cells> ColumnData for C {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn item_type(&self) -> TypeId {
        TypeId::of::<C::Item>()
    }

    fn type_name(&self) -> &'static str {
        C::Item::TYPE
    }

    fn len(&self) -> usize {
        self.items().len()
    }

    fn valid(&self) -> Option<&[bool]> {
        Cells::valid(self)
    }

    fn digest(&self) -> u128 {
        Cells::digest(self)
    }

    fn bytes(&self) -> usize {
        Cells::bytes(self)
    }

    fn item_json(&self, i: usize) -> Json {
        self.items().get(i).map_or(Json::Null, Item::to_json)
    }

    fn item_summary(&self, i: usize) -> String {
        self.items().get(i).map_or_else(String::new, Item::summary)
    }

    fn pick(&self, order: &[Option<usize>]) -> Column {
        let (items, gaps) = (self.items(), Cells::valid(self));
        let there = |i: &usize| *i < items.len() && gaps.is_none_or(|v| v[*i]);
        let picked = order.iter().stoppable().map(|i| i.filter(there).map(|i| items[i].clone()));
        Column::with_gaps(picked.collect())
    }

    fn range(&self, range: Range<usize>) -> Column {
        let mut items = Vec::with_capacity(range.len());
        copy(&self.items()[range.clone()], &mut items);
        Column::build(items, Cells::valid(self).map(|valid| valid[range].to_vec()))
    }

    fn concat(&self, all: &[Column]) -> Option<Column> {
        concat::<C::Item>(all)
    }

    fn format(&self) -> u32 {
        C::Item::FORMAT
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        let gaps = Cells::valid(self);
        let there = |i: usize| gaps.is_none_or(|v| v[i]);
        self.items().iter().stoppable().enumerate().all(|(i, item)| !there(i) || item.encode(out))
    }

    fn decode(&self, len: usize, valid: Option<Vec<bool>>, bytes: &mut &[u8]) -> Option<Column> {
        decode::<C::Item>(len, valid, bytes)
    }
}

/// Digest of type, items and gaps; `valid` tells which are none, if there are gaps.
pub(super) fn digest<T: Item>(items: &[T], valid: Option<&[bool]>) -> u128 {
    let mut d = Digester::new();
    d.str(T::TYPE);
    d.u64(items.len() as u64);
    match valid {
        None => {
            d.u8(0);
            T::digest_all(items, &mut d);
        }
        Some(valid) => {
            d.u8(1);
            for (item, ok) in items.iter().stoppable().zip(valid) {
                d.bool(*ok);
                if *ok {
                    item.digest(&mut d);
                }
            }
        }
    }
    d.finish()
}

/// A column of `len` items off the front of `bytes`; gaps have no bytes there.
fn decode<T: Item>(len: usize, valid: Option<Vec<bool>>, bytes: &mut &[u8]) -> Option<Column> {
    // Every item has a byte at least, so a length that is none does not take memory.
    if valid.as_ref().map_or(len > bytes.len(), |v| v.len() != len) {
        return None;
    }
    let mut items = Vec::with_capacity(len.min(bytes.len() / size_of::<T>().max(1) + 1));
    for i in (0..len).stoppable() {
        let there = valid.as_ref().is_none_or(|v| v[i]);
        items.push(if there { T::decode(bytes)? } else { T::default() });
    }
    Some(Column::build(items, valid))
}

/// Columns of one type one after another; `None` if one is of another type.
fn concat<T: Item>(all: &[Column]) -> Option<Column> {
    let total = all.iter().map(Column::len).sum();
    let (mut items, mut valid) = (Vec::with_capacity(total), Vec::new());
    let mut looked = 0;
    for column in all.iter().stoppable() {
        if let Some(v) = column.valid() {
            valid.reserve(total - valid.len());
            valid.resize(items.len(), true);
            valid.extend_from_slice(v);
        }
        copy(column.slice::<T>()?, &mut items);
        if items.len() - looked > STRIDE {
            looked = items.len();
            stop::check();
        }
    }
    let gaps = !valid.is_empty();
    if gaps {
        valid.resize(items.len(), true);
    }
    Some(Column::build(items, gaps.then_some(valid)))
}

/// Copies items, and looks in between whether to stop.
fn copy<T: Clone>(from: &[T], to: &mut Vec<T>) {
    for part in from.chunks(STRIDE) {
        to.extend_from_slice(part);
        if part.len() == STRIDE {
            stop::check();
        }
    }
}
