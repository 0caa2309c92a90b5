// SPDX-License-Identifier: Apache-2.0
// Values on a dense grid, from a file of one of the formats that `read_scalar_grid` knows.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "aureole/core/memory.h"
#include "aureole/parameter/grid/grid_reader.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/parameter/voxel_data.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/volume/grid/voxel_volume.h"

namespace aureole {
namespace {

/// Names of three letters for the space of the axes, each letter the direction of increasing coordinates.
const std::vector<std::string> kSpaces = {"file", "RAS", "LPS", "LAS", "RAI", "LPI", "LAI", "RPS", "RPI"};

ScalarGridOptions read_options(const Properties& p) {
  ScalarGridOptions options;
  options.array = p.get_string("array", "");
  options.frame = int(p.get_int("frame", 0, {0, 1e6}));
  options.is_series = p.get_bool("series", false);
  if (p.has("file_unit")) options.unit_m = p.get_length_m("file_unit", 1e-3);
  if (const std::string space = p.get_choice("file_space", "file", kSpaces); space != "file")
    options.space = space;
  const auto vector = [&](const char* name) -> std::optional<std::array<double, 3>> {
    if (!p.has(name)) return std::nullopt;
    const Vec3 v = p.get_vec3(name, {});
    return std::array{double(v.x), double(v.y), double(v.z)};
  };
  options.spacing = vector("spacing"), options.origin = vector("origin");
  return options;
}

/// Returns a grid of an array that a program gives, whose numbers stay where they are.
ScalarGrid grid_of_array(const Properties& p, const Array& array, const ScalarGridOptions& options) {
  auto data = std::make_shared<const VoxelData>(voxels_of_array(array));
  ScalarGrid grid = grid_of_voxels(data);
  grid.format = "array";
  if (options.spacing || options.origin) grid_reader::place_by_options(grid, options);
  for (const char* name : {"frame", "series", "array"})
    if (p.has(name)) p.note(name, std::string(name) + " has no effect on an array of a program");
  return grid;
}

ScalarGrid read_grid(const Properties& p) {
  const auto given = p.get_object<Array>("data");
  if (given && p.has("filename")) throw p.error("data", "give either filename or data");
  const ScalarGridOptions options = read_options(p);
  const char* const parameter = given ? "data" : "filename";
  std::filesystem::path file;
  if (!given) file = p.get_file("filename");
  try {
    ScalarGrid grid = given ? grid_of_array(p, *given, options) : read_scalar_grid(file, options);
    for (const auto& further : grid.further_files)
      if (p.context().scene) p.context().scene->add_file(further);
    if (grid.frames > 1 && !p.has("frame"))
      p.note(parameter,
             fmt::format("\"{}\" has {} grids, of which the first is read; \"frame\" chooses another",
                         file.string(), grid.frames));
    for (const std::string& note : grid.notes) p.note(parameter, "\"" + file.string() + "\" " + note);
    try {
      grid.check_finite();
    } catch (const Error& problem) {
      throw given ? problem : Error({file.string(), 0, 0}, problem.message());
    }
    return grid;
  } catch (const Error& problem) {
    throw p.error(parameter, problem.what());
  }
}

/// Returns the transform from world space to [0, 1]^3.
Transform box_of(const Properties& p, const ScalarGrid& grid) {
  const Transform to_local = p.get_transform("to_world").inverse();
  const bool is_stated = grid.has_transform && grid.format != ".vol";
  const bool is_spaced = p.has("spacing") || p.has("origin");
  std::string placement =
      p.get_choice("placement", is_stated || is_spaced ? "file" : "unit_cube", {"file", "unit_cube"});
  if (p.get_bool("use_grid_bbox", false)) {
    if (placement == "unit_cube" && p.has("placement"))
      throw p.error("use_grid_bbox", "contradicts the placement \"unit_cube\"");
    placement = "file";
  }
  if (placement == "unit_cube") {
    for (const char* name : {"file_unit", "file_space", "spacing", "origin"})
      if (p.has(name))
        p.note(name, std::string(name) + " has no effect where the grid fills the unit cube (placement)");
    return to_local;
  }
  if (is_stated && !grid.spacing_is_stated && !p.has("spacing"))
    p.note("filename",
           "the file states no distance of its voxels, which is taken as 1 along each axis; \"spacing\" "
           "states it");
  const double unit_m = p.context().length_unit_m;
  // Boxes of .vol files have the scene's unit, as in Mitsuba.
  const bool is_scene_unit = grid.format == ".vol" && !p.has("file_unit");
  const Transform to_index = (is_scene_unit ? grid.index_to_ras : grid.index_to_world(unit_m)).inverse();
  return Transform::scale(1. / grid.size[0], 1. / grid.size[1], 1. / grid.size[2]) *
         Transform::translate(.5, .5, .5) * to_index * to_local;
}

class GridVolume final : public VoxelVolume {
public:
  explicit GridVolume(const Properties& p) : GridVolume(p, read_grid(p)) {}
  std::shared_ptr<const ScalarGrid> stored_grid() const override { return stored_.load(); }

private:
  GridVolume(const Properties& p, const ScalarGrid& grid)
      : VoxelVolume(p, box_of(p, grid), VoxelFilter::read(p)) {
    const char* const parameter = voxels_parameter(p, "data");
    const bool raw = p.get_bool("raw", false);
    p.get_bool("accel", true);
    if (p.has("accel")) p.note("accel", "has no effect");
    const int channels = grid.channels;
    if (channels != 1 && channels != 3 && channels != 6)
      throw p.error(parameter, fmt::format("has {} numbers at each voxel; 1, 3 (colours) and 6 are supported",
                                           channels));
    const bool colors = channels == 3 && !raw;
    const auto require_memory = [parameter](const Properties& of, double bytes) {
      // A mapped file of bytes may be larger, as floats, than the memory.
      if (const double free = available_memory_bytes(); bytes > free)
        throw of.error(parameter,
                       fmt::format("needs {:.0f} MiB of memory as float32, of which {:.0f} are available",
                                   bytes / (1 << 20), free / (1 << 20)));
    };
    const double count = double(grid.size[0]) * grid.size[1] * grid.size[2];
    if (channels != 1)
      require_memory(p, count * (colors ? sizeof(UpsampledColor) : sizeof(float) * std::size_t(channels)));
    // With `raw` numbers are used as the file states them; .vol files keep the treatment that scenes of media
    // rely on.
    const bool is_exact = raw && grid.has_transform && grid.format != ".vol";
    const bool is_denoised = colors || (channels == 1 && !is_exact);
    const std::array<float, 2> range = grid.range();
    NoiseClamp clamp(0, std::numeric_limits<double>::infinity(), std::max(range[1], 0.f));
    // Whole numbers miss a limit by rounding only where they are very large.
    const bool may_have_noise = grid.type >= ScalarType::float16 || grid.slope != 1 || grid.intercept != 0 ||
                                double(range[1]) * kLimitNoise >= 1;
    if (is_denoised && range[0] < 0 && may_have_noise) {
      for_each(grid, [&](float v) { clamp(v); });
      if (clamp.any()) p.note(parameter, clamp.note());
    }
    const auto fetch = [&](int x, int y, int z, int c) {
      const float v = grid.value(x, y, z, c);
      return is_denoised && v < 0 ? NoiseClamp(clamp)(v) : v;
    };
    if (channels == 1 && !clamp.any()) {
      stored_.store(std::make_shared<const ScalarGrid>(grid));
      set_later(grid.size, range, [this, parameter, count, require_memory] {
        const std::shared_ptr<const ScalarGrid> stored = stored_grid();
        require_memory(properties(), count * sizeof(float));
        try {
          Numbers bricks(
              stored->size, repeats(), [&](int x, int y, int z) { return stored->value(x, y, z); },
              [](auto&&...) { return std::optional<float>(); });
          stored_.store(nullptr);  // the numbers are held in memory only once
          return bricks;
        } catch (const Error& problem) {
          throw properties().error(parameter, problem.message());
        }
      });
      return;
    }
    if (channels == 1) require_memory(p, count * sizeof(float));
    if (colors && range[0] < 0) check_colors(p, grid, fetch, parameter);
    try {
      if (colors && !is_grey(grid, fetch))
        set_colors(grid, fetch);
      else
        set_numbers(grid, fetch, colors ? 1 : channels);
    } catch (const Error& problem) {
      throw p.error(parameter, problem.message());
    }
  }

