// SPDX-License-Identifier: Apache-2.0
// Exceptions: wrong input is `aureole.Error`, a ValueError; a bad scene is `aureole.SceneError`, which holds
// every problem.
#include <system_error>

#include "aureole/core/error.h"
#include "text.h"

namespace aureole::python {

void bind_errors(nb::module_& m) {
  // Both classes are Python's own (aureole/_errors.py), since they carry data.
  nb::object errors = nb::module_::import_("aureole._errors");
  m.attr("Error") = errors.attr("Error");
  m.attr("SceneError") = errors.attr("SceneError");
  nb::register_exception_translator([](const std::exception_ptr& p, void*) {
    const auto raise = [](const char* name, auto&&... arguments) {
      const nb::object type = nb::module_::import_("aureole._errors").attr(name);
      const nb::object instance = type(arguments...);
      PyErr_SetObject(type.ptr(), instance.ptr());
    };
    try {
      std::rethrow_exception(p);
    } catch (const ErrorList& e) {
      nb::list problems;
      for (const std::string& message : e.errors()) problems.append(decoded(message));
      raise("SceneError", problems);
    } catch (const Error& e) {
      raise("Error", decoded(e.what()));
    } catch (const std::system_error& e) {  // of files, and of threads that cannot be had
      raise("Error", decoded(e.what()));
    }
  });
}

}  // namespace aureole::python
