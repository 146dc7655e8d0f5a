//! Films, images, cameras.

use fredholm::scene::{Camera, Environment, Filter, Material, Scene, Sides, shapes};
use fredholm::statistics::Verdict;
use fredholm::{Error, Spectrum, Walk};

/// A sky that is black on the left and white on the right of −z.
fn two_sided_sky() -> Scene {
    let mut scene = Scene::builder();
    scene.environment(Environment::map(2, 1, vec![[0.0; 3], [1.0; 3]]).unwrap());
    scene.build().unwrap()
}

#[test]
fn pixels_lie_where_the_camera_looks() {
    let scene = two_sided_sky();
    let film = scene.film(Camera::towards([0.0; 3], [0.0, 0.0, -1.0]), 4, 2);
    let walk = Walk::collision().samples_per_cell(16);
    let image = scene.light_transport().seen_by(&film).solve(&walk).unwrap();
    for y in 0..2 {
        for x in 0..4 {
            assert_eq!(image[(x, y)].value, Spectrum([f64::from(u8::from(x >= 2)); 3]), "{x} {y}");
        }
    }
    assert_eq!((image.width(), image.height()), (4, 2));
}

/// At an edge through the middle of a pixel every filter sees half of each side; beside it each as much as its tail.
#[test]
fn filters_blur_edges_as_much_as_they_say() {
    let scene = two_sided_sky();
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, -1.0]).field_of_view(1.0);
    // one pixel beside the edge: the share of the filter beyond ½ of a pixel
    for (filter, beyond) in [(Filter::Box, 0.0), (Filter::Tent(1.0), 0.125), (Filter::Gaussian(0.5), 0.158_655_254)] {
        let film = scene.film(camera, 2, 1).filter(filter);
        let image = scene.light_transport().seen_by(&film).solve(&Walk::collision().samples_per_cell(40_000)).unwrap();
        // where nothing is seen there is no error to agree within
        let dark = beyond == 0.0 && image[(0, 0)].value == Spectrum([0.0; 3]);
        assert!(dark || image[(0, 0)].agrees_with(Spectrum([beyond; 3]), 5.0), "{filter:?} {}", image[(0, 0)]);
        assert!(image[(1, 0)].agrees_with(Spectrum([1.0 - beyond; 3]), 5.0), "{filter:?} {}", image[(1, 0)]);
    }
}

/// What is in focus stays where it is; what is not is blurred over the lens.
#[test]
fn a_lens_blurs_what_is_out_of_focus() {
    let mut scene = Scene::builder();
    let lamp = scene.material(Material::diffuse([0.0; 3]).emitting([1.0; 3]));
    scene.mesh(shapes::parallelogram([0.0, -9.0, -10.0], [9.0, 0.0, 0.0], [0.0, 18.0, 0.0]).unwrap(), lamp).unwrap();
    let scene = scene.build().unwrap();
    let pinhole = Camera::towards([0.0; 3], [0.0, 0.0, -1.0]).field_of_view(20.0);
    let seen = |camera: Camera| {
        let film = scene.film(camera, 2, 1);
        scene.light_transport().seen_by(&film).solve(&Walk::collision().samples_per_cell(4000)).unwrap()[(0, 0)].value[0]
    };
    assert_eq!((seen(pinhole), seen(pinhole.lens(1.0, 10.0))), (0.0, 0.0));
    assert!(seen(pinhole.lens(1.0, 5.0)) > 0.05);
}

#[test]
fn images_are_written_and_read() {
    let scene = two_sided_sky();
    let film = scene.film(Camera::towards([0.0; 3], [0.0, 0.0, -1.0]), 8, 4);
    let image = scene.light_transport().seen_by(&film).solve(&Walk::collision().samples_per_cell(4)).unwrap();
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    assert_eq!(image.write_png(folder.join("sky.png")).unwrap(), 0);
    assert_eq!(image.map(|p| Spectrum(p.value.0.map(|v| 2.0 * v))).write_png(folder.join("sky2.png")).unwrap(), 16);
    image.write_exr(folder.join("sky.exr")).unwrap();
    // the file is an environment again, white on the right
    let sky = Environment::read_exr(folder.join("sky.exr")).unwrap();
    assert_eq!(sky.radiance([0.9, 0.0, -0.1]), Spectrum([1.0; 3]));
    assert_eq!(sky.radiance([-0.9, 0.0, -0.1]), Spectrum([0.0; 3]));
    // two pixels of shared exponents: 1 and 8 times (½, ¼, 0)
    let mut radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".to_vec();
    radiance.extend([128, 64, 0, 128, 128, 64, 0, 131]);
    std::fs::write(folder.join("sky.hdr"), radiance).unwrap();
    let sky = Environment::read_hdr(folder.join("sky.hdr")).unwrap();
    assert_eq!([-0.9, 0.9].map(|x| sky.radiance([x, 0.0, -0.1])), [Spectrum([0.5, 0.25, 0.0]), Spectrum([4.0, 2.0, 0.0])]);
    std::fs::write(folder.join("bad.hdr"), b"#?RADIANCE\n\n-Y 1000000 +X 1000000\n").unwrap();
    assert!(matches!(Environment::read_hdr(folder.join("bad.hdr")), Err(Error::Io { .. })));
    assert!(matches!(image.write_png("/dev/null/x.png"), Err(Error::Io { .. })));
    assert!(matches!(Environment::read_exr("/dev/null/x.exr"), Err(Error::Io { .. })));
}

