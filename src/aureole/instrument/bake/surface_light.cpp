// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/bake/surface_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

namespace {

/// The least-squares fit of harmonics to colours in directions, with the terms above degree 0 held small: the half of the
/// sphere behind the surface has no data.
class HarmonicFit {
public:
  explicit HarmonicFit(std::size_t terms)
      : terms_(terms), matrix_(terms * terms, 0.), right_(3 * terms, 0.) {}
  void add(const float* functions, const Vec3& color) {
    for (std::size_t i = 0; i < terms_; ++i) {
      for (std::size_t j = 0; j <= i; ++j)
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
    // Cholesky: the matrix is symmetric and positive definite, and its lower half is there.
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

Vec3 encoded_color(const Vec3& c) {
  return {srgb_encode(std::max(0.f, c.x)), srgb_encode(std::max(0.f, c.y)), srgb_encode(std::max(0.f, c.z))};
}

/// Point i of a sequence in [0, 1)^2 that fills the square evenly (generalised golden ratio, Roberts 2018).
Vec2 even_place_2d(std::size_t i) {
  const auto turn = [&](double by) { return float(std::fmod(0.5 + by * double(i + 1), 1.0)); };
  return {turn(0.7548776662466927), turn(0.5698402909980532)};
}

}  // namespace

SurfaceLight::SurfaceLight(const LoadedScene& loaded, float exposure, std::uint64_t seed, Density density)
    : loaded_(loaded), exposure_(exposure), seed_(seed), meter_(loaded.scene->wavelengths().grid()) {
  const Scene& scene = *loaded.scene;
  const Integrator& integrator = *loaded.integrator;
  if (integrator.leaves() != Integrator::Leaves::pixel)
    throw integrator.properties().error("",
                                        "light paths belong to no place on a surface: bake with \"path\"");
  integrator.require_scene(scene);
  std::vector<float> weights;
  const FilmPart& film = scene.sensor().part;
  const Vec3 eye =
      density == Density::camera
          ? scene.sensor().sample_ray({film.left + 0.5f * film.width, 0.5f * film.height}, {0.5f, 0.5f}).ray.o
          : Vec3{};
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
      samplers_.push_back(surface.shape->make_area_sampler(AreaUse::sensor));
    } catch (const Error&) {
      ++others;
      continue;
    }
    for (std::size_t k = 0; k < samplers_.back()->patch_count(); ++k)
      if (const float area = samplers_.back()->patch_area(k); area > 0) {
        patches_.push_back({samplers_.back().get(), k, area, {}});
        weights.push_back(density == Density::camera ? float(weigh_by_distance(patches_.back(), eye)) : area);
        area_ += double(area);
      }
  }
  if (null_surfaces > 0)
    notes_.push_back(fmt::format("{} surfaces that pass light unchanged are left out", null_surfaces));
  if (others > 0)
    notes_.push_back(
        fmt::format("{} shapes whose area cannot be sampled, such as instances, are left out", others));
  if (patches_.empty()) throw Error("the scene has no surface to bake");
  if (scene.has_media()) notes_.push_back("media are left out: their light is baked on surfaces alone");
  choice_ = Piecewise1D(weights);
}

double SurfaceLight::weigh_by_distance(Patch& patch, const Vec3& eye) {
  // Cells of a quarter of the distance from the eye, as far as the patch has some.
  const auto at = [&](Vec2 u) {
    const auto found = patch.sampler->sample_area(patch.patch, u);
    return found ? length(found->p - eye) : kInfinity;
  };
  const float size = std::sqrt(patch.area);
  float nearest = kInfinity;
  constexpr int kProbes = 8, kMostCells = 256;
  for (int k = 0; k < kProbes * kProbes; ++k)
    nearest =
        std::min(nearest, at({(float(k % kProbes) + 0.5f) / kProbes, (float(k / kProbes) + 0.5f) / kProbes}));
  const float closest = std::max(nearest - size / kProbes, 0.02f * nearest);
  const int cells = std::clamp(int(std::ceil(4 * size / std::max(closest, 1e-20f))), 1, kMostCells);
  std::vector<float> weights(std::size_t(cells) * std::size_t(cells));
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const float distance = at({(float(i % std::size_t(cells)) + 0.5f) / float(cells),
                               (float(i / std::size_t(cells)) + 0.5f) / float(cells)});
    // Within a cell the density is that of its middle; it is bounded where the eye lies in it.
    const float bounded = std::max(distance, 0.5f * size / float(cells));
    weights[i] = std::isfinite(bounded) && bounded > 0 ? 1 / (bounded * bounded) : 0;
    sum += double(weights[i]);
  }
  if (cells > 1 && sum > 0) patch.within = Piecewise2D(weights, cells, cells), patch.varies = true;
  return sum / double(weights.size()) * double(patch.area);
}

