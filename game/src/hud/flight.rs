//! The flight HUD: speed, heights, orbit, ball, bars, warp, holds, guidance, warnings.

use super::panels::{area, bar, row};
use super::{Reply, Scene, ball, format, markers, style};
use crate::command::{Action, Guidance, Hold, WARP_ONE, WARP_QUARTERS};
use crate::input::climb;
use crate::settings::Settings;
use crate::world::eclipse::almanac;
use crate::world::readout::{Readout, Situation, Warning};
use egui::{Align2, Color32, Pos2, Rect, RichText, Sense, Ui, Vec2};
use engine::space::relative::narrow;
use engine::units::DAY;

/// What the pilot chose to see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// Speed over the ground or about the body; by itself unless clicked.
    pub speed: Option<SpeedOver>,
}

/// What speed is measured against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedOver {
    /// The body's centre, inertial.
    Orbit,
    /// The turning ground.
    Surface,
}

const WIDTH: f32 = 190.0;
const BALL: f32 = 84.0;

/// Everything on the flight screen.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, state: &mut State, settings: &Settings, reply: &mut Reply) {
    let opacity = settings.hud.panel_opacity;
    if settings.hud.markers {
        let painter = ctx.layer_painter(egui::LayerId::background());
        markers::draw(&painter, ctx.content_rect(), scene);
    }
    clock(ctx, scene, opacity, reply);
    warnings(ctx, scene.readout);
    area(ctx, "flight", Align2::LEFT_TOP, [12.0, 12.0], |ui| style::panel(opacity).show(ui, |ui| flight(ui, scene)));
    area(ctx, "orbit", Align2::RIGHT_TOP, [-12.0, 12.0], |ui| style::panel(opacity).show(ui, |ui| orbit(ui, scene)));
    area(ctx, "holds", Align2::LEFT_BOTTOM, [12.0, -12.0], |ui| style::panel(opacity).show(ui, |ui| holds(ui, scene.readout, reply)));
    area(ctx, "guidance", Align2::RIGHT_BOTTOM, [-12.0, -12.0], |ui| {
        style::panel(opacity).show(ui, |ui| guidance(ui, scene.readout, reply));
    });
    area(ctx, "ball", Align2::CENTER_BOTTOM, [0.0, -10.0], |ui| middle(ui, scene.readout, state, opacity));
}

/// The part at the top: date, warp, situation, eclipse.
pub fn clock(ctx: &egui::Context, scene: &Scene<'_>, opacity: f32, reply: &mut Reply) {
    let r = scene.readout;
    area(ctx, "clock", Align2::CENTER_TOP, [0.0, 12.0], |ui| {
        style::panel(opacity).show(ui, |ui| {
            ui.vertical_centered(|ui| {
                ui.label(RichText::new(r.time.utc().to_string()).font(style::mono(15.0)).color(style::TEXT));
                warp(ui, r, reply);
                let place = format!("{} · {}", scene.name(r.body), situation(r.situation));
                ui.label(RichText::new(place).font(style::words(12.0)).color(style::DIM));
                if r.sun_visible < 0.9995 && r.sun_visible.is_finite() {
                    let hidden = (1.0 - r.sun_visible) * 100.0;
                    let by = r.eclipsed_by.map_or_else(String::new, |b| format!(" by {}", scene.name(b)));
                    let text = if hidden > 99.95 { format!("Sun hidden{by}") } else { format!("Sun {hidden:.0} % hidden{by}") };
                    ui.label(RichText::new(text).font(style::words(13.0)).color(style::ACCENT));
                }
                if let Some(text) = eclipse(scene) {
                    ui.label(RichText::new(text).font(style::words(12.5)).color(style::ACCENT));
                }
            });
        });
    });
}

/// `Total eclipse: Moon before Sun, 3:12 to greatest`: the event in force or to come within a day.
fn eclipse(scene: &Scene<'_>) -> Option<String> {
    let e = scene.readout.eclipse.filter(|e| e.to_first_s < DAY)?;
    let title = almanac::title(&scene.world.system, &e.event);
    let when = match e.to_greatest_s {
        s if s > 0.0 => format!("{} to greatest", format::duration(s)),
        _ => format!("ends in {}", format::duration(e.to_last_s)),
    };
    Some(format!("{title}, {when}"))
}

const fn situation(s: Situation) -> &'static str {
    match s {
        Situation::Coasting => "coasting",
        Situation::Flying => "flying",
        Situation::Contact => "near the ground",
        Situation::Landed => "landed",
        Situation::Crashed => "crashed",
    }
}

