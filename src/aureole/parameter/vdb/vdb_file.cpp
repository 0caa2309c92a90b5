// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/vdb/vdb_file.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/parameter/vdb/vdb_module.h"

namespace aureole {

namespace {

/// Folders that may contain the module: next to the program or the Python module, or its installation folder.
std::vector<std::filesystem::path> module_folders() {
  std::vector<std::filesystem::path> folders;
  const auto add = [&](const std::filesystem::path& of) {
    std::error_code ignored;
    const std::filesystem::path file = std::filesystem::canonical(of, ignored);
    if (file.empty()) return;
    folders.push_back(file.parent_path());
    folders.push_back(file.parent_path().parent_path() / "lib" / "aureole");
  };
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&read_nvdb), &self) && self.dli_fname) add(self.dli_fname);
  add("/proc/self/exe");
  return folders;
}

ReadVdb* load_module() {
  std::string problem = "it is not there";
  for (const std::filesystem::path& folder : module_folders()) {
    const std::filesystem::path file = folder / kVdbModuleFile;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) continue;
    void* const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (void* const function = handle ? dlsym(handle, kVdbModuleFunction) : nullptr)
      return reinterpret_cast<ReadVdb*>(function);
    if (const char* text = dlerror()) problem = text;
  }
  throw Error(std::string("needs the module ") + kVdbModuleFile + ", which reads .vdb files (" + problem +
              "; it is built where OpenVDB is installed); .nvdb files are read without it");
}

void read_vdb(const std::filesystem::path& file, const std::optional<std::string>& grid, SparseFile& out) {
  static ReadVdb* const read = load_module();
  read(file.c_str(), grid ? grid->c_str() : nullptr, out);
}

void check_finite(const SparseVoxels& voxels) {
  bool finite = true;
  for (const float v : voxels.values) finite &= std::isfinite(v);
  for (const float v : voxels.background) finite &= std::isfinite(v);
  for (const SparseVoxels::Tile& tile : voxels.tiles)
    for (const float v : tile.value) finite &= std::isfinite(v);
  if (!finite) throw Error("the grid \"" + voxels.name + "\" holds values that are not finite");
}

}  // namespace

SparseVoxels read_vdb_file(const std::filesystem::path& file, const std::optional<std::string>& grid,
                           bool& unknown_grid) {
  unknown_grid = false;
  char magic[8] = {};
  {
    InputFile input(file);
    input.read(magic, std::min<std::uint64_t>(sizeof magic, input.size()));
  }
  SparseFile found;
  try {
    if (std::memcmp(magic, " BDV", 4) == 0)
      read_vdb(file, grid, found);
    else if (std::memcmp(magic, "NanoVDB", 7) == 0)
      read_nvdb(file, grid, found);
    else
      throw Error("is neither a .vdb nor a .nvdb file: it begins otherwise");
  } catch (const std::bad_alloc&) {
    throw Error("needs more memory than there is");
  }
  if (!found.error.empty()) throw Error(found.error);
  if (!found.found) {
    unknown_grid = true;
    std::string names;
    for (const std::string& name : found.grids) names += (names.empty() ? "\"" : ", \"") + name + "\"";
    throw Error("has no grid \"" + grid.value_or("") + "\" but " + names +
                did_you_mean(grid.value_or(""), found.grids));
  }
  if (found.voxels.empty) throw Error("the grid \"" + found.voxels.name + "\" has no active voxels");
  check_finite(found.voxels);
  return std::move(found.voxels);
}

}  // namespace aureole
