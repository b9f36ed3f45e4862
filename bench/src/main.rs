//! Measures what papers measured, and writes reports that mirror their tables and figures.
//!
//! ```text
//! cargo run --release -p bench -- boulos
//! cargo run --release -p bench -- afra
//! cargo run --release -p bench -- garanzha
//! cargo run --release -p bench -- sort
//! ```

mod afra;
mod boulos;
mod console;
mod garanzha;
mod machine;
mod report;
mod sort;

use clap::{Parser, Subcommand};
use console::Console;
use std::process::ExitCode;
use tracer::Error;

/// Measures what papers measured, and writes reports that mirror their tables and figures
#[derive(Parser)]
#[command(name = "bench", version, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Boulos(boulos::Args),
    Afra(afra::Args),
    Garanzha(garanzha::Args),
    Sort(sort::Args),
}

fn main() -> ExitCode {
    let Cli { command } = Cli::parse();
    let console = Console::new();
    let done = match command {
        Command::Boulos(args) => boulos::run(&args, &console),
        Command::Afra(args) => afra::run(&args, &console),
        Command::Garanzha(args) => garanzha::run(&args, &console),
        Command::Sort(args) => sort::run(&args, &console),
    };
    let Err(error) = done else { return ExitCode::SUCCESS };
    console.clear();
    eprintln!("error: {error}");
    match error {
        Error::Usage(_) => ExitCode::from(2),
        Error::Cancelled => ExitCode::from(130),
        _ => ExitCode::FAILURE,
    }
}
