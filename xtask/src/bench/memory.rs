//! The greatest memory that this process has taken, as the system counts it.

/// Peak resident memory, bytes: `VmHWM` of Linux, `None` elsewhere.
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Starts the peak anew at what is resident now. Without effect where the system has no such thing: the peak is then of
/// all that came before.
pub fn forget_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

#[cfg(test)]
mod tests {
    #[cfg(target_os = "linux")]
    #[test]
    fn touching_memory_raises_the_peak() {
        let before = super::peak().unwrap();
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        let after = super::peak().unwrap();
        assert!(after >= before.max(64 << 20), "{before} {after} {}", block.len());
    }
}
