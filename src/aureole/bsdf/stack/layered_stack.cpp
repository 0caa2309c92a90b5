// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/stack/layered_stack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "aureole/core/parallel.h"
#include "aureole/core/units.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLargestMegabytes = StackTable::kLargestMegabytes;

/// Returns the items of a list such as "20um, 5um", or of a single number.
std::vector<std::string> list_of(const Properties& p, const char* name, const std::string& fallback) {
  std::string text = fallback;
  if (const Properties::Entry* e = p.find(name)) {
    if (const auto* number = std::get_if<double>(&e->value)) return {fmt::format("{}", *number)};
    if (const auto* whole = std::get_if<std::int64_t>(&e->value)) return {std::to_string(*whole)};
    text = p.get_string(name);
  }
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else if (c != ' ' || !parts.back().empty())
      parts.back() += c;
  }
  for (std::string& part : parts)
    while (!part.empty() && part.back() == ' ') part.pop_back();
  return parts;
}

/// Returns the index of refraction at 589 nm.
double index_of(const Properties& p, const char* name, const std::string& text) {
  double n = 0;
  const auto material = find_refractive_index(text, false);
  if (material && material->is_dispersive())
    throw p.error(name, "\"" + text + "\" absorbs too strongly to be a layer of its own");
  if (material) {
    n = material->at(589.3).real();
  } else {
    try {
      n = parse_number(text);
    } catch (const Error&) {
      throw p.error(
          name, "unknown material \"" + text + "\"" + did_you_mean_or_all(text, refractive_index_names()));
    }
  }
  if (!(n >= 1 && n <= 10))
    throw p.error(name, "indices of refraction must be in [1, 10], got " + std::to_string(n));
  return n;
}

/// Returns the material of a name whose index depends on the wavelength; otherwise empty.
std::optional<RefractiveIndex> dispersive_material(const Properties& p, const char* name,
                                                   const std::string& text) {
  const auto material = find_refractive_index(text);
  if (!material || !material->is_dispersive()) return {};
  check_index_range(p, name, text, *material);
  return material;
}

/// Returns the fraction of light that a BSDF reflects specularly.
double mirrored(const Bsdf& bsdf, const Vec3& wi, const BsdfContext& context) {
  // The specular lobe is one of several, each sampled for a range of u1. It is searched at both ends and at
  // equal steps between them.
  constexpr int kPlaces = 64;
  for (int i = -1; i <= kPlaces; ++i) {
    const float u1 = std::clamp((float(i) + 0.5f) / kPlaces, 0.f, 0x1.fffffep-1f);
    if (const auto s = bsdf.sample(wi, u1, {0.5f, 0.5f}, context); s && s->is_delta())
      return std::min(double(s->value[0]), 1.0);
  }
  return 0;
}

bool alike(const optics::StackDescription& a, const optics::StackDescription& b) {
  const auto same = [](double x, double y) {
    return std::abs(x - y) <= 1e-6 * std::max(std::abs(x), std::abs(y));
  };
  if (!same(a.substrate.value_or(0), b.substrate.value_or(0)) || bool(a.brdf) != bool(b.brdf)) return false;
  for (const double mu : {0.05, 0.3, 0.6, 0.9, 1.0}) {
    if (a.mirror && !same(a.mirror(mu), b.mirror(mu))) return false;
    if (a.brdf &&
        !(same(a.brdf(mu, mu, 0), b.brdf(mu, mu, 0)) && same(a.brdf(mu, 0.5, 1), b.brdf(mu, 0.5, 1))))
      return false;
  }
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    const optics::StackLayer &x = a.layers[i], &y = b.layers[i];
    if (x.index != y.index) return false;
    if (!same(x.absorption, y.absorption) || !same(x.scattering, y.scattering)) return false;
    for (const double mu : {-1.0, -0.7, -0.2, 0.3, 0.6, 0.9, 0.98, 1.0})
      if (!same(x.phase.eval(mu), y.phase.eval(mu))) return false;
  }
  return true;
}

