//! Machines. JSON as in a machine file (docs/machine.md).

use super::Carried;
use crate::post::MachineFile;
use tenon_engine::{Digester, Json, pack, unpack};

impl Carried for MachineFile {
    const TYPE: &'static str = "machine";
    fn digest(&self, d: &mut Digester) {
        d.str(&Carried::to_json(self).to_string());
    }
    fn heap_bytes(&self) -> usize {
        self.machine.tools.len() * 512
    }
    fn to_json(&self) -> Json {
        serde_json::to_value(self).unwrap_or(Json::Null)
    }
    fn summary(&self) -> String {
        format!("{}, {} tools", self.machine.name, self.machine.tools.len())
    }
    /// Its JSON has no such level, which only a format with names can tell.
    fn encode(&self, out: &mut Vec<u8>) -> bool {
        pack(&(&self.machine, &self.words), out)
    }
    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        let (machine, words) = unpack(bytes)?;
        Some(Self { machine, words })
    }
}
