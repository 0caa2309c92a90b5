// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_volume_plots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "aureole/core/error.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/integrator/dvr/scene_checks.h"
#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "scene_loading.h"

namespace aureole {
namespace {

using IntegratorParameters = std::vector<LoadOptions::Parameter>;

struct StepForm {
  const char *label, *color;
  IntegratorParameters parameters;
};

const std::vector<StepForm>& step_forms() {
  static const std::vector<StepForm> all{
      {"opacity_weighted", "#2050c0", {}},
      {"premultiplied", "#c03020", {{"string", "form", "premultiplied"}}},
      {"taylor", "#806020", {{"string", "alpha", "taylor"}}},
      {"preintegrated", "#208030", {{"string", "classification", "preintegrated"}}},
      {"by_opacity", "#802080", {{"string", "steps", "by_opacity"}}},
  };
  return all;
}

double mean_difference(const Image& a, const Image& b) {
  double difference = 0, total = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        difference += std::abs(double(a.at(x, y, c)) - double(b.at(x, y, c)));
        total += double(b.at(x, y, c));
      }
  return total > 0 ? difference / total : 0;
}

}  // namespace

VolumeCurves steps_against_error(const std::filesystem::path& scene, const std::vector<double>& steps,
                                 int width, int height, const std::atomic<bool>& stop) {
  LoadOptions load = load_options({});
  load.defines = {{"width", std::to_string(width)}, {"height", std::to_string(height)}};
  const LoadedScene as_stated = load_scene(scene, load);
  const auto media = classified_media(*as_stated.scene);
  if (media.empty()) throw Error(scene.string() + ": has no medium of the type \"classified\"");
  const double voxel = double(media.front()->field().spacing());
  const auto picture = [&](double voxels, const IntegratorParameters& parameters) {
    LoadOptions options = load;
    options.integrator_parameters = parameters;
    options.integrator_parameters.push_back({"float", "step", fmt::format("{:.9g}", voxels * voxel)});
    RenderOptions render;
    render.end = 1;
    RenderJob job(load_scene(scene, options), render);
    job.run(stop);
    return job.state().rgb_picture();
  };
  const Image reference = picture(1. / 32, {{"string", "classification", "preintegrated"}});
  Plot plot{"Steps against error",
            "log2 of the step in voxels",
            "mean absolute error, per cent of the mean",
            {},
            true};
  std::vector<std::string> numbers;
  for (const StepForm& form : step_forms()) {
    PlotSeries series{.kind = PlotSeries::Kind::line, .x = {}, .y = {}, .low = {}, .high = {}};
    series.label = form.label, series.color = form.color;
    for (const double step : steps) {
      if (stop) return {};
      series.x.push_back(std::log2(step));
      series.y.push_back(100 * mean_difference(picture(step, form.parameters), reference));
    }
    numbers.push_back(fmt::format("{} {:.2g}", form.label, fmt::join(series.y, ", ")));
    plot.series.push_back(std::move(series));
  }
  return {svg_plot(plot), fmt::format("Steps of {:g} voxels, errors in per cent: {}.", fmt::join(steps, ", "),
                                      fmt::join(numbers, "; "))};
}

}  // namespace aureole
