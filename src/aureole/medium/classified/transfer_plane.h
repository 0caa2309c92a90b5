// SPDX-License-Identifier: Apache-2.0
// `TransferPlane`: a transfer function of two numbers, the value of the volume and the length of its
// gradient, so that the boundary between two materials can look different from both (Kniss, Kindlmann &
// Hansen 2002, "Multidimensional transfer functions for interactive volume rendering"). It is a picture, or a
// sum of boxes and triangles.
#pragma once

#include <vector>

#include "aureole/medium/classified/range_maximum.h"
#include "aureole/medium/classified/transfer_function.h"

namespace aureole {

class TransferPlane {
public:
  using Sample = TransferFunction::Sample;

  /// Whether a parameter that states a transfer plane is present.
  static bool is_given(const Properties& properties);
  /// Reads the parameters of `rows`. Throws located Errors.
  static TransferPlane read(const Properties& properties);
  static std::vector<ParameterDoc> rows();

  /// Extinction [1/length] and colour at a value and a length of the gradient [1/length].
  Sample at(float value, float gradient) const;
  /// Upper bound of the extinction over the values from `low` to `high` and all gradients.
  float max_extinction(float low, float high) const;
  float max_extinction() const { return max_extinction_; }

private:
  /// A box, or the part of a triangle with its apex at the gradient 0 that lies between two gradients.
  struct Patch {
    bool is_triangle;
    float low, high;    ///< interval of values of a box
    float from, to;     ///< interval of gradients [1/length]
    float apex;         ///< value at a triangle's apex
    float width, lean;  ///< at the gradient `to`: half of its width, and distance of its middle from the apex
    /// opacity of a layer of `unit_`; in a triangle it falls linearly from the middle to 0 at both sides
    float opacity;
    ColorWeights color;
  };
  /// The extinction at which a layer of `unit_` has the given opacity.
  float extinction_of(float opacity) const;
  float max_of(const Patch& patch) const { return extinction_of(patch.opacity); }
  std::array<float, 2> span_of(const Patch& patch) const;
  void read_patches(const Properties& p, const char* name, bool are_triangles);
  void read_table(const Properties& p);
  Sample table_at(float value, float gradient) const;

  float unit_ = 1;  ///< thickness of the layer whose opacity is given
  float max_extinction_ = 0;
  std::vector<Patch> patches_;
  std::vector<Sample> texels_;  ///< texels row by row from the smallest gradient; empty without a picture
  int width_ = 0, height_ = 0;
  float table_values_[2] = {0, 1},
        table_gradients_[2] = {0, 1};  ///< values and gradients at the centres of the outermost texels
  RangeMaximum columns_;               ///< largest extinction of each column
};

}  // namespace aureole
