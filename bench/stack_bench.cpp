// SPDX-License-Identifier: Apache-2.0
// Milliseconds per wavelength of stacks of layers: fluxes (mode 0), and radiance in all azimuthal modes.
#include <benchmark/benchmark.h>

#include "aureole/optics/stack/plane_stack.h"

namespace aureole {
namespace {

optics::StackDescription slab(double optical_thickness) {
  optics::StackDescription d;
  d.layers = {optics::StackLayer::of_optical_thickness(optical_thickness, 0.95,
                                                       optics::LegendrePhase::henyey_greenstein(0.8))};
  return d;
}

/// Arguments: streams, optical thickness.
void stack_fluxes(benchmark::State& state) {
  const optics::PlaneStack stack(slab(double(state.range(1))), {int(state.range(0))});
  for (auto _ : state) benchmark::DoNotOptimize(stack.fluxes(optics::StackLight::diffuse()).reflectance);
}
BENCHMARK(stack_fluxes)->ArgsProduct({{16, 64}, {1, 100}})->Unit(benchmark::kMillisecond);

void stack_radiance(benchmark::State& state) {
  const optics::PlaneStack stack(slab(double(state.range(1))), {int(state.range(0))});
  const optics::StackLight beam[] = {optics::StackLight::beam(0.7)};
  const double cosines[] = {0.5}, azimuths[] = {0, 1};
  for (auto _ : state) benchmark::DoNotOptimize(stack.radiance(beam, cosines, azimuths).front());
}
BENCHMARK(stack_radiance)->ArgsProduct({{16, 64}, {1, 100}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aureole
