//! PNG and JPEG images.

use crate::error::Error;
use crate::scene::{Rgb, Texture};
use crate::value::Value;
use std::io::Cursor;

/// What the numbers of an image mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Encoding {
    Srgb,
    Linear,
}

/// Eight bits a channel, alpha last.
pub(super) struct Picture {
    width: usize,
    height: usize,
    texels: Vec<[u8; 4]>,
}

/// Images beyond this many texels are refused.
const MOST: usize = 1 << 26;

impl Picture {
    pub(super) fn decode(bytes: &[u8]) -> Result<Self, String> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => png(bytes),
            [0xff, 0xd8, ..] => jpeg(bytes),
            _ => Err("neither PNG nor JPEG".into()),
        }
    }

    pub(super) fn texture(&self, encoding: Encoding) -> Result<Texture, Error> {
        let table: [f64; 256] = std::array::from_fn(|i| match encoding {
            Encoding::Srgb => linear(i as f64 / 255.0),
            Encoding::Linear => i as f64 / 255.0,
        });
        let colour = |t: &[u8; 4]| Rgb::from_components(|i| table[usize::from(t[i])]);
        Texture::new(self.width, self.height, self.texels.iter().map(colour).collect())
    }

    /// How opaque it is, in all components.
    pub(super) fn alpha(&self) -> Result<Texture, Error> {
        let alpha = |t: &[u8; 4]| Rgb::from_components(|_| f64::from(t[3]) / 255.0);
        Texture::new(self.width, self.height, self.texels.iter().map(alpha).collect())
    }
}

/// IEC 61966-2-1.
fn linear(x: f64) -> f64 {
    if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn limited(width: usize, height: usize) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(n) if n > 0 && n <= MOST => Ok(()),
        _ => Err(format!("{width} × {height} texels; between 1 and 2^26 are read")),
    }
}

fn png(bytes: &[u8]) -> Result<Picture, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    limited(width, height)?;
    let mut data = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let info = reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    let channels = info.color_type.samples();
    let texel = |t: &[u8]| match *t {
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, 255],
        [r, g, b, alpha] => [r, g, b, alpha],
        _ => [t[0], t[0], t[0], 255],
    };
    Ok(Picture { width, height, texels: data[..info.buffer_size()].chunks_exact(channels).map(texel).collect() })
}

fn jpeg(bytes: &[u8]) -> Result<Picture, String> {
    use zune_jpeg::zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions};
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("no size")?;
    limited(width, height)?;
    let data = decoder.decode().map_err(|e| e.to_string())?;
    Ok(Picture { width, height, texels: data.as_chunks::<3>().0.iter().map(|[r, g, b]| [*r, *g, *b, 255]).collect() })
}
