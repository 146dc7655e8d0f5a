//! What a surface is made of: a scattering law, perhaps with textures; its emission; its sides.

use super::{Bsdf, MetallicRoughness, SMOOTHEST};
use crate::error::Error;
use crate::scene::Rgb;
use crate::scene::texture::Texture;
use crate::value::Weight;
use std::sync::Arc;

/// Which sides of a surface scatter light. The other one is black, and still blocks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The side its normal points to.
    Front,
    /// Both alike.
    Both,
}

/// Textures that multiply parameters of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// Albedo, base colour or tint.
    pub base: Option<Arc<Texture>>,
    /// Roughness in the second, metallic in the third component, as glTF has it.
    pub metallic_roughness: Option<Arc<Texture>>,
    /// Emission.
    pub emission: Option<Arc<Texture>>,
}

/// A surface material.
///
/// ```
/// use fredholm::scene::{Material, Sides};
/// let lamp = Material::diffuse([0.78; 3]).emitting([17.0, 12.0, 4.0]).sides(Sides::Front);
/// let gold = Material::metal([1.0, 0.77, 0.34], 0.2);
/// # let _ = (lamp, gold);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct Material {
    pub(crate) law: Law,
    pub(crate) emission: Rgb,
    pub(crate) sides: Sides,
    pub(crate) textures: Textures,
    /// where it is below the number, there is no surface
    pub(crate) mask: Option<(Arc<Texture>, f64)>,
}

/// What textures may still change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Law {
    Fixed(Bsdf),
    MetallicRoughness { base: Rgb, metallic: f64, roughness: f64, coat: Rgb, grazing: f64 },
}

impl Material {
    /// Any scattering law, on both sides.
    pub fn new(bsdf: Bsdf) -> Self {
        Material { law: Law::Fixed(bsdf), emission: Rgb::default(), sides: Sides::Both, textures: Textures::default(), mask: None }
    }

    /// Lambert's law with this albedo, on both sides.
    pub fn diffuse(albedo: [f64; 3]) -> Self {
        Material::new(Bsdf::Lambertian { albedo: crate::Spectrum(albedo) })
    }

    /// A perfect mirror.
    pub fn mirror(reflectance: [f64; 3]) -> Self {
        Material::new(Bsdf::Mirror { reflectance: crate::Spectrum(reflectance) })
    }

    /// Clear glass, behind the front of the surface.
    pub fn glass(index: f64) -> Self {
        Material::new(Bsdf::Dielectric { index, tint: Rgb::ONE })
    }

    /// Frosted glass; `roughness` ∈ [0.01, 1], whose square is GGX's α.
    pub fn frosted(index: f64, roughness: f64) -> Self {
        Material::new(Bsdf::RoughDielectric { index, tint: Rgb::ONE, alpha: roughness * roughness })
    }

    /// Metal of this reflectance at normal incidence; `roughness` ∈ [0.01, 1], whose square is GGX's α.
    pub fn metal(specular: [f64; 3], roughness: f64) -> Self {
        Material::new(Bsdf::Conductor { specular: crate::Spectrum(specular), alpha: roughness * roughness })
    }

    /// glTF's material with an index of 1.5; `roughness` below 0.01, where facets are a mirror to all purposes, counts as 0.01.
    pub fn metallic_roughness(base: [f64; 3], metallic: f64, roughness: f64) -> Self {
        Material::coated(base, metallic, roughness, crate::Spectrum([0.04; 3]), 1.0)
    }

    /// glTF's material with F₀ and F₉₀ of the coat.
    pub(crate) fn coated(base: [f64; 3], metallic: f64, roughness: f64, coat: Rgb, grazing: f64) -> Self {
        let law = Law::MetallicRoughness { base: crate::Spectrum(base), metallic, roughness, coat, grazing };
        Material { law, ..Material::new(Bsdf::Black) }
    }

    /// Also emits this radiance, on the front side only, the same in all directions.
    pub fn emitting(self, radiance: [f64; 3]) -> Self {
        Material { emission: crate::Spectrum(radiance), ..self }
    }

    /// Scatters on these sides. Glass always does on both.
    pub fn sides(self, sides: Sides) -> Self {
        Material { sides, ..self }
    }

    /// Parameters times textures.
    pub fn textures(self, textures: Textures) -> Self {
        Material { textures, ..self }
    }

    /// Cut out: where the first component of `mask` is below `cutoff` there is no surface, and light passes.
    pub fn cut_out(self, mask: Arc<Texture>, cutoff: f64) -> Self {
        Material { mask: Some((mask, cutoff)), ..self }
    }