  /// Calls visit(value) for all values, a voxel's channels first, then along x, y and z.
  template <class Visit>
  static void for_each(const ScalarGrid& grid, const Visit& visit) {
    for (int z = 0; z < grid.size[2]; ++z)
      for (int y = 0; y < grid.size[1]; ++y)
        for (int x = 0; x < grid.size[0]; ++x)
          for (int c = 0; c < grid.channels; ++c) visit(grid.value(x, y, z, c));
  }
  template <class Fetch>
  static void check_colors(const Properties& p, const ScalarGrid& grid, const Fetch& fetch,
                           const char* parameter) {
    for (int z = 0; z < grid.size[2]; ++z)
      for (int y = 0; y < grid.size[1]; ++y)
        for (int x = 0; x < grid.size[0]; ++x)
          for (int c = 0; c < grid.channels; ++c)
            if (const float v = fetch(x, y, z, c); v < 0)
              throw p.error(
                  parameter,
                  fmt::format(
                      "a colour must not be negative, but a voxel has {}; \"raw\" is for numbers that "
                      "are no colours",
                      v));
  }
  /// Whether all colours are grey, so that they need no spectrum.
  template <class Fetch>
  static bool is_grey(const ScalarGrid& grid, const Fetch& fetch) {
    for (int z = 0; z < grid.size[2]; ++z)
      for (int y = 0; y < grid.size[1]; ++y)
        for (int x = 0; x < grid.size[0]; ++x) {
          const float red = fetch(x, y, z, 0);
          if (red != fetch(x, y, z, 1) || red != fetch(x, y, z, 2)) return false;
        }
    return true;
  }

