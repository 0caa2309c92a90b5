// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/micrograph.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <pugixml.hpp>

#include "aureole/core/error.h"
#include "aureole/core/units.h"

namespace aureole {
namespace {

// upper bound of a pixel's size, 1270 dpi: coarser values are default tags of scanners and cameras
constexpr double kLargestPixel = 20e-6;

double square(double x, double y) {
  if (!(x > 0 && y > 0 && std::isfinite(x) && std::isfinite(y)))
    throw Error("the pixel size in the file is not positive; give --pixel-size");
  if (std::abs(x / y - 1) > 1e-3)
    throw Error("the pixels are not square (" + std::to_string(x * 1e6) + " x " + std::to_string(y * 1e6) +
                " um); resample the image");
  return x;
}

/// Reads OME-XML: PhysicalSizeX in PhysicalSizeXUnit, by default micrometres.
double ome_pixel_size(const std::string& text) {
  pugi::xml_document document;
  if (!document.load_buffer(text.data(), text.size())) return 0;
  const pugi::xml_node pixels =
      document.find_node([](const pugi::xml_node& n) { return std::strcmp(n.name(), "Pixels") == 0; });
  if (!pixels.attribute("PhysicalSizeX")) return 0;
  const auto size = [&](const char* value, const char* unit) {
    return parse_length_m(std::string(pixels.attribute(value).value()) +
                          pixels.attribute(unit).as_string("um"));
  };
  const double x = size("PhysicalSizeX", "PhysicalSizeXUnit");
  return square(x, pixels.attribute("PhysicalSizeY") ? size("PhysicalSizeY", "PhysicalSizeYUnit") : x);
}

/// Returns the unit of a line "unit=micron" of ImageJ's description in metres; 0 if there is none.
double imagej_unit(const std::string& text) {
  const size_t at = text.find("\nunit=");
  if (at == std::string::npos) return 0;
  std::string unit = text.substr(at + 6, text.find_first_of("\r\n", at + 6) - at - 6);
  if (unit == "pixel" || unit == "pixels" || unit.empty()) return 0;
  if (unit == "micron" || unit == "microns" || unit == "\\u00B5m" || unit == "\xb5m") unit = "um";
  if (unit == "inch") return 0.0254;
  return parse_length_m("1" + unit);
}

/// Excludes the pixels that are black in `file`.
void apply_mask(Micrograph& m, const std::filesystem::path& file) {
  const Image mask = read_image(file);
  const auto fail = [&](const std::string& what) { throw Error({file.string(), 0, 0}, what); };
  if (mask.width != m.width || mask.height != m.height)
    fail("the mask has " + std::to_string(mask.width) + " x " + std::to_string(mask.height) + " pixels, " +
         m.name + " has " + std::to_string(m.width) + " x " + std::to_string(m.height));
  const size_t channels = mask.channel_count(), colours = channels >= 3 ? 3 : 1;
  for (size_t i = 0; i < m.seen.size(); ++i) {
    float most = 0;
    for (size_t c = 0; c < colours; ++c) most = std::max(most, mask.pixels[i * channels + c]);
    if (!(most >= 0.5f)) m.seen[i] = 0;
  }
}

}  // namespace

double pixel_size_m(const ExrAttributes& a) {
  const auto description = a.strings.find("ImageDescription");
  const std::string text = description == a.strings.end() ? "" : description->second;
  if (text.find("<OME") != std::string::npos)
    if (const double size = ome_pixel_size(text); size > 0) return size;
  const auto x = a.floats.find("XResolution"), y = a.floats.find("YResolution");
  if (x == a.floats.end() || !(x->second > 0)) return 0;
  const double per_unit_x = x->second, per_unit_y = y == a.floats.end() ? per_unit_x : double(y->second);
  if (text.starts_with("ImageJ="))
    if (const double unit = imagej_unit(text); unit > 0) return square(unit / per_unit_x, unit / per_unit_y);
  const auto unit = a.integers.find("ResolutionUnit");
  const int code = unit == a.integers.end() ? 1 : unit->second;
  if (code != 2 && code != 3) return 0;
  const double metres = code == 2 ? 0.0254 : 0.01;
  if (metres / per_unit_x > kLargestPixel) return 0;
  return square(metres / per_unit_x, metres / per_unit_y);
}

Micrograph read_micrograph(const std::filesystem::path& file, const MicrographOptions& options) {
  ExrAttributes attributes;
  const Image image = read_image(file, &attributes);
  const auto fail = [&](const std::string& what) { throw Error({file.string(), 0, 0}, what); };
  Micrograph m;
  m.name = file.string(), m.width = image.width, m.height = image.height;
  m.notes = image.notes;
  if (std::min(m.width, m.height) < kSmallestField)
    fail(std::to_string(m.width) + " x " + std::to_string(m.height) +
         " pixels are too few: a field needs at least " + std::to_string(kSmallestField) + " on each side");
  m.pixel_m = options.pixel_m;
  if (m.pixel_m == 0) try {
      m.pixel_m = pixel_size_m(attributes);
    } catch (const Error& e) {
      fail(e.message());
    }
  if (!(m.pixel_m > 0))
    fail(
        "does not say how large its pixels are (no OME or ImageJ description, no resolution tags of a "
        "microscope); give --pixel-size, such as 0.2um");

  const size_t channels = image.channel_count(), colours = channels >= 3 ? 3 : 1;
  m.grey.resize(size_t(m.width) * m.height);
  for (size_t i = 0; i < m.grey.size(); ++i) {
    float sum = 0;
    for (size_t c = 0; c < colours; ++c) {
      const float v = image.pixels[i * channels + c];
      sum += options.srgb && image.srgb_encoded ? srgb_decode(v) : v;
    }
    if (!std::isfinite(sum)) fail("has pixels that are NaN or infinite");
    m.grey[i] = sum / float(colours);
  }

  if (options.mask.empty() && options.exclude.empty()) return m;
  m.seen.assign(m.grey.size(), 1);
  if (!options.mask.empty()) apply_mask(m, options.mask);
  for (const auto& [x, y, w, h] : options.exclude) {
    if (w <= 0 || h <= 0) throw Error("--exclude: width and height must be positive");
    if (x >= m.width || y >= m.height || x + w <= 0 || y + h <= 0)
      throw Error("--exclude " + std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(w) + "," +
                  std::to_string(h) + " lies outside of " + m.name);
    for (int j = std::max(y, 0); j < std::min(y + h, m.height); ++j)
      std::fill_n(m.seen.begin() + size_t(j) * m.width + std::max(x, 0),
                  std::min(x + w, m.width) - std::max(x, 0), std::uint8_t(0));
  }
  const auto left = std::count(m.seen.begin(), m.seen.end(), 1);
  if (left < kSmallestField * kSmallestField)
    fail(left == 0 ? "the mask leaves nothing of the image"
                   : "the mask leaves " + std::to_string(left) + " pixels of the image, too few");
  return m;
}

}  // namespace aureole
