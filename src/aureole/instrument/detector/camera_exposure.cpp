// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/detector/camera_exposure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/parallel_for.h"
#include "aureole/math/transform.h"
#include "aureole/pigment/colour_difference.h"
#include "aureole/pigment/samples.h"
#include "aureole/pigment/text_table.h"
#include "aureole/render/output.h"
#include "aureole/spectrum/photometry.h"
#include "aureole/spectrum/tables.h"
#include "aureole/spectrum/upsampling_fit.h"

namespace aureole {

namespace {

/// The patches of the ColorChecker in 8-bit sRGB, from the sheet of X-Rite (2009 edition, D50 colours adapted to D65).
constexpr int kPatches[24][3] = {
    {115, 82, 68},   {194, 150, 130}, {98, 122, 157},  {87, 108, 67},   {133, 128, 177}, {103, 189, 170},
    {214, 126, 44},  {80, 91, 166},   {193, 90, 99},   {94, 60, 108},   {157, 188, 64},  {224, 163, 46},
    {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},  {187, 86, 149},  {8, 133, 161},
    {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85},    {52, 52, 52}};

/// Reads a key of a camera's file.
class CameraKeys {
public:
  CameraKeys(const nlohmann::json& values, std::filesystem::path file)
      : values_(values), file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& message) const { throw Error({file_.string(), 0, 0}, message); }
  void read(const char* key, double& to) {
    note_known(key);
    if (!values_.contains(key)) return;
    const auto& v = values_[key];
    if (!v.is_number() || !std::isfinite(v.get<double>())) fail(fmt::format("\"{}\" must be a number", key));
    to = v.get<double>();
  }
  void read(const char* key, std::string& to) {
    note_known(key);
    if (!values_.contains(key)) return;
    if (!values_[key].is_string()) fail(fmt::format("\"{}\" must be a text", key));
    to = values_[key].get<std::string>();
  }
  const nlohmann::json* find(const char* key) {
    note_known(key);
    return values_.contains(key) ? &values_[key] : nullptr;
  }
  void refuse_others() const {
    for (const auto& [key, value] : values_.items())
      if (std::find(known_.begin(), known_.end(), key) == known_.end())
        fail(fmt::format("unknown key \"{}\"{}", key, did_you_mean_or_all(key, known_)));
  }

private:
  void note_known(const char* key) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  }

  const nlohmann::json& values_;
  std::filesystem::path file_;
  std::vector<std::string> known_;
};

/// Curves that a camera's file has itself: {"nm": [...], "values": [...]}, or "red", "green" and "blue" beside "nm".
std::vector<EfficiencyCurve> curves_of(const nlohmann::json& object, const CameraKeys& keys,
                                       const std::string& key) {
  const std::string kExpected =
      "\"" + key +
      "\" must be a number, the name of a table, or an object with lists of numbers: \"nm\", and \"values\" or \"red\", "
      "\"green\" and \"blue\"";
  if (!object.is_object()) keys.fail(kExpected);
  std::vector<std::string> names{"red", "green", "blue"};
  if (object.contains("values")) names = {"values"};
  if (object.size() != names.size() + 1 || !object.contains("nm")) keys.fail(kExpected);
  const auto numbers = [&](const std::string& name) {
    if (!object.contains(name) || !object[name].is_array()) keys.fail(kExpected);
    std::vector<double> list;
    for (const nlohmann::json& v : object[name]) {
      if (!v.is_number()) keys.fail("\"" + key + "\": \"" + name + "\" must be a list of numbers");
      list.push_back(v.get<double>());
    }
    return list;
  };
  const std::vector<double> nm = numbers("nm");
  if (nm.size() < 2 || !(nm.front() > 0) ||
      std::adjacent_find(nm.begin(), nm.end(), std::greater_equal<>()) != nm.end())
    keys.fail("\"" + key + "\": \"nm\" must be two or more wavelengths that increase");
  std::vector<EfficiencyCurve> curves;
  for (const std::string& name : names) {
    const EfficiencyCurve& curve = curves.emplace_back(EfficiencyCurve{nm, numbers(name)});
    if (curve.values.size() != nm.size())
      keys.fail(fmt::format("\"{}\": \"{}\" has {} values for {} wavelengths", key, name, curve.values.size(),
                            nm.size()));
    for (const double v : curve.values)
      if (!(v >= 0 && v <= 1)) keys.fail(fmt::format("\"{}\": values lie between 0 and 1, got {:g}", key, v));
  }
  return curves;
}

}  // namespace

