// SPDX-License-Identifier: Apache-2.0
// Scattering of windows and shades by matrices over patches of the hemispheres: J. H. Klems, "A new method for predicting
// the solar heat gain of complex fenestration systems", ASHRAE Transactions 100(1), 1994.
#include <array>
#include <vector>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/bsdf/measured/sheet_bsdf.h"
#include "aureole/math/piecewise.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// A sheet's matrices with a sampling distribution over outgoing patches for each incident patch. The
/// reflection and the transmission of a side may have different incident patches; each has distributions of
/// its own, and their powers choose between them.
class SampledKlemsSheet {
public:
  explicit SampledKlemsSheet(KlemsSheet sheet) : sheet_(std::move(sheet)) {
    for (std::size_t side = 0; side < 2; ++side)
      for (const bool transmitted : {false, true}) {
        const KlemsMatrix& m = matrix(side, transmitted);
        is_coloured_ |= m.is_coloured;
        if (m.empty()) continue;
        std::vector<float> weights(m.outgoing.count());
        for (std::size_t i = 0; i < m.incident.count(); ++i) {
          for (std::size_t o = 0; o < weights.size(); ++o)
            weights[o] = float(double(m.mean(i, o)) * m.outgoing.projected_solid_angle(o));
          distributions_[2 * side + transmitted].emplace_back(weights);
        }
      }
  }

  std::array<float, 3> f(int side, bool transmitted, const Vec3& i, const Vec3& o) const {
    return matrix(std::size_t(side), transmitted).at(i, o);
  }

  float pdf(int side, bool transmitted, const Vec3& i, const Vec3& o) const {
    const float all = power(side, false, i) + power(side, true, i);
    const KlemsMatrix& m = matrix(std::size_t(side), transmitted);
    if (!(all > 0) || m.empty()) return 0;
    const std::size_t row = m.incident.at(-i.x, -i.y, i.z), column = m.outgoing.at(o.x, o.y, o.z);
    if (row >= m.incident.count() || column >= m.outgoing.count()) return 0;
    return m.mean(row, column) * o.z / all;
  }

  std::optional<Vec3> sample(int side, const Vec3& i, float u1, Vec2 u2, bool& transmitted) const {
    const float reflected = power(side, false, i), all = reflected + power(side, true, i);
    if (!(all > 0)) return {};
    const float part = reflected / all;
    transmitted = u1 >= part;
    const float u = transmitted ? remap_above(u1, part) : remap_below(u1, part);
    const KlemsMatrix& m = matrix(std::size_t(side), transmitted);
    const Piecewise1D& d =
        distributions_[std::size_t(2 * side + transmitted)][m.incident.at(-i.x, -i.y, i.z)];
    float unused = 0;
    std::size_t patch = 0;
    d.sample(u, &unused, &patch);
    return m.outgoing.sample(patch, u2);
  }

  bool is_coloured() const { return is_coloured_; }
  bool needs_tangent() const { return true; }
  std::size_t bytes() const {
    std::size_t n = 0;
    for (std::size_t k = 0; k < 4; ++k) n += matrix(k / 2, k % 2 == 1).values.size() * 3 * sizeof(float);
    return n;
  }

private:
  const KlemsMatrix& matrix(std::size_t side, bool transmitted) const {
    return (transmitted ? sheet_.transmission : sheet_.reflection)[side];
  }
  float power(int side, bool transmitted, const Vec3& i) const {
    const auto& rows = distributions_[std::size_t(2 * side + transmitted)];
    const std::size_t row = matrix(std::size_t(side), transmitted).incident.at(-i.x, -i.y, i.z);
    return row < rows.size() ? float(rows[row].total()) : 0.f;
  }

  KlemsSheet sheet_;
  bool is_coloured_ = false;
  /// distributions by incident patch, index 2 side + transmitted
  std::array<std::vector<Piecewise1D>, 4> distributions_;
};

class Klems final : public SheetBsdf<SampledKlemsSheet> {
public:
  explicit Klems(const Properties& properties)
      : SheetBsdf(properties,
                  read_sheet<SampledKlemsSheet>(properties, false, "tensor_tree",
                                                [](const WindowFile& file, WindowNotes& notes) {
                                                  return SampledKlemsSheet(read_klems_sheet(file, notes));
                                                })) {}
};

AUREOLE_PLUGIN(
    Klems, "bsdf", "klems",
    PluginDoc{
        "A window, shade or panel that was measured or simulated for patches of the hemispheres: the XML "
        "files of WINDOW and Radiance with Klems matrices, for light from the front and from the back. The "
        "normal points into the room, as in Radiance: the file's back is seen from the side of the normal. y "
        "is up. Values are constant in each patch. Such files hold the visible range alone, which is used at "
        "all wavelengths, or CIE XYZ, which becomes smooth spectra.",
        "J. H. Klems, A new method for predicting the solar heat gain of complex fenestration systems, ASHRAE "
        "Transactions 100(1), 1994; G. Ward et al., Simulating the daylight performance of complex fenestration "
        "systems using bidirectional scattering distribution functions within Radiance, Leukos 7(4), 2011",
        {{"filename", "file", "", "required", "an .xml file with <IncidentDataStructure> Columns or Rows"},
         IncidentSide::documentation()},
        {R"(<bsdf type="klems">
    <string name="filename" value="shade_klems.xml"/>
</bsdf>)",
         R"(<bsdf type="klems">
    <string name="filename" value="shade_klems.xml"/>
    <string name="incident" value="light"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole
