// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/hold_out.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "aureole/pigment/colour_difference.h"

namespace aureole::pigment {
namespace {

std::string specimen_name(const Sample& s) { return s.specimen.empty() ? s.name : s.specimen; }

/// Samples of each specimen, in the table's order.
struct Specimens {
  std::vector<std::string> names;
  std::vector<std::vector<std::size_t>> samples;

  explicit Specimens(const SampleTable& table) {
    std::vector<std::string> keys;
    for (std::size_t s = 0; s < table.samples.size(); ++s) {
      if (table.samples[s].paints.empty()) continue;
      const std::string key = specimen_key(table.samples[s]);
      const auto at = std::find(keys.begin(), keys.end(), key);
      if (at == keys.end()) {
        keys.push_back(key), names.push_back(specimen_name(table.samples[s])), samples.push_back({s});
      } else {
        samples[std::size_t(at - keys.begin())].push_back(s);
      }
    }
    // Specimens that have one name in several series are called series/name.
    const std::vector<std::string> short_names = names;
    for (std::size_t n = 0; n < names.size(); ++n) {
      const std::string& series = table.samples[samples[n].front()].series;
      if (!series.empty() && std::count(short_names.begin(), short_names.end(), names[n]) > 1)
        names[n] = series + "/" + names[n];
    }
  }

  std::size_t index_of(const std::string& name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at != names.end()) return std::size_t(at - names.begin());
    std::string known;
    for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
    throw std::domain_error("no specimen is called \"" + name + "\"; there are " + known);
  }
};

bool has_paint(const Sample& sample, const std::string& paint) {
  return std::any_of(sample.paints.begin(), sample.paints.end(),
                     [&](const Component& c) { return c.name == paint; });
}

/// Calls f(group, samples kept back) for each group and collects the predictions.
template <class Fit>
std::vector<HeldOut> predict_groups(const SampleTable& table, const HoldOutGroups& groups, bool with_errors,
                                    const ParallelFor& threads, Fit&& fit) {
  const Specimens specimens(table);
  std::vector<std::vector<std::size_t>> members;
  for (const auto& group : groups)
    for (std::vector<std::size_t>& indices = members.emplace_back(); const std::string& name : group)
      indices.push_back(specimens.index_of(name));
  std::vector<std::vector<HeldOut>> results(groups.size());
  const auto predict_group = [&](std::size_t g) {
    std::vector<std::size_t> left_out;
    for (const std::size_t n : members[g])
      left_out.insert(left_out.end(), specimens.samples[n].begin(), specimens.samples[n].end());
    std::vector<HeldOut>& result = results[g];
    for (const std::size_t n : members[g]) result.push_back({specimens.names[n], specimens.samples[n], {}});
    try {
      JointFit rest = fit(left_out);
      for (HeldOut& one : result) try {
          for (const std::size_t s : one.samples)
            one.predictions.push_back(rest.predict(table.samples[s], with_errors));
        } catch (const std::domain_error& e) {
          one.predictions.clear(), one.reason = e.what();
        }
    } catch (const std::domain_error& e) {
      for (HeldOut& one : result) one.reason = e.what();
    }
  };
  threads(
      groups.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) predict_group(g);
      },
      1);
  std::vector<HeldOut> all;
  for (auto& result : results) std::move(result.begin(), result.end(), std::back_inserter(all));
  return all;
}

}  // namespace

HoldOutGroups each_mixture(const SampleTable& table) {
  const Specimens specimens(table);
  HoldOutGroups groups;
  for (std::size_t n = 0; n < specimens.names.size(); ++n)
    if (table.samples[specimens.samples[n].front()].paints.size() > 1) groups.push_back({specimens.names[n]});
  return groups;
}

HoldOutGroups in_groups(const SampleTable& table, int count) {
  const Specimens specimens(table);
  if (count < 2 || std::size_t(count) > specimens.names.size())
    throw std::domain_error("the number of groups must be from 2 to the number of specimens, " +
                            std::to_string(specimens.names.size()));
  HoldOutGroups groups(std::size_t(count), std::vector<std::string>{});
  for (std::size_t n = 0; n < specimens.names.size(); ++n)
    groups[n % std::size_t(count)].push_back(specimens.names[n]);
  return groups;
}

HoldOutGroups hold_out_groups(const SampleTable& table, std::vector<std::string> words) {
  for (std::string& word : words) {
    word.erase(0, std::min(word.find_first_not_of(" \t"), word.size()));
    word.erase(word.find_last_not_of(" \t") + 1);
  }
  const std::vector<std::string> names = Specimens(table).names;
  if (words.size() == 1 && std::find(names.begin(), names.end(), words.front()) == names.end()) {
    const std::string& word = words.front();
    if (word == "each") return each_mixture(table);
    if (!word.empty() && word.size() < 6 && word.find_first_not_of("0123456789") == word.npos)
      return in_groups(table, std::stoi(word));
  }
  return {words};
}

