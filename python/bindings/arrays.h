// SPDX-License-Identifier: Apache-2.0
// Arguments that are arrays, read where they lie: numpy's shapes and strides, broadcast without copies, and
// messages that name the argument and the index. Loops over them run without Python's lock.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/math/vec.h"
#include "unlocked.h"

namespace aureole::python {

namespace nb = nanobind;
using Extents = std::vector<Py_ssize_t>;

/// Null for None, the default of optional arguments.
inline nb::handle optional(nb::handle value) { return value.is_none() ? nb::handle() : value; }

/// An argument: real numbers, or vectors of them along the last axis. The numbers lie in the caller's array
/// where that has float32 or float64, else in a converted copy.
class Argument {
public:
  /// Vectors have `components` numbers; 0: plain numbers. Throws TypeError and Error.
  Argument(const char* name, nb::handle value, int components = 0);
  /// An argument as above; `constant` where the handle is null (see `optional`).
  Argument(const char* name, nb::handle value, const std::array<double, 3>& constant, int components);
  ~Argument();
  Argument(const Argument&) = delete;
  Argument& operator=(const Argument&) = delete;

  const char* name() const { return name_; }
  const char* data() const { return data_; }
  const Extents& shape() const { return shape_; }      ///< without the axis of components
  const Extents& strides() const { return strides_; }  ///< in bytes

  int components() const { return components_; }
  bool is_double() const { return is_double_; }
  bool is_constant() const { return view_.obj == nullptr; }

  // T is float or double where the type is known to be that; void: it is looked up.
  template <class T = void>
  double number(const char* at, Py_ssize_t component = 0) const {
    const char* const p = at + component * component_stride_;
    if constexpr (!std::is_void_v<T>) return double(load<T>(p));
    return is_double_ ? load<double>(p) : double(load<float>(p));
  }
  /// Rounded to single precision, as the renderer uses it.
  template <class T = void>
  Vec3 vec3(const char* at) const {
    return {float(number<T>(at, 0)), float(number<T>(at, 1)), float(number<T>(at, 2))};
  }
  Vec2 vec2(const char* at) const { return {float(number(at, 0)), float(number(at, 1))}; }
  /// A vector with all components equal.
  template <class T = void>
  bool equal(const char* a, const char* b) const {
    if (a == b) return true;
    for (int k = 0; k < components_; ++k)
      if (number<T>(a, k) != number<T>(b, k)) return false;
    return true;
  }

private:
  void read(nb::handle value, int components);
  template <class T>
  static T load(const char* p) {
    T v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  const char* name_;
  std::array<double, 3> constant_{};
  Py_buffer view_{};
  const char* data_;
  Extents shape_, strides_;
  Py_ssize_t component_stride_ = 0;
  int components_ = 1;
  bool is_double_ = true;
};

/// Arguments broadcast against each other as numpy does it, and the order in which to visit the elements.
template <std::size_t N>
class Broadcast {
public:
  /// Elements that differ only in arguments from `shared` on are visited one after another where the axes
  /// allow it: along them the first arguments do not change.
  Broadcast(const std::array<const Argument*, N>& arguments, std::size_t shared);

  const Extents& shape() const { return shape_; }
  /// A run of elements with a constant step of each argument (bytes) and of the result (elements).
  struct Row {
    std::array<const char*, N> at;
    std::array<Py_ssize_t, N> step;
    Py_ssize_t count, out, out_step;
  };
  /// Calls `use(const Row&)` for all elements.
  template <class F>
  void for_rows(F&& use) const;
  /// These elements in parts of about `size` or more, in order, whose sizes are multiples of `multiple`
  /// where only one axis is left.
  std::vector<Broadcast> parts(Py_ssize_t size, Py_ssize_t multiple) const;

  /// " at index (0, 2)" in the array of argument `a` for element `out` of the result; nothing for a scalar.
  std::string where(std::size_t a, Py_ssize_t out) const;

private:
  struct Axis {
    Py_ssize_t count, out;
    std::array<Py_ssize_t, N> step;
  };
  void add_axes(std::size_t shared);