/// Warp: one small arrow a level; those above what the World allows now stay dim.
fn warp(ui: &mut Ui, r: &Readout, reply: &mut Reply) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        for level in 0..u8::try_from(WARP_QUARTERS.len()).unwrap_or(0) {
            let (rect, response) = ui.allocate_exact_size(Vec2::new(15.0, 16.0), Sense::click());
            let colour = match level {
                _ if level <= r.warp && level >= WARP_ONE => style::ACCENT,
                _ if level == r.warp => Color32::from_rgb(120, 180, 255),
                _ if level <= r.warp_asked && level > r.warp => style::ACCENT.gamma_multiply(0.35),
                _ => Color32::from_white_alpha(if response.hovered() { 110 } else { 45 }),
            };
            let c = rect.center();
            let points = vec![c + Vec2::new(-4.0, -5.0), c + Vec2::new(5.0, 0.0), c + Vec2::new(-4.0, 5.0)];
            ui.painter().add(egui::Shape::convex_polygon(points, colour, egui::Stroke::NONE));
            if response.on_hover_text(format::warp(level)).clicked() {
                reply.actions.push(Action::Warp(level));
            }
        }
        let (rect, _) = ui.allocate_exact_size(Vec2::new(66.0, 16.0), Sense::hover());
        ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, format::warp(r.warp), style::mono(13.0), style::TEXT);
    });
}

fn flight(ui: &mut Ui, scene: &Scene<'_>) {
    let r = scene.readout;
    let limits = &scene.world.ship.spec.limits;
    let against = |value: f64, limit: f64| match value / limit {
        x if x > 1.0 => style::DANGER,
        x if x > 0.7 => style::ACCENT,
        _ => style::TEXT,
    };
    ui.label(style::heading("Flight"));
    row(ui, WIDTH, "Above sea", &format::length(r.altitude_m), style::TEXT);
    let above_ground = r.altitude_m - r.ground_m;
    row(ui, WIDTH, "Above ground", &format::length(above_ground), style::TEXT);
    let falling = r.vertical_speed_m_s < -5.0 && above_ground < -8.0 * r.vertical_speed_m_s;
    row(ui, WIDTH, "Vertical", &signed_speed(r.vertical_speed_m_s), if falling { style::DANGER } else { style::TEXT });
    row(ui, WIDTH, "Heading", &format::heading(r.heading_pitch_roll_rad[0]), style::TEXT);
    let [_, pitch, roll] = r.heading_pitch_roll_rad.map(f64::to_degrees);
    row(ui, WIDTH, "Pitch · roll", &format!("{}° {}°", format::number(pitch, 0), format::number(roll, 0)), style::TEXT);
    row(ui, WIDTH, "Felt", &format!("{} g", format::number(r.load_g, 2)), against(r.load_g, limits.load_g));
    if r.density_kg_m3 > 0.0 {
        let q = r.dynamic_pressure_pa;
        row(ui, WIDTH, "Dyn. pressure", &format::pressure(q), against(q, limits.dynamic_pressure_pa));
        row(ui, WIDTH, "Mach", &format::number(r.mach, 2), style::TEXT);
        row(ui, WIDTH, "Heat flux", &format::flux(r.heat_flux_w_m2), against(r.heat_flux_w_m2, limits.heat_flux_w_m2));
    }
    row(ui, WIDTH, "Place", "", style::TEXT);
    let (rect, _) = ui.allocate_exact_size(Vec2::new(WIDTH, 14.0), Sense::hover());
    let place = format::place(r.lat_lon_rad.0, r.lat_lon_rad.1);
    ui.painter().text(rect.right_center(), Align2::RIGHT_CENTER, place, style::mono(12.0), style::TEXT);
}

fn signed_speed(m_s: f64) -> String {
    let text = format::speed(m_s);
    if m_s >= 0.05 && m_s.is_finite() { format!("+{text}") } else { text }
}

