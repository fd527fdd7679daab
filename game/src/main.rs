//! The program: what the player typed → a mode → an exit code. The modes are in [`game::mode`], the words in [`game::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    match game::cli::parse(std::env::args_os()) {
        Ok(cli) => game::mode::run(cli),
        Err(code) => code,
    }
}
