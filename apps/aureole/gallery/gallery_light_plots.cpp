// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_light_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/random.h"
#include "aureole/instrument/detector/camera_exposure.h"
#include "aureole/instrument/lightfield/light_field.h"
#include "aureole/instrument/photometry/illumination.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/tone.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct RenderedLight {
  LoadedScene scene;
  Image picture, colors;
  std::string meanings;
};

RenderedLight rendered_light(const LoadedScene& scene, std::int64_t spp, std::uint64_t seed,
                             const std::atomic<bool>& stop) {
  RenderOptions options;
  options.end = spp, options.seed = seed;
  options.adaptive = AdaptiveTarget::none;
  RenderJob job(scene, options);
  job.run(stop);
  const Film& film = scene.scene->film();
  return {scene, job.state().picture(), job.state().rgb_picture(),
          channels_attribute(film.channel_names(), film.channel_meanings())};
}

/// The size of the film that a scene states, divided.
std::vector<std::pair<std::string, std::string>> divided_size(const std::filesystem::path& scene,
                                                              int divisor) {
  if (divisor == 1) return {};
  const LoadedScene loaded = load_scene(scene, load_options({}));
  const Film& film = loaded.scene->film();
  return {{"width", std::to_string(film.width() / divisor)},
          {"height", std::to_string(film.height() / divisor)}};
}

RenderedLight rendered_light(const std::filesystem::path& scene, const LightEffort& effort,
                             const std::atomic<bool>& stop) {
  LoadOptions load = load_options({});
  load.defines = divided_size(scene, effort.divisor);
  return rendered_light(load_scene(scene, load), effort.spp, 0, stop);
}

Image row_of_pictures(const std::vector<Image>& pictures) {
  Image row{0, pictures[0].height, {"R", "G", "B"}, {}, pictures[0].srgb_encoded};
  for (const Image& p : pictures) row.width += p.width;
  for (int y = 0; y < row.height; ++y)
    for (const Image& p : pictures)
      for (int x = 0; x < p.width; ++x)
        for (std::size_t c = 0; c < 3; ++c) row.pixels.push_back(p.at(x, y, p.channel_count() == 3 ? c : 0));
  return row;
}

Image column_of_pictures(const std::vector<Image>& rows) {
  Image all{rows[0].width, 0, rows[0].channels, {}, rows[0].srgb_encoded};
  for (const Image& r : rows) {
    all.height += r.height;
    all.pixels.insert(all.pixels.end(), r.pixels.begin(), r.pixels.end());
  }
  return all;
}

/// R, G, B, or the first channel, in the order of colours.
Image colors_of_channels(const Image& picture) {
  const bool is_colored = picture.channel("R") >= 0 && picture.channel("G") >= 0 && picture.channel("B") >= 0;
  Image colors{picture.width, picture.height, {"R", "G", "B"}, {}, false};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (const std::string& name : colors.channels)
        colors.pixels.push_back(picture.at(x, y, is_colored ? std::size_t(picture.channel(name)) : 0));
  return colors;
}

/// A raw picture for display: means of each colour over blocks of pixels, the size of which has all colours, balanced and by
/// the camera's matrix. Exposures keep their brightness: `full` is the digital number that is white.
Image developed_blocks(const RawImage& raw, const ColorCalibration* colors, double full) {
  const int block = raw.mosaic_width == 6 ? 3 : raw.mosaic_width;
  Image out{raw.width / block, raw.height / block, {"R", "G", "B"}, {}, true};
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      std::array<double, 3> sum{}, count{};
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i) {
          const int px = x * block + i, py = y * block + j;
          const std::size_t c =
              raw.mosaic[std::size_t(py % raw.mosaic_height) * std::size_t(raw.mosaic_width) +
                         std::size_t(px % raw.mosaic_width)];
          sum[c] += double(raw.values[std::size_t(py) * std::size_t(raw.width) + std::size_t(px)]) -
                    raw.black_level;
          count[c] += 1;
        }
      std::array<double, 3> rgb{};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t from = count[c] > 0 ? c : 0;
        rgb[c] = sum[from] / count[from] / (full * (colors ? colors->white[c] : 1));
      }
      if (colors) {
        std::array<double, 3> xyz{};
        for (std::size_t r = 0; r < 3; ++r)
          for (std::size_t c = 0; c < 3; ++c) xyz[r] += colors->to_xyz[3 * r + c] * rgb[c];
        rgb = {3.2404542 * xyz[0] - 1.5371385 * xyz[1] - 0.4985314 * xyz[2],
               -0.9692660 * xyz[0] + 1.8760108 * xyz[1] + 0.0415560 * xyz[2],
               0.0556434 * xyz[0] - 0.2040259 * xyz[1] + 1.0572252 * xyz[2]};
      }
      for (const double v : rgb) out.pixels.push_back(srgb_encode(float(std::clamp(v, 0.0, 1.0))));
    }
  return out;
}

