#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Renders a labelled data set of a Gemini in the worlds of configs/ (docs/offline.md).
set -euo pipefail

if (($# < 1 || $# > 2)) || [[ $1 == -* ]]; then
  cat <<'END'
Usage: make_dataset.sh DIR [IMAGES_PER_FOLDER]

Renders images of six worlds and of open water into DIR/FOLDER, and makes the data set DIR/set (COCO and YOLO) from them.
Each world has two folders, one for training and one for validation, of 36 images by default: 504 in all. The same command
continues after an interruption. Variables: SONARD, the command (default: sonard); CONFIGS, the folder configs of sonard.
END
  exit 64
fi
here=$(dirname "$(realpath "$0")")
configs=${CONFIGS:-$here/../../../configs}
[[ -d $configs/worlds ]] || configs=/usr/share/sonard/configs
worlds=$(realpath "$configs/worlds")
sonard=${SONARD:-sonard}
out=$1 images=${2:-36}
mkdir -p "$out"

# render SCENE SPLIT SEED: DIR/SCENE_SPLIT.
render() {
  local scene=$1 name=$1_$2
  python3 "$here/poses.py" "$worlds/$scene.sdf" --labels "$here/labels.yaml" --seed "$3" --count "$images" > "$out/$name.csv"
  "$sonard" render "$out/$scene.yaml" --trajectory "$out/$name.csv" --out "$out/$name" --still --truth --seed "$3" --range 15 \
    --bits 16 --compression 2 --clean-png --size 400 --picture-every 0
}

seed=1
for scene in docking_station ssiv manifold oil_and_gas tank gazebo_basin open_water; do
  world="{file: \"$worlds/$scene.sdf\"}"
  [[ $scene != open_water ]] || world=empty
  sed "s|WORLD|$world|" "$here/head.yaml" > "$out/$scene.yaml"
  render "$scene" train "$seed" &
  render "$scene" val $((seed + 1))
  wait $!
  seed=$((seed + 2))
done

rm -rf "$out/set"
PYTHONPATH=$here/../../python${PYTHONPATH:+:$PYTHONPATH} python3 -m sonard_client.to_dataset "$out"/*_train "$out"/*_val \
  --out "$out/set" --format coco,yolo --picture fan --floor-db -48 --labels "$here/labels.yaml" --min-pixels 12 \
  --split "train=*_train" "val=*_val" --config "$out"/*.yaml --title "Sample data set of sonard"