/// Whether a BSDF or one nested in it reads a texture that varies over the surface.
bool varies(const Bsdf& bsdf) {
  for (const Properties::Entry& e : bsdf.properties().entries()) {
    const auto* object = std::get_if<ObjectPtr>(&e.value);
    if (!object) continue;
    const auto* texture = dynamic_cast<const Texture*>(object->get());
    const auto* nested = dynamic_cast<const Bsdf*>(object->get());
    if ((texture && !texture->is_constant()) || (nested && varies(*nested))) return true;
  }
  return false;
}

}  // namespace

LayeredStack::LayeredStack(const Properties& p) : p_(p) {
  read_layers();
  read_interfaces();
  read_substrate();
}

void LayeredStack::read_layers() {
  const auto media = p_.get_children<Medium>("medium");
  if (media.empty()) throw Error(p_.where(), "\"layered\" needs a nested medium for each of its layers");
  if (!p_.has("thickness"))
    throw p_.error(
        "thickness",
        "the parameter \"thickness\" is required, a length for each medium, such as \"20um, 5um\"");
  const std::vector<std::string> thickness = list_of(p_, "thickness", ""),
                                 index = list_of(p_, "int_ior", "1.5");
  const auto fits = [&](const char* name, std::size_t count) {
    if (count != media.size() && !(count == 1 && name != std::string_view("thickness")))
      throw p_.error(name, "needs a value for each of the " + std::to_string(media.size()) +
                               " media, from the top; got " + std::to_string(count));
  };
  fits("thickness", thickness.size()), fits("int_ior", index.size());
  const bool disperse = p_.get_bool("dispersion", true);
  for (std::size_t i = 0; i < media.size(); ++i) {
    const std::string& name = index[index.size() == 1 ? 0 : i];
    Layer layer{media[i], kInfinite, index_of(p_, "int_ior", name), {}};
    if (disperse) layer.material = dispersive_material(p_, "int_ior", name);
    if (thickness[i] != "infinite") {
      try {
        layer.thickness_m = parse_length_m(thickness[i]);
      } catch (const Error& e) {
        throw p_.error("thickness", e.message());
      }
      if (!(layer.thickness_m > 0)) throw p_.error("thickness", "must be above 0, or \"infinite\"");
    }
    const SourceLocation& where = media[i]->properties().where();
    if (!media[i]->is_uniform() || !media[i]->phase().is_uniform())
      throw Error(where, "the media of \"layered\" must be the same everywhere");
    if (media[i]->emits()) throw Error(where, "the media of \"layered\" do not emit light");
    if (!media[i]->phase().is_isotropic_medium())
      throw Error(where, "the media of \"layered\" must scatter alike for all directions of the light");
    layers_.push_back(std::move(layer));
  }
}

void LayeredStack::read_interfaces() {
  index_above_ = index_of(p_, "ext_ior", list_of(p_, "ext_ior", "air").front());
  index_below_ =
      p_.has("below_ior") ? index_of(p_, "below_ior", list_of(p_, "below_ior", "").front()) : index_above_;
  const std::vector<std::string> alpha = list_of(p_, "alpha", "0");
  alpha_.assign(layers_.size() + 1, 0);
  if (alpha.size() > alpha_.size())
    throw p_.error("alpha", "there are " + std::to_string(alpha_.size()) + " interfaces, got " +
                                std::to_string(alpha.size()) + " values");
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    try {
      alpha_[i] = parse_number(alpha[i]);
    } catch (const Error& e) {
      throw p_.error("alpha", e.message());
    }
    if (!(alpha_[i] == 0 || (alpha_[i] >= 0.05 && alpha_[i] <= 1)))
      throw p_.error("alpha", "must be 0 (smooth) or in [0.05, 1], got " + alpha[i]);
    const double before = i == 0 ? index_above_ : layers_[i - 1].index,
                 after = i < layers_.size() ? layers_[i].index : index_below_;
    if (alpha_[i] > 0 && before == after)
      p_.note("alpha", "interface " + std::to_string(i) + " has the same index on both sides: no effect");
    if (before == after) alpha_[i] = 0;
  }
  distribution_ = p_.get_choice("distribution", "beckmann", {"beckmann", "ggx"}) == "ggx"
                      ? optics::InterfaceKind::ggx
                      : optics::InterfaceKind::beckmann;
}

