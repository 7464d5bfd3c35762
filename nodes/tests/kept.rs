//! What the nodes give outlives the process: every value of the example graphs, bit for bit, from a folder that may be
//! damaged, full or shared.

use crate::common::shell;
use crate::graphs::document;
use proptest::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, SystemTime};
use tenon_engine::{Control, Document, Happened, Kept, Options, Registry, Report, Session, Store, StoreFault, Tree};
use tenon_nodes::disk::DiskCache;

/// A folder of its own that goes away at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("tenon-kept-{}-{n}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Self(path)
    }

    fn cache(&self) -> DiskCache {
        DiskCache::new(&self.0, 1 << 30)
    }

    fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = std::fs::read_dir(&self.0).unwrap().map(|f| f.unwrap().path()).collect();
        files.sort();
        files
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Keeps everything, whatever it cost.
struct Everything(DiskCache);

impl Store for Everything {
    fn get(&self, key: u128) -> Result<Option<Vec<u8>>, StoreFault> {
        self.0.get(key)
    }
    fn put(&self, key: u128, bytes: &[u8]) -> Result<(), StoreFault> {
        self.0.put(key, bytes)
    }
    fn place(&self, key: u128) -> String {
        self.0.place(key)
    }
    fn is_worth(&self, _: Duration, _: usize) -> bool {
        true
    }
}

/// A new process's run of a small shell, everything kept.
fn run(folder: &Folder, threads: usize) -> Report {
    let document = Document::from_slice(shell().to_string().as_bytes()).unwrap();
    let store: Arc<dyn Store> = Arc::new(Everything(folder.cache()));
    let options = Options { threads, store: Some(store), ..Options::default() };
    Session::new(registry(), document, options).evaluate(&[], &Control::default())
}

fn registry() -> Arc<Registry> {
    static ALL: LazyLock<Arc<Registry>> = LazyLock::new(|| Arc::new(tenon_nodes::registry()));
    ALL.clone()
}

fn digests(report: &Report) -> BTreeMap<String, u128> {
    report.nodes.iter().map(|n| (n.id.to_string(), n.digest)).collect()
}

/// Every value of the example graphs, small ones, by `graph node.port`.
fn values() -> &'static BTreeMap<String, Tree> {
    static ALL: LazyLock<BTreeMap<String, Tree>> = LazyLock::new(|| {
        let mut all = BTreeMap::new();
        for graph in ["shell-256", "shell-21mm", "quad-mesh"] {
            let (document, host) = document(graph);
            let options = Options { host, ..Options::default() };
            let mut session = Session::new(registry(), document, options);
            if session.document().inputs.contains_key("iterations") {
                session.set("iterations", 2.into()).unwrap();
            }
            let mut names = Vec::new();
            for (id, node) in session.document().nodes() {
                let node_type = registry().get(&node.type_name).unwrap().clone();
                names.extend(node_type.outputs().iter().map(|p| format!("{id}.{}", p.name())));
            }
            let targets: Vec<&str> = names.iter().map(String::as_str).collect();
            session.evaluate(&targets, &Control::default());
            let found = names.iter().filter_map(|n| Some((format!("{graph} {n}"), session.value(n)?)));
            all.extend(found.collect::<Vec<_>>());
        }
        all
    });
    &ALL
}

fn kept(tree: &Tree) -> Kept {
    Kept { outputs: vec![tree.clone()], reports: Vec::new(), failed: false, nanoseconds: 1 }
}

#[test]
fn every_value_of_the_example_graphs_comes_back() {
    let mut seen = BTreeSet::new();
    for (name, tree) in values() {
        let bytes = kept(tree).encode().unwrap_or_else(|| panic!("{name}: {} has no bytes", tree.type_name()));
        let back = Kept::decode(&bytes, &registry()).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert_eq!(back.outputs[0].digest(), tree.digest(), "{name}");
        // What a digest leaves out as well.
        assert!(back.outputs[0].to_json() == tree.to_json(), "{name}");
        assert!(back.encode().unwrap() == bytes, "{name}");
        seen.insert(tree.type_name());
    }
    let never: Vec<&str> = registry().type_names().filter(|t| !seen.contains(t)).collect();
    // They are in the test below; tables are never kept (their format is 0), so nodes that give them run in each process.
    assert_eq!(never, ["plane", "polygon", "table", "vector"], "{seen:?}");
}

