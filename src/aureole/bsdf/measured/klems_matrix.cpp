// SPDX-License-Identifier: Apache-2.0
// Numbers and directions as in Radiance: G. Ward, R. Mistrick, E. S. Lee, A. McNeil and J. Jonsson, "Simulating the
// daylight performance of complex fenestration systems using bidirectional scattering distribution functions within
// Radiance", Leukos 7(4), 2011. +z points into the room, where the file's front is outside.
#include "aureole/bsdf/measured/klems_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/math/warp.h"

namespace aureole {

KlemsPatches::KlemsPatches(const AngleBasis& basis) {
  for (const AngleBasis::Ring& r : basis.rings) {
    const double low = std::sin(r.lower * kDegree), high = std::sin(r.upper * kDegree);
    rings_.push_back(
        {float(low * low), float(high * high), std::uint32_t(count_), std::uint32_t(r.azimuths)});
    count_ += std::size_t(r.azimuths);
  }
}

std::size_t KlemsPatches::at(float x, float y, float z) const {
  if (!(z > 0)) return count_;
  const float sin2 = x * x + y * y;
  for (const Ring& r : rings_) {
    // The last ring includes directions that rounding moves beyond 90 degrees from the normal.
    if (sin2 >= r.upper_sin2 && !(&r == &rings_.back() && r.upper_sin2 > 0.99999f)) continue;
    const float turns = azimuth_of({x, y, 0}) * (0.5f * kInvPi);
    const int cell = int(std::floor((turns < 0 ? turns + 1 : turns) * float(r.azimuths) + 0.5f));
    return r.first + std::uint32_t(cell) % r.azimuths;
  }
  return count_;
}

const KlemsPatches::Ring& KlemsPatches::ring_of(std::size_t patch) const {
  const auto above = std::upper_bound(rings_.begin(), rings_.end(), patch,
                                      [](std::size_t p, const Ring& r) { return p < r.first; });
  return *std::prev(above);
}

double KlemsPatches::projected_solid_angle(std::size_t patch) const {
  const Ring& r = ring_of(patch);
  return kPiD * (double(r.upper_sin2) - double(r.lower_sin2)) / double(r.azimuths);
}

Vec3 KlemsPatches::sample(std::size_t patch, Vec2 u) const {
  const Ring& r = ring_of(patch);
  const float sin2 = std::min(r.lower_sin2 + u.x * (r.upper_sin2 - r.lower_sin2), kOneMinusEpsilon);
  const float turns = (float(patch - r.first) + u.y - 0.5f) / float(r.azimuths);
  const Vec2 a = cos_sin_2pi(turns - std::floor(turns));
  const float sine = std::sqrt(sin2);
  return {sine * a.x, sine * a.y, std::sqrt(1 - sin2)};
}

std::array<float, 3> KlemsMatrix::at(const Vec3& i, const Vec3& o) const {
  if (empty()) return {};
  const std::size_t row = incident.at(-i.x, -i.y, i.z), column = outgoing.at(o.x, o.y, o.z);
  if (row >= incident.count() || column >= outgoing.count()) return {};
  const std::size_t at = row * outgoing.count() + column;
  if (!is_coloured) return {values[at], values[at], values[at]};
  return {values[3 * at], values[3 * at + 1], values[3 * at + 2]};
}

float KlemsMatrix::mean(std::size_t i, std::size_t o) const {
  const std::size_t at = i * outgoing.count() + o;
  return is_coloured ? (values[3 * at] + values[3 * at + 1] + values[3 * at + 2]) / 3 : values[at];
}

/// Linear sRGB of values for the responses X, Y and Z, which are relative as WINDOW and Radiance have them: a neutral sheet has equal
/// ones. They become tristimulus values by those of the white, CIE D65.
std::array<float, 3> rgb_of_xyz(double x, double y, double z) {
  x *= 0.95047, z *= 1.08883;
  // Matrix from CIE XYZ to linear sRGB (IEC 61966-2-1).
  return {float(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          float(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          float(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

KlemsSheet read_klems_sheet(const WindowFile& file, WindowNotes& notes) {
  KlemsSheet sheet;
  // Blocks in reading order: the block of the visible range comes first, since it decides which other blocks
  // are read.
  struct Read {
    const WindowBlock* block;
    std::vector<double> values;  // matrix by incident and outgoing patch
  };
  std::vector<Read> reads;
  for (const WindowBlock& block : file.blocks) {
    const std::size_t incident = file.basis(block.column_basis, block.where).size(),
                      outgoing = file.basis(block.row_basis, block.where).size();
    // Columns belong to incident patches; where rows do, the file lists the rows one after the other.
    const bool by_rows = file.structure == WindowFile::Structure::rows;
    NumberReader reader(block.data, block.where);
    std::vector<double> values(incident * outgoing);
    for (std::size_t k = 0; k < values.size(); ++k) {
      double value = reader.number();
      if (value > 1e30) throw reader.error(fmt::format("{:g} is no scattering per steradian", value));
      if (value < 0) value = 0, ++notes.negative;
      const std::size_t i = by_rows ? k / outgoing : k % incident, o = by_rows ? k % outgoing : k / incident;
      values[i * outgoing + o] = value;
    }
    if (reader.peek())
      throw reader.error(fmt::format("there are more than the {} x {} numbers of {} and {}", outgoing,
                                     incident, block.row_basis.substr(0, 80),
                                     block.column_basis.substr(0, 80)));
    reads.push_back({&block, std::move(values)});
  }
  const auto find = [&](bool transmission, bool front, int channel) -> const Read* {
    for (const Read& r : reads)
      if (r.block->is_transmission == transmission && r.block->is_front == front &&
          r.block->channel == channel)
        return &r;
    return nullptr;
  };
  for (const bool transmission : {false, true})
    for (const bool front : {false, true}) {
      const Read* y = find(transmission, front, 1);
      if (!y) continue;
      KlemsMatrix& m = (transmission ? sheet.transmission : sheet.reflection)[front ? 1 : 0];
      m.incident = KlemsPatches(file.basis(y->block->column_basis, y->block->where));
      m.outgoing = KlemsPatches(file.basis(y->block->row_basis, y->block->where));
      const Read *x = find(transmission, front, 0), *z = find(transmission, front, 2);
      m.is_coloured = x && z && x->values.size() == y->values.size() && z->values.size() == y->values.size();
      for (std::size_t k = 0; k < y->values.size(); ++k) {
        if (!m.is_coloured) {
          m.values.push_back(float(y->values[k]));
          continue;
        }
        for (float c : rgb_of_xyz(x->values[k], y->values[k], z->values[k])) {
          if (c < -1e-6f) ++notes.negative;
          m.values.push_back(std::max(c, 0.f));
        }
      }
    }
  // A sheet in air transmits equally in both directions (Helmholtz), so that one direction gives the other.
  for (const std::size_t side : {std::size_t(0), std::size_t(1)}) {
    KlemsMatrix& missing = sheet.transmission[side];
    const KlemsMatrix& other = sheet.transmission[1 - side];
    if (!missing.empty() || other.empty()) continue;
    (side == 1 ? notes.reversed_front : notes.reversed_back) = true;
    missing.incident = other.outgoing, missing.outgoing = other.incident,
    missing.is_coloured = other.is_coloured;
    const std::size_t channels = other.is_coloured ? 3 : 1;
    const std::size_t rows = other.incident.count(), columns = other.outgoing.count();
    missing.values.resize(other.values.size());
    // Patch k of the incident basis is opposite to patch k of the outgoing basis: both are turned by 180
    // degrees.
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t o = 0; o < columns; ++o) {
        const Vec3 out = other.outgoing.sample(o, {0.5f, 0.5f}), in = other.incident.sample(i, {0.5f, 0.5f});
        const std::size_t row = missing.incident.at(-out.x, -out.y, out.z),
                          column = missing.outgoing.at(-in.x, -in.y, in.z);
        for (std::size_t c = 0; c < channels; ++c)
          missing.values[(row * rows + column) * channels + c] =
              other.values[(i * columns + o) * channels + c];
      }
  }
  return sheet;
}

}  // namespace aureole
