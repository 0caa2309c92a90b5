// SPDX-License-Identifier: Apache-2.0
// Scenes, their parameters, and rendering. The public interface is in aureole/_scene.py and _render.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "aureole/film/film.h"
#include "aureole/instrument/radio/power_map_scene.h"
#include "aureole/loading/aliases.h"
#include "aureole/loading/document.h"
#include "aureole/loading/values.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "aureole/render/job.h"
#include "bindings.h"
#include "current_tables.h"
#include "loading_signals.h"
#include "objects.h"
#include "open_scene.h"
#include "picture.h"
#include "text.h"

namespace aureole::python {

namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;
using Given = OpenScene::Given;

LoadOptions load_options(const Defines& defines, const Given& given, const std::string& integrator,
                         const std::string& sampler, const LoadingSignals& signals) {
  LoadOptions options;
  options.progress = signals.progress();
  options.defines = defines;
  options.tables = current_tables();
  options.given = given;
  options.integrator = integrator, options.sampler = sampler;
  return options;
}

/// A parameter's value; of a spectrum a number, an rgb triple or (nm, value) pairs under its kind.
nb::object value_object(const Properties::Value& value) {
  if (const auto* b = std::get_if<bool>(&value)) return nb::cast(*b);
  if (const auto* i = std::get_if<std::int64_t>(&value)) return nb::cast(*i);
  if (const auto* d = std::get_if<double>(&value)) return nb::cast(*d);
  if (const auto* s = std::get_if<std::string>(&value)) return nb::cast(*s);
  if (const auto* v = std::get_if<Vec3>(&value))
    return nb::make_tuple("vector", nb::make_tuple(v->x, v->y, v->z));
  if (const auto* t = Properties::transform_of(value)) {
    nb::list rows;
    for (const auto& row : t->matrix()) rows.append(nb::make_tuple(row[0], row[1], row[2], row[3]));
    return nb::make_tuple("transform", rows);
  }
  if (const auto* motion = Properties::motion_of(value)) {
    nb::list frames;
    for (const KeyFrame& frame : motion->frames())
      frames.append(
          nb::make_tuple(frame.time, value_object(Properties::Value(Shared<Transform>(frame.transform)))));
    return nb::make_tuple("animation", frames);
  }
  if (const auto* s = Properties::spectrum_of(value)) {
    if (s->kind == SpectrumLiteral::Kind::value) return nb::cast(s->value);
    if (s->kind == SpectrumLiteral::Kind::rgb)
      return nb::make_tuple("rgb", nb::make_tuple(s->rgb[0], s->rgb[1], s->rgb[2]));
    nb::list pairs;
    for (std::size_t i = 0; i < s->nm.size(); ++i) pairs.append(nb::make_tuple(s->nm[i], s->values[i]));
    return nb::make_tuple("spectrum", pairs);
  }
  return cast_object(std::get<ObjectPtr>(value));
}

/// The value or object (which may be null) at a path; nothing if the parameter is not written in the scene.
std::optional<Properties::Value> written(const SceneDocument& document, const std::string& path) {
  const Node* node = document.find(path);
  if (!node) return {};
  if (node->tag == "given" || !is_property(*node)) return document.object(path);
  Diagnostics diagnostics;
  const std::optional<Properties::Value> value = property_value(*node, diagnostics);
  diagnostics.throw_if_errors();
  return value ? *value : Properties::Value(ObjectPtr());
}

/// Runs a job in a thread of its own, so that the calling one can look after signals and progress.
class RunningJob {
public:
  RunningJob(RenderJob& job) : unfinished_(std::in_place) {
    thread_ = std::thread([this, &job] {
      try {
        outcome_ = job.run(stop_, [this](const Progress& p) {
          const std::lock_guard guard(mutex_);
          progress_ = p;
        });
      } catch (...) {
        problem_ = std::current_exception();
      }
      const std::lock_guard guard(mutex_);
      done_ = true;
      changed_.notify_all();
    });
  }
  ~RunningJob() {
    if (!thread_.joinable()) return;
    const Unlocked unlocked([this] { end(); });  // BSDFs written in Python need the lock to come to an end
    end();
  }
  /// Stops the job and waits for its threads.
  void end() {
    stop_ = true;
    join();
  }
  void stop() { stop_ = true; }
  /// Waits for a short while; returns whether the job is done.
  bool wait(double seconds) {
    std::unique_lock guard(mutex_);
    return changed_.wait_for(guard, std::chrono::duration<double>(seconds), [this] { return done_; });
  }
  std::optional<Progress> progress() {
    const std::lock_guard guard(mutex_);
    return progress_;
  }
  RenderJob::Outcome finish() {
    join();
    if (problem_) std::rethrow_exception(problem_);
    return outcome_;
  }

private:
  void join() {
    if (!thread_.joinable()) return;
    thread_.join();
    unfinished_.reset();
  }

  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  bool done_ = false;
  std::optional<Progress> progress_;
  RenderJob::Outcome outcome_ = RenderJob::Outcome::interrupted;
  std::exception_ptr problem_;
  std::optional<Unfinished> unfinished_;
  std::thread thread_;
};

const char* name_of(RenderJob::Outcome outcome) {
  return outcome == RenderJob::Outcome::finished      ? "finished"
         : outcome == RenderJob::Outcome::interrupted ? "interrupted"
                                                      : "time limit";
}

/// Renders with `options`, continuing from `start`. Returns the picture and the outcome.
nb::tuple render(const LoadedScene& built, const RenderOptions& options,
                 const std::shared_ptr<Picture>& start, const nb::object& progress) {
  std::optional<RenderJob> job;
  {
    const Unlocked release;
    job.emplace(built, options);
    if (start) {
      if (!start->state)
        throw Error("start: this picture was not rendered here, so that it can't be continued");
      RenderState state = *start->state;
      state.set_range(options.begin, job->state().end);
      job->resume(std::move(state));
    }
  }
  bool interrupted = false;
  RenderJob::Outcome outcome;
  {
    RunningJob running(*job);
    const auto end = [&] { running.end(); };
    for (bool done = false; !done;) {
      {
        const Unlocked release(end);
        done = running.wait(0.05);
      }
      if (PyErr_CheckSignals() != 0) {
        // A KeyboardInterrupt stops the render and keeps what is done; anything else, and a second one, is
        // passed on.
        if (interrupted || !PyErr_ExceptionMatches(PyExc_KeyboardInterrupt)) {
          nb::python_error problem;
          running.stop();
          {
            const Unlocked release(end);
            while (!running.wait(1)) {
            }
          }
          throw problem;
        }
        PyErr_Clear();
        interrupted = true;
        running.stop();
      }
      if (progress.is_none() || interrupted) continue;
      if (const auto p = running.progress())
        progress(p->units_done, p->units, p->seconds, p->samples_per_second);
    }
    const Unlocked release(end);
    outcome = running.finish();
  }
  auto picture = std::make_shared<Picture>();
  {
    const Unlocked release;
    picture->state = std::make_shared<const RenderState>(job->state());
    if (!options.units) picture->image = picture->state->picture();  // parts are not shown
    for (const InvalidSample& s : job->invalid_samples())
      picture->invalid.push_back({s.x, s.y, s.sample, s.replicate});
  }
  return nb::make_tuple(picture, name_of(interrupted ? RenderJob::Outcome::interrupted : outcome));
}

}  // namespace

