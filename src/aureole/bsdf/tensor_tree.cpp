// SPDX-License-Identifier: Apache-2.0
// Scattering of windows and shades in trees of variable resolution: G. Ward, M. Kurt and N. Bonneel, "A practical framework
// for sharing and rendering real-world bidirectional scattering distribution functions", LBNL report 5954E, 2012.
#include <array>

#include "aureole/bsdf/measured/scattering_tree.h"
#include "aureole/bsdf/measured/sheet_bsdf.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class SampledTreeSheet {
public:
  explicit SampledTreeSheet(TensorTreeSheet sheet) : sheet_(std::move(sheet)) {}

  std::array<float, 3> f(int side, bool transmitted, const Vec3& i, const Vec3& o) const {
    const TensorTree& t = tree(side, transmitted);
    // Where the transmission of one side is missing, the tree of the other side is used with exchanged
    // directions.
    const float value = t.empty() && transmitted ? tree(1 - side, true).at(o, i) : t.at(i, o);
    return {value, value, value};
  }

  float pdf(int side, bool transmitted, const Vec3& i, const Vec3& o) const {
    const float all = power(side, false, i) + power(side, true, i);
    if (!(all > 0)) return 0;
    if (is_reversed(side, transmitted)) return power(side, true, i) / all * cosine_hemisphere_pdf(o.z);
    return tree(side, transmitted).at(i, o) * o.z / all;
  }

  std::optional<Vec3> sample(int side, const Vec3& i, float u1, Vec2 u2, bool& transmitted) const {
    const float reflected = power(side, false, i), all = reflected + power(side, true, i);
    if (!(all > 0)) return {};
    const float part = reflected / all;
    transmitted = u1 >= part;
    const float u = transmitted ? remap_above(u1, part) : remap_below(u1, part);
    if (is_reversed(side, transmitted)) return square_to_cosine_hemisphere(u2);
    return tree(side, transmitted).sample(i, u, u2);
  }

  bool is_coloured() const { return false; }
  bool needs_tangent() const {
    for (const auto* both : {&sheet_.reflection, &sheet_.transmission})
      for (const TensorTree& t : *both)
        if (t.rank() == 4) return true;
    return false;
  }
  std::size_t bytes() const {
    std::size_t n = 0;
    for (const auto* both : {&sheet_.reflection, &sheet_.transmission})
      for (const TensorTree& t : *both) n += t.bytes();
    return n;
  }

private:
  const TensorTree& tree(int side, bool transmitted) const {
    return (transmitted ? sheet_.transmission : sheet_.reflection)[std::size_t(side)];
  }
  bool is_reversed(int side, bool transmitted) const {
    return transmitted && tree(side, true).empty() && !tree(1 - side, true).empty();
  }
  /// The fraction that is scattered to that side; an estimate where the tree of the other side is used.
  float power(int side, bool transmitted, const Vec3& i) const {
    return tree(is_reversed(side, transmitted) ? 1 - side : side, transmitted).power(i);
  }

  TensorTreeSheet sheet_;
};

class TensorTreeBsdf final : public SheetBsdf<SampledTreeSheet> {
public:
  explicit TensorTreeBsdf(const Properties& properties)
      : SheetBsdf(properties, read_sheet<SampledTreeSheet>(
                                  properties, true, "klems", [](const WindowFile& file, WindowNotes& notes) {
                                    return SampledTreeSheet(read_tensor_tree_sheet(file, notes));
                                  })) {}
};

AUREOLE_PLUGIN(
    TensorTreeBsdf, "bsdf", "tensor_tree",
    PluginDoc{
        "A window, shade or panel with scattering of variable resolution: Radiance's XML files with tensor "
        "trees of rank 3 (isotropic) or 4, for light from the front and from the back. The normal points into "
        "the room, as in Radiance: the file's back is seen from the side of the normal. y is up. Such files "
        "hold the visible range alone, which is used at all wavelengths.",
        "G. Ward, M. Kurt, N. Bonneel, A practical framework for sharing and rendering real-world bidirectional "
        "scattering distribution functions, LBNL report 5954E, 2012",
        {{"filename", "file", "", "required",
          "an .xml file with <IncidentDataStructure> TensorTree3 or TensorTree4"},
         IncidentSide::documentation()},
        {R"(<bsdf type="tensor_tree">
    <string name="filename" value="shade_tree3.xml"/>
</bsdf>)",
         R"(<bsdf type="tensor_tree">
    <string name="filename" value="shade_tree4.xml"/>
    <string name="incident" value="light"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
