// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/sheet_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

/// kWavelengths wavelengths that halve, quarter and so on the visible light of D65: the mean over them is the luminance.
std::array<float, kWavelengths> visible_wavelengths(const SpectralGrid& grid) {
  const auto d65 = find_illuminant("D65");
  const Observer& observer = cie_1931_observer();
  std::vector<double> nm, cumulated;
  double sum = 0;
  for (std::size_t i = 0; i < observer.y.size(); ++i) {
    const double at = observer.start_nm + observer.step_nm * double(i);
    if (at < grid.min_nm || at > grid.max_nm) continue;
    sum += observer.y[i] * d65->at(at);
    nm.push_back(at), cumulated.push_back(sum);
  }
  if (!(sum > 0))
    throw Error("the scene's wavelengths hold nothing of the visible range, which a Klems file describes");
  std::array<float, kWavelengths> found{};
  for (std::size_t j = 0; j < kWavelengths; ++j) {
    const auto at =
        std::lower_bound(cumulated.begin(), cumulated.end(), (double(j) + 0.5) / kWavelengths * sum);
    found[j] = float(nm[std::size_t(at - cumulated.begin())]);
  }
  return found;
}

/// Points of an additive recurrence (M. Roberts 2018, the R sequences) in four dimensions.
std::array<float, 4> recurrent_numbers(std::size_t k) {
  std::array<float, 4> u;
  for (std::size_t axis = 0; axis < 4; ++axis) {
    constexpr double kSteps[4] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087,
                                  0.5385972572236101};
    const double x = 0.5 + kSteps[axis] * double(k);
    u[axis] = std::min(float(x - std::floor(x)), 0x1.fffffep-1f);
  }
  return u;
}

/// Van der Corput's sequence: the reversed bits of an index as a fraction. Among the first 2^n indices every
/// interval of 2^-n occurs once.
float van_der_corput(std::uint32_t k) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= (k >> bit & 1u) << (31 - bit);
  return std::min(float(reversed) * 0x1p-32f, 0x1.fffffep-1f);
}

/// Replaces both estimates of f between two directions, where the light travels either way, by their mean. Incident and outgoing
/// patches are those of one partition that has with each patch the one on the other side of the normal.
void average_reciprocal_pairs(const DirectionPatches& patches, SheetScattering& found) {
  const std::size_t n = patches.count;
  std::vector<std::size_t> opposite(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 d = patches.sample(k, {0.5f, 0.5f});
    opposite[k] = std::min(patches.at({-d.x, -d.y, d.z}), n - 1);
  }
  // Incident patches are rotated by 180 degrees. Transmitted light of one side is exchanged with that of the other.
  for (const auto& [there, back] : {std::pair{0, 0}, std::pair{2, 2}, std::pair{1, 3}})
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t o = 0; o < n; ++o) {
        double &a = found.f[std::size_t(there)][i * n + o],
               &b = found.f[std::size_t(back)][opposite[o] * n + opposite[i]];
        a = b = 0.5 * (a + b);
      }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

}  // namespace

