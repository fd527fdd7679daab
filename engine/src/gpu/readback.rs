//! Readback: textures and buffers to the CPU, waiting for them. For stills, films and tests; the live game never waits here.

use super::device::{Gpu, GpuError};

/// The bytes of a buffer (which needs COPY_SRC).
pub fn buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let staging = staging(gpu, source.size());
    let mut encoder = gpu.encoder("readback");
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
    gpu.submit(encoder);
    mapped(gpu, &staging)
}

/// The texels of level 0, layer `layer` of a texture (which needs COPY_SRC), rows tightly packed from the top.
pub fn texture(gpu: &Gpu, source: &wgpu::Texture, layer: u32) -> Result<Vec<u8>, GpuError> {
    let size = source.size();
    let texel = source.format().block_copy_size(None).unwrap_or(4);
    let row = size.width * texel;
    let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, u64::from(pitch) * u64::from(size.height));
    let mut encoder = gpu.encoder("readback");
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture: source,
            mip_level: 0,
            origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: Some(size.height) },
        },
        wgpu::Extent3d { depth_or_array_layers: 1, ..size },
    );
    gpu.submit(encoder);
    let padded = mapped(gpu, &staging)?;
    Ok(padded.chunks_exact(pitch as usize).flat_map(|r| r.iter().take(row as usize).copied()).collect())
}

/// Texels of an Rgba16Float, Rgba32Float or 8-bit RGBA texture as f32, four to a texel (8-bit ones in 0 … 1).
pub fn texture_f32(gpu: &Gpu, source: &wgpu::Texture, layer: u32) -> Result<Vec<f32>, GpuError> {
    let bytes = texture(gpu, source, layer)?;
    match source.format() {
        wgpu::TextureFormat::Rgba16Float => Ok(bytes.chunks_exact(2).map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32()).collect()),
        wgpu::TextureFormat::Rgba32Float | wgpu::TextureFormat::R32Float | wgpu::TextureFormat::Depth32Float => {
            Ok(bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
        }
        wgpu::TextureFormat::Rgba8Unorm | wgpu::TextureFormat::Rgba8UnormSrgb => Ok(bytes.iter().map(|b| f32::from(*b) / 255.0).collect()),
        other => {
            Err(GpuError::Readback(format!("texels of format {other:?} are not read back; expected Rgba16Float, Rgba32Float or Rgba8")))
        }
    }
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    })
}

fn mapped(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let (send, receive) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |r| {
        let _ = send.send(r);
    });
    gpu.wait()?;
    receive.recv().map_err(|e| GpuError::Readback(e.to_string()))?.map_err(|e| GpuError::Readback(e.to_string()))?;
    let bytes = staging.get_mapped_range(..).map_err(|e| GpuError::Readback(e.to_string()))?.to_vec();
    staging.unmap();
    Ok(bytes)
}
