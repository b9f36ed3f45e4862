//! Shading of a portion of rays: what surfaces send out themselves, rays to lights, rays that go on.

use super::columns::{Columns, ROWS, Rows};
use super::groups::{Groups, NOTHING, Step};
use super::lists::{DENSITY, Lists, Paths, Shadows, THROUGHPUT, ten};
use super::place::Place;
use super::sky::{Around, SkySpots};
use crate::geometry::{HitBlock, RayBlock, Vec3};
use crate::lanes::{self, Lanes, Width};
use crate::model::Light;
use crate::render::Sampler;
use crate::render::lights::{LightSample, Lights};
use crate::render::material::{Branch, Frame, Model, Options, Parameters};
use crate::render::scenery::Scenery;
use crate::render::shade::{word, words3};
use simd::{Float, Level, Mask, Vector};
use std::f32::consts::PI;

/// What is done at each hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    /// Every point light and both rays of glass, no ray from what is not smooth (Whitted 1980); else one light and one ray, by chance
    /// (Kajiya 1986).
    pub(super) whitted: bool,
    /// No ray goes on from here.
    pub(super) last: bool,
    pub(super) mis: bool,
    pub(super) roulette: bool,
    pub(super) coat_alone: bool,
    pub(super) group: bool,
}

/// What all portions of a wave share.
pub(super) struct Wave<'a> {
    pub(super) scenery: &'a Scenery,
    pub(super) sampler: Sampler,
    pub(super) sample: u32,
    /// Reflections before.
    pub(super) depth: u32,
    pub(super) rules: Rules,
    /// Of each slot.
    pub(super) pixels: &'a [u32],
    pub(super) paths: &'a Paths,
}

/// What comes of a portion.
#[derive(Debug, Clone)]
pub(super) struct Shaded {
    /// Light that reaches the eye for certain.
    pub(super) light: Lists<3>,
    pub(super) shadows: Shadows,
    /// How many of these rays there are up to the first light source that was asked, the second, and so on.
    pub(super) sources: Vec<usize>,
    pub(super) paths: Paths,
    /// The same for each branch.
    pub(super) branches: Vec<usize>,
}

/// Columns between the steps.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    place: Columns<14>,
    /// What textures multiply colours by; nothing where there are none.
    tint: Columns<3>,
    pub(super) light: Columns<7>,
    pub(super) next: Columns<10>,
    pub(super) models: Box<[u32; ROWS]>,
    materials: Box<[u32; ROWS]>,
    pub(super) pixels: Box<[u32; ROWS]>,
    groups: Groups,
}

/// Columns of [`Scratch::place`].
const POSITION: usize = 0;
const FACE: usize = 3;
const NORMAL: usize = 6;
const TO_EYE: usize = 9;
const OFFSET: usize = 12;
const SIDE: usize = 13;
/// Of [`Scratch::light`].
pub(super) const TO_LIGHT: usize = 0;
pub(super) const RADIANCE: usize = 3;
pub(super) const LIGHT_DENSITY: usize = 6;
/// Of [`Scratch::next`], until directions are chosen: what comes from the environment map where nothing is hit.
pub(super) const AROUND: usize = 0;

impl Scratch {
    pub(super) fn new() -> Self {
        Self {
            place: Columns::new(),
            tint: Columns::new(),
            light: Columns::new(),
            next: Columns::new(),
            models: Box::new([NOTHING; ROWS]),
            materials: Box::new([0; ROWS]),
            pixels: Box::new([0; ROWS]),
            groups: Groups::new(),
        }
    }
}

/// The work on a portion: rays `first..first + len`.
pub(super) struct Portion<'a> {
    pub(super) wave: &'a Wave<'a>,
    pub(super) first: usize,
    pub(super) len: usize,
    pub(super) rays: &'a [RayBlock],
    pub(super) hits: &'a [HitBlock],
    pub(super) scratch: &'a mut Scratch,
}

/// The steps of the work on a portion are dispatched one by one: one function of all of them takes long to compile, and megabytes of stack where
/// nothing is optimized.
struct Places<'a, 'b>(&'a mut Portion<'b>, &'a mut Lists<3>);

impl Lanes for Places<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        self.0.places::<F>(self.1);
        let (scratch, len) = (&mut *self.0.scratch, self.0.len);
        scratch.groups.set::<F>(&scratch.models, len, self.0.wave.rules.group);
    }
}

