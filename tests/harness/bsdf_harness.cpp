// SPDX-License-Identifier: Apache-2.0
#include "harness/bsdf_harness.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"
#include "harness/statistics.h"

namespace aureole::testing {

namespace {

constexpr int kIncidences = 6;
constexpr int kHeroes = 2;        // for the tests that need many samples
constexpr int kTestsPerRun = 10;  // chi-square, energy, and up to eight delta lobes
constexpr float kUnitEdges[] = {0.f, 0.5f, kOneMinusEpsilon};

struct Entry {
  std::string plugin;
  std::function<void(BsdfCase&)> adapt;
  std::vector<BsdfCase> extra;
};
std::vector<Entry>& entries() {
  static std::vector<Entry> all;
  return all;
}

HarnessFigures figures;

/// A delta lobe as found by sampling.
struct DeltaLobe {
  Lobe lobe;
  Vec3 wo;
  Spectrum value, mass;
  std::size_t count = 0;
};

class Check {
public:
  Check(const BsdfCase& c, const HarnessOptions& options)
      : case_(c),
        options_(options),
        bsdf_(c.bsdf ? c.bsdf : build<Bsdf>(c.xml, make_context(c.min_nm, c.max_nm), test::example_file)) {
    level_ = sidak_level(options.family_significance,
                         options.family_size * std::size_t(kIncidences * kHeroes * kTestsPerRun));
    grid_ = SpectralGrid::over(c.min_nm, c.max_nm);
    // A point of a square, whose shading frame is that of the world.
    point_.uv = {0.31f, 0.64f};
    point_.p = {2 * point_.uv.x - 1, 2 * point_.uv.y - 1, 0};
    point_.ng = {0, 0, 1};
    point_.shape = shape_.get();
    for (int j = 0; j < kWavelengths; ++j) rotated_.push_back(wavelengths(j));
  }

  std::vector<std::string> run() {
    for (const float degrees : {20.f, 60.f, 85.f})
      for (const bool below : {false, true}) {
        const float theta = degrees * kPi / 180, phi = 0.4f + 0.05f * degrees;
        const Vec3 wi{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                      below ? -std::cos(theta) : std::cos(theta)};
        const std::size_t before = failures_.size();
        for (const int hero : {0, kWavelengths - 3}) check_samples(wi, hero, below);
        if (failures_.size() == before) check_heroes(wi);
        check_modes_of_deltas(wi);
      }
    check_pairs();
    check_edges();
    if (!case_.gains_energy.empty() && !(figures.largest_energy > 1 + case_.tolerance))
      fail("is said to gain energy (", case_.gains_energy, "), but reflects ", figures.largest_energy,
           " at most");
    return failures_;
  }

private:
  template <class... Parts>
  void fail(const Parts&... parts) {
    std::ostringstream text;
    text.precision(8);
    text << case_.name << ": ";
    (text << ... << parts);
    // A broken BSDF fails everywhere; the first few sentences say it.
    if (failures_.size() < 20) failures_.push_back(text.str());
  }
  static std::string str(const Vec3& v) {
    std::ostringstream text;
    text << "(" << v.x << ", " << v.y << ", " << v.z << ")";
    return text.str();
  }

  /// Wavelengths spread over the range as a path has them, with index `hero` rotated to the front.
  Wavelengths wavelengths(int hero) const {
    const double width = grid_.max_nm - grid_.min_nm;
    return Wavelengths::at(
        grid_, make_spectrum([&](int i) {
          return float(grid_.min_nm + width * (((i + hero) % kWavelengths) + 0.37) / kWavelengths);
        }));
  }
  BsdfContext context(int hero) const { return context(hero, case_.mode); }
  BsdfContext context(int hero, TransportMode mode) const { return {rotated_[hero], point_, mode, 0}; }
  float index(const Vec3& w, float nm) const {
    const auto& n = w.z > 0 ? case_.n_above : case_.n_below;
    return n ? n(nm) : 1;
  }
  void p_value(double p) {
    figures.smallest_p = std::min(figures.smallest_p, p);
    ++figures.statistical_tests;
  }
  /// Blends may have several delta lobes in one direction, of which each is drawn and reported alone.
  static bool same_delta(const DeltaLobe& a, const BsdfSample& s) {
    return a.lobe == s.lobe && length(a.wo - s.wo) < 1e-6f && close(a.mass[0], s.pdf[0], 1e-5, 0) &&
           close(a.value[0], s.value[0], 1e-5, 0);
  }
  static void gather(std::vector<DeltaLobe>& lobes, const BsdfSample& s) {
    for (DeltaLobe& l : lobes)
      if (same_delta(l, s)) {
        ++l.count;
        return;
      }
    lobes.push_back({s.lobe, s.wo, s.value, s.pdf, 1});
  }
  static bool close(double a, double b, double relative, double absolute) {
    return std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)) + absolute;
  }
  static bool is_density(const Spectrum& s) { return is_valid_radiance(s); }

