// SPDX-License-Identifier: Apache-2.0
// aureole gallery: renders the figures of scenes/NAME/gallery.json into one page of pictures, plots and
// numbers.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "aureole/render/output.h"
#include "aureole/render/statistics.h"
#include "command.h"
#include "gallery/gallery_page.h"
#include "gallery/gallery_picture.h"
#include "gallery/gallery_plots.h"
#include "messages.h"
#include "scene_loading.h"
#include "table_progress_line.h"

namespace aureole {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> stop_requested{false};
extern "C" void request_gallery_stop(int) {
  // A second Ctrl-C ends the program immediately.
  if (stop_requested.exchange(true)) _exit(130);
}

struct Arguments {
  std::string name, output, scenes = "scenes", size = "preview";
  std::vector<std::string> only;
  int threads = 0;
  bool again = false, quiet = false;
};

/// Progress of the gallery, measured in samples for pictures without a time limit and in seconds for the
/// others.
class GalleryProgress {
public:
  explicit GalleryProgress(bool quiet) : line_(!quiet && isatty(2)) {}
  ~GalleryProgress() { clear(); }
  void expect(const PictureEffort& e) {
    e.seconds > 0 ? seconds_ahead_ += e.seconds : samples_ahead_ += samples(e);
    ++pictures_;
  }
  void done(const PictureEffort& e, double seconds) {
    if (e.seconds > 0)
      seconds_ahead_ -= e.seconds;
    else
      samples_ahead_ -= samples(e), samples_done_ += samples(e), seconds_done_ += seconds;
    ++pictures_done_;
  }
  void show(const std::string& figure, const PictureEffort& e, const Progress& p) const {
    if (!line_) return;
    double part = p.units > 0 ? double(p.units_done) / double(p.units) : 1;
    double here = 0, ahead = seconds_ahead_, finished = samples_done_, spent = seconds_done_;
    if (e.seconds > 0) {
      part = std::min(1.0, p.seconds / e.seconds);
      ahead -= std::min(e.seconds, p.seconds);
    } else {
      here = part * samples(e);
      finished += here, spent += p.seconds;
    }
    std::string left;
    if (finished > 0 || samples_ahead_ <= 0) {
      const auto s =
          static_cast<long>(ahead + (finished > 0 ? (samples_ahead_ - here) * spent / finished : 0) + 0.5);
      left = fmt::format(", {}:{:02} left", s / 60, s % 60);
    }
    std::fprintf(stderr, "\r%s: picture %d of %d, %.0f %%%s \033[K", figure.c_str(), pictures_done_ + 1,
                 pictures_, 100 * part, left.c_str());
    std::fflush(stderr);
  }
  void clear() const {
    if (line_) std::fprintf(stderr, "\r\033[K");
  }

private:
  static double samples(const PictureEffort& e) { return double(e.width) * e.height * double(e.samples); }
  bool line_;
  int pictures_ = 0, pictures_done_ = 0;
  double samples_ahead_ = 0, seconds_ahead_ = 0, samples_done_ = 0, seconds_done_ = 0;
};

class GalleryRun {
public:
  GalleryRun(const Arguments& a, GallerySize size)
      : a_(a), size_(size), gallery_(read_gallery(fs::path(a.scenes) / a.name)), progress_(a.quiet) {
    std::vector<std::string> ids;
    for (const GalleryFigure& f : gallery_.figures) ids.push_back(f.id);
    for (const std::string& id : a.only)
      if (std::find(ids.begin(), ids.end(), id) == ids.end())
        throw Error(fmt::format("--only {}: there is no such figure{}; figures: {}", id,
                                did_you_mean(id, ids), fmt::join(ids, ", ")));
    for (const GalleryFigure& f : gallery_.figures)
      if (const bool named = std::find(a.only.begin(), a.only.end(), f.id) != a.only.end();
          named || a.only.empty()) {
        if (f.missing.empty())
          chosen_.push_back(&f);
        else if (named)
          throw Error(fmt::format("--only {}: {}", f.id, f.missing));
        else
          tell("note: the figure {} is left out: {}\n", f.id, f.missing);
      }
    check_scenes();
    prepare_folder();
    command_ = fmt::format("aureole gallery {} --size {}", a.name, a.size);
    if (!a.only.empty()) command_ += fmt::format(" --only {}", fmt::join(a.only, ","));
  }

