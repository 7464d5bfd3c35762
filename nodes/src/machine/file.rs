//! `machine`: a machine from a description.

use crate::post::{MachineFile, machine_preset, machine_presets, read_machine};
use crate::value::V;
use tenon_engine::{Fail, NodeType, Port, Text};

pub(super) fn node() -> NodeType {
    let presets: Vec<&'static str> = machine_presets().collect();
    NodeType::new("machine", 1)
        .name("Machine")
        .category("Machine")
        .doc("A machine with its axes, limits, table, tools and words: a preset, or a machine file of your own.")
        .keywords(&["maka", "cnc", "tools", "post", "kinematics"])
        .input(
            Port::item::<Text>("preset")
                .choices(&presets)
                .default("maka-mm7s")
                .doc("A machine that Tenon brings along."),
        )
        .input(Port::item::<Text>("path").file().optional().doc("A machine file; it goes before the preset."))
        .output(Port::item::<V<MachineFile>>("machine").doc("The machine."))
        .run(|c| {
            let machine = match c.optional::<Text>("path") {
                Some(_) => {
                    read_machine(&c.file("path")?).map_err(|e| Fail::new("bad-machine", e.to_string()).port("path"))?
                }
                None => machine_preset(c.text("preset")?)
                    .map_err(|e| Fail::new("bad-machine", e.to_string()).port("preset"))?,
            };
            c.set("machine", V::new(machine));
            Ok(())
        })
}
