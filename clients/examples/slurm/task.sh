#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# One task of the array that render.sh submits:  task.sh TASKS ARGUMENT OF sonard render...
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@60
set -uo pipefail
tasks=$1
shift

# Slurm queues a task again if it is pre-empted or its node fails. This script does so if the program fails in a way
# that another node or a later try may not repeat. Whole frames are kept, and the task continues with the next one.
again() {
  # In one task, SLURM_JOB_ID is the number of the whole array; requeuing it would queue all tasks.
  local task=${SLURM_ARRAY_JOB_ID:-$SLURM_JOB_ID}${SLURM_ARRAY_TASK_ID:+_$SLURM_ARRAY_TASK_ID}
  if ((${SLURM_RESTART_COUNT:-0} < 5)); then
    echo "task $task: $1; queued again"
    scontrol requeue "$task" && exit 0
  fi
}

# shellcheck disable=SC2086  # a command of several words
${SONARD:-sonard} render "$@" --shard "${SLURM_ARRAY_TASK_ID:-1}/$tasks" &
render=$!
trap 'time_is_up=yes; kill "$render"' USR1  # 60 s before Slurm would end it; it ends after the frame in work
wait "$render"
code=$?
while kill -0 "$render" 2>/dev/null; do  # the signal ended the wait, not the program
  wait "$render"
  code=$?
done

case $code in
  0) ;;
  4 | 70 | 71) again "exit code $code" ;;     # engine, defect, memory or descriptors (sonard render --help)
  137 | 139 | 134) again "ended by signal $((code - 128))" ;;  # killed, as by lack of memory, or crashed
  143) [[ -z ${time_is_up-} ]] || again "its time is up" ;;
esac
exit "$code"
