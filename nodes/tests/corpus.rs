//! The corpus of the fuzzers, through the same checks: what a fuzzer has found once stays found.

use crate::fuzz::TARGETS;
use std::path::Path;

#[test]
fn every_check_holds_for_the_whole_corpus() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    for (target, check) in TARGETS {
        let mut files: Vec<_> = std::fs::read_dir(corpus.join(target)).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        assert!(files.len() >= 3, "{target} has a corpus of {}", files.len());
        for file in files {
            // If it panics, this is the last line.
            println!("{}", file.display());
            check(&std::fs::read(file).unwrap());
        }
    }
}

#[test]
fn every_check_stands_whatever_is_cut_off_or_turned() {
    // A little of what a fuzzer does, the same in every run.
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let mut dice = tenon_engine::Random::new(7);
    let mut below = |n: usize| (dice.next().unwrap() * n as f64) as usize;
    for (target, check) in TARGETS {
        let mut files: Vec<_> = std::fs::read_dir(seeds.join(target)).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        for _ in 0..20 {
            let file = &files[below(files.len())];
            let mut bytes = std::fs::read(file).unwrap();
            for _ in 0..1 + below(4) {
                if bytes.is_empty() {
                    break;
                }
                let at = below(bytes.len());
                match below(4) {
                    0 => bytes.truncate(at),
                    1 => bytes[at] ^= 1 << below(8),
                    2 => drop(bytes.drain(at..(at + below(9)).min(bytes.len()))),
                    _ => {
                        let copy = bytes[at..(at + 12).min(bytes.len())].to_vec();
                        let to = below(bytes.len());
                        bytes.splice(to..to, copy);
                    }
                }
            }
            println!("{} {bytes:?}", file.display());
            check(&bytes);
        }
    }
}
