// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/sheet_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

}  // namespace

SheetScattering estimate_sheet(const ScatteringProbe& probe, const DirectionPatches& incident,
                               const DirectionPatches& outgoing, int samples, int even, bool prefers_even) {
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
        const auto sample = probe.bsdf().sample(wi, van_der_corput(std::uint32_t(k)), {u[2], u[3]},
                                                {w, point, TransportMode::radiance, key(k)});
        if (!sample || !(mean(sample->pdf) > 0)) continue;
        const bool transmitted = (sample->wo.z > 0) != (wi.z > 0);
        const std::size_t o = outgoing.at({sample->wo.x, sample->wo.y, std::abs(sample->wo.z)});
        if (o >= m) continue;
        const double value = double(mean(sample->value)), density = samples * double(mean(sample->pdf));
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
            const BsdfEval e = probe.bsdf().eval_pdf(wi, wo, {w, point, TransportMode::radiance, key(k)});
            const double value = double(mean(e.value)), density = even_density(o, wo.z);
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
