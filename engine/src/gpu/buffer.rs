//! Buffers: uniforms and growing lists, written whole each frame.

use bytemuck::Pod;

/// A uniform block of one `T`.
#[derive(Debug)]
pub struct Uniform<T> {
    /// The buffer.
    pub buffer: wgpu::Buffer,
    kind: std::marker::PhantomData<fn() -> T>,
}

impl<T: Pod> Uniform<T> {
    /// A zeroed uniform; `extra` adds usages (e.g. STORAGE where a compute pass writes it).
    pub fn new(device: &wgpu::Device, label: &str, extra: wgpu::BufferUsages) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: (size_of::<T>().max(16)) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST | extra,
            mapped_at_creation: false,
        });
        Self { buffer, kind: std::marker::PhantomData }
    }
    /// Replaces the value.
    pub fn write(&self, queue: &wgpu::Queue, value: &T) {
        queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(value));
    }
}

/// A list of `T` that grows as needed.
#[derive(Debug)]
pub struct List<T> {
    /// The buffer; replaced when it grows, so bind it anew each frame.
    pub buffer: wgpu::Buffer,
    label: &'static str,
    usage: wgpu::BufferUsages,
    len: usize,
    kind: std::marker::PhantomData<fn() -> T>,
}

impl<T: Pod> List<T> {
    /// An empty list with room for `capacity`.
    pub fn new(device: &wgpu::Device, label: &'static str, usage: wgpu::BufferUsages, capacity: usize) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self { buffer: Self::make(device, label, usage, capacity), label, usage, len: 0, kind: std::marker::PhantomData }
    }
    fn make(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, capacity: usize) -> wgpu::Buffer {
        let size = (capacity.max(1) * size_of::<T>()).next_multiple_of(16) as u64;
        device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
    }
    /// Replaces the contents; grows the buffer if needed. True when the buffer was replaced.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, items: &[T]) -> bool {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        let grow = bytes.len() as u64 > self.buffer.size();
        if grow {
            self.buffer = Self::make(device, self.label, self.usage, items.len().next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        self.len = items.len();
        grow
    }
    /// Items written last.
    pub const fn len(&self) -> usize {
        self.len
    }
    /// True when nothing is in it.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }
}