struct Spots<'a, 'b>(&'a mut Portion<'b>, Source<'a>);

impl Lanes for Spots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        self.0.spots::<F>(self.1);
    }
}

struct ToLights<'a, 'b>(&'a mut Portion<'b>, &'a mut Shadows);

impl Lanes for ToLights<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        self.0.lights::<F>(self.1);
    }
}

struct Onwards<'a, 'b>(&'a mut Portion<'b>, Branch, &'a mut Paths);

impl Lanes for Onwards<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        self.0.directions::<F>(self.1, self.2);
    }
}

/// Which light.
#[derive(Clone, Copy)]
enum Source<'a> {
    Point(Light),
    Any(&'a Lights),
}

impl Portion<'_> {
    /// The part of a list of the paths that belongs to this portion.
    #[inline(always)]
    pub(super) fn path_list(&self, number: usize) -> &[f32] {
        &self.wave.paths.list(number)[self.first..][..self.len]
    }

    #[inline(always)]
    fn throughput<F: Float>(&self, first: usize) -> Vec3<F> {
        Vec3 {
            x: F::load_partial(&self.path_list(THROUGHPUT)[first..]),
            y: F::load_partial(&self.path_list(THROUGHPUT + 1)[first..]),
            z: F::load_partial(&self.path_list(THROUGHPUT + 2)[first..]),
        }
    }

    #[inline(always)]
    fn slots<F: Float>(&self, first: usize) -> F::Index {
        F::Index::load_partial(&self.wave.paths.slots[self.first + first..self.first + self.len])
    }

    /// First step: where rays meet what, and the light that comes from there by itself.
    #[inline(always)]
    fn places<F: Float>(&mut self, light: &mut Lists<3>) {
        let Wave { scenery, rules, pixels, .. } = *self.wave;
        let mut first = 0;
        while first < self.len {
            let (block, chunk) = (first / 16, first % 16 / F::LANES);
            let place = Place::<F>::load(scenery, &self.rays[block], &self.hits[block], chunk);
            let there = F::Mask::first_n(self.len - first);
            let hit = place.hit & there;

            let slots = self.slots::<F>(first);
            let pixel = F::Index::gather_masked(pixels, slots, there, F::Index::default());
            pixel.store(&mut self.scratch.pixels[first..]);
            place.material.store(&mut self.scratch.materials[first..]);
            let nothing = F::Index::splat(NOTHING);
            let model = F::Index::gather_masked(&scenery.models, place.material, hit, nothing);
            model.store(&mut self.scratch.models[first..]);
            let columns = &mut self.scratch.place;
            columns.store3(POSITION, first, place.position);
            columns.store3(FACE, first, place.face);
            columns.store3(NORMAL, first, place.normal);
            columns.store3(TO_EYE, first, place.to_eye);
            columns.store(OFFSET, first, place.offset);
            columns.store(SIDE, first, place.side);
            let textures = &scenery.surfaces.textures;
            let mut tint = Vec3::splat([1.0; 3]);
            if !textures.is_empty() {
                tint = place.tint(textures, &self.hits[block], chunk);
                self.scratch.tint.store3(0, first, tint);
            }

            let materials = &scenery.materials;
            let emission = words3::<F>(materials, place.material, Scenery::MATERIAL, 11, hit);
            let density = F::load_partial(&self.path_list(DENSITY)[first..]);
            let mut radiance = emission.scale(share_of_emission(&scenery.lights, emission, density, &place));
            if rules.whitted {
                let ambient = words3::<F>(materials, place.material, Scenery::MATERIAL, 14, hit);
                radiance = radiance + (ambient * tint).scale(F::splat(scenery.ambient));
            }
            let around = match scenery.map {
                Some(_) => self.scratch.next.load3(AROUND, first),
                None => Vec3::splat(scenery.environment),
            };
            let radiance = Vec3::select(hit, radiance, around) * self.throughput(first);
            let some = there & is_light(radiance);
            if some.any() {
                light.push(some, [radiance.x, radiance.y, radiance.z], slots);
            }
            first += F::LANES;
        }
    }

    /// Second step: a light for each place.
    #[inline(always)]
    fn spots<F: Float>(&mut self, source: Source<'_>) {
        let Wave { sampler, sample, depth, .. } = *self.wave;
        let mut first = 0;
        while first < self.len {
            let lit = F::Index::load(&self.scratch.models[first..]).lt(F::Index::splat(3));
            let place = &self.scratch.place;
            let (position, face) = (place.load3::<F>(POSITION, first), place.load3(FACE, first));
            let from = position + face.scale(place.load(OFFSET, first));
            let light = match source {
                Source::Point(light) => LightSample {
                    to_light: Vec3::splat(light.position) - from,
                    radiance: Vec3::splat(light.intensity.map(|c| PI * c)),
                    density: F::splat(f32::INFINITY),
                },
                Source::Any(lights) => {
                    let pixel = F::Index::load(&self.scratch.pixels[first..]);
                    let choice = sampler.pair::<F>(pixel, sample, 1 + 4 * depth);
                    let spot = sampler.pair::<F>(pixel, sample, 2 + 4 * depth);
                    lights.sample(from, choice, spot, lit)
                }
            };
            let radiance = Vec3::select(lit, light.radiance, Vec3::splat([0.0; 3]));
            let columns = &mut self.scratch.light;
            columns.store3(TO_LIGHT, first, light.to_light);
            columns.store3(RADIANCE, first, radiance);
            columns.store(LIGHT_DENSITY, first, light.density);
            first += F::LANES;
        }
    }

    /// Third step: what comes of it, and the ray to it.
    #[inline(always)]
    fn lights<F: Float>(&mut self, shadows: &mut Shadows) {
        let scenery = self.wave.scenery;
        let Scratch { place, tint, light, materials, groups, .. } = &mut *self.scratch;
        let list = |i| &self.wave.paths.list(THROUGHPUT + i)[self.first..][..self.len];
        let throughput = [list(0), list(1), list(2)];
        groups.each::<F, _>(&mut Values {
            surface: Surface { scenery, place, tint, materials },
            wave: self.wave,
            throughput,
            light,
        });

        shadows.reserve(self.len);
        let mut first = 0;
        while first < self.len {
            let columns = &self.scratch.light;
            let radiance = columns.load3::<F>(RADIANCE, first);
            let there = F::Mask::first_n(self.len - first) & is_light(radiance);
            if there.any() {
                let place = &self.scratch.place;
                let (position, face) = (place.load3::<F>(POSITION, first), place.load3(FACE, first));
                let from = position + face.scale(place.load(OFFSET, first));
                let ray = ten(from, columns.load3(TO_LIGHT, first), radiance, F::splat(1.0));
                shadows.push(there, ray, self.slots::<F>(first));
            }
            first += F::LANES;
        }
    }

    /// Fourth step: a direction for each place, and the ray that goes on.
    #[inline(always)]
    fn directions<F: Float>(&mut self, branch: Branch, paths: &mut Paths) {
        let mut first = 0;
        while first < self.len {
            self.scratch.next.store3(THROUGHPUT, first, Vec3::<F>::splat([0.0; 3]));
            first += F::LANES;
        }
        let scenery = self.wave.scenery;
        let Scratch { place, tint, next, materials, pixels, groups, .. } = &mut *self.scratch;
        let list = |i| &self.wave.paths.list(THROUGHPUT + i)[self.first..][..self.len];
        let throughput = [list(0), list(1), list(2)];
        groups.each::<F, _>(&mut Directions {
            surface: Surface { scenery, place, tint, materials },
            wave: self.wave,
            branch,
            throughput,
            next,
            pixels,
        });

        paths.reserve(self.len);
        let mut first = 0;
        while first < self.len {
            let columns = &self.scratch.next;
            let throughput = columns.load3::<F>(THROUGHPUT, first);
            let there = F::Mask::first_n(self.len - first) & is_light(throughput);
            if there.any() {
                let (origin, direction) = (columns.load3(0, first), columns.load3(3, first));
                let ray = ten(origin, direction, throughput, columns.load(DENSITY, first));
                paths.push(there, ray, self.slots::<F>(first));
            }
            first += F::LANES;
        }
    }
}

