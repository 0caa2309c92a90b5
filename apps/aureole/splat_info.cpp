// SPDX-License-Identifier: Apache-2.0
// Descriptions of files of splats and of radiance grids, for `aureole info`.
#include <fmt/format.h>

#include <algorithm>

#include "aureole/parameter/radiance/radiance_voxels.h"
#include "aureole/parameter/splat/splat_cloud.h"
#include "messages.h"
#include "picture_info.h"

namespace aureole {

bool is_splats(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".ply" || extension == ".glb" || extension == ".gltf" || extension == ".usda" ||
         is_splat_file(file);
}

void print_splats(const std::filesystem::path& file) {
  const SplatCloud cloud = read_splat_file(file);
  for (const std::string& note : cloud.notes) tell("note: {} {}\n", file.string(), note);
  const bool is_points = cloud.kind == SplatCloud::Kind::points;
  fmt::print("splats       {} ({})\n", file.string(), cloud.format);
  fmt::print("count        {} {}\n", cloud.size(), is_points ? "points" : "Gaussian splats");
  fmt::print("axes         {} in the file; here x right, y up, z back\n", cloud.axes);
  Bounds3 box;
  float least = kInfinity, most = 0;  // of scales, or of radii
  double opacity = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    box.extend(cloud.positions[i]);
    const Vec3& s = cloud.scales[i];
    least = std::min(least, is_points ? s.x : std::min({s.x, s.y, s.z})),
    most = std::max(most, max_component(s));
    opacity += double(cloud.opacities[i]);
  }
  fmt::print("centres      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", box.lower.x, box.lower.y,
             box.lower.z, box.upper.x, box.upper.y, box.upper.z);
  fmt::print("{}       {:.4g} to {:.4g}{}\n", is_points ? "radii " : "scales", least, most,
             cloud.has_normals ? ", with normals" : "");
  fmt::print("opacity      {:.4g} on average\n", opacity / double(cloud.size()));
  fmt::print("harmonics    degree {}\n", cloud.degree);
  const SplatHints& h = cloud.hints;
  fmt::print("conventions  sorted by {}, {} projection, {} colours{}\n",
             h.sorting == SplatHints::Sorting::z_depth ? "depth" : "distance",
             h.projection == SplatHints::Projection::tangential ? "tangential" : "perspective",
             h.colors == SplatHints::Colors::srgb ? "sRGB" : "linear",
             h.antialiased ? ", opacities compensated for dilation" : "");
  fmt::print("memory       {:.1f} MB\n", double(cloud.memory_bytes()) / 1e6);
}

void print_radiance_voxels(const std::filesystem::path& file) {
  const RadianceVoxels g = read_radiance_voxels(file);
  for (const std::string& note : g.notes) tell("note: {} {}\n", file.string(), note);
  fmt::print("radiance     {} (.npz of Plenoxels)\n", file.string());
  fmt::print("size         {} x {} x {} voxels, {} of them stored\n", g.size[0], g.size[1], g.size[2],
             g.stored());
  const Vec3 lower = g.center - g.radius, upper = g.center + g.radius;
  fmt::print("box          ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", lower.x, lower.y, lower.z,
             upper.x, upper.y, upper.z);
  const auto [least, most] = std::minmax_element(g.densities.begin(), g.densities.end());
  fmt::print("densities    {:.4g} to {:.4g} per length\n", *least, *most);
  fmt::print("harmonics    degree {}\n", g.degree);
  fmt::print("memory       {:.1f} MB\n", double(g.memory_bytes()) / 1e6);
}

}  // namespace aureole
