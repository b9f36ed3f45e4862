//! What holds for every model: reciprocity, energy, and that directions are as dense as is said.

use super::*;
use crate::render::Sampler;
use std::num::Wrapping;

type V = Vec3<f32>;

fn material(diffuse: f32, specular: f32, shininess: f32) -> Parameters<f32> {
    Parameters {
        diffuse: Vec3::splat([diffuse; 3]),
        specular: Vec3::splat([specular; 3]),
        shininess,
        transmission: Vec3::splat([1.0; 3]),
        ior: 1.5,
        front: true,
        options: Options { coat_alone: false, branch: Branch::Random },
    }
}

fn materials() -> Vec<Parameters<f32>> {
    let mut all = Vec::new();
    for (diffuse, specular) in [(1.0, 0.0), (1.0, 0.04), (0.6, 0.5), (0.0, 1.0)] {
        for shininess in [0.0, 1.0, 12.0, 400.0] {
            all.push(material(diffuse, specular, shininess));
        }
    }
    all
}

fn direction(cos: f32, phi: f32) -> V {
    let sin = (1.0 - cos * cos).sqrt();
    let (s, c) = simd::math::sin_cos(phi);
    Vec3 { x: sin * c, y: sin * s, z: cos }
}

fn eyes() -> [V; 5] {
    [1.0, 0.9, 0.5, 0.2, 0.03].map(|cos| direction(cos, 0.4))
}

fn sample<M: Model>(p: &Parameters<f32>, eye: V, i: u32) -> Sample<f32> {
    let pair = |k| Sampler::new(1).pair::<f32>(Wrapping(99), i, k);
    M::sample(p, eye, pair(0), pair(1)[0])
}

/// The integral over the directions with z from `low` to 1: cells of equal solid angle, their middles.
fn integral(low: f32, f: impl Fn(V) -> f32) -> f64 {
    let (rows, columns) = (1000, 1000);
    let mut sum = 0.0;
    for row in 0..rows {
        let z = low + (1.0 - low) * (row as f32 + 0.5) / rows as f32;
        for column in 0..columns {
            sum += f64::from(f(direction(z, TWO_PI * (column as f32 + 0.5) / columns as f32)));
        }
    }
    sum * f64::from((1.0 - low) * TWO_PI) / f64::from(rows * columns)
}

#[test]
fn directions_may_be_exchanged() {
    fn check<M: Model>() {
        for p in materials() {
            for eye in eyes() {
                for light in [direction(0.8, 2.0), direction(0.3, -1.0), direction(0.5, 3.4)] {
                    let (there, back) = (M::value(&p, eye, light).x, M::value(&p, light, eye).x);
                    assert!((there - back).abs() <= 1e-4 * there.abs(), "{p:?}: {there} and {back}");
                }
            }
        }
    }
    check::<Lambertian>();
    check::<Glossy>();
    check::<Mirror>();
}

/// In a white furnace no surface is brighter than the furnace, by integrating the value and by the weights of directions that are chosen;
/// and both say the same.
#[test]
fn energy_is_not_made() {
    fn reflected<M: Model>(p: &Parameters<f32>, eye: V, what: &str) -> f64 {
        let value = integral(0.0, |light| M::value(p, eye, light).x * light.z);
        assert!(value < 1.0 + 2e-3, "{what} reflects {value}: {p:?}, {eye:?}");
        value
    }
    fn chosen<M: Model>(p: &Parameters<f32>, eye: V) -> f64 {
        let n = 1 << 14;
        (0..n).map(|i| f64::from(sample::<M>(p, eye, i).weight.x)).sum::<f64>() / f64::from(n)
    }
    for p in materials() {
        for eye in eyes() {
            let value = reflected::<Lambertian>(&p, eye, "Lambertian");
            assert!(
                (value - f64::from(p.diffuse.x)).abs() < 1e-3 && (chosen::<Lambertian>(&p, eye) - value).abs() < 1e-3
            );
            // A sharp lobe needs finer cells than these when it is cut by the horizon.
            let (value, chosen) = (reflected::<Glossy>(&p, eye, "Glossy"), chosen::<Glossy>(&p, eye));
            assert!((value - chosen).abs() < 0.01, "glossy: {value} by value, {chosen} by choice: {p:?}, {eye:?}");
            let mut p = p;
            p.diffuse = Vec3::splat([1.0 - p.specular.x; 3]);
            reflected::<Mirror>(&p, eye, "Mirror");
        }
    }
    // Seen straight on, a coat or mirror of reflectance one reflects all.
    for shininess in [1.0, 12.0, 100.0] {
        let (p, eye) = (material(0.0, 1.0, shininess), direction(1.0, 0.0));
        assert!((reflected::<Glossy>(&p, eye, "Glossy") - 1.0).abs() < 2e-3);
        assert!((reflected::<Mirror>(&p, eye, "Mirror") - 1.0).abs() < 2e-3);
    }
}

