//! The keys of `atmosphere.toml`: the table by which it is read, from which its schema is written and its editor made. Ranges are the
//! engine's where it has them; what depends on other keys is checked when the air is built ([`super`]).

use super::super::fields::{Field, Kind, Span, Variant, Ways, may, must};

/// Coefficients of a layer, m⁻¹.
const PER_M: Kind = Kind::Rgb(Span::log(0.0, 1.0));
/// Altitudes, m.
const ALTITUDE: Kind = Kind::Number(Span::linear(-1.0e4, 1.0e7));
/// Shares of the light, per channel.
const SHARE: Kind = Kind::Rgb(Span::linear(0.0, 1.0));

/// All of the file.
pub const ATMOSPHERE: &[Field] = &[
    may("model", Kind::Choice(MODELS), "how the light of the air is found: \"physical\" where it is left out"),
    may("spectrum", Kind::Choice(SPECTRA), "how three channels are made of a layer's physical inputs: \"rgb\" where it is left out"),
    may(
        "wavelengths_nm",
        Kind::Rgb(Span::linear(100.0, 2000.0)),
        "where numbers in threes hold: red, green, blue, falling; 680, 550, 440 where it is left out",
    ),
    may("top_altitude_m", Kind::Number(Span::log(100.0, 1.0e7)), "altitude where the air ends, above the datum; at most the body's radius"),
    may("ground_albedo", SHARE, "Lambert albedo of the ground that lights the air from below"),
    may("layers", Kind::Tables(LAYER), "what scatters and absorbs, any number of layers; `layers = []` is a vacuum"),
    may("physics", Kind::Variants(PHYSICS), "what drags; apart from the look. Without it nothing does"),
    may("physical", Kind::Table(PHYSICAL), "settings of the model \"physical\""),
    may("fog", Kind::Tables(FOG), "banks of fog and nebulae: balls of air that turn with the body, whatever its own air is"),
    may("thickness", Kind::Table(THICKNESS), "settings of the model \"thickness\""),
    may("limb_table", Kind::Table(LIMB_TABLE), "settings of the model \"limb_table\""),
    may("view_table", Kind::Table(VIEW_TABLE), "settings of the model \"view_table\""),
    may("gradient", Kind::Table(GRADIENT), "settings of the model \"gradient\""),
];

/// The models, and none.
pub const MODELS: &[(&str, &str)] = &[
    ("physical", "single scattering exact along the ray, higher orders from a table of their source"),
    ("thickness", "as bright as the air is thick, shadowed air a fifth of that [Josth]"),
    ("limb_table", "a table over two cosines at the shell's top, added to the picture [Dolan]"),
    ("view_table", "single scattering from a table by height and two angles [Elek]"),
    ("gradient", "colours of two small painted maps, without physics"),
    ("none", "nothing is seen of it; what drags is kept"),
];

/// What each model cannot do without; a file that names none is by the first.
pub const NEEDED: &[(&str, &[&str])] = &[
    ("physical", &["top_altitude_m", "ground_albedo", "layers"]),
    ("view_table", &["top_altitude_m", "ground_albedo", "layers"]),
    ("thickness", &["top_altitude_m"]),
    ("limb_table", &["top_altitude_m"]),
    ("gradient", &["top_altitude_m"]),
    ("none", &[]),
];

/// What a model cannot do without.
pub fn needed(model: &str) -> &'static [&'static str] {
    NEEDED.iter().find(|(word, _)| *word == model).map_or(&[], |(_, keys)| keys)
}

/// Where the three channels come from.
const SPECTRA: &[(&str, &str)] = &[
    ("rgb", "physical inputs at three wavelengths, mixed to the channels"),
    ("spectral", "physical inputs at every wavelength, seen through the eye's response"),
];

/// A layer.
pub const LAYER: &[Field] = &[
    may("name", Kind::Text, "what patches call it: `[layers.dust]` changes the layer named \"dust\""),
    may("scattering_per_m", PER_M, "scattering coefficient at density 1; red, green, blue"),
    may("absorption_per_m", PER_M, "absorption coefficient at density 1; red, green, blue"),
    may(
        "gas",
        Kind::Table(GAS),
        "in place of the coefficients: Rayleigh scattering from the gas's own numbers; needs no profile and no phase",
    ),
    may("aerosol", Kind::Table(AEROSOL), "in place of the coefficients: dust, droplets or smoke by their optical depth or their number"),
    may("absorber", Kind::Table(ABSORBER), "in place of the coefficients: a known absorber by its column; needs no phase"),
    may("table", Kind::Table(BY_WAVELENGTH), "in place of the coefficients: coefficients at many wavelengths"),
    may("profile", Kind::Variants(PROFILE), "density against altitude, relative to the coefficients"),
    may("phase", Kind::Variants(PHASE), "where scattered light goes"),
];

