// SPDX-License-Identifier: Apache-2.0
// Texts for Python that may hold bytes which are not UTF-8: names of files, and what cites files.
#pragma once

#include <string_view>

#include "bindings.h"

namespace aureole::python {

/// A text in which bytes that are not UTF-8 are shown as \xNN.
inline nb::str decoded(std::string_view message) {
  PyObject* const text = PyUnicode_DecodeUTF8(message.data(), Py_ssize_t(message.size()), "backslashreplace");
  if (!text) throw nb::python_error();
  return nb::steal<nb::str>(text);
}

/// The name of a file as Python has it (os.fsdecode), so that the file can be opened by it.
inline nb::str file_name(std::string_view name) {
  PyObject* const text = PyUnicode_DecodeFSDefaultAndSize(name.data(), Py_ssize_t(name.size()));
  if (!text) throw nb::python_error();
  return nb::steal<nb::str>(text);
}

/// Whether a text is UTF-8.
inline bool is_utf8(std::string_view text) {
  PyObject* const decoded = PyUnicode_DecodeUTF8(text.data(), Py_ssize_t(text.size()), nullptr);
  if (!decoded) PyErr_Clear();
  Py_XDECREF(decoded);
  return decoded;
}

}  // namespace aureole::python
