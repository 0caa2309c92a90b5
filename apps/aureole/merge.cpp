// SPDX-License-Identifier: Apache-2.0
// aureole merge: combines separately rendered parts of a picture.
#include <fmt/format.h>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/render/output.h"
#include "aureole/render/state.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

/// Returns a hint for a missing file, whose name may be a picture's or that name with ".state" appended.
std::string where_state_is(const std::filesystem::path& given) {
  std::filesystem::path picture = given;
  if (lower_extension(picture) == ".state") picture.replace_extension();
  const std::string extension = lower_extension(picture);
  if (extension != ".exr" && extension != ".hdr" && extension != ".rgbe" && extension != ".pfm") return "";
  const auto state = std::filesystem::path(picture).replace_extension(".state");
  std::error_code ignored;
  return fmt::format("; the state of {} is {}{}", picture.string(), state.string(),
                     std::filesystem::exists(state, ignored) ? "" : ", which is not there either");
}

int merge(const std::vector<std::string>& files, const std::filesystem::path& output,
          const std::string& tonemap) {
  std::optional<Tone> tone;
  if (!tonemap.empty()) tone = Tone::parse(tonemap);
  if (lower_extension(output) != ".exr")
    throw Error("-o " + output.string() + ": the output is an .exr file");
  const OutputLock lock(output);
  require_writable(output);
  const auto state_file = std::filesystem::path(output).replace_extension(".state");
  require_writable(std::filesystem::path(output).replace_extension(".png"));
  require_writable(state_file);
  std::error_code ignored;
  for (const auto& f : files)
    if (std::filesystem::equivalent(f, state_file, ignored))
      throw Error("-o " + output.string() + ": its state file would replace the part " + f);
  for (const auto& f : files) {
    const std::string hint = where_state_is(f);
    const bool is_there = std::filesystem::exists(f, ignored);
    if (!is_there || !hint.empty())
      throw Error({f, 0, 0}, (is_there ? "is no state file" : "there is no such file") + hint);
  }
  RenderState sum;
  for (size_t i = 0; i < files.size(); ++i) {
    const RenderState part = RenderState::load(files[i]);
    try {
      if (i == 0)
        sum = part;
      else
        sum.merge(part);
    } catch (const Error& e) {
      throw Error({files[i], 0, 0}, e.message());
    }
  }
  write_pictures(sum, output, tone);
  sum.save(state_file);
  if (sum.units_done() < sum.units())
    tell("note: samples {}:{} are not complete: {:.1f} % are there\n", sum.begin, sum.end,
         100.0 * double(sum.units_done()) / double(sum.units()));
  fmt::print("{}\n", output.string());
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto files = std::make_shared<std::vector<std::string>>();
  auto output = std::make_shared<std::string>();
  options.add("states", *files, "state files").required();
  options.add("-o,--output", *output, "output .exr").required();
  auto tonemap = std::make_shared<std::string>();
  options.add("--tonemap", *tonemap, "tone mapping of the PNG, see \"aureole render\"");
  return [=] { return merge(*files, *output, *tonemap); };
}

AUREOLE_COMMAND("merge", "Merge the .state files of parts rendered with --samples into one picture", declare);

}  // namespace
}  // namespace aureole
