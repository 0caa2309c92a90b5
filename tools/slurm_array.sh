#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# slurm_array.sh SCENE OUTPUT.exr SPP PARTS [options of sbatch, such as --partition=long]
# Renders a scene as an array of PARTS jobs of SLURM, each with its own samples, and merges them in a last job, which starts when all
# have ended well. Needs the program alone on the nodes, and a folder that all of them see. AUREOLE names the program (default: aureole).
# A part that fails is rendered again by the same command: finished parts are kept.
set -euo pipefail

aureole=${AUREOLE:-aureole}
case "${1:-}" in
  part)  # part SCENE OUTPUT.exr SPP PARTS, one task of the array
    shift
    scene=$1 output=$2 spp=$3 parts=$4 task=$SLURM_ARRAY_TASK_ID
    blocks=$(((spp + 15) / 16))  # samples are divided at multiples of 16
    begin=$((16 * (task * blocks / parts))) end=$((16 * ((task + 1) * blocks / parts)))
    ((end > spp)) && end=$spp
    if ((begin >= end)); then exit 0; fi
    part=${output%.exr}.part$task.exr
    [[ -f ${part%.exr}.finished ]] && exit 0
    "$aureole" render "$scene" -o "$part" --samples "$begin:$end" --resume -q
    touch "${part%.exr}.finished"
    exit ;;
  merge)  # merge OUTPUT.exr
    output=$2 base=${2%.exr}
    "$aureole" merge "$base".part*.state -o "$output"
    rm -f "$base".part*.exr "$base".part*.png "$base".part*.state "$base".part*.finished
    exit ;;
esac
if (($# < 4)) || [[ $2 != *.exr ]] || ! [[ $3 =~ ^[1-9][0-9]*$ && $4 =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: slurm_array.sh SCENE OUTPUT.exr SPP PARTS [options of sbatch]" >&2
  exit 2
fi
scene=$1 output=$2 spp=$3 parts=$4
shift 4
self=$(readlink -f "$0")
array=$(sbatch --parsable --array="0-$((parts - 1))" "$@" "$self" part "$scene" "$output" "$spp" "$parts")
last=$(sbatch --parsable --dependency="afterok:$array" "$@" "$self" merge "$output")
echo "$parts parts are job $array, their sum is job $last: $output"
