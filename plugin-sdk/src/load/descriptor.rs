//! What a plugin says of itself: its descriptors, checked and read into values of our own.

use super::{Body, LoadFault, NodeInfo, Plugin, PluginNode, PortInfo, layout};
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::from_c::text;
use std::path::PathBuf;

/// Reads descriptors; every fault names its place.
pub(super) struct Descriptors {
    pub place: String,
}

impl Descriptors {
    pub fn fault(&self, why: impl ToString) -> LoadFault {
        LoadFault::Descriptor { place: self.place.clone(), why: why.to_string() }
    }

    /// # Safety
    /// The text is as the contract says.
    pub unsafe fn text(&self, t: tenon_str, what: &'static str) -> Result<String, LoadFault> {
        if t.len > 1 << 20 {
            return Err(self.fault(format!("{what} is longer than 1 MiB")));
        }
        // SAFETY: as the caller vouches.
        unsafe { text(t, what) }.map(str::to_owned).map_err(|e| self.fault(e))
    }

    /// A struct as far as its maker knows it, the rest zero. `size` is what it says of itself, `least` its size in version
    /// 1.0.
    ///
    /// # Safety
    /// There are as many bytes as `size` says, and zeros are good for what a maker does not know.
    pub unsafe fn grown<T: Copy>(&self, at: *const T, size: u32, least: usize, what: &str) -> Result<T, LoadFault> {
        if (size as usize) < least {
            return Err(self.fault(format!("the size of {what} is {size}; set it to sizeof({what})")));
        }
        let mut all = std::mem::MaybeUninit::<T>::zeroed();
        // SAFETY: as the caller vouches; no more is written than there is room.
        unsafe {
            let bytes = (size as usize).min(size_of::<T>());
            at.cast::<u8>().copy_to_nonoverlapping(all.as_mut_ptr().cast(), bytes);
            Ok(all.assume_init())
        }
    }

    /// # Safety
    /// The port is as the contract says.
    unsafe fn port(&mut self, p: &tenon_port, node: &str, output: bool) -> Result<PortInfo, LoadFault> {
        self.place = node.to_owned();
        // SAFETY: as the caller vouches.
        let name = unsafe { self.text(p.name, "the name of a port")? };
        if !is_name(&name) {
            return Err(self.fault(format!("a port is called \"{name}\"; names are lower case letters, digits and _")));
        }
        self.place = format!("{node}.{name}");
        if !(TENON_BOOLEAN..=TENON_FEATURES).contains(&p.kind) && p.kind != TENON_TABLE {
            return Err(self.fault(format!("its kind is {}, which no port can have", p.kind)));
        }
        if p.access > TENON_TREE {
            return Err(self.fault(format!("its access is {}, which is not known", p.access)));
        }
        let range = (p.flags & TENON_RANGE != 0).then_some((p.min, p.max));
        if let Some((min, max)) = range
            && !(min <= max && matches!(p.kind, TENON_NUMBER | TENON_INTEGER))
        {
            return Err(self.fault(format!("the range {min} to {max} is empty or not of numbers")));
        }
        let mut choices = Vec::new();
        if p.choice_count > 0 {
            if p.choices.is_null() || p.choice_count > 1000 {
                return Err(self.fault(format!("{} choices at {:p}", p.choice_count, p.choices)));
            }
            for i in 0..p.choice_count as usize {
                // SAFETY: not NULL, and as the caller vouches.
                choices.push(unsafe { self.text(*p.choices.add(i), "a choice")? });
            }
        }
        // SAFETY: as the caller vouches.
        let (doc, unit, default_json) = unsafe {
            (self.text(p.doc, "doc")?, self.text(p.unit, "unit")?, self.text(p.default_json, "default_json")?)
        };
        if doc.is_empty() {
            return Err(self.fault("it has no doc"));
        }
        if output && (!default_json.is_empty() || range.is_some() || p.flags & TENON_OPTIONAL != 0) {
            return Err(self.fault("an output has no default and no range and is not optional"));
        }
        Ok(PortInfo {
            name,
            doc,
            kind: p.kind,
            access: p.access,
            unit,
            default_json,
            range,
            choices,
            optional: p.flags & TENON_OPTIONAL != 0,
        })
    }

