//! Nodes of older versions, brought forward by the plugin that they are of.

use super::{Body, PluginNode};
use crate::abi::value::*;
use crate::from_c::text;
use std::ffi::c_void;

/// The longest text that is taken.
const LONGEST: u64 = 1 << 26;

/// What the plugin gave: its last text, or what is wrong with it.
type Given = Option<Result<String, String>>;

unsafe extern "C" fn give(to: *mut c_void, given: tenon_str) {
    // SAFETY: the plugin hands back what it was given, during the call that it was given to.
    if let Some(place) = unsafe { to.cast::<Given>().as_mut() } {
        *place = Some(if given.len > LONGEST {
            Err(format!("it gives a text of {} bytes", given.len))
        } else {
            // SAFETY: a view of bytes that are good until we return, says the contract.
            unsafe { text(given, "the text") }.map(str::to_owned).map_err(|e| e.to_string())
        });
    }
}

impl PluginNode {
    /// Brings a node, as it stands in the file, from version `from` to the next. Cost: the plugin's.
    ///
    /// # Errors
    /// The plugin's words, or how it breaks the contract.
    pub fn migrate(&self, from: u32, node: &str) -> Result<String, String> {
        let (migrate, data) = match &self.body {
            Body::Here { migrate, data, .. } => (migrate.ok_or("the plugin has no step from that version")?, *data),
            Body::Apart(processes, index) => return processes.migrate(*index, from, node),
        };
        let mut given: Given = None;
        let to = (&raw mut given).cast::<c_void>();
        // SAFETY: the plugin was loaded and never goes; text and place live through the call; it does not unwind, says
        // the contract.
        let status = unsafe { migrate(data, from, tenon_str::of(node), give, to) };
        match (status, given) {
            (TENON_OK, Some(text)) => text,
            (TENON_OK, None) => Err("the plugin gives nothing".into()),
            (TENON_FAILED, Some(why)) => Err(why.unwrap_or_else(|e| e)),
            (status, _) => Err(format!("the plugin's migrate gave the status {status}")),
        }
    }
}
