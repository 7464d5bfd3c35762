//! Machine files: read, or refused with the key that is wrong; what is read is written and read the same.

use tenon_nodes::post::{parse_program, read_machine};

const PROGRAM: &[u8] =
    b"%\nG17 G21 G40 G49 G54 G61 G80 G90 G94\nT1 M6\nS100 M3\nG0 X1 Y2 Z3 B0 C0\nG1 X2 F100\nM5\nM2\n%\n";

pub fn check(bytes: &[u8]) {
    match read_machine(bytes) {
        Ok(file) => {
            let text = serde_json::to_vec(&file).unwrap_or_default();
            let again = read_machine(&text).unwrap_or_else(|e| panic!("what was written is not read: {e}"));
            assert_eq!(again, file);
            let _ = parse_program(PROGRAM, &file.machine);
        }
        Err(e) => assert!(!e.to_string().is_empty()),
    }
}
