// Exposure: histogram of log luminance, its trimmed mean, adaptation in time. Rust side: engine/src/render/pass/exposure.rs.

#include "lib/frame.wgsl"
#include "lib/color.wgsl"

struct Meter {
    range: vec4<f32>,  // log2 of the luminance of the first bin, bins per stop, compensation in stops, 0
    trim: vec4<f32>,   // share left out below, share up to which is counted, adaptation to light and to dark, 1/s
    limit: vec4<f32>,  // lowest and highest average luminance exposed for, cd/m², 0, 0
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> exposure: Exposure;
@group(1) @binding(0) var lit: texture_2d<f32>;
@group(1) @binding(1) var<storage, read_write> histogram: array<atomic<u32>, 256>;
@group(1) @binding(2) var<storage, read_write> next: Exposure;
@group(1) @binding(3) var<uniform> meter: Meter;

var<workgroup> local_bins: array<atomic<u32>, 256>;

@compute @workgroup_size(16, 16)
fn count_pixels(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) index: u32) {
    atomicStore(&local_bins[index], 0u);
    workgroupBarrier();
    let pixel = id.xy * 2u;
    if all(pixel < textureDimensions(lit)) {
        let y = luminance_of(textureLoad(lit, pixel, 0).rgb) / exposure.pre;
        // What is darker than the first bin (empty space) says nothing of the light: it is not counted.
        let bin = (log2(max(y, 1e-20)) - meter.range.x) * meter.range.y;
        if bin >= 0.0 {
            atomicAdd(&local_bins[min(u32(bin), 255u)], 1u);
        }
    }
    workgroupBarrier();
    let n = atomicLoad(&local_bins[index]);
    if n > 0u {
        atomicAdd(&histogram[index], n);
    }
}

@compute @workgroup_size(1)
fn settle() {
    var total = 0.0;
    for (var i = 0u; i < 256u; i++) {
        total += f32(atomicLoad(&histogram[i]));
    }
    // Mean of log luminance between two percentiles.
    var below = 0.0;
    var sum = 0.0;
    var weight = 0.0;
    for (var i = 0u; i < 256u; i++) {
        let n = f32(atomicLoad(&histogram[i]));
        let inside = max(min(below + n, total * meter.trim.y) - max(below, total * meter.trim.x), 0.0);
        sum += inside * (f32(i) + 0.5);
        weight += inside;
        below += n;
    }
    // An empty picture is exposed for the darkest.
    var target_log = log2(meter.limit.x);
    if weight > 0.0 {
        target_log = clamp(sum / weight / meter.range.y + meter.range.x, log2(meter.limit.x), log2(meter.limit.y));
    }
    var log_average = target_log;
    if exposure.settled > 0.5 && frame.forward.w >= 0.0 {
        let old = log2(max(exposure.average, 1e-12));
        let rate = select(meter.trim.w, meter.trim.z, target_log > old);
        log_average = target_log + (old - target_log) * exp(-frame.forward.w * rate);
    }
    let average = exp2(log_average);
    // EV100 = log2(8 L); luminance 1.2 · 2^EV becomes 1 [Lagarde & de Rousiers 2014, §5.1].
    let wanted = exp2(meter.range.z) / (9.6 * average);
    next.pre = wanted;
    next.final_ = wanted;
    next.average = average;
    next.settled = 1.0;
}
