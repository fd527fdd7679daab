//! Whether an air can be what was meant: nothing here is an error, since a game may have any air that it likes. Told as warnings, at the
//! line that is suspected, with the figure that is odd and what it would be on a world like ours.

use crate::assets::fault::Fault;
use crate::assets::tree::{Data, Node};
use engine::air::optics::BOLTZMANN_J_K;
use engine::air::{Air, Column, Layer, Model, Phase};
use engine::space::relative::narrow;
use glam::DVec3;

/// Vertical optical depth beyond which even the sun is nowhere to be seen from the ground: Venus's clouds have 30.
const ABSURD_DEPTH: f64 = 100.0;
/// Vertical optical depth that a layer may well have: a thousand times as much is a value per kilometre.
const THICK_DEPTH: f64 = 5.0;
/// Optical depth of a grazing ray at the top beyond which the air visibly ends there.
const EDGE_DEPTH: f64 = 0.01;
/// Factor between a molecular layer's scale height and that of the gas that drags.
const SCALE_FACTOR: f64 = 1.5;
/// Factor between the density of a gas that is seen and that of the one that drags.
const AMOUNT_FACTOR: f64 = 1.25;
/// Steps of the sums over altitude.
const STEPS: u32 = 400;

/// Suspicions about an air. `tree` is its file, for the places; `gravity_m_s2` that at the datum.
pub fn suspicions(tree: &Node, look: &Air, column: Option<&Column>, gravity_m_s2: f64) -> Vec<Fault> {
    let mut found = Vec::new();
    let mut tell = |place: &str, message: String, help: &str| {
        found.push(Fault::warning(&tree.place_of(place), message).help(Some(help.to_owned())));
    };
    let medium = &look.medium;
    let layers: &[Node] = match tree.get("layers").map(|e| &e.value.data) {
        Some(Data::Array(layers)) => layers,
        _ => &[],
    };
    let (mut total, mut thickest) = (DVec3::ZERO, (0.0, "layers".to_owned()));
    for (i, layer) in medium.layers.iter().enumerate() {
        let column_m = column_m(layer, medium.top_altitude_m);
        let extinction = (layer.scattering_per_m + layer.absorption_per_m).as_dvec3();
        let depth = extinction * column_m;
        let written = layers.get(i);
        let name =
            written.and_then(|n| n.get("name")).and_then(|e| e.value.text()).map_or_else(|| format!("layer {i}"), |n| format!("`{n}`"));
        let place = format!("layers[{i}].{}", amount(written, layer));
        // Only coefficients have a length in them that could be another one.
        let by_coefficients = written.and_then(|n| n.get("scattering_per_m").or(n.get("table"))).is_some();
        let per_km = by_coefficients && (ABSURD_DEPTH..1000.0 * THICK_DEPTH).contains(&depth.max_element());
        if per_km {
            tell(
                &place,
                format!("vertical optical depth {:.3} of this layer: the coefficients look like values per kilometre", depth.max_element()),
                "expected m⁻¹: a thousandth of a value in km⁻¹",
            );
        } else {
            total += depth;
            if depth.max_element() > thickest.0 {
                thickest = (depth.max_element(), place);
            }
            // Of coefficients that are a thousand times too large every altitude would be an edge.
            hard_edge(layer, &name, medium.bottom_radius_m, medium.top_altitude_m, &mut tell);
        }
        if let Phase::Table { angle_deg, .. } = &layer.phase {
            let ends = (angle_deg.first().copied().unwrap_or(0.0), angle_deg.last().copied().unwrap_or(180.0));
            if ends.0 > 0.0 || ends.1 < 180.0 {
                tell(
                    &format!("layers[{i}].phase.angle_deg"),
                    format!("a phase function from {}° to {}°: beyond its ends the values there hold on", ends.0, ends.1),
                    "scattering angles run from 0°, straight on, to 180°, straight back",
                );
            }
        }
        let s = layer.scattering_per_m;
        if matches!(layer.phase, Phase::Rayleigh | Phase::ElekRayleigh) && s.x > 1.05 * s.z && s.z > 0.0 {
            tell(
                &format!("layers[{i}].scattering_per_m"),
                "molecules that scatter more red than blue".to_owned(),
                "the order of the channels is red, green, blue; molecules scatter as the wavelength to the power of −4",
            );
        }
        if let Some(column) = column {
            wrong_amount(tree, i, column, &mut tell);
            wrong_scale(layer, i, column, gravity_m_s2, &mut tell);
        }
    }
    if total.max_element() > ABSURD_DEPTH {
        tell(
            &thickest.1,
            format!("vertical optical depth {:.3} of all layers: no light comes through", total.max_element()),
            "Venus's clouds have about 30",
        );
    }
    let lit_by_layers = matches!(look.model, Model::Physical(_) | Model::ViewTable(_));
    if lit_by_layers && total == DVec3::ZERO && found.is_empty() && column.is_some_and(|c| c.at(0.0).density_kg_m3 > 0.0) {
        let unseen = "this air drags and is not seen: no layer scatters or absorbs".to_owned();
        found.push(Fault::warning(&tree.place_of("layers"), unseen).help(Some("`model = \"none\"` says that it is meant".to_owned())));
    }
    found
}

