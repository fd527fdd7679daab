//! The device: finds a GPU that can draw Syzygy, or says of each backend why it cannot.
//!
//! Needed: compute shaders and Rgba16Float render targets. Taken where offered: timestamps, pipeline statistics, filterable
//! 32-bit float textures; nothing depends on them. A lost device is reported by [`Gpu::lost`]; make a new [`Gpu`] then.

use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::rwh::{HasDisplayHandle, HasWindowHandle};

/// Which graphics interface to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendChoice {
    /// The first that works: Vulkan, Metal, Direct3D 12, OpenGL.
    #[default]
    Auto,
    /// Vulkan only.
    Vulkan,
    /// Metal only.
    Metal,
    /// Direct3D 12 only.
    Dx12,
    /// OpenGL (ES) only.
    Gl,
}

impl BackendChoice {
    fn candidates(self) -> Vec<wgpu::Backend> {
        match self {
            Self::Auto => vec![wgpu::Backend::Vulkan, wgpu::Backend::Metal, wgpu::Backend::Dx12, wgpu::Backend::Gl],
            Self::Vulkan => vec![wgpu::Backend::Vulkan],
            Self::Metal => vec![wgpu::Backend::Metal],
            Self::Dx12 => vec![wgpu::Backend::Dx12],
            Self::Gl => vec![wgpu::Backend::Gl],
        }
    }
}

impl FromStr for BackendChoice {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s.to_ascii_lowercase().as_str() {
            "auto" => Ok(Self::Auto),
            "vulkan" | "vk" => Ok(Self::Vulkan),
            "metal" => Ok(Self::Metal),
            "dx12" | "d3d12" => Ok(Self::Dx12),
            "gl" | "opengl" | "gles" => Ok(Self::Gl),
            _ => Err(format!("`{s}` is no backend: expected auto, vulkan, metal, dx12 or gl")),
        }
    }
}

/// Why a backend was not taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Its name.
    pub backend: &'static str,
    /// What it said.
    pub reason: String,
}

/// No usable GPU, or one that went away.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// No backend gave a device.
    #[error("no graphics device can draw Syzygy:{}\n  what to do: install a Vulkan driver (Debian/Ubuntu: `apt install mesa-vulkan-drivers`, which also brings a software renderer), or choose another backend with --backend", Refusals(.0))]
    NoDevice(Vec<Refusal>),
    /// Reading back from the GPU failed.
    #[error("reading from the graphics device failed: {0}")]
    Readback(String),
}

struct Refusals<'a>(&'a [Refusal]);
impl fmt::Display for Refusals<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|r| write!(f, "\n  {}: {}", r.backend, r.reason))
    }
}

/// A device with its queue, and what it can do.
pub struct Gpu {
    /// The instance; surfaces were made from it.
    pub instance: wgpu::Instance,
    /// The adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, driver, backend.
    pub info: wgpu::AdapterInfo,
    /// Features that were granted.
    pub features: wgpu::Features,
    troubles: Arc<Mutex<Troubles>>,
}

#[derive(Default)]
struct Troubles {
    lost: Option<String>,
    error: Option<String>,
}

