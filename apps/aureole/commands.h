// SPDX-License-Identifier: Apache-2.0
// The subcommands of `aureole`, one file each. A new one is a file and a line here and in command_line.cpp.
#pragma once

#include <CLI/CLI.hpp>

namespace aureole {

/// What a subcommand's callback sets: the exit code of the program.
struct CommandResult {
  int exit_code = 0;
};

/// Splits -D name=value options; throws Error for anything else.
std::vector<std::pair<std::string, std::string>> split_defines(const std::vector<std::string>& list);

void add_render_command(CLI::App& app, CommandResult& result);
void add_info_command(CLI::App& app, CommandResult& result);
void add_compare_command(CLI::App& app, CommandResult& result);
void add_merge_command(CLI::App& app, CommandResult& result);
void add_list_command(CLI::App& app, CommandResult& result);
void add_docs_command(CLI::App& app, CommandResult& result);
void add_layer_command(CLI::App& app, CommandResult& result);
void add_rings_command(CLI::App& app, CommandResult& result);
void add_droplet_size_command(CLI::App& app, CommandResult& result);
void add_microstructure_command(CLI::App& app, CommandResult& result);
void add_gallery_command(CLI::App& app, CommandResult& result);

}  // namespace aureole