  /// All delta lobes of wi: many stratified choices, the ends among them, which find lobes of any small mass.
  std::vector<DeltaLobe> delta_lobes(const Vec3& wi, const BsdfContext& ctx) const {
    std::vector<DeltaLobe> lobes;
    if (!has(bsdf_->lobes(), Lobe::delta)) return lobes;
    TestRandom random(options_.seed + 77);
    for (int k = -1; k <= 512; ++k) {
      const float u1 = std::clamp((float(k) + 0.5f) / 512, 0.f, kOneMinusEpsilon);
      if (const auto s = bsdf_->sample(wi, u1, random.next2(), ctx); s && s->is_delta()) gather(lobes, *s);
    }
    return lobes;
  }

  bool check_one_sample(const Vec3& wi, const BsdfSample& s, const BsdfContext& ctx) {
    const std::size_t before = failures_.size();
    if (!(std::abs(length(s.wo) - 1) < 1e-4f))
      fail("wo is not a unit vector: ", str(s.wo), " for wi = ", str(wi));
    if (!is_density(s.value)) fail("invalid value ", s.value[0], " for wi = ", str(wi), ", wo = ", str(s.wo));
    if (!is_density(s.pdf) || !(s.pdf[0] > 0))
      fail("invalid density ", s.pdf[0], " for wi = ", str(wi), ", wo = ", str(s.wo));
    if ((s.lobe & bsdf_->lobes()) != s.lobe) fail("a sample's lobe is not among lobes()");
    const bool up = s.wo.z > 0, through = up != (wi.z > 0);
    if (s.wo.z != 0 && wi.z != 0 && has(s.lobe, through ? Lobe::reflect : Lobe::transmit))
      fail("a sample's lobe and its side disagree for wi = ", str(wi), ", wo = ", str(s.wo));
    if (s.is_delta()) {
      if (max_component(s.pdf) > 1 + 1e-5f) fail("a probability of ", max_component(s.pdf));
    } else {
      const BsdfEval e = bsdf_->eval_pdf(wi, s.wo, ctx);
      for (int j = 0; j < kWavelengths; ++j) {
        if (!close(e.pdf[j], s.pdf[j], 1e-3, 1e-6))
          fail("sample's density ", s.pdf[j], " is not eval_pdf's ", e.pdf[j], " for wi = ", str(wi),
               ", wo = ", str(s.wo));
        if (!close(e.value[j], s.value[j], 1e-3, 1e-6))
          fail("sample's value ", s.value[j], " is not eval_pdf's ", e.value[j], " for wi = ", str(wi),
               ", wo = ", str(s.wo));
      }
    }
    return failures_.size() == before;
  }