/// Ways to describe a layer.
pub const DESCRIBED: Ways = Ways {
    apart: &["scattering_per_m", "absorption_per_m", "gas", "aerosol", "absorber", "table"],
    each: &[
        &["scattering_per_m", "absorption_per_m", "profile", "phase"],
        &["gas"],
        &["aerosol", "profile", "phase"],
        &["absorber", "profile"],
        &["table", "profile", "phase"],
    ],
};

/// Tables that can be filled in several ways, by their path in the file.
pub const WAYS: &[(&str, Ways)] = &[
    ("layers", DESCRIBED),
    (
        "layers.gas",
        Ways {
            apart: &["molecules", "refractive_index", "molecular_density_per_m3", "pressure_pa"],
            each: &[
                &["molecules", "pressure_pa", "temperature_k"],
                &["molecules", "molecular_density_per_m3"],
                &["refractive_index", "pressure_pa", "temperature_k"],
                &["refractive_index", "molecular_density_per_m3"],
            ],
        },
    ),
    (
        "layers.aerosol",
        Ways {
            apart: &["optical_depth", "particle_density_per_m3"],
            each: &[&["optical_depth"], &["particle_density_per_m3", "particle_radius_m"]],
        },
    ),
];

/// A gas: the ranges are those of `engine::air::optics`.
const GAS: &[Field] = &[
    may("molecules", Kind::Shares(MOLECULES), "which, by number; the shares are scaled to 1"),
    may("refractive_index", Kind::OneOrRgb(Span::linear(1.0, 1.1)), "in place of `molecules`: of the gas at its density at the datum"),
    may("depolarisation", Kind::Number(Span::linear(0.0, 0.5)), "ratio for natural light, with `refractive_index`; 0 where it is left out"),
    may("molecular_density_per_m3", Kind::Number(Span::log(1.0e15, 1.0e29)), "molecules at the datum; or `pressure_pa`"),
    may("pressure_pa", Kind::Number(Span::log(1.0e-6, 1.0e9)), "at the datum; an ideal gas at `temperature_k`"),
    may("temperature_k", Kind::Number(Span::linear(1.0, 1.0e4)), "needed by `pressure_pa`, and by the scale height where it is left out"),
    may("molar_mass_kg_mol", Kind::Number(Span::log(1.0e-4, 1.0)), "that of `molecules` where it is left out"),
    may("scale_height_m", Kind::Number(Span::log(10.0, 1.0e6)), "R T / (M g) with the body's gravity where it is left out"),
];

/// Names of [`engine::air::optics::Molecule`].
const MOLECULES: &[&str] = &["air", "n2", "o2", "ar", "co2", "h2", "he", "ch4"];

/// An aerosol.
const AEROSOL: &[Field] = &[
    may("optical_depth", Kind::Number(Span::log(0.0, 1.0e3)), "of the layer, straight up, at 550 nm; or the particles"),
    may("particle_density_per_m3", Kind::Number(Span::log(0.0, 1.0e20)), "particles at density 1"),
    may("particle_radius_m", Kind::Number(Span::log(1.0e-10, 1.0e-2)), "of each"),
    may("efficiency", Kind::Number(Span::linear(0.0, 4.0)), "extinction over the particles' own cross-section; 2 where it is left out"),
    may(
        "angstrom_exponent",
        Kind::Number(Span::linear(-4.0, 4.0)),
        "extinction goes as the wavelength to minus this; 0, grey, where it is left out",
    ),
    must("single_scattering_albedo", Kind::OneOrRgb(Span::linear(0.0, 1.0)), "share that is scattered, not absorbed"),
];

/// An absorber that is known.
const ABSORBER: &[Field] = &[
    must("species", Kind::Choice(&[("ozone", "Chappuis band")]), "which"),
    must("column_du", Kind::Number(Span::log(0.0, 1.0e5)), "straight up, in Dobson units of 2.687e20 molecules per m²"),
];

/// Coefficients by wavelength.
const BY_WAVELENGTH: &[Field] = &[
    must("wavelengths_nm", Kind::Numbers(Span::linear(100.0, 1.0e5)), "rising"),
    must("scattering_per_m", Kind::Numbers(Span::log(0.0, 1.0)), "at each, at density 1"),
    must("absorption_per_m", Kind::Numbers(Span::log(0.0, 1.0)), "at each, at density 1"),
];

