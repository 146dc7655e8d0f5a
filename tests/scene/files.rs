//! Files, right and wrong.

use crate::scene_file;
use fredholm::scene::load::{gltf, load};
use fredholm::scene::{Material, Scene, shapes};
use fredholm::{Error, Walk};

/// plates.gltf with one thing changed.
fn changed(from: &str, to: &str) -> Result<Scene, Error> {
    let text = std::fs::read_to_string(scene_file("plates.gltf")).unwrap();
    assert!(text.contains(from), "{from}");
    gltf(text.replacen(from, to, 1).as_bytes(), ".").and_then(|l| l.builder.build())
}

fn problem(result: Result<Scene, Error>) -> String {
    result.map(|_| ()).unwrap_err().to_string()
}

#[test]
fn every_scene_loads() {
    for (name, triangles) in
        [("cornell", 38), ("furnace_box", 12), ("furnace_sphere", 1280), ("plates", 4), ("many_lights", 1120), ("ajar_door", 394)]
    {
        let loaded = load(scene_file(&format!("{name}.gltf"))).unwrap();
        assert!(loaded.report.is_empty() && loaded.cameras.len() == 1, "{name}: {}", loaded.report);
        assert_eq!(loaded.builder.build().unwrap().geometry().primitives(), triangles, "{name}");
    }
}

#[test]
fn hostile_files_are_refused_by_name() {
    for (from, to, expected) in [
        ("\"byteLength\": 144", "\"byteLength\": 18446744073709551615", "buffer"),
        ("\"count\": 4", "\"count\": 4000000000", "accessor 0"),
        ("\"bufferView\": 0", "\"bufferView\": 77", "Index out of bounds"),
        ("\"mesh\": 0", "\"mesh\": 9", "Index out of bounds"),
        ("\"mesh\": 0", "\"mesh\": 0, \"children\": [0]", "node 0: is its own ancestor"),
        ("\"mesh\": 0", "\"mesh\": 0, \"scale\": [1, 0, 1]", "node 0: its transform cannot be inverted"),
        ("\"mesh\": 0", "\"mesh\": 0, \"scale\": [1e39, 1, 1]", "number out of range"),
        ("\"componentType\": 5125", "\"componentType\": 5126", "no indices"),
        ("\"type\": \"VEC3\"", "\"type\": \"VEC2\"", "where 3 numbers are needed"),
        ("\"emissiveStrength\": 1.0", "\"emissiveStrength\": -1.0", "emission"),
        (";base64,", ";base65,", "data URI"),
        ("\"POSITION\": 0", "\"POSITION\": 99", "a primitive names accessor 99"),
        // a position that is not a number; an index of a vertex that is not there
        ("base64,AACAvwAAgL8AAAC/", "base64,AADAfwAAwH8AAMB/", "NaN"),
        ("AAAAAAEAAAACAAAA", "AAAAAAEAAAAJAAAA", "9"),
        ("\"emissiveStrength\": 1.0", "\"emissiveStrength\": 1e39", "number out of range"),
        ("0.8,\n     0.5,\n     0.2,", "1.8,\n     0.5,\n     0.2,", "albedo = 1.79"),
    ] {
        let text = std::fs::read_to_string(scene_file("plates.gltf")).unwrap();
        if !text.contains(from) {
            panic!("plates.gltf does not say {from}");
        }
        let message = match changed(from, to) {
            Ok(_) => panic!("{to} is accepted"),
            Err(e) => e.to_string(),
        };
        assert!(message.contains(expected), "{to}: {message}");
    }
}

