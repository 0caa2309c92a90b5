// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "aureole/pigment/domain.h"
#include "aureole/pigment/kubelka_munk_inverse.h"
#include "aureole/pigment/prediction.h"

namespace aureole::pigment {
namespace {

using Values = std::vector<double>;

double share_of(const Sample& sample, const std::string& paint) {
  for (const Component& c : sample.paints)
    if (c.name == paint) return c.fraction;
  return 0;
}

/// Samples that are repeats of one measurement.
struct Group {
  std::vector<std::size_t> members;
};

/// The groups of samples that contain information about one paint.
struct Evidence {
  std::string paint;
  std::optional<std::size_t> opaque, film_r, film_t;
  std::vector<std::size_t> drawdowns, tints;
  FitMethod method = FitMethod::masstone;
  std::vector<std::size_t> used;  ///< groups used, except the white's
};

class Fitter {
public:
  Fitter(const SampleTable& table, const FitSettings& settings) : table_(table), settings_(settings) {
    check(table);
    check_samples();
    collect_groups();
    for (const std::string& paint : paints_) evidence_.push_back(collect(paint));
    for (Evidence& e : evidence_) choose_method(e);
    check_units();
  }

  const std::vector<Group>& groups() const { return groups_; }

  /// Returns the mean of each group, without sample `left_out` if given.
  std::vector<Values> means(std::optional<std::size_t> left_out = {}) const {
    std::vector<Values> all;
    for (const Group& g : groups_) {
      Values& mean = all.emplace_back(table_.nm.size());
      int count = 0;
      for (const std::size_t s : g.members) {
        if (left_out == s) continue;
        for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += table_.samples[s].values[i];
        ++count;
      }
      for (double& v : mean) v /= count;
    }
    return all;
  }

  Fit solve(const std::vector<Values>& means) const;
  void add_errors(Fit& fit) const;

private:
  void check_samples() const;
  void collect_groups();
  Evidence collect(const std::string& paint) const;
  void choose_method(Evidence& e) const;
  void check_units() const;
  const Evidence& white() const;
  double inner(const std::vector<Values>& means, std::size_t group, std::size_t i) const {
    return inner_reflectance(settings_.surface, means[group][i]);
  }
  double ratio(const std::vector<Values>& means, std::size_t group, std::size_t i) const {
    return k_over_s(inner(means, group, i));
  }
  const Sample& first(std::size_t group) const { return table_.samples[groups_[group].members.front()]; }
  Coefficients absolute(const Evidence& e, const std::vector<Values>& means, std::size_t i) const;
  Drawdown drawdown(const std::vector<Values>& means, std::size_t group, std::size_t i) const {
    return {inner(means, group, i), substrate_at(table_, settings_.surface, first(group), i)};
  }
  double scattering_of_tints(const Evidence& e, const std::vector<Values>& means, Coefficients white,
                             double masstone, std::size_t i) const;
  double residual(const Evidence& e, const Palette& palette, const std::vector<Values>& means) const;