/// Rounds begin with 16 walks a pixel, and end with the bits of one run.
#[test]
fn images_come_in_rounds() {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    let scene = scene.build().unwrap();
    let film = scene.film(Camera::look_at([0.0; 3], [1.0, 0.2, 0.3]), 40, 30);
    let (equation, walk) = (scene.light_transport(), Walk::mis().samples_per_cell(40));
    let query = equation.seen_by(&film);
    let rounds: Vec<_> = query.rounds(&walk).unwrap().map(Result::unwrap).collect();
    assert_eq!(rounds.iter().map(|r| r.samples).collect::<Vec<_>>(), [16, 32, 40]);
    let whole = query.solve(&walk).unwrap();
    assert!(rounds[2].estimates.pixels().iter().zip(whole.pixels()).all(|(a, b)| a.moments == b.moments));
    assert!(rounds[0].estimates.relative_error() > rounds[2].estimates.relative_error());
    // interrupted after the first, and another day
    let mut first = query.rounds(&walk).unwrap();
    first.next().unwrap().unwrap();
    let resumed = query.rounds(&walk).unwrap().resume(first.checkpoint()).unwrap().last().unwrap().unwrap().estimates;
    assert!(resumed.pixels().iter().zip(whole.pixels()).all(|(a, b)| a.moments == b.moments));
    // or ended as soon as the error is small enough
    let wanted = rounds[1].estimates.relative_error().unwrap();
    let enough = query.rounds(&walk).unwrap().map(Result::unwrap).find(|r| r.estimates.relative_error().unwrap() <= wanted).unwrap();
    assert_eq!(enough.samples, 32);
}

/// The errors are in the file, pixel by pixel.
#[test]
fn exr_files_hold_errors() {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let scene = two_sided_sky();
    let film = scene.film(Camera::towards([0.0; 3], [0.1, 0.0, -1.0]), 2, 1);
    let image = scene.light_transport().seen_by(&film).solve(&Walk::collision().samples_per_cell(64)).unwrap();
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("errors.exr");
    image.write_exr(&file).unwrap();
    let layer = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let channels = layer.from_file(&file).unwrap().layer_data.channel_data.list;
    let number = |name: &str, at: usize| {
        let channel = channels.iter().find(|c| c.name.to_string() == name).unwrap_or_else(|| panic!("no channel {name}"));
        channel.sample_data.values_as_f32().nth(at).unwrap()
    };
    let dark = &image[(0, 0)];
    assert!(dark.value[0] > 0.0 && dark.value[0] < 1.0);
    assert_eq!((number("R", 0), number("error.R", 0)), (dark.value[0] as f32, dark.std_error.unwrap()[0] as f32));
    assert_eq!((number("B", 1), number("error.B", 1)), (1.0, 0.0));
}

/// A pinhole on a wall, in a corner, on a lamp, in the middle of a solid: it sees what is there, and nothing is lost to its own surface.
#[test]
fn cameras_may_stand_anywhere() {
    let mut scene = Scene::builder();
    let wall = scene.material(Material::diffuse([0.5; 3]).emitting([1.0; 3]));
    // gives back what it gets, and is black inside
    let solid = scene.material(Material::diffuse([1.0; 3]).sides(Sides::Front));
    scene.mesh(shapes::room([-1.0; 3], [1.0; 3]).unwrap(), wall).unwrap();
    scene.mesh(shapes::cuboid([0.5; 3], [0.9; 3]).unwrap(), solid).unwrap();
    let scene = scene.build().unwrap();
    let seen = |eye: [f64; 3]| {
        let film = scene.film(Camera::look_at(eye, [0.1, -0.2, 0.05]).field_of_view(20.0), 1, 1);
        scene.light_transport().seen_by(&film).solve(&Walk::collision().samples_per_cell(1 << 10)).unwrap()[(0, 0)].clone()
    };
    for eye in [[-1.0, 0.0, 0.0], [-1.0; 3], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]] {
        let pixel = seen(eye);
        assert!(pixel.agrees_with(Spectrum([2.0; 3]), 5.0), "{eye:?}: {pixel}");
    }
    let inside = seen([0.7; 3]);
    assert_eq!((inside.value, inside.verdict()), (Spectrum([0.0; 3]), Verdict::NothingScored));
}

#[test]
fn absurd_films_are_refused() {
    let scene = two_sided_sky();
    let camera = Camera::towards([0.0; 3], [0.0, 0.0, -1.0]);
    let parameter = |camera: Camera, width: usize, height: usize, filter: Filter| {
        let film = scene.film(camera, width, height).filter(filter);
        match scene.light_transport().seen_by(&film).solve(&Walk::collision()) {
            Err(Error::Invalid { parameter, .. }) => parameter,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(parameter(camera, 0, 4, Filter::Box), "image width");
    assert_eq!(parameter(camera, 4, 0, Filter::Box), "image height");
    assert_eq!(parameter(camera, usize::MAX, usize::MAX, Filter::Box), "number of pixels");
    assert_eq!(parameter(camera, 4, 4, Filter::Tent(0.0)), "width of the filter");
    assert_eq!(parameter(camera.field_of_view(180.0), 4, 4, Filter::Box), "field of view");
    assert_eq!(parameter(camera.up([0.0, 0.0, 2.0]), 4, 4, Filter::Box), "sine between the camera's direction and up");
    assert_eq!(parameter(Camera::towards([f64::NAN; 3], [1.0, 0.0, 0.0]), 4, 4, Filter::Box), "coordinate of the camera");
    assert_eq!(parameter(camera.lens(-1.0, 1.0), 4, 4, Filter::Box), "lens radius");
    assert_eq!(parameter(camera.lens(1.0, 0.0), 4, 4, Filter::Box), "focus distance");
}