  /// Chi-square, masses, energies.
  void check_samples(const Vec3& wi, int hero, bool below) {
    const BsdfContext ctx = context(hero);
    const std::string where = "wi = " + str(wi) + ", hero " + std::to_string(hero);
    TestRandom random(options_.seed * 1000003 + std::uint64_t(hero) + std::uint64_t(1000 * (wi.z + 2)));

    SphereBins::Options bin_options;
    bin_options.pilot.reserve(case_.samples / 8);
    for (std::size_t i = 0; i < case_.samples / 8; ++i) {
      const float u1 = random.next();
      const auto s = bsdf_->sample(wi, u1, random.next2(), ctx);
      if (!s) continue;
      if (!check_one_sample(wi, *s, ctx)) return;
      if (!s->is_delta()) bin_options.pilot.push_back(s->wo);
    }
    if (case_.focus) bin_options.focus = case_.focus(wi);
    bin_options.focus_angle = case_.focus_angle;
    const SphereBins bins(
        [&](const Vec3& wo) {
          const BsdfEval e = bsdf_->eval_pdf(wi, wo, ctx);
          return SphereBins::Value{e.pdf[0], e.value};
        },
        bin_options);

    std::vector<std::size_t> counts(bins.bins().size());
    std::vector<DeltaLobe> deltas;
    std::size_t smooth = 0, none = 0;
    double weight = 0, weight2 = 0;
    for (std::size_t i = 0; i < case_.samples; ++i) {
      const float u1 = random.next();
      const auto s = bsdf_->sample(wi, u1, random.next2(), ctx);
      if (!s) {
        ++none;
        continue;
      }
      const double w = double(s->value[0]) / double(s->pdf[0]);
      weight += w, weight2 += w * w;
      if (s->is_delta())
        gather(deltas, *s);
      else
        ++smooth, ++counts[bins.find(s->wo)];
    }
    for (const DeltaLobe& l : delta_lobes(wi, ctx))
      if (std::none_of(deltas.begin(), deltas.end(), [&](const DeltaLobe& d) {
            return same_delta(d, {l.wo, l.value, l.mass, l.lobe});
          })) {
        deltas.push_back(l);
        deltas.back().count = 0;
      }

    const double n = double(case_.samples);
    if (below && case_.black_below) {
      if (none != case_.samples || bins.mass() > 0) fail("it is not black from below, ", where);
      return;
    }
    if (none == case_.samples && case_.may_fail) return;

    // Masses.
    double mass = bins.mass();
    for (const DeltaLobe& d : deltas) {
      mass += d.mass[0];
      const double p = binomial_p_value(d.count, case_.samples, std::min(double(d.mass[0]), 1.0));
      p_value(p);
      if (p < level_)
        fail("a delta lobe of mass ", d.mass[0], " was sampled ", d.count, " times of ", case_.samples,
             " (p = ", p, "), ", where);
    }
    const double expected_mass = case_.may_fail ? 1 - double(none) / n : 1;
    const double slack = case_.may_fail ? 5 * std::sqrt(double(none) + 1) / n : 0;
    if (!case_.may_fail && none) fail("`sample` returned nothing ", none, " times, ", where);
    if (std::abs(mass - expected_mass) > case_.tolerance + slack)
      fail("densities and masses add up to ", mass, " instead of ", expected_mass, ", ", where);
    figures.largest_mass_error = std::max(figures.largest_mass_error, std::abs(mass - expected_mass));

    // Shape.
    if (smooth || bins.mass() > 1e-6) {
      const ChiSquareResult r = chi_square_test(bins, counts, case_.samples, std::max(5.0, n / 2000));
      p_value(r.p_value);
      if (r.p_value < level_) {
        const auto file =
            options_.dump_folder / (case_.name + "_" + std::to_string(int(std::lround(1000 * wi.z))) + "_" +
                                    std::to_string(hero) + ".csv");
        dump_histogram(file, bins, counts, case_.samples);
        fail("chi-square ", r.statistic, " in ", r.bins, " bins, p = ", r.p_value, ", ", where,
             "; histogram in ", file.string());
      }
    }

    // Energy: of all wavelengths, each as hero for the delta lobes.
    const auto smooth_energy = bins.other();
    for (int j = 0; j < kWavelengths; ++j) {
      double energy = smooth_energy[j];
      for (const DeltaLobe& d : delta_lobes(wi, context((hero + j) % kWavelengths))) energy += d.value[0];
      figures.largest_energy = std::max(figures.largest_energy, energy);
      figures.smallest_energy = std::min(figures.smallest_energy, energy);
      const double bound = case_.gains_energy.empty() ? 1 : case_.largest_energy;
      const bool conserves = case_.not_reciprocal.empty() || case_.mode == TransportMode::radiance;
      if (conserves && energy > bound + case_.tolerance)
        fail("gains energy: ", energy, " at wavelength ", j, ", ", where);
      if (case_.lossless && energy < 1 - case_.tolerance)
        fail("loses energy: ", energy, " at wavelength ", j, ", ", where);
      if (j == 0) {
        const double mean_weight = weight / n;
        const double variance = std::max(weight2 / n - mean_weight * mean_weight, 0.0) / n;
        const double error = std::abs(mean_weight - energy);
        // Quadrature and single precision have errors, too.
        const double p = normal_p_value(std::max(error - 1e-4, 0.0) / std::sqrt(variance + 1e-12));
        p_value(p);
        if (p < level_)
          fail("samples carry the energy ", mean_weight, ", eval has ", energy, " (p = ", p, "), ", where);
      }
    }
  }

