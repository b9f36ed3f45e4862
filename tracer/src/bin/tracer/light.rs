//! `tracer render` with secondary rays.

use crate::args::BuildOptions;
use crate::console::Console;
use crate::cost::Cost;
use crate::method::reordered;
use crate::picture::{self, Kind};
use crate::render::Args;
use crate::report::{Subject, Written};
use crate::workload::{Structure, Workload, mrays_per_s, ms};
use clap::ValueEnum;
use indicatif::HumanCount;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;
use tracer::Error;
use tracer::method::Context;
use tracer::render::integrator::{self, Config, Crop, Integrator, Layers, Means, Rendering};
use tracer::render::{Image, Scenery, Tone};

/// How light is followed.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Light")]
pub struct LightOptions {
    /// How light is followed
    #[arg(long, value_name = "INTEGRATOR", default_value_t, value_enum)]
    pub integrator: Choice,
    /// Paths for each pixel, for whitted, ao and path [default: 1, through its middle]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,
    /// Begin no sample after so many seconds, for whitted, ao and path
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<f64>,
    /// Reflections at most [default: 2 for path, 5 for whitted]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1000))]
    bounces: Option<u32>,
    /// Let dim paths end by chance from the third reflection on, for path
    #[arg(long)]
    roulette: bool,
    /// Find light by chance too, both ways weighted (multiple importance sampling), for path
    #[arg(long)]
    mis: bool,
    /// Send rays from glossy surfaces into the lobe of their coat alone, as Boulos 2008 has it, for path
    #[arg(long)]
    coat_alone: bool,
    /// Shade hits in the order of their rays, not by their material's model: the same picture, slower
    #[arg(long)]
    ungrouped: bool,
    /// How far rays go, in units of the scene, for ao [default: any distance]
    #[arg(long, value_name = "D")]
    distance: Option<f32>,
    /// The part of the picture that is wanted: column and row of its first pixel, width and height
    #[arg(long, value_name = "X,Y,W,H")]
    crop: Option<Part>,
    /// Put more than light into an .exr, for whitted, ao and path: distance, normal, albedo, triangle and material of what is seen through the
    /// middle of each pixel, the variance of the light, and the number of rays
    #[arg(long)]
    layers: bool,
    /// Show the number of rays of each pixel in false colours, in a .png, for whitted, ao and path
    #[arg(long, value_name = "FILE")]
    pub cost: Option<PathBuf>,
    /// Brighten a .png by so many stops
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    exposure: Option<f32>,
    /// Bring bright light into the range of a .png: none, reinhard or aces [default: none]
    #[arg(long, value_name = "CURVE")]
    tone: Option<Tone>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Choice {
    /// Three passes, one ray for each pixel: Phong's model, shadows of point lights
    #[default]
    Eye,
    /// Mirrors, glass and shadows
    Whitted,
    /// How much of the sky each point sees
    Ao,
    /// Path tracing: light from everywhere
    Path,
}

#[derive(Debug, Clone, Copy)]
struct Part(Crop);

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<usize> = text.split(',').filter_map(|n| n.trim().parse().ok()).collect();
        match numbers[..] {
            [x, y, width, height] if text.split(',').count() == 4 => Ok(Self(Crop { x, y, width, height })),
            _ => Err("give four whole numbers, for example 100,50,320,200".into()),
        }
    }
}

