//! The shipped Earth at named places: heights that everyone knows, land that is land, sea that is sea.
//! The relief picture averages over 20 km, so a summit stands for its massif.

use engine::terrain::CubeMap;
use engine::terrain::{Maps, Relief};
use engine::units::DEG;
use std::path::Path;
use std::sync::Arc;

fn earth() -> Relief {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/bodies/earth");
    let text = std::fs::read_to_string(folder.join("body.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let mut relief = table["relief"].as_table().unwrap().clone();
    relief.remove("relief_max");
    let mut spec: engine::terrain::ReliefSpec = relief.try_into().unwrap();
    (spec.colour, spec.night) = (None, None);
    let cube = |name: &Option<String>| {
        let file = folder.join(name.as_ref().expect("the Earth has maps"));
        Some(Arc::new(CubeMap::read(&std::fs::read(file).unwrap()).unwrap()))
    };
    let maps = Maps { height: cube(&spec.map), coast: cube(&spec.coast), ..Maps::default() };
    Relief::new(6.371_008_4e6, spec, maps).unwrap()
}

#[test]
fn named_places_are_where_they_are() {
    let earth = earth();
    let places = [
        ("Mont Blanc massif", 45.83, 6.86, 1800.0, 5000.0),
        ("Everest massif", 27.99, 86.93, 4000.0, 9000.0),
        ("Aconcagua massif", -32.65, -70.01, 2500.0, 7000.0),
        ("Tibet", 33.0, 88.0, 4200.0, 6200.0),
        ("Altiplano", -19.5, -67.5, 3200.0, 4800.0),
        ("Antarctic plateau", -80.0, 90.0, 2500.0, 4500.0),
        ("Greenland's ice", 72.0, -40.0, 2200.0, 3800.0),
        ("Sahara", 24.0, 5.0, 150.0, 1500.0),
        ("Kansas", 38.5, -98.5, 350.0, 750.0),
        ("Iceland", 64.8, -18.5, 300.0, 1700.0),
        ("Dead Sea, dry to the eye", 31.5, 35.5, 0.0, 900.0),
        ("Cape Canaveral", 28.55, -80.65, 0.0, 60.0),
        ("Indian River beside it", 28.55, -80.75, -20.0, 0.0),
        ("Challenger Deep", 11.35, 142.2, -11_500.0, -6000.0),
        ("Puerto Rico trench", 19.7, -66.5, -9000.0, -5500.0),
        ("Mid-Atlantic", 25.0, -30.0, -7000.0, -3500.0),
        ("Channel", 50.2, -1.5, -500.0, -1.0),
        ("Mediterranean", 37.5, 5.0, -4000.0, -1500.0),
        ("Gibraltar strait, west", 35.9, -6.3, -2000.0, -1.0),
    ];
    let mut wrong = Vec::new();
    for (name, lat, lon, low, high) in places {
        let h = earth.height_at_lat_lon(lat * DEG, lon * DEG);
        println!("{name}: {h:.1} m");
        if !(low..=high).contains(&h) {
            wrong.push(format!("{name}: {h:.1} m, expected {low} … {high}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
