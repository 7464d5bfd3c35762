//! The plugin's side in safe Rust: a node is a plain function plus a description.
//!
//! ```ignore
//! fn plugin() -> Plugin {
//!     Plugin::new("acme", "1.0.0").node(
//!         Node::new("acme.twice", 1).name("Twice").doc("Doubles a number.")
//!             .input(Port::number("value").doc("The number."))
//!             .output(Port::number("result").doc("Twice the number."))
//!             .run(|c| c.set_number("result", 2.0 * c.number("value")?)),
//!     )
//! }
//! tenon_plugin::export!(plugin);
//! ```

mod call;
mod describe;
mod element;

pub use call::{Call, Fail};
pub use describe::{Node, Plugin, Port};
pub use element::Element;

/// Exports the plugin that a function `fn() -> tenon_plugin::author::Plugin` describes.
#[macro_export]
macro_rules! export {
    ($plugin:path) => {
        /// The one symbol of a plugin; see `tenon_plugin.h`.
        #[unsafe(no_mangle)]
        pub extern "C" fn tenon_plugin_v1() -> *const $crate::abi::plugin::tenon_plugin {
            static PLUGIN: ::std::sync::OnceLock<Option<&'static $crate::abi::plugin::tenon_plugin>> =
                ::std::sync::OnceLock::new();
            let made = PLUGIN.get_or_init(|| ::std::panic::catch_unwind(|| $plugin().leak()).ok());
            made.map_or(::std::ptr::null(), ::std::ptr::from_ref)
        }
    };
}
