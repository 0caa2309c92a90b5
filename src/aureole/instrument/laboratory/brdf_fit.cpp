// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/brdf_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"
#include "aureole/loading/load.h"
#include "aureole/math/vec.h"
#include "aureole/optics/least_squares.h"

namespace aureole {
namespace {

/// A model: a scaled diffuse term, a scaled lobe and parameters of the lobe. `lobe` is a <bsdf> for values of these.
struct BrdfModel {
  const char* name;
  bool has_diffuse, has_scale;  ///< whether kd/pi is added, and whether the lobe is multiplied by ks
  struct Parameter {
    const char* name;
    double start, low, high;
  };
  std::vector<Parameter> parameters;
  std::function<std::string(const double*)> lobe;
  /// The whole material as a <bsdf>: reflectances kd and ks as text of a <spectrum>, then the parameters.
  std::function<std::string(const std::string& kd, const std::string& ks, const double*)> material;
  /// Whether `material` is a blend: reflectances are divided by the weights, and the lobe's weight follows the parameters.
  bool is_blend = false;
};

std::string number(const char* name, double value) {
  return fmt::format("<float name=\"{}\" value=\"{:.9g}\"/>", name, value);
}
std::string spectrum(const char* name, const std::string& values) {
  return fmt::format("<spectrum name=\"{}\" value=\"{}\"/>", name, values);
}
std::string rough_metal(const char* distribution, double alpha, const std::string& reflectance) {
  return fmt::format(
      "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"none\"/><string name=\"distribution\" "
      "value=\"{}\"/>{}{}</bsdf>",
      distribution, number("alpha", alpha),
      reflectance.empty() ? "" : spectrum("specular_reflectance", reflectance));
}
std::string rough_glass(const char* distribution, double alpha, double ior) {
  return fmt::format(
      "<bsdf type=\"roughdielectric\"><string name=\"distribution\" value=\"{}\"/>{}{}{}</bsdf>",
      distribution, number("alpha", alpha), number("int_ior", ior), number("ext_ior", 1));
}
/// A lobe that cannot be scaled beside a diffuse term: no plug-in is their sum.
std::string sum_of(const std::string& kd, const std::string& lobe) {
  return "<!-- f is the sum of these two BSDFs, which no single one is -->\n<bsdf type=\"diffuse\">" +
         spectrum("reflectance", kd) + "</bsdf>\n" + lobe;
}
/// A blend; `kd` and `ks` have been divided by the weights of the diffuse term and of the lobe.
std::string blend_of(const std::string& kd, const std::string& lobe, double weight) {
  return "<bsdf type=\"blendbsdf\">" + number("weight", weight) + "<bsdf type=\"diffuse\">" +
         spectrum("reflectance", kd) + "</bsdf>" + lobe + "</bsdf>";
}

const std::vector<BrdfModel>& models() {
  static const std::vector<BrdfModel> all{
      {"lambert",
       true,
       false,
       {},
       {},
       [](const std::string& kd, const std::string&, const double*) {
         return "<bsdf type=\"diffuse\">" + spectrum("reflectance", kd) + "</bsdf>";
       }},
      {"oren_nayar",
       false,
       false,
       {{"reflectance", 0.5, 1e-3, 1}, {"sigma", 20, 0.1, 60}},
       [](const double* p) {
         return "<bsdf type=\"oren_nayar\">" + number("reflectance", p[0]) + number("sigma", p[1]) +
                "</bsdf>";
       },
       {}},
      {"ward",
       true,
       true,
       {{"alpha", 0.2, 5e-3, 1}},
       [](const double* p) {
         return "<bsdf type=\"ward\">" + number("alpha_u", p[0]) + number("alpha_v", p[0]) +
                number("specular_reflectance", 1) + number("diffuse_reflectance", 0) + "</bsdf>";
       },
       [](const std::string& kd, const std::string& ks, const double* p) {
         return "<bsdf type=\"ward\">" + number("alpha_u", p[0]) + number("alpha_v", p[0]) +
                spectrum("specular_reflectance", ks) + spectrum("diffuse_reflectance", kd) + "</bsdf>";
       }},
      {"cook_torrance",
       true,
       false,
       {{"alpha", 0.2, 5e-3, 1}, {"eta", 1.5, 1.02, 4}},
       [](const double* p) {
         return "<bsdf type=\"cook_torrance\">" + number("alpha", p[0]) + number("eta", p[1]) +
                number("specular", 1) + number("diffuse", 0) + "</bsdf>";
       },
       [](const std::string& kd, const std::string&, const double* p) {
         return sum_of(kd, "<bsdf type=\"cook_torrance\">" + number("alpha", p[0]) + number("eta", p[1]) +
                               number("specular", 1) + number("diffuse", 0) + "</bsdf>");
       }},
      {"beckmann",
       true,
       true,
       {{"alpha", 0.2, 5e-3, 1}},
       [](const double* p) { return rough_metal("beckmann", p[0], ""); },
       [](const std::string& kd, const std::string& ks, const double* p) {
         return blend_of(kd, rough_metal("beckmann", p[0], ks), p[1]);
       },
       true},
      {"ggx",
       true,
       true,
       {{"alpha", 0.2, 5e-3, 1}},
       [](const double* p) { return rough_metal("ggx", p[0], ""); },
       [](const std::string& kd, const std::string& ks, const double* p) {
         return blend_of(kd, rough_metal("ggx", p[0], ks), p[1]);
       },
       true},
      {"beckmann_dielectric",
       true,
       false,
       {{"alpha", 0.2, 5e-3, 1}, {"eta", 1.5, 1.02, 4}},
       [](const double* p) { return rough_glass("beckmann", p[0], p[1]); },
       [](const std::string& kd, const std::string&, const double* p) {
         return sum_of(kd, rough_glass("beckmann", p[0], p[1]));
       }},
      {"ggx_dielectric",
       true,
       false,
       {{"alpha", 0.2, 5e-3, 1}, {"eta", 1.5, 1.02, 4}},
       [](const double* p) { return rough_glass("ggx", p[0], p[1]); },
       [](const std::string& kd, const std::string&, const double* p) {
         return sum_of(kd, rough_glass("ggx", p[0], p[1]));
       }},
      {"principled",
       false,
       false,
       {{"base_color", 0.5, 1e-3, 1},
        {"roughness", 0.5, 0.07, 1},
        {"metallic", 0.3, 0, 1},
        {"specular", 0.5, 0, 1}},
       [](const double* p) {
         return "<bsdf type=\"principled\">" + number("base_color", p[0]) + number("roughness", p[1]) +
                number("metallic", p[2]) + number("specular", p[3]) + "</bsdf>";
       },
       {}}};
  return all;
}

/// Pairs of directions within the cones of lamp and detector and over the viewed area, for one reading.
struct ConePairs {
  std::vector<Vec3> in, out;
};

constexpr double kRecurrence6 = 1.1127756842787055;  ///< the positive root of x^7 = x + 1

/// A uniform point of a disc of this radius.
Vec2 point_of_disc(double radius, double u, double v) {
  const double r = radius * std::sqrt(u), angle = 2 * kPiD * v;
  return {float(r * std::cos(angle)), float(r * std::sin(angle))};
}

/// The direction from a point of the sample, in units of the distance, to a point of an aperture of this half-angle.
Vec3 towards_aperture(double theta, double phi, double half_angle, double distance, Vec2 from, double u,
                      double v) {
  const double t = theta * kDegree, a = phi * kDegree;
  const Vec3 axis{float(std::sin(t) * std::cos(a)), float(std::sin(t) * std::sin(a)), float(std::cos(t))};
  const Vec2 p = point_of_disc(std::tan(half_angle * kDegree), u, v);
  const Vec3 at = (axis + Frame::from_normal(axis).to_world({p.x, p.y, 0})) * float(distance);
  return normalize(at - Vec3{from.x, from.y, 0});
}

class Fitter {
public:
  Fitter(const GonioTable& table, const FitSettings& s) : settings_(s) {
    std::vector<const GonioReading*> reflected;
    for (const GonioReading& r : table.readings)
      if (r.theta_o < 90) reflected.push_back(&r);
    const std::size_t step =
        std::max<std::size_t>(1, (reflected.size() + s.most_readings - 1) / s.most_readings);
    const bool is_point = s.lamp_angle == 0 && s.detector_angle == 0 && s.viewed_m == 0;
    const std::size_t cones = is_point ? 1 : 32;
    double largest = 0;
    for (const GonioReading* r : reflected)
      for (const double f : r->f) largest = std::max(largest, f);
    for (std::size_t k = 0; k < reflected.size(); k += step) {
      const GonioReading& r = *reflected[k];
      double mean = 0, error2 = 0;
      const double n = double(r.f.size());
      // Errors of bands are taken for equal ones, which tracing shares among wavelengths.
      for (const double f : r.f) mean += f / n;
      for (const double e : r.error) error2 += e * e / n;
      Reading reading{
          &r, mean, std::sqrt(error2 + std::pow(s.floor * mean, 2) + std::pow(1e-5 * largest, 2)), {}};
      for (std::size_t c = 0; c < cones; ++c) {
        // Points of an additive recurrence in six dimensions (M. Roberts 2018, the R sequences).
        const auto at = [&](int axis) {
          const double y = 0.5 + double(c) * std::pow(kRecurrence6, -(axis + 1));
          return y - std::floor(y);
        };
        const Vec2 from = point_of_disc(0.5 * s.viewed_m / s.distance_m, at(4), at(5));
        reading.cones.in.push_back(towards_aperture(r.theta_i, r.phi_i, s.lamp_angle, kLampFarther, from,
                                                    is_point ? 0 : at(0), at(1)));
        reading.cones.out.push_back(
            towards_aperture(r.theta_o, r.phi_o, s.detector_angle, 1, from, is_point ? 0 : at(2), at(3)));
      }
      readings_.push_back(std::move(reading));
    }
    bands_ = table.nm;
  }

