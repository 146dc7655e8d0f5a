//! Scenes from files.
//!
//! | file | read | reported, not used |
//! |---|---|---|
//! | glTF 2.0, `.gltf`, `.glb` | meshes, nodes, perspective cameras, metallic-roughness materials with textures and alpha masks, emissive strength, specular, index of refraction, transmission, punctual lights | skins, morph targets, animations, normal maps, occlusion, blended alpha, emission of backs, ranges of lights, other extensions |
//! | Wavefront `.obj` with `.mtl` | triangles and polygons, normals, texture coordinates, `Kd`, `Ke`, `Ks`, `Ns`, `Ni`, `d`, `map_Kd` | illumination models, other maps |
//!
//! What a file uses and this crate does not is in the [`Report`], by name and number.
//!
//! A mesh that several nodes share is copied for each of them: 160 to 260 bytes a triangle in all (its corners, 36 bytes in single precision or 72, its
//! share of the tree, its normal, rounding error and material), and 64 more if it has normals or texture coordinates.

mod accessor;
mod gltf_file;
mod gltf_material;
mod obj;
mod picture;

use super::{Camera, Scene, SceneBuilder};
use crate::error::Error;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// A scene as a file describes it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// To be built, perhaps after additions.
    pub builder: SceneBuilder,
    /// The cameras of the file, in order, each with the aspect ratio it states.
    pub cameras: Vec<(Camera, Option<f64>)>,
    /// What the file uses and this crate does not.
    pub report: Report,
}

/// What was not used of a file, and how often.
///
/// ```
/// use fredholm::scene::load::Report;
/// assert_eq!(Report::default().to_string(), "everything in the file is used");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report(BTreeMap<String, usize>);

impl Report {
    pub(super) fn note(&mut self, what: impl Into<String>) {
        *self.0.entry(what.into()).or_default() += 1;
    }

    /// What, and how often.
    pub fn entries(&self) -> impl Iterator<Item = (&str, usize)> {
        self.0.iter().map(|(what, count)| (what.as_str(), *count))
    }

    /// Whether everything was used.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("everything in the file is used");
        }
        for (i, (what, count)) in self.0.iter().enumerate() {
            write!(f, "{}{what} ({count}×)", if i == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

/// Reads a scene; the kind of file is told by its name.
///
/// ```
/// let loaded = fredholm::scene::load("tests/data/scenes/plates.gltf")?;
/// assert!(loaded.report.is_empty() && loaded.cameras.len() == 1);
/// assert_eq!(loaded.builder.build()?.geometry().primitives(), 4);
/// # Ok::<(), fredholm::Error>(())
/// ```
///
/// # Errors
/// [`Error::Io`] for files that cannot be read; [`Error::SceneFile`] for what is wrong in them; [`Error::Vertex`] and the like for numbers that no scene can have.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded, Error> {
    let path = path.as_ref();
    let bytes = read(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let name = path.display().to_string();
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("gltf" | "glb") => gltf_file::parse(&name, &bytes, folder),
        Some("obj") => obj::parse(&name, &bytes, folder),
        _ => Err(wrong(&name, "the name must end in .gltf, .glb or .obj")),
    }
}

/// A glTF scene from memory; `folder` is where the files it names lie.
///
/// # Errors
/// As [`load`].
pub fn gltf(bytes: &[u8], folder: impl AsRef<Path>) -> Result<Loaded, Error> {
    gltf_file::parse("glTF", bytes, folder.as_ref())
}

impl Loaded {
    fn empty() -> Self {
        Loaded { builder: Scene::builder(), cameras: Vec::new(), report: Report::default() }
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|e| Error::Io { path: path.display().to_string(), message: e.to_string() })
}

fn wrong(file: &str, problem: impl fmt::Display) -> Error {
    Error::SceneFile { file: file.to_string(), problem: problem.to_string() }
}