/// Whether it is more than nothing, and finite.
#[inline(always)]
fn is_light<F: Float>(rgb: Vec3<F>) -> F::Mask {
    let sum = rgb.x + rgb.y + rgb.z;
    F::splat(0.0).lt(sum) & sum.lt(F::splat(f32::INFINITY))
}

/// How much of what a surface sends out counts for a path that found it by chance, with this density: the rest is found by choosing lights
/// (Veach 1997, section 9.2: the power heuristic, with exponent 2).
#[inline(always)]
fn share_of_emission<F: Float>(lights: &Lights, emission: Vec3<F>, density: F, place: &Place<F>) -> F {
    let cos = place.face.dot(place.to_eye);
    let of_light = lights.density_of(emission) * (place.distance * place.distance) / cos;
    let by_chance_alone = F::splat(f32::INFINITY).le(density);
    power_heuristic(F::select(by_chance_alone, F::splat(0.0), of_light / density), density)
}

/// 1 / (1 + ratio^2); nothing where the own density is zero.
#[inline(always)]
pub(super) fn power_heuristic<F: Float>(ratio: F, own: F) -> F {
    let one = F::splat(1.0);
    F::select(F::splat(0.0).lt(own), one / (one + ratio * ratio), F::splat(0.0))
}

/// The surface at all places.
#[derive(Clone, Copy)]
struct Surface<'a> {
    scenery: &'a Scenery,
    place: &'a Columns<14>,
    tint: &'a Columns<3>,
    materials: &'a [u32; ROWS],
}

