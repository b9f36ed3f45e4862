//! `tracer render`: a picture of a scene.

use crate::args::{self, BuildOptions, PictureOptions, TraceOptions};
use crate::checkpoint::CheckpointOptions;
use crate::console::Console;
use crate::environment::EnvironmentOptions;
use crate::light::{self, LightOptions};
use crate::method::{MethodChoice, reordered};
use crate::picture;
use crate::report::{Subject, Written};
use crate::workload::{Built, Structure, Workload, mrays_per_s, ms};
use indicatif::HumanCount;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tracer::Error;
use tracer::method::Context;
use tracer::progress::Progress;
use tracer::render::{Frame, Settings};

/// Render a scene to a picture
#[derive(Debug, Default, clap::Args)]
#[command(after_help = "\
Examples:
  tracer render                                     the built-in sphereflake to balls.png
  tracer render atrium.obj.zst --size 1920x1080 --camera -60,86,10/0,40,0 --shadows
  tracer render rings --method auto                 as many rays together as agree
  tracer render tree:8 -o tree.exr --level sse2 --width 4 --threads 1 --json
  tracer render garden.obj --integrator path --samples 256 --mis --environment noon.hdr --environment-rotation 90
  tracer render room.obj --integrator path --samples 4096 --checkpoint room.film
  tracer render room.obj --integrator path --samples 64 --bounces 4 --mis --method auto --tone aces
  tracer render balls --integrator whitted --samples 4 --method auto
  tracer render atrium.obj --integrator ao --samples 16 --distance 100 --method auto")]
pub struct Args {
    /// A file or a built-in scene [default: balls]
    scene: Option<String>,
    /// File to write: .png (sRGB, 8 bits) or .exr (linear, 32-bit floats) [default: the scene's name with .png]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub picture: PictureOptions,
    #[command(flatten)]
    pub light: LightOptions,
    #[command(flatten)]
    pub environment: EnvironmentOptions,
    #[command(flatten)]
    pub checkpoint: CheckpointOptions,
    #[command(flatten)]
    pub build: BuildOptions,
    #[command(flatten)]
    pub trace: TraceOptions,
}

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    subject: Subject,
    shadows: bool,
    level: String,
    method: String,
    reorder: &'static str,
    packet: usize,
    threads: usize,
    eye_ms: f64,
    cast_ms: f64,
    shade_ms: f64,
    total_ms: f64,
    rays: usize,
    mrays_per_s: f64,
    hits: usize,
    hits_hash: Option<String>,
    image_hash: Option<String>,
    #[serde(flatten)]
    written: Written,
}

pub fn run(args: &Args, console: &Console) -> Result<ExitCode, Error> {
    // What can be known to be wrong is told before the long work.
    if let Some(path) = &args.output {
        picture::Kind::of(path)?;
    }
    args.trace.level.choose()?;
    let is_eye = args.light.integrator == light::Choice::Eye;
    let method = args.trace.method(if is_eye { MethodChoice::Packet } else { MethodChoice::Auto })?;
    args.light.check(args)?;
    args::check_folder(args.output.as_deref())?;
    args::check_folder(args.light.cost.as_deref())?;
    let build = args.light.without_own_seed(&args.build);
    build.config()?;
    args.picture.size.check()?;
    let pool = args::pool(args.trace.threads.threads)?;
    pool.install(|| {
        let work = Workload::open(args.scene.as_deref().unwrap_or("balls"), console)?;
        let mesh = &work.scene.mesh;
        let structure = Structure::new(method, mesh, || Built::new(mesh, &build, console))?;
        if is_eye {
            picture(args, &work, &structure, console)
        } else {
            light::picture(args, &work, &structure, console)
        }
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Renders, writes and reports, on the current rayon pool.
pub fn picture(args: &Args, work: &Workload, structure: &Structure, console: &Console) -> Result<(), Error> {
    let (level, _) = args.trace.level.choose()?;
    let size = args.picture.size;
    let scene = &work.scene;
    let camera = args.picture.camera.unwrap_or_else(|| scene.camera_or_default());
    let (lanes, shadows) = (args.trace.width, args.picture.shadows);
    let settings = Settings { width: size.width, height: size.height, level, lanes, shadows };
    let choice = structure.choice;
    let method = choice.over(&structure.tree, level, lanes, args.trace.form());
    let reorder = args.trace.reorder.reorder;
    let method = reordered(method, &scene.mesh.bounds(), level, reorder);
    let mut cx = Context { counters: None, cancel: Some(console.cancel()) };

    console.stage("render", 4);
    let mut frame = Frame::new(scene, &work.surfaces, camera, settings);
    let ((), eye_ms) = timed(|| frame.eye_rays());
    console.advance(1);
    let (cast, cast_ms) = timed(|| frame.cast(&*method, &mut cx));
    cast?;
    console.advance(1);
    let (image, shade_ms) = timed(|| frame.shade(&cx));
    let image = image?;
    console.advance(1);
    let hits = frame.hits().iter().filter(|h| !h.is_miss()).count();
    // Only JSON shows the hashes.
    let hits_hash = args.json.then(|| format!("{:016x}", frame.hits().hash()));
    let image_hash = args.json.then(|| format!("{:016x}", image.hash()));

    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.png", scene.name)));
    console.check()?;
    let output_bytes = picture::write(&args.light.developed(&image, &output), &output)?;
    let rays = size.pixels() + if shadows { hits * scene.lights_or_headlight(&camera).len() } else { 0 };
    let report = Report {
        subject: Subject::new(work, structure, &camera, [size.width, size.height]),
        shadows,
        level: level.to_string(),
        method: choice.name(),
        reorder: reorder.name(),
        packet: lanes.lanes(level),
        threads: rayon::current_num_threads(),
        eye_ms,
        cast_ms,
        shade_ms,
        total_ms: eye_ms + cast_ms + shade_ms,
        rays,
        mrays_per_s: mrays_per_s(rays, cast_ms),
        hits,
        hits_hash,
        image_hash,
        written: Written { output, output_bytes },
    };
    if args.json { console.print_json(&report) } else { console.print(&text(&report)) }
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, ms(start.elapsed()))
}

fn text(r: &Report) -> String {
    let rays = HumanCount(r.rays as u64);
    let shadows = if r.shadows { " and shadow" } else { "" };
    let (subject, written) = (r.subject.text(), r.written.text());
    let Subject { width, height, .. } = r.subject;
    let covered = 100.0 * r.hits as f64 / (width * height) as f64;
    let Report { level, method, reorder, packet, threads, eye_ms, cast_ms, shade_ms, total_ms, mrays_per_s, .. } = r;
    format!(
        "\
{subject}rendered  {width}x{height}, level {level}, method {method}, reorder {reorder}, {packet} lanes, threads: {threads}; {covered:.1} % of the picture is covered
  eye rays {eye_ms:>9.2} ms
  casting  {cast_ms:>9.2} ms, {mrays_per_s:.2} Mrays/s ({rays} eye{shadows} rays)
  shading  {shade_ms:>9.2} ms
  total    {total_ms:>9.2} ms
{written}"
    )
}
