// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/experiment.h"

#include <algorithm>

#include "aureole/instrument/check/rules.h"

namespace aureole::check {

namespace {

/// More delta lobes than any valid function has: the function marks a continuum of directions as delta.
constexpr std::size_t kTooManyDeltas = 1000;

/// Draws pilot samples and stores their directions in the options of the bins. Returns false if samples are
/// invalid.
bool draw_pilot(CheckRun& run, const Vec3& wi, int hero, SeededRandom& random,
                DirectionBins::Options& bin_options) {
  bin_options.pilot.reserve(run.options().samples / 8);
  SampleFault fault;
  double worst = 0;
  run.draw(wi, run.query(hero), run.options().samples / 8, random, [&](std::span<const MaybeSample> samples) {
    fault = judge_samples(run, wi, samples, run.query(hero), worst);
    for (const MaybeSample& s : samples)
      if (s && !s->is_delta()) bin_options.pilot.push_back(s->wo);
    return fault.message.empty();
  });
  CheckFinding finding{fault.rule, wi, run.nm(hero), worst};
  finding.limit = 1e-3;
  if (!fault.message.empty()) {
    run.fail(finding, fault.message);
    return false;
  }
  run.add(std::move(finding));
  return true;
}

/// Adds the delta lobes that random samples did not find.
void add_missed_deltas(CheckRun& run, Experiment& e) {
  for (const DeltaLobe& l : run.delta_lobes(e.wi, run.query(e.hero)))
    if (std::none_of(e.deltas.begin(), e.deltas.end(), [&](const DeltaLobe& d) {
          return is_same(d, {l.wo, l.value, l.mass, l.lobe});
        })) {
      e.deltas.push_back(l);
      e.deltas.back().count = 0;
    }
}

}  // namespace

std::optional<DirectionBins> make_bins(CheckRun& run, const Vec3& wi, int hero, SeededRandom& random) {
  const CheckOptions& options = run.options();
  DirectionBins::Options bin_options;
  if (!draw_pilot(run, wi, hero, random, bin_options)) return {};
  if (options.focus) bin_options.focus = options.focus(wi);
  bin_options.focus_angle = options.focus_angle;
  bin_options.tolerance = options.bin_tolerance;
  bin_options.most_bins = options.most_bins;

  CheckFinding finite{CheckRule::finite, wi, run.nm(hero)};
  std::vector<BsdfEval> evals;
  DirectionBins bins(
      [&](std::span<const Vec3> wo, std::span<DirectionBins::Value> values) {
        run.eval_pdf(std::vector<Vec3>(wo.size(), wi), wo, run.query(hero), evals);
        for (std::size_t i = 0; i < wo.size(); ++i) {
          const BsdfEval& e = evals[i];
          if (is_valid_radiance(e.value) && is_valid_radiance(e.pdf)) {
            values[i] = {e.pdf[0], e.value};
            continue;
          }
          // The invalid value is replaced by zero, so that it does not hide all other findings.
          if (finite.figure++ == 0) finite.message = invalid_eval(e, wi, wo[i]);
        }
      },
      bin_options);
  finite.passed = finite.figure == 0;
  run.add(std::move(finite));
  return bins;
}

std::optional<Experiment> make_experiment(CheckRun& run, const Vec3& wi, int hero) {
  const CheckOptions& options = run.options();
  const double nm = run.nm(hero);
  const std::string where = sentence("wi = ", to_text(wi), ", hero ", nm, " nm");
  SeededRandom random(options.seed * 1000003 + std::uint64_t(hero) + std::uint64_t(1000 * (wi.z + 2)));
  std::optional<DirectionBins> bins = make_bins(run, wi, hero, random);
  if (!bins) return {};

  Experiment e{wi, hero, nm, where, std::move(*bins), {}, {}};
  e.counts.resize(e.bins.bins().size());
  run.draw(wi, run.query(hero), options.samples, random, [&](std::span<const MaybeSample> samples) {
    for (const MaybeSample& s : samples) {
      if (!s) {
        ++e.none;
        continue;
      }
      const double w = double(s->value[0]) / double(s->pdf[0]);
      e.weight += w, e.weight2 += w * w;
      if (s->is_delta())
        gather(e.deltas, *s);
      else
        ++e.smooth, ++e.counts[e.bins.find(s->wo)];
    }
    return e.deltas.size() < kTooManyDeltas;
  });
  if (e.deltas.size() >= kTooManyDeltas) {
    run.fail({CheckRule::delta_lobes, wi, nm},
             "samples call themselves delta but go in ever new directions, ", where);
    return {};
  }
  add_missed_deltas(run, e);
  return e;
}

}  // namespace aureole::check