#[test]
fn points_vectors_planes_and_faults_come_back() {
    use tenon_geometry::proof::{Body, Fault, Obstacle, PartFace, ProgramVerdict, ProofReport, Reason};
    use tenon_geometry::{DVec3, polygon::Polygon};
    use tenon_nodes::value::{Plane, Point, V, Vector};
    let odd = DVec3::new(f64::from_bits(0x7ff8_0000_0000_1234), -0.0, f64::MIN_POSITIVE / 3.0);
    let reason = |fault| Reason { line: Some(3), part: None, at: Some(odd), by: 0.25, fault };
    let faults = [
        Fault::Unreadable("x".into()),
        Fault::Limit { axis: 'B', value: 1.0, min: 2.0, max: f64::INFINITY },
        Fault::Collision { rapid: true, body: Body::Holder, obstacle: Obstacle::Clamp("c".into()) },
        Fault::Leftover(PartFace::Node(3)),
        Fault::MissingEngraving { feature: 4, text: "1.2".into() },
        Fault::OffBoard,
    ];
    let verdict = ProgramVerdict {
        name: "b".into(),
        board: 1,
        passed: false,
        motions: usize::MAX,
        reasons: faults.map(reason).to_vec(),
        omitted: 0,
    };
    let proof = ProofReport { programs: vec![verdict], parts: vec![None] };
    let trees = [
        Tree::list(vec![Point(odd), Point(DVec3::X)]),
        Tree::item(Vector(odd)),
        Tree::item(Plane(tenon_geometry::Plane { normal: odd, offset: f64::NEG_INFINITY })),
        Tree::item(V::new(proof)),
        Tree::item(V::new(Polygon::new(vec![DVec3::ZERO, DVec3::X, DVec3::new(0.1, -0.0, 3.0)]).unwrap())),
    ];
    for tree in trees {
        let bytes = kept(&tree).encode().unwrap();
        let back = Kept::decode(&bytes, &registry()).unwrap();
        assert_eq!(back.outputs[0].digest(), tree.digest());
        assert!(back.outputs[0].to_json() == tree.to_json());
        assert!(back.encode().unwrap() == bytes, "every bit of a float counts, which a digest does not see of a NaN");
    }
}

#[test]
fn a_whole_chain_comes_from_the_folder_on_any_number_of_threads() {
    let folder = Folder::new();
    let first = run(&folder, 1);
    let second = run(&folder, 3);
    assert_eq!(digests(&second), digests(&first));
    assert_eq!(second.diagnostics, first.diagnostics);
    assert!(first.cache.is_empty() && second.cache.is_empty());
    for node in second.nodes.iter() {
        // Of those that are never remembered either.
        assert!(matches!(node.happened, Happened::Disk | Happened::Executed), "{node:?}");
        let slow = ["pack", "prove", "paths", "post", "screws", "map", "thicken"].contains(&node.id);
        assert!(!slow || node.happened == Happened::Disk, "{node:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_damage_is_found_named_and_repaired(
        places in proptest::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0u8..), 1..4),
    ) {
        // Flipped bits, or cut off where there is none to flip.
        static WHOLE: LazyLock<(Folder, Report)> = LazyLock::new(|| {
            let folder = Folder::new();
            let report = run(&folder, 1);
            (folder, report)
        });
        let (whole, first) = &*WHOLE;
        let folder = Folder::new();
        std::fs::create_dir(&folder.0).unwrap();
        for file in whole.files() {
            std::fs::copy(&file, folder.0.join(file.file_name().unwrap())).unwrap();
        }
        let files = folder.files();
        let mut damaged = BTreeSet::new();
        for (file, at, by) in places {
            let path = &files[file.index(files.len())];
            let mut bytes = std::fs::read(path).unwrap();
            if bytes.is_empty() {
                continue;
            }
            let at = at.index(bytes.len());
            match by {
                0 => bytes.truncate(at),
                by => bytes[at] ^= by,
            }
            std::fs::write(path, bytes).unwrap();
            damaged.insert(path.display().to_string());
        }
        // Two flips may have made it whole again.
        damaged.retain(|d| std::fs::read(d).unwrap() != std::fs::read(whole.0.join(d.rsplit('/').next().unwrap())).unwrap());
        let report = run(&folder, 2);
        prop_assert_eq!(digests(&report), digests(first));
        prop_assert_eq!(&report.diagnostics, &first.diagnostics);
        prop_assert_eq!(report.cache.len(), damaged.len());
        for d in &damaged {
            prop_assert!(report.cache.iter().any(|c| c.code == "cache-damaged" && c.message.contains(d.as_str())));
        }
        let again = run(&folder, 1);
        prop_assert!(again.cache.is_empty());
        prop_assert_eq!(digests(&again), digests(first));
    }
}

