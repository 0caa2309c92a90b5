#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Measures a material and writes the files of balls.xml: make_files.sh [PROGRAM].
set -e
aureole=${1:-aureole}
cd "$(dirname "$0")"
"$aureole" goniometer materials.xml#lacquer --incident 0,20,40,55,68,77,83,87 --directions 240 --step 30 --noise 0.01 \
  --paths 2048 -o lacquer.csv --material lacquer_fitted.txt --json lacquer_fits.json
"$aureole" convert-bsdf lacquer.csv lacquer.bsdf --range 400,700 --step 20 --angles 16 --resolution 16 --normals 64
# The best model as a part of a scene.
{
  echo '<scene version="3.0.0">'
  sed '1s/<bsdf /<bsdf id="fitted" /' lacquer_fitted.txt
  echo '</scene>'
} > lacquer_fitted.xml
rm lacquer_fitted.txt lacquer_fits.json
