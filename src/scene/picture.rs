//! Images as files: PNG for the eye, EXR for what was computed; environments from EXR and HDR.

use super::{Environment, Image, Rgb};
use crate::error::Error;
use crate::output::replace;
use crate::statistics::Estimate;
use crate::value::Value;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as Exr, Layer, LayerAttributes, ReadChannels, ReadLayers, SmallVec,
    WritableImage, read,
};
use std::path::Path;

impl Image<Estimate<Rgb>> {
    /// Writes the [`values`](Self::values) as [`Image::<Rgb>::write_png`](Image#method.write_png-1) does.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<usize, Error> {
        self.values().write_png(path)
    }

    /// Linear values in channels R, G, B, their standard errors, where they are known, in error.R, error.G, error.B; 32-bit floats.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let mut channels = channels("", &self.values());
        if let Some(errors) = self.errors() {
            channels.extend(self::channels("error.", &errors));
        }
        write_channels(path.as_ref(), (self.width(), self.height()), channels)
    }
}

impl Image<Rgb> {
    /// sRGB in eight bits. Returns how many pixels lie outside [0, 1], where the file holds the nearest colour.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<usize, Error> {
        let (path, mut file) = (path.as_ref(), Vec::new());
        let mut encoder = png::Encoder::new(&mut file, self.width() as u32, self.height() as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
        let bytes: Vec<u8> = self.pixels().iter().flat_map(|p| p.0.map(srgb)).collect();
        encoder.write_header().and_then(|mut w| w.write_image_data(&bytes)).map_err(|e| io(path, &e))?;
        replace(path, &file)?;
        Ok(self.pixels().iter().filter(|p| (0..3).any(|i| !(0.0..=1.0).contains(&p.component(i)))).count())
    }

    /// Linear values in channels R, G, B of 32-bit floats.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        write_channels(path.as_ref(), (self.width(), self.height()), channels("", self))
    }
}

impl Environment {
    /// An equirectangular EXR file with channels R, G, B; see [`Environment::map`].
    ///
    /// # Errors
    /// [`Error::Io`] for files that cannot be read, and what [`Environment::map`] refuses.
    pub fn read_exr(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let pixels = |size: exr::math::Vec2<usize>, _: &_| (size.width(), vec![[0.0f32; 3]; size.area()]);
        let set = |image: &mut (usize, Vec<[f32; 3]>), at: exr::math::Vec2<usize>, (r, g, b): (f32, f32, f32)| {
            image.1[at.y() * image.0 + at.x()] = [r, g, b];
        };
        let reader = read().no_deep_data().largest_resolution_level().rgb_channels(pixels, set).first_valid_layer().all_attributes();
        let image = reader.from_file(path).map_err(|e| io(path, &e))?;
        let layer = image.layer_data;
        Environment::map(layer.size.width(), layer.size.height(), layer.channel_data.pixels.1)
    }

    /// An equirectangular Radiance file (`.hdr`); see [`Environment::map`].
    ///
    /// # Errors
    /// As [`read_exr`](Self::read_exr).
    pub fn read_hdr(path: impl AsRef<Path>) -> Result<Self, Error> {
        use zune_hdr::zune_core::bytestream::ZCursor;
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|e| io(path, &e))?;
        let mut decoder = zune_hdr::HdrDecoder::new(ZCursor::new(bytes));
        let numbers = decoder.decode().map_err(|e| io(path, &format!("{e:?}")))?;
        let (width, height) = decoder.dimensions().ok_or_else(|| io(path, &"no size"))?;
        Environment::map(width, height, numbers.as_chunks::<3>().0.to_vec())
    }
}

fn io(path: &Path, problem: &dyn std::fmt::Display) -> Error {
    Error::Io { path: path.display().to_string(), message: problem.to_string() }
}

type Channels = SmallVec<[AnyChannel<FlatSamples>; 4]>;

fn channels(prefix: &str, image: &Image<Rgb>) -> Channels {
    let one = |(i, name)| {
        let samples = image.pixels().iter().map(|p| p[i] as f32).collect();
        AnyChannel::new(format!("{prefix}{name}").as_str(), FlatSamples::F32(samples))
    };
    ["R", "G", "B"].into_iter().enumerate().map(one).collect()
}

fn write_channels(path: &Path, size: (usize, usize), channels: Channels) -> Result<(), Error> {
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut file = std::io::Cursor::new(Vec::new());
    Exr::from_layer(layer).write().to_buffered(&mut file).map_err(|e| io(path, &e))?;
    replace(path, file.get_ref())
}

/// IEC 61966-2-1 in eight bits.
fn srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}
