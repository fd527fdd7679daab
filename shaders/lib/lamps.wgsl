// Lamps: what of a picture of a planet's night is its cities. Not here: where they are lit (the passes know the sun).

// Luminance of a brightest texel, cd/m². BodyMaps::NIGHT_CD_M2.
const NIGHT_CD_M2: f32 = 0.3;
// Sodium and warm white together, luminance 1 in linear sRGB.
const LAMP_COLOUR: vec3<f32> = vec3<f32>(1.42, 0.92, 0.53);

// Light of the lamps, cd/m², from a linear texel. Such pictures lay moonlit land and sea under the lamps in blue, and compression
// smears colour: the red channel above its floor is what shines, in the colour that lamps have.
fn lamps(film: vec3<f32>) -> vec3<f32> {
    return LAMP_COLOUR * (NIGHT_CD_M2 * max(film.r - 0.06, 0.0));
}
