//! The `tracer` command: renders, compares instruction sets, answers batches of rays. One file per subcommand.
#![forbid(unsafe_code)]

mod args;
mod checkpoint;
mod compare;
mod console;
mod cost;
mod environment;
mod generate;
mod info;
mod light;
mod machine;
mod method;
mod npy;
mod picture;
mod render;
mod report;
mod trace;
mod workload;

use args::{BuildOptions, PictureOptions};
use clap::{Parser, Subcommand};
use console::Console;
use method::MethodChoice;
use std::process::ExitCode;
use tracer::Error;
use workload::{Built, Structure, Workload};

/// Ray tracing on portable SIMD: the same hits, bit for bit, on every instruction set.
///
/// Without a command: renders the built-in sphereflake to balls.png and compares all instruction sets of this CPU on it.
#[derive(Parser)]
#[command(name = "tracer", version, after_help = EXAMPLES, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

const EXAMPLES: &str = "\
Scenes:
  a file     .obj (with the .mtl it names), .ply, .gltf, .glb; packed too: .obj.gz, .ply.zst ...
  built in   balls, rings, tree, hairball; with a size after a colon: balls:3

Examples:
  tracer                                            render balls.png, then compare
  tracer render atrium.obj -o atrium.png --size 1280x720 --shadows
  tracer render rings --camera 0,-3,1/0,0,0/0,0,1/60 -o rings.exr
  tracer compare balls:3 -o speed.svg               a chart of speed-ups
  tracer trace atrium.obj --rays rays.npy --hits hits.npy --json
  SIMD_LEVEL=sse2 tracer info balls                 force a level, see what was chosen

Exit codes: 0 done, 1 a file or the results are at fault, 2 usage, 130 stopped by Ctrl-C";

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Compare(compare::Args),
    Info(info::Args),
    Trace(trace::Args),
    Generate(generate::Args),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let console = Console::new();
    let result = match &cli.command {
        Some(Command::Render(args)) => render::run(args, &console),
        Some(Command::Compare(args)) => compare::run(args, &console),
        Some(Command::Info(args)) => info::run(args, &console),
        Some(Command::Trace(args)) => trace::run(args, &console),
        Some(Command::Generate(args)) => generate::run(args, &console),
        None => first_look(&console),
    };
    result.unwrap_or_else(|error| {
        console.error(&error);
        match error {
            Error::Usage(_) => ExitCode::from(2),
            Error::Cancelled => ExitCode::from(130),
            _ => ExitCode::FAILURE,
        }
    })
}

/// What a new user sees: a picture and the comparison.
fn first_look(console: &Console) -> Result<ExitCode, Error> {
    let pool = args::pool(None)?;
    let picture = PictureOptions::default();
    let work = pool.install(|| Workload::open("balls", console))?;
    let built = pool.install(|| Built::new(&work.scene.mesh, &BuildOptions::default(), console))?;
    let structure = Structure::new(MethodChoice::Packet, &work.scene.mesh, || Ok(built.clone()))?;
    pool.install(|| render::picture(&render::Args::default(), &work, &structure, console))?;
    console.print("\n")?;
    let report =
        compare::measure(&work, &built, Default::default(), &picture, compare::DEFAULT_REPEAT, &pool, console)?;
    compare::show(&report, compare::Format::Table, None, console)
}
