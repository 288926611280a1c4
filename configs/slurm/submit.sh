#!/bin/bash
# Submits the array job of a sweep and the job that joins its shards, as 'ricci submit --slurm' fills it in. To be
# run again after a failure: what is finished stays; with --retry-failed, all but what failed.
set -eu

folder={{folder}}
directory={{directory}}

mkdir -p "$folder/logs"
logs=${folder//%/%%}/logs
array=$(sbatch --parsable --chdir="$directory" --output="$logs/%A_%a.log" "$folder/array.sh" "$@")
array=${array%%;*}
echo "array job $array"
# After any end of the tasks: where one has failed for good, the merge says which shard is missing.
merge=$(sbatch --parsable --chdir="$directory" --output="$logs/%j_merge.log" --dependency="afterany:$array" \
    "$folder/merge.sh")
echo "merge job ${merge%%;*}"