SpectralPicture spectral_picture(const Image& picture, const std::string& meanings, const std::string& name) {
  SpectralPicture s{picture.width, picture.height, false, {}, {}, {}};
  std::vector<std::size_t> channels;
  for (std::size_t c = 0; c < picture.channels.size(); ++c) {
    const std::string meaning = channel_meaning(meanings, picture.channels[c]);
    const std::size_t from = meaning.find(" from ");
    double lower = 0, upper = 0;
    if (!meaning.starts_with("mean ") || meaning.find("spectral ") == meaning.npos || from == meaning.npos ||
        std::sscanf(meaning.c_str() + from, " from %lf to %lf nm", &lower, &upper) != 2 ||
        !(upper > lower && lower > 0))
      continue;
    const bool is_irradiance = meaning.ends_with("W/(m^2 nm)"),
               is_radiance = meaning.ends_with("W/(m^2 sr nm)");
    if (!is_irradiance && !is_radiance)
      throw Error(name + ": a camera measures radiance or irradiance, not \"" + meaning + "\"");
    if (!channels.empty() && is_irradiance != s.is_irradiance)
      throw Error(name + ": has channels of both kinds");
    s.is_irradiance = is_irradiance;
    s.lower_nm.push_back(lower), s.upper_nm.push_back(upper);
    channels.push_back(c);
  }
  if (channels.empty())
    throw Error(
        name +
        ": has no spectral channels: its film must be a \"specfilm\" with \"bins\" or \"bin_edges\", and the "
        "header of the picture says what each holds");
  s.values.reserve(std::size_t(picture.width) * std::size_t(picture.height) * channels.size());
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (const std::size_t c : channels) s.values.push_back(picture.at(x, y, c));
  return s;
}

double EfficiencyCurve::at(double wavelength_nm) const {
  if (nm.size() == 1) return values[0];
  if (!(wavelength_nm >= nm.front() && wavelength_nm <= nm.back())) return 0;
  const std::size_t k = std::size_t(
      std::max<std::ptrdiff_t>(1, std::lower_bound(nm.begin(), nm.end(), wavelength_nm) - nm.begin()));
  return std::lerp(values[k - 1], values[k], (wavelength_nm - nm[k - 1]) / (nm[k] - nm[k - 1]));
}

EfficiencyCurve EfficiencyCurve::constant(double value) { return {{550}, {value}}; }

std::vector<EfficiencyCurve> read_efficiency(const std::filesystem::path& file) {
  std::istringstream text = read_table_file(file);
  std::vector<EfficiencyCurve> curves;
  try {
    const std::vector<pigment::TextRow> rows = pigment::read_text_table(text);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const pigment::TextRow& row = rows[i];
      if (i == 0 && !pigment::finite_number(row.cells[0].text)) continue;
      const std::size_t count = row.cells.size() - 1;
      if (curves.empty()) {
        if (count != 1 && count != 3)
          throw pigment::TextError(
              row.line, 1,
              fmt::format("expected a wavelength and one or three efficiencies, got {} columns",
                          row.cells.size()));
        curves.resize(count);
      }
      if (count != curves.size())
        throw pigment::TextError(row.line, 1,
                                 fmt::format("expected {} columns, got {}", curves.size() + 1, count + 1));
      const double nm = pigment::number_of(row, 0);
      if (!(nm > 0) || (!curves[0].nm.empty() && !(nm > curves[0].nm.back())))
        throw pigment::TextError(row.line, row.cells[0].column, "wavelengths must be positive and increase");
      for (std::size_t c = 0; c < count; ++c) {
        const double value = pigment::number_of(row, c + 1);
        if (!(value >= 0 && value <= 1))
          throw pigment::TextError(row.line, row.cells[c + 1].column,
                                   fmt::format("a quantum efficiency lies between 0 and 1, got {:g}", value));
        curves[c].nm.push_back(nm), curves[c].values.push_back(value);
      }
    }
    if (curves.empty() || curves[0].nm.size() < 2)
      throw pigment::TextError(0, 0, "needs at least two wavelengths");
  } catch (const pigment::TextError& e) {
    throw Error({file.string(), e.line(), e.column()}, e.what());
  }
  return curves;
}

