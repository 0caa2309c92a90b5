// SPDX-License-Identifier: Apache-2.0
// The check of a BSDF (aureole/_check.py makes a report of the results).
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <span>

#include "aureole/core/error.h"
#include "aureole/instrument/check/bsdf_check.h"
#include "aureole/plugin/properties.h"
#include "bindings.h"
#include "python_bsdf.h"

namespace aureole::python {

namespace {

/// A new array that owns its numbers: `shape` in C order, value i given by f(i).
template <class F>
nb::object array(std::initializer_list<std::size_t> shape, F&& f) {
  std::size_t n = 1;
  for (const std::size_t extent : shape) n *= extent;
  auto* const data = new double[n + 1];
  const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  for (std::size_t i = 0; i < n; ++i) data[i] = f(i);
  return nb::cast(nb::ndarray<nb::numpy, double>(data, shape, owner));
}
template <class Item>
nb::object vectors(const std::vector<Item>& items, Vec3 Item::*member) {
  return array({items.size(), 3}, [&](std::size_t i) { return (items[i / 3].*member)[int(i % 3)]; });
}

/// A BSDF written in Python, called for many directions at once (aureole/_check_python.py).
class BatchBsdf final : public Bsdf, public ArrayBsdf {
public:
  BatchBsdf(const Properties& properties, const nb::object& instance)
      : Bsdf(properties),
        batch_(nb::module_::import_("aureole._check_python").attr("Batch")(instance)),
        lobes_(Lobe(nb::cast<unsigned>(batch_.attr("lobes")))) {}

  Lobe lobes() const override { return lobes_; }
  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    BsdfEval found;
    eval_pdf_all({&wi, 1}, {&wo, 1}, ctx, {&found, 1});
    return found;
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> found;
    sample_all({&wi, 1}, {&u1, 1}, {&u2, 1}, ctx, {&found, 1});
    return found;
  }
  void eval_pdf_all(std::span<const Vec3> wi, std::span<const Vec3> wo, const BsdfContext& ctx,
                    std::span<BsdfEval> found) const override {
    if (wi.empty()) return;
    const Callback lock;
    const nb::object both =
        batch_.attr("eval_pdf")(directions(wi), directions(wo), wavelengths(ctx), mode(ctx));
    const Numbers value(both[0], wi.size(), kWavelengths), pdf(both[1], wi.size(), kWavelengths);
    for (std::size_t i = 0; i < wi.size(); ++i) found[i] = {value.spectrum(i), pdf.spectrum(i)};
  }
  void sample_all(std::span<const Vec3> wi, std::span<const float> u1, std::span<const Vec2> u2,
                  const BsdfContext& ctx, std::span<std::optional<BsdfSample>> found) const override {
    if (wi.empty()) return;
    const Callback lock;
    const nb::object u = array({wi.size(), 3}, [&](std::size_t k) {
      const std::size_t i = k / 3;
      return double(k % 3 == 0 ? u1[i] : k % 3 == 1 ? u2[i].x : u2[i].y);
    });
    const nb::object all = batch_.attr("sample")(directions(wi), u, wavelengths(ctx), mode(ctx));
    const Numbers wo(all[0], wi.size(), 3), value(all[1], wi.size(), kWavelengths),
        pdf(all[2], wi.size(), kWavelengths), about(all[3], wi.size(), 3);
    for (std::size_t i = 0; i < wi.size(); ++i) {
      found[i].reset();
      if (about.at(i, 0) == 0) continue;
      found[i] = BsdfSample{normalize(Vec3{float(wo.at(i, 0)), float(wo.at(i, 1)), float(wo.at(i, 2))}),
                            value.spectrum(i), pdf.spectrum(i), Lobe(unsigned(about.at(i, 1))),
                            float(about.at(i, 2))};
    }
  }

private:
  /// An array (rows, columns) that Python returned.
  struct Numbers {
    nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu> a;
    Numbers(nb::handle object, std::size_t rows, std::size_t columns)
        : a(nb::cast<nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>>(object)) {
      if (a.shape(0) != rows || a.shape(1) != columns) throw Error("a batch of the wrong shape");
    }
    double at(std::size_t row, std::size_t column) const { return a.data()[row * a.shape(1) + column]; }
    Spectrum spectrum(std::size_t row) const {
      return make_spectrum([&](int j) { return float(at(row, std::size_t(j))); });
    }
  };
  static nb::object directions(std::span<const Vec3> v) {
    return array({v.size(), 3}, [&](std::size_t k) { return double(v[k / 3][int(k % 3)]); });
  }
  static nb::object wavelengths(const BsdfContext& ctx) {
    return array({kWavelengths}, [&](std::size_t j) { return double(ctx.wavelengths.nm[int(j)]); });
  }
  static const char* mode(const BsdfContext& ctx) {
    return ctx.mode == TransportMode::radiance ? "radiance" : "importance";
  }

