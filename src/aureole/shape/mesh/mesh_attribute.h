// SPDX-License-Identifier: Apache-2.0
// Values of a mesh at its vertices or on its faces, for the texture `mesh_attribute`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "aureole/spectrum/upsampled_color.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The name of an attribute, interned so that comparing two names compares pointers.
class AttributeName {
public:
  explicit AttributeName(const std::string& text);
  const std::string& text() const { return *text_; }
  bool operator==(const AttributeName&) const = default;

private:
  const std::string* text_;  ///< the name's text, one string for each different text in the program
};

/// An attribute: one number or one colour per vertex or face.
class MeshAttribute {
public:
  MeshAttribute(const std::string& name, bool is_color)
      : name_(name), is_color_(is_color), of_faces_(name.starts_with("face_")) {}

  const AttributeName& name() const { return name_; }
  bool is_color() const { return is_color_; }
  /// Whether it has a value per triangle; otherwise per position index.
  bool of_faces() const { return of_faces_; }
  std::size_t size() const { return is_color_ ? colors_.size() : numbers_.size(); }
  std::size_t memory_bytes() const;

  void reserve(std::size_t n) { is_color_ ? colors_.reserve(n) : numbers_.reserve(n); }
  /// Adds one number, or a linear sRGB colour.
  void add(const double* values) {
    if (is_color_)
      colors_.push_back(UpsampledColor::of_rgb(float(values[0]), float(values[1]), float(values[2])));
    else
      numbers_.push_back(float(values[0]));
  }
  /// Moves a value to an earlier index, before `cut` shortens the list.
  void move(std::size_t from, std::size_t to) {
    is_color_ ? void(colors_[to] = colors_[from]) : void(numbers_[to] = numbers_[from]);
  }
  void cut(std::size_t n) { is_color_ ? colors_.resize(n) : numbers_.resize(n); }

  /// Returns the mean of `count` values with weights that sum to one.
  Spectrum eval(const std::uint32_t* indices, const float* weights, int count, const Wavelengths& w) const;

  /// Returns the smallest and largest value over all triangles or vertices and all wavelengths; 0 if there
  /// are none.
  std::pair<float, float> range() const;
  /// Returns the mean over all values.
  SampledSpectrum mean(const SpectralGrid& grid) const;

private:
  AttributeName name_;
  bool is_color_, of_faces_;
  std::vector<float> numbers_;  // values that are numbers; either this or colors_ is empty
  std::vector<UpsampledColor> colors_;
};

}  // namespace aureole