#[test]
fn truncated_files_are_refused() {
    let text = std::fs::read(scene_file("plates.gltf")).unwrap();
    for length in [0, 1, 4, 20, text.len() / 2, text.len() - 2] {
        assert!(matches!(gltf(&text[..length], "."), Err(Error::SceneFile { .. })), "{length}");
    }
    assert!(matches!(gltf(b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON", "."), Err(Error::SceneFile { .. })));
    assert!(matches!(load("nowhere.gltf"), Err(Error::Io { .. })));
    assert!(matches!(load(scene_file("plates_exact.npy")), Err(Error::SceneFile { .. })));
}

#[test]
fn what_is_not_used_is_reported() {
    let text = std::fs::read_to_string(scene_file("plates.gltf")).unwrap();
    let text = text.replacen("\"doubleSided\"", "\"alphaMode\": \"BLEND\", \"normalTexture\": {\"index\": 0}, \"doubleSided\"", 1);
    let text = text.replacen("\"meshes\"", "\"images\": [{\"uri\": \"bumps.png\"}], \"textures\": [{\"source\": 0}], \"meshes\"", 1);
    let text = text.replacen("\"extensionsUsed\": [", "\"extensionsUsed\": [\"KHR_materials_sheen\", ", 1);
    let text = text.replacen("\"doubleSided\": false", "\"doubleSided\": true", 1);
    let report = gltf(text.as_bytes(), ".").unwrap().report;
    let entries: Vec<_> = report.entries().collect();
    let expected = [
        ("blended alpha: the material is opaque", 1),
        ("emission of the back: the front alone emits", 1),
        ("extension KHR_materials_sheen", 1),
        ("normal map", 1),
    ];
    assert_eq!(entries, expected);
}

/// Spot lights become lights, masks holes.
#[test]
fn beams_and_masks_are_used() {
    let text = std::fs::read_to_string(scene_file("plates.gltf")).unwrap();
    let masked = text.replace("\"doubleSided\"", "\"alphaMode\": \"MASK\", \"alphaCutoff\": 2.0, \"doubleSided\"");
    let loaded = gltf(masked.as_bytes(), ".").unwrap();
    assert!(loaded.report.is_empty(), "{}", loaded.report);
    let camera = loaded.cameras[0].0;
    let scene = loaded.builder.build().unwrap();
    let image = scene.light_transport().seen_by(&scene.film(camera, 2, 2)).solve(&Walk::mis().samples_per_cell(4)).unwrap();
    assert!(image.pixels().iter().all(|p| p.value.0 == [0.0; 3]), "all of it is a hole");
    let spot = r#""extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}}, "nodes""#;
    let (head, nodes) = text.rsplit_once("\"nodes\"").unwrap();
    let lit = [head, spot, nodes].concat();
    let lit = lit.replacen("\"mesh\": 0", "\"mesh\": 0, \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}", 1);
    let lit = lit.replacen("\"extensionsUsed\": [", "\"extensionsUsed\": [\"KHR_lights_punctual\", ", 1);
    let loaded = gltf(lit.as_bytes(), ".").unwrap();
    assert!(loaded.report.is_empty(), "{}", loaded.report);
    assert!(loaded.builder.build().unwrap().to_string().contains("5 lights near"));
    let ranged = lit.replace("\"type\": \"spot\"", "\"type\": \"spot\", \"range\": 3.0");
    assert_eq!(gltf(ranged.as_bytes(), ".").unwrap().report.to_string(), "range of a light: it has none (1×)");
    // left out where it is needed: found by mutation
    let refused = |text: String| gltf(text.as_bytes(), ".").unwrap_err().to_string();
    assert!(refused(lit.replace("\"spot\": {\"outerConeAngle\": 0.5}", "\"name\": \"x\"")).contains("light 0 is a spot without a beam"));
    assert!(refused(text.replace("\"perspective\": {", "\"spective\": {")).contains("camera 0 has no projection"));
    let image = r#""images": [{"wri": ""}], "textures": [{"source": 0}], "meshes""#;
    assert!(refused(text.replacen("\"meshes\"", image, 1)).contains("image 0 has neither"));
}

#[test]
fn wavefront_files_load() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    std::fs::write(folder.join("box.mtl"), "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 2 3\n").unwrap();
    let obj = "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl lamp\nf 1 2 3 4\n";
    std::fs::write(folder.join("box.obj"), obj).unwrap();
    let loaded = load(folder.join("box.obj")).unwrap();
    assert!(loaded.report.is_empty(), "{}", loaded.report);
    let scene = loaded.builder.build().unwrap();
    let lamp = scene.look([0.5, 0.5, 1.0], [0.0, 0.0, -1.0]);
    assert_eq!(fredholm::source::Source::eval(scene.light_transport().source(), &lamp).0, [1.0, 2.0, 3.0]);
    // one number is a grey; two are none, and said
    let seen = |library: &str| {
        std::fs::write(folder.join("short.mtl"), library).unwrap();
        std::fs::write(folder.join("short.obj"), obj.replace("box.mtl", "short.mtl")).unwrap();
        let loaded = load(folder.join("short.obj")).unwrap();
        let (report, scene) = (loaded.report.to_string(), loaded.builder.build().unwrap());
        let lamp = scene.look([0.5, 0.5, 1.0], [0.0, 0.0, -1.0]);
        (fredholm::source::Source::eval(scene.light_transport().source(), &lamp).0, report)
    };
    assert_eq!(seen("newmtl lamp\nKe 2\n"), ([2.0; 3], "everything in the file is used".to_string()));
    for short in ["newmtl lamp\nKe 2 2\n", "newmtl lamp\nKd\n"] {
        assert!(seen(short).1.contains("everything is grey"), "{short}");
    }
    std::fs::write(folder.join("bad.obj"), "v 0 0 x\nf 1 2 3\n").unwrap();
    assert!(matches!(load(folder.join("bad.obj")), Err(Error::SceneFile { .. })));
    std::fs::write(folder.join("far.obj"), "v 0 0 0\nv 1 0 0\nf 1 2 9\n").unwrap();
    assert!(load(folder.join("far.obj")).is_err());
}

#[test]
fn impossible_scenes_are_refused() {
    let with = |material: Material| {
        let mut scene = Scene::builder();
        let id = scene.material(material);
        scene.mesh(shapes::cuboid([0.0; 3], [1.0; 3]).unwrap(), id).unwrap();
        scene.build()
    };
    for (material, parameter) in [
        (Material::diffuse([1.1, 0.0, 0.0]), "albedo"),
        (Material::diffuse([f64::NAN; 3]), "albedo"),
        (Material::mirror([-0.1; 3]), "reflectance"),
        (Material::glass(0.0), "index of refraction"),
        (Material::frosted(1.5, 1.5), "GGX alpha"),
        (Material::metal([1.0; 3], 0.0), "GGX alpha"),
        (Material::metallic_roughness([0.5; 3], 2.0, 0.5), "metallic"),
        (Material::metallic_roughness([0.5; 3], 0.0, f64::NAN), "roughness"),
        (Material::diffuse([0.5; 3]).emitting([f64::INFINITY; 3]), "emission"),
    ] {
        let message = problem(with(material.clone()));
        assert!(message.starts_with(&format!("invalid {parameter} = ")), "{material:?}: {message}");
    }
    let mut scene = Scene::builder();
    assert!(scene.point_light([0.0, f64::NAN, 0.0], [1.0; 3]).is_err());
    // each is finite, their sum is not
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([f64::MAX; 3]));
    scene.mesh(shapes::cuboid([0.0; 3], [1.0; 3]).unwrap(), lamp).unwrap();
    assert!(problem(scene.build()).starts_with("invalid power of the lights = inf"));
    let mut scene = Scene::builder();
    assert!(scene.directional_light([0.0; 3], [1.0; 3]).is_err());
}

/// No geometry, no light: a black image; the scene says why, and the verdict that nothing scored.
#[test]
fn nothing_is_black() {
    use fredholm::scene::Camera;
    use fredholm::statistics::Verdict;
    let mut dark = Scene::builder();
    let grey = dark.material(Material::diffuse([0.5; 3]));
    dark.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), grey).unwrap();
    assert!(dark.is_dark());
    for builder in [Scene::builder(), dark] {
        let scene = builder.build().unwrap();
        assert!(scene.to_string().contains("no light: the image is black"), "{scene}");
        let film = scene.film(Camera::look_at([0.0; 3], [1.0, 0.0, 0.0]), 2, 2);
        let image = scene.light_transport().seen_by(&film).solve(&Walk::mis().samples_per_cell(8)).unwrap();
        assert!(image.pixels().iter().all(|p| p.value.0 == [0.0; 3] && p.verdict() == Verdict::NothingScored));
    }
}

