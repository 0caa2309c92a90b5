// SPDX-License-Identifier: Apache-2.0
// The plane stacks (optics/stack) that the parameters of `layered` describe, by wavelength, and the
// resolution of their tables.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/stack/stack_table.h"
#include "aureole/medium/medium.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {

class LayeredStack {
public:
  /// Reads all parameters; throws located Errors.
  explicit LayeredStack(const Properties& p);

  float index_above() const { return float(index_above_); }
  float index_below() const { return float(index_below_); }
  bool is_open() const { return !substrate_; }
  bool has_delta() const;  ///< whether some light is not scattered
  /// A Lambertian substrate whose reflectance varies over the surface, which is not part of the table. Null
  /// if there is none, or if the substrate is constant or not Lambertian.
  const BsdfPtr& lambertian() const { return lambertian_; }
  /// Solves the stack on all cores; throws a located Error if the table would be too large.
  std::shared_ptr<const StackTable> tabulate() const;

private:
  struct Layer {
    MediumPtr medium;
    double thickness_m, index;                ///< thickness, and index of refraction at 589 nm
    std::optional<RefractiveIndex> material;  ///< material, if its index depends on the wavelength
    double index_at(double nm) const { return material ? material->at(nm).real() : index; }
  };
  void read_layers();
  void read_interfaces();
  void read_substrate();
  bool is_lambertian(const Bsdf& bsdf) const;
  std::vector<optics::StackDescription> descriptions(const std::vector<double>& nm, bool disperse) const;
  void add_substrate(optics::StackDescription& d, double nm, double index) const;
  std::vector<optics::LegendrePhase> phases(const Layer& layer, const std::vector<double>& nm) const;
  double narrowest_lobe(const std::vector<optics::StackDescription>& stacks) const;

  const Properties& p_;
  std::vector<Layer> layers_;
  std::vector<double> alpha_;  ///< roughness of each interface from the top; 0: smooth
  optics::InterfaceKind distribution_;
  double index_above_ = 1, index_below_ = 1;
  BsdfPtr substrate_, lambertian_;
};

}  // namespace aureole