impl LightOptions {
    /// Refuses what makes no sense together, before the long work.
    pub fn check(&self, args: &Args) -> Result<(), Error> {
        let Self { integrator, .. } = *self;
        let path_alone = "is for --integrator path";
        let not_eye = "is for --integrator whitted, ao and path";
        for (given, name, of, purpose) in [
            (self.samples.is_some(), "--samples", integrator != Choice::Eye, not_eye),
            (self.time_limit.is_some(), "--time-limit", integrator != Choice::Eye, not_eye),
            (self.crop.is_some(), "--crop", integrator != Choice::Eye, not_eye),
            (args.checkpoint.checkpoint.is_some(), "--checkpoint", integrator != Choice::Eye, not_eye),
            (
                args.environment.environment.is_some(),
                "--environment",
                self.has_bounces(),
                "is for --integrator whitted and path",
            ),
            (self.cost.is_some(), "--cost", integrator != Choice::Eye, not_eye),
            (self.layers, "--layers", integrator != Choice::Eye, not_eye),
            (self.ungrouped, "--ungrouped", self.has_bounces(), "is for --integrator whitted and path"),
            (self.bounces.is_some(), "--bounces", self.has_bounces(), "is for --integrator whitted and path"),
            (self.roulette, "--roulette", integrator == Choice::Path, path_alone),
            (self.mis, "--mis", integrator == Choice::Path, path_alone),
            (self.coat_alone, "--coat-alone", integrator == Choice::Path, path_alone),
            (self.distance.is_some(), "--distance", integrator == Choice::Ao, "is for --integrator ao"),
            (
                args.picture.shadows,
                "--shadows",
                integrator == Choice::Eye,
                "is for --integrator eye: the others always cast them",
            ),
        ] {
            if given && !of {
                return Err(Error::Usage(format!("{name} {purpose}: leave it out")));
            }
        }
        args.checkpoint.check()?;
        let files = [("--output", &args.output), ("--cost", &self.cost), ("--checkpoint", &args.checkpoint.checkpoint)];
        for (i, (name, file)) in files.iter().enumerate() {
            if let Some((other, _)) = files[..i].iter().find(|(_, other)| file.is_some() && file == other) {
                return Err(Error::Usage(format!("{other} and {name} name one file: give each its own")));
            }
        }
        args.environment.check()?;
        if let Some(cost) = &self.cost
            && Kind::of(cost)? != Kind::Png
        {
            return Err(Error::Usage(format!("--cost {}: give a picture that ends in .png", cost.display())));
        }
        let exr = args.output.as_deref().map(Kind::of).transpose()? == Some(Kind::Exr);
        if exr && (self.tone.is_some() || self.exposure.is_some()) {
            return Err(Error::Usage("--tone and --exposure are for .png: an .exr holds the light itself".into()));
        }
        if self.time_limit.is_some_and(|seconds| !(0.0..=1e9).contains(&seconds)) {
            return Err(Error::Usage("--time-limit: give a number of seconds from 0 to 1e9".into()));
        }
        if self.layers && !exr {
            return Err(Error::Usage("--layers is for .exr: name one with -o".into()));
        }
        if self.exposure.is_some_and(|stops| !(-100.0..=100.0).contains(&stops)) {
            return Err(Error::Usage("--exposure: give a number of stops from -100 to 100".into()));
        }
        if integrator != Choice::Eye {
            self.config(args)?.validate()?;
        }
        Ok(())
    }

    fn has_bounces(&self) -> bool {
        matches!(self.integrator, Choice::Whitted | Choice::Path)
    }

    /// The options of the tree without the seed that is one of random numbers alone.
    pub fn without_own_seed(&self, build: &BuildOptions) -> BuildOptions {
        let insertion = build.build == crate::args::Builder::Insertion;
        let seed = build.seed.filter(|_| insertion || self.integrator == Choice::Eye);
        BuildOptions { seed, ..build.clone() }
    }

    /// The picture as it goes into a file.
    pub fn developed(&self, image: &Image, path: &Path) -> Image {
        match Kind::of(path) {
            Ok(Kind::Png) => self.tone.unwrap_or_default().map(image, self.exposure.unwrap_or(0.0)),
            _ => image.clone(),
        }
    }

    fn config(&self, args: &Args) -> Result<Config, Error> {
        let size = args.picture.size;
        let path = integrator::Path {
            bounces: self.bounces.unwrap_or(2),
            roulette: self.roulette,
            mis: self.mis,
            coat_alone: self.coat_alone,
        };
        let integrator = match self.integrator {
            Choice::Eye => Integrator::Eye { shadows: args.picture.shadows },
            Choice::Whitted => Integrator::Whitted { bounces: self.bounces.unwrap_or(5) },
            Choice::Ao => Integrator::AmbientOcclusion { distance: self.distance.unwrap_or(f32::INFINITY) },
            Choice::Path => Integrator::Path(path),
        };
        let (level, _) = args.trace.level.choose()?;
        Ok(Config {
            integrator,
            crop: self.crop.map(|part| part.0),
            samples: self.samples.unwrap_or(1),
            time_limit: self.time_limit.map(Duration::from_secs_f64),
            seed: args.build.seed.unwrap_or(0),
            level,
            lanes: args.trace.width,
            group_shading: !self.ungrouped,
            count_rays: self.layers || self.cost.is_some(),
            ..Config::new(size.width, size.height)
        })
    }
}

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    subject: Subject,
    integrator: String,
    samples: u32,
    /// Of them, those of the checkpoint; what comes below is of the others.
    samples_before: u32,
    seed: u64,
    level: String,
    method: String,
    reorder: &'static str,
    threads: usize,
    generation_ms: f64,
    traversal_ms: f64,
    shading_ms: f64,
    total_ms: f64,
    rays: u64,
    mrays_per_s: f64,
    /// Rays whose first hit was asked for and rays to lights, after each number of reflections.
    bounces: Vec<[u64; 2]>,
    image_hash: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    cost: Option<Cost>,
    #[serde(flatten)]
    written: Written,
}

