//! Further orders of scattering of one air: gathered, turned, order by order, and summed into its part of the table.
//!
//! The method is told in [`crate::air::model::orders`], which makes the plan; the shaders are `shaders/pass/air_orders.wgsl` and
//! `air_orders_sum.wgsl`; how the table is asked, `shaders/lib/air_orders.wgsl`.

use crate::air::model::orders::{ALTITUDES, DIRECTIONS, MAX_ORDERS, Plan, SUNS, VIEWS};
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{
    compute_pipeline, compute_pipeline_with, loaded_entry, sampler_entry, stored_texture_entry, texture_entry, uniform_entry,
};
use crate::render::targets::HDR;
use crate::scene::gpu_data::MAX_AIRS;
use wgpu::util::DeviceExt as _;
use wgpu::{BindGroupEntry, BindingResource, BufferUsages, TextureUsages, TextureViewDimension};

/// Texels of the whole table.
#[allow(clippy::cast_possible_truncation)]
const SIZE: wgpu::Extent3d =
    wgpu::Extent3d { width: 3 * SUNS as u32, height: (MAX_AIRS * ALTITUDES) as u32, depth_or_array_layers: VIEWS as u32 };
/// Texels of the irradiance table of one air.
#[allow(clippy::cast_possible_truncation)]
pub const IRRADIANCE_SIZE: [u32; 2] = [SUNS as u32, ALTITUDES as u32];
/// Azimuths of half a circle: cosine and weight. Denser towards the sun, where hazes glow: π x^1.4 of the middles x of eight even parts; the
/// weights make sums of cos mφ exact to m = 6, so for the product of any two modes. For air with peaks sixteen: π x^1.6, exact to m = 10.
const AZIMUTHS: [&[[f32; 2]]; 2] = [
    &[
        [0.9979031, 0.0546360],
        [0.9548789, 0.0871416],
        [0.8159015, 0.1110116],
        [0.5508123, 0.1258185],
        [0.1661697, 0.1384601],
        [-0.284_445, 0.1513303],
        [-0.7020766, 0.1603134],
        [-0.9633941, 0.1712886],
    ],
    &[
        [0.9999247, 0.0122240],
        [0.9974684, 0.0236741],
        [0.9870415, 0.0323824],
        [0.9621259, 0.0400605],
        [0.916_017, 0.0469294],
        [0.8424219, 0.0528056],
        [0.7361755, 0.0580781],
        [0.594_088, 0.0634615],
        [0.4158671, 0.0685568],
        [0.2050141, 0.0730118],
        [-0.0304550, 0.0777095],
        [-0.2776493, 0.0820819],
        [-0.5190016, 0.0860973],
        [-0.7332069, 0.0905057],
        [-0.8970209, 0.0940060],
        [-0.9879186, 0.0984154],
    ],
];
/// Bytes of three vectors per sun.
const SUN_ROWS: u64 = (SUNS * 3 * 16) as u64;

/// `Order` of the shader.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct OrderUniform {
    numbers: [u32; 4],
    azimuths: [[f32; 4]; 16],
}

/// Pipelines, the table, and the room to work in.
pub struct OrdersBaker {
    layout: wgpu::BindGroupLayout,
    sum_layout: wgpu::BindGroupLayout,
    /// `first` and `next`, over azimuths as most airs need them and as those with peaks do.
    gather: [[wgpu::ComputePipeline; 2]; 2],
    turn: wgpu::ComputePipeline,
    products: wgpu::ComputePipeline,
    sum: wgpu::ComputePipeline,
    gathered: wgpu::Buffer,
    sources: wgpu::Buffer,
    drawn: wgpu::Buffer,
    irradiance: wgpu::Buffer,
    scalars: wgpu::Buffer,
    table: wgpu::Texture,
}

/// What else the bake of one air needs.
pub struct Inputs<'a> {
    /// `Air`.
    pub air: wgpu::BufferBinding<'a>,
    /// Its two transmittances, as an array.
    pub transmittance: &'a wgpu::TextureView,
    /// Its table of the medium, as an array of one layer.
    pub media: &'a wgpu::TextureView,
    /// Bilinear, clamped.
    pub linear: &'a wgpu::Sampler,
    /// All airs' irradiance, a storage array.
    pub irradiance: &'a wgpu::TextureView,
    /// Its slot.
    pub slot: u32,
}

