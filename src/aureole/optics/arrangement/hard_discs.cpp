// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/hard_discs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Relative margin between touching discs, so that rounding never makes them overlap.
constexpr double kMargin = 1 + 1e-12;

}  // namespace

double HardDiscs::area_fraction() const {
  double area = 0;
  for (const double r : radius) area += kPi * r * r;
  return area / (box_x * box_y);
}

double hard_disc_pressure(double fa) { return (1 + fa * fa / 8) / ((1 - fa) * (1 - fa)); }

double hard_disc_contact_value(double fa) { return (1 - 7 * fa / 16) / ((1 - fa) * (1 - fa)); }

HardDiscSimulation::HardDiscSimulation(int n, double area_fraction, std::uint64_t seed)
    : HardDiscSimulation(std::vector<double>(size_t(std::max(n, 0)), 1.0), area_fraction, seed) {}

HardDiscSimulation::HardDiscSimulation(std::vector<double> radii, double area_fraction, std::uint64_t seed)
    : seed_(mix_bits(seed + 0x9e3779b97f4a7c15u)), area_fraction_(area_fraction) {
  if (!(area_fraction > 0 && area_fraction <= kMaxAreaFraction))
    throw std::domain_error("area fraction of simulated hard discs must be above 0 and at most 0.68, got " +
                            std::to_string(area_fraction));
  double area = 0, mean = 0, largest = 0;
  for (const double r : radii) {
    if (!(r > 0 && std::isfinite(r)))
      throw std::domain_error("radii of hard discs must be positive, got " + std::to_string(r));
    area += kPi * r * r, mean += r, largest = std::max(largest, r);
  }
  discs_.box_x = discs_.box_y = std::sqrt(area / area_fraction);
  if (radii.empty() || !(discs_.box_x >= 8 * largest))
    throw std::domain_error("too few hard discs (" + std::to_string(radii.size()) +
                            "): the box must be at least four of the largest diameters wide");
  mean /= double(radii.size());
  discs_.radius = std::move(radii);
  mixed_ = std::any_of(discs_.radius.begin(), discs_.radius.end(),
                       [&](double r) { return r != discs_.radius[0]; });

  // A collision transfers the motion over pi/4 diameters on average, so the pressure gives the mean free
  // path. Chains of any length sample the equilibrium as long as all chains have the same length; this length
  // gives sqrt(n) collisions on average.
  const double n = discs_.size();
  const double free_path =
      std::min(kPi / 2 * mean / (hard_disc_pressure(area_fraction) - 1), discs_.box_x / 4);
  chain_length_ = std::sqrt(n) * free_path;
  chains_per_sweep_ = std::sqrt(n);

  place_on_lattice();
  build_cells(largest);
  std::vector<double> target = discs_.radius;
  // The initial size is the largest that the closest pair of lattice sites allows. Discs that have reached
  // their radius do not grow further.
  std::fill(discs_.radius.begin(), discs_.radius.end(), 0.0);
  double nearest = discs_.box_x;
  for (int i = 0; i < discs_.size(); ++i) nearest = std::min(nearest, room(i));
  for (int i = 0; i < discs_.size(); ++i) discs_.radius[i] = std::min(target[i], nearest / 2 / kMargin);
  grow(target);
  reset_pressure();
}

void HardDiscSimulation::place_on_lattice() {
  const int n = discs_.size();
  const double box = discs_.box_x;
  int best_columns = 1, best_rows = 2;
  double best = 0;
  for (int rows = 2; rows <= 2 * (n + 1); rows += 2) {
    const int columns = (n + rows - 1) / rows;
    const double along = box / columns, up = box / rows;
    const double nearest = std::min({along, 2 * up, std::hypot(along / 2, up)});
    if (nearest > best) best = nearest, best_columns = columns, best_rows = rows;
  }
  std::vector<int> order(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) order[i] = i;
  if (mixed_)
    for (int i = n - 1; i > 0; --i) std::swap(order[i], order[random() * (i + 1)]);
  discs_.x.resize(size_t(n)), discs_.y.resize(size_t(n));
  const std::int64_t sites = std::int64_t(best_columns) * best_rows;
  for (int i = 0; i < n; ++i) {
    // lattice sites are skipped evenly, so that the vacancies are spread
    const int site = int(i * sites / n);
    const int row = site / best_columns, column = site % best_columns;
    discs_.x[order[size_t(i)]] = (column + 0.5 * (row % 2) + 0.25) * box / best_columns;
    discs_.y[order[size_t(i)]] = (row + 0.5) * box / best_rows;
  }
}

