//! What is known of the machine.

use serde::Serialize;
use std::{fmt, fs};

/// Where something is measured.
#[derive(Debug, Clone, Serialize)]
pub struct Machine {
    /// The CPU's name if the system tells it, else its architecture.
    pub cpu: String,
    /// Threads that run at once.
    pub threads: usize,
    /// Work waiting for cores during the last minute, if known: more than a little disturbs measurements.
    pub load_average: Option<f64>,
}

impl Machine {
    /// As it is now.
    pub fn now() -> Self {
        let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let value = |key: &str| info.lines().find_map(|l| l.split_once(':').filter(|(k, _)| k.trim() == key));
        let known = |key: &str| value(key).map(|(_, value)| value.trim().to_owned());
        let name = known("model name").unwrap_or_else(|| std::env::consts::ARCH.into());
        // Some names tell no more than the maker.
        let cpu = match (known("cpu family"), known("model")) {
            (Some(family), Some(model)) => format!("{name} (family {family}, model {model})"),
            _ => name,
        };
        let load = fs::read_to_string("/proc/loadavg").ok();
        Self {
            cpu,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            load_average: load.and_then(|text| text.split_whitespace().next()?.parse().ok()),
        }
    }
}

/// For the head of a report.
impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} hardware threads; load average ", self.cpu, self.threads)?;
        match self.load_average {
            Some(load) => write!(f, "{load:.2} at the start"),
            None => f.write_str("unknown"),
        }
    }
}
