//! Writers: nodes whose files the host writes.

mod drawing;
mod gcode;
mod pieces;
mod proof;
mod solids;

use tenon_engine::{Call, Fail, File, NodeType, Port, Text};

pub(crate) fn nodes() -> Vec<NodeType> {
    [drawing::nodes(), pieces::nodes(), proof::nodes(), solids::nodes(), gcode::nodes()].into_iter().flatten().collect()
}

/// A writer of one file, called `name` unless the port says otherwise.
fn writer(id: &'static str, title: &'static str, name: &'static str) -> NodeType {
    NodeType::new(id, 1)
        .name(title)
        .category("Files")
        .input(Port::item::<Text>("name").default(name).doc("File name in the output folder."))
        .output(Port::item::<File>("file").doc("The file."))
        .writer()
}

/// Sets the output of a [`writer`].
fn set_file(c: &mut Call, bytes: Vec<u8>) -> Result<(), Fail> {
    if c.cancelled() {
        // They may have stopped half-way.
        return Err(Fail::cancelled());
    }
    let name = c.text("name")?.into();
    c.set("file", File { name, bytes: bytes.into(), withheld: None });
    Ok(())
}
