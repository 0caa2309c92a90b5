// SPDX-License-Identifier: Apache-2.0
// Light that varies periodically: the flicker of lamps on alternating current and of pulse width modulation.
#include <cmath>

#include "aureole/modulation/modulation.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class Wave final : public Modulation {
public:
  explicit Wave(const Properties& p) : Modulation(p) {
    frequency_ = p.get_float("frequency", {0, 1e12, true});
    phase_ = p.get_float("phase", 0, {-1e9, 1e9});
    depth_ = p.get_float("depth", 1, Range::unit());
    const std::string form =
        p.get_choice("waveform", "sine", {"sine", "rectified", "square", "triangle", "sawtooth"});
    duty_ = p.get_float("duty", 0.5, {0, 1, true});
    if (p.has("duty") && form != "square")
      p.note("duty", "a wave of the form \"" + form + "\" has no duty cycle: it has no effect");
    double mean = 0.5;
    if (form == "rectified") form_ = Form::rectified, mean = 2 / M_PI;
    if (form == "square") form_ = Form::square, mean = duty_;
    if (form == "triangle") form_ = Form::triangle;
    if (form == "sawtooth") form_ = Form::sawtooth;
    refer_to(1 - depth_ + depth_ * mean, 1);
  }

protected:
  double relative(double time) const override {
    const double turns = frequency_ * time + phase_, x = turns - std::floor(turns);
    return 1 - depth_ + depth_ * wave(x);
  }
  double primitive(double time) const override {
    const double turns = frequency_ * time + phase_, whole = std::floor(turns);
    return (1 - depth_) * time + depth_ * (whole * area(1) + area(turns - whole)) / frequency_;
  }

private:
  /// The wave at the fraction x of its period, in [0, 1].
  double wave(double x) const {
    switch (form_) {
      case Form::sine:
        return 0.5 - 0.5 * std::cos(2 * M_PI * x);
      case Form::rectified:
        return std::sin(M_PI * x);
      case Form::square:
        return x < duty_ ? 1 : 0;
      case Form::triangle:
        return 1 - std::abs(2 * x - 1);
      case Form::sawtooth:
        break;
    }
    return 1 - x;
  }

  /// Integral of the wave up to the fraction x of its period.
  double area(double x) const {
    switch (form_) {
      case Form::sine:
        return 0.5 * x - std::sin(2 * M_PI * x) / (4 * M_PI);
      case Form::rectified:
        return (1 - std::cos(M_PI * x)) / M_PI;
      case Form::square:
        return x < duty_ ? x : duty_;
      case Form::triangle:
        return x < 0.5 ? x * x : 2 * x - x * x - 0.5;
      case Form::sawtooth:
        break;
    }
    return x - 0.5 * x * x;
  }

  enum class Form { sine, rectified, square, triangle, sawtooth } form_ = Form::sine;
  double frequency_ = 0, phase_ = 0, depth_ = 1, duty_ = 0.5;
};

AUREOLE_PLUGIN(
    Wave, "modulation", "wave",
    PluginDoc{
        "Periodic light, 1 - depth + depth w(frequency t + phase), over its mean or its peak. With x, the fraction of "
        "the period, w is: `sine`, (1 - cos(2 pi x))/2, the power of alternating current, whose frequency is twice "
        "that of the mains; `rectified`, sin(pi x); `square`, 1 for x < duty, else 0; `triangle`, from 0 to 1 and "
        "back; `sawtooth`, falling from 1 to 0. The percent flicker of the CIE, (max - min)/(max + min), is "
        "depth/(2 - depth).",
        "CIE TN 006:2016, \"Visual aspects of time-modulated lighting systems\"",
        {{"frequency", "float", "Hz", "required", "periods of the light per second"},
         {"waveform", "string", "", "sine", "sine, rectified, square, triangle or sawtooth"},
         {"phase", "float", "periods", "0", "fraction of a period that has passed at the time 0"},
         {"depth", "float", "", "1",
          "fraction of the peak that is modulated; 1: the light goes out once a period"},
         {"duty", "float", "", "0.5",
          "for square waves: fraction of the period during which the light is on"}},
        {R"(<modulation type="wave">
    <float name="frequency" value="100"/> <string name="waveform" value="square"/> <float name="duty" value="0.2"/>
    <float name="phase" value="0.25"/> <float name="depth" value="0.9"/> <string name="reference" value="peak"/>
</modulation>)",
         R"(<modulation type="wave"><float name="frequency" value="100"/></modulation>)"}});

}  // namespace
}  // namespace aureole