CameraModel read_camera(const std::filesystem::path& file) {
  return parse_camera(read_text_file(file, kMaxJsonBytes), file);
}

CameraModel parse_camera(const std::string& text, const std::filesystem::path& file) {
  nlohmann::json values;
  try {
    values = nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    throw Error({file.string(), 0, 0}, std::string("is no JSON: ") + e.what());
  }
  if (!values.is_object()) throw Error({file.string(), 0, 0}, "expected an object with the camera's keys");
  CameraModel camera;
  CameraKeys keys(values, file);
  optics::DetectorModel& d = camera.detector;
  keys.read("name", camera.name);
  keys.read("full_well", d.full_well), keys.read("read_noise", d.read_noise);
  keys.read("dark_current", d.dark_current), keys.read("dsnu", d.dark_nonuniformity);
  keys.read("prnu", d.photo_nonuniformity), keys.read("gain", d.gain),
      keys.read("black_level", d.black_level);
  double bits = d.bits;
  keys.read("bits", bits);
  if (bits != std::floor(bits) || !(bits >= 1 && bits <= 16))
    keys.fail("\"bits\" must be a whole number from 1 to 16");
  d.bits = int(bits);
  keys.read("pixel_pitch_um", camera.pixel_pitch_um), keys.read("fill_factor", camera.fill_factor);
  keys.read("f_number", camera.f_number);
  if (const nlohmann::json* transmission = keys.find("transmission");
      transmission && !transmission->is_number()) {
    const std::vector<EfficiencyCurve> curves =
        transmission->is_string() ? read_efficiency(file.parent_path() / transmission->get<std::string>())
                                  : curves_of(*transmission, keys, "transmission");
    if (curves.size() != 1) keys.fail("\"transmission\" is one curve for all pixels");
    camera.transmittance = curves[0];
  } else {
    keys.read("transmission", camera.transmission);
  }
  std::string aperture = "sine", mosaic = "mono";
  keys.read("aperture", aperture), keys.read("mosaic", mosaic);
  if (aperture != "sine" && aperture != "thin")
    keys.fail("\"aperture\" must be \"sine\" or \"thin\", not \"" + aperture + "\"");
  camera.aperture = aperture == "sine" ? optics::ApertureLaw::sine : optics::ApertureLaw::thin;
  try {
    camera.mosaic = optics::ColorMosaic::named(mosaic);
  } catch (const std::domain_error& e) {
    keys.fail(e.what());
  }
  if (const nlohmann::json* efficiency = keys.find("efficiency")) {
    if (efficiency->is_number())
      camera.efficiency = {EfficiencyCurve::constant(efficiency->get<double>())};
    else if (efficiency->is_string())
      camera.efficiency = read_efficiency(file.parent_path() / efficiency->get<std::string>());
    else
      camera.efficiency = curves_of(*efficiency, keys, "efficiency");
  }
  keys.refuse_others();
  try {
    check_camera(camera);
  } catch (const Error& e) {
    keys.fail(e.message());
  }
  return camera;
}

void check_camera(const CameraModel& c) {
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw Error(what);
  };
  try {
    c.detector.check();
    optics::aperture_solid_angle(c.f_number, c.aperture);
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
  require(c.pixel_pitch_um > 0 && c.pixel_pitch_um < 1e6, "the pixel pitch must be positive, in um");
  require(c.fill_factor > 0 && c.fill_factor <= 1, "the fill factor lies between 0 and 1");
  require(c.transmission > 0 && c.transmission <= 1, "the transmission lies between 0 and 1, without 0");
  require(c.efficiency.size() == 1 || c.efficiency.size() == 3, "a camera has one efficiency or three");
  require(c.mosaic.is_mono() || c.efficiency.size() == 3,
          "a mosaic of colours needs a table of the efficiency of red, green and blue");
  require(!c.mosaic.is_mono() || c.efficiency.size() == 1,
          "efficiencies of red, green and blue need a \"mosaic\" of colours");
  for (const EfficiencyCurve& curve : c.efficiency)
    for (const double v : curve.values)
      require(v >= 0 && v <= 1, fmt::format("a quantum efficiency lies between 0 and 1, got {:g}", v));
}

