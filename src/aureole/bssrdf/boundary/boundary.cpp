// SPDX-License-Identifier: Apache-2.0
#include "aureole/bssrdf/boundary/boundary.h"

#include <algorithm>
#include <vector>

#include "aureole/math/warp.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {

namespace {

/// A smooth boundary through which all wavelengths of a path enter together, even if the index depends on the
/// wavelength. A `dielectric` refracts each wavelength in another direction, which is irrelevant to a BSSRDF.
class SmoothEntry final : public Bsdf {
public:
  SmoothEntry(const Properties& p, const SampledSpectrum& relative_index)
      : Bsdf(p), relative_index_(relative_index) {}

  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    const Spectrum r = fresnel_dielectric(wi.z, relative_index_.eval(ctx.wavelengths));
    if (u1 < r[0]) return BsdfSample{aureole::reflect(wi), r, r, Lobe::delta | Lobe::reflect};
    const Spectrum t = Spectrum(1.f) - r;
    return BsdfSample{-wi, t, t, Lobe::delta | Lobe::enter};
  }
  bool needs_tangent() const override { return false; }
  Lobe lobes() const override { return Lobe::delta | Lobe::reflect | Lobe::enter; }

private:
  SampledSpectrum relative_index_;
};

/// A boundary described by another BSDF.
class NestedEntry final : public Bsdf {
public:
  NestedEntry(const Properties& p, BsdfPtr nested, const SampledSpectrum& relative_index)
      : Bsdf(p), nested_(std::move(nested)), relative_index_(relative_index) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return nested_->eval_pdf(wi, wo, ctx);
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    std::optional<BsdfSample> s = nested_->sample(wi, u1, u2, ctx);
    if (!s || s->wo.z > 0) return s;
    const Spectrum n = relative_index_.eval(ctx.wavelengths);
    if (s->is_delta() && min_component(n) != max_component(n)) {
      // A dispersive smooth boundary samples the hero wavelength alone; Fresnel's equations give the others.
      const Spectrum t = Spectrum(1.f) - fresnel_dielectric(wi.z, n);
      const float undo = ctx.mode == TransportMode::radiance ? n[0] * n[0] : 1.f;
      if (!(t[0] > 0)) return {};
      s->value = t * (s->value[0] * undo / t[0]);
      s->pdf = t * (s->pdf[0] / t[0]);
    } else if (ctx.mode == TransportMode::radiance) {
      s->value *= n * n;
    }
    s->lobe = Lobe::enter | (s->is_delta() ? Lobe::delta : Lobe::glossy);
    s->eta = 1;
    return s;
  }
  double single_scattering_loss(bool from_within) const override {
    return from_within ? 0 : nested_->single_scattering_loss(false);
  }
  bool needs_tangent() const override { return nested_->needs_tangent(); }
  bool needs_choice() const override { return nested_->needs_choice(); }
  Lobe lobes() const override {
    return Lobe(unsigned(nested_->lobes()) & ~unsigned(Lobe::transmit)) | Lobe::enter;
  }

private:
  BsdfPtr nested_;
  SampledSpectrum relative_index_;
};

/// The transmittance T of a boundary from outside as a function of the cosine, divided by its mean c.
class Transmittance {
public:
  static constexpr int kCells = 64;

  /// Tabulates a rough boundary's transmittance at some wavelengths, each as a sum over samples of its BSDF.
  Transmittance(const Bsdf& boundary, const SampledSpectrum& relative_index) : grid_(relative_index.grid()) {
    const bool disperses = relative_index.minimum() != relative_index.maximum();
    nodes_ = disperses ? 9 : 1;
    for (int k = 0; k < nodes_; ++k) {
      const double nm = std::lerp(grid_.min_nm, grid_.max_nm, nodes_ > 1 ? k / double(nodes_ - 1) : 0.5);
      const Wavelengths w = Wavelengths::at(grid_, float(nm));
      double mean = 0;
      float before = 0;
      for (int i = 0; i <= kCells; ++i) {
        const float mu = std::max(float(i) / kCells, 1e-3f), t = transmitted(boundary, mu, w);
        table_.push_back(t);
        // The integral of 2 T mu over one linear segment.
        const double h = 1.0 / kCells, a = double(before), b = double(t);
        if (i > 0) mean += h * ((a + b) * (i - 1) * h + h * (a + 2 * b) / 3);
        before = t;
      }
      for (std::size_t i = table_.size() - kCells - 1; i < table_.size(); ++i)
        table_[i] = mean > 0 ? float(double(table_[i]) / mean) : 0.f;
    }
  }

