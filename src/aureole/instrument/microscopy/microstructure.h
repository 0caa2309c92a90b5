// SPDX-License-Identifier: Apache-2.0
// The statistics of scatterers in one or several fields of view, with confidence intervals: the parameters of
// a layer of correlated scatterers. Lengths are in metres.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "aureole/instrument/microscopy/micrograph.h"
#include "aureole/instrument/microscopy/particles.h"
#include "aureole/instrument/microscopy/point_statistics.h"
#include "aureole/instrument/microscopy/segmentation.h"

namespace aureole {

/// The scatterers of the material that the particles are written as: openings in an opaque sheet, opaque discs, or
/// transparent spheres. automatic: discs for particles darker than their ground, apertures for brighter ones.
enum class ScattererKind { automatic, apertures, discs, spheres };

struct MicrostructureOptions {
  SegmentationOptions segmentation;
  ScattererKind scatterer = ScattererKind::automatic;
  std::string int_ior;  ///< index of refraction of spheres, which need it: a number or the name of a material
  double correlation_radius_m = 0;  ///< correlation radius [m]; 0: estimated
  int resamples = 300;              ///< number of bootstrap resamples
  std::uint64_t seed = 1;
};

/// A number with its 95 % confidence interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

struct FieldReport {
  std::string name;
  int width = 0, height = 0;
  double pixel_m = 0, seen_m2 = 0;
  int whole = 0, cut = 0, too_small = 0;
  bool bright = false;
  double polarity_score = 0, noise = 0, blur = 0;
};

inline constexpr double kQuantiles[] = {0.05, 0.25, 0.5, 0.75, 0.95};

struct Microstructure {
  std::vector<FieldReport> fields;
  std::vector<Particle> particles;  ///< the particles, in pixels of their fields
  std::vector<double> weights;      ///< weights of particles in size statistics, normalised to 1; 0 for cut
                                    ///< particles

  Estimate shape_fraction;      ///< Fr, the covered fraction of the plane
  Estimate area_fraction;       ///< Fa = density pi correlation_radius^2
  Estimate density;             ///< particles per m^2
  Estimate correlation_radius;  ///< correlation radius [m]; without confidence interval if given
  bool correlation_radius_given = false;
  Estimate mean_radius, deviation, log_deviation;
  std::vector<Estimate> quantiles;  ///< quantiles of the radii at kQuantiles
  double onset_width = 0;           ///< width of the onset of g(r), relative to the smallest distance
  double onset_height = 0;  ///< height of the fitted g(r) just above the smallest distance; 0 without a fit

  bool round = true;
  /// medians of circularity and aspect; alignment is |mean of exp(2i angle)|
  double circularity = 1, aspect = 1, alignment = 0;
  int symmetry = 0;  ///< strongest harmonic of non-circular outlines
  /// Rotation [degrees counter-clockwise from x, y up] from mean_outline to the orientation of aligned
  /// particles.
  double orientation = 0;
  /// outlines about their centroids [m], y up; the mean outline has the maximum of its strongest harmonic on
  /// the x axis
  Outline mean_outline, typical_outline;

  struct Curve {
    std::vector<double> x, value, error;  ///< arguments, values and their standard errors
  };
  Curve pair_correlation;  ///< g(r) by x = r/correlation_radius
  Curve structure_factor;  ///< S by x = u = q correlation_radius

  ScattererKind scatterer = ScattererKind::apertures;  ///< kind of the material's scatterers; never automatic
  std::string int_ior;                                 ///< index of refraction of spheres

  int blocks = 0;  ///< number of bootstrap blocks
  /// choices of the program, each with its reason and the option that chooses otherwise
  std::vector<std::string> choices;
  std::vector<std::string> notes;  ///< doubts about the result

  /// Returns the median of a log-normal distribution with the mean and the log-normal sigma of the radii.
  double median_radius() const {
    return mean_radius.value * std::exp(-0.5 * log_deviation.value * log_deviation.value);
  }
};

/// Called with each field, its segmentation and its particles, in order, to draw pictures for visual
/// inspection.
using FieldVisitor =
    std::function<void(const Micrograph&, const Segmentation&, const std::vector<Particle>&)>;

/// Reads one field after the other with `read(i)`, i < count. Throws Error if fewer than three particles are
/// uncut.
Microstructure analyse_microstructure(size_t count, const std::function<Micrograph(size_t)>& read,
                                      const MicrostructureOptions& options, const FieldVisitor& visit);

/// Sets shape class, mean outline and typical outline from the particles that are uncut and touch no other.
void classify_shapes(Microstructure& m);

}  // namespace aureole