  std::array<const Argument*, N> arguments_;
  Extents shape_;
  std::vector<Axis> axes_;  ///< the last one is innermost; never empty
  bool empty_ = false;
  std::array<Py_ssize_t, N> start_{};  ///< of the first element in each argument [bytes]
  Py_ssize_t start_out_ = 0;
};

/// "(3, 4)" as Python writes a shape or an index.
std::string tuple_text(const Extents& numbers);
[[noreturn]] void throw_cannot_broadcast(const Argument* const* arguments, std::size_t n);

/// A new array of numpy's with `shape`, then an axis of `components` where that is not 0.
template <class T>
class Result {
public:
  explicit Result(Extents shape, int components = 0);
  T* data() const { return data_; }
  /// The array, or for shape () its element.
  nb::object object() const;

private:
  nb::object array_;
  T* data_;
  bool is_scalar_;
};

/// A `SignalCheck` for loops whose bodies take nanoseconds: it looks at the clock once in a thousand calls.
class Interrupts {
public:
  void check() {
    if (++calls_ % 1024 == 0) signals_();
  }

private:
  unsigned calls_ = 0;
  SignalCheck signals_;
};

/// str(value), whatever characters it has.
std::string text_of(const nb::object& value);

/// "0.25", as short as it can be.
std::string number_text(double v);

// ---------------------------------------------------------------- implementation

template <std::size_t N>
Broadcast<N>::Broadcast(const std::array<const Argument*, N>& arguments, std::size_t shared)
    : arguments_(arguments) {
  std::size_t rank = 0;
  for (const Argument* a : arguments) rank = std::max(rank, a->shape().size());
  shape_.assign(rank, 1);
  for (const Argument* a : arguments)
    for (std::size_t k = 0, missing = rank - a->shape().size(); k < a->shape().size(); ++k) {
      Py_ssize_t& n = shape_[missing + k];
      const Py_ssize_t own = a->shape()[k];
      if (own == 1 || own == n) continue;
      if (n != 1) throw_cannot_broadcast(arguments_.data(), N);
      n = own;
    }
  add_axes(shared);
}

template <std::size_t N>
void Broadcast<N>::add_axes(std::size_t shared) {
  const std::size_t rank = shape_.size();
  std::vector<Axis> outer, inner;
  Py_ssize_t out = 1;
  for (std::size_t k = rank; k-- > 0; out *= shape_[k]) {
    empty_ |= shape_[k] == 0;
    if (shape_[k] <= 1) continue;
    Axis axis{shape_[k], out, {}};
    bool is_shared = true;
    for (std::size_t a = 0; a < N; ++a) {
      const std::size_t missing = rank - arguments_[a]->shape().size();
      axis.step[a] =
          k < missing || arguments_[a]->shape()[k - missing] == 1 ? 0 : arguments_[a]->strides()[k - missing];
      if (a < shared) is_shared &= axis.step[a] == 0;
    }
    (is_shared ? inner : outer).push_back(axis);
  }
  // Both lists go from the last axis to the first.
  outer.insert(outer.begin(), inner.begin(), inner.end());
  if (outer.empty()) outer.push_back({1, 0, {}});
  for (auto a = outer.rbegin(); a != outer.rend(); ++a) {
    bool merges = !axes_.empty() && axes_.back().out == a->out * a->count;
    if (merges)
      for (std::size_t i = 0; i < N; ++i) merges &= axes_.back().step[i] == a->step[i] * a->count;
    if (merges)
      axes_.back() = {axes_.back().count * a->count, a->out, a->step};
    else
      axes_.push_back(*a);
  }
}

template <std::size_t N>
template <class F>
void Broadcast<N>::for_rows(F&& use) const {
  if (empty_) return;
  Row row;
  for (std::size_t a = 0; a < N; ++a) row.at[a] = arguments_[a]->data() + start_[a];
  row.step = axes_.back().step, row.count = axes_.back().count, row.out = start_out_,
  row.out_step = axes_.back().out;
  // Rows along the last axis but one follow each other by constant steps; further axes count as an odometer.
  const Axis one{1, 0, {}};
  const Axis& rows = axes_.size() > 1 ? axes_[axes_.size() - 2] : one;
  const std::size_t outer = axes_.size() > 2 ? axes_.size() - 2 : 0;
  std::vector<Py_ssize_t> index(outer, 0);
  const auto move = [&row](const Axis& axis, Py_ssize_t by) {
    for (std::size_t a = 0; a < N; ++a) row.at[a] += by * axis.step[a];
    row.out += by * axis.out;
  };
  for (;;) {
    for (Py_ssize_t i = 0; i < rows.count; ++i) {
      use(std::as_const(row));
      move(rows, 1);
    }
    move(rows, -rows.count);
    std::size_t k = outer;
    for (;;) {
      if (k-- == 0) return;
      if (++index[k] < axes_[k].count) break;
      move(axes_[k], 1 - axes_[k].count);
      index[k] = 0;
    }
    move(axes_[k], 1);
  }
}

template <std::size_t N>
std::vector<Broadcast<N>> Broadcast<N>::parts(Py_ssize_t size, Py_ssize_t multiple) const {
  if (empty_) return {};
  Py_ssize_t total = 1;
  std::size_t longest = 0;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    total *= axes_[k].count;
    if (axes_[k].count > axes_[longest].count) longest = k;
  }
  const Axis& axis = axes_[longest];
  const Py_ssize_t wanted = std::clamp<Py_ssize_t>(total / size, 1, axis.count);
  Py_ssize_t length = (axis.count + wanted - 1) / wanted;
  if (longest + 1 == axes_.size()) length = (length + multiple - 1) / multiple * multiple;
  std::vector<Broadcast> found;
  for (Py_ssize_t begin = 0; begin < axis.count; begin += length) {
    Broadcast part = *this;
    part.axes_[longest].count = std::min(length, axis.count - begin);
    for (std::size_t a = 0; a < N; ++a) part.start_[a] += begin * axis.step[a];
    part.start_out_ += begin * axis.out;
    found.push_back(std::move(part));
  }
  return found;
}

template <std::size_t N>
std::string Broadcast<N>::where(std::size_t a, Py_ssize_t out) const {
  Extents index(shape_.size());
  for (std::size_t k = shape_.size(); k-- > 0; out /= shape_[k]) index[k] = out % shape_[k];
  const Extents& own = arguments_[a]->shape();
  index.erase(index.begin(), index.end() - std::ptrdiff_t(own.size()));
  for (std::size_t k = 0; k < own.size(); ++k)
    if (own[k] == 1) index[k] = 0;
  if (index.empty()) return "";
  return " at index " + (index.size() == 1 ? std::to_string(index[0]) : tuple_text(index));
}

}  // namespace aureole::python