  std::size_t size() const { return readings_.size(); }

  BrdfFit fit(const BrdfModel& model) const {
    std::vector<optics::LeastSquaresParameter> parameters;
    std::vector<std::string> names;
    const auto add = [&](const char* name, double start, double low, double high) {
      names.push_back(name), parameters.push_back({start, low, high});
    };
    if (model.has_diffuse) add("kd", 0.3, 0, 2);
    if (model.has_scale) add("ks", 0.3, 0, 10);
    const std::size_t first = parameters.size();
    for (const auto& p : model.parameters) add(p.name, p.start, p.low, p.high);
    if (readings_.size() <= parameters.size())
      throw Error(fmt::format("{} readings of reflection are too few for the {} parameters of {}",
                              readings_.size(), parameters.size(), model.name));
    const auto values_of = [&](const std::vector<double>& x, std::vector<double>& values) {
      values.assign(readings_.size(), model.has_diffuse ? x[0] / kPiD : 0);
      if (!model.lobe) return;
      const double scale = model.has_scale ? x[1] : 1;
      const std::vector<double> lobe = lobe_values(model.lobe(x.data() + first));
      for (std::size_t k = 0; k < values.size(); ++k) values[k] += scale * lobe[k];
    };
    const auto residuals = [&](const std::vector<double>& x, std::vector<double>& r) {
      values_of(x, r);
      for (std::size_t k = 0; k < r.size(); ++k) r[k] = (r[k] - readings_[k].mean) / readings_[k].error;
    };
    // Roughness has local minima: the best of three starts.
    std::optional<optics::LeastSquaresResult> best;
    for (const double factor : {0.15, 1.0, 3.0}) {
      std::vector<optics::LeastSquaresParameter> from = parameters;
      bool changes = false;
      for (std::size_t i = 0; i < from.size(); ++i)
        if (names[i] == "alpha" || names[i] == "sigma" || names[i] == "roughness")
          from[i].start = std::clamp(from[i].start * factor, from[i].low, from[i].high), changes = true;
      if (!changes && factor != 1) continue;
      optics::LeastSquaresResult r = optics::least_squares(residuals, readings_.size(), from);
      if (!best || r.sum_of_squares < best->sum_of_squares) best = std::move(r);
    }
    BrdfFit fit;
    fit.model = model.name, fit.readings = readings_.size(), fit.chi_squared = best->sum_of_squares;
    const std::size_t n = parameters.size();
    // A model that does not fit has larger errors than its readings say.
    const double excess = std::max(1.0, fit.chi_squared / double(readings_.size() - n));
    for (std::size_t i = 0; i < n; ++i) {
      const double half = 1.96 * std::sqrt(std::max(best->covariance[i * n + i], 0.0) * excess);
      fit.parameters.push_back({names[i], best->values[i], best->values[i] - half, best->values[i] + half});
    }
    fit.aic = fit.chi_squared + 2 * double(n);
    std::vector<double> values;
    values_of(best->values, values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double off = std::abs(values[k] - readings_[k].mean);
      fit.rms += off * off / double(values.size()), fit.largest = std::max(fit.largest, off);
    }
    fit.rms = std::sqrt(fit.rms);
    fit.bsdf = bsdf_of(model, best->values, first);
    return fit;
  }

private:
  struct Reading {
    const GonioReading* from;
    double mean, error;
    ConePairs cones;
  };

