// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/shadow_light.h"

#include <gtest/gtest.h>

#include "aureole/loading/load.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/scene/scene.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

/// A wall that is seen from above in the shadow of a plate under a lamp; `rest`: what else there is.
float light_in(const std::string& rest) {
  return load_scene_from_string(
             R"(<scene version="3.0.0"><integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="beams"/></integrator>
<sensor type="orthographic"><transform name="to_world"><scale value="0.5"/><lookat origin="0, 0, 0.5" target="0, 0, 0" up="0, 1, 0"/></transform><film type="hdrfilm"/></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="9"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><translate z="1"/></transform><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
<emitter type="point"><point name="position" x="0" y="0" z="2"/><spectrum name="intensity" value="1"/></emitter>)" +
                 rest + "</scene>",
             "shadow.xml")
      .scene->diffraction()
      ->light_in_shadows();
}

TEST(LightInShadows, IsThatBySurfacesOverDirectLight) {
  EXPECT_EQ(light_in(""), 0) << "the floor around the shadow cannot be seen from it";
  // A ceiling that is lit sends light under the plate, in proportion to what it reflects.
  const auto ceiling = [](const char* reflectance) {
    return std::string(
               R"(<shape type="rectangle"><transform name="to_world"><scale value="9"/><rotate x="1" angle="180"/><translate z="4"/></transform><bsdf type="diffuse"><spectrum name="reflectance" value=")") +
           reflectance + R"("/></bsdf></shape>)";
  };
  const float white = light_in(ceiling("0.8")), dark = light_in(ceiling("0.2"));
  EXPECT_GT(white, 1e-3f);
  EXPECT_LT(white, 1);
  EXPECT_NEAR(dark, 0.25f * white, 1e-4f * white);
  // Not known where light passes surfaces.
  EXPECT_EQ(
      light_in(
          ceiling("0.8") +
          R"(<shape type="rectangle"><transform name="to_world"><translate z="9"/></transform><bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="diffuse"/></bsdf></shape>)"),
      0);
}

}  // namespace
}  // namespace aureole
