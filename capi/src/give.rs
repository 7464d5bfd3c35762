//! Inputs as C values: copied, or shared with a function that is called when nobody looks at them any more.

use crate::error::{Failure, guard, tenon_error};
use crate::graph::tenon_graph;
use crate::handle;
use crate::read;
use std::any::Any;
use std::ffi::{c_char, c_void};
use std::sync::Arc;
use tenon_nodes::exchange;
use tenon_plugin::abi::value::tenon_tree;
use tenon_plugin::read_tree;
use tenon_plugin::value::Branch;

/// Gives an interface input or a parameter (`node.port`) a value in memory: numbers, points, curves, meshes, panel sets
/// and so on, a list or a tree with paths. Set `size` of every struct in it; `type_name` of columns is not read. Everything
/// is copied, so the caller may change or free it after the call. It stands until the input is set otherwise; as it has no
/// written form `tenon_graph_save` writes what the graph's text said before. Fails, with nothing changed, if the name is not
/// known, the port has a wire or takes other types, or the value is not accepted. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_give(
    graph: *mut tenon_graph,
    name: *const c_char,
    tree: *const tenon_tree,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        // SAFETY: the header asks for a tree whose structs say how much they hold.
        let branches = unsafe { read_tree(tree) }.map_err(|e| Failure::argument(format!("{name}: {e}")))?;
        let tree = exchange::tree(branches).map_err(|e| Failure::argument(format!("{name}: {e}")))?;
        graph.give(name, &tree)
    })
}

/// What is called when arrays that a host shares are free again.
pub type tenon_release = Option<unsafe extern "C" fn(context: *mut c_void)>;

/// The caller's arrays; dropped when nobody looks at them any more.
struct Owner {
    release: tenon_release,
    context: *mut c_void,
}

// SAFETY: the context is only handed back to the caller's function, which the header asks to be fit for any thread.
unsafe impl Send for Owner {}
// SAFETY: see above; nothing can be done with a shared one.
unsafe impl Sync for Owner {}

impl Drop for Owner {
    fn drop(&mut self) {
        if let Some(release) = self.release {
            // SAFETY: the caller gave function and context for each other.
            unsafe { release(self.context) };
        }
    }
}

/// The same without copying large arrays: the library reads where they are the items of lists of truth values, integers,
/// numbers, points, vectors and planes, every array of curves, meshes and panel sets, the columns of tables, and what says
/// which items are gaps. Structs, texts, features, lists of one such item, and bytes other than 0 and 1 that stand for truth
/// values are copied. The arrays must stay as they are, unchanged, until `release(context)` is called, once: when the graph and
/// all results that hold them have let go, or already in this call if all was copied. It is called from any thread, must not
/// throw, and must not call the library. `release` may be NULL for arrays that live as long as the program. Fails as
/// `tenon_graph_give` does; then `release` is not called. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_share(
    graph: *mut tenon_graph,
    name: *const c_char,
    tree: *const tenon_tree,
    release: tenon_release,
    context: *mut c_void,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        // SAFETY: the header asks for a tree whose structs say how much they hold, and for arrays that stay until they are
        // released, which is when nothing that was made of these borrows is left.
        let branches: Vec<Branch<'static>> =
            unsafe { read_tree(tree) }.map_err(|e| Failure::argument(format!("{name}: {e}")))?;
        // Nothing may be released unless all has gone well, so the function comes in last.
        let owner = Arc::new(Lease(std::sync::OnceLock::new()));
        let shared: Arc<dyn Any + Send + Sync> = owner.clone();
        let tree = exchange::lent_tree(branches, &shared).map_err(|e| Failure::argument(format!("{name}: {e}")))?;
        graph.give(name, &tree)?;
        let _ = owner.0.set(Owner { release, context });
        Ok(())
    })
}

/// Holds the owner once the value was accepted.
struct Lease(std::sync::OnceLock<Owner>);