impl Surface<'_> {
    /// What models read, and the frame of the surface.
    #[inline(always)]
    fn parameters<F: Float>(&self, rows: Rows<F>, options: Options) -> (Parameters<F>, Frame<F>) {
        let material = F::Index::gather_masked(self.materials, rows.index, rows.on, F::Index::default());
        let table = &self.scenery.materials[..];
        let mut parameters = Parameters {
            diffuse: words3(table, material, Scenery::MATERIAL, 0, rows.on),
            specular: words3(table, material, Scenery::MATERIAL, 3, rows.on),
            shininess: word(table, material, Scenery::MATERIAL, 6, rows.on),
            transmission: words3(table, material, Scenery::MATERIAL, 7, rows.on),
            ior: word(table, material, Scenery::MATERIAL, 10, rows.on),
            front: F::splat(0.0).lt(self.place.get(SIDE, rows)),
            options,
        };
        let textures = &self.scenery.surfaces.textures;
        if !textures.is_empty() {
            let tint = self.tint.get3(0, rows);
            parameters.diffuse = parameters.diffuse * tint;
            parameters.specular = textures.specular(parameters.specular, tint, material, rows.on);
        }
        (parameters, Frame::around(self.place.get3(NORMAL, rows)))
    }
}

/// What the model makes of the light from a light source.
struct Values<'a> {
    surface: Surface<'a>,
    wave: &'a Wave<'a>,
    throughput: [&'a [f32]; 3],
    light: &'a mut Columns<7>,
}

impl<F: Float> Step<F> for Values<'_> {
    #[inline(always)]
    fn run<M: Model>(&mut self, rows: Rows<F>) {
        if !M::LIT {
            return;
        }
        let Surface { place, .. } = self.surface;
        let rules = self.wave.rules;
        let options = Options { coat_alone: rules.coat_alone, branch: Branch::Random };
        let (parameters, frame) = self.surface.parameters(rows, options);
        let to_eye = frame.local(place.get3(TO_EYE, rows));
        let direction = self.light.get3::<F>(TO_LIGHT, rows).normalize();
        let to_light = frame.local(direction);
        let above = F::splat(0.0).lt(to_light.z) & F::splat(0.0).lt(direction.dot(place.get3(FACE, rows)));

        let mut share = F::splat(1.0);
        if rules.mis && !rules.last {
            let density: F = self.light.get(LIGHT_DENSITY, rows);
            share = power_heuristic(M::density(&parameters, to_eye, to_light) / density, density);
        }
        let value = M::value(&parameters, to_eye, to_light).scale(to_light.z * share);
        let throughput = throughput(self.throughput, rows);
        let contribution = throughput * value * self.light.get3(RADIANCE, rows);
        self.light.set3(RADIANCE, rows, Vec3::select(above, contribution, Vec3::splat([0.0; 3])));
    }
}

/// Where the model sends a ray on.
struct Directions<'a> {
    surface: Surface<'a>,
    wave: &'a Wave<'a>,
    branch: Branch,
    throughput: [&'a [f32]; 3],
    next: &'a mut Columns<10>,
    pixels: &'a [u32; ROWS],
}

