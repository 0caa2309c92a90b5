// SPDX-License-Identifier: Apache-2.0
// The same value everywhere, for places where a volume is expected.
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

class ConstVolume final : public ConstantVolume {
public:
  explicit ConstVolume(const Properties& p) : ConstantVolume(p, read_value(p, SpectrumRole::unbounded)) {}

  VolumePtr as_emission() const override {
    return std::make_shared<ConstantVolume>(properties(), read_value(properties(), SpectrumRole::emission));
  }
};

AUREOLE_PLUGIN(ConstVolume, "volume", "constvolume",
               PluginDoc{
                   "The same value everywhere: a number, a colour or a spectrum. A coefficient of a medium "
                   "may be given directly, too; the scene format knows both ways.",
                   "",
                   {{"value", "spectrum", "", "required", "the value"}},
                   {R"(<volume type="constvolume">
    <rgb name="value" value="0.8, 0.9, 0.7"/>
</volume>)"}});

}  // namespace
}  // namespace aureole