/// The mean and the standard error of one value per run of a scene that is given as text.
std::pair<double, double> reading_of(const std::string& text, std::int64_t spp,
                                     const std::atomic<bool>& stop) {
  const LoadedScene scene = load_scene_from_string(
      "<scene version='3.0.0'><integrator type='path'/>" + text + "</scene>", "figure.xml", {});
  RunStatistics runs;
  for (std::uint64_t seed = 0; seed < 8 && !stop; ++seed) {
    const RenderedLight light = rendered_light(scene, spp, seed, stop);
    double mean = 0;
    for (const float v : light.picture.pixels) mean += double(v) / double(light.picture.pixels.size());
    runs.add(mean);
  }
  return {runs.mean(), runs.error()};
}

constexpr const char* kLightColors[] = {"#2050c0", "#c03020", "#208030"};

PlotSeries traced_points(const std::string& label, const char* color) {
  PlotSeries s{.kind = PlotSeries::Kind::points, .x = {}, .y = {}, .low = {}, .high = {}};
  s.label = label, s.color = color;
  return s;
}
void add_reading(PlotSeries& s, double x, double value, double error) {
  s.x.push_back(x), s.y.push_back(value), s.low.push_back(value - 2 * error),
      s.high.push_back(value + 2 * error);
}

std::string small_receiver(const std::string& turn, const std::string& quantity) {
  return "<sensor type='powermap'><string name='measure' value='irradiance'/><transform name='to_world'><scale value='0.001'/>" +
         turn +
         "</transform><film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>"
         "<string name='quantity' value='" +
         quantity + "'/><rfilter type='box'/></film></sensor>";
}
const std::string kFarBall = "<shape type='sphere'><point name='center' x='0' y='0' z='-50'/></shape>";

}  // namespace

LightPicture measured_picture(const std::filesystem::path& scene, const std::vector<double>& isolines,
                              double threshold, const LightEffort& effort, const std::atomic<bool>& stop) {
  const RenderedLight light = rendered_light(scene, effort, stop);
  const PhotometricMap map = photometric_map(light.picture, light.meanings, scene.string());
  const MapStatistics s = map_statistics(map, {0, 0, map.width, map.height});
  std::string caption = fmt::format("{}: {:.4g} {} in the mean, {:.4g} to {:.4g}, uniformity {:.3f}.",
                                    map.quantity, s.mean, map.unit, s.min, s.max, s.uniformity());
  if (threshold > 0) {
    const PictureGlare g = picture_glare(map, light.scene.scene->sensor(), {0, 0, 1}, threshold);
    caption +=
        fmt::format(" UGR {:.1f} by {} sources on {:.3g} cd/m^2.", g.rating, g.sources.size(), g.background);
  }
  return {
      false_color_picture(map.values, map.width, map.height, map_scale(map, {}, {}, threshold > 0, isolines)),
      caption};
}