fn locked(m: &Mutex<Troubles>) -> std::sync::MutexGuard<'_, Troubles> {
    m.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Gpu {
    /// A device that draws into images only.
    pub fn headless(choice: BackendChoice) -> Result<Self, GpuError> {
        first_working(choice, |instance_of, backend| {
            let instance = wgpu::Instance::new(instance_of(backend));
            Self::open(instance, None)
        })
    }

    /// A device that can present to `window`, and the (not yet configured) surface.
    pub fn for_window<W>(choice: BackendChoice, window: Arc<W>) -> Result<(Self, wgpu::Surface<'static>), GpuError>
    where
        W: HasWindowHandle + HasDisplayHandle + fmt::Debug + Send + Sync + 'static,
    {
        first_working(choice, |instance_of, backend| {
            let instance = wgpu::Instance::new(instance_of(backend).with_display_handle(Box::new(window.clone())));
            let surface = match instance.create_surface(window.clone()) {
                Ok(surface) => surface,
                // Where no driver is, that says more than that there is no surface.
                Err(e) => return Err(Self::open(instance, None).err().unwrap_or(format!("it cannot present to this window: {e}"))),
            };
            let gpu = Self::open(instance, Some(&surface))?;
            Ok((gpu, surface))
        })
    }

    fn open(instance: wgpu::Instance, surface: Option<&wgpu::Surface<'static>>) -> Result<Self, String> {
        let request = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&request)).map_err(|e| concerning(&e.to_string()))?;
        let info = adapter.get_info();
        if !adapter.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS) {
            return Err(format!("{} has no compute shaders", info.name));
        }
        let wanted = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::PIPELINE_STATISTICS_QUERY | wgpu::Features::FLOAT32_FILTERABLE;
        let features = adapter.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("syzygy"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| format!("{} gave no device: {e}", info.name))?;
        let troubles = Arc::new(Mutex::new(Troubles::default()));
        let at_loss = troubles.clone();
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                tracing::error!("graphics device lost: {message}");
            }
            locked(&at_loss).lost = Some(if message.is_empty() { format!("{reason:?}") } else { message });
        });
        let at_error = troubles.clone();
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            tracing::error!("graphics error: {e}");
            locked(&at_error).error.get_or_insert_with(|| e.to_string());
        }));
        tracing::info!("drawing with {} ({}, {})", info.name, info.backend, info.driver);
        Ok(Self { instance, adapter, device, queue, info, features, troubles })
    }

    /// Why the device is gone, if it is.
    pub fn lost(&self) -> Option<String> {
        locked(&self.troubles).lost.clone()
    }

    /// The first error since the last call, if any; it is taken out.
    pub fn take_error(&self) -> Option<String> {
        locked(&self.troubles).error.take()
    }

    /// Waits until everything submitted has run.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(|e| GpuError::Readback(e.to_string()))
    }

    /// Submits one encoder.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.queue.submit([encoder.finish()]);
    }

    /// A new command encoder.
    pub fn encoder(&self, label: &str) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}

/// What an error says of the backend that was asked for: wgpu also lists those that were not.
fn concerning(error: &str) -> String {
    let Some((what, each)) = error.split_once("; ") else { return error.to_owned() };
    let asked: Vec<&str> = each.split(", ").filter(|part| !part.ends_with("not requested")).collect();
    if asked.is_empty() { what.to_owned() } else { format!("{what}: {}", asked.join(", ")) }
}

fn first_working<T>(
    choice: BackendChoice,
    open: impl Fn(&dyn Fn(wgpu::Backend) -> wgpu::InstanceDescriptor, wgpu::Backend) -> Result<T, String>,
) -> Result<T, GpuError> {
    let describe = |backend: wgpu::Backend| wgpu::InstanceDescriptor {
        backends: wgpu::Backends::from(backend),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    };
    let mut refusals = Vec::new();
    for backend in choice.candidates() {
        let name = backend.to_str();
        if !wgpu::Instance::enabled_backend_features().contains(wgpu::Backends::from(backend)) {
            refusals.push(Refusal { backend: name, reason: "not available on this system".to_owned() });
            continue;
        }
        match open(&describe, backend) {
            Ok(found) => return Ok(found),
            Err(reason) => refusals.push(Refusal { backend: name, reason }),
        }
    }
    Err(GpuError::NoDevice(refusals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_every_backend_and_what_to_do() {
        let e = GpuError::NoDevice(vec![
            Refusal { backend: "vulkan", reason: "no driver".into() },
            Refusal { backend: "gl", reason: "no compute shaders".into() },
        ]);
        let text = e.to_string();
        for part in ["vulkan: no driver", "gl: no compute shaders", "apt install mesa-vulkan-drivers", "--backend"] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn a_reason_speaks_of_the_backend_that_was_asked_for() {
        let all = "No suitable graphics adapter found; noop not requested, vulkan drivers/libraries could not be loaded, gl not requested";
        assert_eq!(concerning(all), "No suitable graphics adapter found: vulkan drivers/libraries could not be loaded");
        assert_eq!(concerning("No adapter; gl not requested"), "No adapter");
        assert_eq!(concerning("something else"), "something else");
    }

    #[test]
    fn backend_names_parse() {
        assert_eq!("Vulkan".parse(), Ok(BackendChoice::Vulkan));
        assert!("vulcan".parse::<BackendChoice>().unwrap_err().contains("expected auto, vulkan"));
    }
}
