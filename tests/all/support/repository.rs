//! Files that come with the source.

use std::path::Path;

/// The whole path of a file that is committed as `path`.
pub(crate) fn committed(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    path.to_str().unwrap().into()
}