void LayeredStack::read_substrate() {
  const auto nested = p_.get_children<Bsdf>("bsdf");
  if (nested.size() > 1)
    throw Error(nested[1]->properties().where(),
                "\"layered\" lies on one nested BSDF, got " + std::to_string(nested.size()));
  if (nested.empty()) return;
  substrate_ = nested.front();
  const SourceLocation& where = substrate_->properties().where();
  if (has(substrate_->lobes(), Lobe::transmit | Lobe::null))
    throw Error(
        where,
        "what \"layered\" lies on must not let light through; leave it out where the stack is open below");
  if (substrate_->needs_tangent())
    throw Error(where, "what \"layered\" lies on must not change when it is turned about its normal");
  if (p_.has("below_ior"))
    throw p_.error("below_ior", "there is no medium below a stack that lies on a BSDF");
  if (alpha_.back() > 0)
    throw p_.error("alpha", "the substrate is no interface: there are " + std::to_string(layers_.size()));
  // A constant substrate is part of the table, since evaluating it would take 40 ns each time.
  if (!substrate_->is_constant() && is_lambertian(*substrate_))
    lambertian_ = substrate_;
  else if (varies(*substrate_))
    p_.note("", "what \"layered\" lies on is taken at one point, since only a diffuse BSDF may vary there");
}

/// Whether a BSDF is diffuse only, with equal values for three pairs of directions.
bool LayeredStack::is_lambertian(const Bsdf& bsdf) const {
  if (bsdf.lobes() != (Lobe::diffuse | Lobe::reflect)) return false;
  const SpectralGrid& grid = p_.context().grid;
  const Wavelengths w = Wavelengths::at(grid, Spectrum(float(0.5 * (grid.min_nm + grid.max_nm))));
  SurfacePoint point;
  point.shading.n = point.ng = {0, 0, 1};
  const Spectrum index = float(layers_.back().index);
  const BsdfContext context{w, point, TransportMode::radiance, 0, &index};
  const float along_normal = bsdf.eval({0, 0, 1}, {0, 0, 1}, context)[0];
  for (const auto& [in, out, phi] : {std::array{0.3f, 0.3f, 0.1f}, {0.7f, 0.2f, 3.f}, {0.99f, 0.5f, 1.6f}}) {
    const float sine = std::sqrt(1 - out * out);
    const float value = bsdf.eval({std::sqrt(1 - in * in), 0, in},
                                  {sine * std::cos(phi), sine * std::sin(phi), out}, context)[0] /
                        out;
    if (std::abs(value - along_normal) > 1e-5f * along_normal) return false;
  }
  return true;
}

bool LayeredStack::has_delta() const { return alpha_.front() == 0 || (is_open() && alpha_.back() == 0); }

std::vector<optics::LegendrePhase> LayeredStack::phases(const Layer& layer,
                                                        const std::vector<double>& nm) const {
  const PhaseFunction& phase = layer.medium->phase();
  const SpectralGrid& grid = p_.context().grid;
  std::vector<Wavelengths> groups;
  for (std::size_t i = 0; i < nm.size(); i += kWavelengths)
    groups.push_back(Wavelengths::at(
        grid, make_spectrum([&](int j) { return float(nm[std::min(i + std::size_t(j), nm.size() - 1)]); })));
  const auto values = [&](double mu, std::size_t i, std::vector<std::vector<double>>& all) {
    const Vec3 wi{0, 0, -1}, wo{float(std::sqrt(std::max(0.0, (1 - mu) * (1 + mu)))), 0, float(mu)};
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const Spectrum v = phase.eval_pdf(wi, wo, {groups[g], Vec3{0, 0, 0}}).value;
      for (int j = 0; j < kWavelengths && g * kWavelengths + std::size_t(j) < nm.size(); ++j)
        all[g * kWavelengths + std::size_t(j)][i] = double(v[j]);
    }
  };
  const auto tables = optics::tabulate_phases(
      [&](std::span<const double> mu, std::vector<std::vector<double>>& at,
          std::vector<std::vector<double>>& mirrored) {
        for (std::size_t i = 0; i < mu.size(); ++i) values(mu[i], i, at), values(-mu[i], i, mirrored);
      },
      nm.size(), 0.005, 0.05, {1e-3, 1e-3, 20000});
  std::vector<optics::LegendrePhase> result;
  for (const optics::PhaseTable& t : tables.tables) result.push_back(optics::LegendrePhase::table(t));
  return result;
}

