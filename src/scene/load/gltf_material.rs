//! glTF materials and their textures.

use super::accessor::{Buffers, fetch};
use super::picture::{Encoding, Picture};
use super::{Loaded, Report, wrong};
use crate::error::Error;
use crate::scene::{Bsdf, Material, MaterialId, Rgb, SceneBuilder, Sides, Texture, Textures};
use crate::value::{Value, Weight};
use gltf::material::AlphaMode;
use gltf::texture::{MagFilter, WrappingMode};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// The materials of a file, and the one for primitives without.
pub(super) struct Materials {
    ids: Vec<(MaterialId, bool)>,
    fallback: Option<MaterialId>,
}

impl Materials {
    pub(super) fn load(
        name: &str,
        document: &gltf::Document,
        buffers: &Buffers,
        folder: &Path,
        loaded: &mut Loaded,
    ) -> Result<Self, Error> {
        let mut pictures = Pictures { name, buffers, folder, cache: HashMap::new() };
        let mut ids = Vec::new();
        for m in document.materials() {
            let material = convert(&m, &mut pictures, &mut loaded.report)?;
            let textured = material.textured();
            ids.push((loaded.builder.material(material), textured));
        }
        Ok(Materials { ids, fallback: None })
    }

    /// The material of a primitive, and whether it needs texture coordinates.
    pub(super) fn of(&mut self, primitive: &gltf::Primitive, builder: &mut SceneBuilder) -> (MaterialId, bool) {
        match primitive.material().index() {
            Some(i) => self.ids[i],
            None => {
                let default = || Material::metallic_roughness([1.0; 3], 1.0, 1.0).sides(Sides::Front);
                (*self.fallback.get_or_insert_with(|| builder.material(default())), false)
            }
        }
    }
}

fn convert(m: &gltf::Material, pictures: &mut Pictures, report: &mut Report) -> Result<Material, Error> {
    let pbr = m.pbr_metallic_roughness();
    for (used, what) in [
        (m.normal_texture().is_some(), "normal map"),
        (m.occlusion_texture().is_some(), "occlusion map"),
        (m.alpha_mode() == AlphaMode::Blend, "blended alpha: the material is opaque"),
        (m.double_sided() && m.emissive_factor() != [0.0; 3], "emission of the back: the front alone emits"),
    ] {
        if used {
            report.note(what);
        }
    }
    let [r, g, b, alpha] = pbr.base_color_factor().map(f64::from);
    let emission = m.emissive_factor().map(|c| f64::from(c) * f64::from(m.emissive_strength().unwrap_or(1.0)));
    let textures = Textures {
        base: pbr.base_color_texture().map(|t| pictures.texture(&t, Encoding::Srgb, report)).transpose()?,
        metallic_roughness: pbr.metallic_roughness_texture().map(|t| pictures.texture(&t, Encoding::Linear, report)).transpose()?,
        emission: m.emissive_texture().map(|t| pictures.texture(&t, Encoding::Srgb, report)).transpose()?,
    };
    let sides = if m.double_sided() { Sides::Both } else { Sides::Front };
    let material = scattering(m, [r, g, b], report).emitting(emission).sides(sides).textures(textures);
    Ok(match mask(m, alpha, pictures)? {
        Some((mask, cutoff)) => material.cut_out(mask, cutoff),
        None => material,
    })
}

/// Where factor × texture is below the cutoff there is nothing.
fn mask(m: &gltf::Material, factor: f64, pictures: &mut Pictures) -> Result<Option<(Arc<Texture>, f64)>, Error> {
    let cutoff = m.alpha_cutoff().map_or(0.5, f64::from);
    if m.alpha_mode() != AlphaMode::Mask || cutoff <= 0.0 {
        return Ok(None);
    }
    let picture = m.pbr_metallic_roughness().base_color_texture().map(|t| pictures.decode(&t)).transpose()?;
    Ok(match picture {
        // a factor of 0 leaves nothing: no texel reaches an infinite cutoff
        Some(picture) => Some((Arc::new(picture.alpha()?), cutoff / factor)),
        None if factor < cutoff => Some((Arc::new(Texture::new(1, 1, vec![Rgb::ZERO])?), 1.0)),
        None => None,
    })
}

/// The law: glass if light passes, else the coated base.
fn scattering(m: &gltf::Material, base: [f64; 3], report: &mut Report) -> Material {
    let pbr = m.pbr_metallic_roughness();
    let (metallic, roughness) = (f64::from(pbr.metallic_factor()), f64::from(pbr.roughness_factor()));
    let index = m.ior().map_or(1.5, f64::from);
    if let Some(t) = m.transmission() {
        if m.volume().is_none() {
            report.note("thin-walled transmission: the body is solid glass");
        }
        if m.volume().is_some_and(|v| v.attenuation_distance().is_finite()) {
            report.note("attenuation in a volume");
        }
        if t.transmission_texture().is_some() {
            report.note("transmission map");
        }
        if t.transmission_factor() == 1.0 {
            let tint = crate::Spectrum(base);
            let smooth = Bsdf::Dielectric { index, tint };
            let rough = Bsdf::RoughDielectric { index, tint, alpha: (roughness * roughness).max(1e-4) };
            return Material::new(if roughness == 0.0 { smooth } else { rough });
        }
        report.note("partial transmission: the material is opaque");
    }
    let specular = m.specular();
    let factor = specular.as_ref().map_or(1.0, |s| f64::from(s.specular_factor()));
    let colour = specular.as_ref().map_or(Rgb::ONE, |s| crate::Spectrum(s.specular_color_factor().map(f64::from)));
    if specular.is_some_and(|s| s.specular_texture().is_some() || s.specular_color_texture().is_some()) {
        report.note("specular map");
    }
    let normal = ((index - 1.0) / (index + 1.0)).powi(2);
    let coat = colour.map(|c| (normal * c).min(1.0) * factor);
    Material::coated(base, metallic, roughness, coat, factor)
}

/// Decoded images, each once.
struct Pictures<'a> {
    name: &'a str,
    buffers: &'a Buffers<'a>,
    folder: &'a Path,
    cache: HashMap<(usize, Encoding), Arc<Texture>>,
}

impl Pictures<'_> {
    fn texture(&mut self, info: &gltf::texture::Info, encoding: Encoding, report: &mut Report) -> Result<Arc<Texture>, Error> {
        let texture = info.texture();
        if info.tex_coord() != 0 {
            report.note(format!("texture coordinates of set {}: those of set 0 are used", info.tex_coord()));
        }
        let sampler = texture.sampler();
        if sampler.wrap_s() != WrappingMode::Repeat || sampler.wrap_t() != WrappingMode::Repeat {
            report.note("texture that does not repeat");
        }
        if sampler.mag_filter() == Some(MagFilter::Nearest) {
            report.note("texture that is not interpolated");
        }
        let image = texture.source();
        if let Some(known) = self.cache.get(&(image.index(), encoding)) {
            return Ok(known.clone());
        }
        let texture = Arc::new(self.decode(info)?.texture(encoding)?);
        self.cache.insert((image.index(), encoding), texture.clone());
        Ok(texture)
    }

    fn decode(&self, info: &gltf::texture::Info) -> Result<Picture, Error> {
        let image = info.texture().source();
        let bytes = match image.source() {
            gltf::image::Source::View { view, .. } => self.buffers.view(&view)?.to_vec(),
            gltf::image::Source::Uri { uri, .. } => fetch(self.name, uri, self.folder)?,
        };
        Picture::decode(&bytes).map_err(|problem| wrong(self.name, format!("image {}: {problem}", image.index())))
    }
}
