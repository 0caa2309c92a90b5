// SPDX-License-Identifier: Apache-2.0
// A pinhole camera.
#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

class PerspectiveSensor final : public LensCamera {
public:
  explicit PerspectiveSensor(const Properties& p) : LensCamera(p) {
    if (p.find("focus_distance"))
      p.note("focus_distance",
             "a pinhole has no focus: \"focus_distance\" has no effect; \"thinlens\" has one");
  }
};

AUREOLE_PLUGIN(PerspectiveSensor, "sensor", "perspective",
               PluginDoc{"Pinhole camera whose optical axis is its local +z axis.",
                         "",
                         lens_camera_parameters({{"focus_distance", "float", "scene units", "none",
                                                  "accepted without effect"}}),
                         {R"(<sensor type="perspective">
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <float name="fov" value="40"/> <string name="fov_axis" value="smaller"/>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <float name="principal_point_offset_x" value="0.1"/> <float name="principal_point_offset_y" value="0"/>
    <float name="focus_distance" value="5"/>
    <film type="hdrfilm"/> <sampler type="sobol"/>
</sensor>)",
                          R"(<sensor type="perspective"><string name="focal_length" value="35mm"/></sensor>)",
                          R"(<sensor type="perspective">
    <!-- the irradiance on the film behind a lens of f/4, from 10 to 20 ms, by rows that begin up to 5 ms later -->
    <string name="measure" value="irradiance"/> <float name="f_number" value="4"/> <string name="aperture" value="sine"/>
    <float name="shutter_open" value="0.01"/> <float name="shutter_close" value="0.02"/>
    <float name="readout_time" value="0.005"/> <string name="readout_direction" value="down"/>
    <animation name="to_world">
        <transform time="0.01"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <transform time="0.03"><lookat origin="0.1, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    </animation>
</sensor>)",
                          R"(<sensor type="perspective">
    <!-- a filter before the lens -->
    <spectrum name="srf" value="360:0, 500:0, 560:1, 830:1"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
