// SPDX-License-Identifier: Apache-2.0
// A stack cut into elements (layers, interfaces, substrate), and the light at the levels between them, mode
// by mode. Inside of the library only.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "aureole/optics/stack/operators.h"
#include "aureole/optics/stack/plane_stack.h"

namespace aureole::optics {

class StackSolver {
public:
  struct Element {
    enum class Kind { layer, interface, substrate } kind;
    int layer;                         ///< of the description; of an interface the one below it
    double index_above, index_below;   ///< equal but for interfaces
    double optical_thickness, scaled;  ///< of layers, and with the forward peak taken for light that goes on
    int rough = -1;                    ///< of a rough interface which one
  };
  /// A layer with its forward peak removed, if it is to be.
  struct Scaled {
    double share = 1;  ///< of the extinction that is left
    double albedo = 0;
    std::vector<double> moments;
  };

  /// With `azimuths` all modes can be asked for, else only mode 0. Rough interfaces are those of `like`, if
  /// that is given: a stack that differs in what fills its layers and in its substrate only.
  StackSolver(const StackDescription& description, const DiscreteOrdinates& method, bool azimuths,
              std::span<const IndexedCosine> extra, std::span<const StackPosition> positions = {},
              std::span<const IndexedCosine> cuts = {}, const StackSolver* like = nullptr);

  const Channels& channels() const { return channels_; }
  const std::vector<Element>& elements() const { return elements_; }
  const Scaled& scaled(int layer) const { return scaled_[layer]; }
  const UniformLayer& layer(int layer) const { return layers_[layer]; }
  int last_level() const { return int(elements_.size()); }
  int level(int position) const { return position_levels_[position]; }  ///< of those that were given
  double index(int level) const { return level == 0 ? index_above_ : elements_[level - 1].index_below; }
  /// Modes that scatter at all.
  int modes() const { return modes_; }

  /// Light at levels, from what falls on the stack (columns).
  struct Light {
    Matrix down, up;
  };
  std::vector<Light> light(int mode, const Matrix& from_above, const Matrix& from_below,
                           std::span<const int> levels) const;

  /// Operators of the whole stack.
  Operators whole(int mode) const;
  /// Operators of the layers above a substrate; nothing where there is none.
  std::optional<Operators> above_substrate(int mode) const;
  /// A mode above all others, in which nothing is scattered: light that keeps its direction.
  static constexpr int kUnscattered = 1 << 20;

  /// Unscattered light of one channel at each level for unit light put in at one level: rows are where it
  /// arrives, down at level i in row i, up in row last_level() + 1 + i; columns, numbered alike, are where it
  /// was put in. `scaled`: forward peaks are not scattering.
  Matrix unscattered(int channel, bool scaled) const;

private:
  Operators operators(const Element& element, int mode) const;

  std::vector<Element> elements_;
  std::vector<int> position_levels_;
  std::vector<Scaled> scaled_;
  double index_above_;
  double substrate_;
  std::function<double(double)> mirror_;
  Channels channels_;
  std::vector<UniformLayer> layers_;
  std::vector<std::shared_ptr<const std::vector<Operators>>> rough_;  ///< by rough interface, and mode
  std::vector<Matrix> brdf_;  ///< of the substrate, by mode, where it has one
  int modes_ = 1;
};

/// Optical thickness of what is given as infinite: less than 2e-8 of light passes it.
inline constexpr double kInfiniteOpticalThickness = 1e8;

}  // namespace aureole::optics
