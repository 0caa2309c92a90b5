// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/rgl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "aureole/bsdf/measured/tensor_file.h"
#include "aureole/core/parallel.h"
#include "aureole/math/vec.h"

namespace aureole {
namespace {

void require_increasing(const TensorFile& file, const char* name, const std::vector<float>& values,
                        double low, double high, const char* range) {
  if (values.empty()) throw file.error(fmt::format("field \"{}\" is empty", name));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && !(values[i] > values[i - 1]))
      throw file.error(fmt::format("field \"{}\" must increase; number {} is {:g} after {:g}", name, i + 1,
                                   values[i], values[i - 1]));
    if (!(double(values[i]) >= low && double(values[i]) <= high))
      throw file.error(
          fmt::format("field \"{}\": number {} is {:g}; {} is expected", name, i + 1, values[i], range));
  }
}

/// A table of the last two axes of a field whose first axes have the lengths `slices`.
RglFile::Table read_table(const TensorFile& file, const char* name, const std::vector<std::size_t>& slices) {
  RglFile::Table table;
  table.values = file.floats(name, slices.size() + 2);
  const std::vector<std::size_t>& shape = file.field(name).shape;
  if (!std::equal(slices.begin(), slices.end(), shape.begin()))
    throw file.error(fmt::format(
        "field \"{}\" has the shape {}; its first axes must be {} (azimuths x angles of incidence)", name,
        shape_text(shape), shape_text(slices)));
  table.height = shape[slices.size()], table.width = shape[slices.size() + 1];
  if (table.height < 2 || table.width < 2 || table.height > 65536 || table.width > 65536)
    throw file.error(
        fmt::format("field \"{}\" has the shape {}; tables of 2 to 65536 rows and columns are expected", name,
                    shape_text(shape)));
  for (std::size_t i = 0; i < table.values.size(); ++i)
    if (table.values[i] < 0)
      throw file.error(fmt::format("field \"{}\": number {} is {:g}; a density or an area is never negative",
                                   name, i + 1, table.values[i]));
  return table;
}

}  // namespace

RglFile read_rgl_file(const std::filesystem::path& path, RglNotes& notes) {
  const TensorFile file(path);
  RglFile r;
  r.description = file.text("description");
  r.phi_i = file.floats("phi_i", 1);
  r.theta_i = file.floats("theta_i", 1);
  require_increasing(file, "phi_i", r.phi_i, -1.0001 * kPiD, 2.0001 * kPiD, "an azimuth in [-pi, 2 pi]");
  require_increasing(file, "theta_i", r.theta_i, 0, 0.50001 * kPiD, "an angle in [0, pi/2]");
  r.ndf = read_table(file, "ndf", {});
  r.sigma = read_table(file, "sigma", {});
  const std::vector<std::size_t> slices = {r.phi_i.size(), r.theta_i.size()};
  r.vndf = read_table(file, "vndf", slices);
  r.luminance = read_table(file, "luminance", slices);
  const bool is_spectral = file.find("wavelengths") != nullptr;
  if (is_spectral) {
    r.nm = file.floats("wavelengths", 1);
    require_increasing(file, "wavelengths", r.nm, 1, 1e12, "a wavelength in nm");
  } else if (!file.find("rgb")) {
    throw file.error("there is neither a field \"wavelengths\" with \"spectra\" nor a field \"rgb\"");
  }
  const char* values = is_spectral ? "spectra" : "rgb";
  r.spectra = file.floats(values, 5);
  const std::vector<std::size_t>& shape = file.field(values).shape;
  const std::vector<std::size_t> expected = {r.phi_i.size(), r.theta_i.size(), r.channels(),
                                             r.luminance.height, r.luminance.width};
  if (shape != expected)
    throw file.error(
        fmt::format("field \"{}\" has the shape {}; {} is expected (azimuths x angles x channels x rows x "
                    "columns of \"luminance\")",
                    values, shape_text(shape), shape_text(expected)));
  std::atomic<std::size_t> negative = 0;
  for_ranges(r.spectra.size(), [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += r.spectra[i] < 0;
    negative += found;
  });
  notes.negative_spectra = negative;
  const std::string jacobian = file.text("jacobian");
  if (jacobian.size() != 1)
    throw file.error(
        fmt::format("field \"jacobian\" has {} bytes; one, 0 or 1, is expected", jacobian.size()));
  r.is_relative = jacobian[0] != 0;
  return r;
}

std::string rgl_file_content(const RglFile& file) {
  TensorFileWriter out;
  const std::size_t azimuths = file.phi_i.size(), angles = file.theta_i.size();
  out.add("phi_i", {azimuths}, file.phi_i);
  out.add("theta_i", {angles}, file.theta_i);
  out.add("sigma", {file.sigma.height, file.sigma.width}, file.sigma.values);
  out.add("ndf", {file.ndf.height, file.ndf.width}, file.ndf.values);
  out.add("vndf", {azimuths, angles, file.vndf.height, file.vndf.width}, file.vndf.values);
  out.add("luminance", {azimuths, angles, file.luminance.height, file.luminance.width},
          file.luminance.values);
  const bool is_spectral = !file.nm.empty();
  if (is_spectral) out.add("wavelengths", {file.nm.size()}, file.nm);
  out.add(is_spectral ? "spectra" : "rgb",
          {azimuths, angles, file.channels(), file.luminance.height, file.luminance.width}, file.spectra);
  out.add_bytes("description", file.description);
  const char jacobian = file.is_relative ? 1 : 0;
  out.add_bytes("jacobian", {&jacobian, 1});
  return out.content();
}

}  // namespace aureole
