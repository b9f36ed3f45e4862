//! Pictures that can be gone on with: `tracer render --checkpoint`.

use crate::console::Console;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tracer::Error;
use tracer::model::{Camera, Model};
use tracer::render::Scenery;
use tracer::render::integrator::{self, Config, Film, Identity, Means, Rendering};

/// Where to keep what is done.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Light")]
pub struct CheckpointOptions {
    /// Keep what is done in this file, now and then, at the end and upon Ctrl-C; where the file exists, go on from there, for whitted, ao and path.
    /// The picture has the same bits as one made at once; for more --samples, ask for more
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Write the checkpoint after so many seconds [default: 30]
    #[arg(long, value_name = "SECONDS", requires = "checkpoint")]
    checkpoint_every: Option<f64>,
}

impl CheckpointOptions {
    /// Refuses what makes no sense.
    pub fn check(&self) -> Result<(), Error> {
        match self.checkpoint_every {
            Some(seconds) if !(0.0..=1e9).contains(&seconds) => {
                Err(Error::Usage("--checkpoint-every: give a number of seconds from 0 to 1e9".into()))
            }
            _ => Ok(()),
        }
    }

    /// Makes the picture, on from the checkpoint if there is one. With it, the samples that were there before.
    pub fn render(
        &self,
        model: &Model,
        scenery: &Scenery,
        camera: Camera,
        config: &Config,
        means: Means<'_, '_>,
        console: &Console,
    ) -> Result<(Rendering, u32), Error> {
        let Some(path) = &self.checkpoint else {
            return Ok((integrator::render(model, scenery, camera, config, means)?, 0));
        };
        let identity = Identity::new(model, scenery, &camera, config);
        let mut film = if path.exists() { Film::load(path, &identity, config)? } else { Film::new(config) };
        // A place that cannot be written to is known before the long work.
        film.save(path, &identity)?;
        let before = film.samples();
        let (mut kept, mut last) = (film.done(), Instant::now());
        let mut keep = |film: &Film| match film.save(path, &identity) {
            Ok(()) => kept = film.done(),
            // What is done may still become a picture.
            Err(e) => console.warn(&e.to_string()),
        };
        let every = Duration::from_secs_f64(self.checkpoint_every.unwrap_or(30.0));
        let rendering = integrator::resume(scenery, camera, config, means, &mut film, &mut |film| {
            if last.elapsed() >= every {
                keep(film);
                last = Instant::now();
            }
            Ok(())
        });
        keep(&film);
        if rendering.is_err() && kept == film.done() {
            let (done, all) = (film.samples(), config.samples);
            console.hint(&format!("{done} of {all} samples are in {}: the same command goes on", path.display()));
        }
        Ok((rendering?, before))
    }
}