fn orbit(ui: &mut Ui, scene: &Scene<'_>) {
    let r = scene.readout;
    let o = &r.orbit;
    ui.label(style::heading("Orbit"));
    row(ui, WIDTH, "Apoapsis", &format::length(o.apoapsis_m), style::TEXT);
    // A circle has no apsides: their times would jump about.
    let circle = o.eccentricity < 3e-5;
    let time = |s: f64| if circle { format::NONE.to_owned() } else { format::duration(s) };
    row(ui, WIDTH, "    in", &time(o.to_apoapsis_s), style::DIM);
    row(ui, WIDTH, "Periapsis", &format::length(o.periapsis_m), if o.periapsis_m < 0.0 { style::ACCENT } else { style::TEXT });
    row(ui, WIDTH, "    in", &time(o.to_periapsis_s), style::DIM);
    row(ui, WIDTH, "Period", &format::duration(o.period_s), style::TEXT);
    row(ui, WIDTH, "Inclination", &format!("{}°", format::number(o.inclination_rad.to_degrees(), 2)), style::TEXT);
    row(ui, WIDTH, "Eccentricity", &format::number(o.eccentricity, 4), style::TEXT);
    row(ui, WIDTH, "Delta-v", &format!("{} km/s", format::number(r.delta_v_m_s / 1e3, 2)), style::TEXT);
    if let Some(n) = &r.node {
        ui.add_space(4.0);
        ui.label(style::heading("Planned burn"));
        row(ui, WIDTH, if n.to_burn_s < 0.0 { "Began" } else { "Begins in" }, &format::duration(n.to_burn_s), style::TEXT);
        row(ui, WIDTH, "Left", &format::speed(n.left_m_s), if n.left_m_s > r.delta_v_m_s { style::DANGER } else { style::TEXT });
        row(ui, WIDTH, "Burn", &format!("{} s", format::number(n.burn_s, 1)), style::TEXT);
    }
    let Some(t) = &r.target else { return };
    ui.add_space(4.0);
    ui.label(style::heading("Target"));
    row(ui, WIDTH, scene.name(t.target.body), &format::length(t.distance_m), style::TEXT);
    row(ui, WIDTH, "Closing", &format::speed(-t.closing_m_s), style::TEXT);
    if let Some(spot) = t.target.spot {
        let rad = |udeg: i32| (f64::from(udeg) * 1e-6).to_radians();
        row(ui, WIDTH, &format::place(rad(spot.lat_udeg), rad(spot.lon_udeg)), "", style::TEXT);
        if let Some(ground) = t.ground_distance_m {
            row(ui, WIDTH, "Over ground", &format::length(ground), style::TEXT);
        }
    }
}

fn holds(ui: &mut Ui, r: &Readout, reply: &mut Reply) {
    const ROWS: [&[(Hold, &str)]; 4] = [
        &[(Hold::Rate, "Rate"), (Hold::KillRotation, "Kill"), (Hold::Free, "Free"), (Hold::SurfaceVertical, "Level")],
        &[(Hold::Prograde, "Pro"), (Hold::Retrograde, "Retro"), (Hold::Normal, "Nml"), (Hold::AntiNormal, "A-nml")],
        &[(Hold::RadialOut, "Rad +"), (Hold::RadialIn, "Rad −"), (Hold::Target, "Target"), (Hold::Node, "Burn")],
        &[(Hold::SurfacePrograde, "Srf pro"), (Hold::SurfaceRetrograde, "Srf retro")],
    ];
    ui.label(style::heading("Hold"));
    for holds in ROWS {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (hold, name) in holds {
                if style::toggle(ui, r.hold == *hold, name).clicked() {
                    reply.actions.push(Action::Hold(*hold));
                }
            }
        });
    }
}

fn guidance(ui: &mut Ui, r: &Readout, reply: &mut Reply) {
    ui.label(style::heading("Guidance"));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (choice, name) in [(Guidance::Manual, "Manual"), (Guidance::Hover, "Hover"), (Guidance::Land, "Land"), (Guidance::Node, "Burn")]
        {
            if style::toggle(ui, r.guidance == choice, name).clicked() {
                reply.actions.push(Action::Guidance(choice));
            }
        }
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let held = match r.guidance {
            Guidance::VerticalSpeed { cm_s } => Some(cm_s),
            _ => None,
        };
        if style::toggle(ui, false, " − ").clicked() {
            reply.actions.push(Action::Guidance(climb(r, -1)));
        }
        let text = held.map_or_else(|| "V/S".to_owned(), |cm| format!("V/S {:+.0} m/s", f64::from(cm) / 100.0));
        if style::toggle(ui, held.is_some(), &text).clicked() && held.is_none() {
            reply.actions.push(Action::Guidance(climb(r, 0)));
        }
        if style::toggle(ui, false, " + ").clicked() {
            reply.actions.push(Action::Guidance(climb(r, 1)));
        }
    });
    if !r.guidance_phase.is_empty() {
        ui.label(RichText::new(r.guidance_phase).font(style::words(12.0)).color(style::GOOD));
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if style::toggle(ui, r.gear_down, "Gear").clicked() {
            reply.actions.push(Action::Gear(!r.gear_down));
        }
        if style::toggle(ui, false, "Refuel").clicked() {
            reply.actions.push(Action::Refuel);
        }
    });
}

