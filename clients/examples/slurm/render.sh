#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Renders a trajectory with many Slurm tasks that fill one folder (docs/cluster.md).
set -euo pipefail

usage() {
  cat <<'END'
Usage: render.sh TASKS [SBATCH OPTION...] -- CONFIG --trajectory FILE --out DIR [OPTION OF sonard render...]
       render.sh progress DIR

The first form submits an array of TASKS tasks with one core each, and a final job that renders missing frames
and writes the log. The second form prints the number of frames and the states of the tasks.
Options before "--" are for sbatch (--partition=P, --gpus-per-task=1, --time=2:00:00). Files and DIR must be on a
file system that all nodes share. The output of task N is in DIR.tasks/N.log. To continue after a cancellation,
run the same command again.
The variable SONARD sets the command that a node runs (default: sonard), for example
"apptainer run /shared/sonard.sif".
END
}

# option NAME ARGUMENT...: the value of --NAME VALUE or --NAME=VALUE.
option() {
  local name=--$1
  while shift && (($#)); do
    case $1 in
      "$name") echo "${2-}"; return ;;
      "$name"=*) echo "${1#*=}"; return ;;
    esac
  done
}

submit() {
  local tasks=$1 task out array log options=()
  shift
  while (($#)) && [[ $1 != -- ]]; do
    options+=("$1")
    shift
  done
  shift || { usage >&2; exit 64; }
  [[ " $* " != *" --overwrite "* ]] || { echo "render.sh: --overwrite is not supported, because a requeued task would delete its own frames; delete the folder instead" >&2; exit 64; }
  out=$(option out "$@")
  [[ $tasks =~ ^[1-9][0-9]*$ && -n $out ]] || { usage >&2; exit 64; }
  out=$(realpath -m "$out")
  mkdir -p "$out.tasks"
  task=$(dirname "$(realpath "$0")")/task.sh
  options+=(--parsable --job-name="sonard:$out")
  array=$(sbatch "${options[@]}" --array="1-$tasks" --output="$out.tasks/%a.log" "$task" "$tasks" "$@")
  # Not "afterok": this job renders the frames that tasks have not finished.
  log=$(sbatch "${options[@]}" --dependency="afterany:$array" --output="$out.tasks/log.log" "$task" 1 "$@")
  echo "array $array of $tasks tasks, then $log; progress: $0 progress $out; to cancel: scancel $array $log"
}

progress() {
  local out frames=unknown
  out=$(realpath -m "$1")
  [[ ! -f $out/run.json ]] || frames=$(sed -n 's/^ *"frames": *\([0-9]*\),*$/\1/p' "$out/run.json")
  # The JSON of a frame is its last file.
  echo "$(find "$out" -maxdepth 1 -name '*_*.json' 2>/dev/null | wc -l) of $frames frames"
  squeue --noheader --array --name="sonard:$out" --format=%T | sort | uniq -c
}

case ${1-} in
  -h | --help) usage ;;
  progress) progress "${2:?progress requires DIR}" ;;
  *) (($# > 1)) || { usage >&2; exit 64; }; submit "$@" ;;
esac
