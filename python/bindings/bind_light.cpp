// SPDX-License-Identifier: Apache-2.0
// Photometry, luminaires, lenses, cameras and light fields. The public interface is in aureole/_lens.py, _photometry.py,
// _goniophotometer.py, _ugr.py, _illumination.py, _light_field.py and _exposure.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "aureole/core/input_file.h"
#include "aureole/core/raw_image.h"
#include "aureole/instrument/detector/camera_exposure.h"
#include "aureole/instrument/lens/lens_figures.h"
#include "aureole/instrument/lightfield/light_field.h"
#include "aureole/instrument/photometry/goniophotometer_scene.h"
#include "aureole/instrument/photometry/illumination.h"
#include "aureole/instrument/photometry/shape_solid_angle.h"
#include "aureole/instrument/photometry/ugr_table.h"
#include "aureole/scene/scene.h"
#include "bindings.h"
#include "current_tables.h"
#include "loading_signals.h"
#include "open_scene.h"
#include "picture.h"
#include "text.h"

namespace aureole::python {

namespace {

using NamedValues = std::vector<std::pair<std::string, std::string>>;
using Numbers = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

/// An array of its own, of two axes.
template <class T>
nb::object array_of(std::vector<T> values, std::size_t height, std::size_t width) {
  auto* kept = new std::vector<T>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  const std::size_t shape[2] = {height, width};
  return nb::cast(nb::ndarray<nb::numpy, T, nb::ndim<2>, nb::c_contig>(kept->data(), 2, shape, owner));
}

nb::list texts_of(const std::vector<std::string>& texts) {
  nb::list list;
  for (const std::string& text : texts) list.append(decoded(text));
  return list;
}

std::vector<MapRegion> regions_of(const std::vector<std::array<int, 4>>& rows) {
  std::vector<MapRegion> regions;
  for (const auto& r : rows) regions.push_back({r[0], r[1], r[2], r[3]});
  return regions;
}

PhotometricMap map_of_array(const Numbers& values, const std::string& quantity, const std::string& unit) {
  constexpr std::size_t kLargestSide = 1 << 20;
  if (values.shape(0) < 1 || values.shape(1) < 1 || values.shape(0) > kLargestSide ||
      values.shape(1) > kLargestSide)
    throw Error("values: expected an array of at least one cell");
  return {int(values.shape(1)),
          int(values.shape(0)),
          {values.data(), values.data() + values.size()},
          quantity,
          unit};
}

Vec3 up_of(const std::array<double, 3>& up) {
  const Vec3 v{float(up[0]), float(up[1]), float(up[2])};
  const float square = length_squared(v);
  if (!(square > 0 && std::isfinite(square))) throw Error("up: is no direction");
  return normalize(v);
}

nb::dict lens_dict(const LensFigures& f, const std::vector<std::string>& notes) {
  nb::dict d;
  d["name"] = decoded(f.name), d["surfaces"] = f.surfaces, d["stop"] = f.stop;
  d["focal_length"] = f.focal_length, d["f_number"] = f.f_number, d["back_focus"] = f.back_focus;
  d["entrance_pupil"] = f.entrance_pupil, d["entrance_diameter"] = f.entrance_width;
  d["exit_pupil"] = f.exit_pupil, d["exit_diameter"] = f.exit_width, d["film"] = f.film;
  d["cutoff"] = f.cutoff, d["airy_radius"] = f.airy_radius;
  nb::list foci, spots;
  for (const LensFocus& x : f.foci) foci.append(nb::make_tuple(x.nm, x.focal_length, x.paraxial, x.best));
  for (const LensSpot& s : f.spots) {
    std::vector<double> points;
    for (const auto& p : s.points) points.insert(points.end(), p.begin(), p.end());
    spots.append(nb::make_tuple(s.field, s.nm, s.height, s.rms, s.open, s.transmittance,
                                array_of(std::move(points), s.points.size(), 2)));
  }
  d["foci"] = foci, d["spots"] = spots, d["notes"] = texts_of(notes);
  return d;
}

nb::dict luminaire_dict(const Luminaire& l) {
  const LuminaireFigures f = luminaire_figures(l);
  const optics::IntensityDistribution& distribution = l.distribution;
  nb::dict d;
  d["standard"] = decoded(l.standard), d["symmetry"] = decoded(l.symmetry);
  d["type"] = l.type == optics::PhotometricType::a ? "A" : l.type == optics::PhotometricType::b ? "B" : "C";
  d["azimuths"] = distribution.azimuths(), d["polar_angles"] = distribution.polar_angles();
  std::vector<double> candela;
  for (std::size_t i = 0; i < distribution.azimuths().size(); ++i)
    for (std::size_t j = 0; j < distribution.polar_angles().size(); ++j)
      candela.push_back(distribution.value(i, j));
  d["candela"] =
      array_of(std::move(candela), distribution.azimuths().size(), distribution.polar_angles().size());
  d["flux"] = f.flux, d["downward_flux"] = f.downward_flux, d["peak"] = f.peak;
  d["peak_direction"] = std::pair(f.peak_c, f.peak_gamma), d["beam"] = std::pair(f.beam[0], f.beam[1]);
  d["lamp_flux"] = l.lamp_flux(), d["opening"] = l.opening.size_m, d["balance"] = flux_balance(l).text();
  nb::list keywords;
  for (const auto& [key, value] : l.keywords) keywords.append(nb::make_tuple(decoded(key), decoded(value)));
  d["keywords"] = keywords, d["notes"] = texts_of(l.notes);
  // A luminaire that a format cannot hold says so where its file is asked for.
  const auto text_or_problem = [&](const char* name, std::string (*text)(const Luminaire&)) {
    std::string written, problem;
    try {
      written = text(l);
    } catch (const Error& e) {
      problem = e.what();
    }
    d[name] = nb::make_tuple(decoded(written), decoded(problem));
  };
  text_or_problem("ies", ies_text), text_or_problem("ldt", eulumdat_text);
  return d;
}

/// Options that replace what a file states: flux, flux of the lamps [lm] and power [W], opening [m], keywords.
GoniometryOptions file_changes(const std::array<double, 3>& fluxes,
                               const std::optional<std::array<double, 3>>& opening,
                               const NamedValues& keywords) {
  for (const double v : fluxes)
    if (!(v >= 0 && std::isfinite(v))) throw Error("fluxes: expected numbers that are not negative");
  for (const double v : opening.value_or(std::array<double, 3>{}))
    if (!(v >= 0 && v < 1e4)) throw Error("opening: expected sizes in m");
  GoniometryOptions how;
  how.flux = fluxes[0], how.lamp_flux = fluxes[1], how.watts = fluxes[2];
  if (opening) how.opening = LuminousOpening{.size_m = *opening};
  how.keywords = keywords;
  return how;
}

nb::dict ugr_dict(const UgrTable& t) {
  nb::dict d;
  d["flux"] = t.flux, d["is_of_lamps"] = t.is_of_lamps, d["correction"] = t.correction();
  nb::list ratings, backgrounds, variations, rooms, reflectances, columns;
  for (std::size_t view = 0; view < 2; ++view) {
    std::vector<double> values, luminances;
    for (std::size_t r = 0; r < kUgrRooms.size(); ++r) {
      values.insert(values.end(), t.rating[view][r].begin(), t.rating[view][r].end());
      luminances.insert(luminances.end(), t.background[view][r].begin(), t.background[view][r].end());
    }
    ratings.append(array_of(std::move(values), kUgrRooms.size(), kUgrReflectances.size()));
    backgrounds.append(array_of(std::move(luminances), kUgrRooms.size(), kUgrReflectances.size()));
    for (std::size_t k = 0; k < kUgrReflectances.size(); ++k) columns.append(ugr_column(int(view), k));
  }
  for (const UgrVariation& v : t.variations)
    variations.append(nb::make_tuple(v.spacing, v.difference[0], v.difference[1]));
  for (const UgrRoom& r : kUgrRooms) rooms.append(nb::make_tuple(r.x, r.y));
  for (const UgrReflectances& r : kUgrReflectances)
    reflectances.append(nb::make_tuple(r.ceiling, r.walls, r.plane));
  d["ratings"] = ratings, d["backgrounds"] = backgrounds, d["variations"] = variations, d["rooms"] = rooms;
  d["reflectances"] = reflectances, d["columns"] = columns, d["notes"] = texts_of(t.notes);
  return d;
}

nb::dict map_dict(PhotometricMap map) {
  nb::dict d;
  d["quantity"] = decoded(map.quantity), d["unit"] = decoded(map.unit);
  d["values"] = array_of(std::move(map.values), std::size_t(map.height), std::size_t(map.width));
  return d;
}

nb::dict runs_dict(const IlluminationRuns& runs) {
  nb::dict d = map_dict(runs.map());
  auto colors = std::make_shared<Picture>();
  colors->image = runs.colors();
  d["colors"] = colors;
  nb::list rows;
  for (std::size_t i = 0; i < runs.regions().size(); ++i) {
    const MapRegion& r = runs.regions()[i];
    const RunStatistics& s = runs.statistics()[i];
    rows.append(nb::make_tuple(r.x, r.y, r.width, r.height, s.mean(), s.error()));
  }
  d["regions"] = rows;
  return d;
}

void bind_photometry(nb::module_& m) {
  m.def(
      "photometric_map",
      [](const Picture& picture, const std::string& name) {
        return map_dict(photometric_map(picture.image, picture.channel_meanings(), name));
      },
      nb::arg("picture"), nb::arg("name"));
  m.def(
      "map_statistics",
      [](const Numbers& values, const std::array<int, 4>& region, const std::vector<double>& areas) {
        PhotometricMap map = map_of_array(values, "", "");
        if (!areas.empty() && areas.size() != map.values.size())
          throw Error("areas: expected that of each cell, or none");
        map.areas = areas;
        const MapStatistics s = map_statistics(map, regions_of({region})[0]);
        return nb::make_tuple(s.count, s.mean, s.min, s.median, s.max, s.uniformity(), s.diversity(), s.sum);
      },
      nb::arg("values"), nb::arg("region"), nb::arg("areas"));
  m.def(
      "cell_areas",
      [](const std::shared_ptr<OpenScene>& scene, int width, int height) {
        if (width < 1 || height < 1) throw Error("width: expected at least one cell");
        return cell_areas(scene->scene()->sensor(), width, height);
      },
      nb::arg("scene"), nb::arg("width"), nb::arg("height"));
  m.def(
      "picture_glare",
      [](const Numbers& values, const std::string& quantity, const std::string& unit,
         const std::shared_ptr<OpenScene>& scene, const std::array<double, 3>& up, double threshold) {
        const auto built = scene->scene();
        const PhotometricMap map = map_of_array(values, quantity, unit);
        try {
          place_on_film(built->film(), map.width, map.height);
        } catch (const Error& e) {
          throw Error("scene: " + e.message());
        }
        const PictureGlare g = picture_glare(map, built->sensor(), up_of(up), threshold);
        nb::dict d;
        d["threshold"] = g.threshold, d["background"] = g.background, d["solid_angle"] = g.solid_angle;
        d["rating"] = g.rating, d["outside"] = g.outside;
        nb::list sources;
        for (const PictureGlareSource& s : g.sources)
          sources.append(nb::make_tuple(s.x, s.y, s.pixels, s.source.luminance, s.source.solid_angle,
                                        s.source.position));
        d["sources"] = sources;
        return d;
      },
      nb::arg("values"), nb::arg("quantity"), nb::arg("unit"), nb::arg("scene"), nb::arg("up"),
      nb::arg("threshold"));
  m.def(
      "open_illuminance",
      [](const std::shared_ptr<OpenScene>& scene, const std::array<double, 3>& up) {
        return open_illuminance(*scene->scene(), up_of(up));
      },
      nb::arg("scene"), nb::arg("up"));
  m.def(
      "traced_solid_angle",
      [](const std::shared_ptr<OpenScene>& scene, const std::array<double, 3>& point,
         const std::array<double, 3>& normal, int samples) {
        if (samples < 16 || samples > (1 << 28)) throw Error("samples: expected 16 to 268435456");
        const auto built = scene->scene();
        const auto vector = [](const std::array<double, 3>& v) {
          return Vec3{float(v[0]), float(v[1]), float(v[2])};
        };
        const Unlocked release;
        SignalCheck signals;
        const TracedSolidAngle s =
            traced_solid_angle(*built, vector(point), vector(normal), samples, [&] { signals(); });
        return std::array<double, 4>{s.solid, s.projected, s.solid_error, s.projected_error};
      },
      nb::arg("scene"), nb::arg("point"), nb::arg("normal"), nb::arg("samples"));
  m.def(
      "false_color_map",
      [](const Numbers& values, const std::string& quantity, const std::string& unit,
         std::optional<double> low, std::optional<double> high, bool is_logarithmic,
         const std::vector<double>& isolines) {
        const PhotometricMap map = map_of_array(values, quantity, unit);
        auto picture = std::make_shared<Picture>();
        picture->image = false_color_picture(map.values, map.width, map.height,
                                             map_scale(map, low, high, is_logarithmic, isolines));
        return picture;
      },
      nb::arg("values"), nb::arg("quantity"), nb::arg("unit"), nb::arg("low").none(), nb::arg("high").none(),
      nb::arg("is_logarithmic"), nb::arg("isolines"));
  m.def(
      "load_illumination",
      [](const std::string& file, const NamedValues& defines, bool is_local) {
        const Unlocked release;
        const LoadingSignals signals;
        LoadOptions load;
        load.defines = defines, load.tables = current_tables(), load.progress = signals.progress();
        return signals.run([&] {
          auto opened = std::make_shared<OpenScene>(file, illumination_options(load, is_local));
          if (is_local && measures_on_receivers(*opened->scene()))
            opened = std::make_shared<OpenScene>(file, receiver_options(load));
          return opened;
        });
      },
      nb::arg("file"), nb::arg("defines"), nb::arg("is_local"));
  m.def(
      "illumination_means",
      [](const std::vector<std::shared_ptr<Picture>>& pictures, const std::string& name,
         const std::vector<std::array<int, 4>>& regions) {
        if (pictures.empty()) throw Error("pictures: expected at least one");
        for (const auto& p : pictures)
          if (!p || !p->state) throw Error("pictures: expected pictures that were rendered here");
        const Picture& first = *pictures[0];
        IlluminationRuns runs(name, first.channel_meanings(), first.image.width, first.image.height,
                              regions_of(regions));
        for (const auto& p : pictures) runs.add(p->image, p->state->rgb_picture());
        return runs_dict(runs);
      },
      nb::arg("pictures"), nb::arg("name"), nb::arg("regions"));
}

void bind_luminaires(nb::module_& m) {
  m.def(
      "load_goniophotometer",
      [](const std::string& file, const NamedValues& defines, const std::string& integrator, std::int64_t spp,
         const std::array<double, 2>& steps, const std::array<double, 3>& down,
         const std::vector<double>& along) {
        const GoniophotometerSettings settings{
            file,  defines,         integrator, spp, steps[0], steps[1], {down.begin(), down.end()},
            along, current_tables()};
        const Unlocked release;
        const LoadingSignals signals;
        return signals.run([&] {
          const GoniophotometerSource source = goniophotometer_source(settings, signals.progress());
          auto opened = source.text ? std::make_shared<OpenScene>(*source.text, source.file, source.load)
                                    : std::make_shared<OpenScene>(source.file, source.load);
          if (!source.sensor.empty()) {
            const nb::gil_scoped_acquire lock;
            opened->set({{"sensor", source.sensor}}, {});
          }
          require_luminaire(*opened->scene());
          return opened;
        });
      },
      nb::arg("file"), nb::arg("defines"), nb::arg("integrator"), nb::arg("spp"), nb::arg("steps"),
      nb::arg("down"), nb::arg("along"));
  m.def(
      "measured_luminaire",
      [](const Picture& picture, const std::string& file, const std::string& name, const std::string& maker,
         std::int64_t spp, const std::string& symmetry, const std::array<double, 3>& fluxes,
         const std::optional<std::array<double, 3>>& opening) {
        if (picture.image.height < 2 || picture.image.channel_count() != 1)
          throw Error("picture: expected one intensity for each direction");
        GoniophotometerSettings settings;
        settings.scene = file, settings.spp = spp;
        GoniometryOptions how = file_changes(fluxes, opening, measurement_keywords(settings, name, maker));
        how.symmetry = symmetry_of(symmetry);
        return luminaire_dict(measured_luminaire(picture.image, how));
      },
      nb::arg("picture"), nb::arg("file"), nb::arg("name"), nb::arg("maker"), nb::arg("spp"),
      nb::arg("symmetry"), nb::arg("fluxes"), nb::arg("opening").none());
  m.def(
      "luminaire_of_file",
      [](const std::filesystem::path& file, std::size_t lamp_set, const std::array<double, 3>& fluxes,
         const std::optional<std::array<double, 3>>& opening, const NamedValues& keywords) {
        std::optional<Luminaire> l;
        {
          const Unlocked release;
          l.emplace(read_changed_luminaire(file, lamp_set, file_changes(fluxes, opening, keywords)));
        }
        return luminaire_dict(*l);
      },
      nb::arg("file"), nb::arg("lamp_set"), nb::arg("fluxes"), nb::arg("opening").none(),
      nb::arg("keywords"));
  m.def("require_daylight_map", &require_daylight_map, nb::arg("quantity"), nb::arg("unit"));
  m.def("require_ugr_spacing", &require_ugr_spacing, nb::arg("spacing"));
  m.def("require_luminous_area", &require_luminous_area, nb::arg("size_m"));
  m.def(
      "ugr_table",
      [](const std::string& text, const std::filesystem::path& name, double spacing, bool has_patches) {
        UgrTable table;
        {
          const Unlocked release;
          SignalCheck signals;
          UgrOptions options;
          options.spacing = spacing, options.between = [&] { signals(); };
          if (has_patches) options.background = UgrOptions::Background::patches;
          table = ugr_table(parse_luminaire(text, name), options);
        }
        return ugr_dict(table);
      },
      nb::arg("text"), nb::arg("name"), nb::arg("spacing"), nb::arg("has_patches"));
  m.def(
      "lens_figures",
      [](const std::filesystem::path& file, std::optional<double> f_number, double object,
         const std::vector<double>& fields, const std::vector<double>& wavelengths, int rays) {
        LensFigures figures;
        std::vector<std::string> notes;
        {
          const Unlocked release;
          const LensPrescription lens = read_lens(file);
          notes = lens.notes;
          SignalCheck signals;
          figures = measure_lens(lens, {f_number, object, fields, wavelengths, rays, [&] { signals(); }});
          notes.insert(notes.end(), figures.notes.begin(), figures.notes.end());
        }
        return lens_dict(figures, notes);
      },
      nb::arg("file"), nb::arg("f_number").none(), nb::arg("object"), nb::arg("fields"),
      nb::arg("wavelengths"), nb::arg("rays"));
}

void bind_light_field(nb::module_& m) {
  m.def(
      "light_field_axes",
      [](const std::shared_ptr<OpenScene>& scene) {
        const auto built = scene->scene();
        return light_field_axes(built->sensor().properties(), built->film()).text();
      },
      nb::arg("scene"));
  m.def(
      "require_light_field",
      [](const std::shared_ptr<OpenScene>& scene) {
        const auto built = scene->scene();
        light_field_axes(built->sensor().properties(), built->film());
      },
      nb::arg("scene"));
  m.def(
      "parsed_light_field",
      [](const Picture& picture, const std::string& axes, const std::string& name) {
        const LightFieldAxes f =
            parse_light_field_axes(axes, picture.image.width, picture.image.height, name);
        nb::dict d;
        d["views"] = std::pair(f.views_x, f.views_y), d["size"] = std::pair(f.width, f.height);
        d["aperture"] = std::pair(f.aperture_width, f.aperture_height);
        d["plane_distance"] = f.plane_distance, d["field_width"] = f.field_width;
        return d;
      },
      nb::arg("picture"), nb::arg("axes"), nb::arg("name"));
  m.def(
      "light_field_picture",
      [](const Picture& picture, const std::string& axes, const std::string& name,
         const std::array<double, 2>& at, double diameter, double focus) {
        auto seen = std::make_shared<Picture>();
        const Unlocked release;
        seen->image =
            light_field_picture(light_field_of(picture.image, axes, name), at[0], at[1], diameter, focus);
        seen->attributes.strings[kChannelsAttribute] = picture.channel_meanings();
        return seen;
      },
      nb::arg("picture"), nb::arg("axes"), nb::arg("name"), nb::arg("at"), nb::arg("diameter"),
      nb::arg("focus"));
  m.def(
      "write_light_field",
      [](const Picture& picture, const std::string& axes, const std::filesystem::path& file) {
        const Unlocked release;
        ExrAttributes attributes;
        attributes.strings[kLightFieldAttribute] = axes;
        if (const std::string meanings = picture.channel_meanings(); !meanings.empty())
          attributes.strings[kChannelsAttribute] = meanings;
        write_exr(file, picture.image, ExrPixel::float32, attributes);
      },
      nb::arg("picture"), nb::arg("axes"), nb::arg("file"));
}

void bind_cameras(nb::module_& m) {
  nb::class_<RawImage>(m, "RawPicture", "The digital numbers that a sensor reads.")
      .def_prop_ro("values",
                   [](nb::handle_t<RawImage> self) {
                     const RawImage& raw = nb::cast<RawImage&>(self);
                     const std::size_t shape[2] = {std::size_t(raw.height), std::size_t(raw.width)};
                     return nb::cast(nb::ndarray<nb::numpy, const std::uint16_t, nb::ndim<2>, nb::c_contig>(
                         raw.values.data(), 2, shape, self));
                   })
      .def_prop_ro("black_level", [](const RawImage& raw) { return raw.black_level; })
      .def_prop_ro("white_level", [](const RawImage& raw) { return raw.white_level; })
      .def(
          "write_dng",
          [](const RawImage& raw, const std::filesystem::path& file) {
            const Unlocked release;
            write_dng(file, raw);
          },
          nb::arg("file"))
      .def(
          "write_tiff",
          [](const RawImage& raw, const std::filesystem::path& file) {
            const Unlocked release;
            write_raw_tiff(file, raw);
          },
          nb::arg("file"));
  m.def(
      "camera_of_file",
      [](const std::filesystem::path& file) {
        read_camera(file);  // errors are located in the file
        return decoded(read_text_file(file, kMaxJsonBytes));
      },
      nb::arg("file"));
  m.def(
      "exposure_of_scene",
      [](const std::shared_ptr<OpenScene>& scene) {
        const auto built = scene->scene();
        const Film& film = built->film();
        const std::vector<std::string> names = film.channel_names();
        spectral_picture(
            {.width = 1, .height = 1, .channels = names, .pixels = std::vector<float>(names.size())},
            channels_attribute(names, film.channel_meanings()), "scene");
        return built->sensor().sensor->exposure().duration();
      },
      nb::arg("scene"));
  m.def(
      "expose_picture",
      [](const Picture& picture, const std::string& name, const std::string& camera_text,
         const std::filesystem::path& camera_file, double exposure, const std::array<std::uint64_t, 2>& seeds,
         int frames) {
        if (frames < 1) throw Error("frames: expected at least 1");
        std::vector<double> electrons;
        std::vector<std::shared_ptr<RawImage>> raws;
        std::optional<ColorCalibration> colors;
        CameraModel camera;
        SpectralPicture spectral;
        {
          const Unlocked release;
          camera = parse_camera(camera_text, camera_file);
          if (!camera.mosaic.is_mono()) colors = calibrate_colors(camera);
          spectral = spectral_picture(picture.image, picture.channel_meanings(), name);
          electrons = mean_electrons(spectral, camera, exposure);
          SignalCheck signals;
          for (int i = 0; i < frames; ++i) {
            signals();
            auto& raw = raws.emplace_back(
                std::make_shared<RawImage>(read_sensor(electrons, spectral.width, spectral.height, camera,
                                                       exposure, {seeds[0], seeds[1] + std::uint64_t(i)})));
            if (colors) raw->color_matrix = colors->from_xyz, raw->neutral = colors->white;
          }
        }
        nb::dict d;
        const optics::DetectorModel& detector = camera.detector;
        d["raw"] = raws, d["saturation"] = detector.saturation(), d["gain"] = detector.gain;
        const double dark = detector.dark_current * exposure;
        double sum = 0;
        for (const double e : electrons) sum += e;
        const double mean = sum / double(electrons.size());
        d["signal_to_noise"] = mean * detector.gain / std::sqrt(detector.temporal_variance(mean + dark));
        d["dark_noise"] = std::sqrt(detector.temporal_variance(dark)) / detector.gain;
        d["mosaic"] = array_of(std::vector<std::uint8_t>(camera.mosaic.filters),
                               std::size_t(camera.mosaic.height), std::size_t(camera.mosaic.width));
        d["electrons"] =
            array_of(std::move(electrons), std::size_t(spectral.height), std::size_t(spectral.width));
        d["delta_e"] = colors ? colors->delta_e : std::vector<double>();
        d["from_xyz"] = colors ? colors->from_xyz : std::array<double, 9>{};
        d["to_xyz"] = colors ? colors->to_xyz : std::array<double, 9>{};
        d["white"] = colors ? colors->white : std::array<double, 3>{1, 1, 1};
        d["is_irradiance"] = spectral.is_irradiance;
        return d;
      },
      nb::arg("picture"), nb::arg("name"), nb::arg("camera"), nb::arg("camera_file"), nb::arg("exposure"),
      nb::arg("seeds"), nb::arg("frames"));
}

}  // namespace

void bind_light(nb::module_& m) {
  bind_photometry(m);
  bind_luminaires(m);
  bind_light_field(m);
  bind_cameras(m);
}

}  // namespace aureole::python
