// SPDX-License-Identifier: Apache-2.0
// A stack divided into elements (layers, interfaces, substrate), and the light at the levels between them, by
// azimuthal mode. Internal to the library.
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
    /// Index of the layer in the description; for an interface the index of the layer below it.
    int layer;
    double index_above, index_below;  ///< indices on both sides, which differ only for interfaces
    /// optical thickness of a layer; `scaled` treats the forward peak as unscattered
    double optical_thickness, scaled;
    int rough = -1;  ///< index of a rough interface
  };
  /// A layer after delta-M scaling, if that is used.
  struct Scaled {
    double share = 1;  ///< fraction of the extinction that remains
    double albedo = 0;
    std::vector<double> moments;
  };

  /// With `azimuths` all modes are available, else only mode 0. If `like` is given, its rough interfaces are
  /// reused: the stacks may differ only in their layers' contents and substrates.
  StackSolver(const StackDescription& description, const DiscreteOrdinates& method, bool azimuths,
              std::span<const IndexedCosine> extra, std::span<const StackPosition> positions = {},
              std::span<const IndexedCosine> cuts = {}, const StackSolver* like = nullptr);

  const Channels& channels() const { return channels_; }
  const std::vector<Element>& elements() const { return elements_; }
  const Scaled& scaled(int layer) const { return scaled_[layer]; }
  const UniformLayer& layer(int layer) const { return layers_[layer]; }
  int last_level() const { return int(elements_.size()); }
  /// Returns the level of each of `positions`.
  int level(int position) const { return position_levels_[position]; }
  double index(int level) const { return level == 0 ? index_above_ : elements_[level - 1].index_below; }
  /// Returns the number of modes in which light is scattered.
  int modes() const { return modes_; }

  /// Light at a level, per column of incident light.
  struct Light {
    Matrix down, up;
  };
  std::vector<Light> light(int mode, const Matrix& from_above, const Matrix& from_below,
                           std::span<const int> levels) const;

  /// Returns the operators of the whole stack.
  Operators whole(int mode) const;
  /// Returns the operators of all elements above a substrate; nothing if the stack is only a substrate.
  std::optional<Operators> above_substrate(int mode) const;
  /// A mode above all others, without scattering: for light that keeps its direction.
  static constexpr int kUnscattered = 1 << 20;

  /// Returns the unscattered light of one channel for unit light that starts at a level. Rows are the levels
  /// of arrival: downward light at level i in row i, upward light in row last_level() + 1 + i. Columns are
  /// the starting levels in the same order. `scaled`: forward peaks count as unscattered.
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
  /// Operators of each rough interface, by mode.
  std::vector<std::shared_ptr<const std::vector<Operators>>> rough_;
  std::vector<Matrix> brdf_;  ///< BRDF of the substrate, by mode; empty if there is none
  int modes_ = 1;
};

/// Optical thickness that replaces infinity: less than 2e-8 of the light is transmitted.
inline constexpr double kInfiniteOpticalThickness = 1e8;

}  // namespace aureole::optics
