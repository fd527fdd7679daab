// Occlusion: which fraction of the sun's uniform disc is free. Twin of engine/src/light/occlusion.rs, which derives it.
// Angles in radians. Only small angles are ever differenced, so that f32 keeps 1e-5 of the sun's radius.

const OCCLUSION_STRAIGHT: f32 = 4096.0;

// asin for |x| up to about 0.3, by its series: built-in ones may be good to 1e-3 only.
fn asin_small(x: f32) -> f32 {
    let y = x * x;
    return x * (1.0 + y * (1.0 / 6.0 + y * (3.0 / 40.0 + y * (15.0 / 336.0 + y * (105.0 / 3456.0)))));
}

// atan of x ≥ 0 to 2e-7, by a polynomial on 0 … 1 [Abramowitz & Stegun 1964, 4.4.49].
fn atan_positive(x: f32) -> f32 {
    let inverse = x > 1.0;
    let a = select(x, 1.0 / max(x, 1.0), inverse);
    let y = a * a;
    let angle = a * (1.0 + y * (-0.3333314528 + y * (0.1999355085 + y * (-0.1420889944 + y * (0.1065626393
        + y * (-0.0752896400 + y * (0.0429096138 + y * (-0.0161657367 + y * 0.0028662257))))))));
    return select(angle, 1.57079632679 - angle, inverse);
}

// Angle between unit vectors: 2 asin(½|a−b|), not acos(a·b).
fn separation(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let half = min(0.5 * length(a - b), 1.0);
    return select(2.0 * asin(half), 2.0 * asin_small(half), half < 0.25);
}

// x − ½ sin 2x for 0 ≤ x ≤ π, without cancellation; `half` is tan ½x.
fn lens_segment(half: f32) -> f32 {
    let x = 2.0 * atan_positive(half);
    let y = x * x;
    let series = x * y * (2.0 / 3.0 - y * (2.0 / 15.0 - y * (4.0 / 315.0 - y * (2.0 / 2835.0))));
    // ½ sin 2x = 2 t (1 − t²) / (1 + t²)², of whichever of t and 1/t is below 1.
    let t = select(half, 1.0 / max(half, 1.0), half > 1.0);
    let q = 1.0 + t * t;
    let sine = 2.0 * t * (2.0 - q) / (q * q);
    return select(x - select(sine, -sine, half > 1.0), series, x < 0.5);
}

// Free fraction above a straight limb; `elevation` is the angle from the limb up to the sun's centre.
fn visible_above_limb(sun_rad: f32, elevation: f32) -> f32 {
    let x = clamp(elevation / sun_rad, -1.0, 1.0);
    if x >= 1.0 {
        return 1.0;
    }
    if x <= -1.0 {
        return 0.0;
    }
    return clamp(1.0 - lens_segment(sqrt((1.0 - x) / (1.0 + x))) / 3.14159265359, 0.0, 1.0);
}

// Free fraction behind a disc whose limb curves like a plane circle of radius `rho` = tan(angular radius); `gap` is the angle from
// its limb to the sun's centre, negative inside.
fn visible_behind_limb(sun_rad: f32, rho: f32, gap: f32) -> f32 {
    if gap >= sun_rad {
        return 1.0;
    }
    if gap <= -sun_rad {
        return 0.0;
    }
    if rho > OCCLUSION_STRAIGHT * sun_rad {
        return visible_above_limb(sun_rad, gap);
    }
    let ratio = rho / sun_rad;
    let e2 = 2.0 * rho + gap - sun_rad;
    if e2 <= 0.0 {
        return 1.0 - ratio * ratio;
    }
    let e0 = 2.0 * rho + gap + sun_rad;
    let e1 = sun_rad - gap;
    let e3 = sun_rad + gap;
    let over = e1 / e0;
    let across = e2 / e3;
    let lens = lens_segment(sqrt(over * across)) + ratio * ratio * lens_segment(sqrt(over / across));
    return clamp(1.0 - lens / 3.14159265359, 0.0, 1.0);
}

// Free fraction behind a disc, from angular radii and the separation of the centres.
fn visible_behind_disc(sun_rad: f32, occluder_rad: f32, separation: f32) -> f32 {
    let rho = select(1e30, tan(occluder_rad), occluder_rad < 1.57);
    return visible_behind_limb(sun_rad, rho, separation - occluder_rad);
}

// A sphere at `offset` from the eye against a sun in unit direction `sun`: x: tan of its angular radius, y: gap from its limb to the
// sun's centre (rad; where that is over a quarter turn, only its sign is right), z: its angular radius where small, else 0.
fn limb_of_sphere(sun: vec3<f32>, offset: vec3<f32>, radius: f32) -> vec3<f32> {
    let distance = max(length(offset), radius * 1.0000001);
    let direction = offset / distance;
    let sine = radius / distance;
    let cosine = sqrt((distance - radius) * (distance + radius)) / distance;
    let rho = sine / max(cosine, 1e-6);
    if sine < 0.1 {
        let small = asin_small(sine);
        return vec3<f32>(rho, separation(sun, direction) - small, small);
    }
    // sin(s − ρ) from sines and cosines alone: no angle near a right one is ever formed.
    let sine_gap = length(cross(sun, direction)) * cosine - dot(sun, direction) * sine;
    let cosine_gap = dot(sun, direction) * cosine + length(cross(sun, direction)) * sine;
    return vec3<f32>(rho, select(sign(sine_gap) * 2.0, asin_small(clamp(sine_gap, -0.9, 0.9)), cosine_gap > 0.0), 0.0);
}

// Mean of visible_above_limb while the elevation goes evenly from `a` to `b`: the edge of a shadow crossed within one step of a
// march leaves no band. The integral of the free fraction over x = elevation/α is x/2 + (x asin x + √(1−x²) − ⅓√(1−x²)³)/π.
fn visible_between(sun_rad: f32, a: f32, b: f32) -> f32 {
    let x = a / sun_rad;
    let y = b / sun_rad;
    if min(x, y) >= 1.0 {
        return 1.0;
    }
    if max(x, y) <= -1.0 {
        return 0.0;
    }
    if abs(y - x) < 0.02 {
        return visible_above_limb(sun_rad, 0.5 * (a + b));
    }
    return clamp((visible_integral(y) - visible_integral(x)) / (y - x), 0.0, 1.0);
}
fn visible_integral(x: f32) -> f32 {
    let c = clamp(x, -1.0, 1.0);
    let root = sqrt(1.0 - c * c);
    let angle = sign(c) * (1.57079632679 - 2.0 * atan_positive(sqrt((1.0 - abs(c)) / (1.0 + abs(c)))));
    return max(x - 1.0, 0.0) + 0.5 * c + (c * angle + root - root * root * root / 3.0) / 3.14159265359;
}
