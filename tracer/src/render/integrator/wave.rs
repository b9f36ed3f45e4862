//! Waves of paths: trace, shade, move up.

use super::columns::ROWS;
use super::lists::{CONTRIBUTION, END, Lists, Paths, Shadows, fill};
use super::shade::{Portion, Rules, Scratch, Shaded, Wave};
use super::times::timed;
use super::{After, Config, Film, Integrator, Means, Query, Rendering, Times, ao, camera, shade};
use crate::Error;
use crate::clock::Clock;
use crate::geometry::{HitBatch, RayBatch};
use crate::method::BitVec;
use crate::model::Camera;
use crate::render::{Sampler, Scenery};
use rayon::prelude::*;

pub(super) fn render(
    scenery: &Scenery,
    camera: &Camera,
    config: &Config,
    means: Means<'_, '_>,
    film: &mut Film,
    after: &mut After<'_>,
) -> Result<Rendering, Error> {
    let pixels = camera::pixels(&film.crop);
    means.progress.stage("render", film.pixels() * u64::from(config.samples));
    means.progress.resume(film.done);
    let mut waves = Waves { scenery, camera, config, means, times: Times::default(), memory: Memory::default() };
    let start = Clock::now();
    let in_time = || config.time_limit.is_none_or(|limit| start.elapsed() < limit);
    while film.ahead() > 0 || film.samples() < config.samples && (film.samples() == 0 || in_time()) {
        let sample = film.samples();
        for pixels in pixels[film.ahead()..].chunks(config.batch) {
            waves.sample(pixels, sample)?;
            let Memory { radiance, traced, .. } = &waves.memory;
            timed(&mut waves.times.shading, || film.add(pixels, radiance, traced));
            let mrays = waves.times.rays() as f64 * 1e-6 / waves.times.total().as_secs_f64().max(1e-9);
            waves.means.progress.note(&format!("{mrays:.1} Mrays/s"));
            waves.means.progress.advance(pixels.len() as u64);
            after(film)?;
            waves.means.progress.check()?;
        }
    }
    Ok(film.rendering(waves.times))
}

/// What is used again by each wave.
#[derive(Debug)]
struct Memory {
    radiance: Vec<[f32; 3]>,
    /// Rays of each slot, if they are counted.
    traced: Vec<u32>,
    rays: RayBatch,
    paths: Paths,
    shadows: Shadows,
    shadow_rays: RayBatch,
    hits: HitBatch,
    occluded: BitVec,
    starts: Vec<f32>,
    ends: Vec<f32>,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            radiance: Vec::new(),
            traced: Vec::new(),
            rays: RayBatch::new(),
            paths: Lists::new(),
            shadows: Lists::new(),
            shadow_rays: RayBatch::new(),
            hits: HitBatch::new(),
            occluded: BitVec::new(),
            starts: Vec::new(),
            ends: Vec::new(),
        }
    }
}

struct Waves<'a, 'b, 'c> {
    scenery: &'a Scenery,
    camera: &'a Camera,
    config: &'a Config,
    means: Means<'b, 'c>,
    times: Times,
    memory: Memory,
}

