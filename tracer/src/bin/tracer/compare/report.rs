//! What the comparison found, as JSON and CSV show it.

use serde::Serialize;
use simd::Isa;

#[derive(Debug, Clone, Serialize)]
pub struct Report {
    pub scene: String,
    pub triangles: usize,
    pub build: &'static str,
    pub width: usize,
    pub height: usize,
    pub camera: String,
    pub shadows: bool,
    pub cpu: String,
    /// Of the columns that are not about one thread.
    pub threads: usize,
    pub levels: Vec<&'static str>,
    pub missing: Vec<&'static str>,
    pub load_average: Option<f64>,
    pub repeat: usize,
    /// How it was measured.
    pub measurement: String,
    /// Rays of one frame.
    pub rays: usize,
    pub all_identical: bool,
    pub rows: Vec<Row>,
    pub tests: Vec<Tests>,
}

/// One level at one width. Times are in milliseconds.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub name: String,
    pub level: &'static str,
    /// Rays per packet.
    pub width: usize,
    pub eye_ms: f64,
    pub cast_ms: f64,
    pub shade_ms: f64,
    pub total_ms: f64,
    /// Of casting.
    pub mrays_per_s: f64,
    pub cast_speedup: f64,
    pub total_speedup: f64,
    /// What the paper measured, from scene to scene.
    pub paper_cast_min: Option<f64>,
    pub paper_cast_max: Option<f64>,
    pub paper_total_min: Option<f64>,
    pub paper_total_max: Option<f64>,
    /// All threads, on the clock.
    pub all_threads_cast_ms: f64,
    pub all_threads_total_ms: f64,
    /// Over one thread, total.
    pub all_threads_speedup: f64,
    pub hits_hash: String,
    pub image_hash: String,
    /// To the baseline, with one thread and with all.
    pub identical: bool,
}

/// Work of the traversal with packets of one width.
#[derive(Debug, Clone, Serialize)]
pub struct Tests {
    pub width: usize,
    /// Packet-box tests, divided by the number of rays.
    pub box_tests_per_ray: f64,
    /// Packet-triangle tests, divided by the number of rays.
    pub triangle_tests_per_ray: f64,
    /// Which part of the lanes' box tests a single ray would have done too.
    pub box_utilization: f64,
    pub triangle_utilization: f64,
}

/// Speed-ups in Geimer & Müller 2003, section 4.
#[derive(Debug, Clone, Copy)]
pub struct Paper {
    pub cast: [f64; 2],
    pub total: [f64; 2],
}

impl Paper {
    /// On the machine that is closest to a level and a width: a Xeon with SSE, a G4 with AltiVec.
    pub fn of(isa: Isa, width: usize) -> Option<Self> {
        match (isa, width) {
            (Isa::Sse2 | Isa::Sse42, 4) => Some(Self { cast: [5.2, 6.1], total: [2.4, 3.9] }),
            (Isa::Neon, 4) => Some(Self { cast: [8.0, 11.0], total: [4.0, 8.1] }),
            _ => None,
        }
    }
}

impl Row {
    pub fn paper_cast(&self) -> Option<[f64; 2]> {
        Some([self.paper_cast_min?, self.paper_cast_max?])
    }

    pub fn paper_total(&self) -> Option<[f64; 2]> {
        Some([self.paper_total_min?, self.paper_total_max?])
    }
}
