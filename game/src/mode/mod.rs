//! The modes: what the program does, one file each. [`run`] reads like the list of them.
//!
//! Not here: the words themselves ([`crate::cli`]), the loop that modes share ([`crate::session`]).

pub mod bench;
pub mod check_assets;
pub mod headless;
pub mod open;
pub mod places;
pub mod probe;
pub mod replay;
pub mod shot;
pub mod stage;
pub mod studio;
pub mod window;

use crate::cli::{Cli, HeadlessArgs, Mode, ShotArgs};
use crate::command::Commands;
use crate::replay::{Log, LogError, Player, Recorder};
use crate::save::{self, Slots};
use crate::session::Session;
use crate::world::World;
use stage::Stage;
use std::process::ExitCode;

/// What may stop a mode.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum Error {
    /// A folder is missing.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Place(#[from] places::PlaceError),
    /// A save cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Save(#[from] crate::save::SaveError),
    /// A replay cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Log(#[from] crate::replay::LogError),
    /// An asset is at fault.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Assets(#[from] crate::assets::AssetErrors),
    /// No picture.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Shot(#[from] shot::ShotError),
    /// A headless run ended early.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Headless(#[from] headless::HeadlessError),
    /// No heights.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Height(#[from] probe::height::HeightError),
    /// No two-body states.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Kepler(#[from] probe::kepler::KeplerError),
    /// No radiances.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Sky(#[from] probe::sky::SkyError),
    /// No case of orbital motion.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Case(#[from] bench::orbit_case::CaseError),
    /// No integrator, or a setting that it does not take.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Method(#[from] bench::orbit_method::MethodError),
    /// A bench's rows or pictures.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Rows(#[from] bench::orbit_rows::RowsError),
    /// A body that the system does not have.
    #[error("there is no body `{body}`")]
    #[diagnostic(help("{help}"))]
    NoBody {
        /// What was asked for.
        body: String,
        /// What there is.
        help: String,
    },
    /// A body without air.
    #[error("{0} has no air that drags: it has no atmosphere.toml with a [physics] table")]
    NoAir(String),
    /// An answer cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Out {
        /// The file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// stdout is gone.
    #[error("the answer cannot be written: {0}")]
    Stdout(#[from] std::io::Error),
}

/// Runs the mode that the command line names, and turns what comes of it into an exit code.
pub fn run(cli: Cli) -> ExitCode {
    let mut mode = cli.mode.unwrap_or(Mode::Play(cli.play));
    start_log(mode.places_mut().verbose);
    let outcome = match &mode {
        Mode::Play(args) => window::play(args),
        Mode::Headless(args) => headless(args).map(|()| ExitCode::SUCCESS),
        Mode::Replay(args) => Stage::set(&args.places).map(|stage| replay::run(args, &mut |state| stage.world(state))),
        Mode::Shot(args) => shot(args).map(|()| ExitCode::SUCCESS),
        Mode::CheckAssets(args) => match args.schema {
            Some(kind) => {
                print!("{}", check_assets::schema(kind));
                Ok(ExitCode::SUCCESS)
            }
            None => check_assets::run(args).map(|sound| {
                sound.warnings.iter().for_each(|warning| eprintln!("{warning}\n"));
                println!("{}", sound.line);
                ExitCode::SUCCESS
            }),
        },
        Mode::Probe(probe) => probe::run(probe).map(|()| ExitCode::SUCCESS),
        Mode::Bench(bench) => bench::run(bench).map(|()| ExitCode::SUCCESS),
    };
    outcome.unwrap_or_else(|error| {
        let code = error.exit_code();
        eprintln!("{:?}", miette::Report::new(error));
        code
    })
}

impl Error {
    /// 2 where there is no GPU, 1 for everything else.
    fn exit_code(&self) -> ExitCode {
        use studio::StudioError::Gpu;
        match self {
            Self::Sky(probe::sky::SkyError::Gpu(_))
            | Self::Shot(shot::ShotError::Studio(Gpu(_)))
            | Self::Headless(headless::HeadlessError::Studio(Gpu(_))) => ExitCode::from(2),
            _ => ExitCode::FAILURE,
        }
    }
}

fn shot(args: &ShotArgs) -> Result<(), Error> {
    let session = Stage::set(&args.places)?.session(&args.start)?;
    Ok(shot::run(args, session)?)
}

fn headless(args: &HeadlessArgs) -> Result<(), Error> {
    let stage = Stage::set(&args.places)?;
    let log = args.commands.as_deref().map(|path| Log::read(path).map(|log| (path, log))).transpose()?;
    let session = match &log {
        // A recorded flight begins with its own state.
        Some((path, log)) => {
            let state = save::decode(&log.start).map_err(|problems| LogError::Contents { path: path.to_path_buf(), problems })?;
            let world = stage.world(&state)?;
            log.check_assets(path, &world)?;
            Session::new(world)
        }
        None => stage.session(&args.start)?,
    };
    let mut log = log.map(|(_, log)| Player::new(log));
    let start = session.world.clone();
    let mut recorder = args.record.as_ref().map(|_| Recorder::new(&start));
    let mut commands = |_| log.as_mut().and_then(Player::next_commands).unwrap_or_default();
    let mut after = |commands: &Commands, world: &World| {
        if let Some(recorder) = &mut recorder {
            recorder.tick(commands, world);
        }
    };
    let session = headless::run(args, session, &mut commands, &mut after)?;
    if let Some(path) = &args.save {
        let folder = path.parent().unwrap_or(std::path::Path::new("."));
        Slots::new(folder).write_to(path, &save::label(&session.world), &save::encode(&session.world))?;
    }
    if let (Some(path), Some(recorder)) = (&args.record, recorder) {
        recorder.finish(&session.world).write(path, &crate::replay::recorder::header(&start))?;
    }
    Ok(())
}

/// Logs go to stderr, so that stdout stays machine output.
fn start_log(verbose: u8) {
    use tracing_subscriber::EnvFilter;
    let level = ["warn", "info", "debug"].get(usize::from(verbose)).unwrap_or(&"trace");
    let quiet = format!("{level},wgpu_core=error,wgpu_hal=error,naga=error");
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(quiet));
    // A second call (tests run several modes in one process) keeps the first log.
    let _ = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time().try_init();
}
