//! Files that are whole whenever they are there.

use std::path::Path;

/// Written beside and renamed: whenever the program is killed, the old file or the whole new one is there. Errors name the file.
pub(crate) fn replace(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), String> {
    let part = path.with_extension("part");
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).map_err(|e| format!("{}: {e}", path.display()))
}