  const SampleTable& table_;
  const FitSettings& settings_;
  std::vector<std::string> paints_;
  std::vector<Group> groups_;
  std::vector<Evidence> evidence_;
};

/// Throws unless each value is possible under the interface and each sample is complete.
void Fitter::check_samples() const {
  for (std::size_t s = 0; s < table_.samples.size(); ++s) {
    const Sample& sample = table_.samples[s];
    const std::string named = "sample \"" + sample.name + "\"";
    const auto right = [&](const auto& change) { return right_sample_line(sample, change); };
    if (sample.paints.empty()) {
      if (sample.name.empty())
        throw SampleError(s, -1, "a bare substrate needs a name" + right([](Sample& r) { r.name = "card"; }));
    } else if (sample.backing != "opaque") {
      if (!(sample.thickness > 0))
        throw SampleError(s, -1, named + " is not opaque and needs its thickness" + right([](Sample& r) {
                                   r.thickness = 24e-6;
                                 }));
      const auto number = backing_reflectance(sample);
      if (number && !(*number >= 0 && *number <= 1))
        throw SampleError(s, -1,
                          named + ": the backing's reflectance must be in [0, 1], got " + sample.backing +
                              right([](Sample& r) { r.backing = "0.04"; }));
      const bool known = std::any_of(table_.samples.begin(), table_.samples.end(), [&](const Sample& other) {
        return other.paints.empty() && other.name == sample.backing;
      });
      if (!number && !known && sample.backing != "none")
        throw SampleError(
            s, -1,
            named + ": there is no bare substrate \"" + sample.backing +
                "\" (backings are opaque, none, a reflectance, or the name of a sample without paints)" +
                right([&](Sample& r) {
                  const auto card = std::find_if(table_.samples.begin(), table_.samples.end(),
                                                 [](const Sample& other) { return other.paints.empty(); });
                  r.backing = card == table_.samples.end() ? "0.04" : card->name;
                }));
    }
    if (sample.quantity == Sample::Quantity::transmittance) {
      if (sample.backing != "none")

        throw SampleError(s, -1,
                          named + ": transmittance is that of a free film, backing none" +
                              right([](Sample& r) { r.backing = "none"; }));
      continue;
    }
    if (sample.backing == "none" && !sample.paints.empty())
      continue;  // a reflectance is checked together with its transmittance
    for (std::size_t i = 0; i < sample.values.size(); ++i) try {
        const double inner = inner_reflectance(settings_.surface, sample.values[i]);
        if (sample.backing == "opaque" && !sample.paints.empty()) k_over_s(inner);
      } catch (const std::domain_error& e) {
        // Limits under this interface, rounded inwards. A layer of which K/S is wanted reflects some light.
        constexpr double kDigits = 1e4;
        const double value = sample.values[i],
                     most = std::floor(kDigits * outer_reflectance(settings_.surface, 1)) / kDigits,
                     least = (std::floor(kDigits * settings_.surface.seen) + 1) / kDigits;
        throw SampleError(s, int(i),
                          named + " at " + number_text(table_.nm[i]) + " nm: " + e.what() +
                              "; expected from " + number_text(least) + " to " + number_text(most) +
                              (value > most ? right_reflectance_line(sample, table_.nm[i], value, most)
                                            : right_value_line(sample, table_.nm[i], false, least)));
      }
  }
}

void Fitter::collect_groups() {
  std::map<std::tuple<std::vector<std::pair<std::string, double>>, int, std::string, double>, std::size_t>
      known;
  for (std::size_t s = 0; s < table_.samples.size(); ++s) {
    const Sample& sample = table_.samples[s];
    if (sample.paints.empty()) continue;
    std::vector<std::pair<std::string, double>> recipe;
    for (const Component& c : sample.paints) {
      recipe.emplace_back(c.name, c.fraction);
      if (std::find(paints_.begin(), paints_.end(), c.name) == paints_.end()) paints_.push_back(c.name);
    }
    std::sort(recipe.begin(), recipe.end());
    const auto [at, is_new] =
        known.try_emplace({recipe, int(sample.quantity), sample.backing, sample.thickness}, groups_.size());
    if (is_new) groups_.emplace_back();
    groups_[at->second].members.push_back(s);
  }
}

Evidence Fitter::collect(const std::string& paint) const {
  Evidence e;
  e.paint = paint;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Sample& s = first(g);
    if (share_of(s, paint) == 0) continue;
    if (s.paints.size() == 1) {
      if (s.backing == "opaque")
        e.opaque = g;
      else if (s.backing != "none")
        e.drawdowns.push_back(g);
      else if (s.quantity == Sample::Quantity::transmittance)
        e.film_t = g;
    } else if (s.paints.size() == 2 && s.backing == "opaque" && share_of(s, settings_.white) > 0) {
      e.tints.push_back(g);
    }
  }
  for (std::size_t g = 0; e.film_t && g < groups_.size(); ++g) {
    const Sample& s = first(g);
    if (s.paints.size() == 1 && s.paints[0].name == paint && s.backing == "none" &&
        s.quantity == Sample::Quantity::reflectance && s.thickness == first(*e.film_t).thickness)
      e.film_r = g;
  }
  return e;
}

void Fitter::choose_method(Evidence& e) const {
  // difference of reflectance below which two substrates do not determine K and S
  constexpr double kAlike = 0.05;
  std::string alike;
  const std::string named = "paint \"" + e.paint + "\": ";
  if (e.film_r && e.film_t) {
    e.method = FitMethod::film, e.used = {*e.film_r, *e.film_t};
    return;
  }
  for (std::size_t a = 0; a < e.drawdowns.size(); ++a)
    for (std::size_t b = a + 1; b < e.drawdowns.size(); ++b)
      if (first(e.drawdowns[a]).thickness == first(e.drawdowns[b]).thickness) {
        const auto lightness = [&](std::size_t group) {
          return substrate_at(table_, settings_.surface, first(group), table_.nm.size() / 2);
        };
        const double one = lightness(e.drawdowns[a]), other = lightness(e.drawdowns[b]);
        if (std::abs(one - other) < kAlike) {
          alike = "its substrates \"" + first(e.drawdowns[a]).backing + "\" and \"" +
                  first(e.drawdowns[b]).backing + "\" reflect nearly the same (" + number_text(one) +
                  " and " + number_text(other) + " at " + number_text(table_.nm[table_.nm.size() / 2]) +
                  " nm): two that differ are needed, such as black and white";
          continue;
        }
        e.method = FitMethod::drawdowns, e.used = {e.drawdowns[a], e.drawdowns[b]};
        if (lightness(e.used[0]) > lightness(e.used[1])) std::swap(e.used[0], e.used[1]);
        return;
      }
  if (e.opaque && !e.drawdowns.empty()) {
    e.method = FitMethod::opaque_and_drawdown, e.used = {*e.opaque, e.drawdowns[0]};
    return;
  }
  if (!e.opaque && !alike.empty()) throw std::domain_error(named + alike);
  if (!e.opaque)
    throw std::domain_error(named +
                            (e.film_t ? "the film's reflectance at the same thickness is missing"
                             : e.drawdowns.empty()
                                 ? "its opaque masstone is missing (a layer of this paint alone)"
                                 : "a drawdown over a second substrate, of the same thickness, or its opaque "
                                   "masstone is missing"));
  if (e.paint == settings_.white) {
    e.method = FitMethod::masstone, e.used = {*e.opaque};
    return;
  }
  if (e.tints.empty())
    throw std::domain_error(
        named + "an opaque tint with \"" + settings_.white +
        "\" is missing, or a drawdown of known thickness: the masstone alone gives K/S, not K and S");
  e.method = FitMethod::tints, e.used = e.tints;
  e.used.push_back(*e.opaque);
}

void Fitter::check_units() const {
  std::string relative, absolute;
  for (const Evidence& e : evidence_) {
    if (e.method == FitMethod::tints)
      white();
    else
      (e.method == FitMethod::masstone ? relative : absolute) = e.paint;
  }
  if (!relative.empty() && !absolute.empty())
    throw std::domain_error("paint \"" + absolute + "\" was measured with a thickness, \"" + relative +
                            "\" was not: a drawdown of \"" + relative + "\" with its thickness is missing");
}

const Evidence& Fitter::white() const {
  for (const Evidence& e : evidence_)
    if (e.paint == settings_.white) return e;
  throw std::domain_error("the white \"" + settings_.white + "\" is missing among the samples");
}

Coefficients Fitter::absolute(const Evidence& e, const std::vector<Values>& means, std::size_t i) const {
  const double thickness = first(e.used.back()).thickness;
  try {
    switch (e.method) {
      case FitMethod::film:
        return coefficients_of_transfer(
            inner_transfer(settings_.surface, {means[e.used[0]][i], means[e.used[1]][i]}), thickness);
      case FitMethod::drawdowns:
        return coefficients_of_drawdowns(drawdown(means, e.used[0], i), drawdown(means, e.used[1], i),
                                         thickness);
      case FitMethod::opaque_and_drawdown:
        return coefficients_of_opaque(inner(means, e.used[0], i), drawdown(means, e.used[1], i), thickness);
      default:
        throw std::logic_error("no absolute method");
    }
  } catch (const std::domain_error& error) {
    const bool over_two = e.method == FitMethod::drawdowns;
    const bool is_darker = over_two && means[e.used[1]][i] < means[e.used[0]][i];
    throw SampleError(
        groups_[e.used.front()].members.front(), int(i),
        "paint \"" + e.paint + "\" at " + number_text(table_.nm[i]) + " nm: " + error.what() +
            (is_darker
                 ? "; the film is darker over the brighter card: are the cards swapped? If not, a fit of all "
                   "measurements (--joint) takes this for noise"
             : over_two ? "; a fit of all measurements (--joint) takes what no film can be for noise"
                        : ""));
  }
}

double Fitter::scattering_of_tints(const Evidence& e, const std::vector<Values>& means, Coefficients white,
                                   double masstone, std::size_t i) const {
  if (e.tints.size() == 1)
    return scattering_of_tint(masstone, {share_of(first(e.tints[0]), e.paint), ratio(means, e.tints[0], i)},
                              white);
  // Each tint is a linear equation for S. Its weight follows from the error of reflectance, d(K/S)/dR =
  // -(1/R^2 - 1)/2, and depends on S.
  double s = white.s;
  for (int step = 0; step < 8; ++step) {
    double left = 0, right = 0;
    for (const std::size_t tint : e.tints) {
      const double share = share_of(first(tint), e.paint), r = inner(means, tint, i), theta = k_over_s(r);
      const double scale = 1 / ((share * std::abs(s) + (1 - share) * white.s) * (1 / (r * r) - 1));
      const double a = share * (masstone - theta) * scale;
      left += a * a, right += a * (1 - share) * (theta * white.s - white.k) * scale;
    }
    const double next = right / left;
    if (!std::isfinite(next) || std::abs(next - s) < 1e-12 * std::abs(s)) return next;
    s = next;
  }
  return s;
}

Fit Fitter::solve(const std::vector<Values>& means) const {
  const std::size_t n = table_.nm.size();
  Fit fit;
  fit.palette.nm = table_.nm;
  fit.palette.surface = settings_.surface;
  fit.palette.relative = false;
  const auto new_pigment = [&](const Evidence& e) {
    return Pigment{.name = e.paint, .k = Values(n), .s = Values(n)};
  };
  const auto direct = [&](const Evidence& e) {
    Pigment p = new_pigment(e);
    for (std::size_t i = 0; i < n; ++i) {
      const Coefficients c = e.method == FitMethod::masstone ? Coefficients{ratio(means, e.used[0], i), 1}
                                                             : absolute(e, means, i);
      p.k[i] = c.k, p.s[i] = c.s;
    }
    return p;
  };
  std::optional<Pigment> tinting;  // the white paint with which tints are made
  for (const Evidence& e : evidence_) {
    FitReport report{.method = e.method};
    for (const std::size_t g : e.used)
      ++report.samples, report.measurements += int(groups_[g].members.size());
    if (e.method == FitMethod::masstone) fit.palette.relative = true;
    if (e.method != FitMethod::tints) {
      fit.palette.pigments.push_back(direct(e));
    } else {
      if (!tinting) tinting = direct(white());
      Pigment& p = fit.palette.pigments.emplace_back(new_pigment(e));
      for (std::size_t i = 0; i < n; ++i) {
        const double masstone = ratio(means, *e.opaque, i);
        p.s[i] = scattering_of_tints(e, means, {tinting->k[i], tinting->s[i]}, masstone, i);
        if (!std::isfinite(p.s[i])) p.s[i] = tinting->s[i], ++report.undefined;
        p.k[i] = masstone * p.s[i];
      }
    }
    fit.reports.push_back(report);
  }
  for (std::size_t p = 0; p < evidence_.size(); ++p) {
    const Pigment& pigment = fit.palette.pigments[p];
    FitReport& report = fit.reports[p];
    for (std::size_t i = 0; i < n; ++i) {
      report.negative_k += pigment.k[i] < 0, report.negative_s += pigment.s[i] < 0;
      if (!(pigment.k[i] < 0 || pigment.s[i] < 0)) continue;
      if (report.negative_from_nm == 0) report.negative_from_nm = table_.nm[i];
      report.negative_to_nm = table_.nm[i];
    }
    if (evidence_[p].method == FitMethod::tints && evidence_[p].tints.size() > 1)
      report.residual = residual(evidence_[p], fit.palette, means);
  }
  return fit;
}

double Fitter::residual(const Evidence& e, const Palette& palette, const std::vector<Values>& means) const {
  double sum = 0;
  for (const std::size_t tint : e.tints) {
    const Values predicted = predict(palette, table_, first(tint));
    for (std::size_t i = 0; i < predicted.size(); ++i) sum += std::pow(predicted[i] - means[tint][i], 2);
  }
  return std::sqrt(sum / double(e.tints.size() * table_.nm.size()));
}

void Fitter::add_errors(Fit& fit) const {
  const std::size_t n = table_.nm.size();
  std::vector<Values> variance_k(evidence_.size(), Values(n)), variance_s = variance_k;
  for (const Group& g : groups_) {
    const double count = double(g.members.size());
    if (count < 2) continue;
    std::vector<Palette> without;
    for (const std::size_t s : g.members) without.push_back(solve(means(s)).palette);
    const auto add = [&](std::size_t p, std::size_t i, Values Pigment::*of, double& variance) {
      double mean = 0, squares = 0;
      for (const Palette& w : without) mean += (w.pigments[p].*of)[i] / count;
      for (const Palette& w : without) squares += std::pow((w.pigments[p].*of)[i] - mean, 2);
      variance += (count - 1) / count * squares;
    };
    for (std::size_t p = 0; p < evidence_.size(); ++p)
      for (std::size_t i = 0; i < n; ++i) {
        add(p, i, &Pigment::k, variance_k[p][i]);
        add(p, i, &Pigment::s, variance_s[p][i]);
      }
  }
  for (std::size_t p = 0; p < evidence_.size(); ++p) {
    std::vector<std::size_t> used = evidence_[p].used;
    if (evidence_[p].method == FitMethod::tints)
      used.insert(used.end(), white().used.begin(), white().used.end());
    if (std::any_of(used.begin(), used.end(), [&](std::size_t g) { return groups_[g].members.size() < 2; }))
      continue;
    for (auto* v : {&variance_k[p], &variance_s[p]})
      for (double& x : *v) x = std::sqrt(x);
    fit.palette.pigments[p].k_error = variance_k[p];
    fit.palette.pigments[p].s_error = variance_s[p];
  }
}

}  // namespace

