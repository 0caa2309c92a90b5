# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2034
# Sourced by the other scripts: the scenes that are rendered.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export AUREOLE_CACHE=off  # tables are computed at each start
shared=${AUREOLE_SHARED:-$root/../shared}
cbox=$shared/data/mitsuba/scenes/cbox/cbox.xml
cbox_spectral=$shared/data/mitsuba/scenes/cbox/cbox-spectral.xml
matpreview=$shared/data/mitsuba/scenes/matpreview/matpreview.xml
demo=$root/scenes/condensation/condensation.xml

# True where a scene exists; else prints its name as missing.
have() {
  [[ -f $2 ]] && return
  echo "$1: skipped, there is no $2 (set AUREOLE_SHARED to the folder that holds data/mitsuba/scenes)"
  return 1
}
