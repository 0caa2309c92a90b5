// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <cstdio>
#include <exception>

#include "aureole/core/error.h"
#include "aureole/core/version.h"
#include "commands.h"

namespace aureole {

int run_command_line(int argc, char** argv) {
  CLI::App app("aureole: a spectral renderer and toolkit for material appearance", "aureole");
  app.set_version_flag("--version", std::string("aureole ") + kVersion);
  app.require_subcommand(1);
  CommandResult result;
  add_render_command(app, result);
  add_info_command(app, result);
  add_compare_command(app, result);
  add_merge_command(app, result);
  add_list_command(app, result);
  add_docs_command(app, result);
  add_layer_command(app, result);
  add_rings_command(app, result);
  add_droplet_size_command(app, result);
  add_microstructure_command(app, result);
  add_gallery_command(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const ErrorList& list) {
    for (const auto& line : list.errors()) std::fprintf(stderr, "error: %s\n", line.c_str());
    return 2;
  } catch (const Error& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "error: not enough memory\n");
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 2;
  }
  return result.exit_code;
}

}  // namespace aureole
