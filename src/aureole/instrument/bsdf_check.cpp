// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/bsdf_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "aureole/instrument/sphere_bins.h"
#include "aureole/instrument/statistics.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"

namespace aureole {

namespace {

constexpr float kAngles[] = {20.f, 60.f, 85.f};  // each from above and from below
constexpr int kIncidences = 6;
constexpr int kHeroes = 2;                // for the tests that need many samples
constexpr int kTestsPerRun = 10;          // chi-square, energy, and up to eight delta lobes
constexpr std::size_t kAtOnce = 1 << 14;  // calls between two looks at `progress`
constexpr float kUnitEdges[] = {0.f, 0.5f, kOneMinusEpsilon};

using MaybeSample = std::optional<BsdfSample>;

/// A delta lobe as found by sampling.
struct DeltaLobe {
  Lobe lobe;
  Vec3 wo;
  Spectrum value, mass;
  std::size_t count = 0;
};

bool is_density(const Spectrum& s) { return is_valid_radiance(s); }
/// The first value that is none.
float invalid_in(const Spectrum& s) {
  for (int j = 0; j < kWavelengths; ++j)
    if (!(s[j] >= 0 && std::isfinite(s[j]))) return s[j];
  return s[0];
}

/// How far a and b are apart, relative to the larger one and beyond an absolute slack; NaN if one is.
double deviation(double a, double b, double absolute) {
  const double beyond = std::abs(a - b) - absolute;
  return beyond <= 0 ? 0 : beyond / std::max(std::abs(a), std::abs(b));
}
/// NaN is the worst.
bool worse(double a, double b) { return !std::isnan(b) && !(a <= b); }
bool close(double a, double b, double relative, double absolute) {
  return deviation(a, b, absolute) <= relative;
}

/// Blends may have several delta lobes in one direction, of which each is drawn and reported alone.
bool same_delta(const DeltaLobe& a, const BsdfSample& s) {
  return a.lobe == s.lobe && length(a.wo - s.wo) < 1e-6f && close(a.mass[0], s.pdf[0], 1e-5, 0) &&
         close(a.value[0], s.value[0], 1e-5, 0);
}
void gather(std::vector<DeltaLobe>& lobes, const BsdfSample& s) {
  for (DeltaLobe& l : lobes)
    if (same_delta(l, s)) {
      ++l.count;
      return;
    }
  lobes.push_back({s.lobe, s.wo, s.value, s.pdf, 1});
}

std::string str(const Vec3& v) {
  std::ostringstream text;
  text << "(" << v.x << ", " << v.y << ", " << v.z << ")";
  return text.str();
}
template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  text.precision(8);
  (text << ... << parts);
  return text.str();
}

Vec3 direction(double degrees, bool below) {
  const float theta = float(degrees) * kPi / 180, phi = 0.4f + 0.05f * float(degrees);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
          below ? -std::cos(theta) : std::cos(theta)};
}

std::shared_ptr<const Shape> make_square(const Properties& like) {
  const PluginInfo* plugin = Registry::instance().find("shape", "rectangle");
  const Properties properties("rectangle", "", {}, like.shared_context(), plugin);
  return std::dynamic_pointer_cast<const Shape>(plugin->create(properties));
}

/// What the spectra of the BSDF are tabulated on.
SpectralGrid grid_of(const Bsdf& bsdf, const BsdfCheckOptions& options) {
  if (const auto context = bsdf.properties().shared_context()) return context->grid;
  // It was not made from a scene, and has none.
  const bool given = options.min_nm > 0 && options.max_nm > options.min_nm;
  return given ? SpectralGrid::over(options.min_nm, options.max_nm) : SpectralGrid{};
}

/// Calls of a BSDF for arrays of directions, whichever way it prefers.
class Calls {
public:
  Calls(const Bsdf& bsdf, const BsdfCheckOptions& options)
      : bsdf_(bsdf), arrays_(dynamic_cast<const ArrayBsdf*>(&bsdf)), options_(options) {
    // Quadrature takes about as many calls as the samples.
    expected_ = double(options.samples) * 2.2 * kIncidences * kHeroes +
                double(options.samples) * 1.1 * 2 * double(options.energy_angles.size()) + 1e5;
  }

