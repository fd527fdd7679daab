//! Timer: how long each pass took on the GPU, by timestamps where the device has them.
//!
//! A frame's times arrive a frame or two later; [`Timer::settle`] waits for them, [`Timer::poll`] does not.

use super::device::{Gpu, GpuError};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Spans that one frame may measure.
const MAX_SPANS: u32 = 48;

/// Measures named spans of one frame.
pub struct Timer {
    gpu: Option<Parts>,
    names: Vec<&'static str>,
    waiting: Option<(Receiver<bool>, Vec<&'static str>)>,
    latest: Vec<(&'static str, f64)>,
}

struct Parts {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    period_ns: f32,
}

impl Timer {
    /// A timer; it measures nothing where the device has no timestamps.
    pub fn new(gpu: &Gpu) -> Self {
        let size = u64::from(MAX_SPANS) * 16;
        let buffer =
            |label, usage| gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false });
        let parts = gpu.features.contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Parts {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timer"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_SPANS,
            }),
            resolved: buffer("timer resolved", wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            staging: buffer("timer staging", wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            period_ns: gpu.queue.get_timestamp_period(),
        });
        Self { gpu: parts, names: Vec::new(), waiting: None, latest: Vec::new() }
    }

    /// Forgets the spans of the frame before.
    pub fn begin_frame(&mut self) {
        self.names.clear();
    }

    fn span(&mut self, name: &'static str) -> Option<(&wgpu::QuerySet, u32)> {
        let parts = self.gpu.as_ref()?;
        // While the last frame's figures are under way the staging buffer is not ours.
        let index = u32::try_from(self.names.len()).ok().filter(|i| *i < MAX_SPANS && self.waiting.is_none())?;
        self.names.push(name);
        Some((&parts.queries, 2 * index))
    }

    /// Timestamps for a render pass.
    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.span(name).map(|(query_set, i)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(i),
            end_of_pass_write_index: Some(i + 1),
        })
    }

    /// Timestamps for a compute pass.
    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.span(name).map(|(query_set, i)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(i),
            end_of_pass_write_index: Some(i + 1),
        })
    }

    /// Records the copy of this frame's figures; call before the encoder is finished.
    pub fn end_frame(&self, encoder: &mut wgpu::CommandEncoder) {
        let Some(parts) = self.gpu.as_ref().filter(|_| !self.names.is_empty() && self.waiting.is_none()) else { return };
        let count = u32::try_from(self.names.len()).unwrap_or(0) * 2;
        encoder.resolve_query_set(&parts.queries, 0..count, &parts.resolved, 0);
        encoder.copy_buffer_to_buffer(&parts.resolved, 0, &parts.staging, 0, u64::from(count) * 8);
    }

    /// Asks for this frame's figures; call after the submit.
    pub fn after_submit(&mut self) {
        let Some(parts) = self.gpu.as_ref().filter(|_| !self.names.is_empty() && self.waiting.is_none()) else { return };
        let (send, receive) = channel();
        parts.staging.map_async(wgpu::MapMode::Read, .., move |r| {
            let _ = send.send(r.is_ok());
        });
        self.waiting = Some((receive, self.names.clone()));
    }

    /// Takes figures that have arrived.
    pub fn poll(&mut self, gpu: &Gpu) {
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        let Some((receive, names)) = self.waiting.take() else { return };
        match receive.try_recv() {
            Ok(true) => self.read(&names),
            Ok(false) | Err(TryRecvError::Disconnected) => {}
            Err(TryRecvError::Empty) => self.waiting = Some((receive, names)),
        }
    }

    /// Waits for the figures of the last frame.
    pub fn settle(&mut self, gpu: &Gpu) -> Result<(), GpuError> {
        if self.waiting.is_some() {
            gpu.wait()?;
            self.poll(gpu);
        }
        Ok(())
    }

    fn read(&mut self, names: &[&'static str]) {
        let Some(parts) = &self.gpu else { return };
        if let Ok(bytes) = parts.staging.get_mapped_range(..) {
            let ticks: Vec<u64> =
                bytes.chunks_exact(8).map(|b| u64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]])).collect();
            let ms = |i: usize| ticks[2 * i + 1].saturating_sub(ticks[2 * i]) as f64 * f64::from(parts.period_ns) * 1e-6;
            self.latest = names.iter().enumerate().map(|(i, n)| (*n, ms(i))).collect();
        }
        parts.staging.unmap();
    }

    /// Milliseconds of all spans with a name in the newest known frame; `None` where none was measured.
    pub fn ms(&self, name: &str) -> Option<f64> {
        self.latest.iter().filter(|(n, _)| *n == name).map(|(_, ms)| *ms).reduce(|a, b| a + b)
    }
}
