// SPDX-License-Identifier: Apache-2.0
// Descriptions of files of splats and of radiance grids, for `aureole info`.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "aureole/core/image.h"
#include "aureole/core/letter_case.h"
#include "aureole/instrument/info/file_info.h"
#include "aureole/instrument/info/printed_text.h"
#include "aureole/parameter/radiance/radiance_voxels.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_cloud.h"

namespace aureole {

bool is_splats(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".ply" || extension == ".glb" || extension == ".gltf" || extension == ".usda" ||
         is_splat_file(file);
}

FileInfo splat_info(const std::filesystem::path& file) {
  FileInfo info{"splats", "", {}};
  std::string& out = info.text;
  const SplatCloud cloud = read_splat_file(file);
  for (const std::string& note : cloud.notes) info.notes.push_back(file.string() + " " + note);
  const bool is_points = cloud.kind == SplatCloud::Kind::points;
  add_text(out, "splats       {} ({})\n", file.string(), cloud.format);
  add_text(out, "count        {} {}\n", cloud.size(), is_points ? "points" : "Gaussian splats");
  add_text(out, "axes         {} in the file; here x right, y up, z back\n", cloud.axes);
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
  add_text(out, "centres      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", box.lower.x,
           box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
  add_text(out, "{}       {:.4g} to {:.4g}{}\n", is_points ? "radii " : "scales", least, most,
           cloud.has_normals ? ", with normals" : "");
  add_text(out, "opacity      {:.4g} on average\n", opacity / double(cloud.size()));
  add_text(out, "harmonics    degree {}\n", cloud.degree);
  const SplatHints& h = cloud.hints;
  add_text(out, "conventions  sorted by {}, {} projection, {} colours{}\n",
           h.sorting == SplatHints::Sorting::z_depth ? "depth" : "distance",
           h.projection == SplatHints::Projection::tangential ? "tangential" : "perspective",
           h.colors == SplatHints::Colors::srgb ? "sRGB" : "linear",
           h.antialiased ? ", opacities compensated for dilation" : "");
  add_text(out, "memory       {:.1f} MB\n", double(cloud.memory_bytes()) / 1e6);
  return info;
}

FileInfo radiance_grid_info(const std::filesystem::path& file) {
  FileInfo info{"radiance grid", "", {}};
  std::string& out = info.text;
  const RadianceVoxels g = read_radiance_voxels(file);
  for (const std::string& note : g.notes) info.notes.push_back(file.string() + " " + note);
  add_text(out, "radiance     {} (.npz of Plenoxels)\n", file.string());
  add_text(out, "size         {} x {} x {} voxels, {} of them stored\n", g.size[0], g.size[1], g.size[2],
           g.stored());
  const Vec3 lower = g.center - g.radius, upper = g.center + g.radius;
  add_text(out, "box          ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", lower.x, lower.y,
           lower.z, upper.x, upper.y, upper.z);
  const auto [least, most] = std::minmax_element(g.densities.begin(), g.densities.end());
  add_text(out, "densities    {:.4g} to {:.4g} per length\n", *least, *most);
  add_text(out, "harmonics    degree {}\n", g.degree);
  add_text(out, "memory       {:.1f} MB\n", double(g.memory_bytes()) / 1e6);
  return info;
}

GridSlice radiance_grid_slice(const std::filesystem::path& file, int axis) {
  const RadianceVoxels g = read_radiance_voxels(file);
  std::size_t u, v;
  GridSlice slice = middle_slice(g.size, axis, u, v);
  const std::array<float, 3> radius{g.radius.x, g.radius.y, g.radius.z};
  slice.spacing = {2 * double(radius[u]) / slice.width, 2 * double(radius[v]) / slice.height};
  std::array<int, 3> at{};
  at[std::size_t(axis)] = slice.index;
  for (at[v] = 0; at[v] < slice.height; ++at[v])
    for (at[u] = 0; at[u] < slice.width; ++at[u]) {
      const std::int32_t link = g.links[g.link_index(at[0], at[1], at[2])];
      slice.values.push_back(link < 0 ? 0 : g.densities[std::size_t(link)]);
    }
  return slice;
}

SplatPoints splat_points(const std::filesystem::path& file, std::size_t most) {
  const SplatCloud cloud = read_splat_file(file);
  SplatPoints points;
  points.count = cloud.size();
  const std::size_t step = std::max<std::size_t>(1, (cloud.size() + most - 1) / most);
  const auto shown = [&](float coefficient) {
    const float c = std::clamp(0.5f + kHarmonic0 * coefficient, 0.f, 1.f);
    return cloud.hints.colors == SplatHints::Colors::linear ? srgb_encode(c) : c;
  };
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    const float* c = cloud.harmonics_of(i);
    points.positions.push_back(cloud.positions[i]);
    points.colors.push_back({shown(c[0]), shown(c[1]), shown(c[2])});
    points.opacities.push_back(cloud.opacities[i]);
  }
  return points;
}

}  // namespace aureole