  void eval_pdf(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                std::vector<BsdfEval>& found) {
    found.assign(wo.size(), {});
    in_parts(wo.size(), [&](std::size_t begin, std::size_t n) {
      if (arrays_)
        return arrays_->eval_pdf_all(wi.subspan(begin, n), wo.subspan(begin, n), ctx,
                                     std::span(found).subspan(begin, n));
      for (std::size_t i = begin; i < begin + n; ++i) found[i] = bsdf_.eval_pdf(wi[i], wo[i], ctx);
    });
  }
  /// The values alone.
  void eval(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
            std::vector<Spectrum>& found) {
    found.assign(wo.size(), {});
    std::vector<BsdfEval> both;
    if (arrays_) eval_pdf(wi, wo, ctx, both);
    in_parts(wo.size(), [&](std::size_t begin, std::size_t n) {
      for (std::size_t i = begin; i < begin + n; ++i)
        found[i] = arrays_ ? both[i].value : bsdf_.eval(wi[i], wo[i], ctx);
    });
  }
  void sample(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
              const BsdfContext& ctx, std::vector<MaybeSample>& found) {
    found.assign(wi.size(), {});
    in_parts(wi.size(), [&](std::size_t begin, std::size_t n) {
      if (arrays_)
        return arrays_->sample_all(wi.subspan(begin, n), u1.subspan(begin, n), u2.subspan(begin, n), ctx,
                                   std::span(found).subspan(begin, n));
      for (std::size_t i = begin; i < begin + n; ++i) found[i] = bsdf_.sample(wi[i], u1[i], u2[i], ctx);
    });
  }

private:
  template <class F>
  void in_parts(std::size_t count, F&& f) {
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
      const std::size_t n = std::min(kAtOnce, count - begin);
      f(begin, n);
      done_ += double(n);
      since_ += n;
      if (since_ < kAtOnce / 4 || !options_.progress) continue;
      since_ = 0;
      options_.progress(std::min(done_ / expected_, 0.99));
    }
  }

  const Bsdf& bsdf_;
  const ArrayBsdf* arrays_;
  const BsdfCheckOptions& options_;
  double done_ = 0, expected_ = 1;
  std::size_t since_ = 0;
};

class Check {
public:
  Check(const Bsdf& bsdf, const BsdfCheckOptions& options)
      : options_(options),
        bsdf_(bsdf),
        calls_(bsdf, options),
        grid_(grid_of(bsdf, options)),
        shape_(make_square(bsdf.properties())) {
    min_nm_ = options.min_nm, max_nm_ = options.max_nm;
    if (min_nm_ == 0 && max_nm_ == 0) min_nm_ = grid_.min_nm, max_nm_ = grid_.max_nm;
    if (!(min_nm_ >= grid_.min_nm && max_nm_ <= grid_.max_nm && min_nm_ <= max_nm_))
      throw Error(sentence("wavelengths: expected a range within ", grid_.min_nm, " to ", grid_.max_nm,
                           " nm, for which the BSDF was made, got ", min_nm_, " to ", max_nm_));
    if (options.samples < 1000)
      throw Error(sentence("samples: expected at least 1000, got ", options.samples));
    level_ = sidak_level(options.significance,
                         options.family_size * std::size_t(kIncidences * kHeroes * kTestsPerRun));
    // A point of a square, whose shading frame is that of the world.
    point_.uv = {0.31f, 0.64f};
    point_.p = {2 * point_.uv.x - 1, 2 * point_.uv.y - 1, 0};
    point_.ng = {0, 0, 1};
    point_.shape = shape_.get();
    for (int j = 0; j < kWavelengths; ++j) rotated_.push_back(wavelengths(j));
    find_indices();
  }

  BsdfCheckResult run() {
    result_.level = level_;
    for (const float degrees : kAngles)
      for (const bool below : {false, true}) {
        const Vec3 wi = direction(degrees, below);
        const std::size_t before = failures_;
        for (const int hero : {0, kWavelengths - 3}) check_samples(wi, hero, below);
        if (failures_ == before) check_heroes(wi);
        check_modes_of_deltas(wi);
      }
    for (const double degrees : options_.energy_angles)
      for (const bool below : {false, true}) check_energy(direction(degrees, below), below);
    check_pairs();
    check_edges();
    if (options_.progress) options_.progress(1);
    return std::move(result_);
  }

private:
  BsdfFinding& add(BsdfFinding finding) {
    if (finding.p_value >= 0) {
      result_.smallest_p = std::min(result_.smallest_p, finding.p_value);
      ++result_.statistical_tests;
    }
    if (!finding.passed) ++failures_;
    return result_.findings.emplace_back(std::move(finding));
  }
  template <class... Parts>
  void fail(BsdfFinding finding, const Parts&... parts) {
    finding.passed = false;
    finding.message = sentence(parts...);
    add(std::move(finding));
  }

  /// Wavelengths spread over the range as a path has them, with index `hero` rotated to the front.
  Wavelengths wavelengths(int hero) const {
    const double width = max_nm_ - min_nm_;
    return Wavelengths::at(
        grid_, make_spectrum([&](int i) {
          return float(min_nm_ + width * (((i + hero) % kWavelengths) + 0.37) / kWavelengths);
        }));
  }
  BsdfContext context(int hero) const { return context(hero, options_.mode); }
  BsdfContext context(int hero, TransportMode mode) const { return {rotated_[hero], point_, mode, 0}; }

