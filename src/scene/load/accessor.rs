//! Numbers in the buffers of a glTF file, with every bound checked: files may say anything.

use super::{read, wrong};
use crate::error::Error;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, buffer};
use std::path::Path;

/// The buffers of a document.
pub(super) struct Buffers<'a> {
    name: &'a str,
    data: Vec<Vec<u8>>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(name: &'a str, document: &gltf::Document, mut blob: Option<Vec<u8>>, folder: &Path) -> Result<Self, Error> {
        let mut data = Vec::new();
        for b in document.buffers() {
            let bytes = match b.source() {
                buffer::Source::Bin => blob.take().ok_or_else(|| wrong(name, format!("buffer {} has no data", b.index())))?,
                buffer::Source::Uri(uri) => fetch(name, uri, folder)?,
            };
            if bytes.len() < b.length() {
                let problem = format!("buffer {} says it has {} bytes, but there are {}", b.index(), b.length(), bytes.len());
                return Err(wrong(name, problem));
            }
            data.push(bytes);
        }
        Ok(Buffers { name, data })
    }

    /// The bytes of a view.
    pub(super) fn view(&self, view: &buffer::View) -> Result<&[u8], Error> {
        let buffer = &self.data[view.buffer().index()];
        let end = view.offset().checked_add(view.length()).filter(|end| *end <= buffer.len());
        let problem = || wrong(self.name, format!("buffer view {} reaches beyond its buffer of {} bytes", view.index(), buffer.len()));
        end.map(|end| &buffer[view.offset()..end]).ok_or_else(problem)
    }

    /// The elements of an accessor, byte by byte.
    fn elements(&self, a: &Accessor) -> Result<impl Iterator<Item = &[u8]>, Error> {
        let fail = |problem: &str| wrong(self.name, format!("accessor {}: {problem}", a.index()));
        if a.sparse().is_some() {
            return Err(fail("sparse accessors are not supported"));
        }
        let view = a.view().ok_or_else(|| fail("has no buffer view"))?;
        let bytes = self.view(&view)?;
        let (size, count) = (a.size(), a.count());
        let stride = view.stride().unwrap_or(size);
        let last = count.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(a.offset())).and_then(|n| n.checked_add(size));
        if stride < size || last.is_none_or(|end| end > bytes.len()) {
            return Err(fail(&format!("{count} elements of {size} bytes do not fit into a view of {} bytes", bytes.len())));
        }
        Ok((0..count).map(move |i| &bytes[a.offset() + i * stride..][..size]))
    }

    /// Vectors of N floats.
    pub(super) fn floats<const N: usize>(&self, a: &Accessor) -> Result<Vec<[f32; N]>, Error> {
        let scale = match (a.data_type(), a.normalized()) {
            (DataType::F32, _) => 1.0,
            (DataType::U8, true) => 1.0 / 255.0,
            (DataType::U16, true) => 1.0 / 65535.0,
            (kind, _) => {
                return Err(wrong(self.name, format!("accessor {}: components of type {kind:?} are not supported here", a.index())));
            }
        };
        if a.dimensions().multiplicity() != N || matches!(a.dimensions(), Dimensions::Mat2) {
            return Err(wrong(self.name, format!("accessor {}: {:?} where {N} numbers are needed", a.index(), a.dimensions())));
        }
        let width = a.data_type().size();
        let number = |bytes: &[u8]| match bytes {
            [x] => f32::from(*x),
            [x, y] => f32::from(u16::from_le_bytes([*x, *y])),
            [x, y, z, w] => f32::from_le_bytes([*x, *y, *z, *w]),
            _ => f32::NAN,
        };
        Ok(self.elements(a)?.map(|e| std::array::from_fn(|i| scale * number(&e[i * width..(i + 1) * width]))).collect())
    }

    /// Indices.
    pub(super) fn indices(&self, a: &Accessor) -> Result<Vec<u32>, Error> {
        if !matches!((a.data_type(), a.dimensions()), (DataType::U8 | DataType::U16 | DataType::U32, Dimensions::Scalar)) {
            return Err(wrong(self.name, format!("accessor {}: {:?} of {:?} are no indices", a.index(), a.dimensions(), a.data_type())));
        }
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0u32, |n, b| n << 8 | u32::from(*b));
        Ok(self.elements(a)?.map(number).collect())
    }
}

/// What a URI of a glTF file stands for: data in the text itself, or a file beside it.
pub(super) fn fetch(name: &str, uri: &str, folder: &Path) -> Result<Vec<u8>, Error> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or_else(|| wrong(name, "a data URI that is not base64"))?;
        return STANDARD.decode(text).map_err(|e| wrong(name, format!("a data URI: {e}")));
    }
    if uri.contains("://") {
        return Err(wrong(name, format!("{uri}: only files beside the scene are read")));
    }
    read(&folder.join(unescaped(uri)))
}

/// %20 is a space.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = (*first == b'%').then(|| tail.get(..2)).flatten();
        let code = code.and_then(|h| std::str::from_utf8(h).ok()).and_then(|h| u8::from_str_radix(h, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
