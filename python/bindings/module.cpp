// SPDX-License-Identifier: Apache-2.0
// The module `aureole._aureole`, private to the package, whose Python files are the public interface.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "aureole/core/version.h"
#include "bindings.h"
#include "command_line.h"

NB_MODULE(_aureole, m) {
  using namespace aureole::python;
  m.doc() = "The compiled part of aureole.";
  m.attr("__version__") = aureole::kVersion;
  m.def(
      "run_command_line",
      [](std::vector<std::string> arguments) {
        std::vector<char*> argv;
        for (std::string& a : arguments) argv.push_back(a.data());
        argv.push_back(nullptr);
        const Unlocked release;
        return aureole::run_command_line(int(arguments.size()), argv.data());
      },
      nb::arg("arguments"),
      "Run the command-line program; the first argument is its name. Returns the exit code.");
  bind_leaving();
  bind_errors(m);
  bind_pigment(m);
  bind_optics(m);  // before functions that return its classes
  bind_objects(m);
  bind_python_bsdf(m);
  bind_image(m);
  bind_scene(m);
  bind_parts(m);
  bind_instruments(m);
  bind_light(m);
  bind_spectrum(m);
  bind_cache(m);
  bind_check(m);
  bind_microstructure(m);
  bind_laboratory(m);
}