void LayeredStack::add_substrate(optics::StackDescription& d, double nm, double index) const {
  if (!substrate_) return;
  d.substrate = 0;
  if (lambertian_) return;
  struct Place {
    Wavelengths w;
    SurfacePoint point;
    Spectrum index;
    BsdfContext context() const { return {w, point, TransportMode::radiance, 0, &index}; }
  };
  const auto place = std::make_shared<Place>();
  place->w = Wavelengths::at(p_.context().grid, Spectrum(float(nm)));
  place->index = float(index);
  place->point.shading.n = place->point.ng = {0, 0, 1};
  const BsdfPtr bsdf = substrate_;
  const auto direction = [](double cosine, double phi) {
    const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
    return Vec3{float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(cosine)};
  };
  if (has(bsdf->lobes(), Lobe::delta))
    d.mirror = [=](double cosine) { return mirrored(*bsdf, direction(cosine, 0), place->context()); };
  if (!bsdf->is_smooth()) return;
  const auto brdf = [=](double in, double out, double phi) {
    // Azimuth 0 continues in the half-plane opposite to the incident direction.
    const double f = double(bsdf->eval(direction(in, M_PI), direction(out, phi), place->context())[0]) / out;
    return std::isfinite(f) ? std::max(f, 0.0) : 0;
  };
  const double lambertian = brdf(0.9, 0.8, 1.0);
  for (const auto& [in, out, phi] : {std::array{0.3, 0.3, 0.0}, {0.7, 0.2, 3.0}, {0.99, 0.5, 0.2}})
    if (std::abs(brdf(in, out, phi) - lambertian) > 1e-5 * lambertian) {
      d.brdf = brdf;
      return;
    }
  d.substrate = std::min(M_PI * lambertian, 1.0);
}

std::vector<optics::StackDescription> LayeredStack::descriptions(const std::vector<double>& nm,
                                                                 bool disperse) const {
  const SpectralGrid& grid = p_.context().grid;
  const double unit_m = p_.context().length_unit_m;
  optics::StackDescription d;
  d.index_above = index_above_, d.index_below = index_below_;
  const auto interface = [&](std::size_t i) {
    return alpha_[i] > 0 ? optics::StackInterface{distribution_, alpha_[i]} : optics::StackInterface{};
  };
  d.bottom = interface(layers_.size());
  std::vector<optics::StackDescription> stacks(nm.size(), d);
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    const std::vector<optics::LegendrePhase> phase = phases(layer, nm);
    for (std::size_t i = 0; i < nm.size(); ++i) {
      MediumCoefficients c;
      layer.medium->eval({0, 0, 0}, {0, 0, 1}, Wavelengths::at(grid, Spectrum(float(nm[i]))), c);
      const double extinction = double(c.sigma_t[0]) / unit_m,
                   scattering = std::min(double(c.sigma_s[0]) / unit_m, extinction);
      stacks[i].layers.push_back({extinction - scattering, scattering, layer.thickness_m, phase[i],
                                  disperse ? layer.index_at(nm[i]) : layer.index, interface(l)});
    }
  }
  for (std::size_t i = 0; i < nm.size(); ++i) add_substrate(stacks[i], nm[i], stacks[i].layers.back().index);
  return stacks;
}

