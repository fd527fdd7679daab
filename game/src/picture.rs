//! Pictures on disk: PNG as seen, EXR as scene-linear radiance. Film strips, too.
//!
//! Not here: where the pixels come from (`engine::render`).

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a picture was not written.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The name ends in neither `.png` nor `.exr`.
    #[error("{0}: a picture ends in .png (as seen) or .exr (scene-linear radiance, cd/m²)")]
    Ending(PathBuf),
    /// The number of pixels is not width × height.
    #[error("{path}: {got} values for a picture of {width}×{height}")]
    Shape {
        /// The file.
        path: PathBuf,
        /// Width, pixels.
        width: u32,
        /// Height, pixels.
        height: u32,
        /// Values that were given.
        got: usize,
    },
    /// The file cannot be written.
    #[error("{path}: cannot be written: {source}; is the folder there, and yours to write?")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 8-bit sRGB, as seen.
    Png,
    /// 32-bit float, scene-linear, before exposure.
    Exr,
}

impl Kind {
    /// By the ending of a file's name.
    pub fn of(path: &Path) -> Result<Self, PictureError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(PictureError::Ending(path.to_owned())),
        }
    }
}

/// Writes 8-bit sRGB pixels, RGBA, rows from the top.
pub fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), PictureError> {
    if rgba.len() != width as usize * height as usize * 4 {
        return Err(PictureError::Shape { path: path.to_owned(), width, height, got: rgba.len() });
    }
    let failed = |source: io::Error| PictureError::Write { path: path.to_owned(), source };
    let file = File::create(path).map_err(failed)?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let mut writer = encoder.write_header().map_err(|e| failed(e.into()))?;
    writer.write_image_data(&rgb).and_then(|()| writer.finish()).map_err(|e| failed(e.into()))
}

/// Writes scene-linear pixels, RGBA with alpha left out, rows from the top.
pub fn write_exr(path: &Path, width: u32, height: u32, rgba: &[f32]) -> Result<(), PictureError> {
    if rgba.len() != width as usize * height as usize * 4 {
        return Err(PictureError::Shape { path: path.to_owned(), width, height, got: rgba.len() });
    }
    let at = |x: usize, y: usize| {
        let i = (y * width as usize + x) * 4;
        (rgba[i], rgba[i + 1], rgba[i + 2])
    };
    exr::prelude::write_rgb_file(path, width as usize, height as usize, at)
        .map_err(|e| PictureError::Write { path: path.to_owned(), source: io::Error::other(e.to_string()) })
}

/// Puts frames of one size under each other, two pixels of black between, as one picture of the same width.
pub fn film_strip(width: u32, height: u32, frames: &[Vec<u8>]) -> (u32, u32, Vec<u8>) {
    const GAP: usize = 2;
    let row = width as usize * 4;
    let mut strip = Vec::with_capacity(frames.len() * (height as usize + GAP) * row);
    for (index, frame) in frames.iter().enumerate() {
        if index > 0 {
            strip.extend(std::iter::repeat_n([0, 0, 0, 255], GAP * width as usize).flatten());
        }
        strip.extend_from_slice(frame);
    }
    let rows = strip.len() / row.max(1);
    (width, u32::try_from(rows).unwrap_or(u32::MAX), strip)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_choose_the_kind_and_others_are_refused() {
        assert_eq!(Kind::of(Path::new("a/b.PNG")).ok(), Some(Kind::Png));
        assert_eq!(Kind::of(Path::new("b.exr")).ok(), Some(Kind::Exr));
        let message = Kind::of(Path::new("b.jpg")).unwrap_err().to_string();
        assert!(message.contains("b.jpg") && message.contains(".png") && message.contains(".exr"));
    }

    #[test]
    fn png_and_exr_keep_their_pixels() {
        let dir = tempfile::tempdir().unwrap();
        let png_path = dir.path().join("p.png");
        write_png(&png_path, 2, 1, &[1, 2, 3, 255, 250, 251, 252, 255]).unwrap();
        let mut reader = png::Decoder::new(io::BufReader::new(File::open(&png_path).unwrap())).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(&pixels[..6], &[1, 2, 3, 250, 251, 252]);

        let exr_path = dir.path().join("p.exr");
        write_exr(&exr_path, 1, 2, &[1.0e-3, 2.0, 3.0e9, 1.0, 0.0, 0.5, 0.25, 1.0]).unwrap();
        let image = exr::prelude::read_first_rgba_layer_from_file(
            &exr_path,
            |size, _| vec![[0.0f32; 3]; size.0 * size.1],
            |rows, at, (r, g, b, _): (f32, f32, f32, f32)| rows[at.1] = [r, g, b],
        )
        .unwrap();
        assert_eq!(image.layer_data.channel_data.pixels, vec![[1.0e-3, 2.0, 3.0e9], [0.0, 0.5, 0.25]]);
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let message = write_png(Path::new("/no/such/folder/p.png"), 1, 1, &[0; 4]).unwrap_err().to_string();
        assert!(message.contains("/no/such/folder/p.png"));
    }

    #[test]
    fn a_film_strip_stacks_its_frames() {
        let (w, h, strip) = film_strip(2, 3, &[vec![9; 24], vec![7; 24]]);
        assert_eq!((w, h, strip.len()), (2, 8, 64));
    }
}
