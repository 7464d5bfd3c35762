//! Surfaces from curves (000 §4.3, §5.4): vector sums and tensor products.

mod error;
mod grid;
#[cfg(test)]
mod laws;
mod tensor_product;
mod vector_sum;

pub use error::SurfaceError;
pub use tensor_product::{Direction, tensor_product, vector_sum_grid};
pub use vector_sum::vector_sum;
