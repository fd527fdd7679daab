//! The words of the command line: what is taken, what is refused.

use super::*;
use clap::CommandFactory;

fn cli(words: &[&str]) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(std::iter::once("syzygy").chain(words.iter().copied())).and_then(led)
}

#[test]
fn the_words_hang_together() {
    Cli::command().debug_assert();
}

#[test]
fn every_subcommand_shows_an_example() {
    fn walk(command: &mut clap::Command, path: &str) {
        let help = command.render_long_help().to_string();
        assert!(path.ends_with("help") || help.contains("Example"), "{path}: {help}");
        // What an example says is taken by the program, and the starts that it names are there.
        for line in help.lines().filter(|l| l.starts_with("  syzygy ")) {
            let words: Vec<&str> = line.split("    ").next().unwrap_or(line).split_whitespace().skip(1).take_while(|w| *w != ">").collect();
            cli(&words).unwrap_or_else(|e| panic!("{line}: {e}"));
            for pair in words.windows(2).filter(|pair| pair[0] == "--start") {
                let start = format!("{}/../assets/starts/{}.toml", env!("CARGO_MANIFEST_DIR"), pair[1]);
                assert!(std::path::Path::new(&start).is_file(), "{line}: no start `{}`", pair[1]);
            }
        }
        for sub in command.get_subcommands_mut() {
            let path = format!("{path} {}", sub.get_name());
            walk(sub, &path);
        }
    }
    walk(&mut Cli::command(), "syzygy");
}

#[test]
fn play_is_what_happens_when_nothing_is_named() {
    let bare = cli(&["--start", "eclipse", "--size", "800x600"]).unwrap();
    assert!(bare.mode.is_none());
    assert_eq!((bare.play.start.as_deref(), bare.play.size), (Some("eclipse"), Some((800, 600))));
    assert!(matches!(cli(&["play", "--mods", "a", "--mods", "b"]).unwrap().mode, Some(Mode::Play(p)) if p.places.mods.len() == 2));
}

#[test]
fn folders_may_be_named_before_the_command() {
    let words = ["--mods", "a", "-v", "--assets", "x", "shot", "--mods", "b", "--assets", "y", "--size", "8x8", "--out", "p.png"];
    let Some(Mode::Shot(shot)) = cli(&words).unwrap().mode else { panic!("other words") };
    assert_eq!(shot.places.mods, ["a", "b"].map(PathBuf::from));
    assert_eq!((shot.places.assets, shot.places.verbose), (Some(PathBuf::from("y")), 1));
    let Some(Mode::Probe(Probe::Air(air))) = cli(&["--safe-mode", "probe", "air", "--body", "b", "--altitude-m", "0"]).unwrap().mode else {
        panic!("other words")
    };
    assert!(air.common.places.safe_mode);
    let told = cli(&["--start", "leo", "shot", "--size", "8x8", "--out", "p.png"]).unwrap_err().to_string();
    assert!(told.contains("`syzygy COMMAND --start …`"), "{told}");
}

#[test]
fn heavy_takes_no_value_or_one_after_an_equals_sign() {
    let heavy = |words: &[&str]| match cli(words).unwrap().mode {
        Some(Mode::Replay(r)) => (r.heavy, r.files.len()),
        other => panic!("{other:?}"),
    };
    assert_eq!(heavy(&["replay", "a"]), (None, 1));
    assert_eq!(heavy(&["replay", "--heavy", "a", "b"]), (Some(97), 2));
    assert_eq!(heavy(&["replay", "a", "--heavy=10"]), (Some(10), 1));
}

#[test]
fn numbers_that_are_none_are_refused() {
    for (parser_says, ok) in [
        (size("1280x720").is_ok(), true),
        (size("0x720").is_ok(), false),
        (size("1280").is_ok(), false),
        (size("99999x2").is_ok(), false),
        (julian_date("2461265.24").is_ok(), true),
        (julian_date("NaN").is_ok(), false),
        (julian_date("1e30").is_ok(), false),
        (finite("inf").is_ok(), false),
        (positive("-1e-9").is_ok(), false),
        (positive("0").is_ok(), false),
        (picture("a.PNG").is_ok(), true),
        (picture("a.gif").is_ok(), false),
    ] {
        assert_eq!(parser_says, ok);
    }
}
