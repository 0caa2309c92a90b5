// SPDX-License-Identifier: Apache-2.0
// `TransferFunction`: maps a value of a volume to extinction and colour. Both are piecewise linear in the
// value, and may jump.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "aureole/medium/classified/range_maximum.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

class Properties;
struct ParameterDoc;

/// A colour as weights of a flat spectrum and of the spectra of the red, green and blue primary, so that mixtures of
/// colours are linear and greys are flat.
struct ColorWeights {
  float white = 0, red = 0, green = 0, blue = 0;

  static ColorWeights of_linear_rgb(float r, float g, float b);
};

/// Returns the thickness of the layer whose opacity a volume states, in units of the scene: `opacity_unit_length`, else
/// 1 mm for the opacities of presets of CT and MR, and 1 for all others. Throws a located Error where classes of a mask
/// have both and these lengths differ.
double opacity_unit_length(const Properties& properties);
/// Notes that opacities of the parameter `name` exceed `TransferFunction::kMaxOpacity`.
void note_limited_opacity(const Properties& properties, const char* name);

/// The basis spectra that `ColorWeights` weight, at the wavelengths of one path.
class ColorBasis {
public:
  ColorBasis() = default;  ///< without colours: grey alone
  explicit ColorBasis(const Spectrum& nm);
  Spectrum eval(const ColorWeights& c) const {
    return Spectrum(c.white) + red_ * c.red + green_ * c.green + blue_ * c.blue;
  }

private:
  Spectrum red_{0.f}, green_{0.f}, blue_{0.f};
};

class TransferFunction {
public:
  struct Sample {
    float extinction = 0;  ///< extinction [1/length]
    ColorWeights color;
  };
  /// A point of the curve; two points of one value are a jump.
  struct Node : Sample {
    float value = 0;
    float inverse_width = 0;  ///< inverse width of the interval to the next node; 0 for a jump
  };

  /// A curve of at least one number by value: pairs in ascending order of the first, of which two may be equal.
  struct Curve {
    std::vector<double> values;
    /// components of the curve at each value; of one component the first is used
    std::vector<std::array<double, 3>> numbers;
  };
  /// `extinction` [1/length] and `color` (linear sRGB) by value; they are extended by their first and last number.
  TransferFunction(const Curve& extinction, const Curve& color);

  /// Upper bound of a layer's opacity, to which larger opacities are reduced: an opacity of 1 would be an
  /// infinite extinction.
  static constexpr double kMaxOpacity = 0.9999;

  /// Reads the parameters of `rows`. Throws located Errors.
  static TransferFunction read(const Properties& properties);
  /// Reads a string of a value and `count` numbers at each point. Numbers below 0 or above `most` and values that do not
  /// ascend are located Errors, which show `example`.
  static Curve read_curve(const Properties& properties, const char* name, std::size_t count, double most,
                          const char* example);
  static std::vector<ParameterDoc> rows();

  /// Extinction and colour at a value; at a jump they are those of larger values.
  Sample at(float value) const { return at_in(interval(value), value); }
  /// The extinction of `at`.
  float extinction(float value) const {
    const std::size_t i = interval(value);
    const Node* const nodes = nodes_.data();
    return nodes[i].extinction + fraction_in(i, value) * (nodes[i + 1].extinction - nodes[i].extinction);
  }
  /// The mean extinction over the values between `a` and `b`, and the mean colour weighted by the extinction:
  /// for a short segment along which the value changes linearly from `a` to `b` (Engel, Kraus & Ertl 2001,
  /// "High-quality pre-integrated volume rendering using hardware-accelerated pixel shading", section 3, by
  /// integral functions).
  Sample mean(float a, float b) const;
  /// Upper bound of the extinction over the values from `low` to `high`.
  float max_extinction(float low, float high) const;
  float max_extinction() const { return max_extinction_; }
  const std::vector<Node>& nodes() const { return nodes_; }

private:
  static float clamped(float t) {
    t = t > 0 ? t : 0.f;
    return t < 1 ? t : 1.f;
  }
  static ColorWeights mixed(const ColorWeights& a, const ColorWeights& b, float t) {
    return {a.white + t * (b.white - a.white), a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
            a.blue + t * (b.blue - a.blue)};
  }
  /// Index of the last node whose value is not above `value`, at most the last but one; 0 below all nodes.
  std::size_t interval(float value) const {
    float at = (value - first_) * scale_;
    at = at > 0 ? at : 0.f;  // A NaN becomes 0.
    at = at < float(kBuckets - 1) ? at : float(kBuckets - 1);
    std::size_t i = starts_[std::size_t(int(at))];
    const Node* const nodes = nodes_.data();
    while (i < last_interval_ && nodes[i + 1].value <= value) ++i;
    return i;
  }
  struct Integral {
    double extinction = 0;
    std::array<double, 4> color{};  ///< integral of extinction times colour

    /// Adds the integral over an interval along which extinction and colour are linear.
    void add(const Sample& from, const Sample& to, double width);
  };
  /// Position of a value between the nodes i and i + 1, from 0 to 1, where i is its `interval`.
  float fraction_in(std::size_t i, float value) const {
    const Node& a = nodes_.data()[i];
    return a.inverse_width > 0 ? clamped((value - a.value) * a.inverse_width) : float(value >= a.value);
  }
  /// Extinction and colour at a value whose `interval` is i.
  Sample at_in(std::size_t i, float value) const {
    const Node* const nodes = nodes_.data();
    const Node &a = nodes[i], &b = nodes[i + 1];
    const float t = fraction_in(i, value);
    return {a.extinction + t * (b.extinction - a.extinction), mixed(a.color, b.color, t)};
  }
  /// The integral from the first node to a value whose `interval` is i; `end` is the function there.
  Integral integral_to(std::size_t i, float value, const Sample& end) const;

  static constexpr std::size_t kBuckets = 1024;
  std::vector<Node> nodes_;          ///< at least two nodes in ascending order of value
  std::vector<Integral> integrals_;  ///< integral from the first node to each node
  RangeMaximum extinctions_;         ///< extinctions of the nodes
  std::vector<std::uint32_t> starts_;
  std::size_t last_interval_ = 0;  ///< index of the last interval between two nodes
  float first_ = 0, scale_ = 0, max_extinction_ = 0;
};

}  // namespace aureole
