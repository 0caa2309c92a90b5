// SPDX-License-Identifier: Apache-2.0
// aureole compare: the difference of two pictures, tested against their noise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/render/statistics.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

/// A picture, and the number of replicates from which its variances were computed; 0 if the file does not
/// state it.
struct Pictured {
  Image image;
  int replicates = 0;
};
Pictured read(const std::string& file) {
  ExrAttributes attributes;
  Pictured p{read_picture(file, &attributes)};
  if (const auto found = attributes.integers.find("aureole:replicates"); found != attributes.integers.end())
    p.replicates = found->second;
  return p;
}

/// Prints the comparison of one layer; returns the exit code.
int report(const Comparison& c) {
  fmt::print("channels   {}\n", fmt::join(c.channels, ", "));
  fmt::print("mean       {:.6g} and {:.6g} ({:+.3f} %)\n", c.mean_a, c.mean_b,
             100 * (c.mean_a / c.mean_b - 1));
  fmt::print("RMSE       {:.6g}\n", c.rmse);
  fmt::print("relMSE     {:.6g}\n", c.relative_mse);
  fmt::print("max        {:.6g} at ({}, {})\n", c.max, c.max_x, c.max_y);
  if (c.not_finite > 0) {
    fmt::print("verdict    DIFFERENT: {} values are NaN or infinite\n", c.not_finite);
    return 1;
  }
  if (c.max == 0) {
    fmt::print("verdict    identical\n");
    return 0;
  }
  if (!c.z) {
    fmt::print(
        "z-test     needs variances: render both with --replicates 16 or more (or one, against a reference "
        "with variances)\n");
    return 0;
  }
  fmt::print(
      "z-test     mean of z^2 {:.4f} (expect {} to {}), outside {:.4f} % of {} values (at most {} %), image "
      "mean {:+.2f} standard errors\n",
      c.z->mean_square, kZMeanSquareMin, kZMeanSquareMax, 100 * c.z->outside, c.z->count, 100 * kZOutsideMax,
      c.z->mean_difference);
  if (!c.z->judges_values()) fmt::print("           single values are not judged by so few replicates\n");
  if (c.z->has_too_few_replicates())
    fmt::print(
        "verdict    UNDECIDED: the variances are those of too few replicates: render with --replicates 4 or more\n");
  else if (c.z->shares_noise())
    fmt::print(
        "verdict    UNDECIDED: they differ by much less than their noise, so that they share random numbers, or "
        "one has the samples of the other. Render one of them with another seed of its sampler\n");
  else
    fmt::print("verdict    {}\n", c.z->passes ? "the same within noise" : "DIFFERENT");
  return c.z->passes ? 0 : 1;
}

int compare(const std::string& a_file, const std::string& b_file, const std::string& map_file) {
  const Pictured a = read(a_file), b = read(b_file);
  const std::vector<std::string> layers = common_layers(a.image, b.image);
  if (layers.empty()) throw Error("the pictures have no colour channel in common");
  const Replicates replicates{a.replicates, b.replicates};
  int worst = 0;
  bool any_variances = false;
  Comparison all;  // comparison of all layers; its map has the z of largest magnitude
  for (const std::string& layer : layers) {
    if (layers.size() > 1)
      fmt::print("{}layer      {}\n", &layer == &layers[0] ? "" : "\n", layer.empty() ? "colour" : layer);
    const Comparison c =
        compare_images(layer_of(a.image, layer), layer_of(b.image, layer), kStorageRounding, replicates);
    worst = std::max(worst, report(c));
    if (all.z_map.pixels.empty())
      all.z_map = c.z_map;
    else
      for (std::size_t i = 0; i < c.z_map.pixels.size(); ++i)
        if (std::abs(c.z_map.pixels[i]) > std::abs(all.z_map.pixels[i]))
          all.z_map.pixels[i] = c.z_map.pixels[i];
    any_variances |= c.z.has_value();
  }
  if (!map_file.empty() && any_variances) write_z_map(all, map_file);
  return worst;
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