  /// T/c
  Spectrum at(float mu, const Wavelengths& w) const {
    const float x = std::min(mu, 1.f) * kCells;
    const int i = std::min(int(x), kCells - 1);
    const auto of_node = [&](int k) {
      const float* t = &table_[std::size_t(k * (kCells + 1) + i)];
      return t[0] + (t[1] - t[0]) * (x - float(i));
    };
    if (nodes_ == 1) return of_node(0);
    const float scale = float((nodes_ - 1) / (grid_.max_nm - grid_.min_nm)), first = float(grid_.min_nm);
    return make_spectrum([&](int j) {
      const float y = std::clamp((w.nm[j] - first) * scale, 0.f, float(nodes_ - 1));
      const int k = std::min(int(y), nodes_ - 2);
      return std::lerp(of_node(k), of_node(k + 1), y - float(k));
    });
  }

private:
  static float transmitted(const Bsdf& boundary, float mu, const Wavelengths& w) {
    constexpr int kSide = 8, kChoices = 16;
    const SurfacePoint anywhere;
    const BsdfContext ctx{w, anywhere, TransportMode::importance};
    const Vec3 wi{std::sqrt((1 - mu) * (1 + mu)), 0, mu};
    double sum = 0;
    for (int c = 0; c < kChoices; ++c)
      for (int a = 0; a < kSide * kSide; ++a) {
        // Each value of u1 has its own shift of the grid of directions.
        const auto shifted = [&](int k, float by) {
          const float u = (float(k) + 0.5f) / kSide + float(c) * by;
          return std::min(u - std::floor(u), kOneMinusEpsilon);
        };
        const auto s =
            boundary.sample(wi, (float(c) + 0.5f) / kChoices,
                            {shifted(a % kSide, 0.754877666f), shifted(a / kSide, 0.569840291f)}, ctx);
        if (s && s->wo.z < 0 && s->pdf[0] > 0) sum += double(s->value[0] / s->pdf[0]);
      }
    return float(sum / (kChoices * kSide * kSide));
  }

  SpectralGrid grid_;
  int nodes_;
  std::vector<float> table_;  ///< T/c by wavelength, then by cosine
};

class Exit : public Bsdf {
public:
  using Bsdf::Bsdf;

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const final {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    const float pdf = cosine_hemisphere_pdf(wo.z);
    return {relative_transmittance(wo.z, ctx.wavelengths) * pdf, pdf};
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const final {
    const Vec3 wo = square_to_cosine_hemisphere(u2);
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, lobes()};
  }
  bool needs_tangent() const final { return false; }
  bool needs_choice() const final { return false; }
  Lobe lobes() const final { return Lobe::diffuse | Lobe::reflect; }

private:
  virtual Spectrum relative_transmittance(float mu, const Wavelengths& w) const = 0;  ///< T/c
};

class SmoothExit final : public Exit {
public:
  SmoothExit(const Properties& p, const SampledSpectrum& relative_index)
      : Exit(p), relative_index_(relative_index) {
    std::vector<float> means;
    float last = 0, mean = 0;
    for (const float n : relative_index.nodes()) {
      if (n != last) mean = float(1 / (1 - optics::fresnel_diffuse_reflectance(double(n))));
      means.push_back(mean), last = n;
    }
    inverse_mean_ = SampledSpectrum(relative_index.grid(), std::move(means));
  }

private:
  Spectrum relative_transmittance(float mu, const Wavelengths& w) const override {
    return (Spectrum(1.f) - fresnel_dielectric(mu, relative_index_.eval(w))) * inverse_mean_.eval(w);
  }

