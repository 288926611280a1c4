#!/usr/bin/env bash
# What --isolate costs: the same sweeps with and without, best of several runs. Prints a table.
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

# Seconds of the fastest of the runs.
seconds() {
    local best= start end took k
    for ((k = 0; k < runs; ++k)); do
        start=$(date +%s%N)
        "$ricci" sweep meshes --threads "$threads" -q -o out.h5 "$@" >/dev/null
        end=$(date +%s%N)
        took=$(awk "BEGIN { print ($end - $start) / 1e9 }")
        best=$(awk "BEGIN { print \"$best\" == \"\" || $took < $best + 0 ? $took : $best }")
    done
    echo "$best"
}

printf '%6s %7s %-11s %9s %9s %9s %12s\n' files faces vertices plain isolated ratio 'ms per file'
while read -r copies faces vertices; do
    meshes "$copies" "$faces"
    plain=$(seconds --vertices "$vertices") isolated=$(seconds --vertices "$vertices" --isolate)
    awk -v c="$copies" -v f="$faces" -v v="$vertices" -v p="$plain" -v i="$isolated" 'BEGIN {
        printf "%6d %7d %-11s %8.2fs %8.2fs %9.2f %12.1f\n", c, f, v, p, i, i / p, (i - p) / c * 1000 }'
done <<'CASES'
60 400 sample:16
60 400 all
20 2000 all
4 10000 sample:400
1 10000 sample:800
CASES
