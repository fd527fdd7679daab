//! Layers by what they are made of: `gas`, `aerosol`, `absorber` and `table`, in place of three coefficients. The physics is the engine's
//! ([`engine::air::optics`]); here its numbers are read.

use super::layers::typed;
use super::{Datum, keys};
use crate::assets::fault::Fault;
use crate::assets::reader::{ANY, Reader};
use engine::air::optics::{Aerosol, Amount, Gas, Load, Molecule, Refraction};
use engine::air::spectral::{Optics, SpectralLayer};
use engine::air::{Phase, Profile};
use engine::space::relative::narrow;
use engine::units::NM;

/// The keys that each describe a layer in full; one of them is needed.
pub const KINDS: [&str; 4] = ["gas", "aerosol", "absorber", "table"];

/// What three numbers of a file hold for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channels {
    /// Wavelengths of red, green and blue, m.
    pub wavelengths_m: [f64; 3],
}

impl Channels {
    /// One number for all wavelengths, or one for each channel, by rising wavelength.
    fn curve(self, r: &Reader<'_>, key: &'static str) -> Vec<(f64, f64)> {
        let [red, green, blue] = self.wavelengths_m;
        if r.node.get(key).is_some_and(|e| matches!(e.value.data, crate::assets::tree::Data::Array(_))) {
            let [r, g, b] = r.numbers(key, ANY);
            vec![(blue, b), (green, g), (red, r)]
        } else {
            vec![(green, r.number(key, ANY))]
        }
    }
}

/// A layer that is not given by coefficients; `None` stands for faults, which are written down.
pub fn read(t: &Reader<'_>, datum: Datum, channels: Channels) -> Option<SpectralLayer> {
    let described: Vec<&str> = KINDS.into_iter().filter(|k| t.has(k)).collect();
    if described.len() > 1 || t.has("scattering_per_m") || t.has("absorption_per_m") {
        let all = described.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(" and ");
        let expected = "expected one of `gas`, `aerosol`, `absorber`, `table`, or `scattering_per_m` with `absorption_per_m`";
        // Told at what was written last: by a patch, where one is to blame.
        let given: Vec<&str> = keys::DESCRIBED.apart.iter().copied().filter(|key| t.node.get(key).is_some()).collect();
        let patched = given.iter().find(|key| t.node.place_of(key).source.path != t.node.at.source.path);
        let at = t.node.place_of(patched.or(described.first()).copied().unwrap_or_default());
        let help =
            format!("in a patch, `remove = [\"{}\"]` takes out what the file below it has", described.first().copied().unwrap_or("gas"));
        t.fault(Fault::at(&at, format!("{all}: a layer is described twice: {expected}")).help(patched.map(|_| help)));
        return None;
    }
    let kind = described.first().copied()?;
    let r = t.table(kind)?;
    let optics = match kind {
        "gas" => Optics::Gas(gas(&r, channels)?),
        "aerosol" => Optics::Aerosol(aerosol(&r, channels)?),
        "absorber" => Optics::Ozone(r.number("column_du", ANY)),
        _ => Optics::Table(table(&r)?),
    };
    let profile = match &optics {
        Optics::Gas(gas) if !t.has("profile") => {
            Some(Profile::Exponential { scale_height_m: narrow(gas.scale_height_m(datum.gravity_m_s2)) })
        }
        _ => typed::<Profile>(t, "profile", "a table with the `kind` of profile"),
    };
    let phase = match &optics {
        Optics::Gas(_) | Optics::Ozone(_) if !t.has("phase") => Some(Phase::Rayleigh),
        _ => typed::<Phase>(t, "phase", "a table with the `kind` of phase function"),
    };
    Some(SpectralLayer { optics, profile: profile?, phase: phase? })
}

