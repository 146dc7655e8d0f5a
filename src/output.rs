//! Files that are written whole or not at all.

use crate::error::Error;
use std::path::Path;

/// Writes `bytes` beside `path` and renames: on a full disk what was there before is still there. What is no file, such as a device, is written to; a
/// folder that does not exist is made.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let io = |e: std::io::Error| Error::Io { path: path.display().to_string(), message: e.to_string() };
    if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return std::fs::write(path, bytes).map_err(io);
    }
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(io)?;
    }
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).map_err(|e| {
        // nothing is lost with it: the answer is still in memory
        std::fs::remove_file(&part).ok();
        io(e)
    })
}
