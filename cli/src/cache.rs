//! `--cache`: where results are kept from run to run.

use crate::args::CacheArgs;
use std::sync::Arc;
use tenon_engine::Store;
use tenon_nodes::disk::DiskCache;

/// The folder that the command line names, if it names one.
pub fn store(args: &CacheArgs) -> Option<Arc<dyn Store>> {
    let folder = args.cache.as_deref()?;
    Some(Arc::new(DiskCache::new(folder, u64::from(args.cache_size) << 20)))
}
