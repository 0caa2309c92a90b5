// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include "aureole/core/error.h"

namespace aureole {

namespace {
std::filesystem::path png_of(std::filesystem::path exr) { return exr.replace_extension(".png"); }
}  // namespace

void write_pictures(const RenderState& s, const std::filesystem::path& file) {
  ExrAttributes a;
  a.strings["aureole:scene"] = s.identity.scene;
  a.strings["aureole:scene_hash"] = fmt::format("{:016x}", s.identity.scene_hash);
  a.strings["aureole:version"] = s.identity.version;
  a.strings["aureole:seed"] = std::to_string(s.identity.seed);
  a.strings["aureole:sampler"] = s.identity.sampler;
  a.strings["aureole:integrator"] = s.identity.integrator;
  a.strings["aureole:samples"] = fmt::format("{}:{}", s.begin, s.end);
  a.integers["aureole:spp"] = int(s.samples_everywhere());
  a.integers["aureole:replicates"] = s.identity.replicates;
  a.integers["aureole:wavelengths"] = s.identity.wavelengths;
  a.integers["aureole:invalid_samples"] = int(s.invalid_samples);
  a.floats["aureole:seconds"] = float(s.seconds);
  const bool single = s.development.half && s.identity.replicates == 1;
  write_exr(file, s.picture(), single ? ExrPixel::half : ExrPixel::float32, a);
  write_preview(s, file);
}

void write_preview(const RenderState& s, const std::filesystem::path& file) {
  write_png(png_of(file), s.display_picture());
}

void require_writable(const std::filesystem::path& file) {
  const std::filesystem::path folder =
      file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    throw Error("cannot write " + file.string() + ": there is no folder " + folder.string());
  if (std::filesystem::is_directory(file, ignored))
    throw Error("cannot write " + file.string() + ": it is a folder");
  // Files are replaced by renaming, so the folder must be writable; access() says yes to root on read-only
  // media, so try.
  const std::filesystem::path probe = folder / fmt::format(".aureole-write-test-{}", getpid());
  std::FILE* f = std::fopen(probe.c_str(), "wb");
  if (!f)
    throw Error("cannot write " + file.string() + ": the folder " + folder.string() + " is not writable");
  std::fclose(f);
  std::filesystem::remove(probe, ignored);
}

}  // namespace aureole