LightPicture exposed_pictures(const std::filesystem::path& scene,
                              const std::vector<std::filesystem::path>& cameras,
                              const std::vector<double>& exposures, const LightEffort& effort,
                              const std::atomic<bool>& stop) {
  const RenderedLight light = rendered_light(scene, effort, stop);
  const SpectralPicture spectral = spectral_picture(light.picture, light.meanings, scene.string());
  std::vector<Image> rows;
  std::string caption;
  for (const std::filesystem::path& file : cameras) {
    const CameraModel camera = read_camera(file);
    std::optional<ColorCalibration> colors;
    if (!camera.mosaic.is_mono()) colors = calibrate_colors(camera);
    std::vector<Image> row;
    caption += camera.name + ":";
    for (const double exposure : exposures) {
      const std::vector<double> electrons = mean_electrons(spectral, camera, exposure);
      const RawImage raw = read_sensor(electrons, spectral.width, spectral.height, camera, exposure, {1, 1});
      row.push_back(developed_blocks(raw, colors ? &*colors : nullptr, raw.white_level - raw.black_level));
      double sum = 0;
      for (const double e : electrons) sum += e / double(electrons.size());
      caption += fmt::format(" {:.3g} electrons in {:g} ms,", sum, 1000 * exposure);
    }
    caption.back() = ';';
    caption += ' ';
    rows.push_back(row_of_pictures(row));
  }
  // Mosaics of other blocks have other sizes: all become as wide as the narrowest by leaving out the edge.
  int width = rows[0].width;
  for (const Image& r : rows) width = std::min(width, r.width);
  for (Image& r : rows) {
    Image cut{width, r.height, r.channels, {}, r.srgb_encoded};
    for (int y = 0; y < r.height; ++y)
      for (int x = 0; x < width; ++x)
        for (std::size_t c = 0; c < 3; ++c) cut.pixels.push_back(r.at(x * r.width / width, y, c));
    r = std::move(cut);
  }
  caption.resize(caption.size() - 2);
  return {column_of_pictures(rows), caption + "."};
}

LightPicture refocused_pictures(const std::filesystem::path& scene, double diameter,
                                const std::vector<double>& focus, const LightEffort& effort,
                                const std::atomic<bool>& stop) {
  const RenderedLight light = rendered_light(scene, effort, stop);
  LightField field;
  field.axes = light_field_axes(light.scene.scene->sensor().properties(), light.scene.scene->film());
  field.mosaic = light.picture;
  std::vector<Image> pictures;
  std::string caption = fmt::format("{}; in focus at", field.axes.text());
  for (const double distance : focus) {
    pictures.push_back(
        display_picture(colors_of_channels(light_field_picture(field, 0, 0, diameter, distance))));
    caption += fmt::format(" {:g},", distance);
  }
  caption.back() = '.';
  return {row_of_pictures(pictures), caption};
}

LightPicture local_and_global(const std::filesystem::path& scene, const LightEffort& effort,
                              const std::atomic<bool>& stop) {
  LoadOptions load = load_options({});
  load.defines = divided_size(scene, effort.divisor);
  std::vector<IlluminationRuns> both;
  for (const bool is_local : {true, false}) {
    const LoadedScene loaded = load_scene(scene, illumination_options(load, is_local));
    const Film& film = loaded.scene->film();
    both.emplace_back(scene.string(), channels_attribute(film.channel_names(), film.channel_meanings()),
                      film.crop_width(), film.crop_height(), std::vector<MapRegion>());
    for (std::uint64_t seed = 0; seed < 4 && !stop; ++seed) {
      const RenderedLight light = rendered_light(loaded, effort.spp, seed, stop);
      both.back().add(light.picture, light.colors);
    }
  }
  const RunStatistics &l = both[0].statistics()[0], &g = both[1].statistics()[0];
  const PhotometricMap map = both[1].map();
  return {
      row_of_pictures({display_picture(both[0].colors()), display_picture(both[1].colors())}),
      fmt::format(
          "{}: local {:.4g} +- {:.1g} {}, all light {:.4g} +- {:.1g} {}; {:.1f} % was scattered more than once.",
          map.quantity, l.mean(), l.error(), map.unit, g.mean(), g.error(), map.unit,
          100 * (1 - l.mean() / g.mean()))};
}

