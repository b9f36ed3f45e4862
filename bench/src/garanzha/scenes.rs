//! The paper's scenes, or what is nearest to them, and their eye rays and soft shadows.

use crate::console::Console;
use crate::report::scenes::{self, View};
use clap::ValueEnum;
use serde::Serialize;
use std::fmt;
use tracer::Error;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, OctoBvh, OctoConfig, WideBvh};
use tracer::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch};
use tracer::method::{Auto, Context, Method, Width};
use tracer::model::Camera;
use tracer::progress::Progress;
use tracer::render::EyeRays;
use tracer::sort::z_order;

/// A scene of the paper, in the order of its figure 11.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
pub enum Name {
    /// A stand-in: the built-in tree on its field
    Fairy,
    /// The conference room
    Conference,
    /// Crytek's Sponza in place of Dabrovic's
    Sponza,
}

impl Name {
    /// In the order of the paper, those of a list or all.
    pub fn chosen(names: &[Self]) -> Vec<Self> {
        let all = [Self::Fairy, Self::Conference, Self::Sponza];
        all.into_iter().filter(|name| names.is_empty() || names.contains(name)).collect()
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Fairy => "Fairy (stand-in)",
            Self::Conference => "Conference",
            Self::Sponza => "Sponza",
        })
    }
}

/// A horizontal square that shines: `up` is the axis of its height.
#[derive(Debug, Clone, Copy)]
struct Lamp {
    up: usize,
    center: [f32; 3],
    half: f32,
}

impl Lamp {
    /// The point at (u, v), both from -1 to 1, of a lamp so many times as large.
    fn at(&self, scale: f32, u: f32, v: f32) -> [f32; 3] {
        let mut at = self.center;
        at[(self.up + 1) % 3] += scale * self.half * u;
        at[(self.up + 2) % 3] += scale * self.half * v;
        at
    }
}

/// A scene ready to be traced.
pub struct Scene {
    pub name: Name,
    /// What it is, for the report.
    pub what: String,
    pub bvh: Bvh,
    /// Eight children a node.
    pub octo: OctoBvh,
    /// Two, with leaves as large.
    pub halves: OctoBvh,
    pub wide: WideBvh<8>,
    pub bounds: Aabb,
    camera: Camera,
    lamp: Lamp,
}

impl Scene {
    /// Reads or makes it and builds its trees; none when its file is missing, which is said on standard output.
    pub fn open(name: Name, console: &Console) -> Result<Option<Self>, Error> {
        console.stage(&format!("{name}: reading"), 0);
        let (view, lamp) = match name {
            Name::Fairy => (scenes::fairy()?, Lamp { up: 2, center: [0.0, 0.0, 8.0], half: 0.5 }),
            // Below the ceiling, which is at 8.9.
            Name::Conference => (scenes::conference(console)?, Lamp { up: 2, center: [17.8, 11.0, 8.8], half: 1.5 }),
            // Above the opening of the roof.
            Name::Sponza => (scenes::sponza(console)?, Lamp { up: 1, center: [-5.0, 140.0, -3.5], half: 8.0 }),
        };
        let Some(view) = view else { return Ok(None) };
        let what = view.describe();
        let View { model, camera, .. } = view;
        let bvh = Bvh::build(&model.mesh, &BuildConfig::medium(), console)?;
        let octo = OctoBvh::new(&bvh, &OctoConfig::default())?;
        let halves = OctoBvh::new(&bvh, &OctoConfig { levels: 1, ..OctoConfig::default() })?;
        let wide = bvh.collapse(&CollapseConfig::default());
        console.clear();
        Ok(Some(Self { name, what, bvh, octo, halves, wide, bounds: model.mesh.bounds(), camera, lamp }))
    }

    /// Eye rays along a Z-curve, and what they hit.
    pub fn eye(&self, [width, height]: [usize; 2], cx: &mut Context<'_>) -> Result<(RayBatch, HitBatch), Error> {
        let rays = eye_rays(&self.camera, [width, height]);
        let mut hits = HitBatch::new();
        Auto::new(&self.wide, simd::Level::best()).closest(&rays, &mut hits, cx)?;
        Ok((rays, hits))
    }

    /// The points that eye rays hit.
    pub fn points(rays: &RayBatch, hits: &HitBatch) -> Vec<[f32; 3]> {
        let seen = rays.iter().zip(hits.iter()).filter(|(_, hit)| !hit.is_miss());
        seen.map(|(ray, hit): (Ray, Hit)| [0, 1, 2].map(|i| ray.org[i] + hit.t * ray.dir[i])).collect()
    }

    /// Shadow rays from points to the lamp, so many times as large: `samples` from each, one in each cell of a square grid on it. Those of a point
    /// come one after the other. They keep away from both ends by a thousandth.
    pub fn shadows(&self, points: &[[f32; 3]], samples: usize, scale: f32) -> RayBatch {
        let side = samples.isqrt().max(1);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        let mut rays = RayBatch::new();
        for &org in points {
            for sample in 0..side * side {
                let u = 2.0 * ((sample % side) as f32 + random()) / side as f32 - 1.0;
                let v = 2.0 * ((sample / side) as f32 + random()) / side as f32 - 1.0;
                let to = self.lamp.at(scale, u, v);
                let dir = [0, 1, 2].map(|i| to[i] - org[i]);
                rays.push(Ray { org, t_min: 1e-3, dir, t_max: 1.0 - 1e-3 });
            }
        }
        rays
    }
}

/// Eye rays along a Z-curve.
fn eye_rays(camera: &Camera, [width, height]: [usize; 2]) -> RayBatch {
    let rows = EyeRays::new(camera, width, height, simd::Level::best(), Width::Auto).by_rows();
    z_order(width, height).into_iter().map(|pixel| rows.get(pixel as usize)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_eye_rays_are_four_by_four_pixels() {
        let camera = Camera { eye: [0.0; 3], at: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0], fov: 90.0 };
        let rays: Vec<Ray> = eye_rays(&camera, [64, 48]).iter().collect();
        assert_eq!(rays.len(), 64 * 48);
        let apart = |a: &Ray, b: &Ray| (0..3).map(|i| (a.dir[i] - b.dir[i]).powi(2)).sum::<f32>().sqrt();
        let pixel = apart(&rays[0], &rays[1]);
        for block in rays.chunks(16) {
            assert!(block.iter().all(|ray| apart(&block[0], ray) < 4.5 * pixel));
        }
    }
}
