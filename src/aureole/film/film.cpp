// SPDX-License-Identifier: Apache-2.0
#include "aureole/film/film.h"

#include "aureole/plugin/registry.h"

namespace aureole {

void Film::read_common(const Properties& p) {
  constexpr double kMaximumSize = 1 << 20;
  width_ = int(p.get_int("width", 768, {1, kMaximumSize}));
  height_ = int(p.get_int("height", 576, {1, kMaximumSize}));
  crop_x_ = int(p.get_int("crop_offset_x", 0, {0, double(width_ - 1)}));
  crop_y_ = int(p.get_int("crop_offset_y", 0, {0, double(height_ - 1)}));
  crop_width_ = int(p.get_int("crop_width", width_ - crop_x_, {1, double(width_ - crop_x_)}));
  crop_height_ = int(p.get_int("crop_height", height_ - crop_y_, {1, double(height_ - crop_y_)}));
  sample_border_ = p.get_bool("sample_border", false);
  if (p.find("compensate")) p.note("compensate", "sums are exact here: \"compensate\" has no effect");
  p.find("banner");
  // Marks both parameters as read, since the scene reader has already set the grid from them.
  p.find("wavelength_min");
  p.find("wavelength_max");
  const auto filters = p.get_children<Filter>("rfilter");
  if (filters.size() > 1) throw Error(p.where(), "a film has one reconstruction filter");
  filter_is_default_ = filters.empty();
  filter_ = filters.empty() ? make_default<Filter>(p, "rfilter") : filters.front();
}

ExrPixel Film::read_component_format(const Properties& p) {
  const std::string format = p.get_choice("component_format", "float16", {"float16", "float32", "uint32"});
  if (format == "uint32")
    p.note("component_format", "whole numbers would lose the picture: it is stored as float32");
  return format == "float16" ? ExrPixel::half : ExrPixel::float32;
}

void Film::set_measured(MeasuredKind kind, std::string name) {
  check_kind(kind);
  measured_kind_ = kind;
  measured_name_ = std::move(name);
  if (!measured_name_.empty()) measured_name_ += ' ';
}

void Film::refuse_flux(const std::string& reason) const {
  if (measures_flux()) throw properties().error("quantity", "is power or energy: " + reason);
}

const char* radiometric_name(MeasuredKind kind) {
  return kind == MeasuredKind::radiance     ? "radiance"
         : kind == MeasuredKind::irradiance ? "irradiance"
                                            : "radiant intensity";
}

const char* radiometric_unit(MeasuredKind kind) {
  return kind == MeasuredKind::radiance ? "W/(m^2 sr)" : kind == MeasuredKind::irradiance ? "W/m^2" : "W/sr";
}

void Film::use_box_filter(const std::string& reason) {
  if (filter_->radius() <= 0.5f) return;
  if (!filter_is_default_) filter_->properties().note("", reason);
  filter_ = std::dynamic_pointer_cast<Filter>(make_object(properties(), "rfilter", "box"));
}

std::vector<SampledSpectrum> channel_responses(const Film& film, const SpectralGrid& grid) {
  const std::vector<std::string> names = film.channel_names();
  const size_t channels = names.size() - (names.back() == "A" ? 1 : 0);
  std::vector<std::vector<float>> nodes(channels);
  std::vector<float> measured(size_t(film.measured_channels())), developed(names.size());
  Spectrum unit(0.f);
  unit[0] = 1;
  for (int i = 0; i <= grid.cells; ++i) {
    film.measure(unit, Wavelengths::at(grid, float(grid.node(i))), measured.data());
    const std::vector<double> mean(measured.begin(), measured.end());
    film.develop(mean.data(), 0, developed.data());
    for (size_t c = 0; c < channels; ++c) nodes[c].push_back(developed[c]);
  }
  std::vector<SampledSpectrum> responses;
  for (auto& n : nodes) responses.push_back({grid, std::move(n)});
  return responses;
}

AUREOLE_FAMILY(FamilyInfo{
    .name = "film",
    .fallback = "hdrfilm",
    .parameters = {
        {"width", "integer", "pixels", "768", "width of the film"},
        {"height", "integer", "pixels", "576", "height of the film"},
        {"crop_offset_x", "integer", "pixels", "0", "left edge of the rendered region"},
        {"crop_offset_y", "integer", "pixels", "0", "top edge of the rendered region"},
        {"crop_width", "integer", "pixels", "the rest right of crop_offset_x",
         "width of the rendered region"},
        {"crop_height", "integer", "pixels", "the rest below crop_offset_y", "height of the rendered region"},
        {"sample_border", "boolean", "", "false",
         "also sample beyond the border, as far as the filter reaches"},
        {"rfilter", "rfilter", "", "gaussian", "reconstruction filter"},
        {"component_format", "string", "", "float16", "float16 or float32; uint32 is stored as float32"},
        {"compensate", "boolean", "", "false", "accepted without effect: sums are exact"},
        {"banner", "boolean", "", "false", "accepted without effect"}}});

}  // namespace aureole
