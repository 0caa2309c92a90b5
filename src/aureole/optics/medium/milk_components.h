// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace aureole::optics {

/// A row of data/milk.inc, which names the sources.
struct MilkComponents {
  double lambda_nm;
  double water_index;
  double fat_index, fat_absorption_index;  ///< real index of milk fat, and 1e6 times its imaginary index
  double riboflavin_absorbance;
};
/// Returns the rows, from 375 to 775 nm in steps of 25 nm.
std::span<const MilkComponents> milk_components();

}  // namespace aureole::optics
