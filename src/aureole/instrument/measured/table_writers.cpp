// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/table_writers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

Vec3 direction_by_angles(double theta_degrees, double phi_degrees) {
  const double theta = theta_degrees * kDegree, phi = phi_degrees * kDegree;
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

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

void append_klems_block(std::string& text, const std::string& basis, const char* direction, const char* kind,
                        const std::vector<double>& matrix, std::size_t count) {
  text += fmt::format(
      "\t<WavelengthData>\n\t\t<LayerNumber>System</LayerNumber>\n\t\t<Wavelength unit=\"Integral\">Visible</Wavelength>\n"
      "\t\t<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n"
      "\t\t<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>\n"
      "\t\t<WavelengthDataBlock>\n\t\t\t<WavelengthDataDirection>{0}</WavelengthDataDirection>\n"
      "\t\t\t<ColumnAngleBasis>{1}</ColumnAngleBasis>\n\t\t\t<RowAngleBasis>{1}</RowAngleBasis>\n"
      "\t\t\t<ScatteringDataType>{2}</ScatteringDataType>\n\t\t\t<ScatteringData>\n",
      direction, basis, kind);
  for (std::size_t o = 0; o < count; ++o) {
    for (std::size_t i = 0; i < count; ++i)
      text += fmt::format("{:.4e}{}", matrix[i * count + o], i + 1 < count ? " " : "\n");
  }
  text += "\t\t\t</ScatteringData>\n\t\t</WavelengthDataBlock>\n\t</WavelengthData>\n";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

}  // namespace

std::string klems_file_content(const ScatteringProbe& probe, const KlemsWriterSettings& s) {
  const auto& bases = known_angle_bases();
  const auto basis =
      std::find_if(bases.begin(), bases.end(), [&](const AngleBasis& b) { return b.name == s.basis; });
  if (basis == bases.end()) throw Error("unknown angle basis \"" + s.basis + "\"");
  const KlemsPatches patches(*basis);
  const std::size_t n = patches.count();
  const std::array<float, kWavelengths> visible = visible_wavelengths(probe.grid());
  // matrices by index 2 side + transmitted, each by incident and outgoing patch
  std::array<std::vector<double>, 4> matrices;
  for (auto& m : matrices) m.resize(n * n);
  const SurfacePoint point;
  for_ranges(
      2 * n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t job = begin; job < end; ++job) {
          const std::size_t side = job / n, i = job % n;
          // Both techniques are combined by the balance heuristic: samples of the BSDF find narrow and delta lobes, and
          // directions that are even in each outgoing patch keep the noise of wide lobes low.
          const int even = std::max(s.samples / 4, 1);
          const auto prepare = [&](int k, Vec3& wi) {
            const std::array<float, 4> u = recurrent_numbers(std::size_t(k));
            const Vec3 in = patches.sample(i, {u[0], u[1]});
            // Incident patches are rotated by 180 degrees about the normal.
            wi = {-in.x, -in.y, side == 0 ? in.z : -in.z};
            // Each wavelength is the hero of equally many samples.
            return Wavelengths::at(probe.grid(), make_spectrum([&](int j) {
                                     return visible[std::size_t(j + k) % kWavelengths];
                                   }));
          };
          const auto key = [&](int k) { return std::uint32_t(job * 7919 + std::size_t(k)); };
          const auto add = [&](bool transmitted, std::size_t o, double value) {
            matrices[2 * side + transmitted][i * n + o] += value / patches.projected_solid_angle(o);
          };
          const auto even_density = [&](std::size_t o, float cosine) {
            return even * std::abs(double(cosine)) / patches.projected_solid_angle(o);
          };
          for (int k = 0; k < s.samples; ++k) {
            Vec3 wi;
            const Wavelengths w = prepare(k, wi);
            const std::array<float, 4> u = recurrent_numbers(std::size_t(k));
            const auto sample = probe.bsdf().sample(wi, van_der_corput(std::uint32_t(k)), {u[2], u[3]},
                                                    {w, point, TransportMode::radiance, key(k)});
            if (!sample || !(mean(sample->pdf) > 0)) continue;
            const bool transmitted = (sample->wo.z > 0) != (wi.z > 0);
            const std::size_t o = patches.at(sample->wo.x, sample->wo.y, std::abs(sample->wo.z));
            if (o >= n) continue;
            const double density = s.samples * double(mean(sample->pdf)) +
                                   (sample->is_delta() ? 0 : even_density(o, sample->wo.z));
            add(transmitted, o, double(mean(sample->value)) / density);
          }
          if (!probe.bsdf().is_smooth()) continue;
          for (const bool transmitted : {false, true})
            for (std::size_t o = 0; o < n; ++o)
              for (int k = 0; k < even; ++k) {
                Vec3 wi;
                const Wavelengths w = prepare(int(o) * 17 + k, wi);
                const std::array<float, 4> u = recurrent_numbers(o * 17 + std::size_t(k));
                Vec3 wo = patches.sample(o, {u[2], u[3]});
                if ((wi.z > 0) == transmitted) wo.z = -wo.z;
                if (wo.z == 0) continue;
                const BsdfEval e = probe.bsdf().eval_pdf(wi, wo, {w, point, TransportMode::radiance, key(k)});
                const double value = double(mean(e.value));
                if (value > 0)
                  add(transmitted, o, value / (s.samples * double(mean(e.pdf)) + even_density(o, wo.z)));
              }
        }
      },
      1);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Created by: aureole convert-bsdf -->\n"
      "<WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
      "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n<WindowElementType>System</WindowElementType>\n"
      "<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\t<Material>\n\t\t<Name>{}</Name>\n\t\t<Manufacturer>{}</Manufacturer>\n"
      "\t\t<DeviceType>Other</DeviceType>\n\t</Material>\n\t<DataDefinition>\n"
      "\t\t<IncidentDataStructure>Columns</IncidentDataStructure>\n\t\t<AngleBasis>\n\t\t\t<AngleBasisName>{}</AngleBasisName>\n",
      escaped(s.name), escaped(s.manufacturer), basis->name);
  for (const AngleBasis::Ring& r : basis->rings)
    text += fmt::format(
        "\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{:g}</Theta>\n\t\t\t\t<nPhis>{}</nPhis>\n\t\t\t\t<ThetaBounds>\n"
        "\t\t\t\t\t<LowerTheta>{:g}</LowerTheta>\n\t\t\t\t\t<UpperTheta>{:g}</UpperTheta>\n\t\t\t\t</ThetaBounds>\n"
        "\t\t\t</AngleBasisBlock>\n",
        r.lower == 0 ? 0.0 : 0.5 * (r.lower + r.upper), r.azimuths, r.lower, r.upper);
  text += "\t\t</AngleBasis>\n\t</DataDefinition>\n";
  append_klems_block(text, basis->name, "Transmission Front", "BTDF", matrices[3], n);
  append_klems_block(text, basis->name, "Transmission Back", "BTDF", matrices[1], n);
  append_klems_block(text, basis->name, "Reflection Front", "BRDF", matrices[2], n);
  append_klems_block(text, basis->name, "Reflection Back", "BRDF", matrices[0], n);
  return text + "</Layer>\n</Optical>\n</WindowElement>\n";
}

