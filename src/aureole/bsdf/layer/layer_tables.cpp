// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/layer_tables.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "aureole/core/parallel.h"
#include "aureole/correlation/correlation.h"

namespace aureole {

namespace {

/// Turns errors of `optics` into errors located at a parameter.
template <class F>
auto located(const Properties& p, const char* parameter, F&& make) {
  try {
    return make();
  } catch (const std::domain_error& e) {
    throw p.error(parameter, e.what());
  }
}

optics::ScattererMixture make_mixture(const Properties& p, LayerShapes shapes, const LayerRanges& ranges,
                                      const Correlation& correlation) {
  optics::ScattererMixture mixture = located(p, "aperture", [&] {
    return optics::ScattererMixture(std::move(shapes.scatterers), shapes.correlation_radius, for_ranges);
  });
  if (p.get_choice("sizes", "labelled", {"labelled", "polydisperse"}) == "polydisperse") {
    if (ranges.area_fraction_varies())
      throw p.error("area_fraction", "must be the same everywhere where sizes are \"polydisperse\"");
    located(p, "sizes", [&] {
      mixture.correlate_sizes(ranges.most_area_fraction,
                              [&](const optics::HardDiscMixture& discs) { return correlation.at(discs); });
    });
  }
  return mixture;
}

std::shared_ptr<const ScattererSampler> make_sampler(const Properties& p,
                                                     const std::shared_ptr<const ScattererModel>& model,
                                                     bool varies, double extent) {
  const std::string sampling =
      p.get_choice("sampling", "product", {"product", "factor_mis", "factors", "table", "cosine"});
  if (sampling == "product") return std::make_shared<const ProductSampler>(model);
  if (sampling == "table") {
    if (varies) throw p.error("sampling", "\"table\" is for a layer that is the same everywhere");
    return std::make_shared<const TableSampler>(model, extent);
  }
  if (sampling == "cosine") return nullptr;
  return std::make_shared<const FactorSampler>(model);
}

}  // namespace

LayerTables make_layer_tables(const Properties& p, LayerShapes shapes, const LayerRanges& ranges,
                              double phase_nm, const LayerSubstrate& substrate, bool renormalizable) {
  const SpectralGrid& grid = p.context().grid;
  const auto indices = [&substrate, &grid](double nm) {
    const Wavelengths w = Wavelengths::at(grid, float(nm));
    return std::pair<double, double>{substrate.exterior().eval(w)[0], substrate.interior().eval(w)[0]};
  };
  const auto [n_ext, n_int] = indices(grid.min_nm);
  // The largest difference of two transverse wave vectors, in units of 1/a.
  const double extent = 2 * std::max(n_ext, n_int) * phase_nm * ranges.most_radius_scale / grid.min_nm;

  const auto correlation = get_correlation(p);
  const double correlation_radius = shapes.correlation_radius, largest = shapes.largest;
  LayerTables tables;
  tables.model = p.shared_model<ScattererModel>([&] {
    const optics::ScattererMixture mixture = make_mixture(p, std::move(shapes), ranges, *correlation);
    return located(p, "area_fraction", [&] {
      return std::make_shared<const ScattererModel>(mixture, *correlation, ranges.least_area_fraction,
                                                    ranges.most_area_fraction, extent);
    });
  });
  if (!tables.model) return tables;
  const ScattererModel& model = *tables.model;
  if (!model.is_isotropic() && correlation_radius > 8 * largest)
    throw p.error(
        "correlation_radius",
        "must not exceed 8 times the largest scatterer where shapes or places have no circular symmetry");
  if (model.is_anisotropic() && model.varies())
    throw p.error("area_fraction", "must be the same everywhere where positions have no circular symmetry");

  const bool varies = model.varies() || ranges.radius_scale_varies();
  tables.sampler = make_sampler(p, tables.model, varies, extent);
  if (p.get_bool("renormalize", false)) {
    if (!renormalizable)
      throw p.error("renormalize",
                    "needs the obliquity \"reciprocal\": the others do not conserve energy by themselves");
    if (varies || !model.is_isotropic())
      throw p.error("renormalize", "needs a layer that is the same everywhere and has circular symmetry");
    auto product = std::dynamic_pointer_cast<const ProductSampler>(tables.sampler);
    if (!product) product = std::make_shared<const ProductSampler>(tables.model);
    tables.balance.emplace(product->radial(), phase_nm * ranges.most_radius_scale, grid, indices,
                           substrate.kind());
  }
  return tables;
}

}  // namespace aureole