std::string_view name_of(FitMethod method) {
  switch (method) {
    case FitMethod::film:
      return "free film";
    case FitMethod::drawdowns:
      return "two drawdowns";
    case FitMethod::opaque_and_drawdown:
      return "opaque and drawdown";
    case FitMethod::masstone:
      return "masstone, S = 1";
    case FitMethod::tints:
      return "masstone and tints";
  }
  throw std::logic_error("no such method");
}

Fit fit(const SampleTable& table, const FitSettings& settings) {
  const Fitter fitter(table, settings);
  Fit result = fitter.solve(fitter.means());
  fitter.add_errors(result);
  return result;
}

std::vector<LeftOut> leave_one_repeat_out(const SampleTable& table, const FitSettings& settings) {
  const Fitter fitter(table, settings);
  std::vector<LeftOut> all;
  for (const Group& g : fitter.groups()) {
    if (g.members.size() < 2) continue;
    for (const std::size_t s : g.members) {
      LeftOut& one = all.emplace_back();
      one.sample = s;
      one.predicted = predict(fitter.solve(fitter.means(s)).palette, table, table.samples[s]);
      for (std::size_t i = 0; i < one.predicted.size(); ++i)
        one.rms += std::pow(one.predicted[i] - table.samples[s].values[i], 2) / double(one.predicted.size());
      one.rms = std::sqrt(one.rms);
    }
  }
  return all;
}

}  // namespace aureole::pigment
