//! The sky and aerial perspective: the air of every body in view laid over the opaque picture, far to near, each by its own model
//! and only over the rectangle that its shell covers.
//!
//! Here: which bodies, in which order, over what, and between which textures. How a model draws is its [`Painter`], one file each, with
//! its shader `shaders/pass/sky_<model>.wgsl`; along given rays the same painter and the same function of `shaders/lib/<model>.wgsl` are
//! asked by [`super::sky_probe`]. What all models share in a shader is `shaders/lib/sky_pixel.wgsl`. Not here: the sun's disc and the
//! stars, which are drawn before and dimmed by the air.
//!
//! A new model: a variant of [`Model`], a file here with its painter, its place in [`PAINTERS`], [`painter_of`] and [`model_name`].

pub mod choose;
pub mod gradient;
pub mod limb_table;
pub mod physical;
pub mod thickness;
pub mod view_table;

use crate::air::{Air, Model};
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pass::air_tables::{AirBaker, is_bare};
use crate::render::pipeline::{PipelineKind, depth_entry, storage_entry, texture_entry};
use crate::render::report::AirReport;
use crate::render::shared::{FrameContext, Mirror, Shared};
use crate::render::targets::{HDR, SKY_LEVEL};
use crate::scene::gpu_data::{MAX_AIRS, SkySettings, SkyUniform};
use crate::scene::{Body, Snapshot, Surface};
use bytemuck::Zeroable;
use choose::{Choice, Rect};
use std::sync::OnceLock;
use wgpu::{BindGroupEntry, BindingResource};

/// Points of a march on a long stretch of a ray unless told otherwise.
pub const STEPS: u32 = 12;

/// Pixels from one ray to the next, each way, of an air before a bank of fog that it holds. Not that of the level from which a painter lays
/// its own air.
pub const FRONT_RATE: u32 = 2;

/// How one model of air draws. Bind groups: 0 and 1 as in [`crate::render::shared`], 2 the picture (opaque, depth, `Sky`), 3 its own.
pub trait Painter: Send {
    /// What its shader is made from.
    fn kind(&self) -> &PainterKind;
    /// The model's numbers for a body, in the order that its shader expects.
    fn settings(&self, body: &Body, air: &Air) -> SkySettings;
    /// The same among the other bodies of a scene, for models that have more than one light.
    fn settings_in(&self, scene: &Snapshot, body: &Body, air: &Air) -> SkySettings {
        let _ = scene;
        self.settings(body, air)
    }
    /// Draws what its picture of a body is made of, just before that.
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        let _ = (f, draw);
    }
    /// Adds how much of its light a pixel may err that is drawn between rays.
    fn agree(&self, settings: &mut SkySettings, agree: f32) {
        let _ = (settings, agree);
    }
    /// Where in the picture it will be drawn, for models whose shader asks.
    fn place(&self, settings: &mut SkySettings, rect: Rect) {
        let _ = (settings, rect);
    }
    /// Whether the pass that it draws in then marks in a stencil what has been drawn.
    fn marks(&self) -> bool {
        false
    }
    /// Draws it then: groups 0 to 2 are bound, pixels outside of what its shell covers are cut off. `id` is [`Body::id`].
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, id: u16) {
        pass.set_pipeline(self.pipeline());
        pass.set_bind_group(3, self.group(id), &[]);
        pass.draw(0..3, 0..1);
    }
    /// What draws it in one draw.
    fn pipeline(&self) -> &wgpu::RenderPipeline {
        &self.kind().pipeline
    }
    /// Group 3 for a body (`id` is [`Body::id`]), laid out by [`PainterKind::own_layout`].
    fn group(&self, id: u16) -> &wgpu::BindGroup;
    /// Notes which airs will be drawn; the value is how many tables of its own have to be made for them first.
    fn plan(&mut self, gpu: &Gpu, airs: &[(u16, &Air)], forced: bool) -> usize {
        let _ = (gpu, airs, forced);
        0
    }
    /// Makes the tables that [`Painter::plan`] found missing.
    fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        let _ = (gpu, pass);
    }
    /// Whether it says itself what reaches the ground of its bodies.
    fn lights_ground(&self) -> bool {
        false
    }
    /// Says it: writes transmittance and irradiance of a body's air, each one layer, as `shaders/lib/air.wgsl` reads them.
    fn light_ground(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, id: u16, into: [&wgpu::TextureView; 2]) {
        let _ = (gpu, pass, id, into);
    }
    /// The sky that a body's water mirrors.
    fn mirror(&self, id: u16) -> Option<&Mirror> {
        let _ = id;
        None
    }
}

