// SPDX-License-Identifier: Apache-2.0
// Instruments that the command line has, too. The public interface is in aureole/_instruments.py, _coronas.py and _comparison.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/instrument/corona/droplet_measurement.h"
#include "aureole/instrument/corona/ring_report.h"
#include "aureole/instrument/find_object.h"
#include "aureole/instrument/info/file_info.h"
#include "aureole/instrument/layer_figures.h"
#include "aureole/instrument/medium_figures.h"
#include "aureole/instrument/picture/picture_comparison.h"
#include "aureole/instrument/wavelength_steps.h"
#include "bindings.h"
#include "command.h"
#include "current_tables.h"
#include "loading_signals.h"
#include "object_arrays.h"
#include "picture.h"
#include "text.h"

namespace aureole::python {

namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

/// The objects of a scene file with the notes on wanted ones, loaded without Python's lock.
LoadedObjects objects_of(const std::string& file, const Defines& defines, const IsWanted& is_wanted) {
  const LoadingSignals signals;
  LoadOptions options;
  options.defines = defines;
  options.tables = current_tables();
  options.progress = signals.progress();
  return signals.run([&] { return load_wanted_objects(file, options, is_wanted); });
}

nb::list notes_of(const std::vector<std::string>& notes) {
  nb::list list;
  for (const std::string& note : notes) list.append(decoded(note));
  return list;
}

nb::dict layer_dict(const LayerFigures& figures, const std::vector<std::string>& notes) {
  nb::dict d;
  std::vector<double> nm;
  for (const LightBudget& row : figures.rows) nm.push_back(row.nm);
  d["nm"] = nm;
  for (const LayerQuantity& q : kLayerQuantities) {
    std::vector<double> values;
    for (const LightBudget& row : figures.rows) values.push_back(q.of(row));
    d[q.key] = values;
  }
  nb::dict cie;
  for (std::size_t k = 0; k < figures.xyz.size(); ++k) cie[kLayerQuantities[k].key] = figures.xyz[k];
  d["xyz"] = cie;
  d["haze"] = figures.haze();
  d["notes"] = notes_of(notes);
  return d;
}

nb::dict measured_layer(const Bsdf& bsdf, const SpectralGrid& grid, const LayerSettings& settings,
                        const std::vector<std::string>& notes) {
  LayerFigures figures;
  {
    const Unlocked release;
    figures = measure_layer(bsdf, grid, settings);
  }
  return layer_dict(figures, notes);
}

LayerSettings layer_settings(double angle, double azimuth, double step, const std::string& illuminant,
                             double haze_angle, int samples, const std::array<double, 2>& at) {
  if (samples < 1) throw Error("samples: expected at least 1");
  LayerSettings s{angle, azimuth, step, illuminant, {}};
  s.budget = {haze_angle, samples, {float(at[0]), float(at[1])}};
  return s;
}

nb::dict medium_dict(const Medium& medium, double step, double length, const std::array<double, 3>& at,
                     const std::array<double, 3>& along, const std::vector<std::string>& notes) {
  const Vec3 p = point_of(at), d{float(along[0]), float(along[1]), float(along[2])};
  const float square = length_squared(d);
  if (!(square > 0 && std::isfinite(square))) throw Error("along: the direction has no length");
  std::vector<double> nm, absorption, scattering, asymmetry, transmittance, absorbance, optical_density,
      phase_nm, angles;
  std::vector<std::vector<double>> phase;
  std::array<double, 3> passed{}, kept{};
  {
    const Unlocked release;
    const Vec3 unit = normalize(d);
    const SpectralGrid& grid = medium.properties().context().grid;
    for (const MediumFigures& f : measure_medium(medium, wavelength_steps(grid, step, 25), p, unit)) {
      nm.push_back(f.nm), absorption.push_back(f.absorption), scattering.push_back(f.scattering);
      asymmetry.push_back(f.asymmetry), transmittance.push_back(f.transmittance(length));
      absorbance.push_back(f.absorbance(length)), optical_density.push_back(f.optical_density(length));
    }
    passed = colour_behind(medium, length, false, p, unit),
    kept = colour_behind(medium, length, true, p, unit);
    for (int i = 0; i <= 360; ++i) angles.push_back(0.5 * i * M_PI / 180);
    for (const double part : {0.25, 0.5, 0.75}) {
      phase_nm.push_back(std::lerp(grid.min_nm, grid.max_nm, part));
      phase.push_back(phase_over_angle(medium, phase_nm.back(), angles, p, unit));
    }
  }
  nb::dict d_out;
  d_out["nm"] = nm, d_out["absorption"] = absorption, d_out["scattering"] = scattering;
  d_out["asymmetry"] = asymmetry, d_out["transmittance"] = transmittance;
  d_out["absorbance"] = absorbance, d_out["optical_density"] = optical_density;
  d_out["xyz_unscattered"] = passed, d_out["xyz_not_absorbed"] = kept;
  d_out["angles"] = angles, d_out["phase_nm"] = phase_nm, d_out["phase"] = phase;
  d_out["notes"] = notes_of(notes);
  return d_out;
}

nb::dict comparison_dict(const LayerComparison& layer) {
  const Comparison& c = layer.comparison;
  nb::dict d;
  d["layer"] = decoded(layer.layer);
  nb::list channels;
  for (const std::string& name : c.channels) channels.append(decoded(name));
  d["channels"] = channels;
  d["mean_a"] = c.mean_a, d["mean_b"] = c.mean_b, d["rmse"] = c.rmse, d["relative_mse"] = c.relative_mse;
  d["max_difference"] = c.max, d["max_at"] = std::pair(c.max_x, c.max_y), d["not_finite"] = c.not_finite;
  d["z_mean_square"] = c.z ? nb::cast(c.z->mean_square) : nb::none();
  d["z_outside"] = c.z ? nb::cast(c.z->outside) : nb::none();
  d["z_mean_difference"] = c.z ? nb::cast(c.z->mean_difference) : nb::none();
  d["verdict"] = verdict_text(layer.verdict, c);
  d["is_same"] = is_same(layer.verdict);
  return d;
}

/// Number of replicates of the variances of a picture that was rendered here or read.
int replicates_of_picture(const Picture& picture, int of_file) {
  return picture.state ? picture.state->identity.replicates : of_file;
}

std::vector<std::vector<double>> rows_of(const std::vector<std::array<double, 3>>& values) {
  std::vector<std::vector<double>> rows;
  for (const auto& v : values) rows.push_back({v[0], v[1], v[2]});
  return rows;
}

/// Means of R, G, B of a profile over the angle; NaN where nothing was measured.
std::vector<std::vector<double>> means_of(const CoronaProfile& profile) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < profile.sum.size(); ++i) {
    std::vector<double> row;
    for (std::size_t c = 0; c < 3; ++c)
      row.push_back(profile.weight[i] > 0 ? profile.sum[i][c] / profile.weight[i] : NAN);
    rows.push_back(std::move(row));
  }
  return rows;
}

