// SPDX-License-Identifier: Apache-2.0
// A constant volume, for parameters that expect a volume.
#include "aureole/plugin/registry.h"
#include "aureole/volume/constant_volume.h"

namespace aureole {
namespace {

TexturePtr read_value(const Properties& p, SpectrumRole role) {
  if (!p.has("value")) throw p.error("value", "\"constvolume\" needs the parameter \"value\"");
  TexturePtr value = get_optional_texture(p, "value", role);
  if (!value->is_constant())
    throw p.error("value", "a texture that varies over a surface has no value inside a volume");
  return value;
}

std::optional<Transform> read_box(const Properties& p) {
  if (!p.has("to_world")) return {};
  return p.get_transform("to_world").inverse();
}

class ConstVolume final : public ConstantVolume {
public:
  explicit ConstVolume(const Properties& p)
      : ConstantVolume(p, read_value(p, SpectrumRole::unbounded), read_box(p)) {}

  VolumePtr in_role(SpectrumRole role) const override {
    if (role == SpectrumRole::unbounded) return nullptr;
    if (to_box())
      properties().note("to_world", "has no effect here: it bounds a medium by its extinction or density");
    return std::make_shared<ConstantVolume>(properties(), read_value(properties(), role));
  }
};

AUREOLE_PLUGIN(ConstVolume, "volume", "constvolume",
               PluginDoc{
                   "One value at all points: a number, a colour or a spectrum. A coefficient of a medium "
                   "may also be given directly, without this volume.",
                   "",
                   {{"value", "spectrum", "", "required", "value at all points"},
                    {"to_world", "transform", "", "none",
                     "transform from the unit cube [0, 1]^3 to world space. As the extinction or "
                     "the density of a medium the volume ends at this box; without it, it has no end"}},
                   {R"(<volume type="constvolume">
    <rgb name="value" value="0.8, 0.9, 0.7"/>
</volume>)",
                    R"(<volume type="constvolume">
    <float name="value" value="0.8"/>
    <transform name="to_world"> <scale value="2"/> <translate x="-1" y="-1" z="-1"/> </transform>
</volume>)"}});

}  // namespace
}  // namespace aureole
