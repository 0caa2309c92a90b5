// SPDX-License-Identifier: Apache-2.0
// A phase function given by values at equal steps of the cosine of the scattering angle.
#include <algorithm>
#include <vector>

#include "aureole/phase/tabulated_phase_function.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

TabulatedPhase read_table(const Properties& p) {
  const std::vector<double> values = get_number_list(p, "values");
  if (values.size() < 2) throw p.error("values", "needs at least two numbers");
  if (values.size() > 100000) throw p.error("values", "more than 100000 numbers");
  for (const double v : values)
    if (v < 0) throw p.error("values", "a phase function must not be negative, got " + std::to_string(v));
  if (std::all_of(values.begin(), values.end(), [](double v) { return v == 0; }))
    throw p.error("values", "all numbers are zero");
  std::vector<double> mu;
  const double cells = double(values.size() - 1);
  for (std::size_t i = 0; i < values.size(); ++i) mu.push_back(-1 + 2 * (double(i) / cells));
  const SpectralGrid& grid = p.context().grid;
  return TabulatedPhase(mu, std::vector<double>{grid.min_nm}, values, grid);
}

class TabPhase final : public TabulatedPhaseFunction {
public:
  explicit TabPhase(const Properties& properties)
      : TabulatedPhaseFunction(properties, std::make_shared<const TabulatedPhase>(read_table(properties))) {}
};

AUREOLE_PLUGIN(
    TabPhase, "phase", "tabphase",
    PluginDoc{
        "A phase function given by values at equal steps of the cosine of the scattering angle, from -1 "
        "(backward) to 1 (forward), linear between them. They are normalised.",
        "",
        {{"values", "string", "", "required", "two or more numbers, not negative and not all zero"}},
        {R"(<phase type="tabphase">
    <string name="values" value="0.5, 0.2, 1, 0.7, 3"/>
</phase>)"}});

}  // namespace
}  // namespace aureole