/// Speed, ball, throttle and propellant.
fn middle(ui: &mut Ui, r: &Readout, state: &mut State, opacity: f32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(2.0 * BALL + 150.0, 2.0 * BALL + 50.0), Sense::hover());
    let by_itself = if r.altitude_m < 60_000.0 { SpeedOver::Surface } else { SpeedOver::Orbit };
    let over = state.speed.unwrap_or(by_itself);
    let (speed, name) = match over {
        SpeedOver::Orbit => (r.orbital_speed_m_s, "ORBIT"),
        SpeedOver::Surface => (r.surface_speed_m_s, "SURFACE"),
    };
    let plate = Rect::from_center_size(Pos2::new(rect.center().x, rect.top() + 16.0), Vec2::new(190.0, 30.0));
    let response =
        ui.interact(plate, ui.scope_id().with("speed"), Sense::click()).on_hover_text("Click: over the orbit or over the ground");
    if response.clicked() {
        state.speed = Some(if over == SpeedOver::Orbit { SpeedOver::Surface } else { SpeedOver::Orbit });
    }
    let painter = ui.painter();
    painter.rect_filled(plate, 5, style::ground(opacity));
    painter.text(plate.left_center() + Vec2::new(9.0, 0.0), Align2::LEFT_CENTER, name, style::words(10.5), style::ACCENT);
    painter.text(plate.right_center() - Vec2::new(9.0, 0.0), Align2::RIGHT_CENTER, format::speed(speed), style::mono(18.0), style::TEXT);

    let centre = Pos2::new(rect.center().x, rect.bottom() - BALL - 8.0);
    ball::draw(painter, centre, BALL, &r.markers);
    let tall = |x: f32| Rect::from_center_size(Pos2::new(centre.x + x, centre.y), Vec2::new(13.0, 1.6 * BALL));
    let label = |x: f32, top: &str, bottom: &str| {
        let bar = tall(x);
        painter.text(bar.center_top() - Vec2::new(0.0, 9.0), Align2::CENTER_CENTER, top, style::words(10.0), style::DIM);
        painter.text(bar.center_bottom() + Vec2::new(0.0, 9.0), Align2::CENTER_CENTER, bottom, style::mono(11.0), style::TEXT);
    };
    for side in [-1.0, 1.0] {
        let back = tall(side * (BALL + 30.0)).expand2(Vec2::new(20.0, 17.0));
        painter.rect_filled(back, 5, style::ground(opacity * 0.8));
    }
    let throttle = r.throttle;
    bar(painter, tall(-BALL - 30.0), narrow(throttle), style::ACCENT);
    label(-BALL - 30.0, "THR", &format!("{} %", format::number(throttle * 100.0, 0)));
    let (left, full) = r.propellant_kg;
    let fraction = if full > 0.0 { left / full } else { 0.0 };
    bar(painter, tall(BALL + 30.0), narrow(fraction), if fraction < 0.05 { style::DANGER } else { style::GOOD });
    label(BALL + 30.0, "FUEL", &format!("{} %", format::number(fraction * 100.0, 0)));
}

/// Warnings: the worst first, blinking slowly (1.25 Hz: well below what may trigger photosensitive epilepsy).
fn warnings(ctx: &egui::Context, r: &Readout) {
    if r.warnings.is_empty() {
        return;
    }
    let bright = libm::fmod(ctx.input(|i| i.time), 0.8) < 0.5;
    area(ctx, "warnings", Align2::CENTER_TOP, [0.0, 128.0], |ui| {
        ui.vertical_centered(|ui| {
            for warning in r.warnings.iter().take(3) {
                let (text, urgent) = words_of(*warning);
                let colour = if urgent { style::DANGER } else { style::ACCENT };
                let colour = if urgent && !bright { colour.gamma_multiply(0.45) } else { colour };
                style::panel(0.7).show(ui, |ui| ui.label(RichText::new(text).font(style::words(16.0)).color(colour)));
            }
        });
    });
    ctx.request_repaint();
}

/// What a warning says, and whether it is urgent.
pub const fn words_of(warning: Warning) -> (&'static str, bool) {
    match warning {
        Warning::Crashed => ("HULL LOST", true),
        Warning::PullUp => ("GROUND AHEAD", true),
        Warning::Heat => ("HEAT", true),
        Warning::Overpressure => ("DYNAMIC PRESSURE", true),
        Warning::OverG => ("OVER G", true),
        Warning::GearUp => ("GEAR IS UP", true),
        Warning::Propellant => ("PROPELLANT LOW", false),
        Warning::WarpLowered => ("Warp lowered", false),
    }
}
