// SPDX-License-Identifier: Apache-2.0
// Stacks against other programs: PythonicDISORT and iadpython.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "optics/stack/references/references.h"
#include "optics/stack/stack_test_support.h"

namespace aureole::optics {
namespace {

using testing::hg_layer;
using testing::slide;

StackDescription described(const DisortReference& r) {
  StackDescription d;
  for (const auto& l : r.layers)
    d.layers.push_back(StackLayer::of_optical_thickness(
        l.optical_thickness, l.albedo, LegendrePhase::double_henyey_greenstein({l.share, l.g1, l.g2})));
  if (r.substrate > 0) d.substrate = r.substrate;
  return d;
}

StackPosition inside(const DisortReference& r) {
  StackPosition p{0, r.depth};
  while (p.depth > r.layers[p.layer].optical_thickness) p.depth -= r.layers[p.layer++].optical_thickness;
  return p;
}

/// Relative to each value and 1 % of the largest.
void expect_radiance(std::span<const double> got, const double* expected, double tolerance,
                     const char* where) {
  const double scale = *std::max_element(expected, expected + 15);
  for (int i = 0; i < 15; ++i)
    EXPECT_NEAR(got[i], expected[i], tolerance * (expected[i] + 0.01 * scale)) << where << ", value " << i;
}

TEST(StackReferences, FluxesOfDisort) {
  for (const DisortReference& r : kDisort) {
    if (r.layers[0].g1 > 0.9) continue;  // the many streams of that one are for radiances
    const PlaneStack stack(described(r), {80});
    const StackLight light = StackLight::beam(r.cosine);
    const StackFluxes f = stack.fluxes(light);
    EXPECT_NEAR(f.reflectance, r.fluxes[0], 1e-7);
    EXPECT_NEAR(f.transmittance, r.fluxes[1] - r.fluxes[6], 1e-7);
    EXPECT_NEAR(f.unscattered_transmittance, (1 - r.substrate) * r.fluxes[2], 1e-8);
    const StackPosition at[] = {inside(r)};
    const StackField field = stack.fields(light, at)[0];
    EXPECT_NEAR(field.flux_up, r.fluxes[3], 1e-7);
    EXPECT_NEAR(field.flux_down, r.fluxes[4], 1e-7);
    EXPECT_NEAR(field.unscattered_flux_down, r.fluxes[5], 1e-8);
  }
}

TEST(StackReferences, RadianceOfDisort) {
  for (const DisortReference& r : kDisort) {
    const bool is_peaked = r.layers[0].g1 > 0.9;
    const PlaneStack stack(described(r), {64});
    const StackLight lights[] = {StackLight::beam(r.cosine)};
    std::vector<double> both(std::begin(r.cosines), std::end(r.cosines)), outside = both;
    for (const double c : r.cosines) both.push_back(-c);
    if (r.substrate == 0) outside = both;
    const double tolerance = is_peaked ? 1e-3 : 2e-6;
    const auto left = stack.radiance(lights, outside, kDisortAzimuths);
    expect_radiance(std::span(left).first(15), r.up, tolerance, "top");
    if (r.substrate == 0) expect_radiance(std::span(left).last(15), r.down, tolerance, "bottom");
    if (is_peaked) continue;
    const auto inner = stack.radiance(lights, inside(r), both, kDisortAzimuths);
    expect_radiance(std::span(inner).first(15), r.up_inside, tolerance, "up inside");
    expect_radiance(std::span(inner).last(15), r.down_inside, tolerance, "down inside");
  }
}

TEST(StackReferences, FewStreamsWithSingleScattering) {
  const DisortReference& r = kDisort[5];
  const StackLight lights[] = {StackLight::beam(r.cosine)};
  const auto worst = [&](const DiscreteOrdinates& method) {
    const auto got = PlaneStack(described(r), method).radiance(lights, r.cosines, kDisortAzimuths);
    double error = 0;
    for (int i = 0; i < 15; ++i) error = std::max(error, std::abs(got[i] / r.up[i] - 1));
    return error;
  };
  const double corrected = worst({24}), truncated = worst({24, false});
  std::printf("g = .92, 24 streams: largest error of reflected radiance %.4f, %.4f without delta-M\n",
              corrected, truncated);
  EXPECT_LT(corrected, 0.01);
  EXPECT_GT(truncated, 0.1);
}

TEST(StackReferences, SlabsOfIadpython) {
  for (const IadReference& r : kIad) {
    StackDescription d;
    if (r.slides != 1) d.layers.push_back(slide(r.slides));
    d.layers.push_back(hg_layer(r.optical_thickness, r.albedo, r.g, r.index));
    if (r.slides != 1) d.layers.push_back(slide(r.slides));
    const PlaneStack stack(d, {128});
    const StackLight lights[] = {StackLight::beam(1), StackLight::diffuse()};
    const auto f = stack.fluxes(lights);
    const double tolerance = r.index == 1 ? 1e-6 : 5e-5;
    EXPECT_NEAR(f[0].reflectance, r.reflectance, tolerance);
    EXPECT_NEAR(f[0].transmittance, r.transmittance, tolerance);
    EXPECT_NEAR(f[1].reflectance, r.diffuse_reflectance, tolerance);
    EXPECT_NEAR(f[1].transmittance, r.diffuse_transmittance, tolerance);
  }
}

}  // namespace
}  // namespace aureole::optics
