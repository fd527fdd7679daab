// Exposure: histogram of log luminance, its trimmed mean, adaptation in time. Rust side: engine/src/render/pass/exposure.rs.

#include "lib/frame.wgsl"
#include "lib/color.wgsl"

struct Meter {
    range: vec4<f32>,  // log2 of the luminance of the first bin, bins per stop, compensation in stops; stops that highlights may stand above the middle
    trim: vec4<f32>,   // share left out below, share up to which is counted, adaptation to light and to dark, 1/s
    limit: vec4<f32>,  // lowest and highest EV at ISO 100; EV below which the star in view dazzles; share that is no highlight
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var lit: texture_2d<f32>;
@group(1) @binding(1) var<storage, read_write> histogram: array<atomic<u32>, 256>;
@group(1) @binding(2) var<storage, read_write> next: Exposure;
@group(1) @binding(3) var<uniform> meter: Meter;

// Twins of the constants in engine::light::exposure.
const BRIGHT_HALF_EV: f32 = 0.6;
const HIGHLIGHT_COST_EV: f32 = 1.3;
const BLACK_EV: f32 = 14.0;
const DISC_LOG2: f32 = 22.0;
const MOONLIT: vec3<f32> = vec3<f32>(0.02, 2.2, 0.3);
const BRIGHT: vec3<f32> = vec3<f32>(4096.0, 0.5, 1.0);

var<workgroup> local_bins: array<atomic<u32>, 256>;

@compute @workgroup_size(16, 16)
fn count_pixels(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    atomicStore(&local_bins[index], 0u);
    workgroupBarrier();
    let pixel = id.xy * 2u;
    if all(pixel < textureDimensions(lit)) {
        let y = luminance_of(textureLoad(lit, pixel, 0).rgb) / exposure.pre;
        // What is darker than the first bin (empty space) says nothing of the light: it is not counted.
        let x = (log2(max(y, 1e-20)) - meter.range.x) * meter.range.y;
        if x >= 0.0 {
            atomicAdd(&local_bins[u32(min(1.0 + x, 255.0))], 1u);
        }
    }
    workgroupBarrier();
    let n = atomicLoad(&local_bins[index]);
    if n > 0u {
        atomicAdd(&histogram[index], n);
    }
}

// Stops by which a scene of this luminance is left darker than middle grey, and brighter. Twins of those of engine::light::exposure.
fn dimness_ev(luminance_cd_m2: f32) -> f32 {
    let key = 1.03 - 2.0 / (2.0 + log2(luminance_cd_m2 + 1.0) / log2(10.0));
    let night = MOONLIT.y - MOONLIT.z * (log2(max(luminance_cd_m2, 1e-9) / MOONLIT.x) / log2(10.0));
    return max(min(log2(0.6769 / key), night), 0.0);
}
fn brightness_ev(luminance_cd_m2: f32) -> f32 {
    return clamp(BRIGHT.y * log2(max(luminance_cd_m2, 1e-9) / BRIGHT.x), 0.0, BRIGHT.z);
}

fn log2_of_bin(i: u32) -> f32 {
    return (f32(i) - 0.5) / meter.range.y + meter.range.x;
}

// One step of adaptation. Twin of engine::light::exposure::{ev100_of_histogram, adapt, exposure_of_ev100}.
@compute @workgroup_size(1)
fn settle() {
    var below = 0.0;
    for (var i = 1u; i < 256u; i++) {
        below += select(0.0, f32(atomicLoad(&histogram[i])), log2_of_bin(i) < DISC_LOG2);
    }
    // What the highlights make black does not vote.
    var count = 0.0;
    var first = 1u;
    var black = meter.range.x;
    for (var i = 1u; i < 256u; i++) {
        black = select(black, log2_of_bin(i) - BLACK_EV, count < below * meter.limit.w);
        count += f32(atomicLoad(&histogram[i]));
    }
    var total = 0.0;
    for (var i = 1u; i < 256u; i++) {
        first = select(first, i + 1u, log2_of_bin(i) < black);
        total += select(0.0, f32(atomicLoad(&histogram[i])), i >= first);
    }
    // Mean of log luminance between two percentiles, and what only the brightest pixels exceed.
    var before = 0.0;
    var sum = 0.0;
    var weight = 0.0;
    var bright = meter.range.x;
    for (var i = first; i < 256u; i++) {
        let after = before + f32(atomicLoad(&histogram[i]));
        let inside = max(min(after, total * meter.trim.y) - max(before, total * meter.trim.x), 0.0);
        let log2_luminance = log2_of_bin(i);
        sum += inside * log2_luminance;
        weight += inside;
        bright = select(bright, log2_luminance, before < total * meter.limit.w);
        before = after;
    }
    // EV100 = log2(L · 100 / 12.5); a picture with nothing in it is exposed for the darkest.
    var ev = meter.limit.x;
    if weight > 0.0 {
        let average = exp2(sum / weight);
        let usual = sum / weight - BRIGHT_HALF_EV;
        let middle = max(usual, min(bright - meter.range.w, usual + HIGHLIGHT_COST_EV));
        ev = clamp(middle + 3.0 + dimness_ev(average) - brightness_ev(average), meter.limit.x, meter.limit.y);
    }
    ev = max(ev, meter.limit.z);
    if exposure.settled > 0.5 && frame.forward.w >= 0.0 {
        let now = log2(max(exposure.average, 1e-12)) + 3.0;
        let rate = select(meter.trim.w, meter.trim.z, ev > now);
        ev += (now - ev) * exp(-rate * frame.forward.w);
    }
    // Luminance 1.2 · 2^EV becomes 1 [Lagarde & de Rousiers 2014, §5.1.2]; compensation brightens.
    let wanted = exp2(meter.range.z - ev) / 1.2;
    next.pre = wanted;
    next.final_ = wanted;
    next.average = exp2(ev - 3.0);
    next.settled = 1.0;
}