  /// f of a lobe for all readings, averaged over their cones with the lamp's cosine, as the irradiance weighs them.
  std::vector<double> lobe_values(const std::string& element) const {
    if (settings_.stop && *settings_.stop) throw Error("interrupted: nothing is written");
    const SpectralGrid grid = SpectralGrid::over(540, 560);
    const LoadedObject loaded =
        load_object_from_string("<scene version=\"3.0.0\">" + element + "</scene>", "model", grid);
    const auto bsdf = std::dynamic_pointer_cast<const Bsdf>(loaded.object);
    const Wavelengths w = Wavelengths::at(grid, Spectrum(550.f));
    SurfacePoint point;
    point.uv = {0.5f, 0.5f};
    const BsdfContext ctx{w, point};
    std::vector<double> values;
    values.reserve(readings_.size());
    for (const Reading& r : readings_) {
      double sum = 0, weights = 0;
      for (std::size_t c = 0; c < r.cones.in.size(); ++c) {
        const Vec3 &in = r.cones.in[c], &out = r.cones.out[c];
        if (!(in.z > 0 && out.z > 0)) continue;
        // The BSDF's `wi` is the detector's direction; its value has the cosine of the lamp's.
        sum += double(bsdf->eval(out, in, ctx)[0]), weights += double(in.z);
      }
      values.push_back(weights > 0 ? sum / weights : 0);
    }
    return values;
  }

