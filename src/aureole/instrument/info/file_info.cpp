// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/info/file_info.h"

#include <algorithm>
#include <cstdint>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/parameter/radiance/radiance_voxels.h"

namespace aureole {

namespace {

/// Whether a file begins as XML does.
bool is_xml(const std::filesystem::path& file) {
  if (lower_extension(file) == ".xml") return true;
  InputFile input(file);
  std::string start(std::min<std::uint64_t>(input.size(), 4096), '\0');
  input.read(start.data(), start.size());
  // Before the first character there may be blanks, a byte order mark and the zeros of UTF-16.
  const auto first =
      std::find_if(start.begin(), start.end(), [](unsigned char c) { return c > ' ' && c < 128; });
  return first != start.end() && *first == '<';
}

}  // namespace

FileInfo file_info(const std::filesystem::path& file,
                   const std::vector<std::pair<std::string, std::string>>& defines,
                   const std::shared_ptr<TableCache>& tables) {
  const bool is_radiance_grid = is_radiance_voxels_file(file);
  const bool holds_splats = is_splats(file);                          // .spz is gzip, as NIfTI may be
  const bool is_volume = !holds_splats && is_scalar_grid_file(file);  // .vti is XML, too
  if (!is_radiance_grid && !holds_splats && !is_volume && is_xml(file))
    return scene_info(file, defines, tables);
  if (!defines.empty()) throw Error("-D sets names of scenes: " + file.string() + " is not a scene file");
  if (is_radiance_grid) return radiance_grid_info(file);
  if (is_volume) return volume_info(file);
  if (holds_splats) return splat_info(file);
  if (lower_extension(file) == ".state") return state_info(file);
  if (is_image_file(file)) return picture_info(file);
  throw Error(
      {file.string(), 0, 0},
      "is neither a scene file (XML) nor a picture (EXR, PNG, JPEG, TIFF, PFM, HDR, TGA, BMP) nor a volume "
      "(NRRD, MetaImage, NIfTI, .vti, .npy, .vol), splats (PLY, .spz, .splat, glTF, .usda), a radiance grid (.npz) nor a .state file");
}

}  // namespace aureole