double LayeredStack::narrowest_lobe(const std::vector<optics::StackDescription>& stacks) const {
  double width = 1;
  for (const double a : alpha_)
    if (a > 0) width = std::min(width, a);
  for (const optics::StackDescription& d : stacks) {
    for (const optics::StackLayer& l : d.layers)
      if (l.scattering > 0) width = std::min(width, std::max(0.05, 1 - std::abs(l.phase.asymmetry())));
    // Half width of the peak of a glossy substrate, measured at 30 degrees.
    if (d.brdf) {
      const double peak = d.brdf(0.866, 0.866, 0);
      double angle = 0.02;
      while (angle < 1 && d.brdf(0.866, std::cos(M_PI / 6 + angle), 0) > 0.5 * peak) angle *= 1.2;
      width = std::min(width, std::max(angle, 0.05));
    }
  }
  return width;
}

std::shared_ptr<const StackTable> LayeredStack::tabulate() const {
  const SpectralGrid& grid = p_.context().grid;
  const auto count = int(p_.get_int("wavelengths", 24, {2, 256}));
  std::vector<double> nm(std::size_t(count), grid.min_nm);
  for (int i = 0; i < count; ++i) nm[std::size_t(i)] += (grid.max_nm - grid.min_nm) * i / (count - 1);
  try {
    std::vector<optics::StackDescription> stacks = descriptions(nm, true);
    if (!std::all_of(stacks.begin(), stacks.end(),
                     [&](const auto& d) { return optics::have_same_directions(stacks.front(), d); })) {
      p_.note(
          "int_ior",
          "indices count at 589 nm: they change with the wavelength only where those of all layers stay above "
          "those outside and differ from one another");
      stacks = descriptions(nm, false);
    }
    if (std::all_of(stacks.begin(), stacks.end(), [&](const auto& d) { return alike(stacks.front(), d); }))
      stacks.resize(1);
    const double width = narrowest_lobe(stacks);
    const auto fine = [&](int wide, int most, double power) {
      return std::clamp(int(std::lround(wide * std::pow(width, -power))), wide, most);
    };
    constexpr int kMinDirections = 24;  // number of directions, if the scene gives none
    auto directions = int(p_.get_int("directions", fine(kMinDirections, 64, 0.45), {8, 128}));
    const auto azimuths = int(p_.get_int("azimuths", fine(16, 40, 0.5), {4, 128}));
    const auto streams_for = [&](int wanted) {
      return std::min(optics::streams_for_directions(stacks.front(), wanted), 512);
    };
    const auto megabytes_for = [&](int wanted) {
      return StackTable::megabytes(
          double(optics::kernel_pairs(stacks.front(), streams_for(wanted))) * (azimuths + 1), stacks.size());
    };
    if (!p_.has("directions"))
      while (directions > kMinDirections && megabytes_for(directions) > kLargestMegabytes) --directions;
    const int streams = streams_for(directions);
    const double megabytes = megabytes_for(directions);
    if (megabytes > kLargestMegabytes)
      throw p_.error("directions",
                     fmt::format("the tables would take {:.0f} MB while they are made; {:.0f} are "
                                 "possible: fewer directions, azimuths or wavelengths",
                                 megabytes, kLargestMegabytes));
    std::vector<double> phi;
    // Azimuths are dense about 0, where lobes are; near the horizon lobes are even narrower.
    for (int i = 0; i <= azimuths; ++i)
      phi.push_back(M_PI * std::pow(double(i) / azimuths, width < 0.5 ? 3 : 2));
    const int modes = std::min(streams, 16 + int(12 / width));
    auto kernels = optics::stack_kernels(stacks, {.streams = streams, .modes = modes}, phi, for_ranges);
    std::vector<double> inner;
    for (const optics::StackDescription& d : stacks) inner.push_back(d.layers.back().index);
    return std::make_shared<const StackTable>(
        std::move(kernels), phi, grid, index_above(), index_below(),
        lambertian_ ? std::span<const double>(inner) : std::span<const double>());
  } catch (const std::domain_error& e) {
    throw Error(p_.where(), std::string("the stack: ") + e.what());
  }
}

}  // namespace aureole
