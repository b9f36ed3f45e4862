#!/usr/bin/env bash
# `tracer` beside Embree: the same rays, all methods in turn, one thread, by CPU time. Writes bench/reports/ray_peers.md.
#
#   bench/ray_peers.sh PEERS [SCENE ...]
#
# PEERS is a folder with the harness that loads bench/peers-plugin: bin/bench, bin/plug_embree.so, scenes/NAME.mesh and
# rays/NAME_{prim_mort,prim_scan,shadow,ao,bounce1,bounce2}.ray. SCENE is what is in its scenes/, if none is given.
#
# Embree gets all its modes and shows its best for each row; tracer gets the method `auto`, which is told nothing. Primary rays are handed
# to Embree along a Morton curve, which suits it better, to tracer row by row. REPEAT=7 is how often, THREADS=1, LEVEL=best.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || { sed -n '2,11s/^# \{0,1\}//p' "$0" >&2; exit 2; }
peers=$(realpath "$1")
shift
scenes=("$@")
[ ${#scenes[@]} -gt 0 ] || for mesh in "$peers"/scenes/*.mesh; do scenes+=("$(basename "$mesh" .mesh)"); done
cargo build --release -q -p peers-plugin
ours=$PWD/target/release/libpeers_plugin.so/wide8
embree="embree/q=med"
level=${LEVEL:-best}
if [ "$level" != best ]; then
    ours+=";level=$level"
    embree+=";isa=$level"
fi
report=bench/reports/ray_peers${LEVEL:+_$LEVEL}${THREADS:+_threads_$THREADS}.md

# Runs one kind of rays: its name, Embree's methods, ours; then the files of rays, Embree's first.
row() {
    local name=$1 theirs=$2 our=$3 methods=()
    shift 3
    for method in $theirs; do methods+=("$embree/$method"); done
    # Of a packet, its share for each ray.
    local counted
    counted=$(cd "$peers" && bin/bench "scenes/$scene.mesh" -t 1 -r 1 -m "$ours;count=1/$our" -R "${2:-$1}" 2>&1 >/dev/null |
        awk '/^counted/ { print $2 " | " $3; exit }')
    (cd "$peers" && bin/bench "scenes/$scene.mesh" -t "${THREADS:-1}" -c 65536 -r "${REPEAT:-7}" \
        -m "${methods[@]}" "$ours/$our" -R "$@") |
        awk -F, -v name="$name" -v theirs="$(basename "$1")" -v mine="$(basename "${2:-$1}")" -v scene="$scene" -v counted="$counted" '
            function rate() { for (i = 1; i <= NF; i++) if ($i ~ /^wall_med=|^cpu_med=/) { split($i, p, "="); v[p[1]] = p[2] } return v["cpu_med"] }
            # The harness names a set of rays by what follows the first "_" of its file.
            BEGIN { sub(/^[^_]*_/, "", theirs); sub(/^[^_]*_/, "", mine) }
            { set = $3 }
            set == theirs && $4 ~ /^embree/ && rate() > best { best = rate(); mode = $4; sub(/.*\//, "", mode) }
            set == mine && $4 !~ /^embree/ { our = rate() }
            END {
                if (!best || !our || counted == "") { print "ray_peers.sh: no figure for " name " in " scene > "/dev/stderr"; exit 1 }
                printf "| %s | %s | %.2f (%s) | %.2f | %.2f | %s |\n", scene, name, best, mode, our, our / best, counted
            }'
}

load=$(cut -d ' ' -f 1 /proc/loadavg)
{
    echo "# \`tracer\` beside Embree"
    echo
    echo "$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1) (family $(sed -n 's/^cpu family.*: //p' /proc/cpuinfo | head -1)," \
        "model $(sed -n 's/^model\t.*: //p' /proc/cpuinfo | head -1)), load $load at the start, $(rustc -V), level $level, ${THREADS:-1} thread(s)," \
        "medians of ${REPEAT:-7}; by \`bench/ray_peers.sh\`. Million rays per second of CPU time; Embree's best mode in brackets." \
        "Nodes and triangle tests are auto's; what several rays do together counts once, shared among them."
    echo
    echo "| scene | rays | Embree | auto | ratio | nodes a ray | triangle tests a ray |"
    echo "|---|---|---|---|---|---|---|"
    for scene in "${scenes[@]}"; do
        echo "$scene" >&2
        row "primary" "i1 i8c i16c" i "rays/${scene}_prim_mort" "rays/${scene}_prim_scan"
        row "hard shadow" "o1 o16 o16c o1m" o "rays/${scene}_shadow"
        row "ambient occlusion" "o1 o16 o16c o1m" o "rays/${scene}_ao"
        row "bounce 1" "i1 i16 i1m" i "rays/${scene}_bounce1"
        row "bounce 2" "i1 i16 i1m" i "rays/${scene}_bounce2"
    done
} >"$report.new"
mv "$report.new" "$report"
cat "$report"
