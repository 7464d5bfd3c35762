//! The window without a screen: driven by pointer and keys, looked at through its names and its pictures.

mod beside;
mod boards;
mod canvas;
mod clusters;
mod comfort;
mod common;
mod files;
mod held;
mod history;
mod keys;
mod leaving;
mod looking;
mod looks;
mod menus;
mod panels;
mod sheets;
mod shell;
mod sliders;
mod snapshots;
mod values;
mod viewport;
mod window;
