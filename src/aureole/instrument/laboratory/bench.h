// SPDX-License-Identifier: Apache-2.0
// The bench of the laboratory: an instrument is a scene made in memory, whose detectors are traced in bands of wavelengths.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/math/transform.h"

namespace aureole {

/// Bands of a monochromator: triangles of slit functions.
struct Bands {
  std::vector<double> nm;  ///< their centres, increasing
  double width_nm = 10;    ///< full width at half maximum
};

/// The bands of an instrument over `range`, the first and the last wavelength [nm], at most `step` apart; `usual_step` counts where
/// `step` is not positive. They are `bandwidth` wide, or as wide as they are apart where that is 0 (10 nm for one band).
/// Throws Error unless `range` holds two increasing or equal wavelengths.
Bands bands_over(const std::vector<double>& range, const SpectralGrid& grid, double step, double usual_step,
                 double bandwidth);

struct TraceSettings {
  std::int64_t paths = 1 << 16;  ///< for each detector, all replicates together
  int replicates = 16;           ///< independent parts of them, from whose spread the standard error follows
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: all cores
  const std::atomic<bool>* stop = nullptr;
};

/// Readings of detectors: mean radiance, or irradiance, by replicate, detector and band.
class Readings {
public:
  Readings(std::size_t replicates, std::size_t detectors, std::size_t bands)
      : replicates_(replicates),
        detectors_(detectors),
        bands_(bands),
        values_(replicates * detectors * bands) {}
  std::size_t replicates() const { return replicates_; }
  std::size_t detectors() const { return detectors_; }
  std::size_t bands() const { return bands_; }
  double& at(std::size_t replicate, std::size_t detector, std::size_t band) {
    return values_[(replicate * detectors_ + detector) * bands_ + band];
  }
  double at(std::size_t replicate, std::size_t detector, std::size_t band) const {
    return values_[(replicate * detectors_ + detector) * bands_ + band];
  }
  double mean(std::size_t detector, std::size_t band) const;
  /// One detector that reads the mean of all.
  Readings averaged() const;

private:
  std::size_t replicates_, detectors_, bands_;
  std::vector<double> values_;
};

/// A quotient of readings and its standard error, from the spread of the replicates.
struct Ratio {
  double value = 0, error = 0;
};
/// The quotient of means of one detector and band each. Readings of equal seeds share their wavelengths and random numbers,
/// which the error of the quotient takes into account. 0/0 is 0.
Ratio ratio_of(const Readings& over, std::size_t detector, const Readings& under, std::size_t under_detector,
               std::size_t band);

class Bench {
public:
  /// Throws Error for bands that do not increase or lie outside of the grid, and for too few paths.
  Bench(const SpectralGrid& grid, double length_unit_m, Bands bands, TraceSettings settings);

  const Bands& bands() const { return bands_; }
  const TraceSettings& settings() const { return settings_; }
  const SpectralGrid& grid() const { return grid_; }
  double length_unit_m() const { return length_unit_m_; }
  /// A length in scene units, as text.
  std::string length(double metres) const;
  /// The film and the sampler of a sensor with so many detectors.
  std::string film(std::size_t detectors) const;
  /// Traces a scene by an integrator, `path`, `ptracer` or `bdpt`. `content` has shapes, emitters and one sensor with `film(detectors)`.
  /// Throws Error if `stop` is set meanwhile.
  Readings trace(const std::string& content, const std::map<std::string, ObjectPtr>& given,
                 std::size_t detectors, const char* integrator = "path") const;
  /// A triangle's share that lies within the grid is what a band measures; at the ends of the grid it is cut.
  const std::vector<std::string>& notes() const { return notes_; }

private:
  SpectralGrid grid_;
  double length_unit_m_;
  Bands bands_;
  TraceSettings settings_;
  std::vector<std::string> notes_;
};

/// 16 numbers of a matrix, row by row.
std::string matrix_text(const Transform& t);
/// A rotation and translation that puts the local origin to `origin` and +z along `normal`, in scene units.
Transform facing(const std::array<double, 3>& origin, const std::array<double, 3>& normal);

}  // namespace aureole
