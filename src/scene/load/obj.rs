//! Wavefront OBJ with MTL.

use super::picture::{Encoding, Picture};
use super::{Loaded, read, wrong};
use crate::error::Error;
use crate::scene::geometry::Mesh;
use crate::scene::{Attributes, Material, Textures};
use std::path::Path;
use std::sync::Arc;

pub(super) fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<Loaded, Error> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };
    let library = |file: &Path| library(&folder.join(file));
    let (models, materials) = tobj::load_obj_buf(&mut &bytes[..], &options, library).map_err(|e| wrong(name, e))?;
    let mut loaded = Loaded::empty();
    let materials = materials.unwrap_or_else(|e| {
        loaded.report.note(format!("materials: {e}; everything is grey"));
        Vec::new()
    });
    let mut ids = Vec::new();
    for m in &materials {
        let material = convert(m, folder, &mut loaded)?;
        ids.push(loaded.builder.material(material));
    }
    let mut grey = None;
    for tobj::Model { mesh, .. } in &models {
        let known = mesh.material_id.and_then(|i| ids.get(i).copied());
        let material = known.unwrap_or_else(|| *grey.get_or_insert_with(|| loaded.builder.material(Material::diffuse([0.5; 3]))));
        let vertices = mesh.positions.as_chunks::<3>().0.iter().map(|p| p.map(f64::from)).collect();
        let attributes = Attributes {
            normals: mesh.normals.as_chunks::<3>().0.to_vec(),
            // rows of images are counted from the top, texture coordinates from the bottom
            texcoords: mesh.texcoords.as_chunks::<2>().0.iter().map(|t| [t[0], 1.0 - t[1]]).collect(),
        };
        let mesh = Mesh::new(vertices, mesh.indices.as_chunks::<3>().0.to_vec())?;
        loaded.builder.smooth_mesh(mesh, material, attributes)?;
    }
    Ok(loaded)
}

/// The materials of a file. One number is a grey, as the format has it; of that, and of colours cut short, the parser knows nothing.
fn library(file: &Path) -> tobj::MTLLoadResult {
    let bytes = std::fs::read(file).map_err(|_| tobj::LoadError::OpenFileFailed)?;
    let mut text = String::new();
    for line in String::from_utf8(bytes).map_err(|_| tobj::LoadError::ReadError)?.lines() {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            [key @ ("Ka" | "Kd" | "Ks" | "Ke"), grey] => text.extend([key, " ", grey, " ", grey, " ", grey]),
            ["Ka" | "Kd" | "Ks" | "Ke"] | ["Ka" | "Kd" | "Ks" | "Ke", _, _] => return Err(tobj::LoadError::MaterialParseError),
            _ => text.push_str(line),
        }
        text.push('\n');
    }
    tobj::load_mtl_buf(&mut text.as_bytes())
}

/// `Kd` diffuse, `Ks` with `Ns` a coat, `d` < 1 with `Ni` glass, `Ke` emission.
fn convert(m: &tobj::Material, folder: &Path, loaded: &mut Loaded) -> Result<Material, Error> {
    let colour = |c: Option<[f32; 3]>| c.unwrap_or([0.0; 3]).map(f64::from);
    let (diffuse, specular) = (colour(m.diffuse), colour(m.specular));
    for key in m.unknown_param.keys() {
        loaded.report.note(format!("material property {key}"));
    }
    for (used, what) in [
        (&m.ambient_texture, "map_Ka"),
        (&m.specular_texture, "map_Ks"),
        (&m.shininess_texture, "map_Ns"),
        (&m.normal_texture, "normal map"),
        (&m.dissolve_texture, "map_d"),
    ] {
        if used.is_some() {
            loaded.report.note(what);
        }
    }
    let base = match &m.diffuse_texture {
        Some(file) => {
            let picture = Picture::decode(&read(&folder.join(file))?).map_err(|problem| wrong(file, problem))?;
            Some(Arc::new(picture.texture(Encoding::Srgb)?))
        }
        None => None,
    };
    let law = if m.dissolve.is_some_and(|d| d < 1.0) {
        loaded.report.note("dissolve: the body is solid glass");
        Material::glass(m.optical_density.map_or(1.5, f64::from))
    } else if specular.iter().any(|s| *s > 0.0) {
        // Blinn's exponent n has about the width of GGX with α² = 2/(n + 2)
        let roughness = (2.0 / (f64::from(m.shininess.unwrap_or(0.0)).max(0.0) + 2.0)).powf(0.25);
        Material::coated(diffuse, 0.0, roughness.clamp(0.01, 1.0), crate::Spectrum(specular), 1.0)
    } else {
        Material::diffuse(diffuse)
    };
    Ok(law.emitting(colour(m.emissive)).textures(Textures { base, ..Textures::default() }))
}