  /// The refractive index on the side of w, at the wavelength that is the hero in context(j).
  double index(const Vec3& w, int j) const {
    if (options_.indices_from_samples) return w.z > 0 ? 1 : ratios_[j];
    const auto& n = w.z > 0 ? options_.n_above : options_.n_below;
    return n ? n(rotated_[j].nm[0]) : 1;
  }
  void find_indices() {
    ratios_.fill(1);
    if (!options_.indices_from_samples) return;
    for (int j = 0; j < kWavelengths; ++j)
      for (const MaybeSample& s : stratified_samples(direction(20, false), context(j)))
        if (s && s->wo.z < 0 && !has(s->lobe, Lobe::null) && s->eta > 0) {
          ratios_[j] = s->eta;
          break;
        }
  }

  /// Many stratified choices, the ends among them, which find lobes of any small mass.
  std::vector<MaybeSample> stratified_samples(const Vec3& wi, const BsdfContext& ctx) {
    SeededRandom random(options_.seed + 77);
    std::vector<float> u1;
    std::vector<Vec2> u2;
    for (int k = -1; k <= 512; ++k) {
      u1.push_back(std::clamp((float(k) + 0.5f) / 512, 0.f, kOneMinusEpsilon));
      u2.push_back(random.next2());
    }
    std::vector<MaybeSample> found;
    calls_.sample(std::vector<Vec3>(u1.size(), wi), u1, u2, ctx, found);
    return found;
  }
  std::vector<DeltaLobe> delta_lobes(const Vec3& wi, const BsdfContext& ctx) {
    std::vector<DeltaLobe> lobes;
    if (!has(bsdf_.lobes(), Lobe::delta)) return lobes;
    for (const MaybeSample& s : stratified_samples(wi, ctx))
      if (s && s->is_delta()) gather(lobes, *s);
    return lobes;
  }