void HardDiscSimulation::build_cells(double largest_radius) {
  const double box[2] = {discs_.box_x, discs_.box_y};
  for (int axis = 0; axis < 2; ++axis) {
    // Number of cells along a side: at most about one cell per disc, however small the discs are.
    const double limit = std::ceil(std::sqrt(double(discs_.size())));
    cells_[axis] =
        std::max(4, int(std::min(limit, std::floor(box[axis] / (2 * largest_radius) * (1 - 1e-9)))));
    cells_[axis] = int(std::min<double>(cells_[axis], box[axis] / (2 * largest_radius * (1 + 1e-9))));
    cell_size_[axis] = box[axis] / cells_[axis];
  }
  const int cells = cells_[0] * cells_[1];
  capacity_ = 8;
  count_.assign(size_t(cells), 0);
  members_.assign(size_t(cells) * size_t(capacity_), 0);
  cell_of_.assign(size_t(discs_.size()), 0);
  slot_of_.assign(size_t(discs_.size()), 0);
  for (int i = 0; i < discs_.size(); ++i) {
    const int cx = std::min(int(discs_.x[i] / cell_size_[0]), cells_[0] - 1);
    const int cy = std::min(int(discs_.y[i] / cell_size_[1]), cells_[1] - 1);
    insert(i, cy * cells_[0] + cx);
  }
}

void HardDiscSimulation::insert(int disc, int cell) {
  if (count_[cell] == capacity_) {
    std::vector<int> wider(members_.size() * 2);
    for (size_t c = 0; c < count_.size(); ++c)
      std::copy_n(members_.begin() + std::ptrdiff_t(c) * capacity_, count_[c],
                  wider.begin() + std::ptrdiff_t(c) * capacity_ * 2);
    members_.swap(wider);
    capacity_ *= 2;
  }
  const int slot = count_[cell]++;
  members_[cell * capacity_ + slot] = disc;
  cell_of_[disc] = cell;
  slot_of_[disc] = slot;
}

void HardDiscSimulation::remove(int disc) {
  const int cell = cell_of_[disc], slot = slot_of_[disc];
  const int last = members_[cell * capacity_ + --count_[size_t(cell)]];
  members_[cell * capacity_ + slot] = last;
  slot_of_[last] = slot;
}

/// Returns the largest radius with which the disc touches no disc in the 3 x 3 cells around it; at most the
/// side of a cell.
double HardDiscSimulation::room(int disc) const {
  const size_t i = size_t(disc);
  const int cx = cell_of_[i] % cells_[0], cy = cell_of_[i] / cells_[0];
  double least = std::min(cell_size_[0], cell_size_[1]);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int cell = (cy + dy + cells_[1]) % cells_[1] * cells_[0] + (cx + dx + cells_[0]) % cells_[0];
      for (int k = 0; k < count_[cell]; ++k) {
        const size_t j = size_t(members_[cell * capacity_ + k]);
        if (j == i) continue;
        const double x = std::remainder(discs_.x[j] - discs_.x[i], discs_.box_x);
        const double y = std::remainder(discs_.y[j] - discs_.y[i], discs_.box_y);
        least = std::min(least, std::sqrt(x * x + y * y) - discs_.radius[j]);
      }
    }
  return least;
}

void HardDiscSimulation::grow(const std::vector<double>& target) {
  constexpr int kPatience = 20000;
  for (int round = 0; round < kPatience; ++round) {
    bool all = true;
    for (int i = 0; i < discs_.size(); ++i) {
      double& r = discs_.radius[i];
      if (r == target[i]) continue;
      // The radius fits into a cell: `room` is at most a cell's side, which is at least the diameter of the
      // largest final disc.
      r = std::max(r, std::min(target[i], room(i) - 2 * (kMargin - 1) * cell_size_[0]));
      all = all && r == target[i];
    }
    if (all) return;
    advance(1);
  }
  throw std::domain_error("hard discs of these radii could not be brought to an area fraction of " +
                          std::to_string(area_fraction_) + ", only to " +
                          std::to_string(discs_.area_fraction()));
}