/// Triangles without area are there, and said to be, but nothing hits them and they light nothing; one turned over shows, and emits from, its other side.
#[test]
fn flat_and_inverted_triangles() {
    use fredholm::scene::{Camera, Sides, geometry::Mesh};
    let lamp = |triangle: [u32; 3]| {
        let mut scene = Scene::builder();
        let lamp = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]).sides(Sides::Front));
        let corners = vec![[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 0.0]];
        scene.mesh(Mesh::new(corners, vec![triangle]).unwrap(), lamp).unwrap();
        let scene = scene.build().unwrap();
        let seen = |z: f64| {
            let film = scene.film(Camera::towards([0.0, 0.0, z], [0.0, 0.0, -z]), 1, 1);
            scene.light_transport().seen_by(&film).solve(&Walk::mis().samples_per_cell(4)).unwrap()[(0, 0)].value[0]
        };
        ([1.0, -1.0].map(seen), scene.to_string())
    };
    assert_eq!(lamp([0, 1, 2]).0, [1.0, 0.0]);
    assert_eq!(lamp([0, 2, 1]).0, [0.0, 1.0]);
    let (dark, says) = lamp([0, 1, 1]);
    assert_eq!(dark, [0.0; 2]);
    assert!(says.contains("triangles without area are never hit") && says.contains("no light"), "{says}");
}