LightCurves tilted_detector(std::int64_t spp, const std::atomic<bool>& stop) {
  Plot plot{"A detector in a beam of 1000 lx", "tilt, degrees", "lx", {}, false};
  PlotSeries flux = traced_points("illuminance of the detector", kLightColors[0]),
             over = traced_points("over the cosine", kLightColors[1]), cosine;
  cosine.label = "1000 cos", cosine.color = kLightColors[0];
  double worst = 0;
  for (int degrees = 0; degrees <= 80 && !stop; degrees += 10) {
    const double c = std::cos(degrees * M_PI / 180);
    const auto [mean, error] = reading_of(
        small_receiver(fmt::format("<rotate y='1' angle='{}'/>", degrees), "illuminance") + kFarBall +
            "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/><string name='amount' value='1000 lx'/></emitter>",
        spp, stop);
    add_reading(flux, degrees, mean, error), add_reading(over, degrees, mean / c, error / c);
    worst = std::max(worst, std::abs(mean / (1000 * c) - 1));
  }
  for (int i = 0; i <= 90; ++i) cosine.x.push_back(i), cosine.y.push_back(1000 * std::cos(i * M_PI / 180));
  plot.series = {cosine, flux, over};
  return {
      svg_plot(plot),
      fmt::format("Traced within {:.2g} of the cosine: the detector changes, the light does not.", worst)};
}

LightCurves baffled_detector(std::int64_t spp, const std::atomic<bool>& stop) {
  Plot plot{"A detector behind baffles under an overcast sky",
            "half-angle, degrees",
            "mean radiance over that of the zenith",
            {},
            false};
  PlotSeries traced = traced_points("traced", kLightColors[0]), exact;
  exact.label = "(1 + 2 cos)/3, in the mean", exact.color = kLightColors[1];
  // The sky has L = L_z (1 + 2 cos)/3 and an illuminance of pi L_z 7/9.
  constexpr double kZenith = 1000;
  double worst = 0;
  // Few directions of the sky pass a narrow baffle, which gets more samples for it.
  const auto mean_of_cone = [](double angle) {
    const double c = std::cos(angle), s2 = std::sin(angle) * std::sin(angle);
    return 1.0 / 3 + 4.0 / 9 * (1 - c * c * c) / s2;
  };
  for (const double degrees : {3.0, 6.0, 12.0, 20.0, 30.0, 45.0, 60.0, 80.0}) {
    if (stop) break;
    const double angle = degrees * M_PI / 180;
    const auto [mean, error] = reading_of(
        small_receiver("", "illuminance") +
            fmt::format(
                "<shape type='cylinder'><point name='p0' x='0' y='0' z='-1'/><point name='p1' x='0' y='0' z='1'/>"
                "<float name='radius' value='{:.9g}'/><bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf></shape>",
                std::tan(angle)) +
            fmt::format("<emitter type='ciesky'><string name='amount' value='{:.9g} lx'/></emitter>",
                        M_PI * kZenith * 7 / 9),
        std::int64_t(double(spp) * std::min(200.0, 1 / (std::sin(angle) * std::sin(angle)))), stop);
    const double projected = M_PI * std::sin(angle) * std::sin(angle) * kZenith;
    add_reading(traced, degrees, mean / projected, error / projected);
    worst = std::max(worst, std::abs(mean / projected / mean_of_cone(angle) - 1));
  }
  for (int i = 1; i <= 88; ++i) exact.x.push_back(i), exact.y.push_back(mean_of_cone(i * M_PI / 180));
  plot.series = {exact, traced};
  return {
      svg_plot(plot),
      fmt::format(
          "Flux over area and projected solid angle: the narrower the baffle, the nearer to the radiance of the "
          "zenith. Traced within {:.2g} of the integral.",
          worst)};
}

