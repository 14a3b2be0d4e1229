#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Checks and measures engine gpu on a card in at most ten minutes, the most valuable first:
#   on_a_gpu.sh OUT [LIKE]
# OUT gets text, JSON, images, and summary.md with all tables. LIKE is the OUT of a run on another device, for example
# on llvmpipe, to compare images with. A point that fails or runs out of time does not stop the others.
#
# Needs no network, but the repository with build/release (./test builds it), where it was built or behind a link from
# there, and the packages of `docker/install_packages.sh runtime`.
#
# To try it on llvmpipe, make it shorter with these variables:
#   TESTS    test programs [those of tests/gl]
#   SCENES   scenes [six]
#   PINGS    for each median [31]
#   REPEATS  of each image [1000]
#   SERVE_S  seconds of each served run [10]
#   PACE     factor of all time limits [1]
set -uo pipefail

(($# == 1 || $# == 2)) || { sed -n '4,/^set/ s/^# \?//p' "$0" >&2; exit 64; }
mkdir -p "$1" || exit 1
out=$(realpath "$1") like=${2:+$(realpath "$2")/images}
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
bin=build/release/bin
# Those of the stages come first.
all_tests() { sed -nE 's/^sonard_test\((\w+) gl\b.*/\1/p' tests/gl/{gpu_*,*}/CMakeLists.txt | awk '!seen[$0]++' | tr '\n' ' '; }
read -ra tests <<<"${TESTS-$(all_tests)}"
read -ra scenes <<<"${SCENES-docking flat100k swell100k ripple100k b3_cluster swell1m}"
pings=${PINGS-31} repeats=${REPEATS-1000} serve_s=${SERVE_S-10} pace=${PACE-1}
scenes=("${scenes[@]/#/--scene=}")

# Paths of scenes and test data are those of the machine that built the programs.
built_in=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' build/release/CMakeCache.txt)
[[ -e $built_in ]] || { mkdir -p "$(dirname "$built_in")" && ln -s "$PWD" "$built_in"; }

began=$SECONDS
points=()
others=()
trap '((${#others[@]} == 0)) || kill "${others[@]}" 2>/dev/null' EXIT

# run SECONDS LOG COMMAND...: within the time, and notes how it ended
run() {
  local limit=$(($1 * pace)) log=$2 from=$SECONDS left=$((590 * pace - SECONDS + began)) code
  shift 2
  ((limit < left)) || limit=$left
  ((limit > 0)) || { points+=("| $log | left out: no time | 0 |"); return; }
  echo "on_a_gpu: $log: $*"
  timeout --kill-after=5 "$limit" "$@" &>"$out/$log.txt"
  code=$?
  points+=("| $log | $( ((code == 124)) && echo "stopped after $limit s" || echo "exit code $code") | $((SECONDS - from)) |")
}
# report SECONDS NAME OPTIONS...: a page of sonard_bench
report() {
  run "$1" "$2" "$bin/sonard_bench" --gpu-report "$out/$2.md" --json "$out/$2.json" --references tests/data/oracle "${@:3}"
}
# serve NAME INTERVAL_MS IDS CONFIG: pings per second through the wire, along the track of the demo
serve() {
  : >"$out/$1.log"
  "$bin/sonard" run "$4" 2>>"$out/$1.log" &
  others+=($!)
  timeout $((20 * pace)) sh -c "until grep -q 'sonard ready' '$out/$1.log'; do sleep 0.1; done"
  "$bin/posecast" configs/trajectories/docking_demo.csv --to 127.0.0.1:14600 --loop &>"$out/$1-poses.txt" &
  others+=($!)
  run $((serve_s + 10)) "$1" "$bin/sonarview" --sonar-id "$3" --range 20 --continuous "$2" --quiet --seconds "$serve_s" \
    --out "$out/$1"
  kill "${others[@]}"
  wait "${others[@]}"
  others=()
}

# 1. Is it right?
nvidia-smi --query-gpu=name,driver_version,clocks.sm,clocks.max.sm --format=csv,noheader >"$out/card.txt" 2>/dev/null
run 20 1-selftest "$bin/sonard" selftest
printf '%s\n' "${tests[@]}" >"$out/1-list.txt"
# shellcheck disable=SC2016  # the inner shell expands it
run 100 1-tests xargs --arg-file="$out/1-list.txt" --max-procs="$(nproc)" -I{} sh -c \
  '"$0/{}" --gtest_brief=1 >"$1/1-{}.txt" 2>&1; code=$?; echo "{}: exit code $code"; exit $code' "$bin" "$out"
# 2. Stages, back to back
report 60 2-stages --only-gpu --pings "$pings" "${scenes[@]}"
# 3. As a sonar pings: the clock of a card falls between pings, unless other work keeps it up
report 50 3-at-10-hz --only-gpu --pings $(((pings + 2) / 3)) --rate 10 "${scenes[@]}"
while :; do "$bin/sonard_bench" --gpu-report "$out/beside.md" --only-gpu --scene plane --pings 100000 2>"$out/beside.txt"; done &
others+=($!)
report 50 3-at-10-hz-clock-kept-up --only-gpu --pings $(((pings + 2) / 3)) --rate 10 "${scenes[@]}"
mapfile -t children < <(pgrep --parent "${others[0]}")
kill "${others[@]}" "${children[@]}"
wait "${others[@]}" 2>/dev/null
others=()
# 4. Occupancy: work groups and shared memory. Lists in shared memory instead of local ones would need another see.comp,
# so this is left out. 1024 segments need more than the 32 KiB of shared memory that llvmpipe has.
for group in 32 64 128; do
  for segments in 512 1024; do
    report 10 4-group-$group-segments-$segments --only-gpu --pings $(((pings + 2) / 3)) --group $group \
      --segments $segments --scene swell100k --scene docking
  done
done
# 5. Both engines in turns, 8 heads, the demo
report 60 5-turns --pings "$pings" "${scenes[@]}"
config=$(mktemp --tmpdir=configs --suffix=.yaml on-a-gpu-XXXXXX)
trap '((${#others[@]} == 0)) || kill "${others[@]}" 2>/dev/null; rm -f "$config"' EXIT
{ echo "engine: gpu" && cat configs/demo.yaml; } >"$config"
serve 5-demo 60 513 "$config"
{
  printf '%s\n' "engine: gpu" "world: {file: worlds/docking_station.sdf}" "sampling: {preset: fast}" \
    "poses: {initial: {position_m: [-2.136, -11.913, -25.6], rpy_deg: [0, 0, 80]}, udp: {bind: 127.0.0.1:14600}}" "heads:"
  for k in 1 2 3 4 5 6 7 8; do
    echo "  - {name: head$k, type: gemini_720i, sonar_id: $((512 + k)), mount: {rpy_deg: [0, 20, 0]}, acoustics: {fine_beams: 1}," \
      "network: {bind: 127.0.0.$((k + 1)), alternate_address: 127.0.0.$((k + 1)), netmask: 255.0.0.0, status: [127.0.0.1]}}"
  done
} >"$config"
serve 5-eight-heads 33 513,514,515,516,517,518,519,520 "$config"
# 6. The same bits, and the same images as on another device
report 90 6-images --only-gpu --pings 1 --repeats "$repeats" --images "$out/images" ${like:+--like "$like"} "${scenes[@]}"

{
  echo "# Engine gpu on a card"
  echo
  echo "- date: $(date -u +'%Y-%m-%d %H:%M UTC')"
  echo "- card, driver, clock now and at most: $(cat "$out/card.txt")"
  echo "- OpenGL:$(sed -n 's/^engine  *gpu,//p' "$out/2-stages.md")"
  echo "- seconds in all: $((SECONDS - began))"
  printf '%s\n' "" "| point | end | s |" "|---|---|---|" "${points[@]}" "" "## Tests" ""
  sed 's/^/- /' "$out/1-tests.txt"
  for page in "$out"/[2-5]-*.md; do
    printf '%s\n' "" "## $(basename "$page" .md)" ""
    if [[ $page == */2-* ]]; then grep '^|' "$page"; else grep -e '^| scene' -e '^|---' -e '| .[cg]pu. |' "$page"; fi
  done
  printf '%s\n' "" "## Served" ""
  sed -nE 's/.*(pings_missed=[0-9]+).*(rate_hz=[0-9.]+).*(sonar_id=[0-9]+)/- \3 \2 \1/p' "$out"/5-*.txt
  printf '%s\n' "" "## Images" ""
  grep -E 'repeats|RMS' "$out/6-images.txt" | sed 's/^/- /'
} >"$out/summary.md"
echo "on_a_gpu: $out/summary.md, after $((SECONDS - began)) s"