impl Waves<'_, '_, '_> {
    /// One sample of these pixels: the light that comes to each.
    fn sample(&mut self, pixels: &[u32], sample: u32) -> Result<(), Error> {
        let memory = &mut self.memory;
        timed(&mut self.times.generation, || {
            memory.rays = camera::rays(self.config, self.camera, pixels, sample);
            memory.radiance.clear();
            memory.radiance.resize(pixels.len(), [0.0; 3]);
            memory.traced.clear();
            if self.config.count_rays {
                memory.traced.resize(pixels.len(), 1);
            }
        });
        match self.config.integrator {
            Integrator::AmbientOcclusion { distance } => self.occlusion(pixels, sample, distance),
            _ => self.paths(pixels, sample),
        }
    }

    fn occlusion(&mut self, pixels: &[u32], sample: u32, distance: f32) -> Result<(), Error> {
        self.closest(0)?;
        let Config { seed, level, lanes, .. } = *self.config;
        let Memory { rays, hits, radiance, shadows, .. } = &mut self.memory;
        timed(&mut self.times.shading, || {
            let portions = pixels.par_chunks(ROWS).enumerate().map(|(i, pixels)| {
                let blocks = i * ROWS / 16..(i * ROWS + pixels.len()).div_ceil(16);
                let portion = ao::Portion {
                    scenery: self.scenery,
                    sampler: Sampler::new(seed),
                    sample,
                    distance,
                    pixels,
                    first: i * ROWS,
                    rays: &rays.blocks()[blocks.clone()],
                    hits: &hits.blocks()[blocks],
                };
                ao::shade(level, lanes, portion)
            });
            let shaded: Vec<_> = portions.collect();
            shadows.clear();
            for (light, more) in &shaded {
                add(radiance, light);
                shadows.append(more, 0..more.len());
            }
        });
        self.count();
        self.any(0)
    }

    fn paths(&mut self, pixels: &[u32], sample: u32) -> Result<(), Error> {
        let (bounces, rules) = rules(self.config);
        timed(&mut self.times.generation, || self.memory.paths = Lists::of_eye(pixels.len()));
        for depth in 0..=bounces {
            self.closest(depth as usize)?;
            self.shade(pixels, sample, depth, Rules { last: depth == bounces, ..rules })?;
            self.any(depth as usize)?;
            if self.memory.paths.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// The first hits of the rays.
    fn closest(&mut self, depth: usize) -> Result<(), Error> {
        let (Memory { rays, hits, .. }, means) = (&mut self.memory, &mut self.means);
        self.times.bounce(depth).closest += rays.len() as u64;
        if let Some(observer) = &mut means.observer {
            observer(depth, Query::Closest, rays);
        }
        timed(&mut self.times.traversal, || means.method.closest(rays, hits, means.cx))
    }

    /// Shades the hits; what comes of it are the next rays and those to lights.
    fn shade(&mut self, pixels: &[u32], sample: u32, depth: u32, rules: Rules) -> Result<(), Error> {
        let Config { seed, level, lanes, .. } = *self.config;
        let Memory { rays, hits, radiance, shadows, paths, starts, ends, .. } = &mut self.memory;
        self.means.cx.check()?;
        timed(&mut self.times.shading, || {
            let sampler = Sampler::new(seed);
            let wave = Wave { scenery: self.scenery, sampler, sample, depth, rules, pixels, paths };
            let len = rays.len();
            let shade = |scratch: &mut Scratch, first: usize| {
                let blocks = first / 16..(first + ROWS).min(len).div_ceil(16);
                let (rays, hits) = (&rays.blocks()[blocks.clone()], &hits.blocks()[blocks]);
                let portion = Portion { wave: &wave, first, len: (len - first).min(ROWS), rays, hits, scratch };
                shade::shade(level, lanes, portion)
            };
            let portions = (0..len.div_ceil(ROWS)).into_par_iter().map(|i| i * ROWS);
            let shaded: Vec<Shaded> = portions.map_init(Scratch::new, shade).collect();

            paths.clear();
            shadows.clear();
            for portion in &shaded {
                add(radiance, &portion.light);
            }
            append(shadows, &shaded, |portion| (&portion.shadows, &portion.sources));
            append(paths, &shaded, |portion| (&portion.paths, &portion.branches));
            ends.clear();
            ends.resize(paths.len(), f32::INFINITY);
            fill(rays, paths, starts, ends);
        });
        self.count();
        Ok(())
    }

    /// Counts the rays that come of hits, if that is wanted.
    fn count(&mut self) {
        if !self.config.count_rays {
            return;
        }
        let Memory { traced, paths, shadows, .. } = &mut self.memory;
        for lists in [paths, shadows] {
            for &slot in &lists.slots[..lists.len()] {
                traced[slot as usize] += 1;
            }
        }
    }

    /// The light along rays that nothing is in the way of.
    fn any(&mut self, depth: usize) -> Result<(), Error> {
        let (memory, means) = (&mut self.memory, &mut self.means);
        let Memory { radiance, shadows, shadow_rays, occluded, starts, .. } = memory;
        if shadows.is_empty() {
            return Ok(());
        }
        timed(&mut self.times.shading, || fill(shadow_rays, shadows, starts, shadows.list(END)));
        self.times.bounce(depth).any += shadow_rays.len() as u64;
        if let Some(observer) = &mut means.observer {
            observer(depth, Query::Any, shadow_rays);
        }
        timed(&mut self.times.traversal, || means.method.any(shadow_rays, occluded, means.cx))?;
        timed(&mut self.times.shading, || {
            let list = |i| shadows.list(CONTRIBUTION + i);
            let (r, g, b) = (list(0), list(1), list(2));
            for i in 0..shadows.len() {
                if !occluded.get(i) {
                    let sum = &mut radiance[shadows.slots[i] as usize];
                    *sum = [sum[0] + r[i], sum[1] + g[i], sum[2] + b[i]];
                }
            }
        });
        Ok(())
    }
}

fn rules(config: &Config) -> (u32, Rules) {
    let none = Rules {
        whitted: false,
        last: false,
        mis: false,
        roulette: false,
        coat_alone: false,
        group: config.group_shading,
    };
    match config.integrator {
        Integrator::Path(path) => {
            let super::Path { bounces, roulette, mis, coat_alone } = path;
            (bounces, Rules { mis, roulette, coat_alone, ..none })
        }
        Integrator::Whitted { bounces } => (bounces, Rules { whitted: true, ..none }),
        Integrator::Eye { .. } | Integrator::AmbientOcclusion { .. } => (0, none),
    }
}

/// Appends rays of all portions: those of the first step, then those of the second, and so on, each in the order of the rays that they come of. So the order
/// of those of one slot, in which their light is added up, does not depend on where portions end.
fn append(all: &mut Lists<10>, portions: &[Shaded], of: impl Fn(&Shaded) -> (&Lists<10>, &Vec<usize>)) {
    let steps = portions.first().map_or(0, |portion| of(portion).1.len());
    for step in 0..steps {
        for portion in portions {
            let (rays, ends) = of(portion);
            let first = if step == 0 { 0 } else { ends[step - 1] };
            all.append(rays, first..ends[step]);
        }
    }
}

/// Adds light to the slots it belongs to.
fn add(radiance: &mut [[f32; 3]], light: &Lists<3>) {
    let (r, g, b) = (light.list(0), light.list(1), light.list(2));
    for i in 0..light.len() {
        let sum = &mut radiance[light.slots[i] as usize];
        *sum = [sum[0] + r[i], sum[1] + g[i], sum[2] + b[i]];
    }
}