  SampledSpectrum relative_index_, inverse_mean_;
};

class RoughExit final : public Exit {
public:
  RoughExit(const Properties& p, const Bsdf& boundary, const SampledSpectrum& relative_index)
      : Exit(p), transmittance_(boundary, relative_index) {}

private:
  Spectrum relative_transmittance(float mu, const Wavelengths& w) const override {
    return transmittance_.at(mu, w);
  }

  Transmittance transmittance_;
};

/// Returns the relative index of refraction, taken from `eta` of a sample in which the hero wavelength is
/// transmitted along the normal; 0 if there is none.
float relative_index_of(const Bsdf& boundary, const Wavelengths& w) {
  const SurfacePoint anywhere;
  constexpr int kTries = 64;
  for (int i = kTries - 1; i >= 0; --i) {
    const auto s = boundary.sample({0, 0, 1}, (float(i) + 0.5f) / kTries, {0.5f, 0.5f}, {w, anywhere});
    if (s && s->wo.z < 0) return s->eta;
  }
  return 0;
}

void check_nested(const Bsdf& boundary, const Wavelengths& w) {
  Spectrum n;
  if (!boundary.interior_index(w, n) || boundary.is_passable())
    throw Error(boundary.properties().where(),
                "the boundary of a bssrdf must refract, as \"dielectric\" and \"roughdielectric\" do; a \"" +
                    boundary.properties().type() + "\" does not");
  for (const Properties::Entry& e : boundary.properties().entries()) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    const auto* texture = object ? dynamic_cast<const Texture*>(object->get()) : nullptr;
    if (texture && !texture->is_constant())
      throw Error(e.where, "the boundary of a bssrdf must be the same everywhere");
  }
}

}  // namespace

Boundary make_boundary(const Properties& p) {
  const SpectralGrid& grid = p.context().grid;
  const auto nested = p.get_children<Bsdf>("bsdf");
  if (nested.size() > 1)
    throw Error(nested[1]->properties().where(), "a bssrdf has one boundary, but this is its second BSDF");
  // Both indices are read in any case, since they are documented for all plug-ins of the family.
  const Ior interior = Ior::from(p, "int_ior", "polypropylene"), exterior = Ior::from(p, "ext_ior", "air");
  Boundary b;
  if (nested.empty()) {
    b.relative_index = SampledSpectrum::from_function(grid, [&](double nm) {
      const Wavelengths w = Wavelengths::at(grid, float(nm));
      return double(interior.eval(w)[0] / exterior.eval(w)[0]);
    });
    b.entry = std::make_shared<SmoothEntry>(p, b.relative_index);
    b.exit = std::make_shared<SmoothExit>(p, b.relative_index);
    return b;
  }
  for (const char* name : {"int_ior", "ext_ior", "dispersion"})
    if (p.has(name)) throw p.error(name, "the nested BSDF is the boundary, and has its indices");
  const BsdfPtr boundary = nested.front();
  check_nested(*boundary, Wavelengths::at(grid, float(grid.min_nm)));
  b.relative_index = SampledSpectrum::from_function(grid, [&](double nm) {
    return double(relative_index_of(*boundary, Wavelengths::at(grid, float(nm))));
  });
  if (!(b.relative_index.minimum() > 0))
    throw Error(boundary->properties().where(), "this boundary of a bssrdf lets no light in");
  b.entry = std::make_shared<NestedEntry>(p, boundary, b.relative_index);
  if (boundary->is_smooth())
    b.exit = std::make_shared<RoughExit>(p, *boundary, b.relative_index);
  else
    b.exit = std::make_shared<SmoothExit>(p, b.relative_index);
  return b;
}

}  // namespace aureole
