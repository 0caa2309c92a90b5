#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Writes the measured files of this folder: make_files.sh [PROGRAM]. The other two are those of the tests
# (tests/bsdf/data/measured/make_tables.py).
set -e
aureole=${1:-aureole}
cd "$(dirname "$0")"
"$aureole" convert-bsdf materials.xml#golden_paint golden_paint.bsdf --angles 10 --resolution 12 --normals 64 --step 40
"$aureole" convert-bsdf materials.xml#brushed_copper brushed_copper.bsdf --angles 7 --azimuths 13 --resolution 8 --normals 32 --step 120
"$aureole" convert-bsdf materials.xml#screen screen.klems --format klems --basis quarter
cp ../../tests/bsdf/data/measured/small_merl.binary rough_metal.binary
cp ../../tests/bsdf/data/measured/glossy_table.csv glossy_red.csv
