#!/usr/bin/env bash
# `simd` beside its peers: builds the benchmark for each level that `wide` needs a build for, runs all contestants in turn in
# several rounds, and writes the table of medians to bench/reports/simd_peers.md. Ten minutes on an idle machine.
#
#   bench/simd_peers.sh [ROUNDS]      5 if not given
set -euo pipefail
cd "$(dirname "$0")/.."
rounds=${1:-5}
report=bench/reports/simd_peers.md

builds=(baseline)
has() { for flag in "$@"; do grep -qw "$flag" /proc/cpuinfo || return 1; done; }
has avx2 fma bmi2 && builds+=(x86-64-v3)
has avx512f avx512bw avx512cd avx512dq avx512vl && builds+=(x86-64-v4)

bench() {
    local build=$1
    shift
    if [ "$build" = baseline ]; then
        cargo bench -q -p bench --bench simd_peers "$@"
    else
        RUSTFLAGS="-C target-cpu=$build" cargo bench -q -p bench --bench simd_peers --target-dir "target/$build" "$@"
    fi
}
for build in "${builds[@]}"; do bench "$build" --no-run; done

export CRITERION_HOME=$PWD/target/criterion
rm -rf "$CRITERION_HOME"/{slab,triangle,mandelbrot,dot,transpose,compress,sin_cos,gather}
load=$(cut -d ' ' -f 1 /proc/loadavg)
for ((round = 1; round <= rounds; round++)); do
    echo "round $round of $rounds" >&2
    for build in "${builds[@]}"; do
        # Of the other builds only `wide` is wanted: the rest is dispatched at run time.
        filter=()
        [ "$build" = baseline ] || filter=(/wide/)
        bench "$build" -- "${filter[@]}" --save-baseline "round$round" \
            --warm-up-time 0.2 --measurement-time 0.6 --sample-size 30 --nresamples 1001 --noplot >/dev/null
    done
done

mkdir -p "$(dirname $report)"
{
    echo "# \`simd\` beside its peers"
    echo
    echo "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), load $load at the start, $(rustc -V), $rounds rounds; by \`bench/simd_peers.sh\`."
    echo
    cargo run --release -q -p bench --bin simd-peers-table -- --crates
} >$report.new
mv $report.new $report
cat $report
