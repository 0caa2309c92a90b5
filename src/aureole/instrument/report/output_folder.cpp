// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/report/output_folder.h"

#include "aureole/core/error.h"

namespace aureole {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path folder, const std::string& marker) : folder_(std::move(folder)) {
  const auto fail = [&](const std::string& what) { throw Error({folder_.string(), 0, 0}, what); };
  std::error_code code;
  folder_ = fs::absolute(folder_).lexically_normal();
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  if (fs::is_symlink(folder_, code)) folder_ = fs::canonical(folder_, code);
  if (fs::exists(folder_, code)) {
    if (!fs::is_directory(folder_, code)) fail("exists and is not a folder");
    if (!fs::is_empty(folder_, code) && !fs::exists(folder_ / marker, code))
      fail("is a folder of something else (no " + marker + " in it); choose a new one");
  }
  if (!fs::is_directory(folder_.parent_path(), code))
    fail("cannot be made: its parent folder does not exist");
  part_.emplace(folder_);
}

void OutputFolder::write(const std::string& name, const std::string& text) const {
  write_file_atomically(path(name), text);
}

void OutputFolder::commit() {
  std::error_code code;
  fs::path old;
  if (fs::exists(folder_, code)) {
    old = part_->path();
    old += "-old";
    fs::rename(folder_, old, code);
    if (code) throw Error({folder_.string(), 0, 0}, "cannot be replaced: " + code.message());
  }
  fs::rename(part_->path(), folder_, code);
  if (code) {
    const std::string why = code.message();
    if (!old.empty()) fs::rename(old, folder_, code);
    throw Error({folder_.string(), 0, 0}, "cannot be made: " + why);
  }
  part_->release();
  if (!old.empty()) fs::remove_all(old, code);
}

}  // namespace aureole