  /// Calls `use(sample)` for `count` random samples (null where there is none), in parts; stops when it
  /// returns false.
  template <class F>
  bool draw(const Vec3& wi, const BsdfContext& ctx, std::size_t count, SeededRandom& random, F&& use) {
    const std::vector<Vec3> same(std::min(count, kAtOnce), wi);
    std::vector<float> u1(same.size());
    std::vector<Vec2> u2(same.size());
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
      const std::size_t n = std::min(kAtOnce, count - begin);
      for (std::size_t i = 0; i < n; ++i) u1[i] = random.next(), u2[i] = random.next2();
      calls_.sample(std::span(same).first(n), std::span(u1).first(n), std::span(u2).first(n), ctx, samples_);
      if (!use(std::span<const MaybeSample>(samples_))) return false;
    }
    return true;
  }

  /// What is wrong with samples for wi: the first thing. `worst` grows to the largest deviation from
  /// `eval_pdf`.
  struct Fault {
    std::string message;  ///< empty: nothing
    BsdfRule rule = BsdfRule::sample;
  };
  Fault judge(const Vec3& wi, std::span<const MaybeSample> samples, const BsdfContext& ctx, double& worst) {
    std::vector<Vec3> wo;
    for (const MaybeSample& s : samples)
      if (s && !s->is_delta()) wo.push_back(s->wo);
    std::vector<BsdfEval> evals;
    calls_.eval_pdf(std::vector<Vec3>(wo.size(), wi), wo, ctx, evals);
    std::size_t smooth = 0;
    for (const MaybeSample& s : samples) {
      if (!s) continue;
      const BsdfEval* const e = s->is_delta() ? nullptr : &evals[smooth++];
      const auto where = [&] { return " for wi = " + str(wi) + ", wo = " + str(s->wo); };
      if (!is_finite(s->wo))
        return {"sample returns a direction that is not finite" + where(), BsdfRule::finite};
      if (!(std::abs(length(s->wo) - 1) < 1e-4f)) return {"wo is not a unit vector" + where()};
      if (!is_density(s->value))
        return {sentence("sample returns the invalid value ", invalid_in(s->value), where()),
                BsdfRule::finite};
      if (!is_density(s->pdf))
        return {sentence("sample returns the invalid density ", invalid_in(s->pdf), where()),
                BsdfRule::finite};
      if (!(s->pdf[0] > 0)) return {"sample returns a direction of density 0" + where()};
      if ((s->lobe & bsdf_.lobes()) != s->lobe) return {"a sample's lobe is not among lobes()"};
      const bool through = (s->wo.z > 0) != (wi.z > 0);
      if (s->wo.z != 0 && wi.z != 0 && has(s->lobe, through ? Lobe::reflect : Lobe::transmit))
        return {"a sample's lobe and its side disagree" + where()};
      if (!e) {
        if (max_component(s->pdf) > 1 + 1e-5f)
          return {sentence("a probability of ", max_component(s->pdf), where())};
        continue;
      }
      for (int j = 0; j < kWavelengths; ++j) {
        const double of_pdf = deviation(e->pdf[j], s->pdf[j], 1e-6);
        const double of_value = deviation(e->value[j], s->value[j], 1e-6);
        worst = std::max({worst, of_pdf, of_value});
        if (!(of_pdf <= 1e-3))
          return {sentence("sample's density ", s->pdf[j], " is not eval_pdf's ", e->pdf[j], where())};
        if (!(of_value <= 1e-3))
          return {sentence("sample's value ", s->value[j], " is not eval_pdf's ", e->value[j], where())};
      }
    }
    return {};
  }

  /// Bins for the density of wi; nothing where samples are wrong.
  std::optional<SphereBins> make_bins(const Vec3& wi, const BsdfContext& ctx, SeededRandom& random) {
    const double nm = ctx.wavelengths.nm[0];
    SphereBins::Options bin_options;
    bin_options.pilot.reserve(options_.samples / 8);
    Fault fault;
    double worst = 0;
    draw(wi, ctx, options_.samples / 8, random, [&](std::span<const MaybeSample> samples) {
      fault = judge(wi, samples, ctx, worst);
      for (const MaybeSample& s : samples)
        if (s && !s->is_delta()) bin_options.pilot.push_back(s->wo);
      return fault.message.empty();
    });
    BsdfFinding finding{fault.rule, wi, nm, worst};
    finding.limit = 1e-3;
    if (!fault.message.empty()) {
      fail(finding, fault.message);
      return {};
    }
    add(std::move(finding));
    if (options_.focus) bin_options.focus = options_.focus(wi);
    bin_options.focus_angle = options_.focus_angle;
    bin_options.most_bins = options_.most_bins;

    BsdfFinding finite{BsdfRule::finite, wi, nm};
    SphereBins bins(
        [&](std::span<const Vec3> wo, std::span<SphereBins::Value> values) {
          calls_.eval_pdf(std::vector<Vec3>(wo.size(), wi), wo, ctx, evals_);
          for (std::size_t i = 0; i < wo.size(); ++i) {
            const BsdfEval& e = evals_[i];
            if (is_density(e.value) && is_density(e.pdf)) {
              values[i] = {e.pdf[0], e.value};
              continue;
            }
            // Zero instead, so that one bad place does not hide everything else.
            if (finite.figure++ == 0)
              finite.message = sentence("eval_pdf gives the value ", invalid_in(e.value), " and the density ",
                                        invalid_in(e.pdf), " for wi = ", str(wi), ", wo = ", str(wo[i]));
          }
        },
        bin_options);
    finite.passed = finite.figure == 0;
    add(std::move(finite));
    return bins;
  }

  /// The energy of each wavelength, as place in the context of `hero`, each as hero for the delta lobes;
  /// recorded and bounded.
  std::array<double, kWavelengths> judge_energy(const Vec3& wi, int hero, const SphereBins& bins) {
    BsdfCheckResult::Energy e{wi, {}, bins.other(), true};
    BsdfFinding finding{BsdfRule::energy, wi};
    finding.expected = options_.largest_energy;
    finding.limit = options_.tolerance;
    // A BSDF that is not reciprocal conserves energy in one mode.
    e.bounded = options_.reciprocal || options_.mode == TransportMode::radiance;
    double worst = -1;
    for (int j = 0; j < kWavelengths; ++j) {
      for (const DeltaLobe& d : delta_lobes(wi, context((hero + j) % kWavelengths)))
        e.energy[j] += d.value[0];
      const double energy = e.energy[j];
      e.nm[j] = rotated_[hero].nm[j];
      result_.largest_energy = std::max(result_.largest_energy, energy);
      result_.smallest_energy = std::min(result_.smallest_energy, energy);
      const double gain = e.bounded ? energy - options_.largest_energy : 0,
                   loss = options_.lossless ? 1 - energy : 0;
      const double wrong = std::isnan(energy) ? HUGE_VAL : std::max(gain, loss);
      if (worst >= 0 && wrong <= worst) continue;
      worst = std::max(wrong, 0.0);
      finding.figure = energy;
      finding.nm = e.nm[j];
      finding.passed = wrong <= options_.tolerance;
      if (!finding.passed) {
        finding.expected = loss > gain ? 1 : options_.largest_energy;
        finding.message = sentence(loss > gain ? "loses" : "gains", " energy: ", energy, " at ", e.nm[j],
                                   " nm, wi = ", str(wi));
      }
    }
    add(std::move(finding));
    result_.energies.push_back(e);
    return e.energy;
  }

  bool is_black(const SphereBins& bins) const {
    const auto energy = bins.other();
    return bins.mass() == 0 && std::all_of(energy.begin(), energy.end(), [](double e) { return e == 0; });
  }
  /// Records that nothing comes from wi.
  void note_black(const Vec3& wi, double nm, bool passed, const std::string& where) {
    BsdfFinding finding{BsdfRule::black, wi, nm};
    finding.passed = passed;
    if (!passed) finding.message = "it is not black from below, " + where;
    add(std::move(finding));
    if (passed) {
      result_.black_below |= wi.z < 0;
      BsdfCheckResult::Energy e{wi, {}, {}, true};
      for (int j = 0; j < kWavelengths; ++j) e.nm[j] = rotated_[0].nm[j];
      result_.energies.push_back(e);
    }
  }

  /// Chi-square, masses, energies.
  void check_samples(const Vec3& wi, int hero, bool below) {
    const BsdfContext ctx = context(hero);
    const double nm = ctx.wavelengths.nm[0];
    const std::string where = sentence("wi = ", str(wi), ", hero ", nm, " nm");
    SeededRandom random(options_.seed * 1000003 + std::uint64_t(hero) + std::uint64_t(1000 * (wi.z + 2)));
    const std::optional<SphereBins> made = make_bins(wi, ctx, random);
    if (!made) return;
    const SphereBins& bins = *made;

    std::vector<std::size_t> counts(bins.bins().size());
    std::vector<DeltaLobe> deltas;
    std::size_t smooth = 0, none = 0;
    double weight = 0, weight2 = 0;
    draw(wi, ctx, options_.samples, random, [&](std::span<const MaybeSample> samples) {
      for (const MaybeSample& s : samples) {
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
      // More delta lobes than any BSDF has: directions that scatter but call themselves delta.
      return deltas.size() < 1000;
    });
    if (deltas.size() >= 1000)
      return fail({BsdfRule::delta_lobes, wi, nm},
                  "samples call themselves delta but go in ever new directions, ", where);
    for (const DeltaLobe& l : delta_lobes(wi, ctx))
      if (std::none_of(deltas.begin(), deltas.end(), [&](const DeltaLobe& d) {
            return same_delta(d, {l.wo, l.value, l.mass, l.lobe});
          })) {
        deltas.push_back(l);
        deltas.back().count = 0;
      }

    const double n = double(options_.samples);
    if (below && options_.black_below)
      return note_black(wi, nm, none == options_.samples && !(bins.mass() > 0), where);
    if (none == options_.samples && is_black(bins)) {
      if (below && options_.may_be_black_below) return note_black(wi, nm, true, where);
      if (options_.may_fail) return;
    }
    result_.largest_failure = std::max(result_.largest_failure, double(none) / n);

    // Masses.
    double mass = bins.mass();
    for (const DeltaLobe& d : deltas) {
      mass += d.mass[0];
      BsdfFinding finding{BsdfRule::delta_lobes, wi, nm};
      finding.figure = double(d.count) / n;
      finding.expected = d.mass[0];
      finding.p_value = binomial_p_value(d.count, options_.samples, std::min(double(d.mass[0]), 1.0));
      finding.limit = level_;
      finding.passed = finding.p_value >= level_;
      if (!finding.passed)
        finding.message = sentence("a delta lobe of mass ", d.mass[0], " was sampled ", d.count, " times of ",
                                   options_.samples, " (p = ", finding.p_value, "), ", where);
      add(std::move(finding));
    }
    BsdfFinding integral{BsdfRule::density_integral, wi, nm};
    integral.figure = mass;
    integral.expected = options_.may_fail ? 1 - double(none) / n : 1;
    integral.limit = options_.tolerance + (options_.may_fail ? 5 * std::sqrt(double(none) + 1) / n : 0);
    const double mass_error = std::abs(mass - integral.expected);
    result_.largest_mass_error = std::max(result_.largest_mass_error, mass_error);
    if (!options_.may_fail && none)
      integral.passed = false,
      integral.message = sentence("`sample` returned nothing ", none, " times, ", where);
    else if (!(mass_error <= integral.limit))
      integral.passed = false, integral.message = sentence("densities and masses add up to ", mass,
                                                           " instead of ", integral.expected, ", ", where);
    add(std::move(integral));

    // Shape.
    if (smooth || bins.mass() > 1e-6) {
      const ChiSquareResult r = chi_square_test(bins, counts, options_.samples, std::max(5.0, n / 2000));
      BsdfFinding finding{BsdfRule::chi_square, wi, nm};
      finding.figure = r.statistic;
      finding.expected = double(r.bins) - 1;
      finding.p_value = r.p_value;
      finding.limit = level_;
      finding.passed = r.p_value >= level_;
      if (!finding.passed)
        finding.message =
            sentence("chi-square ", r.statistic, " in ", r.bins, " bins, p = ", r.p_value, ", ", where);
      add(std::move(finding));
      BsdfCheckResult::Histogram histogram{wi,        nm,          hero,   options_.samples,
                                           r.p_value, r.statistic, r.bins, {}};
      histogram.bins.reserve(counts.size());
      for (std::size_t i = 0; i < counts.size(); ++i) {
        const SphereBins::Bin& b = bins.bins()[i];
        histogram.bins.push_back({b.center, float(b.size), float(b.mass * n), float(counts[i])});
      }
      result_.histograms.push_back(std::move(histogram));
    }

    const double energy = judge_energy(wi, hero, bins)[0];
    const double mean_weight = weight / n;
    const double variance = std::max(weight2 / n - mean_weight * mean_weight, 0.0) / n;
    BsdfFinding finding{BsdfRule::sample_energy, wi, nm};
    finding.figure = mean_weight;
    finding.expected = energy;
    // Quadrature and single precision have errors, too.
    finding.p_value =
        normal_p_value(std::max(std::abs(mean_weight - energy) - 1e-4, 0.0) / std::sqrt(variance + 1e-12));
    finding.limit = level_;
    finding.passed = finding.p_value >= level_;
    if (!finding.passed)
      finding.message = sentence("samples carry the energy ", mean_weight, ", eval has ", energy,
                                 " (p = ", finding.p_value, "), ", where);
    add(std::move(finding));
  }

  /// Energy alone, for the angles between.
  void check_energy(const Vec3& wi, bool below) {
    if (below && (options_.black_below || result_.black_below)) return;
    SeededRandom random(options_.seed * 1000003 + std::uint64_t(1000 * (wi.z + 2)));
    if (const std::optional<SphereBins> bins = make_bins(wi, context(0), random)) judge_energy(wi, 0, *bins);
  }

  /// Values and densities belong to wavelengths, not to their place among the N: rotating which of them is
  /// the hero rotates them.
  void check_heroes(const Vec3& wi) {
    BsdfFinding finding{BsdfRule::wavelengths, wi};
    finding.limit = 1e-3;
    SeededRandom random(options_.seed + 5);
    constexpr int kDirections = 100;
    std::vector<Vec3> wo;
    std::vector<float> u1;
    std::vector<Vec2> u2;
    for (int k = 0; k < kDirections; ++k) {
      wo.push_back(square_to_uniform_sphere(random.next2()));
      if (k % 2) u1.push_back(random.next()), u2.push_back(random.next2());
    }
    const std::vector<Vec3> same(kDirections, wi);
    std::vector<MaybeSample> drawn;
    calls_.sample(std::span(same).first(u1.size()), u1, u2, context(0), drawn);
    for (std::size_t k = 0; k < drawn.size(); ++k)
      if (drawn[k] && !drawn[k]->is_delta()) wo[2 * k + 1] = drawn[k]->wo;

    std::vector<BsdfEval> first, other;
    calls_.eval_pdf(same, wo, context(0), first);
    for (int j = 1; j < kWavelengths; ++j) {
      calls_.eval_pdf(same, wo, context(j), other);
      for (int k = 0; k < kDirections; ++k)
        for (int i = 0; i < kWavelengths; ++i) {
          const int original = (i + j) % kWavelengths;
          for (const bool density : {true, false}) {
            const double a = density ? first[k].pdf[original] : first[k].value[original];
            const double b = density ? other[k].pdf[i] : other[k].value[i];
            const double d = deviation(a, b, 1e-7);
            finding.figure = std::max(finding.figure, d);
            if (d <= finding.limit) continue;
            finding.nm = rotated_[0].nm[original];
            return fail(finding, density ? "density" : "value", " of wavelength ", original, " (", finding.nm,
                        " nm) is ", a, ", but ", b, " with hero ", j, " for wi = ", str(wi),
                        ", wo = ", str(wo[k]));
          }
        }
    }
    // Delta lobes: the mass given for wavelength j is the probability with which j, as hero, would go there.
    const std::vector<DeltaLobe> mirrors = delta_lobes(wi, context(0));
    for (int j = 1; j < kWavelengths && !mirrors.empty(); ++j) {
      const std::vector<DeltaLobe> as_hero = delta_lobes(wi, context(j));
      for (const DeltaLobe& l : mirrors) {
        const auto here = [&](const DeltaLobe& d) { return d.lobe == l.lobe && length(d.wo - l.wo) < 1e-7f; };
        double mass = 0, value = 0, expected_mass = 0, expected_value = 0;
        for (const DeltaLobe& d : mirrors)
          if (here(d)) expected_mass += d.mass[j], expected_value += d.value[j];
        for (const DeltaLobe& o : as_hero)
          if (here(o)) mass += o.mass[0], value += o.value[0];
        const double of_mass = deviation(mass, expected_mass, 1e-6);
        const double of_value = deviation(value, expected_value, 1e-6);
        finding.figure = std::max({finding.figure, of_mass, of_value});
        if (of_mass <= finding.limit && of_value <= finding.limit) continue;
        finding.nm = rotated_[0].nm[j];
        return fail(finding, "wavelength ", j, " (", finding.nm, " nm) has mass ", expected_mass,
                    " and value ", expected_value, " in the hero's delta lobe towards ", str(l.wo),
                    ", but as hero ", mass, " and ", value);
      }
    }
    add(std::move(finding));
  }

  /// Radiance over n^2 is what a delta lobe carries, in either direction.
  void check_modes_of_deltas(const Vec3& wi) {
    if (!options_.reciprocal) return;
    BsdfFinding finding{BsdfRule::modes, wi, rotated_[0].nm[0]};
    finding.limit = 1e-3;
    const std::vector<DeltaLobe> importance = delta_lobes(wi, context(0, TransportMode::importance));
    const std::vector<DeltaLobe> radiance = delta_lobes(wi, context(0, TransportMode::radiance));
    if (importance.empty() && radiance.empty()) return;
    if (importance.size() != radiance.size())
      return fail(finding, "the modes have different delta lobes for wi = ", str(wi));
    for (std::size_t k = 0; k < importance.size(); ++k) {
      // What passes as if nothing were there does not enter another medium.
      const bool null = has(importance[k].lobe, Lobe::null);
      const double ratio = null ? 1 : index(wi, 0) / index(importance[k].wo, 0);
      const double d = deviation(radiance[k].value[0], importance[k].value[0] * ratio * ratio, 1e-6);
      finding.figure = std::max(finding.figure, d);
      if (!(d <= finding.limit))
        return fail(finding, "a delta lobe carries ", radiance[k].value[0], " in radiance mode and ",
                    importance[k].value[0], " in importance mode, for wi = ", str(wi));
    }
    add(std::move(finding));
  }

  /// Reciprocity, and the relation between the modes: importance mode is radiance mode with the roles of wi
  /// and wo exchanged.
  void check_pairs() {
    if (!bsdf_.is_smooth()) return;
    SeededRandom random(options_.seed + 9);
    std::vector<Vec3> wi, wo, from;
    std::vector<float> u1;
    std::vector<Vec2> u2;
    for (int k = 0; k < 4000; ++k) {
      wi.push_back(square_to_uniform_sphere(random.next2()));
      wo.push_back(square_to_uniform_sphere(random.next2()));
      if (k % 2) from.push_back(wi.back()), u1.push_back(random.next()), u2.push_back(random.next2());
    }
    std::vector<MaybeSample> drawn;
    calls_.sample(from, u1, u2, context(0), drawn);
    for (std::size_t k = 0; k < drawn.size(); ++k)
      if (drawn[k] && !drawn[k]->is_delta()) wo[2 * k + 1] = drawn[k]->wo;

    std::vector<Spectrum> to_wi, to_wo, adjoint;
    calls_.eval(wi, wo, context(0, TransportMode::radiance), to_wi);
    calls_.eval(wo, wi, context(0, TransportMode::radiance), to_wo);
    calls_.eval(wi, wo, context(0, TransportMode::importance), adjoint);
    BsdfFinding modes{BsdfRule::modes}, reciprocity{BsdfRule::reciprocity};
    modes.limit = reciprocity.limit = 2e-3;
    std::size_t wrong = 0, pairs = 0;
    for (std::size_t k = 0; k < wi.size(); ++k) {
      if (!(std::abs(wi[k].z) >= 1e-3f && std::abs(wo[k].z) >= 1e-3f)) continue;
      ++pairs;
      bool agrees = true;
      for (int j = 0; j < kWavelengths; ++j) {
        const double ni = index(wi[k], j), no = index(wo[k], j);
        const double forward = to_wi[k][j] / std::abs(wo[k].z), backward = to_wo[k][j] / std::abs(wi[k].z);
        const double other = adjoint[k][j] / std::abs(wo[k].z);
        const double of_modes = deviation(other, backward, 1e-6);
        if (worse(of_modes, modes.figure)) {
          modes.figure = of_modes;
          if (!(of_modes <= modes.limit)) {
            modes.passed = false;
            modes.wi = wi[k], modes.nm = rotated_[j].nm[0];
            modes.message =
                sentence("importance mode gives ", other, " for wi -> wo, radiance mode ", backward,
                         " for the same light; wi = ", str(wi[k]), ", wo = ", str(wo[k]));
          }
        }
        if (!options_.reciprocal) continue;
        const double a = forward / (ni * ni), b = backward / (no * no), of_pair = deviation(a, b, 1e-6);
        agrees &= of_pair <= reciprocity.limit;
        if (worse(of_pair, reciprocity.figure)) {
          reciprocity.figure = of_pair;
          if (!(of_pair <= reciprocity.limit)) {
            reciprocity.passed = false;
            reciprocity.wi = wi[k], reciprocity.nm = rotated_[j].nm[0];
            reciprocity.message = sentence("not reciprocal: ", a, " against ", b, " at ", reciprocity.nm,
                                           " nm; wi = ", str(wi[k]), ", wo = ", str(wo[k]));
          }
        }
        if (j == 0) result_.pairs.push_back({wi[k], wo[k], rotated_[0].nm[0], a, b});
      }
      wrong += !agrees;
    }
    if (wrong) reciprocity.message += sentence(" (the worst; ", wrong, " of ", pairs, " pairs are wrong)");
    add(std::move(modes));
    if (options_.reciprocal) add(std::move(reciprocity));
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
    std::vector<float> u1;
    std::vector<Vec2> u2;
    for (const float a : kUnitEdges)
      for (const float x : kUnitEdges)
        for (const float y : kUnitEdges) u1.push_back(a), u2.push_back({x, y});

    BsdfFinding finding{BsdfRule::finite};
    std::vector<BsdfEval> evals;
    std::vector<MaybeSample> samples;
    const auto found = [&](const Vec3& wi, const std::string& message) {
      finding.figure += 1;
      if (finding.message.empty()) finding.wi = wi, finding.message = message;
    };
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
      for (const Vec3& wi : directions) {
        calls_.eval_pdf(std::vector<Vec3>(directions.size(), wi), directions, context(0, mode), evals);
        for (std::size_t k = 0; k < evals.size(); ++k)
          if (!is_density(evals[k].value) || !is_density(evals[k].pdf))
            found(wi,
                  sentence("eval_pdf gives the value ", invalid_in(evals[k].value), " and the density ",
                           invalid_in(evals[k].pdf), " for wi = ", str(wi), ", wo = ", str(directions[k])));
        calls_.sample(std::vector<Vec3>(u1.size(), wi), u1, u2, context(0, mode), samples);
        for (std::size_t k = 0; k < samples.size(); ++k) {
          double unused = 0;
          const std::string wrong =
              judge(wi, std::span<const MaybeSample>(samples).subspan(k, 1), context(0, mode), unused)
                  .message;
          if (!wrong.empty()) found(wi, sentence(wrong, ", with u = ", u1[k], ", ", u2[k].x, ", ", u2[k].y));
        }
      }
    finding.passed = finding.figure == 0;
    if (finding.figure > 1) finding.message += sentence(" (the first of ", finding.figure, ")");
    add(std::move(finding));
  }

  const BsdfCheckOptions& options_;
  const Bsdf& bsdf_;
  Calls calls_;
  SpectralGrid grid_;
  double min_nm_ = 0, max_nm_ = 0;
  std::shared_ptr<const Shape> shape_;
  SurfacePoint point_;
  std::vector<Wavelengths> rotated_;
  std::array<double, kWavelengths> ratios_{};
  double level_ = 0;
  std::size_t failures_ = 0;
  BsdfCheckResult result_;
  // Kept from call to call.
  std::vector<MaybeSample> samples_;
  std::vector<BsdfEval> evals_;
};

}  // namespace

const char* name_of(BsdfRule rule) {
  constexpr const char* kNames[] = {"sample", "chi_square",    "delta_lobes", "density_integral",
                                    "energy", "sample_energy", "black",       "wavelengths",
                                    "modes",  "reciprocity",   "finite"};
  return kNames[int(rule)];
}

bool BsdfCheckResult::passed() const {
  return std::all_of(findings.begin(), findings.end(), [](const BsdfFinding& f) { return f.passed; });
}

std::vector<std::string> BsdfCheckResult::problems() const {
  std::vector<std::string> sentences;
  for (const BsdfFinding& f : findings)
    if (!f.passed) sentences.push_back(f.message);
  return sentences;
}

BsdfCheckResult check_bsdf(const Bsdf& bsdf, const BsdfCheckOptions& options) {
  return Check(bsdf, options).run();
}

}  // namespace aureole
