// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/material_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/optics/arrangement/equilibrium_structure_factor.h"
#include "aureole/pigment/grain_index.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {
namespace {

/// A structure factor that differs from that of hard discs by more than this RMS fraction, and significantly, is
/// noted. Errors of the area fraction of 0.01 cause 0.06. Spreads of sizes, which the comparison leaves out, cause up
/// to the second value.
constexpr double kSameStructure = 0.15, kSameStructureOfSizes = 0.5;
/// Relative width of the onset of g(r) above which there is no distinct smallest distance, and its height below which
/// there is none; hard discs have at least 1.
constexpr double kDistinctOnset = 0.2, kDistinctHeight = 0.5;
/// Relative difference of the 5 % and 95 % quantiles of radii from a log-normal distribution's.
constexpr double kSameQuantile = 0.05;
/// Relative deviation of radii from which sizes count as different in the positions.
constexpr double kEqualSizes = 0.05;

void note_positions(Microstructure& m) {
  const double fraction = m.area_fraction.value;
  // another area fraction has a note of its own
  if (!(fraction > 0 && fraction <= optics::kMaxEquilibriumFraction)) return;
  double squares = 0, noise = 0, chi = 0, most = 0, at = 0;
  int rings = 0;
  const Microstructure::Curve& s = m.structure_factor;
  for (size_t i = 0; i < s.x.size(); ++i) {
    if (!(s.error[i] > 0) || s.x[i] > 8) continue;
    const double model = optics::equilibrium_structure_factor(optics::HardDiscWave(s.x[i]), s.x[i], fraction);
    const double difference = s.value[i] / model - 1;
    // The standard error of a ring is in proportion to S; the model's error is independent of the measured
    // noise.
    const double error = s.value[i] > 0 ? s.error[i] / s.value[i] : 1;
    squares += difference * difference, noise += error * error,
        chi += difference * difference / (error * error);
    if (std::abs(difference) > std::abs(most)) most = difference, at = s.x[i];
    ++rings;
  }
  if (rings < 8) return;
  const double rms = std::sqrt(std::max(squares - noise, 0.0) / rings);
  const bool equal = m.deviation.value < kEqualSizes * m.mean_radius.value;
  if (chi < rings + 5 * std::sqrt(2.0 * rings) || rms < (equal ? kSameStructure : kSameStructureOfSizes))
    return;
  m.notes.push_back(fmt::format(
      "positions are not those of hard discs, which the material has: S(q) differs by {:.0f} % (RMS), most at u = "
      "{:.1f}, where it is {:.2g} times as large. Particles may be clustered, ordered or divided wrongly; a nested "
      "correlation of type table takes the measured structure_factor.txt",
      100 * rms, at, 1 + most));
}

void note_onset(Microstructure& m) {
  if (m.correlation_radius_given || m.onset_width == 0) return;  // there is no fit of g(r)
  if (m.onset_width < kDistinctOnset && m.onset_height > kDistinctHeight) return;
  m.notes.push_back(fmt::format(
      "g(r) has no distinct onset: at the smallest distance of centres it rises to {:.2f}, within {:.0f} % of that "
      "distance, where hard discs have at least 1 at once. Correlation radius and area fraction are uncertain beyond "
      "their intervals; --correlation-radius sets the first",
      m.onset_height, 100 * m.onset_width));
}

void note_sphere_sizes(Microstructure& m) {
  const double sigma = m.log_deviation.value, median = m.median_radius();
  for (size_t i = 0; i < m.quantiles.size(); ++i) {
    const Estimate& q = m.quantiles[i];
    const double z = kQuantiles[i] == 0.05 ? -1.6449 : kQuantiles[i] == 0.95 ? 1.6449 : 0;
    const double model = median * std::exp(sigma * z);
    if (z == 0 || std::abs(q.value / model - 1) < kSameQuantile || (q.low <= model && model <= q.high))
      continue;
    m.notes.push_back(fmt::format(
        "sizes are not log-normal, as those of the spheres of the material are: {:.0f} % of the particles are smaller "
        "than {:.4g} um, where the distribution has {:.4g} um",
        100 * kQuantiles[i], q.value * 1e6, model * 1e6));
    return;
  }
}

}  // namespace

void check_material_options(const MicrostructureOptions& o) {
  if (o.scatterer != ScattererKind::spheres) {
    if (!o.int_ior.empty()) throw Error("--int-ior is for --scatterer spheres");
    return;
  }
  if (o.int_ior.empty())
    throw Error(
        "--scatterer spheres needs --int-ior, the index of refraction of the spheres: a number, such as 1.46, or a "
        "material, such as water");
  double index = 0;
  try {
    index = parse_number(o.int_ior);
  } catch (const Error&) {
    if (find_refractive_index(o.int_ior, false) || pigment::find_grain_index(o.int_ior)) return;
    throw Error("--int-ior: unknown material \"" + o.int_ior + "\"" +
                did_you_mean(o.int_ior, refractive_index_names()));
  }
  if (!(index > 0 && index <= 10)) throw Error(fmt::format("--int-ior: {:g} is not in (0, 10]", index));
}

void choose_scatterers(Microstructure& m, const MicrostructureOptions& o) {
  const FieldReport& first = m.fields.front();
  double score = 1;
  for (const FieldReport& f : m.fields) {
    score = std::min(score, f.polarity_score);
    if (f.bright == first.bright) continue;
    if (o.scatterer == ScattererKind::automatic)
      throw Error(fmt::format(
          "{}: particles are {}, in {} they are {}: give --polarity dark or bright, which decides for all, or say what "
          "they are by --scatterer apertures, discs or spheres",
          f.name, f.bright ? "bright" : "dark", first.name, first.bright ? "bright" : "dark"));
    m.notes.push_back(f.name + ": particles are " + (f.bright ? "bright" : "dark") + ", in " + first.name +
                      " they are not; --polarity decides for all");
  }
  const char *side = first.bright ? "bright" : "dark", *other = first.bright ? "dark" : "bright";
  if (o.segmentation.polarity == Polarity::automatic)
    m.choices.push_back(fmt::format(
        "particles are taken to be the {} parts, whose outlines are convex (score {:.2f}; 1 is certain, below "
        "0.05 is an error): --polarity {} takes the {} parts",
        side, score, other, other));
  m.scatterer = o.scatterer, m.int_ior = o.int_ior;
  if (o.scatterer != ScattererKind::automatic) return;
  m.scatterer = first.bright ? ScattererKind::apertures : ScattererKind::discs;
  m.choices.push_back(
      first.bright
          ? "the material is an opaque sheet with openings (apertures), since particles brighter than their ground let "
            "transmitted light through: --scatterer discs is for particles that are opaque and look bright by reflected "
            "light or fluorescence, --scatterer spheres for transparent beads"
          : "the material has opaque discs, since particles darker than their ground block transmitted light: "
            "--scatterer apertures is for openings in an opaque sheet that look dark by reflected light, --scatterer "
            "spheres for transparent beads");
}

void note_bad_fits(Microstructure& m) {
  note_positions(m);
  note_onset(m);
  if (m.scatterer == ScattererKind::spheres) note_sphere_sizes(m);
}

}  // namespace aureole
