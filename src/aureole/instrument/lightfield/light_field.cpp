// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/lightfield/light_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

namespace {

struct WeightedView {
  int x, y;
  double weight;
};

/// The views that a picture is made of.
std::vector<WeightedView> views_for(const LightFieldAxes& f, double x, double y, double diameter) {
  std::vector<WeightedView> views;
  if (diameter > 0) {
    for (int j = 0; j < f.views_y; ++j)
      for (int i = 0; i < f.views_x; ++i) {
        const auto p = f.position(i, j);
        if (std::hypot(p[0] - x, p[1] - y) <= 0.5 * diameter) views.push_back({i, j, 1});
      }
    return views;
  }
  // The place between the middles of the cells, bilinear; beyond the outer ones the nearest.
  const double a = std::clamp((x / f.aperture_width + 0.5) * f.views_x - 0.5, 0.0, f.views_x - 1.0),
               b = std::clamp((y / f.aperture_height + 0.5) * f.views_y - 0.5, 0.0, f.views_y - 1.0);
  const int i = std::min(int(a), std::max(0, f.views_x - 2)),
            j = std::min(int(b), std::max(0, f.views_y - 2));
  for (int dj = 0; dj < 2; ++dj)
    for (int di = 0; di < 2; ++di) {
      const double weight = (di ? a - i : 1 - (a - i)) * (dj ? b - j : 1 - (b - j));
      if (weight > 0) views.push_back({i + di, j + dj, weight});
    }
  return views;
}

}  // namespace

LightField light_field_of(Image picture, const std::string& axes, const std::string& name) {
  const LightFieldAxes found = parse_light_field_axes(axes, picture.width, picture.height, name);
  return {found, std::move(picture)};
}

LightFieldAxes light_field_axes(const Properties& p, const Film& film) {
  if (p.type() != "lightfield")
    throw Error(p.where(),
                "the sensor is a \"" + p.type() + "\"; a light field needs the sensor \"lightfield\"");
  if (film.crop_width() != film.width() || film.crop_height() != film.height())
    throw Error(film.properties().where(),
                "the film has a crop; a light field is the whole film, which holds all its views");
  LightFieldAxes f;
  f.views_x = int(p.get_int("views_x", 8)), f.views_y = int(p.get_int("views_y", f.views_x));
  f.width = film.width() / f.views_x, f.height = film.height() / f.views_y;
  f.aperture_width = p.get_float("aperture_width", 1),
  f.aperture_height = p.get_float("aperture_height", f.aperture_width);
  f.plane_distance = p.get_float("plane_distance", 1), f.field_width = p.get_float("field_width", 1);
  return f;
}

Image light_field_picture(const LightField& f, double x, double y, double diameter, double focus) {
  if (!(focus > 0)) throw Error("the distance of focus must be positive");
  const std::vector<WeightedView> views = views_for(f.axes, x, y, diameter);
  if (views.empty()) throw Error("no view of the light field lies in this aperture: make it larger");
  const std::size_t channels = f.mosaic.channel_count();
  Image picture{f.axes.width, f.axes.height, f.mosaic.channels, {}, false};
  picture.pixels.assign(std::size_t(picture.width) * std::size_t(picture.height) * channels, 0.f);
  const double pixel = f.axes.field_width / f.axes.width, shift = 1 - f.axes.plane_distance / focus;
  std::vector<double> sums(channels);
  for (int v = 0; v < picture.height; ++v)
    for (int u = 0; u < picture.width; ++u) {
      std::fill(sums.begin(), sums.end(), 0.0);
      double weights = 0;
      for (const WeightedView& view : views) {
        // The ray from the view's place to the point of the plane in focus that the pixel of a camera at (x, y) shows.
        const auto place = f.axes.position(view.x, view.y);
        const double a = u + (place[0] - x) * shift / pixel, b = v + (place[1] - y) * shift / pixel;
        if (a < -0.5 || b < -0.5 || a > picture.width - 0.5 || b > picture.height - 0.5) continue;
        const double ca = std::clamp(a, 0.0, picture.width - 1.0),
                     cb = std::clamp(b, 0.0, picture.height - 1.0);
        const int i = std::min(int(ca), std::max(0, picture.width - 2)),
                  j = std::min(int(cb), std::max(0, picture.height - 2));
        for (int dj = 0; dj < 2; ++dj)
          for (int di = 0; di < 2; ++di) {
            const double w = view.weight * (di ? ca - i : 1 - (ca - i)) * (dj ? cb - j : 1 - (cb - j));
            if (!(w > 0)) continue;
            const int px = view.x * picture.width + i + di, py = view.y * picture.height + j + dj;
            for (std::size_t c = 0; c < channels; ++c) sums[c] += w * double(f.mosaic.at(px, py, c));
          }
        weights += view.weight;
      }
      for (std::size_t c = 0; c < channels; ++c)
        picture.at(u, v, c) = weights > 0 ? float(sums[c] / weights) : 0.f;
    }
  return picture;
}

}  // namespace aureole
