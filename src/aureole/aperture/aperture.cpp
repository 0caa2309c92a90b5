// SPDX-License-Identifier: Apache-2.0
#include "aureole/aperture/aperture.h"

#include <cmath>
#include <stdexcept>

#include "aureole/core/input_file.h"

namespace aureole {
namespace {

optics::SizeDistribution read_sizes(const Properties& p) {
  const bool histogram = p.find("size_histogram") != nullptr;
  if (histogram && p.has("size_spread"))
    throw p.error("size_histogram", "give \"size_spread\" or \"size_histogram\", not both");
  const double sigma = p.get_float("size_spread", 0, Range{0, optics::SizeDistribution::kMaxSpread});
  try {
    if (histogram) {
      const auto path = p.get_file("size_histogram");
      std::istringstream file = read_table_file(path);
      return optics::SizeDistribution::histogram(file);
    }
    return optics::SizeDistribution::log_normal(sigma);
  } catch (const Error& e) {
    throw e.where().line > 0 ? e : p.error("size_histogram", e.what());
  } catch (const std::domain_error& e) {
    throw p.error(histogram ? "size_histogram" : "size_spread", e.what());
  }
}

}  // namespace

Aperture::Aperture(const Properties& p)
    : Object(p),
      fraction_(p.get_float("fraction", 1, Range{0, 1, true})),
      rotation_(p.get_float("rotation", 0) * M_PI / 180),
      random_rotation_(p.get_bool("random_rotation", false)),
      sizes_(read_sizes(p)) {}

AUREOLE_FAMILY(FamilyInfo{
    .name = "aperture",
    .parameters =
        {{"fraction", "float", "", "1", "fraction of the layer's scatterers that have this shape, in (0, 1]"},
         {"rotation", "float", "degrees", "0", "counter-clockwise rotation of the shape"},
         {"random_rotation", "boolean", "", "false", "rotate every scatterer by a random angle of its own"},
         {"size_spread", "float", "", "0",
          "standard deviation of the logarithm of the sizes (log-normal, median 1, truncated at 3 standard "
          "deviations)"},
         {"size_histogram", "file", "", "none",
          "text file with two columns, relative size and count: measured sizes instead of a spread"}},
    .is_reusable = true});

double get_aperture_length_m(const Properties& p, const std::string& name) {
  const double length = p.get_length_m(name, 0);
  if (!p.has(name)) throw p.error(name, "needs the parameter \"" + name + "\", a length such as \"5um\"");
  if (!(length >= 1e-9 && length <= 1)) throw p.error(name, "must be between 1nm and 1m");
  return length;
}

}  // namespace aureole