nb::dict rings_dict(const RingReport& r) {
  nb::dict d;
  d["at"] = r.at;
  std::vector<double> angles;
  for (int i = 0; i < CoronaProfile::kBins; ++i) angles.push_back((i + 0.5) * CoronaProfile::kStep);
  d["angles"] = angles;
  d["measured"] = means_of(r.measured), d["predicted"] = means_of(r.predicted);
  const auto pairs = [](const std::array<RingAngles, 3>& rings) {
    std::vector<std::pair<double, double>> all;
    for (const RingAngles& a : rings)
      all.emplace_back(a.first_maximum > 0 ? a.first_maximum : NAN,
                       a.next_minimum > 0 ? a.next_minimum : NAN);
    return all;
  };
  d["measured_rings"] = pairs(r.measured_rings), d["predicted_rings"] = pairs(r.predicted_rings);
  d["is_complete"] = r.is_complete();
  return d;
}

nb::dict droplets_dict(const DropletMeasurement& m) {
  const CoronaFit& f = m.fit;
  nb::dict d;
  d["radius"] = std::pair(f.radius, f.radius_error);
  d["area_fraction"] = std::pair(f.area_fraction, f.area_fraction_error);
  d["fraction_is_given"] = f.fraction_fixed;
  d["spread"] = std::pair(f.spread, f.spread_error);
  d["second_radius"] = std::pair(f.second_radius, f.second_radius_error);
  d["second_share"] = std::pair(f.second_share, f.second_share_error);
  d["correlation"] = f.correlation, d["residual"] = f.residual, d["center"] = m.center;
  std::vector<double> angles;
  for (std::size_t i = 0; i < m.profile.s.size(); ++i) angles.push_back(m.ring_deg(i));
  d["angles"] = angles, d["measured"] = rows_of(m.profile.mean), d["error"] = rows_of(m.profile.sd);
  d["fitted"] = rows_of(f.model);
  d["notes"] = notes_of(m.notes);
  return d;
}

}  // namespace

