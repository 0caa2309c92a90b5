#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Shares of the render time by part of the renderer, by the function that a sample of perf falls in (inlined functions
# count for the one they are in). Usage: bench/profile.sh [folder of the benchmark programs]
set -euo pipefail
. "$(dirname "$0")/scenes.sh"
bin=${1:-$root/build/bench/bin}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

profile() {
  local name=$1 && shift
  perf record -q -F 997 -o "$folder/$name.data" -- "$bin/aureole_render_bench" "$name" "$@" --threads 1 > /dev/null 2>&1
  perf report -i "$folder/$name.data" --sort dso,symbol --stdio 2> /dev/null | grep '%' > "$folder/$name.txt" || true
  names+=("$name")
}
names=()
if have cbox "$cbox"; then profile cbox "$cbox" -D res=256 --spp 64 --sampler sobol; fi
if have matpreview "$matpreview"; then
  profile matpreview "$matpreview" -D width=342 -D height=256 --spp 64 --sampler sobol
fi
profile condensation "$demo" -D width=360 -D height=240 --spp 64

files=()
for name in "${names[@]}"; do files+=("$folder/$name.txt"); done
awk '
  function part(s) {
    if (s ~ /libembree/) return "Embree"
    if (s ~ /libm\.so|libc\.so|libstdc/) return "C and maths libraries"
    if (s ~ /kernel|\[k\]/) return "kernel"
    if (s ~ /Sampler::block|SampleStream/) return "sampler"
    if (s ~ /SampledSpectrum|Wavelength|Texture|Bitmap|Checkerboard|upsampl|Upsampl|TexelSpectrum/) return "spectra and textures"
    if (s ~ /Diffuse::|ielectric::|Conductor::|Plastic::|Twosided|TwoSided|Scatterer|RadialTable|[fF]resnel|optics::/) return "BSDFs"
    if (s ~ /Emitter|Envmap|EnvironmentMap|LightSampler|Piecewise|LatLong|invert|area_sampling|[sS]pherical|solid_angle|sample_direct/)
      return "light sampling"
    if (s ~ /Mesh|Sphere|Ball|Cube|Rectangle|Patch|surface_point|ball_/) return "surface points of shapes"
    if (s ~ /Integrator|Scene::|RayTracer|__wrap/) return "integrator, with ray set-up"
    if (s ~ /RenderJob|CameraRenderer|Film|Filter|Sensor|LensCamera|Camera::/) return "camera, film, job"
    return "other"
  }
  FNR == 1 { ++columns; file[columns] = FILENAME; sub(/.*\//, "", file[columns]); sub(/\.txt/, "", file[columns]) }
  { p = part($0); share[p, columns] += $1; total[p] += $1 }
  END {
    printf "%-30s", "part"; for (c = 1; c <= columns; ++c) printf " %13s", file[c]; print ""
    while (1) {
      best = ""
      for (p in total) if (best == "" || total[p] > total[best]) best = p
      if (best == "") break
      printf "%-30s", best; for (c = 1; c <= columns; ++c) printf " %13.1f", share[best, c]; print ""
      delete total[best]
    }
  }' "${files[@]}"
