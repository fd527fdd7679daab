// Ship: one ship as an instance of the hull, and what lights it. Mirrored by ShipInstance in engine/src/scene/gpu_data.rs.

struct Ship {
    @location(3) centre: vec4<f32>,  // xyz: centre of mass, m from the camera; w: host body's index or −1
    @location(4) hull_x: vec4<f32>,  // columns of icrf_from_hull
    @location(5) hull_y: vec4<f32>,
    @location(6) hull_z: vec4<f32>,
    @location(7) state: vec4<f32>,   // throttle, gear (1 down), heat, height above ground in m
}

fn icrf_from_hull(ship: Ship, v: vec3<f32>) -> vec3<f32> {
    return ship.hull_x.xyz * v.x + ship.hull_y.xyz * v.y + ship.hull_z.xyz * v.z;
}

// A hull vertex in camera-relative ICRF metres; `retract` is where it goes with the gear up.
fn hull_point(ship: Ship, position: vec3<f32>, retract: vec3<f32>) -> vec3<f32> {
    return ship.centre.xyz + icrf_from_hull(ship, position + retract * (1.0 - ship.state.y));
}

// Light that a sphere of radiance 1 below sends to a plane: half of the form factor of a disc seen at angle, softened at the
// horizon. `sine` is the sine of its angular radius, `c` the cosine between the plane's normal and the direction to it.
fn sphere_form_factor(sine: f32, c: f32) -> f32 {
    // Exact for a sphere above the plane's horizon (sine² · c); near it, a smooth half-sum keeps the light of the part above.
    let s2 = sine * sine;
    let soft = 0.5 * (c + sqrt(c * c + s2 * s2 * 0.25));
    return s2 * max(soft, 0.0);
}
