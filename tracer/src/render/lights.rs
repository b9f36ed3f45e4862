//! Light sources: points and triangles that shine, one of them chosen for each point that is lit.

use super::material::{luminance, luminance_of, negate};
use super::scenery::offset_of;
use super::shade::{word, words3};
use crate::geometry::Vec3;
use crate::model::{Light, Model};
use simd::{Float, Vector};
use std::f32::consts::PI;

/// All light sources of a scene, with a table to choose one by what it contributes, about.
#[derive(Debug, Clone)]
pub(crate) struct Lights {
    /// [`Lights::WORDS`] words for each: a corner, two edges (zero for a point), radiance (a point's irradiance), probability, threshold and
    /// offset.
    table: Vec<f32>,
    /// Which to take where a number is not below the threshold.
    alias: Vec<u32>,
    /// Density per area at which points of triangles are chosen, over the luminance of their radiance.
    density: f32,
    /// The chance that none of them is chosen, but the environment.
    environment: f32,
}

/// A place on a light source.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LightSample<F: Float> {
    /// From the point that is lit, of full length.
    pub(crate) to_light: Vec3<F>,
    /// What comes from there over the density: times value and cosine, what goes to the eye.
    pub(crate) radiance: Vec3<F>,
    /// Density per solid angle; infinite for a point.
    pub(crate) density: F,
}

impl Lights {
    const WORDS: u32 = 15;

