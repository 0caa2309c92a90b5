// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/table_writers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/instrument/measured/sheet_estimate.h"

namespace aureole {
namespace {

Vec3 direction_by_angles(double theta_degrees, double phi_degrees) {
  const double theta = theta_degrees * kDegree, phi = phi_degrees * kDegree;
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

}  // namespace

std::string klems_file_content(const ScatteringProbe& probe, const KlemsWriterSettings& s) {
  const auto& bases = known_angle_bases();
  const auto basis =
      std::find_if(bases.begin(), bases.end(), [&](const AngleBasis& b) { return b.name == s.basis; });
  if (basis == bases.end()) throw Error("unknown angle basis \"" + s.basis + "\"");
  const KlemsPatches patches(*basis);
  const std::size_t n = patches.count();
  const DirectionPatches all{n, [&](std::size_t k, Vec2 u) { return patches.sample(k, u); },
                             [&](const Vec3& d) { return std::size_t(patches.at(d.x, d.y, d.z)); },
                             [&](std::size_t k) { return double(patches.projected_solid_angle(k)); }};
  const SheetScattering found =
      estimate_sheet(probe, all, all, s.samples, std::max(s.samples / 4, 1), false, s.is_reciprocal);
  std::string data = fmt::format(
      "\t\t<IncidentDataStructure>Columns</IncidentDataStructure>\n\t\t<AngleBasis>\n\t\t\t<AngleBasisName>{}</AngleBasisName>\n",
      basis->name);
  for (const AngleBasis::Ring& r : basis->rings)
    data += fmt::format(
        "\t\t\t<AngleBasisBlock>\n\t\t\t\t<Theta>{:g}</Theta>\n\t\t\t\t<nPhis>{}</nPhis>\n\t\t\t\t<ThetaBounds>\n"
        "\t\t\t\t\t<LowerTheta>{:g}</LowerTheta>\n\t\t\t\t\t<UpperTheta>{:g}</UpperTheta>\n\t\t\t\t</ThetaBounds>\n"
        "\t\t\t</AngleBasisBlock>\n",
        r.lower == 0 ? 0.0 : 0.5 * (r.lower + r.upper), r.azimuths, r.lower, r.upper);
  std::string text = window_file_head(s.name, s.manufacturer, data + "\t\t</AngleBasis>\n");
  const std::string names = fmt::format(
      "\t\t\t<ColumnAngleBasis>{0}</ColumnAngleBasis>\n\t\t\t<RowAngleBasis>{0}</RowAngleBasis>\n",
      basis->name);
  const auto add = [&](const char* direction, const char* kind, const std::vector<double>& f) {
    std::string numbers;
    for (std::size_t o = 0; o < n; ++o)
      for (std::size_t i = 0; i < n; ++i)
        numbers += fmt::format("{:.4e}{}", f[i * n + o], i + 1 < n ? " " : "\n");
    text += window_file_block(names, direction, kind, numbers);
  };
  add("Transmission Front", "BTDF", found.f[3]);
  add("Transmission Back", "BTDF", found.f[1]);
  add("Reflection Front", "BRDF", found.f[2]);
  add("Reflection Back", "BRDF", found.f[0]);
  return text + kWindowFileEnd;
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
