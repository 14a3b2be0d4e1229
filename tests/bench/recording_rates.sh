#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Measures the cost of recording: pings per second of a configuration with and without it, in turns, on
# loopback.
#   recording_rates.sh PROGRAMS CONFIG [SECONDS] [ROUNDS] [SONARVIEW OPTIONS...]
# CONFIG has a section `recording`, as configs/recording.yaml has; runs without recording leave this section
# out.
set -euo pipefail
programs=$1 config=$2 seconds=${3:-10} rounds=${4:-3}
shift $(($# < 4 ? $# : 4))

# Beside the original, because paths in it are relative to it.
without=$(mktemp --tmpdir="$(dirname "$config")" --suffix=.yaml without-recording-XXXXXX)
log=$(mktemp)
daemon=
trap 'rm -f "$without" "$log"; [[ -z $daemon ]] || kill "$daemon"' EXIT
sed '/^recording:/,/^[^ #]/{/^recording:/d;/^[ #]/d}' "$config" >"$without"

# rate CONFIG: pings per second
rate() {
  "$programs/sonard" run "$1" 2>"$log" &
  daemon=$!
  until grep -q 'sonard ready' "$log"; do
    kill -0 "$daemon" || { cat "$log" >&2; exit 1; }
    sleep 0.05
  done
  "$programs/sonarview" --quiet --seconds "$seconds" "${options[@]}" | sed -n 's/.*rate_hz=\([0-9.]*\).*/\1/p'
  kill "$daemon"
  wait "$daemon"
  daemon=
}

options=("$@")
for ((round = 1; round <= rounds; ++round)); do
  off=$(rate "$without")
  on=$(rate "$config")
  dropped=$(sed -n 's/.*recording: ended .*\(dropped_images=[0-9]*\).*/\1/p' "$log")
  echo "round $round: off ${off} Hz, on ${on} Hz, $(awk "BEGIN { printf \"%+.1f\", 100 * ($on - $off) / $off }") %, $dropped"
done
