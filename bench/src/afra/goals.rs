//! What must be reached.

use super::dynamic::{Dynamic, Rays};
use super::speed::{Kind, Speeds};
use super::variants::{ALWAYS, DEFAULT, PLACES, PLACES_ALWAYS, TASKS, Variants};
use super::{Part, scenes::Name};
use crate::report::goals::{Bound, Goal};

/// All goals, with a value for each scene that they are of.
pub fn all(parts: &[Part]) -> Vec<Goal> {
    let mut goals = Vec::new();
    let mut goal = |what: &str, least, values: Vec<(String, Option<f64>)>| {
        let bound = Bound::AtLeast(least);
        if !values.is_empty() {
            goals.push(Goal { what: what.into(), bound, values });
        }
    };
    let conference = parts.iter().filter(|part| part.speeds.scene == Name::Conference);
    let values = conference.map(|part| (part.speeds.scene.to_string(), over_mbvh8(&part.speeds)));
    goal("DAC over MBVH8, one thread, best level, 1 bounce", 0.8, values.collect());
    for (what, variants) in [
        ("rays moved over places moved, filtering always, rays of the bounce", [ALWAYS, PLACES_ALWAYS]),
        ("rays moved over places moved, rays of the bounce", [DEFAULT, PLACES]),
    ] {
        let value = |part: &Part| (part.variants.scene.to_string(), part.variants.ratio(variants, 1));
        goal(what, 1.25, parts.iter().map(value).collect());
    }
    let value = |part: &Part| (part.variants.scene.to_string(), speed_up(&part.variants));
    goal("all threads over one, DAC by default, 1 bounce", 1.8, parts.iter().map(value).collect());
    for (what, rays) in [
        ("build and trace with the best tree over DAC, one ray per pixel", Rays::Eye),
        ("build and trace with the best tree over DAC, one path of 1 bounce per pixel", Rays::Path),
    ] {
        let value = |part: &Part| (part.dynamic.scene.to_string(), over_trees(&part.dynamic, rays));
        goal(what, 1.0, parts.iter().map(value).collect());
    }
    goals
}

fn over_mbvh8(speeds: &Speeds) -> Option<f64> {
    Some(speeds.best(Kind::Dac)?.mrays[0] / speeds.best(Kind::Mbvh8)?.mrays[0])
}

fn speed_up(variants: &Variants) -> Option<f64> {
    Some(variants.scaling(TASKS)?.speed_up())
}

fn over_trees(dynamic: &Dynamic, rays: Rays) -> Option<f64> {
    Some(dynamic.best_tree(&dynamic.frame, rays) / dynamic.total(&dynamic.frame, 0, rays))
}