proptest! {
    #[test]
    fn decoding_anything_never_panics_and_what_it_takes_it_writes_again(
        value in any::<prop::sample::Index>(), at in any::<prop::sample::Index>(), by in 1u8..,
    ) {
        // Beneath the digests: the bytes of the values themselves.
        let all: Vec<&Tree> = values().values().filter(|t| t.bytes() < 100_000).collect();
        let mut bytes = kept(all[value.index(all.len())]).encode().unwrap();
        let at = at.index(bytes.len());
        bytes[at] ^= by;
        if let Ok(back) = Kept::decode(&bytes, &registry()) {
            let again = Kept::decode(&back.encode().unwrap(), &registry()).unwrap();
            prop_assert_eq!(back, again);
        }
    }
}

fn set_age(path: PathBuf, seconds: u64) {
    let then = SystemTime::now() - Duration::from_secs(seconds);
    std::fs::File::options().write(true).open(path).unwrap().set_modified(then).unwrap();
}

#[test]
fn what_was_used_longest_ago_goes_first_and_nothing_else() {
    let folder = Folder::new();
    let cache = DiskCache::new(&folder.0, 10_000);
    for key in 0..8 {
        cache.put(key, &[7; 1000]).unwrap();
        set_age(cache.path(key), 100 - key as u64);
    }
    std::fs::write(folder.0.join("notes.txt"), "of a person").unwrap();
    let temporary = |name: &str| folder.0.join(format!(".{:032x}-1-{name}.tmp", 1));
    for (name, age) in [("old", 7200), ("new", 1)] {
        std::fs::write(temporary(name), "half").unwrap();
        set_age(temporary(name), age);
    }
    // Using the oldest makes it the youngest.
    assert_eq!(cache.get(0), Ok(Some(vec![7; 1000])));
    cache.trim().unwrap();
    assert!(cache.get(7).unwrap().is_some(), "all of them are within the limit");
    assert!(!temporary("old").exists() && temporary("new").exists());
    let smaller = DiskCache::new(&folder.0, 5000);
    assert!(smaller.trim().unwrap() <= 4500);
    let left: Vec<u128> = (0..8).filter(|key| smaller.path(*key).exists()).collect();
    assert_eq!(left, [0, 5, 6, 7]);
    assert!(folder.0.join("notes.txt").exists());
    // More than all of it is not even tried.
    smaller.put(9, &[7; 6000]).unwrap();
    assert_eq!(smaller.get(9), Ok(None));
}

#[test]
fn an_entry_under_another_name_is_not_taken_for_another() {
    let folder = Folder::new();
    let cache = folder.cache();
    cache.put(1, b"one").unwrap();
    std::fs::copy(cache.path(1), cache.path(2)).unwrap();
    assert_eq!(cache.get(1), Ok(Some(b"one".to_vec())));
    assert!(matches!(cache.get(2), Err(StoreFault::Damaged { why, .. }) if why.contains("another key")));
}

#[test]
fn a_folder_that_cannot_be_is_told_once() {
    let folder = Folder::new();
    std::fs::write(&folder.0, "a file").unwrap();
    let document = Document::from_slice(shell().to_string().as_bytes()).unwrap();
    let store: Arc<dyn Store> = Arc::new(Everything(folder.cache()));
    let options = Options { store: Some(store), ..Options::default() };
    let report = Session::new(registry(), document, options).evaluate(&[], &Control::default());
    assert!(!report.has_errors());
    let codes: Vec<&str> = report.cache.iter().map(|d| &*d.code).collect();
    assert_eq!(codes, ["cache-failed"]);
    let told: Value = serde_json::to_value(&report.cache[0]).unwrap();
    assert_eq!(told["severity"], "warning");
    std::fs::remove_file(&folder.0).unwrap();
}
