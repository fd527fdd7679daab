// The second light of a body: what the brightest of the worlds around throws back at it, moonlight or planetshine. It is like the first
// but for direction, size and strength, so whatever is lit by a Body is lit again by the same Body in its second light.
//
// Chosen and faded in by engine/src/scene/second_light.rs; Body.lights.z is 1 where there is one. Nothing hides it but the body's own horizon.

#include "lib/frame.wgsl"

// The body in its k-th light: 0, the star; 1, the second.
fn in_light(body: Body, k: u32) -> Body {
    var lit = body;
    if k > 0u {
        lit.sun = body.second;
        lit.illuminance = body.second_illuminance;
        lit.ids.y = 0;
        lit.lights.x = 0;
        lit.lights.y = -1;
    }
    return lit;
}

// How many lights it has.
fn light_count(body: Body) -> u32 {
    return 1u + u32(max(body.lights.z, 0));
}