void bind_scene(nb::module_& m) {
  nb::class_<aureole::Array, Object>(m, "Array", "Numbers that stand for a file in a scene.")
      .def(
          "__init__",
          [](aureole::Array* self, const nb::ndarray<const double, nb::c_contig, nb::device::cpu>& values) {
            std::vector<std::size_t> shape;
            for (std::size_t i = 0; i < values.ndim(); ++i) shape.push_back(values.shape(i));
            new (self) aureole::Array(std::move(shape), {values.data(), values.data() + values.size()});
          },
          nb::arg("values"))
      .def_prop_ro("shape", &aureole::Array::shape);

  nb::class_<OpenScene>(m, "OpenScene", "A scene with its objects.")
      .def_static(
          "load_file",
          [](const std::filesystem::path& file, const Defines& defines, const Given& given,
             const std::string& integrator, const std::string& sampler) {
            const Unlocked release;
            const LoadingSignals signals;
            const LoadOptions options = load_options(defines, given, integrator, sampler, signals);
            return signals.run([&] { return std::make_shared<OpenScene>(file, options); });
          },
          nb::arg("file"), nb::arg("defines"), nb::arg("given"), nb::arg("integrator"), nb::arg("sampler"))
      .def_static(
          "load_string",
          [](const std::string& text, const std::filesystem::path& file, const Defines& defines,
             const Given& given, const std::string& integrator, const std::string& sampler) {
            const Unlocked release;
            const LoadingSignals signals;
            const LoadOptions options = load_options(defines, given, integrator, sampler, signals);
            return signals.run([&] { return std::make_shared<OpenScene>(text, file, options); });
          },
          nb::arg("text"), nb::arg("file"), nb::arg("defines"), nb::arg("given"), nb::arg("integrator"),
          nb::arg("sampler"))
      .def("paths", [](OpenScene& s) { return s.read([](const auto& d) { return d.paths(); }); })
      .def(
          "value",
          [](OpenScene& s, const std::string& path) -> nb::tuple {
            const auto value = s.read([&](const auto& d) { return written(d, path); });
            return nb::make_tuple(value.has_value(), value ? value_object(*value) : nb::none());
          },
          nb::arg("path"), "(whether something is written at the path, its value or object).")
      .def(
          "owner",
          [](OpenScene& s, const std::string& path) {
            const auto [family, type] = s.read([&](const auto& d) {
              const Node& node = d.owner(path);
              return std::pair(std::string(object_family(node)), std::string(node.get("type")));
            });
            return nb::make_tuple(family, type);
          },
          nb::arg("path"), "(family, type) of the object that holds the parameter at a path.")
      .def(
          "set",
          [](OpenScene& s, const std::vector<std::pair<std::string, std::string>>& changes,
             const Given& given) { s.set(changes, given); },
          nb::arg("changes"), nb::arg("given"))
      .def("xml", [](OpenScene& s) { return s.read([](const auto& d) { return d.xml(); }); })
      .def_prop_ro("notes",
                   [](OpenScene& s) {
                     nb::list notes;
                     for (const std::string& note : s.loaded().notes) notes.append(decoded(note));
                     return notes;
                   })
      .def_prop_ro("hash", [](OpenScene& s) { return s.loaded().hash; })
      .def_prop_ro("files",
                   [](OpenScene& s) {
                     std::vector<std::string> names;
                     for (const auto& file : s.loaded().files)
                       names.push_back(std::filesystem::absolute(file).lexically_normal().string());
                     return names;
                   })
      .def_prop_ro("file", [](OpenScene& s) { return file_name(s.loaded().file.string()); })
      .def_prop_ro("sample_count", [](OpenScene& s) { return s.scene()->sensor().sampler().sample_count(); })
      .def_prop_ro("size",
                   [](OpenScene& s) {
                     const auto scene = s.scene();
                     const Film& film = scene->film();
                     return nb::make_tuple(film.crop_width(), film.crop_height());
                   })
      .def_prop_ro("wavelength_range",
                   [](OpenScene& s) {
                     const SpectralGrid grid = s.scene()->wavelengths().grid();
                     return nb::make_tuple(grid.min_nm, grid.max_nm);
                   })
      .def_prop_ro("bounds", [](OpenScene& s) -> nb::object {
        const Bounds3 b = s.scene()->bounds();
        if (b.empty()) return nb::none();
        return nb::make_tuple(nb::make_tuple(b.lower.x, b.lower.y, b.lower.z),
                              nb::make_tuple(b.upper.x, b.upper.y, b.upper.z));
      });

  m.def(
      "render",
      [](const std::shared_ptr<OpenScene>& scene, std::int64_t begin, std::optional<std::int64_t> end,
         std::optional<std::uint64_t> seed, int threads, int replicates, double time_limit_s,
         const std::optional<std::string>& adaptive, const std::shared_ptr<Picture>& start,
         const nb::object& progress, const std::optional<std::pair<std::int64_t, std::int64_t>>& units,
         bool is_for_denoising) {
        RenderOptions options;
        if (units) options.units = UnitRanges::Range{units->first, units->second};
        if (adaptive) options.adaptive = adaptive_target(*adaptive);
        options.begin = begin, options.end = end, options.seed = seed;
        options.threads = threads, options.replicates = replicates, options.time_limit_s = time_limit_s;
        LoadedScene built = is_for_denoising ? scene->for_denoising() : scene->loaded();
        if (is_for_denoising) divide_for_denoising(built, options);
        return render(built, options, start, progress);
      },
      nb::arg("scene"), nb::arg("begin"), nb::arg("end").none(), nb::arg("seed").none(), nb::arg("threads"),
      nb::arg("replicates"), nb::arg("time_limit_s"), nb::arg("adaptive").none(), nb::arg("start").none(),
      nb::arg("progress").none(), nb::arg("units").none() = nb::none(), nb::arg("is_for_denoising") = false);

  m.def(
      "empty_picture",
      [](const std::shared_ptr<OpenScene>& scene, std::optional<std::int64_t> end,
         std::optional<std::uint64_t> seed, int replicates, const std::optional<std::string>& adaptive) {
        RenderOptions options;
        if (adaptive) options.adaptive = adaptive_target(*adaptive);
        options.end = end, options.seed = seed, options.replicates = replicates;
        const LoadedScene built = scene->loaded();
        auto picture = std::make_shared<Picture>();
        const Unlocked release;
        picture->state = std::make_shared<const RenderState>(planned_state(built, options));
        picture->image = picture->state->picture();
        return picture;
      },
      nb::arg("scene"), nb::arg("end").none(), nb::arg("seed").none(), nb::arg("replicates"),
      nb::arg("adaptive").none(), "The picture of a scene without a sample, to which parts are added.");

  m.def(
      "load_power_map",
      [](const std::string& file, const Defines& defines, const std::string& integrator,
         std::optional<int> max_depth, bool diffraction, const std::string& diffraction_model,
         const std::string& polarisation, const std::vector<double>& plane, const std::vector<double>& normal,
         const std::vector<double>& size, const std::vector<double>& transmitters,
         const std::string& frequency, double cell) {
        for (const auto& [name, numbers, count] :
             {std::tuple("plane", &plane, 3), {"normal", &normal, 3}, {"size", &size, 2}})
          if (!numbers->empty() && numbers->size() != std::size_t(count))
            throw Error(std::string(name) + ": expected " + std::to_string(count) + " numbers");
        PowerMapSettings settings{
            file,   integrator, defines,      max_depth, diffraction, diffraction_model, polarisation, plane,
            normal, size,       transmitters, frequency, cell,        current_tables()};
        const Unlocked release;
        const LoadingSignals signals;
        PowerMapSource source = power_map_source(settings);
        source.load.progress = signals.progress();
        auto opened = signals.run([&] {
          return source.text ? std::make_shared<OpenScene>(*source.text, source.file, source.load)
                             : std::make_shared<OpenScene>(source.file, source.load);
        });
        return std::pair(opened, [&] {
          const nb::gil_scoped_acquire lock;
          return power_map_notes(settings, opened->loaded());
        }());
      },
      nb::arg("file"), nb::arg("defines"), nb::arg("integrator"), nb::arg("max_depth").none(),
      nb::arg("diffraction"), nb::arg("diffraction_model"), nb::arg("polarisation"), nb::arg("plane"),
      nb::arg("normal"), nb::arg("size"), nb::arg("transmitters"), nb::arg("frequency"), nb::arg("cell"),
      "The scene of a power map, and notes on light that it misses.");
  m.def(
      "require_power_map",
      [](const std::shared_ptr<OpenScene>& scene) { require_power_map(*scene->scene()); }, nb::arg("scene"));
  m.def(
      "power_maps",
      [](const std::shared_ptr<OpenScene>& scene, const Picture& picture, const std::string& power) {
        const auto built = scene->scene();
        const Film& film = built->film();
        if (picture.image.width != film.crop_width() || picture.image.height != film.crop_height())
          throw Error("image: expected a picture of this scene, with its width and height");
        for (const std::string& name : film.channel_names())
          if (picture.image.channel(name) < 0)
            throw Error("image: expected a picture of this scene, with the channel " + name);
        std::vector<PowerMap> maps;
        {
          const Unlocked release;
          std::optional<double> watts;
          if (!power.empty()) watts = parse_power_w(power);
          maps = power_maps(*built, picture.image, watts);
        }
        nb::list all;
        for (const PowerMap& map : maps) {
          nb::dict d;
          d["channel"] = map.channel, d["band"] = band_text(map), d["width"] = map.width;
          d["height"] = map.height, d["min_nm"] = map.min_nm, d["max_nm"] = map.max_nm;
          d["wavelength"] = map.wavelength_m, d["power"] = map.power_w, d["density"] = map.density;
          d["free_space"] = map.free, d["error"] = map.error, d["relative_db"] = map.relative_db();
          d["received_dbm"] = map.received_dbm(), d["error_db"] = map.error_db();
          all.append(d);
        }
        return all;
      },
      nb::arg("scene"), nb::arg("picture"), nb::arg("power"));

  m.def(
      "did_you_mean",
      [](const std::string& name, const std::vector<std::string>& names) {
        return did_you_mean(name, names);
      },
      nb::arg("name"), nb::arg("names"),
      "\"; did you mean ...?\" for a name that is near to one of `names`, else an empty string.");
  m.def(
      "is_alias",
      [](const std::string& family, const std::string& name) { return find_alias(family, name) != nullptr; },
      nb::arg("family"), nb::arg("name"),
      "Whether another program's plug-in of that name is read as one of ours.");
  m.def(
      "plugins",
      [] {
        nb::list all;
        for (const PluginInfo& p : Registry::instance().all()) {
          nb::list parameters;
          for (const ParameterDoc& d : p.doc.parameters)
            parameters.append(nb::make_tuple(d.name, d.type, d.unit, d.fallback, d.meaning));
          all.append(nb::make_tuple(p.family, p.name, p.doc.summary, p.doc.source, parameters));
        }
        return all;
      },
      "(family, name, summary, source, [(parameter, type, unit, default, meaning)]) of all plug-ins.");
}

}  // namespace aureole::python