std::vector<HeldOut> hold_out(const SampleTable& table, const FilmTheory& theory,
                              const JointSettings& settings, const HoldOutGroups& groups,
                              const JointFit& full, bool with_errors, const ParallelFor& threads) {
  return predict_groups(table, groups, with_errors, threads, [&](const std::vector<std::size_t>& left_out) {
    return JointFit(table, theory, settings, left_out, &full);
  });
}

std::vector<HeldOut> hold_out_plain(const SampleTable& table, const FilmTheory& theory,
                                    const HoldOutGroups& groups, const std::string& white,
                                    const std::string& black, const ParallelFor& threads) {
  return predict_groups(table, groups, false, threads, [&](const std::vector<std::size_t>& held) {
    std::set<std::string> series, needed, seen;
    for (const std::size_t s : held) {
      series.insert(table.samples[s].series);
      for (const Component& c : table.samples[s].paints) needed.insert(c.name);
    }
    std::set<std::size_t> used;
    const auto is_held = [&](std::size_t s) { return std::find(held.begin(), held.end(), s) != held.end(); };
    const auto add = [&](std::size_t s) {
      if (is_held(s)) return;
      used.insert(s);
      for (const Component& c : table.samples[s].paints) seen.insert(c.name);
    };
    for (std::size_t s = 0; s < table.samples.size(); ++s) {
      const Sample& sample = table.samples[s];
      if (sample.paints.empty()) continue;
      const bool base = std::all_of(sample.paints.begin(), sample.paints.end(),
                                    [&](const Component& c) { return c.name == white || c.name == black; });
      if (base || series.contains(sample.series)) add(s);
    }
    for (const std::string& paint : needed) {
      if (seen.contains(paint)) continue;
      for (const Sample& pure : table.samples)
        if (pure.paints.size() == 1 && pure.paints[0].name == paint) {
          for (std::size_t s = 0; s < table.samples.size(); ++s)
            if (!table.samples[s].paints.empty() && table.samples[s].series == pure.series) add(s);
          break;
        }
    }
    std::vector<std::size_t> left_out;
    for (std::size_t s = 0; s < table.samples.size(); ++s)
      if (!used.contains(s)) left_out.push_back(s);
    // Errors of reflectances are those of the other fits by default, so that a comparison tells what the other unknowns are worth.
    // With equal errors this fit predicts dark mixtures worse.
    JointSettings settings = JointSettings::plain();
    settings.noise_relative = JointSettings().noise_relative;
    return JointFit(table, theory, settings, left_out);
  });
}

std::map<std::string, double> held_out_differences(const SampleTable& table, const std::vector<HeldOut>& held,
                                                   const Observation& lamp) {
  std::map<std::string, double> all;
  for (const HeldOut& h : held) {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < h.predictions.size(); ++i) {
      const Sample& s = table.samples[h.samples[i]];
      if (s.quantity != Sample::Quantity::reflectance) continue;
      sum += ciede2000(lamp.lab(s.values), lamp.lab(h.predictions[i].values)), ++count;
    }
    if (count > 0) all[h.specimen] = sum / count;
  }
  return all;
}

double interval_coverage(const SampleTable& table, const std::vector<HeldOut>& held) {
  int inside = 0, count = 0;
  for (const HeldOut& h : held)
    for (std::size_t i = 0; i < h.predictions.size(); ++i)
      for (std::size_t l = 0; l < table.nm.size(); ++l, ++count)
        inside += std::abs(h.predictions[i].values[l] - table.samples[h.samples[i]].values[l]) <=
                  kNormal90 * h.predictions[i].error[l];
  return count ? double(inside) / count : 0;
}

bool is_determined(const SampleTable& table, const std::string& specimen, const std::string& white,
                   const std::string& black) {
  const Specimens specimens(table);
  const std::size_t n = specimens.index_of(specimen);
  const Sample& sample = table.samples[specimens.samples[n].front()];
  for (const Component& c : sample.paints) {
    if (c.name == white || c.name == black) continue;
    bool told = false;
    for (std::size_t m = 0; m < specimens.names.size(); ++m) {
      const Sample& other = table.samples[specimens.samples[m].front()];
      if (m == n || other.paints.size() < 2 || !has_paint(other, c.name)) continue;
      told = told || std::any_of(other.paints.begin(), other.paints.end(), [&](const Component& with) {
               return with.name != c.name && with.name != black;
             });
    }
    if (!told) return false;
  }
  return true;
}

}  // namespace aureole::pigment
