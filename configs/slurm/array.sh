#!/bin/bash
# One shard of a sweep per task of an array job, as 'ricci submit --slurm' fills it in. However a task ends early
# (preemption, time limit, a dead node), its next start goes on where it was. With --retry-failed a shard that is
# finished tries again what failed in it.
{{directives}}
set -u

ricci={{ricci}}
folder={{folder}}
shards={{shards}}
{{environment}}
task=${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}
shard=$SLURM_ARRAY_TASK_ID
cpus=${SLURM_CPUS_PER_TASK:-1}
restarts=${SLURM_RESTART_COUNT:-0}
resume=${1:---resume}  # or --retry-failed
out=$(printf '%s/shard-%04d-of-%04d.h5' "$folder" "$shard" "$shards")
say() { printf '%s %s on %s: %s\n' "$(date '+%F %T')" "$task" "${SLURMD_NODENAME:-?}" "$*"; }

say "shard $shard/$shards, start $((restarts + 1)), $cpus CPUs"
if [[ $resume == --resume && -e $out && ! -e $out.parts ]]; then
    say "finished before"
    exit 0
fi

# Nine tenths of the memory that Slurm grants, where it says how much: an item that needs more then fails with a
# message, instead of the task without one.
options=(--threads "$cpus")
memory=${SLURM_MEM_PER_NODE:-$((${SLURM_MEM_PER_CPU:-0} * cpus))}
((memory > 0)) && options+=(--max-memory "$((memory * 9 / 10))M")

# Slurm sends USR1 to this script some time before the time limit: be queued again, which ends this start. TERM
# comes on requeue, preemption and scancel: stop; Slurm knows what comes next. The sweep then ends by itself with
# everything finished on disk; if it is killed before, its journal still holds. A start that finishes nothing in a
# whole time limit would be followed by others like it for ever, so the third such is the last; what it has under way
# may still end within the grace.
journal_size() { stat -c %s "$out.parts/journal" 2>/dev/null || echo 0; }
sweep=
caught=0
stuck=0
stop() {
    caught=1
    [[ -n $sweep ]] && kill -TERM "$sweep" 2>/dev/null
}
near_the_limit() {
    caught=1
    say "the time limit is near"
    if ((restarts >= 2)) && [[ $(journal_size) == "$size_before" ]]; then
        say "nothing is finished since this start: stopping"
        stuck=1
        stop
    else
        scontrol requeue "$task" || stop
    fi
}
trap stop TERM
trap near_the_limit USR1

size_before=$(journal_size)
"$ricci" sweep --config "$folder/sweep.toml" --shard "$shard/$shards" -o "$out" "$resume" "${options[@]}" &
sweep=$!
status=0
while :; do
    caught=0
    wait "$sweep"
    code=$?
    # 127: its end was seen together with a signal, and older bashes forget it then.
    ((code == 127)) || status=$code
    ((caught)) || break
done

case $status in
    0) say "finished" ;;
    1) say "finished; some items failed: see above, and /failures in the result" ;;
    130 | 143)
        if ((stuck)) && [[ $(journal_size) == "$size_before" ]]; then
            say "no progress in one time limit: give more --time"
            exit 1
        fi
        ((stuck)) && scontrol requeue "$task"
        say "stopped; its next start goes on from here"
        exit "$status"
        ;;
    *)
        say "failed with status $status"
        exit "$status"
        ;;
esac