  nb::object batch_;
  Lobe lobes_;
};

nb::dict converted(const CheckResult& r) {
  nb::list findings, histograms;
  for (const CheckFinding& f : r.findings) {
    nb::dict d;
    d["kind"] = name_of(f.rule);
    d["direction"] = nb::make_tuple(f.wi.x, f.wi.y, f.wi.z);
    d["wavelength"] = f.nm;
    d["figure"] = f.figure;
    d["expected"] = f.expected;
    d["p_value"] = f.p_value;
    d["limit"] = f.limit;
    d["passed"] = f.passed;
    d["message"] = nb::str(f.message.c_str());
    findings.append(d);
  }
  for (const auto& h : r.histograms) {
    const auto& bins = h.bins;
    nb::dict d;
    d["direction"] = nb::make_tuple(h.wi.x, h.wi.y, h.wi.z);
    d["wavelength"] = h.nm;
    d["samples"] = h.samples;
    d["p_value"] = h.p_value;
    d["chi_square"] = h.chi_square;
    d["pools"] = h.pools;
    d["centers"] = vectors(bins, &CheckResult::Bin::center);
    d["sizes"] = array({bins.size()}, [&](std::size_t i) { return bins[i].size; });
    d["expected"] = array({bins.size()}, [&](std::size_t i) { return bins[i].expected; });
    d["found"] = array({bins.size()}, [&](std::size_t i) { return bins[i].found; });
    histograms.append(d);
  }
  nb::dict d;
  d["findings"] = findings;
  d["histograms"] = histograms;
  constexpr std::size_t n = kWavelengths;
  d["energy_directions"] = vectors(r.energies, &CheckResult::Energy::wi);
  d["energy_wavelengths"] =
      array({r.energies.size(), n}, [&](std::size_t i) { return r.energies[i / n].nm[i % n]; });
  d["energies"] =
      array({r.energies.size(), n}, [&](std::size_t i) { return r.energies[i / n].energy[i % n]; });
  d["pair_wi"] = vectors(r.pairs, &CheckResult::Pair::wi);
  d["pair_wo"] = vectors(r.pairs, &CheckResult::Pair::wo);
  d["pair_forward"] = array({r.pairs.size()}, [&](std::size_t i) { return r.pairs[i].forward; });
  d["pair_backward"] = array({r.pairs.size()}, [&](std::size_t i) { return r.pairs[i].backward; });
  d["pair_wavelength"] = r.pairs.empty() ? 0 : r.pairs.front().nm;
  d["level"] = r.level;
  d["statistical_tests"] = r.statistical_tests;
  d["largest_failure"] = r.largest_failure;
  d["black_below"] = r.black_below;
  return d;
}

}  // namespace

void bind_check(nb::module_& m) {
  m.def(
      "check_bsdf",
      [](const nb::object& bsdf, bool lossless, bool reciprocal, std::optional<bool> black_below,
         bool may_fail, bool radiance, std::size_t samples, double significance, double tolerance,
         double largest_energy, double min_nm, double max_nm, std::optional<double> index_ratio,
         const std::vector<double>& angles, std::size_t most_bins, std::uint64_t seed, nb::object progress) {
        CheckOptions options;
        options.lossless = lossless;
        options.reciprocal = reciprocal;
        options.black_below = black_below.value_or(false);
        options.may_be_black_below = !black_below;
        options.may_fail = may_fail;
        options.mode = radiance ? TransportMode::radiance : TransportMode::importance;
        options.samples = samples;
        options.bin_tolerance = CheckOptions::bin_tolerance_for(samples);
        options.significance = significance;
        options.tolerance = tolerance;
        options.largest_energy = largest_energy;
        options.min_nm = min_nm, options.max_nm = max_nm;
        options.indices_from_samples = !index_ratio;
        if (index_ratio) options.n_below = [n = float(*index_ratio)](float) { return n; };
        options.energy_angles = angles;
        options.most_bins = most_bins;
        options.seed = seed;
        // Lobes around the specular directions may be too narrow for the samples to show their width.
        options.focus = [](const Vec3& wi) { return std::vector<Vec3>{reflect(wi), -wi}; };

        using Clock = std::chrono::steady_clock;
        Clock::time_point next = Clock::now();
        options.progress = [&](double part) {
          if (part < 1 && Clock::now() < next) return;
          if (is_leaving()) throw Error("the program ends");  // seen by nobody: the thread stays in ~Unlocked
          const nb::gil_scoped_acquire acquire;
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
          if (!progress.is_none()) progress(part);
          next = Clock::now() + std::chrono::milliseconds(50);
        };
        std::shared_ptr<const Bsdf> checked;
        const auto batch = [&](const nb::object& instance) {
          auto context = std::make_shared<BuildContext>();
          if (max_nm > min_nm) context->grid = SpectralGrid::over(min_nm, max_nm);
          return std::make_shared<const BatchBsdf>(Properties("python", "", {}, context), instance);
        };
        if (!nb::isinstance<Bsdf>(bsdf)) {
          checked = batch(bsdf);
        } else {
          checked = nb::cast<std::shared_ptr<Bsdf>>(bsdf);
          if (const auto* p = dynamic_cast<const PythonBsdf*>(checked.get()))
            checked = batch(p->instance().attr("target"));
        }
        CheckResult result;
        {
          const Unlocked release;
          result = check_bsdf(*checked, options);
        }
        return converted(result);
      },
      nb::arg("bsdf"), nb::kw_only(), nb::arg("lossless"), nb::arg("reciprocal"),
      nb::arg("black_below").none(), nb::arg("may_fail"), nb::arg("radiance"), nb::arg("samples"),
      nb::arg("significance"), nb::arg("tolerance"), nb::arg("largest_energy"), nb::arg("min_nm"),
      nb::arg("max_nm"), nb::arg("index_ratio").none(), nb::arg("angles"), nb::arg("most_bins"),
      nb::arg("seed"), nb::arg("progress").none(),
      nb::sig("def check_bsdf(bsdf: object, *, lossless: bool, reciprocal: bool, black_below: bool | None, "
              "may_fail: bool, radiance: bool, samples: int, significance: float, tolerance: float, "
              "largest_energy: float, min_nm: float, max_nm: float, index_ratio: float | None, "
              "angles: list[float], most_bins: int, seed: int, progress: object) -> dict[str, typing.Any]"),
      "What is wrong with a BSDF, and the numbers behind it. See `aureole.check`.");
}

}  // namespace aureole::python
