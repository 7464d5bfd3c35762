//! Whether a plugin laid the contract's structs out as this program does, where it says how it did.

use super::LoadFault;
use super::descriptor::Descriptors;
use crate::abi::layout::{FIELDS, Field, LAYOUT};
use crate::abi::plugin::*;

/// Sizes in the version that brought them: what every plugin that has them knows.
const LEAST_LAYOUT: usize = 32;
const LEAST_FIELD: usize = 40;

/// More fields than the contract will ever have.
const MOST: u64 = 10_000;

/// Refuses a plugin in which a field that both know lies elsewhere. Fields that only one side knows are growth. O(fields²),
/// once per library, and O(1) where both are of one version.
///
/// # Safety
/// It is NULL or as the contract says.
pub(super) unsafe fn check(layout: *const tenon_layout, descriptors: &mut Descriptors) -> Result<(), LoadFault> {
    if layout.is_null() {
        return Ok(());
    }
    descriptors.place = "the layout".into();
    if !layout.is_aligned() {
        return Err(descriptors.fault(format!("it lies at {layout:p}")));
    }
    // SAFETY: as the caller vouches; the size comes first.
    let theirs = unsafe { descriptors.grown(layout, (*layout).size, LEAST_LAYOUT, "tenon_layout")? };
    if theirs.digest == LAYOUT.digest {
        return Ok(());
    }
    let stride = theirs.field_stride as usize;
    let (count, fields) = (theirs.field_count, theirs.fields);
    if count > MOST || fields.is_null() || !fields.is_aligned() || stride < LEAST_FIELD || !stride.is_multiple_of(8) {
        return Err(descriptors.fault(format!("{count} fields at {fields:p}, {stride} bytes apart")));
    }
    for i in 0..count as usize {
        // SAFETY: not NULL, aligned, and as the caller vouches.
        let (of, name, at) = unsafe {
            let field = *fields.byte_add(i * stride);
            (descriptors.text(field.of, "a struct")?, descriptors.text(field.name, "a field")?, field)
        };
        let same = |ours: &&Field| ours.of == of && ours.name == name;
        let Some(ours) = FIELDS.iter().find(same) else { continue };
        if (at.offset, at.bytes) != (ours.offset, ours.bytes) {
            let (theirs, ours) = ((at.offset, at.bytes), (ours.offset, ours.bytes));
            return Err(LoadFault::Layout { of, name, theirs, ours });
        }
    }
    Ok(())
}
