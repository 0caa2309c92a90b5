// SPDX-License-Identifier: Apache-2.0
// Solid angles, glare and mesopic vision. aureole/_radiometry.py checks the arguments and shapes the results.
#include <vector>

#include "aureole/optics/photometry/glare.h"
#include "aureole/optics/photometry/solid_angle.h"
#include "bindings.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {

namespace {

using optics::Point3;

Point3 point_at(const double* row) { return {row[0], row[1], row[2]}; }

/// Fills rows of two results for rows of `width` numbers.
template <class F>
void fill_solid_angles(const char* name, const Array<const double, 2>& rows, std::size_t width,
                       const Array<double, 2>& result, const F& f) {
  const std::size_t n = rows.shape(0);
  require_size(rows.shape(1) == width && result.shape(0) == n && result.shape(1) == 2, name);
  const double* from = rows.data();
  double* to = result.data();
  naming(name, [&] {
    for_each(n, [=](std::size_t i) {
      const optics::SolidAngles s = f(from + i * width);
      to[2 * i] = s.solid, to[2 * i + 1] = s.projected;
    });
    return 0;
  });
}

}  // namespace

void bind_radiometry(nb::module_& m) {
  m.def(
      "sphere_solid_angles",
      [](const Array<const double, 2>& rows, const Array<double, 2>& result) {
        fill_solid_angles("sphere", rows, 7, result, [](const double* r) {
          return optics::sphere_solid_angle(point_at(r), r[3], point_at(r + 4));
        });
      },
      nb::arg("rows"), nb::arg("result").noconvert(), "Rows: centre from the observer, radius, normal.");
  m.def(
      "disc_solid_angles",
      [](const Array<const double, 2>& rows, const Array<double, 2>& result) {
        fill_solid_angles("disc", rows, 10, result, [](const double* r) {
          return optics::disc_solid_angle(point_at(r), point_at(r + 3), r[6], point_at(r + 7));
        });
      },
      nb::arg("rows"), nb::arg("result").noconvert(),
      "Rows: centre from the observer, axis, radius, normal.");
  m.def(
      "polygon_solid_angles",
      [](const Array<const double, 2>& corners, const Array<const double, 2>& rows,
         const Array<double, 2>& result) {
        require_size(corners.shape(1) == 3, "polygon");
        const std::size_t count = corners.shape(0);
        const double* at = corners.data();
        fill_solid_angles("polygon", rows, 6, result, [=](const double* r) {
          std::vector<Point3> seen;
          for (std::size_t k = 0; k < count; ++k)
            seen.push_back({at[3 * k] - r[0], at[3 * k + 1] - r[1], at[3 * k + 2] - r[2]});
          return optics::polygon_solid_angle(seen, point_at(r + 3));
        });
      },
      nb::arg("corners"), nb::arg("rows"), nb::arg("result").noconvert(), "Rows: observer, normal.");
  m.def(
      "mesopic_luminances",
      [](const Reals& photopic, const Reals& ratio, const Array<double, 2>& result) {
        const std::size_t n = photopic.size();
        require_size(ratio.size() == n && result.shape(0) == n && result.shape(1) == 2, "mesopic_luminances");
        const double *l = photopic.data(), *s = ratio.data();
        double* to = result.data();
        naming("photopic", [&] {
          for_each(n, [=](std::size_t i) {
            const optics::MesopicLuminance found = optics::mesopic_luminance(l[i], s[i]);
            to[2 * i] = found.luminance, to[2 * i + 1] = found.m;
          });
          return 0;
        });
      },
      nb::arg("photopic"), nb::arg("ratio"), nb::arg("result").noconvert());
  m.def(
      "unified_glare_rating",
      [](double background, const Array<const double, 2>& sources) {
        require_size(sources.shape(1) == 3, "unified_glare_rating");
        std::vector<optics::GlareSource> list;
        for (std::size_t i = 0; i < sources.shape(0); ++i)
          list.push_back({sources.data()[3 * i], sources.data()[3 * i + 1], sources.data()[3 * i + 2]});
        return naming("background", [&] { return optics::unified_glare_rating(background, list); });
      },
      nb::arg("background"), nb::arg("sources"), "Rows of sources: luminance, solid angle, position index.");
}

}  // namespace aureole::python
