//! The machine code of two kernels at each level: packed instructions of the level's registers and no call in the loop; and
//! no packed arithmetic at all at level serial, the honest emulation.
//!
//! The code is found in this executable by markers: a `nop` with a number no one else uses, before the loop and behind it.
//! Names would not do: the function that a kernel is compiled to at a level is always called `run`, inlined into its caller
//! or not, and some formats of executables have no names at all. The markers may touch memory as far as the compiler knows,
//! so no load or store, and hence no arithmetic on what is loaded, can be moved across them.

#[cfg(not(target_arch = "x86_64"))]
#[test]
fn assembly() {
    println!("skipped: it reads x86-64 code");
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use iced_x86::{Decoder, DecoderOptions, FlowControl, Instruction, Register};
    use object::{Object, ObjectSection, SectionKind};
    use simd::{Block, Float, Int, Isa, Level, Mask, Simd, Vector};
    use std::ops::Range;

    // ---- The kernels ----

    const SLAB: i32 = 0x5eed_0000;
    const ELEMENTWISE: i32 = 0x5eed_1000;
    const END: i32 = 0x100;

    const fn marker<S: Simd>(kernel: i32) -> i32 {
        kernel + S::LEVEL.isa() as i32
    }

    /// `nop`, its operand an address that is not accessed: `0f 1f 80` and the number.
    macro_rules! mark {
        ($number:expr) => {
            // SAFETY: an instruction without effect.
            unsafe { std::arch::asm!("nop dword ptr [rax + {}]", const $number, options(nostack, preserves_flags)) }
        };
    }

    /// Boxes in structure-of-arrays form: minimum x, y, z, maximum x, y, z.
    type Boxes = [Block<f32>; 6];

    #[inline(always)]
    fn boxes_hit<F: Float>(boxes: &Boxes, origin: &[f32; 3], inverse: &[f32; 3], t_max: f32) -> u32 {
        let mut hits = 0;
        for chunk in 0..16 / F::LANES {
            let (mut near, mut far) = (F::splat(0.0), F::splat(t_max));
            for axis in 0..3 {
                let (origin, inverse) = (F::splat(origin[axis]), F::splat(inverse[axis]));
                let t0 = (F::load_block(&boxes[axis], chunk) - origin) * inverse;
                let t1 = (F::load_block(&boxes[axis + 3], chunk) - origin) * inverse;
                near = t0.min(t1).max(near);
                far = t0.max(t1).min(far);
            }
            hits |= near.le(far).bitmask() << (chunk * F::LANES);
        }
        hits
    }

    simd::kernel! {
        /// Which boxes one ray hits, sixteen bits for sixteen boxes.
        fn slab<S>(boxes: &[Boxes], origin: &[f32; 3], inverse: &[f32; 3], t_max: f32, hits: &mut [u32]) {
            mark!(marker::<S>(SLAB));
            for (boxes, hits) in boxes.iter().zip(hits) {
                *hits = boxes_hit::<S::Float>(boxes, origin, inverse, t_max);
            }
            mark!(marker::<S>(SLAB) + END);
        }
    }

    #[inline(always)]
    fn mixed<F: Float>(a: F, b: F, c: F) -> F {
        let larger = F::select(a.lt(b), b, a);
        let (i, j) = (a.to_int() + F::Int::from_uint(b.to_bits()), c.to_int());
        let integer = F::from_int((i.max(j) * (i - j).min(i)) ^ (i >> 3));
        (a * b + c) / larger.sqrt() - F::select(i.lt(j), integer, -c)
    }

    simd::kernel! {
        /// Arithmetic from memory to memory, with all a vectorizer could wish for.
        fn elementwise<S>(inputs: &[[Block<f32>; 3]], outputs: &mut [Block<f32>]) {
            mark!(marker::<S>(ELEMENTWISE));
            for (input, output) in inputs.iter().zip(outputs) {
                for chunk in 0..16 / S::Float::LANES {
                    // Not `[0, 1, 2].map(..)`: std's `map` is not always inlined.
                    let (a, b) = (S::Float::load_block(&input[0], chunk), S::Float::load_block(&input[1], chunk));
                    mixed(a, b, S::Float::load_block(&input[2], chunk)).store_block(output, chunk);
                }
            }
            mark!(marker::<S>(ELEMENTWISE) + END);
        }
    }

    /// Calls the kernels at every level, with which they are in the executable; and they do what they say.
    fn kernels_work(level: Level) {
        let planes = |x: f32| Block(std::array::from_fn(|i| x + i as f32));
        // Unit cubes along the diagonal; the ray flies in x at y = z = 3.5, from behind the cube at 3 or not.
        let boxes = [[0.0, 0.0, 0.0, 1.0, 1.0, 1.0].map(planes); 2];
        for (x, expected) in [(0.0, 1 << 3), (5.0, 0)] {
            let mut hits = [0; 2];
            slab(level, &boxes, &[x, 3.5, 3.5], &[1.0, 1e30, 1e30], 100.0, &mut hits);
            assert_eq!(hits, [expected; 2], "{level}");
        }
        let mut outputs = [Block::default(); 2];
        elementwise(level, &[[Block([2.0; 16]), Block([8.0; 16]), Block([1.5; 16])]; 2], &mut outputs);
        assert_eq!(outputs, [Block([mixed(2.0, 8.0, 1.5); 16]); 2], "{level}");
    }

    // ---- Their code ----

    /// The instructions between the markers of a kernel: once, or more often if the compiler made copies.
    fn code(text: &[u8], kernel: i32, isa: Isa) -> Vec<Vec<Instruction>> {
        let first = kernel + isa as i32;
        let positions = |number: i32| {
            let nop: Vec<u8> = [0x0f, 0x1f, 0x80].into_iter().chain(number.to_le_bytes()).collect();
            text.windows(nop.len()).enumerate().filter(move |(_, w)| *w == nop).map(|(at, _)| at)
        };
        positions(first)
            .map(|begin| {
                let end = positions(first + END).find(|&end| end > begin);
                let end = end.expect("the end of the kernel follows its beginning");
                Decoder::with_ip(64, &text[begin..end], begin as u64, DecoderOptions::NONE).into_iter().collect()
            })
            .collect()
    }

    /// From the targets of jumps backward to the jumps.
    fn loops(code: &[Instruction]) -> Vec<&[Instruction]> {
        let is_jump = |i: &Instruction| {
            matches!(i.flow_control(), FlowControl::ConditionalBranch | FlowControl::UnconditionalBranch)
        };
        let range = |(at, jump): (usize, &Instruction)| -> Option<Range<usize>> {
            let target = code[..=at].iter().position(|i| i.ip() == jump.near_branch_target());
            target.filter(|_| is_jump(jump)).map(|target| target..at + 1)
        };
        code.iter().enumerate().filter_map(range).map(|range| &code[range]).collect()
    }

    fn name(instruction: &Instruction) -> String {
        format!("{:?}", instruction.mnemonic()).to_lowercase()
    }

    /// Arithmetic on several lanes. Moves, shuffles and logicals are not: scalar code has them too.
    fn is_packed_arithmetic(instruction: &Instruction) -> bool {
        const FLOAT: [&str; 8] = ["add", "sub", "mul", "div", "min", "max", "cmp", "sqrt"];
        const INTEGER: [&str; 9] = ["padd", "psub", "pmul", "pmin", "pmax", "pcmpgt", "psra", "cvtdq2ps", "cvttps2dq"];
        let name = name(instruction);
        let name = name.strip_prefix('v').unwrap_or(&name);
        FLOAT.iter().any(|op| name.strip_prefix(op).is_some_and(|rest| matches!(rest, "ps" | "pd")))
            || INTEGER.iter().any(|op| name.starts_with(op))
    }

    fn listing(code: &[Instruction]) -> String {
        code.iter().map(|i| format!("{:x}: {}\n", i.ip(), name(i))).collect()
    }

    fn check(isa: Isa, kernel: i32, code: &[Instruction], expected: &[&str]) {
        let context = |code: &[Instruction]| format!("{isa}, kernel {kernel:x}:\n{}", listing(code));
        let loops = loops(code);
        assert!(!loops.is_empty(), "no loop: {}", context(code));
        for body in &loops {
            let calls = body.iter().any(|i| matches!(i.flow_control(), FlowControl::Call | FlowControl::IndirectCall));
            assert!(!calls, "a call in the loop: {}", context(body));
        }
        let fused = code.iter().find(|i| name(i).starts_with("vfm") || name(i).starts_with("vfnm"));
        assert!(fused.is_none(), "fused: {}", context(code));

        let is_wide: fn(Register) -> bool = match isa {
            Isa::Sse2 | Isa::Sse42 => Register::is_xmm,
            Isa::Avx2 => Register::is_ymm,
            Isa::Avx512 => Register::is_zmm,
            Isa::Serial => {
                let packed: Vec<Instruction> = code.iter().copied().filter(is_packed_arithmetic).collect();
                assert!(packed.is_empty(), "packed arithmetic: {}in {}", listing(&packed), context(code));
                return;
            }
            _ => return,
        };
        let prefix = if matches!(isa, Isa::Sse2 | Isa::Sse42) { "" } else { "v" };
        for op in expected {
            let op = format!("{prefix}{op}");
            let uses = |i: &Instruction| name(i) == op && (0..i.op_count()).any(|k| is_wide(i.op_register(k)));
            assert!(loops.iter().any(|body| body.iter().any(uses)), "no {op} in the loop: {}", context(code));
        }
        let vex = code.iter().find(|i| name(i).starts_with('v')).filter(|_| prefix.is_empty());
        assert!(vex.is_none(), "AVX instructions: {}", context(code));
    }

    #[test]
    fn assembly() {
        let executable = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let file = object::File::parse(&*executable).unwrap();
        let sections: Vec<_> = file.sections().filter(|section| section.kind() == SectionKind::Text).collect();
        let text: Vec<&[u8]> = sections.iter().map(|section| section.data().unwrap()).collect();

        Level::available().for_each(kernels_work);
        // Code is there for levels that this CPU lacks, too.
        for isa in [Isa::Serial, Isa::Scalar, Isa::Sse2, Isa::Sse42, Isa::Avx2, Isa::Avx512] {
            for (kernel, expected) in [
                (SLAB, &["subps", "mulps", "minps", "maxps", "cmpps"][..]),
                (ELEMENTWISE, &["addps", "subps", "mulps", "divps", "sqrtps", "cmpps", "cvtdq2ps"]),
            ] {
                let copies: Vec<_> = text.iter().flat_map(|text| code(text, kernel, isa)).collect();
                assert!(!copies.is_empty(), "{isa}: kernel {kernel:x} was not found");
                for copy in copies {
                    check(isa, kernel, &copy, expected);
                }
            }
        }
    }
}