void bind_instruments(nb::module_& m) {
  m.def(
      "command_names",
      [] {
        std::vector<std::string> names;
        for (const Command& command : commands()) names.push_back(command.name);
        return names;
      },
      "Names of the commands of the program; those of a group have two words.");
  m.def(
      "layer_of_file",
      [](const std::string& target, const Defines& defines, double angle, double azimuth, double step,
         const std::string& illuminant, double haze_angle, int samples, const std::array<double, 2>& at) {
        const auto [file, id] = file_and_id(target);
        const LayerSettings settings =
            layer_settings(angle, azimuth, step, illuminant, haze_angle, samples, at);
        LoadedObjects loaded;
        std::shared_ptr<const Bsdf> bsdf;
        {
          const Unlocked release;
          loaded = objects_of(file, defines, has_id(id));
          bsdf = find_bsdf(loaded, file, id);
        }
        return measured_layer(*bsdf, loaded.context->grid, settings, loaded.notes);
      },
      nb::arg("target"), nb::arg("defines"), nb::arg("angle"), nb::arg("azimuth"), nb::arg("step"),
      nb::arg("illuminant"), nb::arg("haze_angle"), nb::arg("samples"), nb::arg("at"));
  m.def(
      "layer",
      [](const std::shared_ptr<Bsdf>& bsdf, double angle, double azimuth, double step,
         const std::string& illuminant, double haze_angle, int samples, const std::array<double, 2>& at) {
        require_standalone(*bsdf);
        return measured_layer(*bsdf, bsdf->properties().context().grid,
                              layer_settings(angle, azimuth, step, illuminant, haze_angle, samples, at), {});
      },
      nb::arg("bsdf"), nb::arg("angle"), nb::arg("azimuth"), nb::arg("step"), nb::arg("illuminant"),
      nb::arg("haze_angle"), nb::arg("samples"), nb::arg("at"));
  m.def(
      "medium_of_file",
      [](const std::string& target, const Defines& defines, double step, double length,
         const std::array<double, 3>& at, const std::array<double, 3>& along) {
        const auto [file, id] = file_and_id(target);
        LoadedObjects loaded;
        std::shared_ptr<const Medium> medium;
        {
          const Unlocked release;
          loaded = objects_of(file, defines, is_medium_called(id));
          medium = find_medium(loaded, file, id);
        }
        return medium_dict(*medium, step, length, at, along, loaded.notes);
      },
      nb::arg("target"), nb::arg("defines"), nb::arg("step"), nb::arg("length"), nb::arg("at"),
      nb::arg("along"));
  m.def(
      "medium",
      [](const std::shared_ptr<Medium>& medium, double step, double length, const std::array<double, 3>& at,
         const std::array<double, 3>& along) { return medium_dict(*medium, step, length, at, along, {}); },
      nb::arg("medium"), nb::arg("step"), nb::arg("length"), nb::arg("at"), nb::arg("along"));
  m.def(
      "file_info",
      [](const std::filesystem::path& file, const Defines& defines) {
        FileInfo info;
        {
          const Unlocked release;
          info = file_info(file, defines, current_tables());
        }
        return nb::make_tuple(info.kind, decoded(info.text), notes_of(info.notes));
      },
      nb::arg("file"), nb::arg("defines"));
  m.def(
      "state_picture",
      [](const std::filesystem::path& file) {
        auto picture = std::make_shared<Picture>();
        const Unlocked release;
        picture->state = std::make_shared<const RenderState>(RenderState::load(file));
        picture->image = picture->state->picture();
        return picture;
      },
      nb::arg("file"));
  m.def(
      "grid_slice",
      [](const std::filesystem::path& file, bool is_radiance_grid, int axis) {
        if (axis < 0 || axis > 2) throw Error("axis: expected 0, 1 or 2, got " + std::to_string(axis));
        GridSlice slice;
        {
          const Unlocked release;
          slice = is_radiance_grid ? radiance_grid_slice(file, axis) : volume_slice(file, axis);
        }
        const Result<double> values({slice.height, slice.width});
        std::ranges::copy(slice.values, values.data());
        return nb::make_tuple(values.object(), slice.spacing[0], slice.spacing[1], slice.index, slice.count);
      },
      nb::arg("file"), nb::arg("is_radiance_grid"), nb::arg("axis"));
  m.def(
      "splat_points",
      [](const std::filesystem::path& file, std::size_t most) {
        if (most < 1 || most > 10'000'000)
          throw Error("most: expected 1 to 10000000, got " + std::to_string(most));
        SplatPoints points;
        {
          const Unlocked release;
          points = splat_points(file, most);
        }
        const Py_ssize_t n = Py_ssize_t(points.positions.size());
        const Result<double> positions({n}, 3), colors({n}, 4);
        for (std::size_t i = 0; i < points.positions.size(); ++i) {
          const Vec3 &p = points.positions[i], &c = points.colors[i];
          std::ranges::copy(std::array{p.x, p.y, p.z}, positions.data() + 3 * i);
          std::ranges::copy(std::array{c.x, c.y, c.z, points.opacities[i]}, colors.data() + 4 * i);
        }
        return nb::make_tuple(positions.object(), colors.object(), points.count);
      },
      nb::arg("file"), nb::arg("most"));
  m.def(
      "replicates_of_file",
      [](const std::filesystem::path& file) {
        ExrAttributes attributes;
        const Unlocked release;
        read_image(file, &attributes);
        return replicates_of(attributes);
      },
      nb::arg("file"));
  m.def(
      "compare_pictures",
      [](const Picture& a, const Picture& b, int replicates_a, int replicates_b) {
        PictureComparison found;
        auto map = std::make_shared<Picture>();
        {
          const Unlocked release;
          found = compare_pictures(
              a.image, b.image,
              {replicates_of_picture(a, replicates_a), replicates_of_picture(b, replicates_b)});
          map->image = found.z_map().z_map;
        }
        nb::list layers;
        for (const LayerComparison& layer : found.layers) layers.append(comparison_dict(layer));
        return nb::make_tuple(layers, map->image.pixels.empty() ? nb::none() : nb::cast(map));
      },
      nb::arg("a"), nb::arg("b"), nb::arg("replicates_a"), nb::arg("replicates_b"));
  m.def(
      "measure_rings",
      [](const Picture& picture, const std::string& name, const std::vector<double>& at,
         const std::vector<double>& azimuths, const std::vector<double>& masks, double fov,
         const std::string& illuminant, const std::string& radius, const std::string& correlation_radius,
         double area_fraction, const std::string& pane_distance, const std::string& lamp_distance,
         const std::string& lamp_diameter, double smooth) {
        RingSettings s;
        s.at = at, s.azimuths = azimuths, s.masks = masks, s.fov = fov, s.illuminant = illuminant;
        s.radius = radius, s.correlation_radius = correlation_radius, s.area_fraction = area_fraction;
        s.pane_distance = pane_distance, s.lamp_distance = lamp_distance, s.lamp_diameter = lamp_diameter;
        s.smooth = smooth;
        RingReport report;
        {
          const Unlocked release;
          report = measure_rings(picture.image, name, s);
        }
        return rings_dict(report);
      },
      nb::arg("picture"), nb::arg("name"), nb::arg("at"), nb::arg("azimuths"), nb::arg("masks"),
      nb::arg("fov"), nb::arg("illuminant"), nb::arg("radius"), nb::arg("correlation_radius"),
      nb::arg("area_fraction"), nb::arg("pane_distance"), nb::arg("lamp_distance"), nb::arg("lamp_diameter"),
      nb::arg("smooth"));
  m.def(
      "measure_droplets",
      [](const std::shared_ptr<Picture>& picture, const std::string& name, const nb::dict& options) {
        DropletSettings s;
        s.photo = name;
        const auto text = [&](const char* key) { return nb::cast<std::string>(options[key]); };
        const auto number = [&](const char* key) { return nb::cast<double>(options[key]); };
        const auto numbers = [&](const char* key) { return nb::cast<std::vector<double>>(options[key]); };
        try {
          s.pixel_angle = text("pixel_angle"), s.lamp = text("lamp"), s.angles = text("angles");
          s.angle_error = text("angle_error"), s.substrate = text("substrate");
          s.pane_distance = text("pane_distance"), s.lamp_distance = text("lamp_distance");
          s.lamp_angle = text("lamp_angle"), s.inner = text("inner"), s.correlation = text("correlation");
          s.fov = number("fov"), s.area_fraction = number("area_fraction"), s.index = number("index");
          s.spread = nb::cast<bool>(options["spread"]);
          s.second_size = nb::cast<bool>(options["second_size"]);
          s.center = numbers("center"), s.azimuths = numbers("azimuths"), s.masks = numbers("masks");
        } catch (const nb::cast_error&) {
          throw Error("options: expected texts, numbers and lists of numbers");
        }
        if (s.azimuths.size() != 2 || s.masks.size() % 3 != 0)
          throw Error("options: expected two azimuths, and three numbers for each mask");
        DropletMeasurement found;
        {
          const Unlocked release;
          found = measure_droplets(s, picture ? picture->image : Image{});
        }
        return droplets_dict(found);
      },
      nb::arg("picture").none(), nb::arg("name"), nb::arg("options"));
}

}  // namespace aureole::python
