//! glTF 2.0: nodes, meshes, cameras, lights (Khronos Group, *glTF 2.0 specification*, 2021).

use super::accessor::Buffers;
use super::gltf_material::Materials;
use super::{Loaded, wrong};
use crate::error::Error;
use crate::scene::geometry::Mesh;
use crate::scene::{Attributes, Camera};
use gltf::khr_lights_punctual::Kind;
use gltf::mesh::Mode;
use gltf::{Node, Primitive, Semantic};
use nalgebra::{Matrix3, Matrix4, Vector3};
use std::path::Path;

/// Extensions that are read.
const KNOWN: [&str; 6] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
];

/// A file on its way into a builder.
struct Reader<'a> {
    name: &'a str,
    buffers: Buffers<'a>,
    materials: Materials,
    loaded: Loaded,
    seen: Vec<bool>,
}

pub(super) fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<Loaded, Error> {
    let (document, blob) = document(name, bytes)?;
    let buffers = Buffers::load(name, &document, blob, folder)?;
    let mut loaded = Loaded::empty();
    for extension in document.extensions_used().filter(|e| !KNOWN.contains(e)) {
        loaded.report.note(format!("extension {extension}"));
    }
    document.animations().for_each(|_| loaded.report.note("animation"));
    document.scenes().skip(1).for_each(|_| loaded.report.note("scene beside the first or the default one"));
    let materials = Materials::load(name, &document, &buffers, folder, &mut loaded)?;
    let scene = document.default_scene().or_else(|| document.scenes().next()).ok_or_else(|| wrong(name, "the file has no scene"))?;
    let mut reader = Reader { name, buffers, materials, loaded, seen: vec![false; document.nodes().len()] };
    // a stack of its own: a file may nest deeper than the program's
    let mut stack: Vec<(Node, Matrix4<f64>)> = scene.nodes().map(|n| (n, Matrix4::identity())).collect();
    stack.reverse();
    while let Some((node, parent)) = stack.pop() {
        let transform = reader.node(&node, &parent)?;
        let children: Vec<_> = node.children().map(|c| (c, transform)).collect();
        stack.extend(children.into_iter().rev());
    }
    Ok(reader.loaded)
}

/// The file as JSON, and what follows it in a `.glb`; every index in it is good.
fn document(name: &str, bytes: &[u8]) -> Result<(gltf::Document, Option<Vec<u8>>), Error> {
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice_without_validation(bytes).map_err(|e| wrong(name, e))?;
    let json = document.into_json();
    // the crate's own validation looks positions up before it has checked where they are
    let mut named = json.meshes.iter().flat_map(|m| &m.primitives).flat_map(|p| p.attributes.values());
    if let Some(bad) = named.find(|i| i.value() >= json.accessors.len()) {
        return Err(wrong(name, format!("a primitive names accessor {}, but there are {}", bad.value(), json.accessors.len())));
    }
    if let Some(problem) = gap(&json) {
        return Err(wrong(name, problem));
    }
    gltf::Document::from_json(json).map(|document| (document, blob)).map_err(|e| wrong(name, e))
}

/// What the crate takes for granted when it is asked for it, and files may leave out.
fn gap(json: &gltf::json::Root) -> Option<String> {
    use gltf::json::camera::Type as Projection;
    use gltf::json::extensions::scene::khr_lights_punctual::Type;
    use gltf::json::validation::Checked;
    let empty = |i: &gltf::json::Image| if i.buffer_view.is_some() { i.mime_type.is_none() } else { i.uri.is_none() };
    let blind = |c: &gltf::json::Camera| match c.type_ {
        Checked::Valid(Projection::Perspective) => c.perspective.is_none(),
        Checked::Valid(Projection::Orthographic) => c.orthographic.is_none(),
        Checked::Invalid => true,
    };
    if let Some(i) = json.images.iter().position(empty) {
        return Some(format!("image {i} has neither a URI nor a buffer view with its type"));
    }
    if let Some(i) = json.cameras.iter().position(blind) {
        return Some(format!("camera {i} has no projection"));
    }
    let lights = json.extensions.as_ref()?.khr_lights_punctual.as_ref()?;
    let i = lights.lights.iter().position(|l| l.type_ == Checked::Valid(Type::Spot) && l.spot.is_none())?;
    Some(format!("light {i} is a spot without a beam"))
}