impl OrdersBaker {
    /// Compiles the passes and makes room for all airs.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary) -> Result<Self, RenderError> {
        let storage = |binding, read_only| buffer_entry(binding, wgpu::BufferBindingType::Storage { read_only });
        let written = |binding, view_dimension| stored_texture_entry(binding, HDR, view_dimension);
        let layout =
            |entries: &[_]| gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("air orders"), entries });
        let each = layout(&[
            uniform_entry(0),
            texture_entry(1, TextureViewDimension::D2Array),
            sampler_entry(2, wgpu::SamplerBindingType::Filtering),
            uniform_entry(3),
            storage(4, true),
            storage(5, false),
            storage(6, false),
            storage(7, false),
            storage(8, false),
            loaded_entry(9, TextureViewDimension::D2Array),
        ]);
        let all = layout(&[
            uniform_entry(3),
            storage(4, true),
            storage(5, true),
            storage(6, false),
            written(7, TextureViewDimension::D3),
            written(8, TextureViewDimension::D2Array),
            storage(9, true),
            storage(10, true),
        ]);
        let module = shaders.load(&gpu.device, "pass/air_orders.wgsl")?;
        let sum_module = shaders.load(&gpu.device, "pass/air_orders_sum.wgsl")?;
        let room = |label, size| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        };
        let (altitudes, orders) = (ALTITUDES as u64, u64::from(MAX_ORDERS));
        Ok(Self {
            gather: AZIMUTHS.map(|azimuths| {
                let constants = [("AZIMUTHS", azimuths.len() as f64)];
                ["first", "next"].map(|entry| compute_pipeline_with(gpu, "air_orders", &module, &[&each], entry, &constants))
            }),
            turn: compute_pipeline(gpu, "air_orders", &module, &[&each], "turn"),
            products: compute_pipeline(gpu, "air_orders_sum", &sum_module, &[&all], "products"),
            sum: compute_pipeline(gpu, "air_orders_sum", &sum_module, &[&all], "sum"),
            layout: each,
            sum_layout: all,
            gathered: room("air orders: gathered", altitudes * DIRECTIONS as u64 * SUN_ROWS),
            sources: room("air orders: sources", orders * altitudes * VIEWS as u64 * SUN_ROWS),
            drawn: room("air orders: drawn", orders * altitudes * VIEWS as u64 * SUN_ROWS),
            irradiance: room("air orders: irradiance", (orders + 1) * altitudes * SUNS as u64 * 16),
            scalars: room("air orders: products", orders * orders * 16),
            table: gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("air orders"),
                size: SIZE,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: HDR,
                usage: TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING,
                view_formats: &[],
            }),
        })
    }

    /// The irradiance tables of all airs, which this pass writes too.
    pub fn irradiance_tables(gpu: &Gpu) -> Texture {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
        let [w, h] = IRRADIANCE_SIZE;
        #[allow(clippy::cast_possible_truncation)]
        Texture::with(&gpu.device, "air irradiance", [w, h, MAX_AIRS as u32], 1, HDR, usage)
    }

    /// The table.
    pub fn view(&self) -> wgpu::TextureView {
        self.table.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Computes the orders of one air by its plan. Work on several airs may follow in one pass.
    #[allow(clippy::cast_possible_truncation)]
    pub fn bake(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, plan: &Plan, inputs: &Inputs<'_>) {
        let buffer = |contents: &[u8], usage| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("air orders"), contents, usage })
        };
        let orders = if plan.orders > 0 { plan.orders.clamp(2, MAX_ORDERS) } else { 0 };
        let deep = plan.deep.unwrap_or(0);
        let [first, next] = &self.gather[usize::from(plan.peaked)];
        let azimuths = AZIMUTHS[usize::from(plan.peaked)];
        let is_deep = u32::from(plan.deep.is_some());
        let plan = buffer(bytemuck::cast_slice(&plan.rows), BufferUsages::STORAGE);
        let (directions, views, altitudes) = (DIRECTIONS as u32, VIEWS as u32, ALTITUDES as u32);
        for order in 0..orders {
            let mut numbers = OrderUniform { numbers: [order, orders, inputs.slot, 0], azimuths: [[0.0; 4]; 16] };
            numbers.azimuths.iter_mut().zip(azimuths).for_each(|(to, [cosine, weight])| *to = [*cosine, *weight, 0.0, 0.0]);
            let number = buffer(bytemuck::bytes_of(&numbers), BufferUsages::UNIFORM);
            let group = bind(
                gpu,
                &self.layout,
                [
                    (0, BindingResource::Buffer(inputs.air.clone())),
                    (1, BindingResource::TextureView(inputs.transmittance)),
                    (2, BindingResource::Sampler(inputs.linear)),
                    (3, number.as_entire_binding()),
                    (4, plan.as_entire_binding()),
                    (5, self.gathered.as_entire_binding()),
                    (6, self.sources.as_entire_binding()),
                    (7, self.irradiance.as_entire_binding()),
                    (8, self.drawn.as_entire_binding()),
                    (9, BindingResource::TextureView(inputs.media)),
                ],
            );
            pass.set_bind_group(0, &group, &[]);
            pass.set_pipeline(if order == 0 { first } else { next });
            pass.dispatch_workgroups(directions, altitudes, 1);
            pass.set_pipeline(&self.turn);
            pass.dispatch_workgroups(views, altitudes, 1);
        }
        let number = buffer(bytemuck::bytes_of(&[deep, orders, inputs.slot, is_deep]), BufferUsages::UNIFORM);
        let group = bind(
            gpu,
            &self.sum_layout,
            [
                (3, number.as_entire_binding()),
                (4, self.sources.as_entire_binding()),
                (5, self.irradiance.as_entire_binding()),
                (6, self.scalars.as_entire_binding()),
                (7, BindingResource::TextureView(&self.view())),
                (8, BindingResource::TextureView(inputs.irradiance)),
                (9, self.drawn.as_entire_binding()),
                (10, plan.as_entire_binding()),
            ],
        );
        pass.set_bind_group(0, &group, &[]);
        if orders > 0 {
            pass.set_pipeline(&self.products);
            pass.dispatch_workgroups(orders - 1, orders, 1);
        }
        pass.set_pipeline(&self.sum);
        pass.dispatch_workgroups(views, altitudes, 1);
    }
}

const fn buffer_entry(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

fn bind<const N: usize>(gpu: &Gpu, layout: &wgpu::BindGroupLayout, resources: [(u32, BindingResource<'_>); N]) -> wgpu::BindGroup {
    let entries = resources.map(|(binding, resource)| BindGroupEntry { binding, resource });
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("air orders"), layout, entries: &entries })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_azimuths_are_exact() {
        for (azimuths, exact) in AZIMUTHS.into_iter().zip([6, 10]) {
            for m in 0..=exact {
                let sum: f64 = azimuths.iter().map(|[c, w]| f64::from(*w) * libm::cos(f64::from(m) * libm::acos(f64::from(*c)))).sum();
                assert!((sum - if m == 0 { 1.0 } else { 0.0 }).abs() < 2e-6, "cos {m}φ of {}: {sum}", azimuths.len());
            }
        }
    }
}
