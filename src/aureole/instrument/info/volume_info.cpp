// SPDX-License-Identifier: Apache-2.0
// Description of a volume's file, for `aureole info`.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/instrument/info/file_info.h"
#include "aureole/instrument/info/printed_text.h"
#include "aureole/parameter/grid/scalar_grid.h"

namespace aureole {

namespace {

std::string unit_name(double unit_m) {
  for (const auto& [name, m] : {std::pair{"m", 1.}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}})
    if (std::abs(unit_m / m - 1) < 1e-9) return name;
  return fmt::format("units of {:g} m", unit_m);
}

}  // namespace

FileInfo volume_info(const std::filesystem::path& file) {
  FileInfo info{"volume", "", {}};
  std::string& out = info.text;
  const ScalarGrid grid = read_scalar_grid(file);
  for (const std::string& note : grid.notes) info.notes.push_back(file.string() + " " + note);
  add_text(out, "volume       {} ({})\n", file.string(), grid.format);
  add_text(out, "size         {} x {} x {} voxels, {} number{} each{}\n", grid.size[0], grid.size[1],
           grid.size[2], grid.channels, grid.channels == 1 ? "" : "s",
           grid.frames > 1 ? fmt::format(", {} frames, of which the first is described", grid.frames) : "");
  add_text(out, "type         {}{}\n", name_of(grid.type),
           grid.slope != 1 || grid.intercept != 0
               ? fmt::format(", times {:.9g} plus {:.9g}", grid.slope, grid.intercept)
               : "");
  const auto [dx, dy, dz] = grid.spacing();
  const std::string unit = unit_name(grid.unit_m);
  add_text(out, "spacing      {:.7g} x {:.7g} x {:.7g} {}{}\n", dx, dy, dz, unit,
           !grid.spacing_is_stated ? " (the file states none)"
           : grid.unit_is_stated   ? ""
           : grid.format == ".vol" ? " (in scenes the scene's unit: the file states none)"
                                   : " (the file states no unit)");
  const Transform::Matrix& m = grid.index_to_ras.matrix();
  const bool is_anatomical = !grid.space.empty();
  add_text(out, "origin       ({:.7g}, {:.7g}, {:.7g}) {}, centre of the first voxel{}\n", m[0][3], m[1][3],
           m[2][3], unit,
           is_anatomical ? fmt::format(", in RAS coordinates (the file's are {})", grid.space)
                         : ", in the file's coordinates");
  const std::array<double, 3> d = grid.spacing();
  for (std::size_t k = 0; k < 3; ++k)
    add_text(out, "{:<12} {} along ({:.6f}, {:.6f}, {:.6f})\n", k == 0 ? "orientation" : "", "xyz"[k],
             m[0][k] / d[k] + 0.0, m[1][k] / d[k] + 0.0, m[2][k] / d[k] + 0.0);  // 0 instead of -0
  const auto [low, high] = grid.range();
  add_text(out, "values       {} to {}\n", shown_number(low), shown_number(high));
  try {
    grid.check_finite();
  } catch (const Error& problem) {
    add_text(out, "             {}\n", problem.message());
  }
  if (!grid.further_files.empty())
    add_text(out, "numbers in   {}{}\n", grid.further_files[0].string(),
             grid.further_files.size() > 1 ? fmt::format(" and {} more files", grid.further_files.size() - 1)
                                           : "");
  return info;
}

GridSlice volume_slice(const std::filesystem::path& file, int axis) {
  const ScalarGrid grid = read_scalar_grid(file);
  std::size_t u, v;
  GridSlice slice = middle_slice(grid.size, axis, u, v);
  slice.spacing = {grid.spacing()[u], grid.spacing()[v]};
  slice.values.resize(std::size_t(slice.width) * std::size_t(slice.height));
  for (int row = 0; row < slice.height; ++row) {
    const std::span<float> out(slice.values.data() + std::size_t(row) * std::size_t(slice.width),
                               std::size_t(slice.width));
    if (axis == 0)
      for (int y = 0; y < slice.width; ++y) out[std::size_t(y)] = grid.value(slice.index, y, row);
    else
      grid.read_row(0, axis == 1 ? slice.index : row, axis == 1 ? row : slice.index, 0, out);
  }
  return slice;
}

}  // namespace aureole
