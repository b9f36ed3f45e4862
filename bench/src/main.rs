//! Measures what papers measured, and writes reports that mirror their tables and figures.
//!
//! ```text
//! cargo run --release -p bench -- boulos
//! cargo run --release -p bench -- sort
//! ```

mod boulos;
mod console;
mod machine;
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
    Sort(sort::Args),
}

fn main() -> ExitCode {
    let console = Console::new();
    let done = match Cli::parse().command {
        Command::Boulos(args) => boulos::run(&args, &console),
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