SheetScattering estimate_sheet(const ScatteringProbe& probe, const DirectionPatches& incident,
                               const DirectionPatches& outgoing, int samples, int even, bool prefers_even,
                               bool is_reciprocal) {
  const std::size_t n = incident.count, m = outgoing.count;
  const std::array<float, kWavelengths> visible = visible_wavelengths(probe.grid());
  const bool transmits = has(probe.bsdf().lobes(), Lobe::transmit);
  SheetScattering found;
  found.outgoing = m;
  for (auto& f : found.f) f.resize(n * m);
  const SurfacePoint point;
  const auto estimate_patch = [&](std::size_t job) {
    const std::size_t side = job / n, i = job % n;
    const auto prepare = [&](int k, Vec3& wi) {
      const std::array<float, 4> u = recurrent_numbers(std::size_t(k));
      const Vec3 in = incident.sample(i, {u[0], u[1]});
      // Incident patches are rotated by 180 degrees about the normal.
      wi = {-in.x, -in.y, side == 0 ? in.z : -in.z};
      // Each wavelength is the hero of equally many samples.
      return Wavelengths::at(
          probe.grid(), make_spectrum([&](int j) { return visible[std::size_t(j + k) % kWavelengths]; }));
    };
    const auto key = [&](int k) { return std::uint32_t(job * 7919 + std::size_t(k)); };
    const auto row = [&](bool transmitted) {
      return found.f[2 * side + transmitted].begin() + std::ptrdiff_t(i * m);
    };
    const auto add = [&](bool transmitted, std::size_t o, double value) {
      row(transmitted)[std::ptrdiff_t(o)] += value / outgoing.projected(o);
    };
    // f |cos theta_o| of one direction of the light, or the mean of both.
    const auto value_of = [&](const Vec3& wi, const Vec3& wo, const Spectrum& forward,
                              const BsdfContext& ctx) {
      if (!probe.makes_reciprocal()) return double(mean(forward));
      const double backward = double(mean(probe.bsdf().eval(wo, wi, ctx))) * double(std::abs(wo.z / wi.z));
      return 0.5 * (double(mean(forward)) + backward);
    };
    const auto even_density = [&](std::size_t o, float cosine) {
      return even * std::abs(double(cosine)) / outgoing.projected(o);
    };
    // Samples of the BSDF find narrow and delta lobes. Returns the light of the others, whether they are added or not.
    const auto add_samples = [&](bool only_delta) {
      double light = 0;
      for (int k = 0; k < samples; ++k) {
        Vec3 wi;
        const Wavelengths w = prepare(k, wi);
        const std::array<float, 4> u = recurrent_numbers(std::size_t(k));
        const BsdfContext ctx{w, point, TransportMode::radiance, key(k)};
        const auto sample = probe.bsdf().sample(wi, van_der_corput(std::uint32_t(k)), {u[2], u[3]}, ctx);
        if (!sample || !(mean(sample->pdf) > 0)) continue;
        const bool transmitted = (sample->wo.z > 0) != (wi.z > 0);
        const std::size_t o = outgoing.at({sample->wo.x, sample->wo.y, std::abs(sample->wo.z)});
        if (o >= m) continue;
        const double value = sample->is_delta() ? double(mean(sample->value))
                                                : value_of(wi, sample->wo, sample->value, ctx),
                     density = samples * double(mean(sample->pdf));
        if (!sample->is_delta()) light += value / density;
        if (only_delta && !sample->is_delta()) continue;
        add(transmitted, o, value / (density + (sample->is_delta() ? 0 : even_density(o, sample->wo.z))));
      }
      return light;
    };
    // Directions that are even in each outgoing patch keep the noise of wide lobes low. Returns their light.
    const auto add_even = [&](bool alone) {
      double light = 0;
      for (const bool transmitted : {false, true}) {
        if (transmitted && !transmits) continue;
        for (std::size_t o = 0; o < m; ++o)
          for (int k = 0; k < even; ++k) {
            Vec3 wi;
            const Wavelengths w = prepare(int(o) * 17 + k, wi);
            const std::array<float, 4> u = recurrent_numbers(o * 17 + std::size_t(k));
            Vec3 wo = outgoing.sample(o, {u[2], u[3]});
            if ((wi.z > 0) == transmitted) wo.z = -wo.z;
            if (wo.z == 0) continue;
            const BsdfContext ctx{w, point, TransportMode::radiance, key(k)};
            const BsdfEval e = probe.bsdf().eval_pdf(wi, wo, ctx);
            const double value = value_of(wi, wo, e.value, ctx), density = even_density(o, wo.z);
            if (!(value > 0)) continue;
            light += value / density;
            add(transmitted, o, value / (density + (alone ? 0 : samples * double(mean(e.pdf)))));
          }
      }
      return light;
    };
    if (!probe.bsdf().is_smooth()) {
      add_samples(false);
      return;
    }
    if (prefers_even) {
      const double by_even = add_even(true), by_samples = add_samples(true);
      if (std::abs(by_even - by_samples) <= 0.03 * by_samples) return;
      for (const bool transmitted : {false, true})
        std::fill(row(transmitted), row(transmitted) + std::ptrdiff_t(m), 0.0);
    }
    add_samples(false), add_even(false);
  };
  for_ranges(
      2 * n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t job = begin; job < end; ++job) probe.check_stop(), estimate_patch(job);
      },
      1);
  if ((is_reciprocal || probe.makes_reciprocal()) && n == m) average_reciprocal_pairs(outgoing, found);
  return found;
}

std::string window_file_head(const std::string& name, const std::string& manufacturer,
                             const std::string& data) {
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Created by: aureole convert-bsdf -->\n"
      "<WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n<WindowElementType>System</WindowElementType>\n"
      "<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\t<Material>\n\t\t<Name>{}</Name>\n\t\t<Manufacturer>{}</Manufacturer>\n"
      "\t\t<DeviceType>Other</DeviceType>\n\t</Material>\n\t<DataDefinition>\n{}\t</DataDefinition>\n",
      escaped(name), escaped(manufacturer), data);
}

std::string window_file_block(const std::string& bases, const std::string& direction, const std::string& kind,
                              const std::string& numbers) {
  return fmt::format(
      "\t<WavelengthData>\n\t\t<LayerNumber>System</LayerNumber>\n\t\t<Wavelength unit=\"Integral\">Visible</Wavelength>\n"
      "\t\t<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n"
      "\t\t<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>\n"
      "\t\t<WavelengthDataBlock>\n\t\t\t<WavelengthDataDirection>{}</WavelengthDataDirection>\n{}"
      "\t\t\t<ScatteringDataType>{}</ScatteringDataType>\n\t\t\t<ScatteringData>\n{}"
      "\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>\n",
      direction, bases, kind, numbers);
}

}  // namespace aureole
