#!/usr/bin/env bash
# Counts instructions of kernels under callgrind and compares them with the accepted counts, bench/instructions.txt.
# With --accept, accepts what is counted now. What it needs is built below target/, but for valgrind.
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v valgrind >/dev/null; then
    if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
        echo "$0: valgrind is missing; on Debian: apt-get install valgrind" >&2
        exit 1
    fi
    apt-get update && apt-get install -y --no-install-recommends valgrind
fi

# Runner and library have to be of one version.
version=$(sed -n '/^name = "gungraun-runner"$/{n;s/version = "\(.*\)"/\1/p}' Cargo.lock)
export GUNGRAUN_RUNNER=$PWD/target/gungraun-runner/$version/bin/gungraun-runner
if [ ! -x "$GUNGRAUN_RUNNER" ]; then
    # Unoptimized: it starts valgrind and reads small files.
    CARGO_PROFILE_DEV_DEBUG=0 cargo install gungraun-runner --version "=$version" --locked --debug \
        --root "target/gungraun-runner/$version" --target-dir target/gungraun-runner/build
fi

mkdir -p target
counts=target/instructions.json
cargo bench -p bench --bench instructions -- --output-format=json >$counts
cargo run --release -q -p bench --bin instructions-gate -- $counts "$@"