  /// Values and densities belong to wavelengths, not to their place among the N: rotating which of them is
  /// the hero rotates them.
  void check_heroes(const Vec3& wi) {
    TestRandom random(options_.seed + 5);
    for (int k = 0; k < 100; ++k) {
      Vec3 wo = square_to_uniform_sphere(random.next2());
      if (k % 2)
        if (const auto s = bsdf_->sample(wi, random.next(), random.next2(), context(0)); s && !s->is_delta())
          wo = s->wo;
      const BsdfEval e = bsdf_->eval_pdf(wi, wo, context(0));
      for (int j = 1; j < kWavelengths; ++j) {
        const BsdfEval r = bsdf_->eval_pdf(wi, wo, context(j));
        for (int i = 0; i < kWavelengths; ++i) {
          const int original = (i + j) % kWavelengths;
          if (!close(r.pdf[i], e.pdf[original], 1e-3, 1e-7))
            return fail("density of wavelength ", original, " is ", e.pdf[original], ", but ", r.pdf[i],
                        " with hero ", j, " for wi = ", str(wi), ", wo = ", str(wo));
          if (!close(r.value[i], e.value[original], 1e-3, 1e-7))
            return fail("value of wavelength ", original, " is ", e.value[original], ", but ", r.value[i],
                        " with hero ", j, " for wi = ", str(wi), ", wo = ", str(wo));
        }
      }
    }
    // Delta lobes: the mass given for wavelength j is the probability with which j, as hero, would go there.
    const std::vector<DeltaLobe> first = delta_lobes(wi, context(0));
    for (int j = 1; j < kWavelengths; ++j) {
      const std::vector<DeltaLobe> other = delta_lobes(wi, context(j));
      for (const DeltaLobe& l : first) {
        const auto here = [&](const DeltaLobe& d) { return d.lobe == l.lobe && length(d.wo - l.wo) < 1e-7f; };
        double mass = 0, value = 0, expected_mass = 0, expected_value = 0;
        for (const DeltaLobe& d : first)
          if (here(d)) expected_mass += d.mass[j], expected_value += d.value[j];
        for (const DeltaLobe& o : other)
          if (here(o)) mass += o.mass[0], value += o.value[0];
        if (!close(mass, expected_mass, 1e-3, 1e-6) || !close(value, expected_value, 1e-3, 1e-6))
          return fail("wavelength ", j, " has mass ", expected_mass, " and value ", expected_value,
                      " in the hero's delta lobe towards ", str(l.wo), ", but as hero ", mass, " and ",
                      value);
      }
    }
  }

  /// Radiance over n^2 is what a delta lobe carries, in either direction.
  void check_modes_of_deltas(const Vec3& wi) {
    if (!case_.not_reciprocal.empty()) return;
    const std::vector<DeltaLobe> importance = delta_lobes(wi, context(0, TransportMode::importance));
    const std::vector<DeltaLobe> radiance = delta_lobes(wi, context(0, TransportMode::radiance));
    if (importance.size() != radiance.size())
      return fail("the modes have different delta lobes for wi = ", str(wi));
    for (std::size_t k = 0; k < importance.size(); ++k) {
      const float nm = rotated_[0].nm[0];
      // What passes as if nothing were there does not enter another medium.
      const bool null = has(importance[k].lobe, Lobe::null);
      const double ratio = null ? 1 : index(wi, nm) / index(importance[k].wo, nm);
      if (!close(radiance[k].value[0], importance[k].value[0] * ratio * ratio, 1e-3, 1e-6))
        return fail("a delta lobe carries ", radiance[k].value[0], " in radiance mode and ",
                    importance[k].value[0], " in importance mode, for wi = ", str(wi));
    }
  }