    /// Whether there is no surface after all.
    #[inline]
    pub(crate) fn is_hole(&self, texcoord: impl Fn() -> [f64; 2]) -> bool {
        self.mask.as_ref().is_some_and(|(mask, cutoff)| mask.at(texcoord())[0] < *cutoff)
    }

    /// The scattering law at a point with these texture coordinates.
    #[inline]
    pub(crate) fn at(&self, texcoord: impl Fn() -> [f64; 2]) -> Bsdf {
        match (&self.law, &self.textures) {
            (Law::Fixed(bsdf), Textures { base: None, .. }) => *bsdf,
            (Law::Fixed(bsdf), Textures { base: Some(texture), .. }) => tinted(*bsdf, texture.at(texcoord())),
            (Law::MetallicRoughness { base, metallic, roughness, coat, grazing }, textures) => {
                Bsdf::MetallicRoughness(resolved((*base, *metallic, *roughness), (*coat, *grazing), textures, texcoord))
            }
        }
    }

    /// Radiance emitted on the front.
    #[inline]
    pub(crate) fn radiance(&self, texcoord: impl Fn() -> [f64; 2]) -> Rgb {
        match &self.textures.emission {
            _ if self.is_hole(&texcoord) => Rgb::default(),
            None => self.emission,
            Some(texture) => self.emission.apply(texture.at(texcoord())),
        }
    }

    /// Whether any texture is fetched.
    pub(crate) fn textured(&self) -> bool {
        let Textures { base, metallic_roughness, emission } = &self.textures;
        base.is_some() || metallic_roughness.is_some() || emission.is_some() || self.mask.is_some()
    }

    pub(crate) fn transmits(&self) -> bool {
        matches!(self.law, Law::Fixed(bsdf) if bsdf.transmits())
    }

    /// Whether only Dirac parts scatter.
    pub(crate) fn is_singular(&self) -> bool {
        matches!(self.law, Law::Fixed(bsdf) if bsdf.is_singular())
    }

    pub(crate) fn validate(&self) -> Result<(), Error> {
        if let Some(e) = self.emission.0.iter().find(|e| !(**e >= 0.0 && e.is_finite())) {
            return Err(Error::invalid("emission", *e, "must be finite and not negative"));
        }
        if let Some((_, cutoff)) = self.mask.as_ref().filter(|m| m.1.is_nan()) {
            return Err(Error::invalid("cutoff of a mask", *cutoff, "must be a number"));
        }
        match self.law {
            Law::Fixed(bsdf) => bsdf.validate(),
            Law::MetallicRoughness { base, metallic, roughness, coat, grazing } => {
                if !(0.0..=1.0).contains(&metallic) {
                    return Err(Error::invalid("metallic", metallic, "must lie in [0, 1]"));
                }
                if !(0.0..=1.0).contains(&roughness) {
                    return Err(Error::invalid("roughness", roughness, "must lie in [0, 1]"));
                }
                MetallicRoughness::coated(base, metallic, roughness.max(SMOOTHEST.sqrt()), coat, grazing).validate()
            }
        }
    }
}

/// Base colour, metallic and roughness times their textures.
fn resolved(
    (mut base, mut metallic, mut roughness): (Rgb, f64, f64),
    (coat, grazing): (Rgb, f64),
    textures: &Textures,
    texcoord: impl Fn() -> [f64; 2],
) -> MetallicRoughness {
    if let Some(texture) = &textures.base {
        base = base.apply(texture.at(texcoord()));
    }
    if let Some(texture) = &textures.metallic_roughness {
        let t = texture.at(texcoord());
        (roughness, metallic) = (roughness * t[1], metallic * t[2]);
    }
    // the floor of α is said in the documentation of `Bsdf`: a texture may reach 0
    MetallicRoughness::coated(base, metallic, roughness.max(SMOOTHEST.sqrt()), coat, grazing)
}

/// The law with its colour multiplied.
fn tinted(bsdf: Bsdf, by: Rgb) -> Bsdf {
    match bsdf {
        Bsdf::Lambertian { albedo } => Bsdf::Lambertian { albedo: albedo.apply(by) },
        Bsdf::Mirror { reflectance } => Bsdf::Mirror { reflectance: reflectance.apply(by) },
        Bsdf::Dielectric { index, tint } => Bsdf::Dielectric { index, tint: tint.apply(by) },
        Bsdf::RoughDielectric { index, tint, alpha } => Bsdf::RoughDielectric { index, tint: tint.apply(by), alpha },
        Bsdf::Conductor { specular, alpha } => Bsdf::Conductor { specular: specular.apply(by), alpha },
        Bsdf::Black | Bsdf::MetallicRoughness(_) => bsdf,
    }
}