    /// # Safety
    /// The node type is as the contract says.
    unsafe fn node(&mut self, n: &tenon_node_type, plugin: &str) -> Result<PluginNode, LoadFault> {
        // SAFETY: as the caller vouches.
        let id = unsafe { self.text(n.id, "the id of a node type")? };
        self.place = format!("node type \"{id}\"");
        let short = id.strip_prefix(plugin).and_then(|rest| rest.strip_prefix('.'));
        if !short.is_some_and(is_name) {
            return Err(
                self.fault(format!("its id must be \"{plugin}.\" and a name of lower case letters, digits and _"))
            );
        }
        let migrate_from = if n.migrate.is_some() { n.migrate_from.clamp(1, n.version.max(1)) } else { n.version };
        let Some(evaluate) = n.evaluate else { return Err(self.fault("evaluate is NULL")) };
        if n.version == 0 {
            return Err(self.fault("its version is 0; versions begin with 1"));
        }
        if n.flags & TENON_PURE == 0 {
            return Err(self.fault("TENON_PURE is not set: only functions of their inputs can be nodes"));
        }
        let fastener = n.flags & TENON_FASTENER != 0;
        if fastener == (n.output_count > 0) {
            return Err(self.fault(if fastener { "a fastener declares no outputs" } else { "it has no outputs" }));
        }
        let mut lists = [Vec::new(), Vec::new()];
        for (list, (ports, count, output)) in
            lists.iter_mut().zip([(n.inputs, n.input_count, false), (n.outputs, n.output_count, true)])
        {
            if count > 256 || (count > 0 && (ports.is_null() || !ports.is_aligned())) {
                return Err(self.fault(format!("{count} ports at {ports:p}")));
            }
            if count > 0 && !stride(n.port_stride, PORT) {
                return Err(self.fault(format!("port_stride is {}; set it to sizeof(tenon_port)", n.port_stride)));
            }
            for i in 0..count as usize {
                // SAFETY: not NULL, aligned, and as the caller vouches; the size comes first.
                let port = unsafe {
                    let at = ports.byte_add(i * n.port_stride as usize);
                    self.grown(at, (*at).size.min(n.port_stride), PORT, "tenon_port")?
                };
                // SAFETY: as the caller vouches.
                list.push(unsafe { self.port(&port, &id, output)? });
            }
        }
        let [inputs, outputs] = lists;
        self.place = format!("node type \"{id}\"");
        // SAFETY: as the caller vouches.
        let (name, category, doc, keywords) = unsafe {
            (
                self.text(n.name, "name")?,
                self.text(n.category, "category")?,
                self.text(n.doc, "doc")?,
                self.text(n.keywords, "keywords")?,
            )
        };
        if name.is_empty() || doc.is_empty() {
            return Err(self.fault("it has no name or no doc"));
        }
        let info = NodeInfo {
            id,
            version: n.version,
            name,
            category,
            doc,
            keywords: keywords.split(',').map(str::trim).filter(|k| !k.is_empty()).map(str::to_owned).collect(),
            inputs,
            outputs,
            slow: n.flags & TENON_SLOW != 0,
            fastener,
            migrate_from,
        };
        Ok(PluginNode { info, body: Body::Here { evaluate, migrate: n.migrate, data: n.data } })
    }
}

/// Sizes of the structs in version 1.0: what every plugin knows.
const PLUGIN: usize = 96;
const NODE: usize = std::mem::offset_of!(tenon_node_type, migrate);
const PORT: usize = 112;

/// Whether structs can lie so many bytes apart.
fn stride(stride: u32, least: usize) -> bool {
    stride as usize >= least && (stride as usize).is_multiple_of(align_of::<u64>())
}

fn is_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

impl Plugin {
    /// A plugin of this very program, which needs no library: its nodes are called by the same contract.
    ///
    /// # Errors
    /// As [`Plugin::load`], for its descriptors.
    pub fn built_in(plugin: crate::author::Plugin) -> Result<Self, LoadFault> {
        // SAFETY: the author layer makes descriptors as the contract says, and they are kept for ever.
        unsafe { Self::read(plugin.leak(), PathBuf::new()) }
    }

    /// Reads a descriptor.
    ///
    /// # Safety
    /// It is NULL or as the contract says.
    pub(super) unsafe fn read(plugin: *const tenon_plugin, path: PathBuf) -> Result<Self, LoadFault> {
        if plugin.is_null() || !plugin.is_aligned() {
            return Err(LoadFault::NotAPlugin(format!("{SYMBOL} gave {plugin:p}")));
        }
        // SAFETY: the first four numbers are there in every version.
        let [magic, size, major] = unsafe { [(*plugin).magic, (*plugin).size, (*plugin).abi_major] };
        if magic != TENON_PLUGIN_MAGIC {
            return Err(LoadFault::NotAPlugin(format!("{SYMBOL} gave no plugin: its magic number is {magic:#x}")));
        }
        if major != TENON_PLUGIN_MAJOR {
            return Err(LoadFault::Version { found: major });
        }
        let mut descriptors = Descriptors { place: "the plugin".into() };
        // SAFETY: it is as large as it says.
        let p = unsafe { descriptors.grown(plugin, size, PLUGIN, "tenon_plugin")? };
        // SAFETY: as the caller vouches. Nothing else is read before this.
        unsafe { layout::check(p.layout, &mut descriptors)? };
        descriptors.place = "the plugin".into();
        // SAFETY: as the caller vouches.
        let (id, version, vendor, doc) = unsafe {
            (
                descriptors.text(p.id, "id")?,
                descriptors.text(p.version, "version")?,
                descriptors.text(p.vendor, "vendor")?,
                descriptors.text(p.doc, "doc")?,
            )
        };
        if !is_name(&id) {
            return Err(descriptors.fault(format!("its id is \"{id}\"; ids are lower case letters, digits and _")));
        }
        if p.node_count == 0 || p.node_count > 10_000 || p.nodes.is_null() || !p.nodes.is_aligned() {
            return Err(descriptors.fault(format!("{} node types at {:p}", p.node_count, p.nodes)));
        }
        if !stride(p.node_stride, NODE) {
            let why = format!("node_stride is {}; set it to sizeof(tenon_node_type)", p.node_stride);
            return Err(descriptors.fault(why));
        }
        let mut nodes: Vec<PluginNode> = Vec::new();
        for i in 0..p.node_count as usize {
            // SAFETY: not NULL, aligned, and as the caller vouches; the size comes first.
            let node = unsafe {
                let at = p.nodes.byte_add(i * p.node_stride as usize);
                descriptors.grown(at, (*at).size.min(p.node_stride), NODE, "tenon_node_type")?
            };
            // SAFETY: as the caller vouches.
            let node = unsafe { descriptors.node(&node, &id)? };
            if nodes.iter().any(|n| n.id == node.id) {
                return Err(descriptors.fault("there are two of it"));
            }
            nodes.push(node);
        }
        Ok(Self { path, id, version, vendor, doc, nodes })
    }
}
