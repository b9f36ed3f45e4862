#!/usr/bin/env bash
# Tests on a processor with AVX-512, emulated by Bochs: slow, but it is the one in Debian that has it (qemu does not).
set -euo pipefail

if [ $# -eq 0 ]; then
    cat >&2 <<'END'
usage: tests/avx512.sh CARGO-TEST-ARGUMENTS          as tests/avx512.sh -p simd --test ops -- double

The emulated machine boots Linux with the test as its only program: there are no files, and no second processor. Bochs 2.7 has faults:
a fused multiply-add of f64 loses what cancels (double::operations fails at avx2, too), and a test of half precision fails.
  SIMD_TEST_LEVELS   what has to run (serial,scalar,sse2,sse4.2,avx2,avx512)
  BOCHS_CPU          the processor (corei7_skylake_x); bochs --help cpu lists them
  BOCHS_TIMEOUT      seconds for one program (900)
END
    exit 2
fi

# What it needs is unpacked from Debian's packages, not installed.
unpack() {
    # bochs-term because the default display needs more libraries; none is used.
    local packages=(bochs bochs-term bochsbios vgabios isolinux syslinux-common xorriso cpio busybox-static)
    local state=$home/apt kernel
    echo "tests/avx512.sh: unpacking Bochs and Linux below $home" >&2
    rm -rf "$home"
    mkdir -p "$state/lists/partial" "$state/archives/partial" "$root"
    local apt=(-qq -o "Dir::State::lists=$state/lists" -o "Dir::Cache=$state" -o "Dir::Cache::archives=$state/archives"
        -o APT::Sandbox::User=root -o Debug::NoLocking=1)
    apt-get "${apt[@]}" update
    # This machine's own libraries are used where it has them.
    apt-get "${apt[@]}" install --yes --download-only --reinstall --no-install-recommends "${packages[@]}" >/dev/null
    kernel=$(apt-cache "${apt[@]}" depends linux-image-cloud-amd64 | sed -n 's/.*Depends: \(linux-image-[0-9]\)/\1/p' | head -1)
    (cd "$state/archives" && apt-get "${apt[@]}" download "$kernel")
    for package in "$state"/archives/*.deb; do dpkg-deb --extract "$package" "$root"; done
    rm -rf "$state"
    touch "$root/.complete"
}

# Boots the machine with one program, shows what that prints and ends with its status.
boot() {
    local status
    work=$(mktemp -d)
    bochs=
    trap 'rm -rf "$work"; [ -z "$bochs" ] || kill "$bochs" 2>/dev/null || true' EXIT
    mkdir -p "$work"/files/{bin,dev,proc,sys,tmp} "$work/disk"
    cp "$root/bin/busybox" "$work/files/bin/"
    strip -o "$work/files/test" "$1"
    # Setting the line again, before the power goes, waits until all is sent.
    cat >"$work/files/init" <<END
#!/bin/busybox sh
busybox mount -t devtmpfs dev /dev
busybox mount -t proc proc /proc
busybox mount -t sysfs sys /sys
exec >/dev/ttyS0 2>&1
busybox stty 115200 -opost </dev/ttyS0
$(export -p | grep -E '^declare -x (SIMD|RUST)_' | sed 's/^declare -x/export/')
/test$(printf ' %q' "${@:2}")
echo "== status \$?"
busybox stty opost </dev/ttyS0
busybox poweroff -f
END
    chmod +x "$work/files/init"
    (cd "$work/files" && find . | "$root/bin/cpio" --create --format=newc --quiet) >"$work/disk/files"
    cp "$root"/boot/vmlinuz-* "$work/disk/linux"
    cp "$root/usr/lib/ISOLINUX/isolinux.bin" "$root/usr/lib/syslinux/modules/bios/ldlinux.c32" "$work/disk/"
    # Linux without xsavec and xsaves: Bochs says a wrong size of the compacted registers, upon which Linux gives up AVX.
    printf '%s\n' 'default linux' 'label linux' 'kernel /linux' \
        'append initrd=/files console=ttyS0 quiet loglevel=1 panic=-1 mitigations=off nokaslr tsc=reliable clearcpuid=aperfmperf,xsavec,xsaves noxsaves' >"$work/disk/isolinux.cfg"
    "$root/usr/bin/xorriso" -as mkisofs -quiet -o "$work/disk.iso" -b isolinux.bin -c boot.cat \
        -no-emul-boot -boot-load-size 4 -boot-info-table "$work/disk" 2>"$work/messages" || { cat "$work/messages" >&2; exit 1; }
    cat >"$work/bochs" <<END
cpu: model=${BOCHS_CPU:-corei7_skylake_x}, ips=50000000, reset_on_triple_fault=0
memory: guest=512, host=512
romimage: file=$root/usr/share/bochs/BIOS-bochs-latest
vgaromimage: file=$root/usr/share/bochs/VGABIOS-lgpl-latest
ata0-master: type=cdrom, path=$work/disk.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=$work/serial
clock: sync=none
log: $work/log
panic: action=fatal
sound: waveoutdrv=dummy, waveindrv=dummy
display_library: rfb, options="timeout=0"
END
    : >"$work/serial"
    # Debian's Bochs starts in its debugger: c continues.
    LTDL_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu/bochs/plugins timeout "${BOCHS_TIMEOUT:-900}" \
        "$root/usr/bin/bochs-bin" -q -f "$work/bochs" <<<c >"$work/messages" 2>&1 &
    bochs=$!
    tail --pid=$bochs --follow --lines=+1 --sleep-interval=0.2 "$work/serial" | sed --unbuffered '/^== status/d'
    status=$(sed -n 's/^== status \([0-9]*\).*/\1/p' "$work/serial")
    if [ -z "$status" ]; then
        echo "tests/avx512.sh: the program did not end; Bochs says:" >&2
        tail --lines=5 "$work/messages" "$work/log" >&2
        exit 124
    fi
    exit "$status"
}

project=$(dirname "$(readlink -f "$0")")/..
home=$(realpath -m "${CARGO_TARGET_DIR:-$project/target}/bochs")
root=$home/root
if [ "$1" = --boot ]; then
    export LD_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu:$root/lib/x86_64-linux-gnu
    boot "${@:2}"
fi

[ -e "$root/.complete" ] || unpack
export SIMD_TEST_LEVELS=${SIMD_TEST_LEVELS-serial,scalar,sse2,sse4.2,avx2,avx512}
export CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS=-Ctarget-feature=+crt-static
export CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER="$project/tests/avx512.sh --boot"
cd "$project"
exec cargo test --target x86_64-unknown-linux-gnu "$@"