  /// The fitted material; reflectances that are factors of the model follow the bands. A plug-in holds no reflectance above 1.
  std::string bsdf_of(const BrdfModel& model, const std::vector<double>& x, std::size_t first) const {
    if (!model.material) return model.lobe(x.data() + first);
    std::vector<double> lobe(readings_.size());
    if (model.lobe) lobe = lobe_values(model.lobe(x.data() + first));
    std::vector<double> diffuse, specular;
    for (std::size_t b = 0; b < bands_.size(); ++b) {
      // Linear least squares of two terms, or of one.
      double dd = 0, ds = 0, ss = 0, df = 0, sf = 0;
      for (std::size_t k = 0; k < readings_.size(); ++k) {
        const double weight = 1 / std::pow(readings_[k].error, 2), d = 1 / kPiD, s = lobe[k],
                     f = readings_[k].from->f[b] - (model.has_scale ? 0 : s);
        dd += weight * d * d, ds += weight * d * s, ss += weight * s * s, df += weight * d * f,
            sf += weight * s * f;
      }
      double of_diffuse = df / dd, of_lobe = 1;
      if (model.has_scale) {
        const double determinant = dd * ss - ds * ds;
        if (determinant > 0)
          of_diffuse = (df * ss - sf * ds) / determinant, of_lobe = (sf * dd - df * ds) / determinant;
        if (of_diffuse < 0) of_diffuse = 0, of_lobe = ss > 0 ? sf / ss : 0;
        of_lobe = std::max(of_lobe, 0.0);
      }
      diffuse.push_back(of_diffuse), specular.push_back(of_lobe);
    }
    std::vector<double> parameters(x.begin() + std::ptrdiff_t(first), x.end());
    double weight = 0;
    if (model.is_blend) {
      // Between the least weight that the lobe needs and the largest that the diffuse term leaves.
      const double kd = *std::max_element(diffuse.begin(), diffuse.end()),
                   ks = *std::max_element(specular.begin(), specular.end());
      weight = kd + ks <= 1 ? ks + 0.5 * (1 - kd - ks) : ks / (kd + ks);
      parameters.push_back(weight);
    }
    std::string kd, ks;
    for (std::size_t b = 0; b < bands_.size(); ++b) {
      const auto add = [&](std::string& text, double v, double share) {
        text += fmt::format("{}{:.6g}:{:.5g}", text.empty() ? "" : ", ", bands_[b],
                            std::clamp(v / share, 0.0, 1.0));
      };
      add(kd, diffuse[b], model.is_blend ? std::max(1 - weight, 1e-9) : 1);
      add(ks, specular[b], model.is_blend ? std::max(weight, 1e-9) : 1);
    }
    if (bands_.size() < 2) kd = kd.substr(kd.find(':') + 1), ks = ks.substr(ks.find(':') + 1);
    return model.material(kd, ks, parameters.data());
  }

