#!/bin/bash
# Joins the shards of a sweep into one file, as 'ricci submit --slurm' fills it in.
{{directives}}
set -u

ricci={{ricci}}
folder={{folder}}
output={{output}}

say() { printf '%s %s on %s: %s\n' "$(date '+%F %T')" "$SLURM_JOB_ID" "${SLURMD_NODENAME:-?}" "$*"; }

"$ricci" merge "$folder" -o "$output"
status=$?
if ((status > 1)); then
    say "not merged; once the reason is gone: bash $folder/submit.sh (what is finished stays)"
    exit "$status"
fi
say "wrote $output"
