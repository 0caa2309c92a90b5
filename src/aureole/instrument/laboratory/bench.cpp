// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/wavelength_steps.h"
#include "aureole/render/job.h"

namespace aureole {

double Readings::mean(std::size_t detector, std::size_t band) const {
  double sum = 0;
  for (std::size_t r = 0; r < replicates_; ++r) sum += at(r, detector, band);
  return sum / double(replicates_);
}

Readings Readings::averaged() const {
  Readings one(replicates_, 1, bands_);
  for (std::size_t r = 0; r < replicates_; ++r)
    for (std::size_t d = 0; d < detectors_; ++d)
      for (std::size_t b = 0; b < bands_; ++b) one.at(r, 0, b) += at(r, d, b) / double(detectors_);
  return one;
}

Ratio ratio_of(const Readings& over, std::size_t detector, const Readings& under, std::size_t under_detector,
               std::size_t band) {
  const std::size_t n = over.replicates();
  const double a = over.mean(detector, band), b = under.mean(under_detector, band);
  if (a == 0 && b == 0) return {};
  Ratio ratio{a / b, 0};
  double squares = 0;
  for (std::size_t r = 0; r < n; ++r) {
    const double residual =
        (over.at(r, detector, band) - ratio.value * under.at(r, under_detector, band)) / b;
    squares += residual * residual;
  }
  ratio.error = n > 1 ? std::sqrt(squares / (double(n) * double(n - 1))) : INFINITY;
  return ratio;
}

Bands bands_over(const std::vector<double>& range, const SpectralGrid& grid, double step, double usual_step,
                 double bandwidth) {
  if (range.size() != 2 || !(range[0] > 0 && range[1] >= range[0]))
    throw Error("--range: two wavelengths in nm are expected, as in 400,700");
  Bands bands;
  if (range[1] > range[0]) {
    SpectralGrid measured = grid;
    measured.min_nm = range[0], measured.max_nm = range[1];
    bands.nm = wavelength_steps(measured, step, usual_step);
  } else {
    bands.nm = {range[0]};
  }
  bands.width_nm = bandwidth > 0 ? bandwidth : bands.nm.size() > 1 ? bands.nm[1] - bands.nm[0] : 10;
  return bands;
}

Bench::Bench(const SpectralGrid& grid, double length_unit_m, Bands bands, TraceSettings settings)
    : grid_(grid), length_unit_m_(length_unit_m), bands_(std::move(bands)), settings_(settings) {
  if (bands_.nm.empty()) throw Error("there is no wavelength to measure");
  if (!(bands_.width_nm > 0 && bands_.width_nm <= 0.5 * (grid_.max_nm - grid_.min_nm)))
    throw Error(
        fmt::format("a bandwidth of {:g} nm: more than 0 and at most half of the scene's range is expected",
                    bands_.width_nm));
  for (std::size_t i = 0; i < bands_.nm.size(); ++i) {
    if (i > 0 && !(bands_.nm[i] > bands_.nm[i - 1])) throw Error("wavelengths must increase");
    if (!(bands_.nm[i] >= grid_.min_nm && bands_.nm[i] <= grid_.max_nm))
      throw Error(fmt::format("{:g} nm is outside of the scene's wavelengths, {:g} to {:g} nm", bands_.nm[i],
                              grid_.min_nm, grid_.max_nm));
  }
  if (bands_.nm.front() - bands_.width_nm < grid_.min_nm || bands_.nm.back() + bands_.width_nm > grid_.max_nm)
    notes_.push_back(fmt::format("slit functions are cut where the scene's wavelengths end, {:g} and {:g} nm",
                                 grid_.min_nm, grid_.max_nm));
  constexpr std::int64_t kMostPaths = std::int64_t(1) << 40;
  if (settings_.replicates < 2 || settings_.replicates > 1024 || settings_.paths < settings_.replicates ||
      settings_.paths > kMostPaths)
    throw Error(fmt::format("{} paths: at least one for each of {} replicates is expected", settings_.paths,
                            settings_.replicates));
}

std::string Bench::length(double metres) const { return fmt::format("{:.9g}", metres / length_unit_m_); }

std::string Bench::film(std::size_t detectors) const {
  std::string bands;
  for (std::size_t i = 0; i < bands_.nm.size(); ++i) {
    const double centre = bands_.nm[i], low = centre - bands_.width_nm, high = centre + bands_.width_nm;
    const auto cut = [&](double end) {
      const double inside = std::clamp(end, grid_.min_nm, grid_.max_nm);
      return std::pair(inside, 1 - std::abs(inside - centre) / bands_.width_nm);
    };
    const auto [a, at_a] = cut(low);
    const auto [b, at_b] = cut(high);
    std::string points;
    if (a < centre) points += fmt::format("{:.9g}:{:.9g}, ", a, std::max(at_a, 0.0));
    points += fmt::format("{:.9g}:1", centre);
    if (b > centre) points += fmt::format(", {:.9g}:{:.9g}", b, std::max(at_b, 0.0));
    bands += fmt::format("<spectrum name=\"band{}\" value=\"{}\"/>", i, points);
  }
  const std::int64_t samples = (settings_.paths + settings_.replicates - 1) / settings_.replicates;
  return fmt::format(
      "<film type=\"specfilm\"><integer name=\"width\" value=\"{}\"/><integer name=\"height\" value=\"1\"/>"
      "<float name=\"wavelength_min\" value=\"{:.17g}\"/><float name=\"wavelength_max\" value=\"{:.17g}\"/>"
      "<string name=\"component_format\" value=\"float32\"/><rfilter type=\"box\"/>{}</film>"
      "<sampler type=\"sobol\"><integer name=\"sample_count\" value=\"{}\"/></sampler>",
      detectors, grid_.min_nm, grid_.max_nm, bands,
      (samples + kSampleBlock - 1) / kSampleBlock * kSampleBlock);
}

Readings Bench::trace(const std::string& content, const std::map<std::string, ObjectPtr>& given,
                      std::size_t detectors, const char* integrator) const {
  LoadOptions load;
  load.given = given;
  const LoadedScene loaded = load_scene_from_string(
      fmt::format("<scene version=\"3.0.0\"><string name=\"length_unit\" value=\"{:.17g}m\"/>"
                  "<integrator type=\"{}\"><integer name=\"rr_depth\" value=\"16\"/></integrator>{}</scene>",
                  length_unit_m_, integrator, content),
      "instrument", load);
  RenderOptions options;
  options.seed = settings_.seed, options.threads = settings_.threads,
  options.replicates = settings_.replicates;
  RenderJob job(loaded, options);
  static const std::atomic<bool> kNever{false};
  if (job.run(settings_.stop ? *settings_.stop : kNever) == RenderJob::Outcome::interrupted)
    throw Error("interrupted: nothing is written");
  if (job.state().invalid_samples > 0)
    throw Error(fmt::format("{} samples of the instrument were not finite: the material is at fault",
                            job.state().invalid_samples));
  Readings readings(std::size_t(settings_.replicates), detectors, bands_.nm.size());
  std::vector<double> measured(std::size_t(loaded.scene->film().measured_channels()));
  double alpha = 0;
  for (std::size_t r = 0; r < readings.replicates(); ++r)
    for (std::size_t d = 0; d < detectors; ++d) {
      job.state().mean(r, int(d), 0, measured.data(), &alpha);
      for (std::size_t b = 0; b < readings.bands(); ++b) readings.at(r, d, b) = measured[b];
    }
  return readings;
}

std::string matrix_text(const Transform& t) {
  std::string text;
  for (const auto& row : t.matrix())
    for (const double x : row) text += fmt::format("{:.12g} ", x);
  return text;
}

Transform facing(const std::array<double, 3>& origin, const std::array<double, 3>& normal) {
  const double l = std::hypot(normal[0], normal[1], normal[2]);
  const double z[3] = {normal[0] / l, normal[1] / l, normal[2] / l};
  // The local x axis is the world's +x, or +y where the normal is nearly along x, less its part along the normal.
  const int k = std::abs(z[0]) < 0.9999 ? 0 : 1;
  double x[3];
  for (int i = 0; i < 3; ++i) x[i] = (i == k ? 1 : 0) - z[k] * z[i];
  const double lx = std::hypot(x[0], x[1], x[2]);
  for (double& v : x) v /= lx;
  const double y[3] = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]};
  Transform::Matrix m{};
  for (std::size_t i = 0; i < 3; ++i) m[i] = {x[i], y[i], z[i], origin[i]};
  m[3] = {0, 0, 0, 1};
  return Transform(m);
}

}  // namespace aureole
