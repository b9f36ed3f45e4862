//! `tracer compare`: the experiment of Geimer & Müller 2003, section 4, on this CPU.

mod chart;
mod measure;
mod report;
mod text;

pub use measure::measure;

use crate::args::{self, BuildOptions, PictureOptions, ReorderOption, ThreadsOption};
use crate::console::{Console, json};
use crate::method::MethodChoice;
use crate::workload::{Built, Workload};
use clap::ValueEnum;
use report::Report;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tracer::Error;
use tracer::output::write_atomically;

/// Rounds of measurement when nothing else is asked for.
pub const DEFAULT_REPEAT: NonZeroUsize = NonZeroUsize::new(5).unwrap();

/// Compare all levels and widths of this CPU with emulation
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each level of this CPU renders the same frame with packets of 4, 8 and 16 rays: one thread, CPU time, the levels in turn in
each round, medians over the rounds; and once more with all threads. The baseline is float4 in emulation, as in Geimer &
Müller 2003. Ends with exit code 1 if any level finds other hits or another picture, be it in a single bit.

Examples:
  tracer compare                                    the sphereflake, as a table
  tracer compare rings --format markdown
  tracer compare rings --method auto                the same for another way of finding hits
  tracer compare atrium.obj -o speed.svg            a chart; .json, .csv and .md likewise")]
pub struct Args {
    /// A file or a built-in scene
    #[arg(default_value = "balls")]
    scene: String,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    build: BuildOptions,
    /// How hits are found at all levels; the three rows in emulation are packets always
    #[arg(long, value_name = "METHOD", value_enum, default_value_t = MethodChoice::Packet, help_heading = "Measurement")]
    method: MethodChoice,
    #[command(flatten, next_help_heading = "Measurement")]
    reorder: ReorderOption,
    /// Rounds of measurement after one to warm up; medians are reported, so let it be odd
    #[arg(long, value_name = "N", default_value_t = DEFAULT_REPEAT, help_heading = "Measurement")]
    repeat: NonZeroUsize,
    #[command(flatten)]
    threads: ThreadsOption,
    /// What to write [default: as the name of the file says, else a table]
    #[arg(long, value_enum, help_heading = "Output")]
    format: Option<Format>,
    /// File to write instead of standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Table,
    Json,
    Csv,
    Markdown,
    /// A bar chart
    Svg,
}

impl Format {
    fn of(path: &Path) -> Self {
        match path.extension().map(|e| e.to_ascii_lowercase()).as_ref().and_then(|e| e.to_str()) {
            Some("json") => Self::Json,
            Some("csv") => Self::Csv,
            Some("md") => Self::Markdown,
            Some("svg") => Self::Svg,
            _ => Self::Table,
        }
    }
}

pub fn run(args: &Args, console: &Console) -> Result<ExitCode, Error> {
    args.build.config()?;
    args.picture.size.check()?;
    let output = args.output.as_deref();
    args::check_folder(output)?;
    let format = args.format.or_else(|| output.map(Format::of)).unwrap_or(Format::Table);
    let pool = args::pool(args.threads.threads)?;
    let work = pool.install(|| Workload::open(&args.scene, console))?;
    let built = pool.install(|| Built::new(&work.scene.mesh, &args.build, console))?;
    let report =
        measure(&work, &built, (args.method, args.reorder.reorder), &args.picture, args.repeat, &pool, console)?;
    show(&report, format, output, console)
}

/// Writes the report; the exit code says whether all rows are identical.
pub fn show(report: &Report, format: Format, output: Option<&Path>, console: &Console) -> Result<ExitCode, Error> {
    let text = match format {
        Format::Table => text::table(report),
        Format::Json => json(report)?,
        Format::Csv => text::csv(report)?,
        Format::Markdown => text::markdown(report),
        Format::Svg => chart::svg(report),
    };
    match output {
        None => console.print(&text)?,
        Some(path) => {
            write_atomically(path, |out| out.write_all(text.as_bytes()))?;
            console.print(&format!("wrote {}\n", path.display()))?;
        }
    }
    Ok(if report.all_identical { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
