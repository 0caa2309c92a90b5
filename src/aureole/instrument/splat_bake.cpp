// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/splat_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/integrator/aov_channels.h"
#include "aureole/math/piecewise.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

/// A patch of a surface that is baked.
struct BakedPatch {
  const AreaSampler* sampler;
  std::size_t patch;
};

/// The least-squares fit of harmonics to colours in directions. The terms above degree 0 are regularised,
/// since the half of the sphere behind the surface has no data.
class HarmonicFit {
public:
  explicit HarmonicFit(std::size_t terms)
      : terms_(terms), matrix_(terms * terms, 0.), right_(3 * terms, 0.) {}
  void add(const float* functions, const Vec3& color) {
    for (std::size_t i = 0; i < terms_; ++i) {
      for (std::size_t j = 0; j < terms_; ++j)
        matrix_[i * terms_ + j] += double(functions[i]) * double(functions[j]);
      for (std::size_t k = 0; k < 3; ++k)
        right_[3 * i + k] += double(functions[i]) * double(color[int(k)] - 0.5f);
    }
    ++count_;
  }
  /// Writes the coefficients of all terms.
  void solve(float* out) {
    const std::size_t n = terms_;
    constexpr double kHold = 1e-3;
    for (std::size_t i = 1; i < n; ++i) matrix_[i * n + i] += kHold * double(count_) / (4 * kPiD);
    // Solves by Cholesky's factorisation: the matrix is symmetric and positive definite.
    std::vector<double>& m = matrix_;
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < j; ++k) m[j * n + j] -= m[j * n + k] * m[j * n + k];
      m[j * n + j] = std::sqrt(std::max(m[j * n + j], 1e-30));
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) m[i * n + j] -= m[i * n + k] * m[j * n + k];
        m[i * n + j] /= m[j * n + j];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < i; ++k) right_[3 * i + c] -= m[i * n + k] * right_[3 * k + c];
        right_[3 * i + c] /= m[i * n + i];
      }
      for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) right_[3 * i + c] -= m[k * n + i] * right_[3 * k + c];
        right_[3 * i + c] /= m[i * n + i];
        out[3 * i + c] = float(right_[3 * i + c]);
      }
    }
  }

private:
  std::size_t terms_, count_ = 0;
  std::vector<double> matrix_, right_;
};

Vec3 encoded(const Vec3& c) {
  return {srgb_encode(std::max(0.f, c.x)), srgb_encode(std::max(0.f, c.y)), srgb_encode(std::max(0.f, c.z))};
}

/// Point i of a sequence in [0, 1)^2 that fills the square evenly (generalised golden ratio, Roberts 2018).
Vec2 even_place_2d(std::size_t i) {
  const auto turn = [&](double by) { return float(std::fmod(0.5 + by * double(i + 1), 1.0)); };
  return {turn(0.7548776662466927), turn(0.5698402909980532)};
}

}  // namespace