LightCurves lambertian_disc(std::int64_t spp, const std::atomic<bool>& stop) {
  Plot plot{"A Lambertian disc of 100 cd/m^2 and 1 m^2", "direction, degrees", "cd/m^2 and cd", {}, false};
  PlotSeries radiance = traced_points("luminance", kLightColors[1]),
             intensity = traced_points("luminous intensity", kLightColors[0]), cosine;
  cosine.label = "100 cos", cosine.color = kLightColors[0];
  const std::string disc = fmt::format(
      "<shape type='disk'><transform name='to_world'><scale value='{:.9g}'/></transform><emitter type='area'>"
      "<string name='amount' value='100 cd/m^2'/></emitter></shape>",
      1 / std::sqrt(M_PI));
  double worst = 0;
  for (int degrees = 0; degrees <= 80 && !stop; degrees += 10) {
    const double a = degrees * M_PI / 180, s = std::sin(a), c = std::cos(a);
    const std::string film =
        "<film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/><rfilter type='box'/><string name='quantity' value='";
    const auto [l, le] = reading_of(
        fmt::format(
            "<sensor type='radiancemeter'><transform name='to_world'><lookat origin='{:.9g},0,{:.9g}' target='0,0,0' "
            "up='0,1,0'/></transform>",
            5 * s, 5 * c) +
            film + "luminance'/></film></sensor>" + disc,
        spp, stop);
    // The illuminance on a small receiver at 100 m that faces the disc, times the square of the distance.
    const auto [e, ee] = reading_of(
        "<sensor type='powermap'><string name='measure' value='irradiance'/>" +
            fmt::format(
                "<transform name='to_world'><scale value='0.01'/><lookat origin='{:.9g},0,{:.9g}' target='0,0,0' up='0,1,0'/></transform>",
                100 * s, 100 * c) +
            film + "illuminance'/></film></sensor>" + disc,
        spp, stop);
    add_reading(radiance, degrees, l, le), add_reading(intensity, degrees, 1e4 * e, 1e4 * ee);
    worst = std::max({worst, std::abs(l / 100 - 1), std::abs(1e4 * e / (100 * c) - 1)});
  }
  for (int i = 0; i <= 90; ++i) cosine.x.push_back(i), cosine.y.push_back(100 * std::cos(i * M_PI / 180));
  plot.series = {cosine, radiance, intensity};
  return {svg_plot(plot), fmt::format("Traced within {:.2g} of 100 cd/m^2 and of Lambert's cosine.", worst)};
}

LightCurves coverage_by_scale(int grains, std::uint64_t seed) {
  // Grains of radius 1 at places without order, denser in broad bands, in a square whose side holds the stated number.
  constexpr double kBands = 3;
  const double side = std::sqrt(grains * M_PI / 0.3);
  std::vector<std::array<double, 2>> places;
  auto random = [&, n = std::uint64_t(0)]() mutable {
    return double(combine_bits(seed, n++) >> 11) * 0x1p-53;
  };
  while (places.size() < std::size_t(grains)) {
    const double x = random() * side, y = random() * side;
    if (random() < 0.5 + 0.5 * std::cos(2 * M_PI * kBands * x / side)) places.push_back({x, y});
  }
  Plot plot{"A property by scale",
            "decimal logarithm of the window's side over the radius of a grain",
            "fraction of the window that grains cover",
            {},
            false};
  const double centers[3] = {0.333, 0.36, 0.42};
  for (int k = 0; k < 3; ++k) {
    PlotSeries s;
    s.label = fmt::format("at {:.3f} of the side", centers[k]), s.color = kLightColors[k];
    for (double w = 0.3; w < 0.6 * side; w *= 1.12) {
      const double cx = centers[k] * side, cy = 0.5 * side;
      // Points of a grid over the window, of which each grain covers some; grains may overlap.
      constexpr int kPoints = 128;
      std::vector<char> covered(std::size_t(kPoints) * kPoints, 0);
      const double step = w / kPoints, left = cx - 0.5 * w, bottom = cy - 0.5 * w;
      for (const auto& p : places) {
        if (std::abs(p[0] - cx) > 0.5 * w + 1 || std::abs(p[1] - cy) > 0.5 * w + 1) continue;
        const auto index = [&](double at) {
          return int(std::clamp(std::floor(at / step), 0.0, kPoints - 1.0));
        };
        for (int j = index(p[1] - 1 - bottom); j <= index(p[1] + 1 - bottom); ++j)
          for (int i = index(p[0] - 1 - left); i <= index(p[0] + 1 - left); ++i) {
            const double dx = left + (i + 0.5) * step - p[0], dy = bottom + (j + 0.5) * step - p[1];
            if (dx * dx + dy * dy <= 1) covered[std::size_t(j) * kPoints + std::size_t(i)] = 1;
          }
      }
      s.x.push_back(std::log10(w));
      s.y.push_back(double(std::count(covered.begin(), covered.end(), 1)) / double(covered.size()));
    }
    plot.series.push_back(s);
  }
  return {svg_plot(plot),
          "Grain by grain it is all or nothing; over ten to a hundred radii it settles, "
          "as radiometry takes it; over the bands of the material it changes again."};
}

}  // namespace aureole
