#!/usr/bin/env bash
# The portable tests on another processor, emulated.
set -euo pipefail
cd "$(dirname "$0")/.."

usage() {
    cat >&2 <<'END'
usage: tests/foreign.sh TARGET [cargo test arguments]

  aarch64                  NEON; on qemu's default CPU, then on a Cortex-A53
  i686                     32-bit x86
  armv7 ppc64le riscv64    emulation alone
  wasm                     emulation alone; compiled, not run

QEMU_CPU picks one CPU. Without arguments: simd, and where it has registers there the exactness of the tracer's hits too.
END
    exit 2
}

# triple: Rust's name; gnu: the name of GNU's compiler and libraries; arch: Debian's; qemu: the emulator's.
# levels: what has to run (the tests of simd read it). exact: whether the first CPU also traces.
subcommand=test
cpus=(default)
levels=scalar
exact=false
case ${1:-} in
    aarch64)
        triple=aarch64-unknown-linux-gnu gnu=aarch64-linux-gnu arch=arm64 qemu=aarch64
        cpus=(default cortex-a53) levels=serial,scalar,neon exact=true ;;
    i686)
        triple=i686-unknown-linux-gnu gnu=i686-linux-gnu arch=i386 qemu=i386
        levels=serial,scalar,sse2 exact=true ;;
    armv7) triple=armv7-unknown-linux-gnueabihf gnu=arm-linux-gnueabihf arch=armhf qemu=arm ;;
    ppc64le) triple=powerpc64le-unknown-linux-gnu gnu=powerpc64le-linux-gnu arch=ppc64el qemu=ppc64le ;;
    riscv64) triple=riscv64gc-unknown-linux-gnu gnu=riscv64-linux-gnu arch=riscv64 qemu=riscv64 ;;
    wasm)
        triple=wasm32-unknown-unknown gnu=
        subcommand=build ;;
    *) usage ;;
esac
target=$1
shift

cross=../shared/cross/cross
if [ -x $cross ]; then
    run=("$cross" "$target" "$subcommand")
else
    missing=()
    rustup target list --installed | grep -qx "$triple" || missing+=("rustup target add $triple")
    if [ -n "$gnu" ]; then
        command -v "$gnu-gcc" >/dev/null || missing+=("apt install gcc-$gnu libc6-dev-$arch-cross")
        command -v "qemu-$qemu" >/dev/null || missing+=("apt install qemu-user")
        variable=CARGO_TARGET_$(echo "$triple" | tr a-z- A-Z_)
        export "${variable}_LINKER=$gnu-gcc" "${variable}_RUNNER=qemu-$qemu -L /usr/$gnu"
    fi
    if [ ${#missing[@]} -gt 0 ]; then
        echo "tests/foreign.sh: to test for $target:" >&2
        printf '  %s\n' "${missing[@]}" >&2
        exit 2
    fi
    run=(cargo "$subcommand" --target "$triple")
fi

export SIMD_TEST_LEVELS=${SIMD_TEST_LEVELS:-$levels}
for cpu in "${QEMU_CPU:-${cpus[@]}}"; do
    if [ "$cpu" = default ]; then unset QEMU_CPU; else export QEMU_CPU=$cpu; fi
    echo "== $target, CPU $cpu"
    if [ $# -gt 0 ]; then
        "${run[@]}" "$@"
        continue
    fi
    # `from_env` starts its own program again, which an emulated process cannot.
    if [ $subcommand = test ]; then "${run[@]}" -p simd -- --skip from_env; else "${run[@]}" -p simd; fi
    # Emulation is slow: the scenes of the other tests would take half an hour.
    if $exact; then "${run[@]}" -p tests --test exact -- golden awkward flat; fi
    exact=false
done
