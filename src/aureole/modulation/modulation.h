// SPDX-License-Identifier: Apache-2.0
// The modulation family: how the light of an emitter changes over time.
#pragma once

#include <memory>

#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"

namespace aureole {

class Modulation : public Object {
public:
  static constexpr const char* kFamily = "a modulation";
  explicit Modulation(const Properties& properties);

  /// The factor of the emission at a time [s]. It is not negative.
  float at(double time) const { return float(relative(time) * scale_); }
  /// The integral of the factor between two times [s].
  double integral(double from, double to) const { return (primitive(to) - primitive(from)) * scale_; }

protected:
  /// The curve before it is scaled so that the stated emission is its mean or its peak.
  virtual double relative(double time) const = 0;
  /// A function whose derivative by the time is `relative`.
  virtual double primitive(double time) const = 0;
  /// Sets the scale by mean and maximum of `relative`, both positive. Called by constructors.
  void refer_to(double mean, double peak);

private:
  bool by_peak_;
  double scale_ = 1;
};

using ModulationPtr = std::shared_ptr<const Modulation>;

}  // namespace aureole