/// The compiled shader of a model.
pub struct PainterKind {
    /// Its file below `shaders/`: entry points `vertex`, `fragment`, `probe`.
    pub file: &'static str,
    /// Layout of group 3.
    pub own_layout: wgpu::BindGroupLayout,
    /// Draws with the entry point `fragment`.
    pub pipeline: wgpu::RenderPipeline,
    /// For further pipelines of the same file.
    pub module: wgpu::ShaderModule,
    /// Draws with the entry point `front`: made when first needed.
    front: OnceLock<wgpu::RenderPipeline>,
}

/// One body's air, about to be drawn.
pub struct Draw<'a> {
    /// The body.
    pub body: &'a Body,
    /// Its air.
    pub air: &'a Air,
    /// What its shell covers.
    pub rect: Rect,
    /// Group 1.
    pub light: &'a wgpu::BindGroup,
    /// Group 2.
    pub picture: &'a wgpu::BindGroup,
    /// Light and transmittance of the air in which it lies, up to it, are in the level of [`FRONT_RATE`].
    pub held: bool,
    /// The tables of that air tell what lights the bank.
    pub lit: bool,
}

impl PainterKind {
    /// Compiles `file`; `own` are the entries of group 3.
    pub fn new(parts: &Parts<'_>, file: &'static str, own: &[wgpu::BindGroupLayoutEntry]) -> Result<Self, RenderError> {
        let Parts { gpu, shaders, shared, picture } = parts;
        let own_layout =
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("group 3: model of air"), entries: own });
        let module = shaders.load(&gpu.device, file)?;
        let groups = [&shared.frame_layout, &shared.light_layout, picture, &own_layout];
        let pipeline = PipelineKind::full_screen("sky", &module, &groups, HDR).make(gpu);
        Ok(Self { file, own_layout, pipeline, module, front: OnceLock::new() })
    }
}

/// What painters are made from.
pub struct Parts<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Shaders.
    pub shaders: &'a ShaderLibrary,
    /// Groups 0 and 1.
    pub shared: &'a Shared,
    /// Layout of group 2.
    pub picture: &'a wgpu::BindGroupLayout,
}

/// Makes a model's painter.
type Make = fn(&Parts<'_>) -> Result<Box<dyn Painter>, RenderError>;

/// The painters, in the order of [`painter_of`].
const PAINTERS: [Make; 5] = [physical::make, thickness::make, gradient::make, limb_table::make, view_table::make];

/// Place of a model's painter in [`PAINTERS`].
const fn painter_of(model: &Model) -> usize {
    match model {
        Model::Physical(_) => 0,
        Model::Thickness(_) => 1,
        Model::Gradient(_) => 2,
        Model::LimbTable(_) => 3,
        Model::ViewTable(_) => 4,
    }
}

/// A model's name, as files spell it.
pub const fn model_name(model: &Model) -> &'static str {
    match model {
        Model::Physical(_) => "physical",
        Model::Thickness(_) => "thickness",
        Model::Gradient(_) => "gradient",
        Model::LimbTable(_) => "limb_table",
        Model::ViewTable(_) => "view_table",
    }
}

/// The painter of one model alone, for probes.
pub fn painter(parts: &Parts<'_>, model: &Model) -> Result<Box<dyn Painter>, RenderError> {
    PAINTERS[painter_of(model)](parts)
}

