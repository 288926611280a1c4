#!/usr/bin/env bash
# What --isolate costs: the same sweeps with and without; wall clock and processor time, each the least of
# several runs. Prints a table.
#   bench/isolation_cost.sh [build/bin/ricci [THREADS [RUNS]]]
set -euo pipefail
ricci=$(readlink -f "${1:-build/bin/ricci}") threads=${2:-2} runs=${3:-5}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# COPIES files of one surface of so many faces.
meshes() {
    local copies=$1 faces=$2 k
    rm -rf meshes && mkdir meshes
    "$ricci" generate eight --faces "$faces" -o meshes/m000.off -q
    for ((k = 1; k < copies; ++k)); do cp meshes/m000.off "meshes/m$(printf %03d "$k").off"; done
}

# Least seconds by the clock, and of processors.
seconds() {
    local k
    TIMEFORMAT='%R %U %S'
    for ((k = 0; k < runs; ++k)); do
        { time "$ricci" sweep meshes --threads "$threads" -q -o out.h5 "$@" >/dev/null; } 2>&1
    done | awk '{ r = $1; c = $2 + $3; if (NR == 1 || r < R) R = r; if (NR == 1 || c < C) C = c } END { print R, C }'
}

printf '%5s %6s %-11s %8s %8s %8s %8s %15s\n' files faces vertices plain isolated 'plain' 'isolated' 'CPU ms per file'
printf '%5s %6s %-11s %17s %17s\n' '' '' '' 'clock, s' 'processors, s'
while read -r copies faces vertices; do
    meshes "$copies" "$faces"
    echo "$copies $faces $vertices $(seconds --vertices "$vertices") $(seconds --vertices "$vertices" --isolate)" |
        awk '{ printf "%5d %6d %-11s %8.2f %8.2f %8.2f %8.2f %15.1f\n", $1, $2, $3, $4, $6, $5, $7, ($7 - $5) / $1 * 1000 }'
done <<'CASES'
60 400 sample:4
60 400 sample:100
20 2000 sample:200
4 10000 sample:400
1 10000 sample:800
CASES