  /// Reciprocity, and the relation between the modes: importance mode is radiance mode with the roles of wi
  /// and wo exchanged.
  void check_pairs() {
    if (!bsdf_->is_smooth()) return;
    TestRandom random(options_.seed + 9);
    for (int k = 0; k < 4000; ++k) {
      const Vec3 wi = square_to_uniform_sphere(random.next2());
      Vec3 wo = square_to_uniform_sphere(random.next2());
      if (k % 2)
        if (const auto s = bsdf_->sample(wi, random.next(), random.next2(), context(0)); s && !s->is_delta())
          wo = s->wo;
      if (std::abs(wi.z) < 1e-3f || std::abs(wo.z) < 1e-3f) continue;
      const Spectrum to_wi = bsdf_->eval(wi, wo, context(0, TransportMode::radiance)) * (1 / std::abs(wo.z));
      const Spectrum to_wo = bsdf_->eval(wo, wi, context(0, TransportMode::radiance)) * (1 / std::abs(wi.z));
      const Spectrum adjoint =
          bsdf_->eval(wi, wo, context(0, TransportMode::importance)) * (1 / std::abs(wo.z));
      for (int j = 0; j < kWavelengths; ++j) {
        if (!close(adjoint[j], to_wo[j], 2e-3, 1e-6))
          return fail("importance mode gives ", adjoint[j], " for wi -> wo, radiance mode ", to_wo[j],
                      " for the same light; wi = ", str(wi), ", wo = ", str(wo));
        const float nm = rotated_[0].nm[j];
        const double ni = index(wi, nm), no = index(wo, nm);
        if (case_.not_reciprocal.empty() && !close(to_wi[j] / (ni * ni), to_wo[j] / (no * no), 2e-3, 1e-6))
          return fail("not reciprocal: ", to_wi[j] / (ni * ni), " against ", to_wo[j] / (no * no),
                      "; wi = ", str(wi), ", wo = ", str(wo));
      }
    }
  }

  /// Grazing directions and the ends of the random numbers: finite, and no sample without a direction.
  void check_edges() {
    std::vector<Vec3> directions;
    for (const float z : {1.f, 0.5f, 1e-3f, 1e-7f, 1e-20f, 0.f})
      for (const float sign : {1.f, -1.f})
        for (const float phi : {0.f, 1.1f}) {
          const float r = std::sqrt((1 - z) * (1 + z));
          directions.push_back({r * std::cos(phi), r * std::sin(phi), sign * z});
        }
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
      for (const Vec3& wi : directions) {
        for (const Vec3& wo : directions) {
          const BsdfEval e = bsdf_->eval_pdf(wi, wo, context(0, mode));
          if (!is_density(e.value) || !is_density(e.pdf))
            return fail("eval_pdf gives the value ", e.value[0], " and the density ", e.pdf[0],
                        " for wi = ", str(wi), ", wo = ", str(wo));
        }
        for (const float u1 : kUnitEdges)
          for (const float ux : kUnitEdges)
            for (const float uy : kUnitEdges)
              if (const auto s = bsdf_->sample(wi, u1, {ux, uy}, context(0, mode)))
                if (!check_one_sample(wi, *s, context(0, mode)))
                  return fail("... with u = ", u1, ", ", ux, ", ", uy);
      }
  }

  const BsdfCase& case_;
  const HarnessOptions& options_;
  std::shared_ptr<const Bsdf> bsdf_;
  SpectralGrid grid_;
  std::shared_ptr<const Shape> shape_ = build<Shape>(R"(<shape type="rectangle"/>)");
  SurfacePoint point_;
  std::vector<Wavelengths> rotated_;
  double level_ = 0;
  std::vector<std::string> failures_;
};

}  // namespace

std::vector<std::string> check_bsdf(const BsdfCase& c, const HarnessOptions& options) {
  figures = {};
  return Check(c, options).run();
}

const HarnessFigures& last_figures() { return figures; }

BsdfCases::BsdfCases(std::string plugin, std::function<void(BsdfCase&)> adapt, std::vector<BsdfCase> extra) {
  entries().push_back({std::move(plugin), std::move(adapt), std::move(extra)});
}

std::vector<BsdfCase> all_bsdf_cases() {
  std::vector<BsdfCase> cases;
  for (const std::string& plugin : Registry::instance().names("bsdf")) {
    const auto& examples = Registry::instance().find("bsdf", plugin)->doc.examples;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      BsdfCase c;
      c.name = plugin + "_example_" + std::to_string(i + 1);
      c.xml = examples[i];
      for (const Entry& e : entries())
        if (e.plugin == plugin && e.adapt) e.adapt(c);
      cases.push_back(std::move(c));
    }
    for (const Entry& e : entries())
      if (e.plugin == plugin) cases.insert(cases.end(), e.extra.begin(), e.extra.end());
  }
  return cases;
}

}  // namespace aureole::testing
