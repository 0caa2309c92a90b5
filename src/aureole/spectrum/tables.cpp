// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/tables.h"

#include <algorithm>

#include "aureole/core/letter_case.h"

namespace aureole {
namespace {

constexpr double kIlluminantStep = 5.0;

struct IlluminantRecord {
  std::string_view name;
  double start_nm;
  std::span<const double> values;
};

#include "aureole/spectrum/data/cie_1931_observer.inc"
#include "aureole/spectrum/data/cie_1964_observer.inc"
#include "aureole/spectrum/data/illuminants.inc"

/// Wavelengths 300, 305, ... 830 nm: every illuminant uses a subrange of them.
constexpr auto kTabulatedNm = [] {
  std::array<double, 107> nm{};
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = 300.0 + kIlluminantStep * static_cast<double>(i);
  return nm;
}();

}  // namespace

double TabulatedSpectrum::at(double lambda_nm) const {
  if (wavelengths_nm.empty() || !(lambda_nm >= wavelengths_nm.front() && lambda_nm <= wavelengths_nm.back()))
    return 0;
  const auto above = std::ranges::upper_bound(wavelengths_nm, lambda_nm);
  const auto i = static_cast<std::size_t>(above - wavelengths_nm.begin());
  if (i == wavelengths_nm.size()) return values.back();
  const double t = (lambda_nm - wavelengths_nm[i - 1]) / (wavelengths_nm[i] - wavelengths_nm[i - 1]);
  return values[i - 1] + t * (values[i] - values[i - 1]);
}

const Observer& cie_1931_observer() {
  static const Observer observer{360.0, 1.0, kObserverX, kObserverY, kObserverZ};
  return observer;
}

const Observer& cie_1964_observer() {
  static const Observer observer{360.0, 1.0, kObserver10X, kObserver10Y, kObserver10Z};
  return observer;
}

double cie_y_integral() {
  static const double integral = [] {
    static constexpr double kEnds[] = {0.0, 1e9}, kOne[] = {1.0, 1.0};
    return cie_tristimulus({kEnds, kOne})[1];
  }();
  return integral;
}

std::array<double, 3> cie_tristimulus(const TabulatedSpectrum& spectrum) {
  const Observer& observer = cie_1931_observer();
  const std::size_t size = observer.y.size();
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < size; ++i) {
    const double width = observer.step_nm * (i == 0 || i + 1 == size ? 0.5 : 1.0);
    const double w = width * spectrum.at(observer.start_nm + observer.step_nm * static_cast<double>(i));
    sum[0] += w * observer.x[i];
    sum[1] += w * observer.y[i];
    sum[2] += w * observer.z[i];
  }
  return sum;
}

std::optional<TabulatedSpectrum> find_illuminant(std::string_view name) {
  std::string full(name);
  if (full.size() > 1 && (full[0] == 'F' || full[0] == 'f') &&
      std::isdigit(static_cast<unsigned char>(full[1])))
    full = "FL" + full.substr(1);
  for (const IlluminantRecord& record : kIlluminants) {
    if (!equal_without_case(record.name, full)) continue;
    const auto first = static_cast<std::size_t>((record.start_nm - kTabulatedNm.front()) / kIlluminantStep);
    return TabulatedSpectrum{std::span(kTabulatedNm).subspan(first, record.values.size()), record.values};
  }
  return std::nullopt;
}

std::vector<std::string> illuminant_names() {
  std::vector<std::string> names;
  for (const IlluminantRecord& record : kIlluminants) names.emplace_back(record.name);
  return names;
}

double d65_whitepoint_normalization() {
  static const double factor = cie_y_integral() / cie_tristimulus(*find_illuminant("D65"))[1];
  return factor;
}

}  // namespace aureole