/// Densities against altitude.
const PROFILE: &[Variant] = &[
    Variant {
        word: "exponential",
        fields: &[must("scale_height_m", Kind::Number(Span::log(10.0, 1.0e6)), "altitude over which density falls to 1/e")],
        doc: "falls by a factor of e every scale height",
    },
    Variant {
        word: "tent",
        fields: &[
            must("bottom_m", ALTITUDE, "where it begins"),
            must("peak_m", ALTITUDE, "where density is 1"),
            must("top_m", ALTITUDE, "where it ends"),
        ],
        doc: "rises from 0 at the bottom to 1 at the peak and falls to 0 at the top",
    },
    Variant {
        word: "constant",
        fields: &[must("bottom_m", ALTITUDE, "where it begins"), must("top_m", ALTITUDE, "where it ends")],
        doc: "1 between two altitudes",
    },
    Variant {
        word: "table",
        fields: &[
            must("altitude_m", Kind::Numbers(Span::linear(-1.0e4, 1.0e7)), "altitudes, rising"),
            must("density", Kind::Numbers(Span::linear(0.0, 1.0e6)), "relative density at each"),
        ],
        doc: "linear between points, 0 above the last",
    },
];

/// The asymmetry of two phase functions.
const G: Field = must("g", Kind::Number(Span::linear(-0.99, 0.99)), "asymmetry: 1 forward, 0 even, −1 back");

/// Phase functions.
const PHASE: &[Variant] = &[
    Variant { word: "rayleigh", fields: &[], doc: "molecules" },
    Variant { word: "henyey_greenstein", fields: &[G], doc: "aerosol; g is the mean cosine" },
    Variant { word: "cornette_shanks", fields: &[G], doc: "aerosol, with Rayleigh's form where g is 0" },
    Variant { word: "elek_rayleigh", fields: &[], doc: "Elek's empirical function for molecules" },
    Variant { word: "isotropic", fields: &[], doc: "even to all sides" },
    Variant {
        word: "table",
        fields: &[
            must("angle_deg", Kind::Numbers(Span::linear(0.0, 180.0)), "scattering angles, rising"),
            must("value", Kind::Numbers(Span::log(0.0, 1.0e9)), "value at each, on any scale"),
        ],
        doc: "linear between points; scaled so that it holds all the light",
    },
];

/// Altitude where drag ends.
const DRAG_TOP: Field = must("drag_top_m", Kind::Number(Span::log(1.0, 1.0e8)), "altitude above which drag is neglected");

/// What drags.
const PHYSICS: &[Variant] = &[
    Variant { word: "us76", fields: &[DRAG_TOP], doc: "the US Standard Atmosphere 1976: Earth's" },
    Variant {
        word: "hydrostatic",
        fields: &[
            DRAG_TOP,
            must("temperature_k", Kind::Number(Span::linear(1.0, 1.0e4)), "at the datum"),
            must("pressure_pa", Kind::Number(Span::log(1.0e-9, 1.0e9)), "at the datum"),
            must("molar_mass_kg_mol", Kind::Number(Span::log(1.0e-4, 1.0)), "of the mixture"),
            must("heat_capacity_ratio", Kind::Number(Span::linear(1.0, 1.7)), "γ"),
            may("lapse", Kind::Tables(LAPSE), "stretches of constant lapse rate from the datum up; temperature is constant above the last"),
        ],
        doc: "an ideal gas in equilibrium under the body's own gravity",
    },
];

/// A stretch of [`PHYSICS`].
const LAPSE: &[Field] = &[
    must("to_altitude_m", Kind::Number(Span::linear(1.0, 1.0e7)), "geopotential altitude where it ends"),
    must("k_per_m", Kind::Number(Span::linear(-1.0, 1.0)), "change of temperature with altitude"),
];

/// Settings of the model `physical`: it needs none.
const PHYSICAL: &[Field] = &[];

/// Settings of the model `thickness`.
const THICKNESS: &[Field] = &[
    may("colour", SHARE, "of the air, linear sRGB"),
    may("brightness", Kind::Number(Span::log(0.0, 1000.0)), "of a lit way of one scale; 1 is a white surface that faces the sun"),
    may("shadow_share", Kind::Number(Span::linear(0.0, 1.0)), "how bright shadowed air is beside lit air"),
    may("scale_m", Kind::Number(Span::log(1.0, 1.0e15)), "width of air that counts as one; left out: the longest way in the shell"),
    may(
        "shadow",
        Kind::Choice(&[("cone", "the umbra"), ("cylinder", "as wide as the body all along")]),
        "the volume that counts as shadowed",
    ),
    may("opacity", Kind::Number(Span::log(0.0, 1000.0)), "optical depth of a way of one scale for what lies behind; 0 only adds light"),
];