std::optional<SurfaceLight::Point> SurfaceLight::point(std::size_t i, std::size_t count) const {
  std::size_t k;
  float density;
  choice_.sample(std::min((float(i) + 0.5f) / float(count), 0x1.fffffep-1f), &density, &k);
  const Patch& patch = patches_[k];
  Vec2 place = even_place_2d(i);
  float within = 1;
  if (patch.varies) place = patch.within.sample(place, &within);
  const auto found = patch.sampler->sample_area(patch.patch, place);
  if (!found) return {};
  // The choice has a density over [0, 1) that is constant in each of its cells.
  const float per_area = float(count) * density / float(patches_.size()) * within / patch.area;
  return Point{found->p, found->ng, 1 / std::sqrt(per_area)};
}

void SurfaceLight::add_samples(const Point& point, std::uint64_t key, int first, int count, float start,
                               Samples& samples) const {
  const Scene& scene = *loaded_.scene;
  const Integrator& integrator = *loaded_.integrator;
  const Frame frame = Frame::from_normal(point.n);
  const std::uint64_t stream = combine_bits(combine_bits(seed_, 0xBA4E), key);
  const std::size_t channels = std::max<std::size_t>(1, integrator.aov_names().size());
  std::vector<Path> paths(kBatch);
  std::vector<float> aovs(kBatch * channels);
  std::vector<Splat> splats;
  Vec3 looks[kBatch];
  for (int begin = 0; begin < count; begin += kBatch) {
    const int together = std::min(kBatch, count - begin);
    for (int j = 0; j < together; ++j) {
      Path& path = paths[std::size_t(j)];
      path = Path();
      path.samples = SampleStream(scene.sensor().sampler(), stream, std::uint32_t(first + begin + j));
      path.wavelengths = scene.wavelengths().sample(path.samples.get1(SampleStream::kWavelengthSet),
                                                    path.samples.get1(SampleStream::kHero));
      // Directions are even in solid angle; those at grazing angles are left out.
      const Vec2 u = path.samples.get2(SampleStream::kFilm);
      const float z = 0.05f + 0.95f * u.x, r = std::sqrt(1 - z * z), phi = 2 * kPi * u.y;
      const Vec3 d = frame.to_world({r * std::cos(phi), r * std::sin(phi), z});
      looks[j] = -d;
      path.ray = {point.p + d * start, -d, kInfinity};
      path.aovs = aovs.data() + std::size_t(j) * channels;
      path.samples.set_first(SampleStream::camera_dimensions(false));
    }
    splats.clear();
    integrator.estimate(scene, {paths.data(), std::size_t(together)}, splats, {});
    for (int j = 0; j < together; ++j) {
      const Path& path = paths[std::size_t(j)];
      if (!is_finite(path.result.estimate)) {
        ++samples.lost;
        continue;
      }
      float rgb[3];
      meter_.rgb(path.result.estimate, path.wavelengths, rgb);
      samples.looks.push_back(looks[j]);
      samples.colors.push_back(Vec3{rgb[0], rgb[1], rgb[2]} * exposure_);
    }
  }
}

void fit_encoded_harmonics(int degree, const SurfaceLight::Samples& samples, float* out) {
  const std::size_t terms = std::size_t((degree + 1) * (degree + 1)), count = samples.looks.size();
  std::fill_n(out, 3 * terms, 0.f);
  if (degree == 0 || count == 0) {
    Vec3 sum;
    for (const Vec3& c : samples.colors) sum += c;
    const Vec3 mean = count > 0 ? encoded_color(sum * (1 / float(count))) : Vec3{};
    for (int c = 0; c < 3; ++c) out[c] = (mean[c] - 0.5f) / kHarmonic0;
    return;
  }
  float functions[16];
  HarmonicFit linear(terms), encoded(terms);
  for (std::size_t j = 0; j < count; ++j) {
    eval_harmonics(degree, samples.looks[j], functions);
    linear.add(functions, samples.colors[j]);
  }
  std::vector<float> fit(3 * terms);
  linear.solve(fit.data());
  for (std::size_t j = 0; j < count; ++j) {
    eval_harmonics(degree, samples.looks[j], functions);
    encoded.add(functions, encoded_color(harmonic_color(fit.data(), functions, terms)));
  }
  encoded.solve(out);
}

}  // namespace aureole