  int run() {
    write_page();
    for (const GalleryFigure* f : chosen_) plan(*f);
    for (const GalleryFigure* f : chosen_) {
      const auto start = std::chrono::steady_clock::now();
      const int made = make(*f);
      const bool stopped = stop_requested;
      results_.save(folder_ / "results.json");
      write_page();
      progress_.clear();
      if (stopped) {
        tell("interrupted in {}: what is done is on the page; the same command continues\n", f->id);
        return 1;
      }
      if (!a_.quiet)
        fmt::print(
            "{:<8} {}: {}\n", f->id, f->title,
            made == 0 ? std::string("was done already")
                      : fmt::format(
                            "{:.1f} s",
                            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
      std::fflush(stdout);
    }
    if (!a_.quiet) fmt::print("{}\n", (folder_ / "index.html").string());
    return 0;
  }

private:
  template <class Visit>
  static void for_pictures(const GalleryFigure& f, const Visit& visit) {
    for (const PictureTable& t : f.tables) {
      if (t.reference) visit(*t.reference, t);
      for (const GalleryPicture& p : t.pictures) visit(p, t);
    }
  }

  /// Reports all errors that can be found without building scenes, before anything is rendered.
  void check_scenes() {
    for (const GalleryFigure* f : chosen_)
      for_pictures(*f, [&](const GalleryPicture& p, const PictureTable&) { picture_key(p, size_); });
  }

  void prepare_folder() {
    folder_ = a_.output.empty() ? fs::path("gallery-" + a_.name) : fs::path(a_.output);
    std::error_code code;
    if (fs::exists(folder_, code) && !fs::is_directory(folder_, code))
      throw Error({folder_.string(), 0, 0}, "exists and is not a folder");
    if (fs::is_directory(folder_, code) && !fs::is_empty(folder_, code) &&
        !fs::exists(folder_ / "results.json", code))
      throw Error({folder_.string(), 0, 0},
                  "is a folder of something else (no results.json in it); choose a new one");
    fs::create_directories(folder_ / "exr", code);
    if (code) throw Error({folder_.string(), 0, 0}, "cannot be made: " + code.message());
    lock_.emplace(folder_ / "index.html");
    require_writable(folder_ / "index.html");
    results_ = GalleryResults::load(folder_ / "results.json");
    results_.save(folder_ / "results.json");
  }

  fs::path exr(const GalleryPicture& p) const { return folder_ / "exr" / (p.name + ".exr"); }

  /// Whether a picture with these inputs exists in this size or, if a preview is requested, in full size.
  bool is_done(const GalleryPicture& p, bool any_size) const {
    const auto at = results_.pictures.find(p.name);
    if (at == results_.pictures.end() || !fs::exists(exr(p)) || !fs::exists(folder_ / (p.name + ".png")))
      return false;
    if (!any_size && at->second.size < size_) return false;
    try {
      return at->second.key == picture_key(p, at->second.size);
    } catch (const Error&) {
      return false;  // a result of a figure that was not requested
    }
  }
  static std::string plot_key(const GalleryPlot& p) {
    std::string key = std::string(kVersion) + " " + p.kind + " " + p.parameters.dump();
    const auto scene = p.parameters.find("scene");  // which the plot renders
    if (scene == p.parameters.end() || !scene->is_string()) return key;
    GalleryPicture picture;
    picture.scene = p.folder / scene->get<std::string>();
    return key + " " + picture_key(picture, kPreviewSize);
  }
  bool is_done(const GalleryPlot& p, bool any_size) const {
    const auto at = results_.plots.find(p.name);
    if (at == results_.plots.end() || at->second.key != plot_key(p)) return false;
    if (!any_size && at->second.size < size_) return false;
    for (const PlotFile& f : at->second.plot.files)
      if (!fs::exists(folder_ / f.file)) return false;
    return true;
  }

  void plan(const GalleryFigure& f) {
    for_pictures(f, [&](const GalleryPicture& p, const PictureTable&) {
      if (a_.again || !is_done(p, false)) progress_.expect(p.effort[size_]);
    });
  }

  /// Makes a figure; returns the number of pictures and plots made.
  int make(const GalleryFigure& f) {
    int made = 0;
    for_pictures(f, [&](const GalleryPicture& p, const PictureTable& t) {
      if (stop_requested) return;
      if (a_.again || !is_done(p, false)) made += render(f, p);
      if (stop_requested) return;
      // Written again, since the tone may have changed, and the error if the reference has changed.
      const Image image = read_image(exr(p));
      write_png(folder_ / (p.name + ".png"), toned(image, p.tone));
      if (t.reference && &p != &*t.reference)
        results_.pictures[p.name].relative_rmse =
            std::sqrt(compare_images(image, read_image(exr(*t.reference))).relative_mse);
    });
    for (const GalleryPlot& p : f.plots) {
      if (stop_requested) break;
      if (!a_.again && is_done(p, false)) continue;
      const auto start = std::chrono::steady_clock::now();
      const auto plot = make_plot(p, size_, folder_, stop_requested);
      if (!plot) break;
      PlotRecord record{plot_key(p), size_, 0, *plot};
      record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      results_.plots[p.name] = record;
      ++made;
    }
    return made;
  }

  bool render(const GalleryFigure& f, const GalleryPicture& p) {
    const PictureEffort& effort = p.effort[size_];
    fs::path state = exr(p);
    state.replace_extension(".state");
    TableProgressLine line(a_.quiet);
    const RenderedPicture r = render_picture(
        p, size_, a_.threads, state, stop_requested,
        [&](const Progress& now) { progress_.show(f.id, effort, now); },
        [&](const std::string& object, double part) { line.show(object, part); });
    if (!r.complete) return false;
    write_exr(exr(p), r.image, ExrPixel::float32, {});
    write_png(folder_ / (p.name + ".png"), toned(r.image, p.tone));
    results_.pictures[p.name] = {picture_key(p, size_), size_, r.samples, r.seconds, r.load_seconds, {}};
    results_.save(folder_ / "results.json");
    std::error_code ignored;
    fs::remove(state, ignored);
    if (r.invalid_samples > 0) {
      progress_.clear();
      tell("note: {}: {} samples were invalid and left out\n", p.name, r.invalid_samples);
    }
    progress_.done(effort, r.seconds + r.load_seconds);
    return true;
  }

  void write_page() const {
    GalleryResults valid;
    for (const GalleryFigure& f : gallery_.figures) {
      if (!f.missing.empty()) continue;
      for_pictures(f, [&](const GalleryPicture& p, const PictureTable&) {
        if (is_done(p, true)) valid.pictures[p.name] = results_.pictures.at(p.name);
      });
      for (const GalleryPlot& p : f.plots)
        if (is_done(p, true)) valid.plots[p.name] = results_.plots.at(p.name);
    }
    write_file_atomically(folder_ / "index.html", gallery_page(gallery_, valid, command_));
  }

  const Arguments& a_;
  GallerySize size_;
  Gallery gallery_;
  std::vector<const GalleryFigure*> chosen_;
  fs::path folder_;
  std::optional<OutputLock> lock_;  ///< lock of the page
  GalleryResults results_;
  GalleryProgress progress_;
  std::string command_;
};

int gallery(const Arguments& a) {
  if (a.size != "preview" && a.size != "full")
    throw Error(fmt::format("--size {}: write preview or full", a.size));
  if (a.threads < 0 || a.threads > 4096)
    throw Error(fmt::format("--threads {}: must be between 1 and 4096 (0: all cores)", a.threads));
  if (a.name.empty() || a.name.find('/') != std::string::npos)
    throw Error(fmt::format("\"{}\": write the name of a folder of scenes, such as corona", a.name));
  GalleryRun run(a, a.size == "full" ? kFullSize : kPreviewSize);
  std::signal(SIGINT, request_gallery_stop);
  std::signal(SIGTERM, request_gallery_stop);
  std::signal(SIGHUP, request_gallery_stop);
  return run.run();
}

std::function<int()> declare(CommandOptions& options) {
  auto a = std::make_shared<Arguments>();
  options.add("name", a->name, "name of a folder of scenes, such as corona").required();
  options.add("--size", a->size, "preview (minutes) or full (an hour)").shows_default();
  options.add("-o,--output", a->output, "folder of the page (default: gallery-NAME)");
  options.add("--only", a->only, "figures, separated by commas, such as fig08,fig09").separated_by(',');
  options.add("--scenes", a->scenes, "parent of that folder").shows_default();
  options.add("--threads", a->threads, "number of threads (default: all cores)");
  add_cache_option(options);
  options.add("--again", a->again, "also render figures that are already done");
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return gallery(*a); };
}

AUREOLE_COMMAND("gallery", "Render the figures of scenes/NAME/gallery.json and write a page that shows them",
                declare);

}  // namespace
}  // namespace aureole