/// Densities are those of a distribution, and directions are distributed by them: chi-square over 8 x 8 cells of the sphere.
#[test]
fn directions_are_as_dense_as_is_said() {
    fn check<M: Model>(p: &Parameters<f32>, eye: V, what: &str) {
        let total = integral(-1.0, |light| M::density(p, eye, light));
        assert!((total - 1.0).abs() < 2e-3, "{what}: densities sum to {total}: {p:?}, {eye:?}");
        const N: u32 = 1 << 14;
        const CELLS: usize = 8;
        let cell = |light: V| {
            let row = ((light.z + 1.0) * 0.5 * CELLS as f32) as usize;
            let column = ((simd::math::atan2(light.y, light.x) / TWO_PI + 0.5) * CELLS as f32) as usize;
            row.min(CELLS - 1) * CELLS + column.min(CELLS - 1)
        };
        let (mut expected, mut found) = (vec![0.0; CELLS * CELLS], vec![0.0; CELLS * CELLS]);
        let fine = 400;
        for row in 0..fine {
            let z = -1.0 + 2.0 * (row as f32 + 0.5) / fine as f32;
            for column in 0..fine {
                let light = direction(z, TWO_PI * (column as f32 + 0.5) / fine as f32);
                expected[cell(light)] +=
                    f64::from(N) * f64::from(M::density(p, eye, light) * 2.0 * TWO_PI) / f64::from(fine * fine);
            }
        }
        for i in 0..N {
            let Sample { to_light, density, .. } = sample::<M>(p, eye, i);
            assert!((to_light.dot(to_light) - 1.0).abs() < 1e-4);
            let said = M::density(p, eye, to_light);
            assert!((said - density).abs() <= 1e-4 * said, "{what}");
            found[cell(to_light)] += 1.0;
        }
        let chi2: f64 = expected.iter().zip(&found).map(|(e, f)| (e - f) * (e - f) / (e + 5.0)).sum();
        // Stratified points do better than the 99 that independent ones exceed once in a hundred times.
        assert!(chi2 < 99.0, "{what}: chi-square {chi2}: {p:?}, {eye:?}");
    }
    for p in materials().into_iter().filter(|p| p.shininess <= 12.0) {
        for eye in eyes() {
            check::<Lambertian>(&p, eye, "Lambertian");
            check::<Glossy>(&p, eye, "Glossy");
        }
    }
}

/// Known values of glass (Hecht, Optics, 4.6): 4 % straight on, all of it from inside beyond 41.8 degrees; Snell's law.
#[test]
fn glass() {
    let p = material(0.0, 0.0, 0.0);
    let (mut reflected, mut refracted) = (p, p);
    reflected.options.branch = Branch::Reflected;
    refracted.options.branch = Branch::Refracted;
    let up = direction(1.0, 0.0);
    assert!((sample::<Dielectric>(&reflected, up, 0).weight.x - 0.04).abs() < 1e-6);
    for cos in [1.0, 0.8, 0.5, 0.1, 0.001] {
        let eye = direction(cos, 1.0);
        let [a, b] = [&reflected, &refracted].map(|p| sample::<Dielectric>(p, eye, 0));
        assert!((a.weight.x + b.weight.x - 1.0).abs() < 1e-6 && (0.0..=1.0).contains(&a.weight.x));
        let sin = |v: V| (v.x * v.x + v.y * v.y).sqrt();
        assert!((sin(eye) - 1.5 * sin(b.to_light)).abs() < 1e-6 && b.to_light.z < 0.0);
        assert!((b.to_light.dot(b.to_light) - 1.0).abs() < 1e-6);
        // Back along the same way, the same part is reflected.
        let mut back = reflected;
        back.front = false;
        let inside = sample::<Dielectric>(&back, negate(b.to_light), 0);
        assert!((inside.weight.x - a.weight.x).abs() < 1e-3, "{} and {}", inside.weight.x, a.weight.x);
    }
    for (degrees, total) in [(41.0_f32, false), (42.5, true)] {
        let mut inside = reflected;
        inside.front = false;
        let eye = direction(simd::math::cos(degrees.to_radians()), 0.0);
        assert_eq!(sample::<Dielectric>(&inside, eye, 0).weight.x == 1.0, total, "{degrees} degrees");
    }
    let random: f32 = (0..1000).map(|i| f32::from(u8::from(sample::<Dielectric>(&p, up, i).to_light.z > 0.0))).sum();
    assert!((random / 1000.0 - 0.04).abs() < 5e-3);
}
