// SPDX-License-Identifier: Apache-2.0
// aureole compare: the difference of two pictures, tested against their noise.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <string>

#include "aureole/instrument/picture/picture_comparison.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

/// Prints the comparison of one layer.
void report(const LayerComparison& layer) {
  const Comparison& c = layer.comparison;
  fmt::print("channels   {}\n", fmt::join(c.channels, ", "));
  fmt::print("mean       {:.6g} and {:.6g} ({:+.3f} %)\n", c.mean_a, c.mean_b,
             100 * (c.mean_a / c.mean_b - 1));
  fmt::print("RMSE       {:.6g}\n", c.rmse);
  fmt::print("relMSE     {:.6g}\n", c.relative_mse);
  fmt::print("max        {:.6g} at ({}, {})\n", c.max, c.max_x, c.max_y);
  const bool is_tested = c.not_finite == 0 && c.max != 0;
  if (is_tested && !c.z)
    fmt::print(
        "z-test     needs variances: render both with --replicates 16 or more (or one, against a reference "
        "with variances)\n");
  if (is_tested && c.z) {
    fmt::print(
        "z-test     mean of z^2 {:.4f} (expect {} to {}), outside {:.4f} % of {} values (at most {} %), image "
        "mean {:+.2f} standard errors\n",
        c.z->mean_square, kZMeanSquareMin, kZMeanSquareMax, 100 * c.z->outside, c.z->count,
        100 * kZOutsideMax, c.z->mean_difference);
    if (!c.z->judges_values()) fmt::print("           single values are not judged by so few replicates\n");
  }
  if (const std::string verdict = verdict_text(layer.verdict, c); !verdict.empty())
    fmt::print("verdict    {}\n", verdict);
}

int compare(const std::string& a_file, const std::string& b_file, const std::string& map_file) {
  ExrAttributes of_a, of_b;
  const Image a = read_picture(a_file, &of_a), b = read_picture(b_file, &of_b);
  const PictureComparison found = compare_pictures(a, b, {replicates_of(of_a), replicates_of(of_b)});
  for (const LayerComparison& layer : found.layers) {
    if (found.layers.size() > 1)
      fmt::print("{}layer      {}\n", &layer == &found.layers[0] ? "" : "\n",
                 layer.layer.empty() ? "colour" : layer.layer);
    report(layer);
  }
  if (const Comparison map = found.z_map(); !map_file.empty() && !map.z_map.pixels.empty())
    write_z_map(map, map_file);
  return found.is_same() ? 0 : 1;
}

std::function<int()> declare(CommandOptions& options) {
  auto a = std::make_shared<std::string>(), b = std::make_shared<std::string>(),
       map = std::make_shared<std::string>();
  options.add("a", *a, "picture").required();
  options.add("b", *b, "reference").required();
  options.add("--z-map", *map, "write the z-values as a PNG (blue -4, white 0, red +4)").names_output();
  return [=] { return compare(*a, *b, *map); };
}

AUREOLE_COMMAND("compare",
                "Compare two pictures: RMSE, relMSE, largest difference, z-test if variances are stored",
                declare);

}  // namespace
}  // namespace aureole