std::string direction_table_content(const ScatteringProbe& probe, const DirectionTableSettings& s) {
  std::string text =
      "# f in 1/sr, without a cosine; angles in degrees from the normal; above 90: below the surface\n";
  text += fmt::format("theta_i,phi_i,theta_o,phi_o,{}nm\n", fmt::join(probe.nm(), "nm,"));
  std::vector<double> outgoing = s.outgoing;
  if (s.transmits)
    for (const double theta : s.outgoing)
      if (theta < 90) outgoing.push_back(180 - theta);
  struct Row {
    double theta_i, phi_i;
  };
  std::vector<Row> rows;
  for (const double phi : s.incident_azimuths)
    for (const double theta : s.incident) rows.push_back({theta, phi});
  std::vector<std::string> texts(rows.size());
  for_ranges(
      rows.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<double> f;
        for (std::size_t k = begin; k < end; ++k)
          for (const double theta : outgoing)
            for (const double azimuth : s.azimuths) {
              const bool is_pole = theta == 0 || theta == 180;
              if (is_pole && azimuth != s.azimuths.front()) continue;
              const double phi = is_pole ? 0 : std::fmod(rows[k].phi_i + azimuth, 360.0);
              probe.f(direction_by_angles(rows[k].theta_i, rows[k].phi_i), direction_by_angles(theta, phi),
                      f);
              texts[k] += fmt::format("{:g},{:g},{:g},{:g}", rows[k].theta_i, rows[k].phi_i, theta, phi);
              for (const double v : f) texts[k] += fmt::format(",{:.6g}", v);
              texts[k] += '\n';
            }
      },
      1);
  for (const std::string& t : texts) text += t;
  return text;
}

std::string zemax_file_content(const ScatteringProbe& probe, const ZemaxSettings& s) {
  std::string text =
      "# Made by aureole convert-bsdf; BSDF in 1/sr\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n";
  text += fmt::format(
      "ScatterType  {}\nSampleRotation  1\n0\nAngleOfIncidence  {}\n{:g}\nScatterAzimuth  {}\n{:g}\n"
      "ScatterRadial  {}\n{:g}\n\nMonochrome\nDataBegin\n",
      s.transmission ? "BTDF" : "BRDF", s.incident.size(), fmt::join(s.incident, "\t"), s.azimuths.size(),
      fmt::join(s.azimuths, "\t"), s.radial.size(), fmt::join(s.radial, "\t"));
  for (const double angle : s.incident) {
    const Vec3 wi = direction_by_angles(angle, 180);
    // The mirror direction is at azimuth 0; azimuths about it count from the direction towards the normal.
    const Vec3 pole = direction_by_angles(angle, 0);
    const Vec3 to_normal{-pole.z, 0, pole.x}, across{0, 1, 0};
    std::string values;
    double total = 0;
    for (std::size_t a = 0; a < s.azimuths.size(); ++a) {
      for (std::size_t r = 0; r < s.radial.size(); ++r) {
        const double azimuth = s.azimuths[a] * kDegree, radial = s.radial[r] * kDegree;
        const Vec3 out = pole * float(std::cos(radial)) +
                         (to_normal * float(std::cos(azimuth)) + across * float(std::sin(azimuth))) *
                             float(std::sin(radial));
        const bool is_above = out.z > 1e-4f;
        const double f = is_above ? probe.mean(wi, {out.x, out.y, s.transmission ? -out.z : out.z}) : 0;
        values += fmt::format("{:.6e}{}", f, r + 1 < s.radial.size() ? "\t" : "\n");
        // Total integrated scatter by the trapezoidal rule; azimuths cover half of the circle.
        const auto width = [](const std::vector<double>& x, std::size_t i) {
          return 0.5 * (x[std::min(i + 1, x.size() - 1)] - x[i > 0 ? i - 1 : 0]) * kDegree;
        };
        total += 2 * f * double(out.z) * std::sin(radial) * width(s.azimuths, a) * width(s.radial, r);
      }
    }
    text += fmt::format("TIS {:.6f}\n{}", total, values);
  }
  return text + "DataEnd\n";
}

}  // namespace aureole
