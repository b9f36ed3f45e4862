//! `tracer render --checkpoint`.

use crate::{Folder, SQUARES};

#[test]
fn a_picture_in_parts() {
    let folder = Folder::with("s.obj", SQUARES);
    for integrator in ["path --mis --bounces 3", "whitted", "ao --distance 0.7"] {
        let command = format!("render s.obj --size 40x30 --crop 3,2,31,25 --json --integrator {integrator}");
        folder.run(&format!("{command} --samples 6 --cost whole-cost.png -o whole.png"));
        let first = folder.json(&format!("{command} --samples 2 --checkpoint film --cost cost.png -o part.png"));
        assert_eq!((&first["samples"], &first["samples_before"]), (&2.into(), &0.into()));
        let finish = format!(
            "{command} --samples 6 --checkpoint film --checkpoint-every 0 --level scalar --threads 1 --cost cost.png -o part.png"
        );
        let second = folder.json(&finish);
        assert_eq!((&second["samples"], &second["samples_before"]), (&6.into(), &2.into()));
        let rays = |report: &serde_json::Value| report["bounces"][0][0].as_u64().expect("a number");
        assert_eq!((rays(&first), rays(&second)), (2 * 31 * 25, 4 * 31 * 25));
        for (part, whole) in [("part.png", "whole.png"), ("cost.png", "whole-cost.png")] {
            assert!(folder.read(part) == folder.read(whole), "{integrator}: {part}");
        }
        // There is nothing left to do but to write the picture.
        let third = folder.json(&finish);
        assert_eq!((&third["image_hash"], &third["samples_before"]), (&second["image_hash"], &6.into()));
        assert_eq!(third["rays"], 0);
        std::fs::remove_file(folder.path().join("film")).expect("a file");
    }
    assert!(folder.run("render s.obj --size 9x9 --integrator ao --samples 3 --checkpoint f").contains("samples: 3;"));
    assert!(
        folder
            .run("render s.obj --size 9x9 --integrator ao --samples 4 --checkpoint f")
            .contains("samples: 4 (3 before);")
    );
}

#[test]
fn checkpoints_of_no_use() {
    let folder = Folder::with("s.obj", SQUARES);
    let command = "render s.obj --size 20x10 --integrator path --checkpoint film";
    folder.run(&format!("{command} --samples 4"));
    let good = folder.read("film");
    for (options, words) in [
        ("--samples 4 --seed 1", &["film", "its seed is 0, not 1", "name another file"][..]),
        ("--samples 4 --bounces 3", &["its bounces is 2, not 3"]),
        ("--samples 4 --camera 1,1,5/0,0,0", &["its camera is "]),
        ("--samples 4 --crop 0,0,20,9", &["its crop is 0,0,20,10, not 0,0,20,9"]),
        ("--samples 3", &["4 samples, 3 are asked for"]),
        ("--samples 1", &["its samples is several"]),
        ("--samples 4 --cost c.png", &["does not count rays"]),
    ] {
        folder.fails(&format!("{command} {options}"), 1, words);
        assert!(folder.read("film") == good, "it is as it was");
    }
    folder.fails("render balls:0 --size 20x10 --integrator path --checkpoint film --samples 4", 1, &["its scene is"]);
    for (bytes, words) in [
        (&b"P6 20 10 255"[..], &["film", "not a checkpoint"][..]),
        (b"", &["not a checkpoint"]),
        (&good[..good.len() - 3], &["damaged", "bytes where there should be"]),
        (&good[..20], &["not a checkpoint"]),
    ] {
        folder.write("film", bytes);
        folder.fails(&format!("{command} --samples 4"), 1, words);
    }
    let mut bytes = good.clone();
    bytes[good.len() / 2] ^= 1;
    folder.write("film", bytes);
    folder.fails(&format!("{command} --samples 4"), 1, &["checksum"]);
    folder.fails(
        "render s.obj --integrator ao --checkpoint p.png -o p.png",
        2,
        &["--output and --checkpoint name one file"],
    );
    folder.fails("render s.obj --checkpoint f", 2, &["--checkpoint", "--integrator"]);
    folder.fails("render s.obj --integrator ao --checkpoint no/such/folder", 1, &["no/such/folder"]);
    folder.fails("render s.obj --integrator ao --checkpoint-every 3", 2, &["--checkpoint"]);
    folder.fails("render s.obj --integrator ao --checkpoint f --checkpoint-every nan", 2, &["--checkpoint-every"]);
}