  template <class Fetch>
  void set_numbers(const ScalarGrid& grid, const Fetch& fetch, int count) {
    std::vector<Numbers> numbers;
    for (int c = 0; c < count; ++c)
      numbers.emplace_back(
          grid.size, repeats(), [&](int x, int y, int z) { return fetch(x, y, z, c); },
          [](auto&&...) { return std::optional<float>(); });
    set(std::move(numbers));
  }
  template <class Fetch>
  void set_colors(const ScalarGrid& grid, const Fetch& fetch) {
    const auto color = [&](int x, int y, int z) {
      return UpsampledColor::of_rgb_or_black(fetch(x, y, z, 0), fetch(x, y, z, 1), fetch(x, y, z, 2));
    };
    set(Colors(grid.size, repeats(), color, [](auto&&...) { return std::optional<UpsampledColor>(); }));
  }

  /// grid of one number at each voxel, as stored in the file
  std::atomic<std::shared_ptr<const ScalarGrid>> stored_;
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = {
      {"filename", "file", "", "required, or data",
       "a file of 1, 3 or 6 numbers at each voxel: .vol, NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), NIfTI (.nii, "
       ".nii.gz, .hdr), .vti, .npy or TIFF, recognised by its first bytes (docs/volume_files.md)"},
      {"data", "array", "", "none",
       "instead of filename, from Python: depth x height x width [x 1, 3 or 6] numbers"},
      {"to_world", "transform", "", "identity",
       "transform from the unit cube [0, 1]^3 (or from the file's position in space, see placement) to world space"},
      {"placement", "string", "", "unit_cube for .vol, .npy, TIFF and data; file for others",
       "unit_cube: the grid fills the unit cube, before to_world; file: it lies where the file says, in RAS "
       "coordinates and the scene's unit of length. By default \"file\", too, where spacing or origin is given"},
      {"use_grid_bbox", "boolean", "", "false",
       "the grid fills the box stored in the file, instead of the unit cube, before to_world: placement is \"file\""},
      {"file_unit", "string", "length", "the file's, else 1mm",
       "the file's unit of length, instead of the one that it states; .vol: the scene's unit"},
      {"file_space", "string", "", "file",
       "directions of increasing coordinates in the file, such as RAS or LPS, instead of those that it states"},
      {"spacing", "vector", "", "1, 1, 1",
       "distance of neighbouring voxels along x, y, z in the file's unit, for files that state none and for data"},
      {"origin", "point", "", "0, 0, 0", "centre of the first voxel in the file's unit, for those files"},
      {"array", "string", "", "the active scalars, else the first", "name of an array of a .vti file"},
      {"frame", "integer", "", "0", "which of the grids of a file with several, such as instants"},
      {"series", "boolean", "", "false",
       "the file is a TIFF of one slice: all files of its folder whose names differ in the last number are slices"},
      {"raw", "boolean", "", "false",
       "three numbers are a vector, not a colour, and have no spectrum; negative numbers by rounding stay (but in "
       ".vol)"},
      {"accel", "boolean", "", "true", "accepted for compatibility with Mitsuba, without effect"}};
  const std::vector<ParameterDoc> filter = VoxelFilter::rows();
  all.insert(all.begin() + 2, filter.begin(), filter.end());
  return all;
}

AUREOLE_PLUGIN(
    GridVolume, "volume", "gridvolume",
    PluginDoc{
        "Values on a regular grid, from one of the formats in docs/volume_files.md. One number per voxel is the "
        "value at every wavelength; three are a colour, which becomes a spectrum like a texture's "
        "(docs/conventions.md); spectra are interpolated. As an emission both multiply D65. Six "
        "are numbers without spectrum, such as a symmetric matrix.",
        "",
        rows(),
        {R"(<volume type="gridvolume">
    <string name="filename" value="smoke.vol"/>
    <boolean name="use_grid_bbox" value="true"/>
    <transform name="to_world">
        <scale value="2"/>
    </transform>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="smoke.vol"/>
    <string name="filter_type" value="nearest"/>
    <string name="wrap_mode" value="repeat"/>
    <boolean name="raw" value="false"/>
    <boolean name="accel" value="false"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="head.nii"/>
    <boolean name="raw" value="true"/>
    <integer name="frame" value="0"/>
    <string name="placement" value="file"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="head.nrrd"/>
    <string name="file_unit" value="1cm"/>
    <string name="file_space" value="LPS"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="head.mha"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="flow.vti"/>
    <string name="array" value="density"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="stack.tif"/>
    <boolean name="series" value="false"/>
    <vector name="spacing" x="0.5" y="0.5" z="1.2"/>
    <point name="origin" x="-10" y="-10" z="0"/>
</volume>)",
         R"(<volume type="gridvolume">
    <string name="filename" value="density.npy"/>
</volume>)"}});

}  // namespace
}  // namespace aureole
