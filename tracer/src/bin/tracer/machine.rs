//! What is known of the machine.

use indicatif::HumanBytes;
use simd::{Isa, Level};
use std::fs;
use tracer::Error;

/// The CPU's name if the system tells it, else its architecture.
pub fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let names = ["model name", "Model", "cpu model", "cpu"];
    let value = |key| info.lines().find_map(|l| l.split_once(':').filter(|(k, _)| k.trim() == key));
    let name = names.into_iter().find_map(value).map(|(_, name)| name.split_whitespace().collect::<Vec<_>>().join(" "));
    name.filter(|n| !n.is_empty()).unwrap_or_else(|| std::env::consts::ARCH.into())
}

/// Work waiting for cores during the last minute, if known: more than a little disturbs measurements.
pub fn load_average() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

/// Names of the levels that this CPU has, and of those it lacks.
pub fn levels() -> (Vec<&'static str>, Vec<&'static str>) {
    let (found, missing): (Vec<Isa>, _) = Isa::ALL.into_iter().partition(|&isa| Level::new(isa).is_some());
    let names = |list: Vec<Isa>| list.into_iter().map(Isa::name).collect();
    (names(found), names(missing))
}

/// Refuses work that needs more memory than there is.
pub fn check_memory(needed: u64, what: &str) -> Result<(), Error> {
    let known = fs::read_to_string("/proc/meminfo").ok().and_then(|text| available(&text));
    // Where the system does not tell, it may still refuse.
    let refused = || usize::try_from(needed).map_or(true, |n| Vec::<u8>::new().try_reserve_exact(n).is_err());
    let room = known.map_or_else(
        || if refused() { "less".into() } else { String::new() },
        |free| {
            if needed > free { HumanBytes(free).to_string() } else { String::new() }
        },
    );
    if room.is_empty() {
        return Ok(());
    }
    let needed = HumanBytes(needed);
    Err(Error::Usage(format!("{what} needs about {needed} of memory, there is {room}: choose a smaller size")))
}

fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_meminfo() {
        assert_eq!(available("MemTotal: 9 kB\nMemAvailable:   24 kB\n"), Some(24 * 1024));
        assert_eq!(available("MemTotal: 9 kB\n"), None);
    }

    #[test]
    fn refuses_what_no_machine_has() {
        check_memory(1 << 20, "a little").expect("there is a megabyte");
        let message = check_memory(1 << 60, "an exabyte").expect_err("too much").to_string();
        assert!(message.contains("1.00 EiB") && message.contains("smaller"), "{message}");
    }

    #[test]
    fn every_level_is_found_or_missing() {
        let (found, missing) = levels();
        assert!(found.contains(&"scalar"));
        assert_eq!(found.len() + missing.len(), Isa::ALL.len());
    }
}
