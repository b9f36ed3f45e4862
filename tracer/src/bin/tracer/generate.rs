//! `tracer generate`: the built-in scenes as files.

use crate::console::Console;
use crate::workload::check_size;
use clap::builder::PossibleValuesParser;
use indicatif::HumanCount;
use std::path::PathBuf;
use std::process::ExitCode;
use tracer::Error;
use tracer::model::Builtin;
use tracer::progress::Progress;

/// Write a built-in scene to a file
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tracer generate balls -o balls.obj                the sphereflake, with balls.mtl beside it
  tracer generate hairball --size 100 -o hair.ply   fewer hairs, as PLY")]
pub struct Args {
    /// Which scene
    #[arg(value_parser = PossibleValuesParser::new(Builtin::ALL.map(Builtin::name)))]
    scene: String,
    /// How large: levels of balls and tree, layers of rings, hairs of the hairball [default: the papers' sizes: balls 4,
    /// rings 7, tree 12, hairball 6000]
    #[arg(long, value_name = "N")]
    size: Option<u32>,
    /// File to write, .obj (with its .mtl) or .ply (triangles alone)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

pub fn run(args: &Args, console: &Console) -> Result<ExitCode, Error> {
    let which = Builtin::ALL.into_iter().find(|b| b.name() == args.scene);
    let which = which.ok_or_else(|| Error::Usage(format!("{}: no such scene", args.scene)))?;
    let size = args.size.unwrap_or_else(|| which.default_size());
    check_size(which, size)?;
    console.stage("generate", 0);
    let scene = which.scene(size)?;
    scene.write(&args.output, console)?;
    let triangles = HumanCount(scene.mesh.triangles.len() as u64);
    console.print(&format!("wrote {}: {triangles} triangles\n", args.output.display()))?;
    Ok(ExitCode::SUCCESS)
}