std::vector<double> mean_electrons(const SpectralPicture& p, const CameraModel& c, double exposure) {
  check_camera(c);
  if (!(exposure > 0 && std::isfinite(exposure))) throw Error("the exposure must be positive, in seconds");
  const double area = c.pixel_pitch_um * c.pixel_pitch_um * 1e-12 * c.fill_factor;
  const double optics =
      c.transmission * (p.is_irradiance ? 1 : optics::aperture_solid_angle(c.f_number, c.aperture));
  // Electrons per spectral quantity of an interval: the integral of efficiency over the energy of a photon.
  const std::size_t bins = p.lower_nm.size();
  std::vector<std::vector<double>> factors;
  double largest = 0;
  for (const EfficiencyCurve& curve : c.efficiency) {
    std::vector<double>& f = factors.emplace_back();
    for (std::size_t b = 0; b < bins; ++b) {
      constexpr int kSteps = 64;
      double sum = 0;
      for (int k = 0; k < kSteps; ++k) {
        const double nm = std::lerp(p.lower_nm[b], p.upper_nm[b], (k + 0.5) / kSteps);
        sum += curve.at(nm) * c.transmittance.at(nm) * nm * 1e-9 / kPlanckTimesLight;
      }
      f.push_back(sum / kSteps * (p.upper_nm[b] - p.lower_nm[b]) * area * optics * exposure);
      largest = std::max(largest, f.back());
    }
  }
  if (!(largest > 0)) throw Error("the camera is blind at the wavelengths of the picture");
  std::vector<double> electrons(std::size_t(p.width) * std::size_t(p.height));
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const std::vector<double>& f = factors[factors.size() == 1 ? 0 : std::size_t(c.mosaic.at(x, y))];
      double sum = 0;
      for (std::size_t b = 0; b < bins; ++b) sum += f[b] * double(p.at(x, y, b));
      if (!std::isfinite(sum))
        throw Error(fmt::format("the picture has no finite value at the pixel {}, {}", x, y));
      // Filters with negative lobes make negative pixels.
      electrons[std::size_t(y) * std::size_t(p.width) + std::size_t(x)] = std::max(0.0, sum);
    }
  return electrons;
}

RawImage read_sensor(std::span<const double> electrons, int width, int height, const CameraModel& c,
                     double exposure, const NoiseSeeds& seeds) {
  check_camera(c);
  RawImage raw;
  raw.width = width, raw.height = height;
  raw.values.resize(electrons.size());
  raw.black_level = c.detector.black_level;
  raw.white_level =
      std::min(c.detector.white_level(),
               int(std::lround(c.detector.black_level + c.detector.gain * c.detector.saturation())));
  raw.mosaic_width = c.mosaic.width, raw.mosaic_height = c.mosaic.height, raw.mosaic = c.mosaic.filters;
  raw.model = c.name, raw.exposure = exposure, raw.f_number = c.f_number;
  for (std::size_t i = 0; i < electrons.size(); ++i)
    raw.values[i] = optics::read_pixel(c.detector, electrons[i], exposure, i, seeds.sensor, seeds.frame);
  return raw;
}

ColorCalibration calibrate_colors(const CameraModel& camera) {
  std::vector<EfficiencyCurve> curves;
  for (const EfficiencyCurve& c : camera.efficiency) {
    EfficiencyCurve& filtered = curves.emplace_back();
    for (double nm = 360; nm <= 830; ++nm)
      filtered.nm.push_back(nm), filtered.values.push_back(c.at(nm) * camera.transmittance.at(nm));
  }
  return calibrate_colors(std::span<const EfficiencyCurve>(curves));
}

