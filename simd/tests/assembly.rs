//! The machine code of a few kernels at each level, five of them with four, eight and sixteen lanes: packed instructions of the
//! registers that this takes, no call in the loop and no vector put aside in memory where registers suffice; and no packed
//! arithmetic at all at level serial, the honest emulation.
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
    use simd::{Block, Float, Int, Isa, Level, Mask, Simd, Vector, dispatch, math};
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
    const END: i32 = 0x800;

    const fn number(kernel: i32, isa: Isa, lanes: usize) -> i32 {
        kernel + 0x10 * lanes as i32 + isa as i32
    }

    const fn marker<S: Simd, F: Float>(kernel: i32) -> i32 {
        number(kernel, S::LEVEL.isa(), F::LANES)
    }

    /// `nop`, its operand an address that is not accessed: `0f 1f 80` and the number.
    macro_rules! mark {
        ($number:expr) => {
            // SAFETY: an instruction without effect.
            unsafe { std::arch::asm!("nop dword ptr [rax + {}]", const $number, options(nostack, preserves_flags)) }
        };
    }

    /// A kernel of a number of lanes: four, eight or sixteen, native or made of others.
    macro_rules! kernel_of_lanes {
        ($(#[$meta:meta])* fn $name:ident<S, F>($($arg:ident: $ty:ty),*) $body:block) => {
            $(#[$meta])*
            fn $name(level: Level, lanes: usize, $($arg: $ty),*) {
                #[inline(always)]
                fn kernel<S: Simd, F: Float>($($arg: $ty),*) $body
                match lanes {
                    4 => dispatch!(level, |S, $($arg: $ty),*| { kernel::<S, S::Float4>($($arg),*) }),
                    8 => dispatch!(level, |S, $($arg: $ty),*| { kernel::<S, S::Float8>($($arg),*) }),
                    _ => dispatch!(level, |S, $($arg: $ty),*| { kernel::<S, S::Float16>($($arg),*) }),
                }
            }
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

    kernel_of_lanes! {
        /// Which boxes one ray hits, sixteen bits for sixteen boxes.
        fn slab<S, F>(boxes: &[Boxes], origin: &[f32; 3], inverse: &[f32; 3], t_max: f32, hits: &mut [u32]) {
            mark!(marker::<S, F>(SLAB));
            for (boxes, hits) in boxes.iter().zip(hits) {
                *hits = boxes_hit::<F>(boxes, origin, inverse, t_max);
            }
            mark!(marker::<S, F>(SLAB) + END);
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
            mark!(marker::<S, S::Float>(ELEMENTWISE));
            for (input, output) in inputs.iter().zip(outputs) {
                for chunk in 0..16 / S::Float::LANES {
                    // Not `[0, 1, 2].map(..)`: std's `map` is not always inlined.
                    let (a, b) = (S::Float::load_block(&input[0], chunk), S::Float::load_block(&input[1], chunk));
                    mixed(a, b, S::Float::load_block(&input[2], chunk)).store_block(output, chunk);
                }
            }
            mark!(marker::<S, S::Float>(ELEMENTWISE) + END);
        }
    }

    simd::kernel! {
        fn power<S>(exponent: f32, numbers: &mut [Block<f32>]) {
            mark!(marker::<S, S::Float>(POWER));
            for block in numbers {
                for chunk in 0..16 / S::Float::LANES {
                    let x = S::Float::load_block(block, chunk);
                    math::pow(x, S::Float::splat(exponent)).store_block(block, chunk);
                }
            }
            mark!(marker::<S, S::Float>(POWER) + END);
        }
    }

    simd::kernel! {
        /// How many numbers are in a range, nothing but loads and comparisons.
        fn count<S>(numbers: &[Block<f32>], low: f32, high: f32) -> usize {
            mark!(marker::<S, S::Float>(COUNT));
            let (low, high) = (S::Float::splat(low), S::Float::splat(high));
            let mut count = 0;
            for block in numbers {
                for chunk in 0..16 / S::Float::LANES {
                    let x = S::Float::load_block(block, chunk);
                    count += (low.le(x) & x.le(high)).count();
                }
            }
            mark!(marker::<S, S::Float>(COUNT) + END);
            count
        }
    }

    kernel_of_lanes! {
        fn saxpy<S, F>(a: f32, x: &[Block<f32>], y: &mut [Block<f32>]) {
            mark!(marker::<S, F>(SAXPY));
            let a = F::splat(a);
            for (x, y) in x.iter().zip(y) {
                for chunk in 0..16 / F::LANES {
                    (a * F::load_block(x, chunk) + F::load_block(y, chunk)).store_block(y, chunk);
                }
            }
            mark!(marker::<S, F>(SAXPY) + END);
        }
    }

    type Vec3<F> = [F; 3];

    #[inline(always)]
    fn load3<F: Float>(blocks: &[Block<f32>], chunk: usize) -> Vec3<F> {
        [F::load_block(&blocks[0], chunk), F::load_block(&blocks[1], chunk), F::load_block(&blocks[2], chunk)]
    }

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

    kernel_of_lanes! {
        fn moller_trumbore<S, F>(triangles: &[[Block<f32>; 9]], origin: &[f32; 3], dir: &[f32; 3], out: &mut [Block<f32>]) {
            mark!(marker::<S, F>(MOLLER_TRUMBORE));
            let origin = [F::splat(origin[0]), F::splat(origin[1]), F::splat(origin[2])];
            let dir = [F::splat(dir[0]), F::splat(dir[1]), F::splat(dir[2])];
            for (triangle, out) in triangles.iter().zip(out) {
                for chunk in 0..16 / F::LANES {
                    let [v0, e1, e2] = [&triangle[..3], &triangle[3..6], &triangle[6..]];
                    let triangle = [load3(v0, chunk), load3(e1, chunk), load3(e2, chunk)];
                    distance(triangle, origin, dir).store_block(out, chunk);
                }
            }
            mark!(marker::<S, F>(MOLLER_TRUMBORE) + END);
        }
    }

    kernel_of_lanes! {
        /// Squares of as many blocks as a vector has lanes, of which the first chunks are used.
        fn transpose<S, F>(squares: &mut [[Block<f32>; 16]]) {
            mark!(marker::<S, F>(TRANSPOSE));
            for square in squares {
                // Not zeros, which may be a call of `memset`.
                let mut rows = [F::load_block(&square[0], 0); 16];
                for i in 1..F::LANES {
                    rows[i] = F::load_block(&square[i], 0);
                }
                F::transpose(&mut rows[..F::LANES]);
                for i in 0..F::LANES {
                    rows[i].store_block(&mut square[i], 0);
                }
            }
            mark!(marker::<S, F>(TRANSPOSE) + END);
        }
    }

    kernel_of_lanes! {
        /// The positive numbers of each vector to its front.
        fn compress<S, F>(numbers: &mut [Block<f32>]) {
            mark!(marker::<S, F>(COMPRESS));
            for block in numbers {
                for chunk in 0..16 / F::LANES {
                    let x = F::load_block(block, chunk);
                    x.compress(x.gt(F::default())).store_block(block, chunk);
                }
            }
            mark!(marker::<S, F>(COMPRESS) + END);
        }
    }

    fn planes(x: f32) -> Block<f32> {
        Block(std::array::from_fn(|i| x + i as f32))
    }

    /// Calls the kernels at a level, with which they are in the executable; and they do what they say.
    fn kernels_work(level: Level) {
        // The compiler must not know how many there are.
        let inputs = black_box(vec![[Block([2.0; 16]), Block([8.0; 16]), Block([1.5; 16])]; 2]);
        let mut outputs = [Block::default(); 2];
        elementwise(level, &inputs, &mut outputs);
        assert_eq!(outputs, [Block([mixed(2.0, 8.0, 1.5); 16]); 2], "{level}");
        let mut powers = black_box(vec![Block([3.0; 16]); 2]);
        power(level, 2.0, &mut powers);
        assert_eq!(powers, [Block([9.0; 16]); 2], "{level}");
        let numbers = black_box(vec![planes(0.0), planes(4.0)]);
        assert_eq!(count(level, &numbers, 5.0, 6.5), 4, "{level}");
    }

    /// As above, those of any number of lanes.
    fn kernels_of_lanes_work(level: Level, lanes: usize) {
        // Unit cubes along the diagonal; the ray flies in x at y = z = 3.5, from behind the cube at 3 or not.
        let boxes = black_box(vec![[0.0, 0.0, 0.0, 1.0, 1.0, 1.0].map(planes); 2]);
        for (x, expected) in [(0.0, 1 << 3), (5.0, 0)] {
            let mut hits = [0; 2];
            slab(level, lanes, &boxes, &[x, 3.5, 3.5], &[1.0, 1e30, 1e30], 100.0, &mut hits);
            assert_eq!(hits, [expected; 2], "{level}, {lanes} lanes");
        }
        let numbers = black_box(vec![planes(0.0), planes(4.0)]);
        let mut y = black_box(vec![Block([1.0; 16]); 2]);
        saxpy(level, lanes, 2.0, &numbers, &mut y);
        assert_eq!(y[1].0[15], 39.0, "{level}, {lanes} lanes");
        // In the plane x = 3, 4, ..., 18; the ray flies in x.
        let triangle = [planes(3.0), Block([-1.0; 16]), Block([-1.0; 16])];
        let edges = [0.0, 4.0, 0.0, 0.0, 0.0, 4.0].map(|x| Block([x; 16]));
        let triangles = black_box(vec![std::array::from_fn(|k| if k < 3 { triangle[k] } else { edges[k - 3] }); 2]);
        let mut out = [Block::default(); 2];
        moller_trumbore(level, lanes, &triangles, &[0.0; 3], &[1.0, 0.0, 0.0], &mut out);
        assert_eq!(out, [planes(3.0); 2], "{level}, {lanes} lanes");
        let mut squares = black_box(vec![std::array::from_fn(|i| planes(16.0 * i as f32)); 2]);
        transpose(level, lanes, &mut squares);
        assert_eq!(squares[1][3].0[2], 35.0, "{level}, {lanes} lanes");
        let mut numbers = black_box(vec![Block(std::array::from_fn(|i| i as f32 - 2.0)); 2]);
        compress(level, lanes, &mut numbers);
        assert_eq!(numbers[1].0[..2], if lanes == 4 { [1.0, 0.0] } else { [1.0, 2.0] }, "{level}, {lanes} lanes");
    }

    // ---- Their code ----

    /// Where the markers are, by their numbers: once, or more often if the compiler made copies.
    fn markers(text: &[u8]) -> BTreeMap<i32, Vec<u64>> {
        let mut markers = BTreeMap::<_, Vec<u64>>::new();
        for (at, bytes) in text.windows(7).enumerate() {
            if let [0x0f, 0x1f, 0x80, number @ ..] = bytes {
                markers.entry(i32::from_le_bytes(number.try_into().unwrap())).or_default().push(at as u64);
            }
        }
        markers
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

        /// Where execution can get from these addresses by these steps; those of them included that are in the code.
        fn reachable(&self, from: &[u64], steps: impl Fn(u64) -> Vec<u64>) -> BTreeSet<u64> {
            let (mut todo, mut seen) = (from.to_vec(), BTreeSet::new());
            while let Some(ip) = todo.pop() {
                if self.0.contains_key(&ip) && seen.insert(ip) {
                    todo.extend(steps(ip));
                }
            }
            seen
        }

        /// The instructions that may be followed by one of the ends, unlike what comes after a panic; and those of them that may
        /// be followed by themselves.
        fn before(&self, ends: &[u64]) -> [Vec<Instruction>; 2] {
            let mut back = BTreeMap::<u64, Vec<u64>>::new();
            for (ip, (_, next)) in &self.0 {
                next.iter().for_each(|next| back.entry(*next).or_default().push(*ip));
            }
            let forward = |ip: u64| self.0[&ip].1.clone();
            let backward = |ip: u64| back.get(&ip).cloned().unwrap_or_default();
            let before = self.reachable(ends, backward);
            let mut repeated = BTreeSet::new();
            // Every cycle has a jump to a lower address.
            for ip in &before {
                for target in self.0[ip].1.iter().filter(|next| *next <= ip) {
                    let behind = self.reachable(&[*target], forward);
                    repeated.extend(self.reachable(&[*ip], backward).intersection(&behind));
                }
            }
            [&before, &repeated].map(|ips| ips.iter().map(|ip| self.0[ip].0).collect())
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

    /// Whether vectors are expected on the stack: in release builds; checks of arithmetic take registers, too.
    fn spills(isa: Isa, kernel: i32, lanes: usize) -> bool {
        let of_halves = lanes > isa.lanes();
        match kernel {
            // Distances, near and far, and the two sides of a box are four registers each; the ray comes on top.
            SLAB => isa.lanes() == 4 && lanes == 16,
            // Some fifteen values are alive, of two registers and more in a pair. SSE4.2 blends by register 0 and no other.
            MOLLER_TRUMBORE => of_halves || isa == Isa::Sse42,
            // All of the square is in registers, sixteen and more, and one to shuffle through.
            TRANSPOSE => of_halves,
            // SSE2 has no shuffle by a variable; the halves of a pair are joined in memory.
            COMPRESS => of_halves || isa == Isa::Sse2,
            _ => false,
        }
    }

    /// Instructions that make the kernel what it is, without the `v` of AVX.
    fn expected(isa: Isa, kernel: i32, lanes: usize) -> &'static [&'static str] {
        match (kernel, isa, lanes) {
            (SLAB, ..) => &["subps", "mulps", "minps", "maxps", "cmpps"],
            (ELEMENTWISE, ..) => &["addps", "subps", "mulps", "divps", "sqrtps", "cmpps", "cvtdq2ps"],
            (POWER, ..) => &["addps", "subps", "mulps", "divps", "cmpps", "cvtdq2ps"],
            (COUNT, ..) => &["cmpps"],
            (SAXPY, ..) => &["mulps", "addps"],
            (MOLLER_TRUMBORE, ..) => &["mulps", "subps", "addps", "divps", "cmpps"],
            (TRANSPOSE, Isa::Avx512, 8 | 16) => &["permt2ps"],
            (TRANSPOSE, ..) => &["unpcklps", "unpckhps"],
            (COMPRESS, Isa::Sse2, _) => &["cmpps"],
            (COMPRESS, Isa::Sse42, _) | (COMPRESS, _, 4) => &["cmpps", "pshufb"],
            (COMPRESS, Isa::Avx2, _) => &["cmpps", "permps"],
            (COMPRESS, Isa::Avx512, 8) => &["cmpps", "permps"],
            (COMPRESS, ..) => &["cmpps", "compressps"],
            _ => &[],
        }
    }

    /// What is wrong with the code of a kernel, of which `body` is its loop.
    fn faults(isa: Isa, kernel: i32, lanes: usize, code: &[Instruction], body: &[Instruction]) -> Vec<String> {
        let mut faults = Vec::new();
        let mut rule = |kept: bool, fault: &str| {
            if !kept {
                faults.push(fault.to_owned());
            }
        };
        rule(!body.is_empty(), "no loop");
        let is_call = |i: &Instruction| matches!(i.flow_control(), FlowControl::Call | FlowControl::IndirectCall);
        rule(!body.iter().any(is_call), "a call in the loop");
        let is_fused = |i: &Instruction| name(i).starts_with("vfm") || name(i).starts_with("vfnm");
        rule(!code.iter().any(is_fused), "fused");

        // The registers of so many lanes, or the widest there are.
        let is_wide: fn(Register) -> bool = match (isa, lanes) {
            (Isa::Serial, _) => {
                rule(!code.iter().any(is_packed_arithmetic), "packed arithmetic");
                return faults;
            }
            (Isa::Sse2 | Isa::Sse42, _) | (Isa::Avx2 | Isa::Avx512, 4) => Register::is_xmm,
            (Isa::Avx2, _) | (Isa::Avx512, 8) => Register::is_ymm,
            (Isa::Avx512, _) => Register::is_zmm,
            _ => return faults,
        };
        if !cfg!(debug_assertions) && !spills(isa, kernel, lanes) {
            rule(!body.iter().any(is_spill), "a vector goes to the stack");
        }
        let prefix = if matches!(isa, Isa::Sse2 | Isa::Sse42) { "" } else { "v" };
        for op in expected(isa, kernel, lanes) {
            let op = format!("{prefix}{op}");
            let uses = |i: &Instruction| name(i) == op && (0..i.op_count()).any(|k| is_wide(i.op_register(k)));
            rule(body.iter().any(uses), &format!("no {op} of that width in the loop"));
        }
        rule(prefix == "v" || !code.iter().any(|i| name(i).starts_with('v')), "AVX instructions");
        faults
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

    /// A section of code with its markers.
    type Text<'a> = (&'a [u8], BTreeMap<i32, Vec<u64>>);

    /// All copies of a kernel in the executable, which may be none if its level is left out; what is wrong with them.
    fn check(text: &[Text<'_>], isa: Isa, kernel: i32, lanes: usize) -> Vec<String> {
        let (mut copies, mut report) = (0, Vec::new());
        let first = number(kernel, isa, lanes);
        for (text, markers) in text {
            let of = |number: i32| markers.get(&number).map_or(&[][..], Vec::as_slice);
            let ends = of(first + END);
            for begin in of(first) {
                copies += 1;
                let [code, body] = Code::from(text, *begin, ends).before(ends);
                let faults = faults(isa, kernel, lanes, &code, &body).join(", ");
                if !faults.is_empty() {
                    let listings = format!("{}in the loop:\n{}", listing(&code), listing(&body));
                    report.push(format!("{isa}, kernel {kernel:x}, {lanes} lanes: {faults}:\n{listings}"));
                }
            }
        }
        if left_out(isa) != (copies == 0) {
            report.push(format!("{isa}, kernel {kernel:x}, {lanes} lanes: {copies} copies"));
        }
        report
    }

    #[test]
    fn assembly() {
        let executable = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let file = object::File::parse(&*executable).unwrap();
        let sections: Vec<_> = file.sections().filter(|section| section.kind() == SectionKind::Text).collect();
        let text = sections.iter().map(|section| section.data().unwrap());
        let text: Vec<Text> = text.map(|text| (text, markers(text))).collect();

        let mut report = Vec::new();
        Level::available().for_each(kernels_work);
        for lanes in [4, 8, 16] {
            Level::available().for_each(|level| kernels_of_lanes_work(level, lanes));
        }
        // Code is there for levels that this CPU lacks, too.
        for isa in [Isa::Serial, Isa::Scalar, Isa::Sse2, Isa::Sse42, Isa::Avx2, Isa::Avx512] {
            for kernel in [ELEMENTWISE, POWER, COUNT] {
                report.extend(check(&text, isa, kernel, isa.lanes()));
            }
            for kernel in [SLAB, SAXPY, MOLLER_TRUMBORE, TRANSPOSE, COMPRESS] {
                report.extend([4, 8, 16].into_iter().flat_map(|lanes| check(&text, isa, kernel, lanes)));
            }
        }
        assert!(report.is_empty(), "{}", report.join("\n"));
    }
}
