// SPDX-License-Identifier: Apache-2.0
// A light that `hide_emitters` lets the sensor's rays pass lies within a segment: edges beside that segment count once.
#include "render/edge_scenes.h"

namespace aureole::test {
namespace {

/// Rays that pass the edge at x = 0 of a black sheet on their way to the floor, which a lamp below the sheet irradiates.
testing::Picture seen_beside_the_edge(const std::string& between) {
  RenderOptions options;
  options.replicates = 4;
  return testing::render(
      load_scene_from_string(fmt::format(R"(<scene version="3.0.0"><string name="length_unit" value="20um"/>
  <integrator type="path"><integer name="max_depth" value="2"/><boolean name="hide_emitters" value="true"/>
    <boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="2 wavelengths"/></integrator>
  <sensor type="orthographic"><transform name="to_world"><scale x="0.06" y="0.3"/>
      <lookat origin="0.07, 0, 2" target="0.07, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="sobol"><integer name="sample_count" value="64"/></sampler>
    <film type="specfilm"><integer name="width" value="4"/><integer name="height" value="1"/><rfilter type="box"/>
      <float name="wavelength_min" value="540"/><float name="wavelength_max" value="560"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film></sensor>{}{}{}{}</scene>)",
                                         rectangle(R"(<translate z="-1"/>)", grey(0.7)), only_edges(),
                                         point("0.9, 0, -0.7"), between),
                             "hidden.xml"),
      options);
}

TEST(HiddenLights, DoNotRepeatTheDiffractionFactor) {
  const testing::Picture
      open = seen_beside_the_edge(""),
      hidden = seen_beside_the_edge(rectangle(
          R"(<scale value="0.4"/><translate x="0.2" z="-0.3"/>)",
          R"(<emitter type="area"><spectrum name="radiance" value="1e-12"/><float name="sampling_weight" value="0"/></emitter>)"));
  double nearest = 0;
  for (std::size_t i = 0; i < open.mean.size(); ++i) {
    // Both draw equal random numbers for the factor of the whole segment.
    EXPECT_NEAR(hidden.mean[i], open.mean[i], 2e-3 * open.mean[i]) << "pixel " << i;
    nearest = std::max(nearest, std::abs(open.mean[i] / open.mean.back() - 1));
  }
  EXPECT_GT(nearest, 0.02) << "the edge must take something near it";
}

}  // namespace
}  // namespace aureole::test