ColorCalibration calibrate_colors(std::span<const EfficiencyCurve> curves) {
  if (curves.size() != 3) throw Error("a matrix of colours needs the efficiencies of red, green and blue");
  const TabulatedSpectrum d65 = *find_illuminant("D65");
  const Observer& observer = cie_1931_observer();
  using Three = std::array<double, 3>;
  const auto responses = [&](const auto& reflectance, Three& camera, Three& xyz) {
    camera = {}, xyz = {};
    for (std::size_t k = 0; k < observer.y.size(); ++k) {
      const double nm = observer.start_nm + observer.step_nm * double(k);
      const double light = d65.at(nm) * reflectance(nm);
      xyz[0] += light * observer.x[k], xyz[1] += light * observer.y[k], xyz[2] += light * observer.z[k];
      for (std::size_t c = 0; c < 3; ++c) camera[c] += light * curves[c].at(nm) * nm;
    }
  };
  Three white_camera, white_xyz;
  responses([](double) { return 1.0; }, white_camera, white_xyz);
  for (const double w : white_camera)
    if (!(w > 0)) throw Error("one of the efficiencies is zero in the visible: it tells no colours");
  std::vector<Three> cameras, colors;
  const auto linear = [](int value) { return double(srgb_decode(float(value) / 255)); };
  for (const auto& patch : kPatches) {
    const SigmoidSpectrum spectrum = fit_srgb({linear(patch[0]), linear(patch[1]), linear(patch[2])});
    Three camera, xyz;
    responses([&](double nm) { return double(spectrum.at(float(nm))); }, camera, xyz);
    for (std::size_t c = 0; c < 3; ++c) camera[c] /= white_camera[c], xyz[c] /= white_xyz[1];
    cameras.push_back(camera), colors.push_back(xyz);
  }
  const double scale = 1 / white_xyz[1];
  for (double& w : white_xyz) w *= scale;
  // Each row of the matrix sums to the white's value, so that two of its numbers are free: r (R - B) + g (G - B) = X - w B.
  ColorCalibration result;
  for (std::size_t row = 0; row < 3; ++row) {
    double a00 = 0, a01 = 0, a11 = 0, b0 = 0, b1 = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const Three& c = cameras[i];
      const double p = c[0] - c[2], q = c[1] - c[2], rest = colors[i][row] - white_xyz[row] * c[2];
      a00 += p * p, a01 += p * q, a11 += q * q, b0 += p * rest, b1 += q * rest;
    }
    const double determinant = a00 * a11 - a01 * a01;
    if (!(determinant > 1e-9 * a00 * a11))
      throw Error("the efficiencies of the filters are too alike to tell colours");
    const double r = (a11 * b0 - a01 * b1) / determinant, g = (a00 * b1 - a01 * b0) / determinant;
    result.to_xyz[3 * row] = r, result.to_xyz[3 * row + 1] = g,
                      result.to_xyz[3 * row + 2] = white_xyz[row] - r - g;
  }
  const pigment::Xyz white{white_xyz[0], white_xyz[1], white_xyz[2]};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    pigment::Xyz seen{};
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t c = 0; c < 3; ++c) seen[row] += result.to_xyz[3 * row + c] * cameras[i][c];
    for (double& v : seen) v = std::max(v, 1e-6);
    const double difference =
        pigment::ciede2000(pigment::lab_of_xyz({colors[i][0], colors[i][1], colors[i][2]}, white),
                           pigment::lab_of_xyz(seen, white));
    result.delta_e.push_back(difference);
    result.mean_delta_e += difference / double(cameras.size());
    result.largest_delta_e = std::max(result.largest_delta_e, difference);
  }
  const double brightest = *std::max_element(white_camera.begin(), white_camera.end());
  for (std::size_t c = 0; c < 3; ++c) result.white[c] = white_camera[c] / brightest;
  Transform::Matrix m = Transform().matrix();
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 3; ++c) m[row][c] = result.to_xyz[3 * row + c];
  const Transform inverse = Transform(m).inverse();
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t c = 0; c < 3; ++c)
      result.from_xyz[3 * row + c] = inverse.matrix()[row][c] * white_camera[row] / white_camera[1];
  return result;
}

}  // namespace aureole
