// SPDX-License-Identifier: Apache-2.0
// Light over time by a table: flashes, decays, measured waveforms.
#include <algorithm>
#include <cmath>

#include "aureole/modulation/modulation.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Timetable final : public Modulation {
public:
  explicit Timetable(const Properties& p) : Modulation(p) {
    times_ = get_number_list(p, "times"), values_ = get_number_list(p, "values");
    if (times_.size() < 2) throw p.error("times", "needs at least two times");
    if (times_.size() > kMostTimes)
      throw p.error("times", "has " + std::to_string(times_.size()) + " times; at most 1000000 are read");
    if (values_.size() != times_.size())
      throw p.error("values", "needs one value for each of the " + std::to_string(times_.size()) +
                                  " times, has " + std::to_string(values_.size()));
    double area = 0, peak = 0;
    areas_.push_back(0);
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (!(values_[i] >= 0)) throw p.error("values", "must not be negative");
      peak = std::max(peak, values_[i]);
      if (i == 0) continue;
      if (!(times_[i] >= times_[i - 1])) throw p.error("times", "must not decrease");
      area += 0.5 * (values_[i] + values_[i - 1]) * (times_[i] - times_[i - 1]);
      areas_.push_back(area);
    }
    const double length = times_.back() - times_.front();
    if (!(length > 0)) throw p.error("times", "must not all be equal");
    if (!(area > 0)) throw p.error("values", "are zero all the time: the emitter would never shine");
    repeats_ = p.get_bool("repeat", false);
    refer_to(area / length, peak);
  }

protected:
  double relative(double time) const override {
    if (repeats_) {
      const double length = times_.back() - times_.front(), turns = (time - times_.front()) / length;
      time = times_.front() + (turns - std::floor(turns)) * length;
    }
    if (time < times_.front()) return values_.front();
    const auto later = std::upper_bound(times_.begin(), times_.end(), time);
    if (later == times_.end()) return values_.back();
    const std::size_t k = std::size_t(later - times_.begin());
    return values_[k - 1] +
           (values_[k] - values_[k - 1]) * (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
  }

  double primitive(double time) const override {
    double before = 0;
    if (repeats_) {
      const double length = times_.back() - times_.front(), turns = (time - times_.front()) / length;
      before = std::floor(turns) * areas_.back();
      time = times_.front() + (turns - std::floor(turns)) * length;
    }
    if (time < times_.front()) return values_.front() * (time - times_.front());
    const auto later = std::upper_bound(times_.begin(), times_.end(), time);
    if (later == times_.end()) return before + areas_.back() + values_.back() * (time - times_.back());
    const std::size_t k = std::size_t(later - times_.begin());
    const double width = times_[k] - times_[k - 1], x = time - times_[k - 1];
    return before + areas_[k - 1] + values_[k - 1] * x + 0.5 * (values_[k] - values_[k - 1]) * x * x / width;
  }

private:
  static constexpr std::size_t kMostTimes = 1000000;
  std::vector<double> times_, values_;
  std::vector<double> areas_;  ///< integral from the first time to each
  bool repeats_ = false;
};

AUREOLE_PLUGIN(
    Timetable, "modulation", "timetable",
    PluginDoc{
        "Light over time by a table, linear between its times. Two equal times are a step. Before the first time "
        "and after the last one the light keeps the value at that end, unless the table repeats.",
        "",
        {{"times", "string", "s", "required", "times, in increasing order"},
         {"values", "string", "", "required", "light at these times, relative to each other"},
         {"repeat", "boolean", "", "false", "the table is one period of the light"}},
        {R"(<modulation type="timetable">
    <string name="times" value="0, 0.0002, 0.001"/> <string name="values" value="0, 1, 0"/>
    <boolean name="repeat" value="false"/> <string name="reference" value="peak"/>
</modulation>)"}});

}  // namespace
}  // namespace aureole