/// Settings of the model `limb_table`.
const LIMB_TABLE: &[Field] = &[
    may("size", Kind::Whole(Span::log(8.0, 1024.0)), "texels of the table each way"),
    may("light_scale_per_sr", Kind::Rgb(Span::log(0.0, 1000.0)), "what one planet radius of air of density 1 sends"),
    may("march_step_radii", Kind::Number(Span::log(1.0e-5, 1.0)), "longest step of the bake, planet radii"),
    may("density_exponent", Kind::Number(Span::linear(0.0, 32.0)), "n in the density (1 − h)ⁿ"),
];

/// Settings of the model `view_table`.
const VIEW_TABLE: &[Field] = &[
    may("height_size", Kind::Whole(Span::log(2.0, 256.0)), "heights of the table"),
    may("view_size", Kind::Whole(Span::log(4.0, 256.0)), "view angles of the table"),
    may("sun_size", Kind::Whole(Span::log(2.0, 256.0)), "sun angles of the table"),
    may("depth_height_size", Kind::Whole(Span::log(2.0, 1024.0)), "heights of the table of optical depth"),
    may("depth_angle_size", Kind::Whole(Span::log(2.0, 1024.0)), "angles of the table of optical depth"),
    may("ambient_size", Kind::Whole(Span::log(2.0, 1024.0)), "sun angles of the table of the sky's light"),
    may("samples", Kind::Whole(Span::log(2.0, 500.0)), "samples along a ray of sight"),
    may("depth_samples", Kind::Whole(Span::log(2.0, 500.0)), "samples of an optical depth"),
    may("ambient_samples", Kind::Whole(Span::log(2.0, 128.0)), "directions of the sky's light, each way"),
    may(
        "spacing",
        Kind::Choice(&[
            ("graded", "dense at the horizon, the ground and the terminator"),
            ("uniform", "even in height and angles, as in the thesis"),
        ]),
        "how table entries and samples lie",
    ),
    may(
        "alpha_colour",
        Kind::Choice(&[("proportional", "reddened as the air beside it is"), ("grey", "the particles' own colour, as in the thesis")]),
        "how the aerosol's light gets its colour",
    ),
];

/// The keys of [`GRADIENT`] that name pictures: of the shell, of the ground.
pub const MAPS: [&str; 2] = ["shell_map", "ground_map"];

/// Settings of the model `gradient`.
const GRADIENT: &[Field] = &[
    may("stretch", Kind::Number(Span::linear(0.0, 2.0)), "by how much day reaches beyond the terminator: where sunset begins"),
    may("fade_stretch", Kind::Number(Span::linear(0.0, 2.0)), "by how much more the air is seen at all"),
    may("visibility_m", Kind::Number(Span::log(1.0, 1.0e9)), "ground nearer than this is clear"),
    may("transparency", Kind::Number(Span::linear(0.0, 1.0)), "how strong the air's colour can become over the ground"),
    may("brightness", Kind::Number(Span::log(0.0, 100.0)), "of the map's white; 1 is a white surface that faces the sun"),
    may("opacity", Kind::Number(Span::linear(0.0, 1.0)), "how much of the sky behind the shell is hidden where it is strongest"),
    may(
        MAPS[0],
        Kind::File,
        "PNG, 32 × 16 texels as a rule. Left: away from the sun, right: toward it; bottom: at the surface, top: at the edge",
    ),
    may(
        MAPS[1],
        Kind::File,
        "PNG, 32 × 2 texels. Top row: the air's colour; bottom row: by what the sun's is multiplied. Left: midnight, right: noon",
    ),
];

/// A bank of fog, or a nebula.
pub const FOG: &[Field] = &[
    may("name", Kind::Text, "what patches call it"),
    must("latitude_deg", Kind::Number(Span::linear(-90.0, 90.0)), "of its centre, planetocentric"),
    must("longitude_deg", Kind::Number(Span::linear(-360.0, 360.0)), "of its centre, east"),
    must("altitude_m", Kind::Number(Span::log(-1.0e4, 1.0e13)), "of its centre, above the datum"),
    must("radius_m", Kind::Number(Span::log(1.0, 1.0e13)), "of the ball"),
    may("thickness", Kind::Table(THICKNESS), "how it looks: as the model \"thickness\"; `scale_m` is its diameter where it is left out"),
];
