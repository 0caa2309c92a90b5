// SPDX-License-Identifier: Apache-2.0
// A camera with a thin lens: points outside the plane of focus are blurred.
#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

class ThinLensSensor final : public LensCamera {
public:
  explicit ThinLensSensor(const Properties& p) : LensCamera(p) {
    const double radius = p.get_float("aperture_radius", {0, 1e9});
    set_lens(radius, p.get_float("focus_distance", clip().far, Range::positive()));
  }
};

AUREOLE_PLUGIN(
    ThinLensSensor, "sensor", "thinlens",
    PluginDoc{
        "Perspective camera with a thin lens behind a circular aperture. A point at distance z along the "
        "axis is imaged as a disc of radius aperture_radius |1/z - 1/focus_distance| as a tangent; times "
        "the picture's width / (2 tan(fov/2)) this is the radius in pixels. The brightness equals the "
        "pinhole camera's: it does not grow with the aperture.",
        "Potmesil & Chakravarty 1981, \"A lens and aperture camera model for synthetic image "
        "generation\"",
        lens_camera_parameters({{"aperture_radius", "float", "scene units", "required",
                                 "radius of the aperture"},
                                {"focus_distance", "float", "scene units", "far_clip",
                                 "distance of the plane of focus, along the axis"}}),
        {R"(<sensor type="thinlens">
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <float name="aperture_radius" value="0.1"/>
    <float name="focus_distance" value="5"/>
    <float name="fov" value="40"/>
    <film type="hdrfilm"/> <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
