//! Methods that find the hits of the same rays, in turn.

use crate::console::Console;
use crate::report::clock::{median, timed, timed_on_all};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{BitVec, Context, DivideConquer, Method, TriangleBoxes, Width};
use tracer::progress::Progress;

/// What all measurements have in common.
pub struct Task<'a> {
    /// Width and height of the picture.
    pub size: [usize; 2],
    /// Rounds, of which medians are taken.
    pub repeat: usize,
    pub quick: bool,
    pub console: &'a Console,
    one: ThreadPool,
    all: ThreadPool,
}

/// How many threads trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    One,
    All,
}

/// Seconds, of one thread by its CPU, of all by the clock on the wall; and CPU seconds of all.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Spent {
    pub seconds: f64,
    pub cpu: f64,
}

impl<'a> Task<'a> {
    pub fn new(size: [usize; 2], repeat: usize, quick: bool, console: &'a Console) -> Result<Self, Error> {
        let pool = |threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build();
            pool.map_err(|e| Error::Usage(format!("there are no threads to measure on: {e}")))
        };
        // Zero: as many as run at once, or as RAYON_NUM_THREADS says.
        Ok(Self { size, repeat, quick, console, one: pool(1)?, all: pool(0)? })
    }

    /// The number of all threads.
    pub fn threads(&self) -> usize {
        self.all.current_num_threads()
    }

    /// Does something and looks at the clock.
    pub fn run<T: Send>(&self, threads: Threads, work: impl FnOnce() -> T + Send) -> (T, Spent) {
        match threads {
            Threads::One => self.one.install(|| {
                let (result, seconds) = timed(work);
                (result, Spent { seconds, cpu: seconds })
            }),
            Threads::All => self.all.install(|| {
                let (result, [seconds, cpu]) = timed_on_all(work);
                (result, Spent { seconds, cpu })
            }),
        }
    }
}

/// One of them.
pub struct Rival<'a> {
    pub name: String,
    pub method: Box<dyn Method + 'a>,
}

impl<'a> Rival<'a> {
    pub fn new(name: impl Into<String>, method: impl Method + 'a) -> Self {
        Self { name: name.into(), method: Box::new(method) }
    }
}

/// Medians of the rounds by rival. Another one is first in each round.
///
/// # Errors
/// [`Error::Geometry`] when not all find the same hits; [`Error::Cancelled`].
pub fn race(
    rivals: &[Rival<'_>],
    rays: &RayBatch,
    threads: Threads,
    rounds: usize,
    task: &Task<'_>,
) -> Result<Vec<Spent>, Error> {
    let n = rivals.len();
    if rays.is_empty() {
        // All paths have left the scene before.
        return Ok(vec![Spent::default(); n]);
    }
    let mut times = vec![[const { Vec::new() }; 2]; n];
    let mut hits = HitBatch::new();
    let mut first: Option<(u64, &str)> = None;
    for round in 0..rounds {
        for i in (0..n).map(|i| (round + i) % n) {
            let Rival { name, method } = &rivals[i];
            let mut cx = Context { counters: None, cancel: Some(task.console.cancel()) };
            let (done, spent) = task.run(threads, || method.closest(rays, &mut hits, &mut cx));
            done?;
            let (hash, other) = *first.get_or_insert((hits.hash(), name));
            if hits.hash() != hash {
                return Err(Error::Geometry(format!("{name} found other hits than {other}: one of them is wrong")));
            }
            times[i][0].push(spent.seconds);
            times[i][1].push(spent.cpu);
            task.console.advance(1);
        }
    }
    Ok(times.iter().map(|[seconds, cpu]| Spent { seconds: median(seconds), cpu: median(cpu) }).collect())
}

/// Divide and conquer as in a scene that changes: nothing is left to it from the picture before.
pub struct Anew<'a> {
    pub boxes: &'a TriangleBoxes,
    pub level: Level,
}

impl Anew<'_> {
    fn method(&self) -> DivideConquer<'_> {
        DivideConquer::new(self.boxes, self.level, Width::Auto)
    }
}

impl Method for Anew<'_> {
    fn name(&self) -> &'static str {
        self.method().name()
    }

    fn source(&self) -> &'static str {
        self.method().source()
    }

    fn memory(&self) -> usize {
        0
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.method().closest(rays, hits, cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.method().any(rays, occluded, cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracer::geometry::Ray;
    use tracer::model::builtin;

    /// Who finds something else is named.
    #[test]
    fn other_hits_are_an_error() {
        let console = Console::default();
        let task = Task::new([4, 4], 2, true, &console).expect("threads");
        let boxes = |name| TriangleBoxes::new(&builtin(name).expect("a name").expect("a size").mesh).expect("sound");
        let (balls, tree) = (boxes("balls:1"), boxes("tree:2"));
        let rival = |name, boxes| Rival::new(name, Anew { boxes, level: Level::best() });
        let rays: RayBatch = (0..40).map(|i| Ray::new([0.02 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
        let alike = [rival("first", &balls), rival("second", &balls)];
        for threads in [Threads::One, Threads::All] {
            assert_eq!(race(&alike, &rays, threads, task.repeat, &task).expect("the same").len(), 2);
        }
        let e = race(&[rival("balls", &balls), rival("tree", &tree)], &rays, Threads::One, 1, &task);
        assert!(e.expect_err("other hits").to_string().contains("tree found other hits than balls"));
    }
}
