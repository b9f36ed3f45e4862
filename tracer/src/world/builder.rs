//! Builds worlds.

use super::primitives::{Items, Primitives};
use super::transform::Transform;
use super::{Content, Instance, World};
use crate::bvh::WideBvh;
use crate::geometry::Aabb;
use crate::{Error, Scene};
use simd::Level;
use std::sync::Arc;

/// What a [`World`] is made of.
#[derive(Default)]
#[must_use]
pub struct WorldBuilder {
    instances: Vec<(Source, [[f32; 4]; 3], u32)>,
    level: Option<Level>,
}

enum Source {
    Scene(Arc<Scene>),
    Primitives(Arc<dyn Primitives>),
}

impl WorldBuilder {
    /// Adds a scene at the place that an affine map says: `to_world` has the rows of the matrix that takes points of the scene, with a 1
    /// as the fourth coordinate, to the world. The same scene may be added many times: it is stored once.
    pub fn instance(self, scene: Arc<Scene>, to_world: [[f32; 4]; 3]) -> Self {
        self.add(Source::Scene(scene), to_world)
    }

    /// Adds surfaces of one's own, as [`WorldBuilder::instance`] does a scene ([`World::IDENTITY`] leaves them where they are).
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tracer::geometry::{Aabb, Hit, Ray};
    /// use tracer::{Primitives, World};
    ///
    /// /// Center and radius.
    /// struct Spheres(Vec<([f32; 3], f32)>);
    ///
    /// impl Primitives for Spheres {
    ///     fn count(&self) -> usize {
    ///         self.0.len()
    ///     }
    ///     fn bounds(&self, i: usize) -> Aabb {
    ///         let (c, r) = self.0[i];
    ///         Aabb { min: c.map(|x| x - r), max: c.map(|x| x + r) }
    ///     }
    ///     fn closest(&self, i: usize, ray: &Ray) -> Option<Hit> {
    ///         let (c, r) = self.0[i];
    ///         let o: [f32; 3] = std::array::from_fn(|k| ray.org[k] - c[k]);
    ///         let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    ///         let (a, b) = (dot(ray.dir, ray.dir), dot(o, ray.dir));
    ///         let root = (b * b - a * (dot(o, o) - r * r)).sqrt(); // NaN where there is none
    ///         let hits = [(-b - root) / a, (-b + root) / a];
    ///         let t = hits.into_iter().find(|t| (ray.t_min..=ray.t_max).contains(t))?;
    ///         Some(Hit { t, u: 0.0, v: 0.0, primitive: i as u32 })
    ///     }
    /// }
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let spheres = Arc::new(Spheres(vec![([0.0; 3], 1.0), ([5.0, 0.0, 0.0], 2.0)]));
    /// let world = World::builder().primitives(spheres, World::IDENTITY).build()?;
    /// let found = world.closest(&Ray::new([5.0, 0.0, 9.0], [0.0, 0.0, -1.0])).expect("the second sphere");
    /// assert_eq!((found.instance, found.hit.primitive, found.hit.t), (0, 1, 7.0));
    /// # Ok(())
    /// # }
    /// ```
    pub fn primitives(self, primitives: Arc<dyn Primitives>, to_world: [[f32; 4]; 3]) -> Self {
        self.add(Source::Primitives(primitives), to_world)
    }

    /// Who sees the instance added last: rays with a mask that has a bit in common with this one. An instance without a mask has all bits.
    pub fn mask(mut self, mask: u32) -> Self {
        if let Some((.., last)) = self.instances.last_mut() {
            *last = mask;
        }
        self
    }

    /// At another level than the best, whatever those of the scenes. The hits are the same.
    pub fn level(self, level: Level) -> Self {
        Self { level: Some(level), ..self }
    }

    /// Builds the tree over the instances, and one over each set of primitives. Instances are numbered in the order they were added.
    ///
    /// # Errors
    /// [`Error::Geometry`] with the instance at fault: its matrix is not finite, has (nearly) no inverse (the largest sums of a row of it and
    /// its inverse, multiplied, are more than 2^20) or is extreme (scales by more than 2^40 or less than 2^-40, or takes coordinates to more than 2^60), or
    /// a box of its primitives is none. Also when there are no instances.
    pub fn build(self) -> Result<World, Error> {
        if self.instances.is_empty() {
            return Err(Error::Geometry("the world has no instances: add at least one".into()));
        }
        let mut all = Vec::with_capacity(self.instances.len());
        let mut boxes = Vec::with_capacity(self.instances.len());
        let mut known: Vec<Items> = Vec::new();
        for (i, (source, to_world, mask)) in self.instances.into_iter().enumerate() {
            let fault = |message: String| Error::Geometry(format!("instance {i}: {message}"));
            let transform = Transform::new(&to_world).map_err(fault)?;
            let content = match source {
                Source::Scene(scene) => Content::Scene(scene),
                Source::Primitives(primitives) => {
                    Content::Items(items(&mut known, primitives).map_err(|e| fault(e.to_string()))?)
                }
            };
            let of_object = content.bounds();
            boxes.push(if of_object == Aabb::EMPTY {
                of_object
            } else {
                transform.bounds(&of_object).map_err(fault)?
            });
            all.push(Instance { content, transform, mask });
        }
        let growth = all.iter().map(|instance| instance.transform.growth()).fold(0.0, f32::max);
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
        let tree = WideBvh::of_boxes(&boxes)?;
        // One search in the tree of the world, in it one in an instance's.
        let below = all.iter().map(|instance| instance.content.tree().depth).max().unwrap_or(0);
        let room = 8 * (tree.depth + below) + 2;
        Ok(World { instances: all, tree, growth, bounds, room, level: self.level.unwrap_or_else(Level::best) })
    }

    fn add(mut self, source: Source, to_world: [[f32; 4]; 3]) -> Self {
        self.instances.push((source, to_world, u32::MAX));
        self
    }
}

/// The tree over these primitives, built when they are seen first.
fn items(known: &mut Vec<Items>, primitives: Arc<dyn Primitives>) -> Result<Items, Error> {
    if let Some(items) = known.iter().find(|items| items.are_of(&primitives)) {
        return Ok(items.clone());
    }
    let items = Items::new(primitives)?;
    known.push(items.clone());
    Ok(items)
}
