// SPDX-License-Identifier: Apache-2.0
// Scatterers found in microscope pictures. The public interface is in aureole/_microstructure.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/report/microstructure_report.h"
#include "bindings.h"
#include "picture.h"

namespace aureole::python {

namespace {

using Grey = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Seen = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// A picture as it was given: a file, or grey values.
struct Field {
  std::filesystem::path file;  ///< empty: `picture` has the values
  Micrograph picture;          ///< of a file its mask alone
};

std::vector<std::uint8_t> values_of(const Seen& mask) { return {mask.data(), mask.data() + mask.size()}; }

Field array_field(const std::string& name, const Grey& grey, double pixel_m,
                  const std::optional<Seen>& mask) {
  constexpr std::size_t kLargest = 1 << 16;
  if (grey.shape(0) > kLargest || grey.shape(1) > kLargest) throw Error(name + ": too large for a picture");
  Field f;
  f.picture.name = name, f.picture.pixel_m = pixel_m;
  f.picture.height = int(grey.shape(0)), f.picture.width = int(grey.shape(1));
  if (std::min(f.picture.width, f.picture.height) < kSmallestField)
    throw Error(name + ": expected at least " + std::to_string(kSmallestField) +
                " pixels on each side, got shape (" + std::to_string(f.picture.height) + ", " +
                std::to_string(f.picture.width) + ")");
  f.picture.grey.assign(grey.data(), grey.data() + grey.size());
  if (mask) f.picture.seen = values_of(*mask);
  return f;
}

Field file_field(const std::filesystem::path& file, double pixel_m, const std::optional<Seen>& mask) {
  Field f{file, {}};
  f.picture.pixel_m = pixel_m;
  if (mask) {
    f.picture.height = int(mask->shape(0)), f.picture.width = int(mask->shape(1));
    f.picture.seen = values_of(*mask);
  }
  return f;
}

/// The picture, with a mask that fits it and leaves enough.
Micrograph opened(const Field& f, bool srgb) {
  Micrograph m = f.picture;
  if (!f.file.empty()) {
    MicrographOptions options;
    options.pixel_m = f.picture.pixel_m, options.srgb = srgb;
    m = read_micrograph(f.file, options);
    if (f.picture.seen.empty()) return m;
    if (f.picture.width != m.width || f.picture.height != m.height)
      throw Error("mask: expected the shape of " + m.name + ", (" + std::to_string(m.height) + ", " +
                  std::to_string(m.width) + "), got (" + std::to_string(f.picture.height) + ", " +
                  std::to_string(f.picture.width) + ")");
    m.seen = f.picture.seen;
  } else if (m.seen.empty()) {
    return m;
  }
  if (m.seen.size() != m.grey.size()) throw Error("mask: expected the shape of " + m.name);
  const auto left = std::count(m.seen.begin(), m.seen.end(), 1);
  if (left < kSmallestField * kSmallestField)
    throw Error("mask: leaves " + std::to_string(left) + " pixels of " + m.name + ", too few");
  return m;
}

struct MicrostructureResult {
  Microstructure found;
  std::vector<std::shared_ptr<Picture>> overlays;
};

MicrostructureResult analyse(const std::vector<const Field*>& fields, const MicrostructureOptions& options,
                             bool srgb, bool overlays) {
  const Unlocked release;
  const auto read = [&](size_t i) {
    if (is_leaving()) throw Error("the program ends");  // seen by nobody: the thread stays in ~Unlocked
    {
      const nb::gil_scoped_acquire lock;
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    }
    return opened(*fields[i], srgb);
  };
  MicrostructureResult result;
  const auto visit = [&](const Micrograph& field, const Segmentation& s, const std::vector<Particle>& p) {
    if (!overlays) return;
    result.overlays.push_back(std::make_shared<Picture>());
    result.overlays.back()->image = overlay(field, s, p);
  };
  result.found = analyse_microstructure(fields.size(), read, options, visit);
  return result;
}

nb::tuple tuple_of(const Estimate& e) { return nb::make_tuple(e.value, e.low, e.high); }

nb::tuple tuple_of(const Microstructure::Curve& c) { return nb::make_tuple(c.x, c.value, c.error); }

nb::dict numbers(const Microstructure& m) {
  nb::dict d;
  d["covered_fraction"] = tuple_of(m.shape_fraction), d["area_fraction"] = tuple_of(m.area_fraction);
  d["density"] = tuple_of(m.density), d["correlation_radius"] = tuple_of(m.correlation_radius);
  d["mean_radius"] = tuple_of(m.mean_radius), d["radius_deviation"] = tuple_of(m.deviation);
  d["log_deviation"] = tuple_of(m.log_deviation);
  nb::dict quantiles;
  for (size_t i = 0; i < m.quantiles.size(); ++i)
    quantiles[nb::float_(kQuantiles[i])] = tuple_of(m.quantiles[i]);
  d["radius_quantiles"] = quantiles;
  d["round"] = m.round, d["circularity"] = m.circularity, d["aspect"] = m.aspect;
  d["pair_correlation"] = tuple_of(m.pair_correlation);
  d["structure_factor"] = tuple_of(m.structure_factor);
  std::vector<std::string> notes = m.notes;
  for (std::string& note : measured_material(m).notes) notes.push_back(std::move(note));
  d["notes"] = notes, d["choices"] = m.choices;
  nb::list fields;
  for (const FieldReport& f : m.fields) {
    nb::dict one;
    one["name"] = f.name, one["width"] = f.width, one["height"] = f.height, one["pixel_size"] = f.pixel_m;
    one["seen"] = f.seen_m2, one["whole"] = f.whole, one["cut"] = f.cut, one["too_small"] = f.too_small;
    one["bright"] = f.bright, one["polarity_score"] = f.polarity_score;
    one["noise"] = f.noise, one["blur"] = f.blur;
    fields.append(one);
  }
  d["fields"] = fields;
  return d;
}

/// The table of particles by columns, lengths in metres.
nb::dict particles(const Microstructure& m) {
  std::vector<int> field;
  std::vector<double> x, y, radius, area, circularity, aspect, angle;
  std::vector<bool> cut, touching;
  nb::list outlines;
  for (const Particle& p : m.particles) {
    const double s = m.fields[size_t(p.field)].pixel_m;
    field.push_back(p.field), x.push_back(p.x * s), y.push_back(p.y * s);
    radius.push_back(p.radius * s), area.push_back(p.area * s * s);
    circularity.push_back(p.circularity), aspect.push_back(p.aspect), angle.push_back(p.angle);
    cut.push_back(p.cut), touching.push_back(p.touching);
    std::vector<double> line;
    for (const auto& q : p.outline) line.push_back(q[0] * s), line.push_back(q[1] * s);
    outlines.append(line);
  }
  nb::dict d;
  d["field"] = field, d["x"] = x, d["y"] = y, d["radius"] = radius, d["area"] = area;
  d["circularity"] = circularity, d["aspect"] = aspect, d["angle"] = angle;
  d["cut"] = cut, d["touching"] = touching, d["weight"] = m.weights, d["outline"] = outlines;
  return d;
}

void save_result(const MicrostructureResult& r, const std::filesystem::path& path) {
  OutputFolder folder(path, "result.json");
  write_microstructure(r.found, folder);
  for (size_t i = 0; i < r.overlays.size(); ++i)
    write_png(folder.path("overlay-" + std::to_string(i) + ".png"), r.overlays[i]->image);
  folder.commit();
}

}  // namespace

void bind_microstructure(nb::module_& m) {
  nb::class_<Field>(m, "MicrographField", "A picture to be analysed.")
      .def_static("array", array_field, nb::arg("name"), nb::arg("grey"), nb::arg("pixel_m"),
                  nb::arg("mask").none())
      .def_static("file", file_field, nb::arg("file"), nb::arg("pixel_m"), nb::arg("mask").none());
  nb::class_<MicrostructureResult>(m, "MicrostructureResult", "What was found in pictures of a microscope.")
      .def_prop_ro("numbers", [](const MicrostructureResult& r) { return numbers(r.found); })
      .def_prop_ro("particles", [](const MicrostructureResult& r) { return particles(r.found); })
      .def_prop_ro("overlays", [](const MicrostructureResult& r) { return r.overlays; })
      .def_prop_ro("size_histogram", [](const MicrostructureResult& r) { return size_histogram(r.found); })
      .def_prop_ro("scene_text",
                   [](const MicrostructureResult& r) { return measured_material(r.found).scene; })
      .def("save", save_result, nb::arg("folder"));
  m.def(
      "analyse_microstructure",
      [](const std::vector<const Field*>& fields, int polarity, int background, double background_scale,
         int denoise, double smooth, bool fill_holes, double min_radius, double correlation_radius_m,
         int resamples, std::uint64_t seed, bool srgb, bool overlays, int scatterer,
         const std::string& int_ior) {
        if (polarity < 0 || scatterer < 0 || scatterer > 3 || polarity > 2 || background < 0 ||
            background > 2 || denoise < 0 || denoise > 3 ||
            std::find(fields.begin(), fields.end(), nullptr) != fields.end())
          throw Error("analyse_microstructure: wrong arguments");
        MicrostructureOptions o;
        o.segmentation = {Polarity(polarity),
                          Background(background),
                          background_scale,
                          Denoise(denoise),
                          smooth,
                          fill_holes,
                          min_radius};
        o.correlation_radius_m = correlation_radius_m, o.resamples = resamples, o.seed = seed;
        o.scatterer = ScattererKind(scatterer), o.int_ior = int_ior;
        return analyse(fields, o, srgb, overlays);
      },
      nb::arg("fields"), nb::arg("polarity"), nb::arg("background"), nb::arg("background_scale"),
      nb::arg("denoise"), nb::arg("smooth"), nb::arg("fill_holes"), nb::arg("min_radius"),
      nb::arg("correlation_radius_m"), nb::arg("resamples"), nb::arg("seed"), nb::arg("srgb"),
      nb::arg("overlays"), nb::arg("scatterer"), nb::arg("int_ior"));
}

}  // namespace aureole::python
