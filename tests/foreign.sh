#!/usr/bin/env bash
# The portable tests on another processor, emulated.
set -euo pipefail
cd "$(dirname "$0")/.."

usage() {
    cat >&2 <<'END'
usage: tests/foreign.sh TARGET [cargo test arguments]

  aarch64                              NEON; on qemu's default CPU, then on a Cortex-A53
  i686                                 32-bit x86
  i586                                 32-bit x86 without SSE2, on a Pentium III: all but arithmetic of floats
  armv7 riscv64                        emulation alone
  ppc64le                              VSX, by nightly Rust's intrinsics
  wasm wasm-relaxed wasm-scalar        WebAssembly with SIMD, with relaxed SIMD, and emulation alone; on node
  windows                              x86-64, on wine
  darwin                               macOS on ARM; type-checked, not run
  qemu64 Nehalem SandyBridge Haswell   this machine's build on an older x86-64
  asan msan                            this machine's build with AddressSanitizer or MemorySanitizer (five minutes)

QEMU_CPU picks one CPU. Without arguments: simd, and where it has registers there the exactness of the tracer's hits too.
END
    exit 2
}

# triple: Rust's name; gnu: the name of GNU's compiler and libraries; arch: Debian's; qemu: the emulator's.
# levels: what has to run (the tests of simd read it). exact: whether the first CPU also traces, and which of those tests it runs.
# what, filter: which tests of simd, as arguments of cargo and of the tests.
subcommand=test
cpus=(default)
levels=scalar
exact=false
traces=(--test exact -- golden awkward flat)
features=
gnu= arch= qemu=
# `from_env` starts its own program again, which an emulated process cannot.
filter=(--skip from_env)
what=()
# options: what every call of cargo gets.
options=()
case ${1:-} in
    aarch64)
        triple=aarch64-unknown-linux-gnu gnu=aarch64-linux-gnu arch=arm64 qemu=aarch64
        cpus=(default cortex-a53) levels=serial,scalar,neon exact=true ;;
    i686)
        triple=i686-unknown-linux-gnu gnu=i686-linux-gnu arch=i386 qemu=i386
        levels=serial,scalar,sse2 exact=true ;;
    i586)
        # The FPU rounds a chain of operations once, when the result is stored, and makes signalling NaNs quiet: no promise of
        # the same bits, nor of the accuracy of exp2 and log2, can be kept there. What holds are comparisons, masks, integers
        # and memory.
        triple=i586-unknown-linux-gnu gnu=i686-linux-gnu arch=i386 qemu=i386
        cpus=(pentium3)
        what=(--test level --test ops)
        filter+=(--skip float:: --skip double:: --skip estimates:: --skip math:: --skip lanes::) ;;
    armv7) triple=armv7-unknown-linux-gnueabihf gnu=arm-linux-gnueabihf arch=armhf qemu=arm ;;
    ppc64le)
        triple=powerpc64le-unknown-linux-gnu gnu=powerpc64le-linux-gnu arch=ppc64el qemu=ppc64le
        levels=scalar,vsx exact=true options=(--features simd/vsx)
        # The intrinsics are unstable; this makes any compiler take them.
        export RUSTC_BOOTSTRAP=1 ;;
    riscv64) triple=riscv64gc-unknown-linux-gnu gnu=riscv64-linux-gnu arch=riscv64 qemu=riscv64 ;;
    wasm) triple=wasm32-unknown-unknown levels=scalar,wasm features=+simd128
        exact=true traces=(--test exact --test hostile) ;;
    wasm-relaxed) triple=wasm32-unknown-unknown levels=scalar,wasm,wasm-relaxed features=+simd128,+relaxed-simd ;;
    wasm-scalar) triple=wasm32-unknown-unknown features=-simd128 ;;
    windows) triple=x86_64-pc-windows-gnu levels=serial,scalar,sse2 filter=() ;;
    darwin) triple=aarch64-apple-darwin subcommand=check ;;
    qemu64) triple=x86_64-unknown-linux-gnu qemu=x86_64 levels=serial,scalar,sse2 ;;
    # AVX, which the second of these has, is no level of its own.
    Nehalem | SandyBridge) triple=x86_64-unknown-linux-gnu qemu=x86_64 levels=serial,scalar,sse2,sse4.2 ;;
    Haswell)
        # Faults of qemu 7.2, seen with small C programs too: it gathers from wrong places when the indices are in ymm4, and its
        # vmaskmovps reads the lanes that are off, which need not exist. Real processors with AVX2 run these three.
        filter=(--exact --skip from_env --skip memory::gather --skip memory::masked --skip memory::partial)
        triple=x86_64-unknown-linux-gnu qemu=x86_64 levels=serial,scalar,sse2,sse4.2,avx2 ;;
    asan) triple=x86_64-unknown-linux-gnu levels=serial,scalar,sse2 what=(--all-features --lib --test level --test interop --test ops) ;;
    # Of AVX-512 it knows too little; of the fences of level serial it takes the results for defined.
    msan) triple=x86_64-unknown-linux-gnu levels=serial,scalar,sse2
        what=(--no-default-features --features std,sse4_2,avx2 --lib --test level --test ops) ;;
    *) usage ;;
