//! The machine code of a few kernels at each level: packed instructions of the level's registers, no call in the loop and no
//! vector put aside in memory; and no packed arithmetic at all at level serial, the honest emulation.
//!
//! The code is found in this executable by markers: a `nop` with a number no one else uses, before the loop and behind it.
//! Names would not do: at each level the function is called `run`, and some formats of executables have no names at all. The
//! markers may touch memory as far as the compiler knows, so no load or store, and hence no arithmetic on what is loaded, can
//! be moved across them. From the first marker on, the jumps are followed: the compiler puts blocks where it likes.

#[cfg(not(target_arch = "x86_64"))]
#[test]
fn assembly() {
    println!("skipped: it reads x86-64 code");
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use iced_x86::{Decoder, DecoderOptions, FlowControl, Instruction, OpKind, Register};
    use object::{Object, ObjectSection, SectionKind};
    use simd::{Block, Float, Int, Isa, Level, Mask, Simd, Vector, math};
    use std::collections::{BTreeMap, BTreeSet};
    use std::hint::black_box;

    // ---- The kernels ----

    const SLAB: i32 = 0x5eed_0000;
    const ELEMENTWISE: i32 = 0x5eed_1000;
    const POWER: i32 = 0x5eed_2000;
    const COUNT: i32 = 0x5eed_3000;
    const SAXPY: i32 = 0x5eed_4000;
    const MOLLER_TRUMBORE: i32 = 0x5eed_5000;
    const TRANSPOSE: i32 = 0x5eed_6000;
    const COMPRESS: i32 = 0x5eed_7000;
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

    simd::kernel! {
        fn power<S>(exponent: f32, numbers: &mut [Block<f32>]) {
            mark!(marker::<S>(POWER));
            for block in numbers {
                for chunk in 0..16 / S::Float::LANES {
                    let x = S::Float::load_block(block, chunk);
                    math::pow(x, S::Float::splat(exponent)).store_block(block, chunk);
                }
            }
            mark!(marker::<S>(POWER) + END);
        }
    }

    simd::kernel! {
        /// How many numbers are in a range, nothing but loads and comparisons.
        fn count<S>(numbers: &[Block<f32>], low: f32, high: f32) -> usize {
            mark!(marker::<S>(COUNT));
            let (low, high) = (S::Float::splat(low), S::Float::splat(high));
            let mut count = 0;
            for block in numbers {
                for chunk in 0..16 / S::Float::LANES {
                    let x = S::Float::load_block(block, chunk);
                    count += (low.le(x) & x.le(high)).count();
                }
            }
            mark!(marker::<S>(COUNT) + END);
            count
        }
    }

    simd::kernel! {
        fn saxpy<S>(a: f32, x: &[Block<f32>], y: &mut [Block<f32>]) {
            mark!(marker::<S>(SAXPY));
            let a = S::Float::splat(a);
            for (x, y) in x.iter().zip(y) {
                for chunk in 0..16 / S::Float::LANES {
                    (a * S::Float::load_block(x, chunk) + S::Float::load_block(y, chunk)).store_block(y, chunk);
                }
            }
            mark!(marker::<S>(SAXPY) + END);
        }
    }

    type Vec3<F> = [F; 3];

    #[inline(always)]
    fn cross<F: Float>(a: Vec3<F>, b: Vec3<F>) -> Vec3<F> {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    #[inline(always)]
    fn dot<F: Float>(a: Vec3<F>, b: Vec3<F>) -> F {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// Distances along one ray to a vector of triangles, infinite where it misses: vertex, edge, edge.
    #[inline(always)]
    fn distance<F: Float>(triangle: [Vec3<F>; 3], origin: Vec3<F>, dir: Vec3<F>) -> F {
        let [v0, e1, e2] = triangle;
        let from = [origin[0] - v0[0], origin[1] - v0[1], origin[2] - v0[2]];
        let (p, q) = (cross(dir, e2), cross(from, e1));
        let inverse = F::splat(1.0) / dot(e1, p);
        let (u, v, t) = (dot(from, p) * inverse, dot(dir, q) * inverse, dot(e2, q) * inverse);
        let zero = F::splat(0.0);
        let hit = zero.le(u) & zero.le(v) & (u + v).le(F::splat(1.0)) & zero.le(t);
        F::select(hit, t, F::splat(f32::INFINITY))
    }

    simd::kernel! {
        fn moller_trumbore<S>(triangles: &[[Block<f32>; 9]], origin: &[f32; 3], dir: &[f32; 3], out: &mut [Block<f32>]) {
            mark!(marker::<S>(MOLLER_TRUMBORE));
            let origin = [S::Float::splat(origin[0]), S::Float::splat(origin[1]), S::Float::splat(origin[2])];
            let dir = [S::Float::splat(dir[0]), S::Float::splat(dir[1]), S::Float::splat(dir[2])];
            for (triangle, out) in triangles.iter().zip(out) {
                for chunk in 0..16 / S::Float::LANES {
                    let mut corners = [[S::Float::default(); 3]; 3];
                    for (k, block) in triangle.iter().enumerate() {
                        corners[k / 3][k % 3] = S::Float::load_block(block, chunk);
                    }
                    distance(corners, origin, dir).store_block(out, chunk);
                }
            }
            mark!(marker::<S>(MOLLER_TRUMBORE) + END);
        }
    }

    simd::kernel! {
        /// Squares of as many blocks as a vector has lanes, of which the first chunks are used.
        fn transpose<S>(squares: &mut [[Block<f32>; 16]]) {
            mark!(marker::<S>(TRANSPOSE));
            for square in squares {
                let mut rows = [S::Float::default(); 16];
                for i in 0..S::Float::LANES {
                    rows[i] = S::Float::load_block(&square[i], 0);
                }
                S::Float::transpose(&mut rows[..S::Float::LANES]);
                for i in 0..S::Float::LANES {
                    rows[i].store_block(&mut square[i], 0);
                }
            }
            mark!(marker::<S>(TRANSPOSE) + END);
        }
    }

    simd::kernel! {
        /// The positive numbers of each vector to its front.
        fn compress<S>(numbers: &mut [Block<f32>]) {
            mark!(marker::<S>(COMPRESS));
            for block in numbers {
                for chunk in 0..16 / S::Float::LANES {
                    let x = S::Float::load_block(block, chunk);
                    x.compress(x.gt(S::Float::default())).store_block(block, chunk);
                }
            }
            mark!(marker::<S>(COMPRESS) + END);
        }
    }

    /// Calls the kernels at every level, with which they are in the executable; and they do what they say.
    fn kernels_work(level: Level) {
        let planes = |x: f32| Block(std::array::from_fn(|i| x + i as f32));
        // Unit cubes along the diagonal; the ray flies in x at y = z = 3.5, from behind the cube at 3 or not. The compiler
        // must not know how many there are.
        let boxes = black_box(vec![[0.0, 0.0, 0.0, 1.0, 1.0, 1.0].map(planes); 2]);
        for (x, expected) in [(0.0, 1 << 3), (5.0, 0)] {
            let mut hits = [0; 2];
            slab(level, &boxes, &[x, 3.5, 3.5], &[1.0, 1e30, 1e30], 100.0, &mut hits);
            assert_eq!(hits, [expected; 2], "{level}");
        }
        let inputs = black_box(vec![[Block([2.0; 16]), Block([8.0; 16]), Block([1.5; 16])]; 2]);
        let mut outputs = [Block::default(); 2];
        elementwise(level, &inputs, &mut outputs);
        assert_eq!(outputs, [Block([mixed(2.0, 8.0, 1.5); 16]); 2], "{level}");
        let mut powers = black_box(vec![Block([3.0; 16]); 2]);
        power(level, 2.0, &mut powers);
        assert_eq!(powers, [Block([9.0; 16]); 2], "{level}");
        let numbers = black_box(vec![planes(0.0), planes(4.0)]);
        assert_eq!(count(level, &numbers, 5.0, 6.5), 4, "{level}");

        let mut y = black_box(vec![Block([1.0; 16]); 2]);
        saxpy(level, 2.0, &numbers, &mut y);
        assert_eq!(y[1].0[15], 39.0, "{level}");
        // In the plane x = 3, 4, ..., 18; the ray flies in x.
        let triangle = [planes(3.0), Block([-1.0; 16]), Block([-1.0; 16])];
        let edges = [0.0, 4.0, 0.0, 0.0, 0.0, 4.0].map(|x| Block([x; 16]));
        let triangles = black_box(vec![std::array::from_fn(|k| if k < 3 { triangle[k] } else { edges[k - 3] }); 2]);
        let mut out = [Block::default(); 2];
        moller_trumbore(level, &triangles, &[0.0; 3], &[1.0, 0.0, 0.0], &mut out);
        assert_eq!(out, [planes(3.0); 2], "{level}");
        let mut squares = black_box(vec![std::array::from_fn(|i| planes(16.0 * i as f32)); 2]);
        transpose(level, &mut squares);
        assert_eq!(squares[1][3].0[2], 35.0, "{level}");
        let mut numbers = black_box(vec![Block(std::array::from_fn(|i| i as f32 - 2.0)); 2]);
        compress(level, &mut numbers);
        assert_eq!(numbers[1].0[..2], if level.isa().lanes() == 4 { [1.0, 0.0] } else { [1.0, 2.0] }, "{level}");
    }

    // ---- Their code ----

    /// Where the marker with this number is: once, or more often if the compiler made copies.
    fn positions(text: &[u8], number: i32) -> Vec<u64> {
        let nop: Vec<u8> = [0x0f, 0x1f, 0x80].into_iter().chain(number.to_le_bytes()).collect();
        text.windows(nop.len()).enumerate().filter(|(_, w)| *w == nop).map(|(at, _)| at as u64).collect()
    }

    /// Instructions by their address, and the addresses where execution may go on.
    struct Code(BTreeMap<u64, (Instruction, Vec<u64>)>);

    impl Code {
        /// What can be executed from `begin` on, until one of the ends.
        fn from(text: &[u8], begin: u64, ends: &[u64]) -> Self {
            let mut code = BTreeMap::new();
            let mut todo = vec![begin];
            while let Some(ip) = todo.pop() {
                let Some(bytes) = text.get(ip as usize..).filter(|_| !code.contains_key(&ip)) else { continue };
                let instruction = Decoder::with_ip(64, bytes, ip, DecoderOptions::NONE).decode();
                let (next, target) = (instruction.next_ip(), instruction.near_branch_target());
                let next = match instruction.flow_control() {
                    _ if ends.contains(&ip) => vec![],
                    FlowControl::Next | FlowControl::Call | FlowControl::IndirectCall => vec![next],
                    FlowControl::ConditionalBranch => vec![next, target],
                    FlowControl::UnconditionalBranch => vec![target],
                    _ => vec![],
                };
                todo.extend(&next);
                code.insert(ip, (instruction, next));
            }
            Self(code)
        }

        /// Whether execution can get from one of these addresses to one of those.
        fn reaches(&self, from: &[u64], to: &[u64]) -> bool {
            let (mut todo, mut seen) = (from.to_vec(), BTreeSet::new());
            while let Some(ip) = todo.pop() {
                if to.contains(&ip) {
                    return true;
                }
                if let Some((_, next)) = self.0.get(&ip).filter(|_| seen.insert(ip)) {
                    todo.extend(next);
                }
            }
            false
        }

        /// The instructions that may be followed by one of the ends, unlike what comes after a panic.
        fn before(&self, ends: &[u64]) -> Vec<Instruction> {
            self.0.iter().filter(|(ip, _)| self.reaches(&[**ip], ends)).map(|(_, (i, _))| *i).collect()
        }

        /// Those of the instructions that may be followed by themselves.
        fn repeated(&self, instructions: &[Instruction]) -> Vec<Instruction> {
            let repeats = |i: &&Instruction| self.reaches(&self.0[&i.ip()].1, &[i.ip()]);
            instructions.iter().filter(repeats).copied().collect()
        }
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

    /// A vector put aside on the stack.
    fn is_spill(instruction: &Instruction) -> bool {
        let to_stack = instruction.op0_kind() == OpKind::Memory
            && matches!(instruction.memory_base(), Register::RSP | Register::RBP)
            && instruction.op_count() > 1;
        to_stack && (1..instruction.op_count()).any(|k| instruction.op_register(k).is_vector_register())
    }

    fn check(isa: Isa, kernel: i32, code: &[Instruction], body: &[Instruction], expected: &[&str]) {
        let context = format!("{isa}, kernel {kernel:x}:\n{}in the loop:\n{}", listing(code), listing(body));
        assert!(!body.is_empty(), "no loop: {context}");
        let calls = body.iter().any(|i| matches!(i.flow_control(), FlowControl::Call | FlowControl::IndirectCall));
        assert!(!calls, "a call in the loop: {context}");
        let fused = code.iter().any(|i| name(i).starts_with("vfm") || name(i).starts_with("vfnm"));
        assert!(!fused, "fused: {context}");

        let is_wide: fn(Register) -> bool = match isa {
            Isa::Sse2 | Isa::Sse42 => Register::is_xmm,
            Isa::Avx2 => Register::is_ymm,
            Isa::Avx512 => Register::is_zmm,
            Isa::Serial => {
                let packed: Vec<Instruction> = code.iter().copied().filter(is_packed_arithmetic).collect();
                assert!(packed.is_empty(), "packed arithmetic: {}in {context}", listing(&packed));
                return;
            }
            _ => return,
        };
        // The power and the triangle test need more than sixteen registers; SSE2 has no shuffle by a variable.
        let spills = match kernel {
            // Checks of arithmetic take registers, too.
            _ if cfg!(debug_assertions) => true,
            POWER => true,
            MOLLER_TRUMBORE => isa != Isa::Avx512,
            COMPRESS => isa == Isa::Sse2,
            _ => false,
        };
        if !spills {
            assert!(!body.iter().any(is_spill), "a vector goes to the stack: {context}");
        }
        let prefix = if matches!(isa, Isa::Sse2 | Isa::Sse42) { "" } else { "v" };
        for op in expected {
            let op = format!("{prefix}{op}");
            let uses = |i: &Instruction| name(i) == op && (0..i.op_count()).any(|k| is_wide(i.op_register(k)));
            assert!(body.iter().any(uses), "no {op} in the loop: {context}");
        }
        let vex = prefix.is_empty() && code.iter().any(|i| name(i).starts_with('v'));
        assert!(!vex, "AVX instructions: {context}");
    }

    /// Levels without their cargo feature, unless the compiler's flags ask for them.
    fn left_out(isa: Isa) -> bool {
        let kept = match isa {
            Isa::Sse42 => [cfg!(feature = "sse4_2"), cfg!(target_feature = "sse4.2")],
            Isa::Avx2 => [cfg!(feature = "avx2"), cfg!(target_feature = "avx2")],
            Isa::Avx512 => [cfg!(feature = "avx512"), cfg!(target_feature = "avx512f")],
            _ => [true; 2],
        };
        kept == [false; 2]
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
                (POWER, &["addps", "subps", "mulps", "divps", "cmpps", "cvtdq2ps"]),
                (COUNT, &["cmpps"]),
                (SAXPY, &["mulps", "addps"]),
                (MOLLER_TRUMBORE, &["mulps", "subps", "addps", "divps", "cmpps"]),
                (TRANSPOSE, if isa == Isa::Avx512 { &["permt2ps"] } else { &["unpcklps", "unpckhps"] }),
                (
                    COMPRESS,
                    match isa {
                        Isa::Sse2 => &["cmpps"],
                        Isa::Sse42 => &["pshufb"],
                        Isa::Avx2 => &["permd"],
                        _ => &["compressps"],
                    },
                ),
            ] {
                let mut copies = 0;
                for text in &text {
                    let (first, last) = (kernel + isa as i32, kernel + isa as i32 + END);
                    let ends = positions(text, last);
                    for begin in positions(text, first) {
                        copies += 1;
                        let all = Code::from(text, begin, &ends);
                        let code = all.before(&ends);
                        check(isa, kernel, &code, &all.repeated(&code), expected);
                    }
                }
                if left_out(isa) {
                    assert_eq!(copies, 0, "{isa}: kernel {kernel:x} was to be left out");
                } else {
                    assert!(copies > 0, "{isa}: kernel {kernel:x} was not found");
                }
            }
        }
    }
}