SplatBake bake_splats(const LoadedScene& loaded, const SplatBakeOptions& options) {
  const Scene& scene = *loaded.scene;
  const Integrator& integrator = *loaded.integrator;
  if (integrator.leaves() != Integrator::Leaves::pixel)
    throw integrator.properties().error("",
                                        "light paths belong to no place on a surface: bake with \"path\"");
  integrator.require_scene(scene);
  SplatBake bake;
  std::vector<std::shared_ptr<const AreaSampler>> samplers;
  std::vector<BakedPatch> patches;
  std::vector<float> areas;
  std::size_t null_surfaces = 0, others = 0;
  for (std::size_t s = 0; s < scene.parts().surfaces.size(); ++s) {
    const Surface& surface = scene.surfaces().all[s];
    if (!surface.shape) {
      ++others;
      continue;
    }
    if (surface.is_null()) {
      ++null_surfaces;
      continue;
    }
    try {
      samplers.push_back(surface.shape->make_area_sampler(AreaUse::sensor));
    } catch (const Error&) {
      ++others;
      continue;
    }
    for (std::size_t k = 0; k < samplers.back()->patch_count(); ++k)
      if (const float area = samplers.back()->patch_area(k); area > 0)
        patches.push_back({samplers.back().get(), k}), areas.push_back(area), bake.area += double(area);
  }
  if (null_surfaces > 0)
    bake.notes.push_back(fmt::format("{} surfaces that pass light unchanged are left out", null_surfaces));
  if (others > 0)
    bake.notes.push_back(
        fmt::format("{} shapes whose area cannot be sampled, such as instances, are left out", others));
  if (patches.empty()) throw Error("the scene has no surface to bake");
  if (scene.has_media()) bake.notes.push_back("media are left out: their light is baked on surfaces alone");

  const Piecewise1D choice(areas);
  const float spacing = float(std::sqrt(bake.area / double(options.count)));
  const int degree = options.as_points ? 0 : options.degree;
  SplatCloud& cloud = bake.cloud;
  cloud.kind = options.as_points ? SplatCloud::Kind::points : SplatCloud::Kind::gaussians;
  cloud.format = "baked", cloud.axes = "RUB", cloud.has_normals = options.as_points;
  cloud.resize(options.count, degree);
  const ColourMeter meter(scene.wavelengths().grid());
  const std::size_t terms = cloud.coefficients();
  std::vector<std::uint32_t> lost(options.count, 0);
  for_ranges(
      options.count,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Path> paths(kBatch);
        std::vector<float> aovs(kBatch * std::max<std::size_t>(1, integrator.aov_names().size()));
        std::vector<Splat> splats;
        std::vector<Vec3> colors(std::size_t(options.paths)), directions(colors.size());
        for (std::size_t i = begin; i < end; ++i) {
          std::size_t k;
          float density;
          choice.sample((float(i) + 0.5f) / float(options.count), &density, &k);
          const auto point = patches[k].sampler->sample_area(patches[k].patch, even_place_2d(i));
          const Vec3 p = point ? point->p : Vec3{}, n = point ? point->ng : Vec3{0, 0, 1};
          const Frame frame = Frame::from_normal(n);
          const std::uint64_t key = combine_bits(combine_bits(options.seed, 0xBA4E), i);
          const int count = point ? options.paths : 0;
          Vec3 sum;
          int found = 0;
          for (int first = 0; first < count; first += kBatch) {
            const int together = std::min(kBatch, count - first);
            for (int j = 0; j < together; ++j) {
              Path& path = paths[std::size_t(j)];
              path = Path();
              path.samples = SampleStream(scene.sensor().sampler(), key, std::uint32_t(first + j));
              path.wavelengths = scene.wavelengths().sample(path.samples.get1(SampleStream::kWavelengthSet),
                                                            path.samples.get1(SampleStream::kHero));
              // Directions are uniform in solid angle; directions at grazing angles are left out.
              const Vec2 u = path.samples.get2(SampleStream::kFilm);
              const float z = 0.05f + 0.95f * u.x, r = std::sqrt(1 - z * z), phi = 2 * kPi * u.y;
              const Vec3 d = frame.to_world({r * std::cos(phi), r * std::sin(phi), z});
              directions[std::size_t(first + j)] = d;
              path.ray = {p + d * (0.5f * spacing), -d, kInfinity};
              path.aovs = aovs.data() + std::size_t(j) * (aovs.size() / kBatch);
              path.samples.set_first(SampleStream::camera_dimensions(false));
            }
            splats.clear();
            integrator.estimate(scene, {paths.data(), std::size_t(together)}, splats, {});
            for (int j = 0; j < together; ++j) {
              const Path& path = paths[std::size_t(j)];
              if (!is_finite(path.result.estimate)) {
                directions[std::size_t(first + j)] = {};
                continue;
              }
              float rgb[3];
              meter.rgb(path.result.estimate, path.wavelengths, rgb);
              const Vec3 c = Vec3{rgb[0], rgb[1], rgb[2]} * options.exposure;
              colors[std::size_t(first + j)] = c;
              sum += c, ++found;
            }
          }
          lost[i] = std::uint32_t(count - found) + (point ? 0 : 1);
          float* h = &cloud.harmonics[3 * terms * i];
          std::fill_n(h, 3 * terms, 0.f);
          if (degree > 0 && found > 0) {
            float functions[16];
            HarmonicFit linear(terms), encodes(terms);
            for (int j = 0; j < count; ++j) {
              const Vec3& d = directions[std::size_t(j)];
              if (d == Vec3{}) continue;
              eval_harmonics(degree, -d, functions);  // harmonics of the direction in which the camera looks
              linear.add(functions, colors[std::size_t(j)]);
            }
            std::vector<float> fit(3 * terms);
            linear.solve(fit.data());
            for (int j = 0; j < count; ++j) {
              const Vec3& d = directions[std::size_t(j)];
              if (d == Vec3{}) continue;
              eval_harmonics(degree, -d, functions);
              encodes.add(functions, encoded(harmonic_color(fit.data(), functions, terms)));
            }
            encodes.solve(h);
          } else {
            const Vec3 mean = found > 0 ? encoded(sum * (1 / float(found))) : Vec3{};
            for (int c = 0; c < 3; ++c) h[c] = (mean[c] - 0.5f) / kHarmonic0;
          }
          cloud.positions[i] = p;
          const float z = std::max(-0.999999f, n.z), w = std::sqrt(0.5f * (1 + z));
          cloud.rotations[i] = {w, -n.y / (2 * w), n.x / (2 * w), 0};
          const float norm = std::sqrt(w * w + (n.x * n.x + n.y * n.y) / (4 * w * w));
          for (float& q : cloud.rotations[i]) q /= norm;
          cloud.opacities[i] = options.as_points ? 1.f : 0.95f;
          const float radius = spacing * (options.as_points ? 0.8f : options.coverage);
          cloud.scales[i] = {radius, radius, options.as_points ? 0.f : 0.1f * radius};
        }
      },
      64);
  std::size_t all_lost = 0;
  for (const std::uint32_t n : lost) all_lost += n;
  if (all_lost > 0)
    bake.notes.push_back(fmt::format("{} paths had no finite light and are left out", all_lost));
  return bake;
}

}  // namespace aureole
