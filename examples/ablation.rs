//! What is skipped, and what it would cost: each scene beside the same with one thing in it that changes nothing, or little.
//!
//! Equation: L = Lₑ + T L over a floor under a lamp. Out of sight of both lie, one at a time, a second light, triangles enough for a tree, a
//! texture and a mask of ones, a floor that is nearly a mirror instead of one.
//!
//! `cargo run --release --example ablation -- [--samples 256]`: a line of CSV each; the connections count those tried and those spared.
#![allow(clippy::print_stdout)]

use fredholm::scene::{Attributes, Camera, Material, Scene, SceneBuilder, Sides, Texture, Textures, geometry::Mesh, shapes};
use fredholm::{Error, Spectrum, Walk};
use std::{sync::Arc, time::Instant};

type Addition = fn(&mut SceneBuilder) -> Result<(), Error>;

fn floor(scene: &mut SceneBuilder, material: Material) -> Result<(), Error> {
    let material = scene.material(material);
    let (vertices, texcoords) = (vec![[-1.0, 0.0, -1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0]], vec![[0.0; 2]; 4]);
    scene.smooth_mesh(Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]])?, material, Attributes { normals: Vec::new(), texcoords })
}

fn grey() -> Material {
    Material::diffuse([0.5; 3])
}

fn ones() -> Result<Arc<Texture>, Error> {
    Ok(Arc::new(Texture::new(1, 1, vec![Spectrum([1.0; 3])])?))
}

/// Seconds, the least of five, the mean radiance, rays and the connections: tried, at mirrors, faced away, dark.
fn run(addition: Addition, samples: u64) -> Result<(f64, String), Error> {
    let mut scene = Scene::builder();
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([5.0; 3]).sides(Sides::Front));
    scene.mesh(shapes::parallelogram([-0.5, 2.0, -0.5], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])?, lamp)?;
    addition(&mut scene)?;
    let scene = scene.build()?;
    let film = scene.film(Camera::look_at([0.0, 1.0, 1.2], [0.0, 0.0, 0.5]), 32, 32);
    let (walk, mut least) = (Walk::mis().samples_per_cell(samples), f64::INFINITY);
    for _ in 0..5 {
        let clock = Instant::now();
        scene.light_transport().seen_by(&film).solve(&walk)?;
        least = least.min(clock.elapsed().as_secs_f64());
    }
    let (equation, c) = scene.counted();
    let image = equation.seen_by(&film).solve(&walk)?;
    let mean = image.pixels().iter().map(|p| p.value[0]).sum::<f64>() / image.pixels().len() as f64;
    Ok((least, format!("{mean:.4},{},{},{},{},{}", c.rays(), c.shadow_rays(), c.mirrors(), c.unseen(), c.dark())))
}

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip_while(|a| a != "--samples");
    let samples = arguments.nth(1).and_then(|a| a.parse().ok()).unwrap_or(256);
    let plain: Addition = |s| floor(s, grey());
    let pairs: [(&str, Addition, Addition); 5] = [
        ("selection of lights", plain, |s| {
            let lamp = s.material(Material::diffuse([0.0; 3]).emitting([1e-6; 3]).sides(Sides::Front));
            s.mesh(shapes::parallelogram([-0.1, -9.0, -0.1], [0.1, 0.0, 0.0], [0.0, 0.0, 0.1])?, lamp)?;
            floor(s, grey())
        }),
        ("tree", plain, |s| {
            let grey_box = s.material(grey());
            s.mesh(shapes::cuboid([-0.1, -9.0, -0.1], [0.1, -8.0, 0.1])?, grey_box)?;
            floor(s, grey())
        }),
        ("texture", plain, |s| floor(s, grey().textures(Textures { base: Some(ones()?), ..Textures::default() }))),
        ("mask", plain, |s| floor(s, grey().cut_out(ones()?, 0.5))),
        ("connections at mirrors", |s| floor(s, Material::mirror([0.5; 3])), |s| floor(s, Material::metal([0.5; 3], 0.03))),
    ];
    println!(
        "skipped,s without,s with,ratio,radiance,rays,shadow rays,at mirrors,faced away,dark,radiance with,rays,shadow rays,at mirrors,faced away,dark"
    );
    for (name, without, with) in pairs {
        let ((a, before), (b, after)) = (run(without, samples)?, run(with, samples)?);
        println!("{name},{a:.4},{b:.4},{:.2},{before},{after}", b / a);
    }
    Ok(())
}