void HardDiscSimulation::chain(int disc, int axis) {
  // p is the coordinate along the chain, t the one across it.
  double* p = (axis ? discs_.y : discs_.x).data();
  double* t = (axis ? discs_.x : discs_.y).data();
  const double box_p = axis ? discs_.box_y : discs_.box_x, box_t = axis ? discs_.box_x : discs_.box_y;
  const int cells_p = cells_[axis], cells_t = cells_[1 - axis];
  const int stride_p = axis ? cells_[0] : 1, stride_t = axis ? 1 : cells_[0];
  const double* radius = discs_.radius.data();
  double left = chain_length_, carried = 0;
  int cp = axis ? cell_of_[disc] / cells_[0] : cell_of_[disc] % cells_[0];
  int ct = axis ? cell_of_[disc] % cells_[0] : cell_of_[disc] / cells_[0];
  while (true) {
    // Discs beyond the neighbouring cell cannot be hit before the chain leaves the current one, since cells
    // are a diameter wide.
    const double at = p[disc], across = t[disc], own = radius[disc];
    const double to_edge = std::max((cp + 1) * cell_size_[axis] - at, 0.0);
    double free = std::min(left, to_edge), jump = 0;
    int hit = -1, hit_cp = 0, hit_ct = 0;
    for (int row = -1; row <= 1; ++row) {
      int rt = ct + row;
      double shift_t = -across;
      if (rt < 0)
        rt += cells_t, shift_t -= box_t;
      else if (rt == cells_t)
        rt = 0, shift_t += box_t;
      for (int column = 0; column <= 1; ++column) {
        int rp = cp + column;
        double shift_p = -at;
        if (rp == cells_p) rp = 0, shift_p += box_p;
        const int cell = rp * stride_p + rt * stride_t;
        const int* member = &members_[cell * capacity_];
        for (int k = 0, n = count_[cell]; k < n; ++k) {
          const int j = member[k];
          const double ahead = p[j] + shift_p, beside = t[j] + shift_t;
          const double contact = (own + radius[j]) * kMargin;
          if (!(ahead > 0 && ahead < free + contact) || j == disc) continue;
          const double squared = contact * contact - beside * beside;
          if (squared <= 0) continue;
          const double reach = std::sqrt(squared), gap = std::max(ahead - reach, 0.0);
          if (gap < free || (gap == 0 && hit < 0)) {
            free = gap, jump = reach, hit = j, hit_cp = rp, hit_ct = rt;
          }
        }
      }
    }
    left -= free;
    if (hit >= 0) {
      p[disc] = at + free;
      carried += jump;
      disc = hit, cp = hit_cp, ct = hit_ct;
      if (left <= 0) break;
      continue;
    }
    if (free < to_edge) {  // the remaining length of the chain is used up
      p[disc] = at + free;
      break;
    }
    remove(disc);
    cp = cp + 1 == cells_p ? 0 : cp + 1;
    p[disc] = cp * cell_size_[axis];
    insert(disc, cp * stride_p + ct * stride_t);
    if (left <= 0) break;
  }
  ++chains_[axis];
  carried_[axis] += carried;
}

bool HardDiscSimulation::fits(int place, double x, double y, double radius, int ignored) const {
  const int cx = cell_of_[place] % cells_[0], cy = cell_of_[place] / cells_[0];
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int cell = (cy + dy + cells_[1]) % cells_[1] * cells_[0] + (cx + dx + cells_[0]) % cells_[0];
      for (int k = 0; k < count_[cell]; ++k) {
        const int j = members_[cell * capacity_ + k];
        if (j == place || j == ignored) continue;
        const double ex = std::remainder(discs_.x[j] - x, discs_.box_x);
        const double ey = std::remainder(discs_.y[j] - y, discs_.box_y);
        const double contact = (radius + discs_.radius[j]) * kMargin;
        if (ex * ex + ey * ey < contact * contact) return false;
      }
    }
  return true;
}

void HardDiscSimulation::try_swap() {
  int big = int(random() * discs_.size()), small = int(random() * discs_.size());
  const std::vector<double>& r = discs_.radius;
  if (r[big] == r[small]) return;
  if (r[big] < r[small]) std::swap(big, small);
  if (!fits(small, discs_.x[small], discs_.y[small], r[big], big)) return;
  const int cell_big = cell_of_[big], cell_small = cell_of_[small];
  remove(big), remove(small);
  std::swap(discs_.x[big], discs_.x[small]);
  std::swap(discs_.y[big], discs_.y[small]);
  insert(big, cell_small), insert(small, cell_big);
}

void HardDiscSimulation::advance(double sweeps) {
  // The number of moves must not depend on their outcome: stopping at the n-th collision would bias the
  // distribution.
  chains_due_ += sweeps * chains_per_sweep_;
  for (; chains_due_ >= 1; chains_due_ -= 1) {
    const int disc = int(random() * discs_.size());
    chain(disc, random() < 0.5 ? 0 : 1);
    if (!mixed_) continue;
    constexpr double kSwapsPerDisc = 0.5;
    swaps_due_ += kSwapsPerDisc * discs_.size() / chains_per_sweep_;
    for (; swaps_due_ >= 1; swaps_due_ -= 1) try_swap();
  }
}

// Integrated autocorrelation times, 2 tau, of S at its peak, in sweeps, from 6000 snapshots of 1500 discs:
// 1.4 for Fa up to 0.3, 3 (0.5), 6 (0.6), 15 (0.65), 35 (0.68). S at the box's longest wave has 25 to 65 at
// any Fa, and more in larger boxes.
double HardDiscSimulation::peak_correlation() const {
  return 1.4 + 35 * std::exp((area_fraction_ - 0.68) / 0.03);
}

double HardDiscSimulation::equilibration_sweeps() const {
  return 200 * std::max(1.0, discs_.size() / 1500.0) + 30 * peak_correlation();
}
double HardDiscSimulation::decorrelation_sweeps() const {
  return 2.5 + 8 * area_fraction_ + 0.3 * peak_correlation();
}

double HardDiscSimulation::pressure(int axis) const {
  return 1 + carried_[axis] / (double(chains_[axis]) * chain_length_);
}

double HardDiscSimulation::pressure() const {
  return 1 + (carried_[0] + carried_[1]) / (double(chains_[0] + chains_[1]) * chain_length_);
}

}  // namespace aureole::optics