impl Reader<'_> {
    fn node(&mut self, node: &Node, parent: &Matrix4<f64>) -> Result<Matrix4<f64>, Error> {
        let fail = |problem: String| wrong(self.name, format!("node {}: {problem}", node.index()));
        if std::mem::replace(&mut self.seen[node.index()], true) {
            return Err(fail("is its own ancestor, or has two parents".into()));
        }
        let local = Matrix4::from(node.transform().matrix()).map(f64::from);
        let transform = parent * local;
        let linear: Matrix3<f64> = transform.fixed_view::<3, 3>(0, 0).into_owned();
        let determinant = linear.determinant();
        let size = linear.norm();
        let needed = node.mesh().is_some() || node.camera().is_some() || node.light().is_some();
        if needed && !(determinant.abs() > 1e-12 * size.powi(3) && transform.iter().all(|x| x.is_finite())) {
            return Err(fail(format!("its transform cannot be inverted: determinant {determinant}")));
        }
        if let Some(mesh) = node.mesh() {
            if node.skin().is_some() {
                self.loaded.report.note("skin: the mesh is left as it is");
            }
            for primitive in mesh.primitives() {
                self.primitive(&primitive, &transform, determinant)?;
            }
        }
        if let Some(camera) = node.camera() {
            self.camera(&camera, &transform);
        }
        if let Some(light) = node.light() {
            self.light(&light, &transform)?;
        }
        Ok(transform)
    }

    fn primitive(&mut self, primitive: &Primitive, transform: &Matrix4<f64>, determinant: f64) -> Result<(), Error> {
        if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.loaded.report.note(format!("primitive of mode {:?}", primitive.mode()));
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            self.loaded.report.note("primitive without positions");
            return Ok(());
        };
        primitive.morph_targets().for_each(|_| self.loaded.report.note("morph target"));
        for (semantic, _) in primitive.attributes() {
            if !matches!(semantic, Semantic::Positions | Semantic::Normals | Semantic::Tangents | Semantic::TexCoords(0)) {
                self.loaded.report.note(format!("vertex attribute {}", semantic.to_string()));
            }
        }
        let point = |p: &[f32; 3]| transform.transform_point(&p.map(f64::from).into()).coords.into();
        let vertices: Vec<[f64; 3]> = self.buffers.floats::<3>(&positions)?.iter().map(point).collect();
        let indices = match primitive.indices() {
            Some(a) => self.buffers.indices(&a)?,
            None => (0..vertices.len() as u32).collect(),
        };
        let mut triangles = triangles(primitive.mode(), &indices);
        if determinant < 0.0 {
            // a mirrored mesh would show its back
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let (material, textured) = self.materials.of(primitive, &mut self.loaded.builder);
        let attributes = self.attributes(primitive, transform, textured)?;
        self.loaded.builder.smooth_mesh(Mesh::new(vertices, triangles)?, material, attributes)
    }

    fn attributes(&self, primitive: &Primitive, transform: &Matrix4<f64>, textured: bool) -> Result<Attributes, Error> {
        let mut attributes = Attributes::default();
        if let Some(a) = primitive.get(&Semantic::Normals) {
            // normals go with the inverse transpose; cofactors do, up to a length
            let linear: Matrix3<f64> = transform.fixed_view::<3, 3>(0, 0).into_owned();
            let inverse = linear.try_inverse().ok_or_else(|| wrong(self.name, "a transform that cannot be inverted"))?.transpose();
            let turned = |n: &[f32; 3]| -> [f32; 3] {
                let n = inverse * Vector3::from(n.map(f64::from));
                (n / n.norm()).map(|x| x as f32).into()
            };
            attributes.normals = self.buffers.floats::<3>(&a)?.iter().map(turned).collect();
        }
        if let (true, Some(a)) = (textured, primitive.get(&Semantic::TexCoords(0))) {
            attributes.texcoords = self.buffers.floats::<2>(&a)?;
        }
        Ok(attributes)
    }

    fn camera(&mut self, camera: &gltf::Camera, transform: &Matrix4<f64>) {
        let gltf::camera::Projection::Perspective(lens) = camera.projection() else {
            self.loaded.report.note("orthographic camera");
            return;
        };
        let column = |j: usize| -> [f64; 3] { std::array::from_fn(|i| transform[(i, j)]) };
        let view = Camera::towards(column(3), column(2).map(|x| -x)).up(column(1));
        let view = view.field_of_view(f64::from(lens.yfov()).to_degrees());
        self.loaded.cameras.push((view, lens.aspect_ratio().map(f64::from)));
    }

    fn light(&mut self, light: &gltf::khr_lights_punctual::Light, transform: &Matrix4<f64>) -> Result<(), Error> {
        let strength = light.color().map(|c| f64::from(c) * f64::from(light.intensity()));
        let column = |j: usize| -> [f64; 3] { std::array::from_fn(|i| transform[(i, j)]) };
        if light.range().is_some() {
            self.loaded.report.note("range of a light: it has none");
        }
        match light.kind() {
            Kind::Point => self.loaded.builder.point_light(column(3), strength),
            Kind::Directional => self.loaded.builder.directional_light(column(2).map(|x| -x), strength),
            Kind::Spot { inner_cone_angle, outer_cone_angle } => {
                let angles = [inner_cone_angle, outer_cone_angle].map(|a| f64::from(a).to_degrees());
                self.loaded.builder.spot_light(column(3), column(2).map(|x| -x), strength, angles)
            }
        }
    }
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            indices.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => indices.get(1..).unwrap_or(&[]).windows(2).map(|w| [indices[0], w[0], w[1]]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}
