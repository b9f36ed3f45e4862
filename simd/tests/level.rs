//! Levels by name, from the environment, and the texts of the errors.

#![cfg(feature = "std")]

use simd::{Isa, Level, LevelError};

#[test]
fn names() {
    for isa in Isa::ALL {
        assert_eq!(isa.to_string(), isa.name());
        match isa.name().parse::<Level>() {
            Ok(level) => {
                assert_eq!(level.isa(), isa);
                assert_eq!(level.to_string(), isa.name());
                assert!(Level::available().any(|l| l == level), "{isa}");
            }
            Err(error) => {
                assert_eq!(error, LevelError::Unavailable(isa));
                assert_eq!(Level::new(isa), None);
                assert!(Level::available().all(|l| l.isa() != isa), "{isa}");
            }
        }
    }
}

#[test]
fn scalar_is_everywhere_and_the_best_comes_last() {
    assert_eq!("scalar".parse(), Ok(Level::SCALAR));
    assert!(Level::available().any(|level| level == Level::SCALAR));
    assert_eq!(Some(Level::best()), Level::available().last());
    #[cfg(target_arch = "x86_64")]
    assert!("sse2".parse::<Level>().is_ok());
    #[cfg(target_arch = "aarch64")]
    assert!("neon".parse::<Level>().is_ok());
    #[cfg(all(target_arch = "powerpc64", target_endian = "little", feature = "vsx"))]
    assert_eq!("vsx".parse(), Ok(Level::best()));
    // Not detected but compiled in.
    #[cfg(target_feature = "simd128")]
    assert!("wasm".parse::<Level>().is_ok());
    #[cfg(target_feature = "relaxed-simd")]
    assert_eq!("wasm-relaxed".parse(), Ok(Level::best()));
}

#[test]
fn unknown_names() {
    for name in ["", "auto", "sse5", "AVX2", " scalar", "sse42"] {
        let error = name.parse::<Level>().unwrap_err();
        assert_eq!(error, LevelError::Unknown(name.to_owned()));
        let known = "auto, serial, scalar, sse2, sse4.2, avx2, avx512, neon, vsx, wasm, wasm-relaxed";
        assert_eq!(error.to_string(), format!("unknown level '{name}'; known: {known}"));
    }
}

/// No CPU has them all.
#[test]
#[allow(clippy::match_like_matches_macro, reason = "constants")]
fn unavailable_levels() {
    let missing: Vec<Isa> = Isa::ALL.into_iter().filter(|&isa| Level::new(isa).is_none()).collect();
    assert!(!missing.is_empty());
    let here: Vec<&str> = Level::available().map(|level| level.isa().name()).collect();
    for isa in missing {
        let text = isa.name().parse::<Level>().unwrap_err().to_string();
        let compiled = match isa {
            Isa::Sse42 => cfg!(any(feature = "sse4_2", target_feature = "sse4.2")),
            Isa::Avx2 => cfg!(any(feature = "avx2", target_feature = "avx2")),
            Isa::Avx512 => cfg!(any(feature = "avx512", target_feature = "avx512f")),
            Isa::Vsx => cfg!(feature = "vsx"),
            _ => true,
        };
        let who = if compiled { "this CPU lacks" } else { "this build leaves out" };
        assert_eq!(text, format!("{who} level '{isa}'; it has: {}", here.join(", ")));
    }
}

/// What [`Level::from_env`] returns, for the test below: run in a process of its own, as the environment of one with threads
/// cannot be changed safely.
#[test]
#[ignore = "a part of `from_env`"]
fn print_level_from_env() {
    assert_eq!(Level::cached(), Level::from_env());
    match Level::cached() {
        Ok(level) => println!("level: {level}."),
        Err(error) => println!("error: {error}."),
    }
}

#[test]
#[cfg(not(target_family = "wasm"))]
fn from_env() {
    let with = |value: Option<&str>| {
        let mut child = std::process::Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "print_level_from_env", "--ignored", "--nocapture"]).env_remove(Level::ENV);
        if let Some(value) = value {
            child.env(Level::ENV, value);
        }
        String::from_utf8(child.output().unwrap().stdout).unwrap()
    };
    let best = format!("level: {}.", Level::best());
    for value in [None, Some(""), Some("auto")] {
        let output = with(value);
        assert!(output.contains(&best), "{value:?}: {output}");
    }
    for isa in Isa::ALL {
        let expected = match isa.name().parse::<Level>() {
            Ok(level) => format!("level: {level}."),
            Err(error) => format!("error: {error}."),
        };
        let output = with(Some(isa.name()));
        assert!(output.contains(&expected), "{isa}: {output}");
    }
    let output = with(Some("sse5"));
    assert!(output.contains("error: unknown level 'sse5'"), "{output}");
}