  FitSettings settings_;
  std::vector<Reading> readings_;
  std::vector<double> bands_;
};

}  // namespace

std::vector<std::string> brdf_models() {
  std::vector<std::string> names;
  for (const BrdfModel& m : models()) names.push_back(m.name);
  return names;
}

std::vector<BrdfFit> fit_brdfs(const GonioTable& table, const FitSettings& settings) {
  const std::vector<std::string> names = brdf_models();
  for (const std::string& name : settings.models)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(fmt::format("\"{}\" is no model{}; there are {}", name, did_you_mean(name, names),
                              fmt::join(names, ", ")));
  for (const double angle : {settings.lamp_angle, settings.detector_angle})
    if (!(angle >= 0 && angle <= 45))
      throw Error(
          fmt::format("a half-angle of {:g} degrees of lamp or detector: 0 to 45 is expected", angle));
  if (!(settings.viewed_m >= 0 && settings.viewed_m < settings.distance_m))
    throw Error(fmt::format("a viewed diameter of {:g} mm does not fit a distance of {:g} mm",
                            1e3 * settings.viewed_m, 1e3 * settings.distance_m));
  const Fitter fitter(table, settings);
  if (fitter.size() == 0) throw Error("there is no reading of reflection to which a model could be fitted");
  std::vector<BrdfFit> fits;
  for (const BrdfModel& m : models())
    if (settings.models.empty() ||
        std::find(settings.models.begin(), settings.models.end(), m.name) != settings.models.end())
      fits.push_back(fitter.fit(m));
  std::stable_sort(fits.begin(), fits.end(),
                   [](const BrdfFit& a, const BrdfFit& b) { return a.aic < b.aic; });
  return fits;
}

std::string fit_text(const std::vector<BrdfFit>& fits) {
  std::string text =
      "model                        AIC     chi^2/n     rms, 1/sr   parameters (confidence interval of 95 %)\n";
  for (const BrdfFit& f : fits) {
    text += fmt::format("{:<20} {:>11.1f} {:>11.3g} {:>13.4g}   ", f.model, f.aic,
                        f.chi_squared / double(f.readings), f.rms);
    std::vector<std::string> parts;
    for (const FittedParameter& p : f.parameters)
      parts.push_back(p.low == p.high
                          ? fmt::format("{} {:.4g} (at its bound)", p.name, p.value)
                          : fmt::format("{} {:.4g} ({:.4g} to {:.4g})", p.name, p.value, p.low, p.high));
    text += fmt::format("{}\n", fmt::join(parts, ", "));
  }
  return text;
}

}  // namespace aureole