/// Pictures of absurd sizes, and what is no picture.
#[test]
fn hostile_pictures_are_refused() {
    let text = std::fs::read_to_string(scene_file("plates.gltf")).unwrap();
    let with = |uri: &str| {
        let images = format!("\"images\": [{{\"uri\": \"{uri}\"}}], \"textures\": [{{\"source\": 0}}], \"meshes\"");
        let text = text.replacen("\"meshes\"", &images, 1);
        let text = text.replacen("\"baseColorFactor\"", "\"baseColorTexture\": {\"index\": 0}, \"baseColorFactor\"", 1);
        problem(gltf(text.as_bytes(), ".").and_then(|l| l.builder.build()))
    };
    // headers of PNG images
    let million = "iVBORw0KGgoAAAANSUhEUgAPQkAAD0JACAYAAABcbTh9AAAACElEQVR4nAMAAAAAAUgGidIAAAAASUVORK5CYII=";
    let empty = "iVBORw0KGgoAAAANSUhEUgAAAAAAAAAECAYAAACgGj4EAAAACElEQVR4nAMAAAAAAUgGidIAAAAASUVORK5CYII=";
    for (uri, expected) in [
        (format!("data:image/png;base64,{million}"), "1000000 × 1000000 texels"),
        (format!("data:image/png;base64,{empty}"), "image 0"),
        ("data:image/png;base64,iVBORw0KGgo=".into(), "image 0"),
        ("data:image/png;base64,AAAA".into(), "neither PNG nor JPEG"),
        ("nowhere.png".into(), "nowhere.png"),
        ("https://example.org/a.png".into(), "only files beside the scene"),
    ] {
        let message = with(&uri);
        assert!(message.contains(expected), "{uri}: {message}");
    }
}

/// Frosted glass of index 1 bends nothing: what is behind is seen through it, by all walks.
#[test]
fn glass_of_index_1_is_not_there() {
    use fredholm::scene::Camera;
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    let nothing = scene.material(Material::frosted(1.0, 0.5));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.sphere([0.0; 3], 0.5, nothing).unwrap();
    let scene = scene.build().unwrap();
    let film = scene.film(Camera::look_at([0.0, 0.1, 0.9], [0.0; 3]), 1, 1);
    let image = scene.light_transport().seen_by(&film).solve(&Walk::mis().samples_per_cell(1 << 10)).unwrap();
    assert!(image[(0, 0)].agrees_with(fredholm::Spectrum([2.0; 3]), 5.0), "{}", image[(0, 0)]);
}

/// Files with bytes changed, doubled or left out: an error or a scene, never a panic.
#[test]
fn mangled_files_never_panic() {
    use fredholm::sampling::{Pcg, Sampler, Sequence};
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let mut text = std::fs::read(scene_file("plates.gltf")).unwrap();
    // less of the matrix and the names, more of the rest
    text.retain(|b| !b" \n".contains(b));
    let glb = {
        let json = String::from_utf8(text.clone()).unwrap();
        let mut json = json.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let header =
            [&b"glTF"[..], &2u32.to_le_bytes(), &(20 + json.len() as u32).to_le_bytes(), &(json.len() as u32).to_le_bytes(), b"JSON"];
        [header.concat(), json].concat()
    };
    assert!(gltf(&glb, ".").is_ok());
    let obj =
        b"mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvt 0 0\nusemtl lamp\nf 1/1/1 2/1/1 3/1/1\nf 1//1 2//1 3//1\nf -1 -2 -3\n"
            .to_vec();
    for i in 0..3000u64 {
        let mut u = Pcg::new(23).point(0, 0, i);
        let mut bytes = [&text, &glb, &obj][i as usize % 3].clone();
        for _ in 0..1 + i % 4 {
            let at = (u.next_1d() * bytes.len() as f64) as usize;
            match (u.next_1d() * 5.0) as u32 {
                0 => bytes[at] = (u.next_1d() * 256.0) as u8,
                1 => bytes[at] = b"0123456789-.,\"[]{}"[(u.next_1d() * 18.0) as usize],
                2 => bytes.truncate(at.max(1)),
                3 => bytes.insert(at, b"9-e\"]"[(u.next_1d() * 5.0) as usize]),
                _ => drop(bytes.remove(at)),
            }
            if bytes.is_empty() {
                break;
            }
        }
        let loaded = if i % 3 == 2 {
            std::fs::write(folder.join("mangled.obj"), &bytes).unwrap();
            load(folder.join("mangled.obj"))
        } else {
            gltf(&bytes, ".")
        };
        let _ = loaded.and_then(|l| l.builder.build());
    }
}