    /// Of these points and of the triangles of a valid model that shine, both sides of them. `radius` is the size of the scene. `environment` is
    /// the weight of what they share the choice with.
    pub(crate) fn new(points: &[Light], model: &Model, radius: f64, environment: f64) -> Self {
        let (mut table, mut weights) = (Vec::new(), Vec::new());
        let luminance = |c: [f32; 3]| f64::from(luminance_of(c));
        for light in points.iter().filter(|light| luminance(light.intensity) > 0.0) {
            weights.push(f64::from(PI) * luminance(light.intensity));
            table.extend(
                light.position.into_iter().chain([0.0; 6]).chain(light.intensity.map(|c| PI * c)).chain([0.0; 3]),
            );
        }
        let per_power = 1.0 / (radius * radius).max(1e-30);
        for i in 0..model.mesh.triangles.len() {
            let emission = model.materials[model.mesh.material(i) as usize].emission.map(|c| c.max(0.0));
            if luminance(emission) > 0.0 {
                let [v0, e1, e2] = corner_and_edges(model.mesh.triangle(i));
                let area = area(e1, e2);
                if area > 0.0 {
                    weights.push(luminance(emission) * area * per_power);
                    table.extend(v0.into_iter().chain(e1).chain(e2).chain(emission).chain([
                        0.0,
                        0.0,
                        offset_of(v0, e1, e2),
                    ]));
                }
            }
        }
        let total: f64 = weights.iter().sum();
        let (thresholds, alias) = alias_table(&weights, total);
        let total = total + environment;
        for (i, record) in table.chunks_exact_mut(Self::WORDS as usize).enumerate() {
            record[12] = (weights[i] / total) as f32;
            record[13] = thresholds[i];
        }
        let share = |weight: f64| if total > 0.0 { (weight / total) as f32 } else { 0.0 };
        Self { table, alias, density: share(per_power), environment: share(environment) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.alias.is_empty()
    }

    /// The chance that the environment is chosen: where the first number is below it.
    pub(crate) fn environment(&self) -> f32 {
        self.environment
    }

    /// The density per area, of a place on a triangle of this radiance.
    #[inline(always)]
    pub(crate) fn density_of<F: Float>(&self, radiance: Vec3<F>) -> F {
        luminance(radiance) * F::splat(self.density)
    }

    /// A place on a light source, as seen from a point: by two numbers that choose the source and two that choose the place. There must be sources.
    /// Where the environment is chosen the result has no meaning.
    #[inline(always)]
    pub(crate) fn sample<F: Float>(
        &self,
        from: Vec3<F>,
        choice: [F; 2],
        place: [F; 2],
        mask: F::Mask,
    ) -> LightSample<F> {
        let table = &self.table[..];
        let last = F::Index::splat((self.alias.len() - 1) as u32);
        let mut first = choice[0];
        if self.environment > 0.0 {
            let chance = F::splat(self.environment);
            first = ((first - chance) / (F::splat(1.0) - chance)).max(F::splat(0.0));
        }
        let index = (first * F::splat(self.alias.len() as f32)).to_uint().min(last);
        let threshold: F = word(table, index, Self::WORDS, 13, mask);
        let alias = F::Index::gather_masked(&self.alias, index, mask, index);
        let index = F::Index::select(choice[1].lt(threshold), index, alias);

        let corner = words3::<F>(table, index, Self::WORDS, 0, mask);
        let (e1, e2) = (words3(table, index, Self::WORDS, 3, mask), words3(table, index, Self::WORDS, 6, mask));
        let emission = words3(table, index, Self::WORDS, 9, mask);
        let probability: F = word(table, index, Self::WORDS, 12, mask);
        let offset: F = word(table, index, Self::WORDS, 14, mask);

        // Uniform over the triangle (Turk 1990).
        let root = place[0].sqrt();
        let point = corner + e1.scale(root * (F::splat(1.0) - place[1])) + e2.scale(root * place[1]);
        let normal = e1.cross(e2);
        let twice_area = normal.dot(normal).sqrt();
        let is_point = twice_area.le(F::splat(0.0));
        let normal = normal.scale(F::splat(1.0) / twice_area);

        // The ray ends before the triangle, on this side of it.
        let to_light = point - from;
        let away = normal.dot(to_light);
        let nearer = to_light + negate(normal).scale(offset.mul_sign(away));
        let distance2 = to_light.dot(to_light);
        let cos = away.abs() / distance2.sqrt();
        let density = probability * F::splat(2.0) / twice_area * (distance2 / cos);
        let seen = F::splat(0.0).lt(cos) & F::splat(0.0).lt(distance2);
        let of_triangle = Vec3::select(seen, emission.scale(F::splat(1.0) / density), Vec3::splat([0.0; 3]));
        LightSample {
            to_light: Vec3::select(is_point, to_light, nearer),
            radiance: Vec3::select(is_point, emission.scale(F::splat(1.0) / probability), of_triangle),
            density: F::select(is_point, F::splat(f32::INFINITY), density),
        }
    }
}

/// A corner of a triangle and its two edges from there.
pub(crate) fn corner_and_edges([a, b, c]: [[f32; 3]; 3]) -> [[f32; 3]; 3] {
    let edge = |p: [f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    [a, edge(b), edge(c)]
}

fn area(e1: [f32; 3], e2: [f32; 3]) -> f64 {
    let vec3 = |[x, y, z]: [f32; 3]| Vec3 { x, y, z };
    let normal = vec3(e1).cross(vec3(e2));
    f64::from(normal.dot(normal).sqrt()) / 2.0
}

/// To choose a number by weights in constant time (Vose 1991, "A Linear Algorithm for Generating Random Numbers with a Given Distribution"): a
/// threshold and another number for each.
fn alias_table(weights: &[f64], total: f64) -> (Vec<f32>, Vec<u32>) {
    let n = weights.len();
    let (mut thresholds, mut alias) = (vec![1.0_f32; n], (0..n as u32).collect::<Vec<_>>());
    let mut rest: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| rest[i] < 1.0);
    while let (Some(&more), Some(less)) = (large.last(), small.pop()) {
        thresholds[less] = rest[less] as f32;
        alias[less] = more as u32;
        rest[more] -= 1.0 - rest[less];
        if rest[more] < 1.0 {
            large.pop();
            small.push(more);
        }
    }
    (thresholds, alias)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each is chosen as often as its weight says.
    #[test]
    fn alias_tables() {
        for weights in [vec![1.0], vec![1.0, 1.0], vec![5.0, 0.25, 1.0, 1.0, 30.0], (1..100).map(f64::from).collect()] {
            let total: f64 = weights.iter().sum();
            let (thresholds, alias) = alias_table(&weights, total);
            let n = weights.len() as f64;
            let mut chosen = vec![0.0; weights.len()];
            for (i, &threshold) in thresholds.iter().enumerate() {
                chosen[i] += f64::from(threshold) / n;
                chosen[alias[i] as usize] += (1.0 - f64::from(threshold)) / n;
            }
            for (chosen, weight) in chosen.iter().zip(&weights) {
                assert!((chosen - weight / total).abs() < 1e-6, "{weights:?}");
            }
        }
        assert_eq!(alias_table(&[], 0.0), (vec![], vec![]));
    }
}
