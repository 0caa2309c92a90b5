// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <algorithm>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <type_traits>

namespace aureole::python {

namespace {

std::string described(nb::handle value, nb::handle array) {
  if (nb::cast<int>(array.attr("ndim")) > 0 || nb::type_check(value))
    return "an array of " + text_of(array.attr("dtype"));
  return text_of(nb::type_name(value.type()));
}

/// numpy's array of the value with native float32 or float64.
nb::object float_array(const char* name, nb::handle value) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const std::string argument(name);
  nb::object array;
  try {
    array = numpy.attr("asarray")(value);
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_ValueError)) throw;
    throw nb::type_error((argument + ": expected an array of real numbers, got a ragged " +
                          text_of(nb::type_name(value.type())))
                             .c_str());
  }
  const nb::object dtype = array.attr("dtype");
  const std::string kind = nb::cast<const char*>(dtype.attr("kind"));
  if (kind != "f" && kind != "i" && kind != "u")
    throw nb::type_error((argument + ": expected real numbers, got " + described(value, array)).c_str());
  if (nb::cast<bool>(numpy.attr("ma").attr("is_masked")(value)))
    throw nb::type_error(
        (argument + ": expected an array without masked elements: fill or drop them first").c_str());
  const auto size = nb::cast<int>(dtype.attr("itemsize"));
  const bool native = nb::cast<bool>(dtype.attr("isnative"));
  if (kind == "f" && native && (size == 4 || size == 8)) return array;
  return array.attr("astype")("float64");
}

}  // namespace

Argument::Argument(const char* name, nb::handle value, int components) : name_(name) {
  read(value, components);
}

Argument::Argument(const char* name, nb::handle value, const std::array<double, 3>& constant, int components)
    : name_(name), constant_(constant) {
  if (value.is_valid() && !value.is_none()) {
    read(value, components);
    return;
  }
  data_ = reinterpret_cast<const char*>(constant_.data());
  component_stride_ = sizeof(double);
  components_ = std::max(components, 1);
}

void Argument::read(nb::handle value, int components) {
  const nb::object array = float_array(name_, value);
  if (PyObject_GetBuffer(array.ptr(), &view_, PyBUF_RECORDS_RO) != 0) throw nb::python_error();
  data_ = static_cast<const char*>(view_.buf);
  is_double_ = view_.itemsize == 8;
  shape_.assign(view_.shape, view_.shape + view_.ndim);
  strides_.assign(view_.strides, view_.strides + view_.ndim);
  if (components == 0) return;
  if (shape_.empty() || shape_.back() != components) {
    const std::string got = tuple_text(shape_);
    PyBuffer_Release(&view_);
    throw Error(std::string(name_) + ": expected the shape (..., " + std::to_string(components) + "), got " +
                got);
  }
  components_ = components;
  component_stride_ = strides_.back();
  shape_.pop_back(), strides_.pop_back();
}

Argument::~Argument() {
  if (view_.obj) PyBuffer_Release(&view_);
}

std::string tuple_text(const Extents& numbers) {
  std::string s = "(";
  for (std::size_t k = 0; k < numbers.size(); ++k) s += (k ? ", " : "") + std::to_string(numbers[k]);
  return s + (numbers.size() == 1 ? ",)" : ")");
}

void throw_cannot_broadcast(const Argument* const* arguments, std::size_t n) {
  std::string text;
  for (std::size_t a = 0; a < n; ++a) {
    if (arguments[a]->shape().empty()) continue;
    text += (text.empty() ? "" : ", ") + std::string(arguments[a]->name()) + " " +
            tuple_text(arguments[a]->shape());
  }
  throw Error("the arguments do not broadcast together; their shapes, without the axis of components, are " +
              text);
}

template <class T>
Result<T>::Result(Extents shape, int components) {
  if (components) shape.push_back(components);
  is_scalar_ = shape.empty();
  constexpr double kMaxCount =
      1 << 28;  // 2 GiB of numbers; larger results are probably a mistake in the shapes
  double count = 1;
  for (const Py_ssize_t n : shape) count *= double(n);
  if (count > kMaxCount)
    throw Error("the arguments: expected at most 2^28 results, got the shape " + tuple_text(shape) +
                ": call it for parts");
  nb::list sizes;
  for (const Py_ssize_t n : shape) sizes.append(n);
  const char* const dtype = std::is_same_v<T, double>          ? "float64"
                            : std::is_same_v<T, bool>          ? "bool"
                            : std::is_same_v<T, std::uint32_t> ? "uint32"
                                                               : "complex128";
  array_ = nb::module_::import_("numpy").attr("empty")(nb::tuple(sizes), dtype);
  Py_buffer view;
  if (PyObject_GetBuffer(array_.ptr(), &view, PyBUF_CONTIG) != 0) throw nb::python_error();
  data_ = static_cast<T*>(view.buf);  // stays where it is for as long as the array lives
  PyBuffer_Release(&view);
}

template <class T>
nb::object Result<T>::object() const {
  return is_scalar_ ? nb::object(array_[nb::tuple()]) : array_;
}

template class Result<double>;
template class Result<bool>;
template class Result<std::uint32_t>;
template class Result<std::complex<double>>;

std::string text_of(const nb::object& value) {
  const auto text = nb::steal<nb::object>(PyObject_Str(value.ptr()));
  if (!text.is_valid()) throw nb::python_error();
  const auto bytes = nb::steal<nb::bytes>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace"));
  if (!bytes.is_valid()) throw nb::python_error();
  return {bytes.c_str(), bytes.size()};
}

std::string number_text(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

}  // namespace aureole::python