/// The key by which a layer is as thick as it is.
fn amount(written: Option<&Node>, layer: &Layer) -> &'static str {
    let strongest =
        if depth_of(layer.absorption_per_m) > depth_of(layer.scattering_per_m) { "absorption_per_m" } else { "scattering_per_m" };
    let keys = [
        strongest,
        "table.scattering_per_m",
        "aerosol.optical_depth",
        "aerosol.particle_density_per_m3",
        "absorber.column_du",
        "gas.pressure_pa",
        "gas.molecular_density_per_m3",
    ];
    let there = |key: &&str| {
        let mut parts = key.split('.');
        written.is_some_and(|node| parts.try_fold(node, |at, part| at.get(part).map(|e| &e.value)).is_some())
    };
    keys.into_iter().find(there).unwrap_or(strongest)
}

fn depth_of(v: glam::Vec3) -> f64 {
    f64::from(v.max_element())
}

/// Height of air at density 1 that holds a layer's matter above the datum, m.
pub fn column_m(layer: &Layer, top_m: f64) -> f64 {
    let step = top_m / f64::from(STEPS);
    (0..STEPS).map(|i| layer.profile.density((f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

/// Air that is not negligible at the top ends there in a visible edge.
fn hard_edge(layer: &Layer, name: &str, radius_m: f64, top_m: f64, tell: &mut impl FnMut(&str, String, &str)) {
    let density = layer.profile.density(top_m * (1.0 - 1e-9));
    let extinction = depth_of(layer.scattering_per_m + layer.absorption_per_m);
    // A ray that grazes the shell one hundredth below the top.
    let way = 2.0 * (2.0 * (radius_m + top_m) * 0.01 * top_m).sqrt();
    let depth = extinction * density * way;
    if depth > EDGE_DEPTH {
        let percent = 100.0 * density;
        let share = if percent < 0.1 { format!("{percent:.0e}") } else { format!("{percent:.1}") };
        tell(
            "top_altitude_m",
            format!("a hard edge: {name} still has {share} % of its density at the top (grazing optical depth {depth:.2})"),
            "raise the top, or lower the scale height: an exponential layer wants a top of about 12 scale heights",
        );
    }
}

/// A gas of another density than the one that drags.
fn wrong_amount(tree: &Node, i: usize, column: &Column, tell: &mut impl FnMut(&str, String, &str)) {
    let Some(Data::Array(layers)) = tree.get("layers").map(|e| &e.value.data) else { return };
    let Some(gas) = layers.get(i).and_then(|l| l.get("gas")) else { return };
    let number = |key: &str| match gas.value.get(key).map(|e| &e.value.data) {
        Some(Data::Number(x)) => Some(*x),
        _ => None,
    };
    let low = column.at(0.0);
    let (key, seen) = match (number("molecular_density_per_m3"), number("pressure_pa"), number("temperature_k")) {
        (Some(n), ..) => ("molecular_density_per_m3", n),
        (None, Some(p), Some(t)) => ("pressure_pa", p / (BOLTZMANN_J_K * t)),
        _ => return,
    };
    let drags = low.pressure_pa / (BOLTZMANN_J_K * low.temperature_k);
    if drags > 0.0 && !(1.0 / AMOUNT_FACTOR..=AMOUNT_FACTOR).contains(&(seen / drags)) {
        tell(
            &format!("layers[{i}].gas.{key}"),
            format!("{seen:.2e} molecules per m³ are seen, {drags:.2e} drag: p ≠ ρ R T / M for one of them"),
            "molecules and the gas that drags are one: give both the same pressure and temperature",
        );
    }
}

/// A molecular layer that does not fall off as the gas that drags does: p, ρ and T would not belong together.
fn wrong_scale(layer: &Layer, i: usize, column: &Column, gravity_m_s2: f64, tell: &mut impl FnMut(&str, String, &str)) {
    let engine::air::Profile::Exponential { scale_height_m } = layer.profile else { return };
    let low = column.at(0.0);
    let scatters = layer.scattering_per_m.max_element() > 0.0 && matches!(layer.phase, Phase::Rayleigh | Phase::ElekRayleigh);
    if !scatters || low.density_kg_m3 <= 0.0 || gravity_m_s2 <= 0.0 {
        return;
    }
    let hydrostatic = low.pressure_pa / (low.density_kg_m3 * gravity_m_s2);
    let ratio = f64::from(scale_height_m) / hydrostatic;
    if !(1.0 / SCALE_FACTOR..=SCALE_FACTOR).contains(&ratio) {
        tell(
            &format!("layers[{i}].profile.scale_height_m"),
            format!(
                "scale height {scale_height_m} m, but the gas of [physics] has p/(ρ g) = {:.0} m at the datum: p ≠ ρ R T / M for one of them",
                narrow(hydrostatic)
            ),
            "molecules and the gas that drags are one: give both the same temperature and molar mass",
        );
    }
}
