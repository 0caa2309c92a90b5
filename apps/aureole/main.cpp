// SPDX-License-Identifier: Apache-2.0
// The command-line program. Exit codes: 0 done, 1 interrupted or a comparison that fails, 2 wrong input.
#include <cstdio>
#include <exception>

#include "aureole/core/error.h"
#include "aureole/core/version.h"
#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app("aureole: a spectral renderer and toolkit for material appearance", "aureole");
  app.set_version_flag("--version", std::string("aureole ") + aureole::kVersion);
  app.require_subcommand(1);
  aureole::CommandResult result;
  aureole::add_render_command(app, result);
  aureole::add_info_command(app, result);
  aureole::add_compare_command(app, result);
  aureole::add_merge_command(app, result);
  aureole::add_list_command(app, result);
  aureole::add_docs_command(app, result);
  aureole::add_layer_command(app, result);
  aureole::add_rings_command(app, result);
  aureole::add_droplet_size_command(app, result);
  aureole::add_microstructure_command(app, result);
  aureole::add_gallery_command(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const aureole::ErrorList& list) {
    for (const auto& line : list.errors()) std::fprintf(stderr, "error: %s\n", line.c_str());
    return 2;
  } catch (const aureole::Error& e) {
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