/// Renders, writes and reports, on the current rayon pool.
pub fn picture(args: &Args, work: &Workload, structure: &Structure, console: &Console) -> Result<(), Error> {
    let config = args.light.config(args)?;
    let scene = &work.scene;
    let camera = args.picture.camera.unwrap_or_else(|| scene.camera_or_default());
    let scenery = match args.environment.open(work)? {
        Some(map) => Scenery::in_environment(scene, map),
        None => Scenery::new(scene, &camera),
    };
    let choice = structure.choice;
    let method = choice.over(&structure.tree, config.level, config.lanes, args.trace.form());
    let reorder = args.trace.reorder.reorder;
    let method = reordered(method, &scene.mesh.bounds(), config.level, reorder);
    let mut cx = Context { counters: None, cancel: Some(console.cancel()) };
    let means = Means { method: &*method, cx: &mut cx, observer: None, progress: console };
    let (rendering, samples_before) = args.checkpoint.render(scene, &scenery, camera, &config, means, console)?;
    console.clear();

    let cost = args.light.cost.as_ref().map(|path| Cost::write(&rendering, path)).transpose()?;
    let output = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.png", scene.name)));
    let Rendering { ref image, samples, ref times, .. } = rendering;
    let (size, image_hash, times) = ([image.width, image.height], format!("{:016x}", image.hash()), times.clone());
    let output_bytes = if args.light.layers {
        let layers = Layers::new(&scenery, &camera, &config, &*method, &mut cx)?;
        picture::write_layers(rendering, layers, &output)?
    } else {
        picture::write(&args.light.developed(image, &output), &output)?
    };
    let total_ms = ms(times.total());
    let report = Report {
        subject: Subject::new(work, structure, &camera, size),
        integrator: args.light.integrator.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default(),
        samples,
        samples_before,
        seed: config.seed,
        level: config.level.to_string(),
        method: choice.name(),
        reorder: reorder.name(),
        threads: rayon::current_num_threads(),
        generation_ms: ms(times.generation),
        traversal_ms: ms(times.traversal),
        shading_ms: ms(times.shading),
        total_ms,
        rays: times.rays(),
        mrays_per_s: mrays_per_s(times.rays() as usize, total_ms),
        bounces: times.bounces.iter().map(|b| [b.closest, b.any]).collect(),
        image_hash,
        cost,
        written: Written { output, output_bytes },
    };
    if args.json { console.print_json(&report) } else { console.print(&text(&report)) }
}

fn text(r: &Report) -> String {
    let (subject, written, rays) = (r.subject.text(), r.written.text(), HumanCount(r.rays));
    let cost = r.cost.as_ref().map(Cost::text).unwrap_or_default();
    let Subject { width, height, .. } = r.subject;
    let Report { integrator, samples, level, method, reorder, threads, .. } = r;
    let Report { generation_ms, traversal_ms, shading_ms, total_ms, mrays_per_s, .. } = r;
    let before = if r.samples_before > 0 { format!(" ({} before)", r.samples_before) } else { String::new() };
    let share = |part: f64| 100.0 * part / total_ms.max(1e-9);
    let [g, t, s] = [*generation_ms, *traversal_ms, *shading_ms].map(share);
    let mut bounces = String::new();
    for (i, [closest, any]) in r.bounces.iter().enumerate() {
        let _ = writeln!(bounces, "  {i:>8}   {:>14} {:>14}", HumanCount(*closest), HumanCount(*any));
    }
    format!(
        "\
{subject}rendered  {width}x{height} by {integrator}, samples: {samples}{before}; level {level}, method {method}, reorder {reorder}, threads: {threads}
  generation {generation_ms:>10.2} ms {g:>5.1} %
  traversal  {traversal_ms:>10.2} ms {t:>5.1} %
  shading    {shading_ms:>10.2} ms {s:>5.1} %
  total      {total_ms:>10.2} ms, {mrays_per_s:.2} Mrays/s ({rays} rays)
  bounce             rays  rays to lights
{bounces}{cost}{written}"
    )
}