esac
target=$1
shift
variable=CARGO_TARGET_$(echo "$triple" | tr a-z- A-Z_)

cross=../shared/cross/cross
if [ -x $cross ]; then
    run=("$cross" "$target" "$subcommand")
else
    missing=()
    need() { command -v "$1" >/dev/null || missing+=("$2"); }
    rustup target list --installed | grep -qx "$triple" || missing+=("rustup target add $triple")
    if [ -n "$gnu" ]; then
        need "$gnu-gcc" "apt install gcc-$gnu libc6-dev-$arch-cross"
        export "${variable}_LINKER=$gnu-gcc"
    fi
    case $target in
        qemu64 | Nehalem | SandyBridge | Haswell)
            need qemu-x86_64 "apt install qemu-user"
            export "${variable}_RUNNER=qemu-x86_64 -cpu $target" ;;
        wasm*) need node "apt install nodejs" ;;
        windows)
            need x86_64-w64-mingw32-gcc "apt install gcc-mingw-w64-x86-64"
            need wine64 "apt install wine64"
            export "${variable}_RUNNER=wine64" ;;
        darwin) ;;
        asan) missing+=("a nightly toolchain, then:" "RUSTFLAGS=-Zsanitizer=address SIMD_TEST_LEVELS=$levels cargo +nightly test --target $triple -p simd ${what[*]} -- ${filter[*]}") ;;
        msan) missing+=("rustup +nightly component add rust-src, then:" "RUSTFLAGS=-Zsanitizer=memory SIMD_TEST_LEVELS=$levels cargo +nightly test -Zbuild-std --target $triple -p simd ${what[*]} -- ${filter[*]}") ;;
        *)
            need "qemu-$qemu" "apt install qemu-user"
            export "${variable}_RUNNER=qemu-$qemu -L /usr/$gnu" ;;
    esac
    if [ ${#missing[@]} -gt 0 ]; then
        echo "tests/foreign.sh: to test for $target:" >&2
        printf '  %s\n' "${missing[@]}" >&2
        exit 2
    fi
    [ -z "$features" ] || export "${variable}_RUSTFLAGS=-Ctarget-feature=$features"
    run=(cargo "$subcommand" --target "$triple")
fi

if [ "$triple" = wasm32-unknown-unknown ]; then
    # Older engines have relaxed SIMD behind a flag, which newer ones do not know.
    flag=--experimental-wasm-relaxed-simd
    node $flag -e 0 2>/dev/null || flag=--no-warnings
    run+=(--config "target.$triple.runner = ['node', '--no-warnings', '$flag', '$PWD/tests/wasm.mjs']")
fi

run+=("${options[@]}")
export SIMD_TEST_LEVELS=${SIMD_TEST_LEVELS:-$levels}
# Emulated floating point is slow, and the accuracy that the bits have does not depend on who computes them.
[ -z "$qemu" ] || export SIMD_TEST_EVERY=${SIMD_TEST_EVERY:-17}
for cpu in "${QEMU_CPU:-${cpus[@]}}"; do
    if [ "$cpu" = default ]; then unset QEMU_CPU; else export QEMU_CPU=$cpu; fi
    echo "== $target, CPU $cpu"
    if [ $# -gt 0 ]; then
        "${run[@]}" "$@"
        continue
    fi
    if [ $subcommand = test ]; then "${run[@]}" -p simd "${what[@]}" -- "${filter[@]}"; else "${run[@]}" -p simd; fi
    # Emulation is slow: the scenes of the other tests would take half an hour.
    if $exact; then "${run[@]}" -p tests "${traces[@]}"; fi
    exact=false
done