impl<F: Float> Step<F> for Directions<'_> {
    #[inline(always)]
    fn run<M: Model>(&mut self, rows: Rows<F>) {
        if !M::follows(self.branch) {
            return;
        }
        let Surface { place, .. } = self.surface;
        let Wave { rules, sampler, sample, depth, .. } = *self.wave;
        let options = Options { coat_alone: rules.coat_alone, branch: self.branch };
        let (parameters, frame) = self.surface.parameters(rows, options);
        let to_eye = frame.local(place.get3(TO_EYE, rows));
        let pixel = F::Index::gather_masked(self.pixels, rows.index, rows.on, F::Index::default());
        let point = sampler.pair::<F>(pixel, sample, 3 + 4 * depth);
        let [lobe, survival] = sampler.pair::<F>(pixel, sample, 4 + 4 * depth);
        let chosen = M::sample(&parameters, to_eye, point, lobe);

        let direction = frame.world(chosen.to_light).normalize();
        let face = place.get3::<F>(FACE, rows);
        let along = direction.dot(face);
        // On the same side of the triangle as of the normal to shade with.
        let possible = F::splat(0.0).lt(along.mul_sign(chosen.to_light.z));
        let offset = place.get::<F>(OFFSET, rows).mul_sign(along);
        let origin = place.get3(POSITION, rows) + face.scale(offset);

        let (zero, infinity) = (F::splat(0.0), F::splat(f32::INFINITY));
        let mut throughput = throughput(self.throughput, rows) * chosen.weight;
        throughput = Vec3::select(possible, throughput, Vec3::splat([0.0; 3]));
        if rules.roulette && depth >= FIRST_ROULETTE {
            let largest = throughput.x.max(throughput.y).max(throughput.z);
            let chance = largest.min(F::splat(1.0));
            let survivor = throughput.scale(F::splat(1.0) / chance);
            throughput = Vec3::select(survival.lt(chance), survivor, Vec3::splat([0.0; 3]));
        }
        let by_chance = zero.le(chosen.density) & chosen.density.lt(infinity);
        let density = if rules.mis { chosen.density } else { F::select(by_chance, zero, chosen.density) };
        self.next.set3(0, rows, origin);
        self.next.set3(3, rows, direction);
        self.next.set3(THROUGHPUT, rows, throughput);
        self.next.set(DENSITY, rows, density);
    }
}

/// Reflections before the first roulette.
const FIRST_ROULETTE: u32 = 2;

#[inline(always)]
fn throughput<F: Float>(lists: [&[f32]; 3], rows: Rows<F>) -> Vec3<F> {
    Vec3 { x: rows.of(lists[0]), y: rows.of(lists[1]), z: rows.of(lists[2]) }
}

/// Shades a portion.
pub(super) fn shade(level: Level, width: Width, mut portion: Portion<'_>) -> Shaded {
    let (sources, branches) = (Vec::new(), Vec::new());
    let mut shaded = Shaded { light: Lists::new(), shadows: Lists::new(), sources, paths: Lists::new(), branches };
    let Wave { scenery, rules, .. } = *portion.wave;
    shaded.light.reserve(portion.len);
    if let Some(map) = &scenery.map {
        lanes::run_long(level, width, Around(&mut portion, map));
    }
    lanes::run_long(level, width, Places(&mut portion, &mut shaded.light));
    let (points, others) =
        if rules.whitted { (&scenery.points[..], &scenery.lamps) } else { (&[][..], &scenery.lights) };
    let any = (!others.is_empty()).then_some(Source::Any(others));
    let sky = scenery.map.as_ref().filter(|map| map.weight() > 0.0);
    for source in points.iter().map(|&point| Source::Point(point)).chain(any) {
        lanes::run_long(level, width, Spots(&mut portion, source));
        if let (false, Some(map)) = (rules.whitted, sky) {
            lanes::run_long(level, width, SkySpots(&mut portion, map, scenery.lights.environment()));
        }
        lanes::run_long(level, width, ToLights(&mut portion, &mut shaded.shadows));
        shaded.sources.push(shaded.shadows.len());
    }
    if let Some(map) = sky
        && (rules.whitted || any.is_none())
    {
        lanes::run_long(level, width, SkySpots(&mut portion, map, 1.0));
        lanes::run_long(level, width, ToLights(&mut portion, &mut shaded.shadows));
        shaded.sources.push(shaded.shadows.len());
    }
    let branches: &[Branch] = match (rules.last, rules.whitted) {
        (true, _) => &[],
        (_, true) => &[Branch::Reflected, Branch::Refracted],
        (_, false) => &[Branch::Random],
    };
    for &branch in branches {
        lanes::run_long(level, width, Onwards(&mut portion, branch, &mut shaded.paths));
        shaded.branches.push(shaded.paths.len());
    }
    shaded
}