/// Layout of group 2.
pub fn picture_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("group 2: picture"),
        entries: &[
            texture_entry(0, wgpu::TextureViewDimension::D2),
            depth_entry(1),
            wgpu::BindGroupLayoutEntry { visibility: wgpu::ShaderStages::all(), ..storage_entry(2) },
        ],
    })
}

/// The pass.
pub struct Sky {
    /// Points of a march on a long stretch of a ray, a multiple of four.
    pub steps: u32,
    /// How much of its light a pixel may err that is drawn between rays.
    pub agree: f32,
    picture: wgpu::BindGroupLayout,
    painters: Vec<Box<dyn Painter>>,
    uniforms: Vec<Uniform<SkyUniform>>,
    /// The same for the air before a bank of fog.
    fronts: Vec<Uniform<SkyUniform>>,
    chosen: Vec<Choice>,
    no_mirror: Mirror,
    /// The last picture through air is in `aerial`, else in `opaque`.
    in_aerial: bool,
}

impl Sky {
    /// Compiles every model.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let picture = picture_layout(gpu);
        let parts = Parts { gpu, shaders, shared, picture: &picture };
        let painters = PAINTERS.iter().map(|make| make(&parts)).collect::<Result<Vec<_>, _>>()?;
        let [uniforms, fronts] =
            [0, 1].map(|_| (0..MAX_AIRS).map(|_| Uniform::new(&gpu.device, "Sky", wgpu::BufferUsages::STORAGE)).collect());
        Ok(Self {
            steps: STEPS,
            agree: physical::AGREE,
            picture,
            painters,
            uniforms,
            fronts,
            chosen: Vec::new(),
            no_mirror: Mirror::none(gpu),
            in_aerial: false,
        })
    }

    /// Chooses what to draw and why the rest is not; then tells why no model has tables of its own to make.
    pub fn plan(&mut self, f: &mut FrameContext<'_>, tables: &AirBaker) -> Option<String> {
        self.in_aerial = false;
        self.chosen = choose::choose(f.scene, &f.air_slots);
        for choice in &self.chosen {
            f.report_air(AirReport {
                body: choice.id,
                model: choice.model.to_owned(),
                ran: choice.skip.is_none(),
                reason: choice.skip.clone().unwrap_or_else(|| choice.reason.clone()),
                covers: choice.rect.share_of(f.targets.size),
                tables: tables.told(choice.body).to_owned(),
            });
        }
        self.chosen.retain(|c| c.skip.is_none());
        let mut missing = 0;
        for (i, painter) in self.painters.iter_mut().enumerate() {
            let airs: Vec<(u16, &Air)> =
                self.chosen.iter().filter_map(|c| air_of(f.scene, c)).filter(|a| painter_of(&a.1.model) == i).collect();
            missing += painter.plan(f.gpu, &airs, f.scene.force.all);
        }
        (missing == 0).then(|| "no model in view needs tables of its own that it does not have".to_owned())
    }

    /// Makes the tables that [`Sky::plan`] found missing.
    pub fn record_tables(&mut self, f: &mut FrameContext<'_>) {
        let gpu = f.gpu;
        let mut pass = f.compute("sky_tables");
        for painter in &mut self.painters {
            painter.bake(gpu, &mut pass);
        }
    }

    /// Why no ground has to be told anew what lights it.
    pub fn skip_daylight(&self, f: &FrameContext<'_>) -> Option<String> {
        if self.by_own_light(f.scene).next().is_none() {
            return Some("no model in view lights the ground by tables of its own".to_owned());
        }
        let ran = |name| f.report.pass(name).is_some_and(|p| p.ran);
        (!ran("air_tables") && !ran("sky_tables")).then(|| "no table in view has changed since the ground was told".to_owned())
    }

    /// Puts what the models in view say of it in the place of what the air tables say: `tables` are those.
    pub fn record_daylight(&self, f: &mut FrameContext<'_>, tables: [&Texture; 2]) {
        let (gpu, scene, slots) = (f.gpu, f.scene, f.air_slots.clone());
        let mut pass = f.compute("sky_daylight");
        for (choice, painter) in self.by_own_light(scene) {
            let Some(slot) = slots.get(choice.body as usize).copied().flatten() else { continue };
            // Transmittance has two layers a slot; the beam's, the second, is for models that march.
            let [sun, sky] = [tables[0].layer_view(2 * slot), tables[1].layer_view(slot)];
            painter.light_ground(gpu, &mut pass, choice.id, [&sun, &sky]);
        }
    }

    fn by_own_light<'a, 's>(&'a self, scene: &'s Snapshot) -> impl Iterator<Item = (&'a Choice, &'a dyn Painter)> + use<'a, 's> {
        self.chosen.iter().filter_map(move |choice| {
            let (_, air) = air_of(scene, choice)?;
            let painter = self.painters.get(painter_of(&air.model)).filter(|p| p.lights_ground())?;
            Some((choice, &**painter))
        })
    }

    /// The sky that water mirrors: that of the nearest body in view whose model keeps one in a table.
    pub fn mirror(&self, scene: &Snapshot) -> &Mirror {
        self.by_own_light(scene).filter_map(|(choice, painter)| painter.mirror(choice.id)).last().unwrap_or(&self.no_mirror)
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        if scene.bodies.iter().all(|b| b.air.is_none()) {
            return Some("no body in the scene has air".to_owned());
        }
        self.chosen.is_empty().then(|| "no air in view covers a pixel".to_owned())
    }

    /// Reads the opaque colour and depth, lays each chosen air over it, and gives the finished light. `light` is group 1.
    ///
    /// An air that covers the whole picture goes from one texture to the other; one that covers a part is drawn in place,
    /// after that part alone was copied to be read.
    pub fn record(&mut self, f: &mut FrameContext<'_>, light: &wgpu::BindGroup) -> wgpu::TextureView {
        let whole = Rect::whole(f.targets.size);
        for (i, choice) in self.chosen.iter().enumerate() {
            let (Some((id, air)), Some(uniform)) = (air_of(f.scene, choice), self.uniforms.get(i)) else { continue };
            let Some(painter) = self.painters.get(painter_of(&air.model)) else { continue };
            let Some(body) = f.scene.bodies.get(choice.body as usize) else { continue };
            let holder = choice.held_by.and_then(|by| u32::try_from(by).ok()).filter(|_| matches!(body.surface, Surface::Nothing));
            let ids = [choice.body, self.steps, 0, holder.unwrap_or(0)];
            let mut settings = painter.settings_in(f.scene, body, air);
            painter.agree(&mut settings, self.agree);
            painter.place(&mut settings, choice.rect);
            uniform.write(&f.gpu.queue, &SkyUniform { ids, settings });
            let targets = f.targets;
            let (current, other) = if self.in_aerial { (&targets.aerial, &targets.opaque) } else { (&targets.opaque, &targets.aerial) };
            let (from, into) = if choice.rect == whole {
                self.in_aerial = !self.in_aerial;
                (current, other)
            } else {
                choice.rect.copy(&mut f.encoder, &current.texture, &other.texture);
                (other, current)
            };
            let picture = self.picture_group(f, &from.view, uniform);
            let held = matches!(body.surface, Surface::Nothing) && self.record_front(f, light, &from.view, i);
            let Some(painter) = self.painters.get_mut(painter_of(&air.model)) else { continue };
            let holder = choice.held_by.and_then(|by| f.scene.bodies.get(by));
            let lit = held && holder.is_some_and(|h| h.air.as_ref().is_some_and(|air| !is_bare(h, air)));
            let draw = Draw { body, air, rect: choice.rect, light, picture: &picture, held, lit };
            paint(f, &mut **painter, &draw, id, &into.view, choice.rect != whole);
        }
        if self.in_aerial { f.targets.aerial.view.clone() } else { f.targets.opaque.view.clone() }
    }

    /// Before a bank of fog in another's air: draws that air up to the bank, into the level of [`FRONT_RATE`]. False where it lies in none.
    fn record_front(&self, f: &mut FrameContext<'_>, light: &wgpu::BindGroup, opaque: &wgpu::TextureView, bank: usize) -> bool {
        let Some((choice, uniform)) = self.chosen.get(bank).zip(self.fronts.get(bank)) else { return false };
        let Some(holder) = self.chosen.iter().find(|c| choice.held_by == Some(c.body as usize)) else { return false };
        let Some((id, air)) = air_of(f.scene, holder) else { return false };
        let Some(painter) = self.painters.get(painter_of(&air.model)) else { return false };
        let Some(body) = f.scene.bodies.get(holder.body as usize) else { return false };
        let settings = painter.settings_in(f.scene, body, air);
        uniform.write(&f.gpu.queue, &SkyUniform { ids: [holder.body, self.steps, 0, choice.body], settings });
        let picture = self.picture_group(f, opaque, uniform);
        let kind = painter.kind();
        let groups = [&f.shared.frame_layout, &f.shared.light_layout, &self.picture, &kind.own_layout];
        let pipeline = kind.front.get_or_init(|| {
            PipelineKind { entry: "front", colours: 2, ..PipelineKind::full_screen("sky", &kind.module, &groups, SKY_LEVEL) }.make(f.gpu)
        });
        let rect = choice.rect.every(FRONT_RATE, f.targets.size);
        let views = f.targets.sky_at(FRONT_RATE).light.each_ref().map(|t| &t.view);
        let mut pass = f.draw_pair("sky", views, true);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, light, &[]);
        pass.set_bind_group(2, &picture, &[]);
        pass.set_bind_group(3, painter.group(id), &[]);
        pass.set_scissor_rect(rect.left, rect.top, rect.width, rect.height);
        pass.draw(0..3, 0..1);
        true
    }

    fn picture_group(&self, f: &FrameContext<'_>, opaque: &wgpu::TextureView, uniform: &Uniform<SkyUniform>) -> wgpu::BindGroup {
        f.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sky"),
            layout: &self.picture,
            entries: &[
                BindGroupEntry { binding: 0, resource: BindingResource::TextureView(opaque) },
                BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&f.targets.depth.view) },
                BindGroupEntry { binding: 2, resource: uniform.buffer.as_entire_binding() },
            ],
        })
    }

    /// Whether the finished light of the last frame is in `aerial`; else it is in `opaque`.
    pub const fn in_aerial(&self) -> bool {
        self.in_aerial
    }
}

/// Draws one air into a picture, over its old contents or in their place.
pub fn paint(f: &mut FrameContext<'_>, painter: &mut dyn Painter, draw: &Draw<'_>, id: u16, into: &wgpu::TextureView, over: bool) {
    painter.before(f, draw);
    let stencil = &f.targets.sky_stencil.view;
    let mut pass = if painter.marks() { f.draw_marked("sky", into, over, stencil) } else { f.draw_full_screen("sky", into, over) };
    pass.set_bind_group(1, draw.light, &[]);
    pass.set_bind_group(2, draw.picture, &[]);
    let Rect { left, top, width, height } = draw.rect;
    pass.set_scissor_rect(left, top, width, height);
    painter.draw(&mut pass, id);
}

/// The air of a chosen body, and the body's id.
fn air_of<'a>(scene: &'a Snapshot, choice: &Choice) -> Option<(u16, &'a Air)> {
    let body = scene.bodies.get(choice.body as usize)?;
    body.air.as_ref().map(|air| (body.id, air))
}

/// Settings of a model that has none.
pub fn no_settings() -> SkySettings {
    SkySettings::zeroed()
}
