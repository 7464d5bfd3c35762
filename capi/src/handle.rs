//! Handles: keys into one table. What C holds as a pointer is never followed, so freed, foreign and invented handles are
//! told apart from good ones.

use crate::engine::Engine;
use crate::error::Failure;
use crate::graph::Graph;
use crate::job::Job;
use crate::result::Evaluated;
use crate::sweep::Sweep;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// Whatever a handle stands for.
#[derive(Clone)]
pub(crate) enum Object {
    Engine(Arc<Engine>),
    Graph(Arc<Graph>),
    Job(Arc<Job>),
    Result(Arc<Evaluated>),
    Sweep(Arc<Sweep>),
    Error(Arc<Failure>),
    Text(Arc<str>),
}

impl Object {
    fn kind(&self) -> &'static str {
        match self {
            Self::Engine(_) => "engine",
            Self::Graph(_) => "graph",
            Self::Job(_) => "job",
            Self::Result(_) => "result",
            Self::Sweep(_) => "sweep",
            Self::Error(_) => "error",
            Self::Text(_) => "text",
        }
    }
}

static OBJECTS: LazyLock<RwLock<HashMap<usize, Object>>> = LazyLock::new(RwLock::default);
static NEXT: AtomicUsize = AtomicUsize::new(1);

/// Keys look like aligned addresses far below any real one, which debuggers show well.
const STEP: usize = 16;

/// Puts an object into the table.
pub(crate) fn give<T>(object: Object) -> *mut T {
    let key = NEXT.fetch_add(1, Ordering::Relaxed) * STEP;
    OBJECTS.write().unwrap_or_else(PoisonError::into_inner).insert(key, object);
    std::ptr::without_provenance_mut(key)
}

fn find<T>(handle: *const T) -> Option<Object> {
    OBJECTS.read().unwrap_or_else(PoisonError::into_inner).get(&handle.addr()).cloned()
}

/// Takes an object out of the table; freeing nothing, or a second time, does nothing.
pub(crate) fn free<T>(handle: *const T) {
    // Dropped after the lock, since an object may hold others.
    let object = OBJECTS.write().unwrap_or_else(PoisonError::into_inner).remove(&handle.addr());
    drop(object);
}

/// Number of handles that were given and not freed.
pub(crate) fn count() -> usize {
    OBJECTS.read().unwrap_or_else(PoisonError::into_inner).len()
}

fn wrong<T>(handle: *const T, wanted: &str) -> Failure {
    let found = match find(handle) {
        _ if handle.is_null() => "NULL".to_owned(),
        Some(other) => format!("a handle of kind {}", other.kind()),
        None => "a handle that was freed or never given".to_owned(),
    };
    Failure::argument(format!("the {wanted} is {found}"))
}

macro_rules! finders {
    ($($name:ident $variant:ident $type:ty;)*) => { $(
        pub(crate) fn $name<T>(handle: *const T) -> Result<Arc<$type>, Failure> {
            match find(handle) {
                Some(Object::$variant(object)) => Ok(object),
                _ => Err(wrong(handle, stringify!($name))),
            }
        }
    )* };
}

finders! {
    engine Engine Engine;
    graph Graph Graph;
    job Job Job;
    result Result Evaluated;
    sweep Sweep Sweep;
    error Error Failure;
    text Text str;
}