/// Which of two keys is there; both or none is a fault.
fn one_of(r: &Reader<'_>, one: &'static str, other: &'static str) -> Option<&'static str> {
    match (r.has(one), r.has(other)) {
        (true, false) => Some(one),
        (false, true) => Some(other),
        (both, _) => {
            let found = if both { "both are given" } else { "neither is given" };
            let place = r.node.at.clone();
            r.fault(Fault::at(&place, format!("`{one}` or `{other}`: {found}: expected one of the two")));
            None
        }
    }
}

fn gas(r: &Reader<'_>, channels: Channels) -> Option<Gas> {
    let refraction = match one_of(r, "molecules", "refractive_index")? {
        "molecules" => {
            let shares = r.table("molecules")?;
            let share = |(name, molecule): (&'static str, Molecule)| shares.maybe_number(name, ANY).map(|share| (molecule, share));
            let all: Vec<(Molecule, f64)> = Molecule::NAMES.into_iter().filter_map(share).collect();
            if all.iter().map(|m| m.1).sum::<f64>() <= 0.0 {
                let known = Molecule::NAMES.map(|m| m.0).join(", ");
                r.wrong("molecules", format!("`molecules`: expected a share above 0 of at least one of {known}"));
                return None;
            }
            Refraction::Molecules(all)
        }
        _ => Refraction::Index {
            index: channels.curve(r, "refractive_index"),
            depolarisation: r.maybe_number("depolarisation", ANY).unwrap_or(0.0),
        },
    };
    let amount = match one_of(r, "molecular_density_per_m3", "pressure_pa")? {
        "pressure_pa" => Amount::Pressure(r.number("pressure_pa", ANY)),
        key => Amount::MolecularDensity(r.number(key, ANY)),
    };
    let scale_height_m = r.maybe_number("scale_height_m", ANY);
    let molar_mass_kg_mol = r.maybe_number("molar_mass_kg_mol", ANY);
    let needs_temperature = scale_height_m.is_none() || matches!(amount, Amount::Pressure(_));
    let temperature_k = if needs_temperature { r.number("temperature_k", ANY) } else { f64::NAN };
    if needs_temperature && temperature_k.is_nan() {
        return None;
    }
    if scale_height_m.is_none() && molar_mass_kg_mol.is_none() && matches!(refraction, Refraction::Index { .. }) {
        r.number("molar_mass_kg_mol", ANY);
        return None;
    }
    Some(Gas { refraction, amount, temperature_k, molar_mass_kg_mol, scale_height_m })
}

fn aerosol(r: &Reader<'_>, channels: Channels) -> Option<Aerosol> {
    let load = match one_of(r, "optical_depth", "particle_density_per_m3")? {
        "optical_depth" => Load::OpticalDepth(r.number("optical_depth", ANY)),
        key => Load::Particles {
            density_per_m3: r.number(key, ANY),
            radius_m: r.number("particle_radius_m", ANY),
            efficiency: r.maybe_number("efficiency", ANY).unwrap_or(2.0),
        },
    };
    Some(Aerosol {
        load,
        angstrom_exponent: r.maybe_number("angstrom_exponent", ANY).unwrap_or(0.0),
        single_scattering_albedo: channels.curve(r, "single_scattering_albedo"),
    })
}

fn table(r: &Reader<'_>) -> Option<Vec<[f64; 3]>> {
    let [wavelengths_nm, scattering, absorption] = ["wavelengths_nm", "scattering_per_m", "absorption_per_m"].map(|key| r.series(key, ANY));
    if scattering.len() != wavelengths_nm.len() || absorption.len() != wavelengths_nm.len() {
        let counts = format!("{} wavelengths, {} and {} coefficients", wavelengths_nm.len(), scattering.len(), absorption.len());
        r.wrong("wavelengths_nm", format!("[table]: {counts}: expected as many of each"));
        return None;
    }
    Some(wavelengths_nm.iter().zip(scattering).zip(absorption).map(|((nm, s), a)| [nm * NM, s, a]).collect())
}
