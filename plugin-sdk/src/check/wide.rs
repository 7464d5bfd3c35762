//! Inputs as a newer host lays them out: its structs have grown at their ends, so they lie further apart. A plugin that
//! goes from one to the next by its own `sizeof` and not by the stride that it is told reads rubbish.

use crate::abi::value::*;
use crate::load::Views;
use std::ffi::c_void;

/// By how much every struct has grown, bytes, and what stands there.
const MORE: usize = 16;
const RUBBISH: u64 = 0xA5A5_A5A5_A5A5_A5A5;

/// Copies that views lead to.
#[derive(Default)]
pub(super) struct Wide(Vec<Vec<u64>>);

impl Wide {
    /// `count` structs of `size` bytes, `size + MORE` apart.
    ///
    /// # Safety
    /// There are so many at `from`.
    unsafe fn spread(&mut self, from: *const c_void, count: u64, size: usize) -> *mut c_void {
        let words = (size + MORE) / 8;
        let mut copy = vec![RUBBISH; words * count as usize];
        for i in 0..count as usize {
            // SAFETY: as the caller vouches; the copy has `words` words for each.
            unsafe {
                let to = copy.as_mut_ptr().add(i * words).cast::<u8>();
                from.cast::<u8>().add(i * size).copy_to_nonoverlapping(to, size);
            }
        }
        let at = copy.as_mut_ptr().cast();
        self.0.push(copy);
        at
    }

    /// Lays the structs of all inputs further apart. The views must not outlive `self`.
    pub(super) fn widen(&mut self, views: &mut Views<'_>) {
        for tree in views.trees() {
            let count = tree.branch_count;
            // SAFETY: our own views: pointers and counts are right, and copies are ours to change.
            unsafe {
                let branches: *mut tenon_branch =
                    self.spread(tree.branches.cast(), count, size_of::<tenon_branch>()).cast();
                tree.branch_stride = (size_of::<tenon_branch>() + MORE) as u32;
                for i in 0..count as usize {
                    let branch = branches.byte_add(i * tree.branch_stride as usize);
                    self.column(&mut (*branch).column);
                }
                tree.branches = branches;
            }
        }
    }

    /// # Safety
    /// A column of our own views.
    unsafe fn column(&mut self, column: &mut tenon_column) {
        let size = match column.kind {
            TENON_CURVE => size_of::<tenon_curve>(),
            TENON_MESH => size_of::<tenon_mesh>(),
            TENON_PANELS => size_of::<tenon_panels>(),
            TENON_FEATURES => size_of::<tenon_features>(),
            TENON_TABLE => size_of::<tenon_table>(),
            // Their layout is fixed for ever.
            _ => return,
        };
        // SAFETY: as the caller vouches.
        unsafe {
            let items = self.spread(column.items, column.count, size);
            for i in 0..column.count as usize {
                let item = items.byte_add(i * (size + MORE));
                item.cast::<u32>().write((size + MORE) as u32);
                if column.kind == TENON_TABLE {
                    let table = &mut *item.cast::<tenon_table>();
                    let size = size_of::<tenon_attribute>();
                    table.attributes = self.spread(table.attributes.cast(), table.attribute_count, size).cast();
                    table.attribute_stride = (size + MORE) as u32;
                }
                if column.kind == TENON_FEATURES {
                    let features = &mut *item.cast::<tenon_features>();
                    let size = size_of::<tenon_feature>();
                    features.features = self.spread(features.features.cast(), features.feature_count, size).cast();
                    features.feature_stride = (size + MORE) as u32;
                }
            }
            column.items = items;
        }
        column.stride = (size + MORE) as u64;
    }
}
