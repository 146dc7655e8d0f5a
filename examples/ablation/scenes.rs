//! Scenes, and what changes nothing in them.

use fredholm::scene::{Attributes, Camera, Film, Material, Scene, SceneBuilder, Sides, Texture, Textures, geometry::Mesh, shapes};
use fredholm::{Error, Spectrum};
use std::sync::Arc;

pub(crate) type Addition = fn(&mut SceneBuilder) -> Result<(), Error>;

/// Height of the lamp, in the middle and facing down.
pub(crate) const LAMP: f64 = 2.0;

fn floor(scene: &mut SceneBuilder, material: Material) -> Result<(), Error> {
    let material = scene.material(material);
    let (vertices, texcoords) = (vec![[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]], vec![[0.0; 2]; 4]);
    scene.smooth_mesh(Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]])?, material, Attributes { normals: Vec::new(), texcoords })
}

fn ball(scene: &mut SceneBuilder, material: Material) -> Result<(), Error> {
    let material = scene.material(material);
    scene.sphere([0.0, 0.3, 0.3], 0.5, material)
}

/// Above the lamp.
fn ceiling(scene: &mut SceneBuilder, material: Material) -> Result<(), Error> {
    let material = scene.material(material);
    scene.mesh(shapes::parallelogram([-3.0, 2.5, -3.0], [6.0, 0.0, 0.0], [0.0, 0.0, 6.0])?, material)
}

fn second_lamp(scene: &mut SceneBuilder) -> Result<(), Error> {
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([1e-6; 3]).sides(Sides::Front));
    scene.mesh(shapes::parallelogram([-0.1, -9.0, -0.1], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1])?, lamp)
}

fn hidden_box(scene: &mut SceneBuilder) -> Result<(), Error> {
    let material = scene.material(grey());
    scene.mesh(shapes::cuboid([-0.1, -9.0, -0.1], [0.1, -8.0, 0.1])?, material)
}

fn grey() -> Material {
    Material::diffuse([0.5; 3])
}

fn ones() -> Result<Arc<Texture>, Error> {
    Ok(Arc::new(Texture::new(1, 1, vec![Spectrum([1.0; 3])])?))
}

/// A scene and what its camera sees of it at height `target`.
pub(crate) fn built(addition: Addition, target: f64) -> Result<(Scene, Film), Error> {
    let mut scene = Scene::builder();
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([5.0; 3]).sides(Sides::Front));
    scene.mesh(shapes::parallelogram([-0.5, LAMP, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])?, lamp)?;
    addition(&mut scene)?;
    let scene = scene.build()?;
    let film = scene.film(Camera::look_at([0.0, 1.0, 1.2], [0.0, target, 0.5]), 32, 32);
    Ok((scene, film))
}

/// Name, scene, the scene with what is skipped; without one, the spared shadow rays are cast.
pub(crate) fn pairs() -> [(&'static str, Addition, Option<Addition>); 8] {
    let plain: Addition = |s| floor(s, grey());
    [
        ("shadow rays behind the horizon", |s| ball(s, grey()), None),
        ("shadow rays to a lamp that faces away", |s| ceiling(s, grey()), None),
        ("shadow rays from black surfaces", |s| floor(s, Material::diffuse([0.0; 3])), None),
        ("connections at mirrors", |s| floor(s, Material::mirror([0.5; 3])), None),
        ("selection of lights", plain, Some(|s| second_lamp(s).and_then(|()| floor(s, grey())))),
        ("tree", plain, Some(|s| hidden_box(s).and_then(|()| floor(s, grey())))),
        ("texture", plain, Some(|s| floor(s, grey().textures(Textures { base: Some(ones()?), ..Textures::default() })))),
        ("mask", plain, Some(|s| floor(s, grey().cut_out(ones()?, 0.5)))),
    ]
}
