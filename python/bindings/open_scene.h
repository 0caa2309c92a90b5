// SPDX-License-Identifier: Apache-2.0
// A scene as Python holds it.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/loading/document.h"
#include "loading_signals.h"
#include "objects.h"
#include "unlocked.h"

namespace aureole::python {

/// A scene that may be changed while its earlier states are rendered.
class OpenScene {
public:
  using Given = std::map<std::string, ObjectPtr>;

  OpenScene(const std::filesystem::path& file, const LoadOptions& options)
      : document_(file, heard_by(*progress_, options)) {
    loaded_first();
  }
  OpenScene(const std::string& text, const std::filesystem::path& file, const LoadOptions& options)
      : document_(text, file, heard_by(*progress_, options)) {
    loaded_first();
  }
  OpenScene(const OpenScene&) = delete;
  OpenScene& operator=(const OpenScene&) = delete;

  /// Reads the document while no other thread changes it. Python's lock is held, but not while waiting for
  /// the document: the thread that changes it may need Python's lock to finish.
  template <class F>
  auto read(const F& f) {
    const Held held(*this);
    return f(document_);
  }
  LoadedScene loaded() {
    return read([](const SceneDocument& d) { return d.loaded(); });
  }
  /// The scene as it is loaded for denoising.
  LoadedScene for_denoising() {
    const Held held(*this);
    const Unlocked unlocked;
    return document_.for_denoising();
  }
  std::shared_ptr<const Scene> scene() {
    return read([](const SceneDocument& d) { return d.scene(); });
  }
  void set(const std::vector<std::pair<std::string, std::string>>& changes, const Given& given) {
    const Held held(*this);
    changing_ = true;
    struct End {
      bool& changing;
      ~End() { changing = false; }
    } end{changing_};
    const Unlocked unlocked;
    const LoadingSignals signals;
    *progress_ = signals.progress();
    signals.run([&] {
      document_.edit(changes, given);
      return 0;
    });
    remember_lights(document_.scene());
  }

private:
  struct Held {
    explicit Held(OpenScene& scene) : lock(scene.mutex_, std::try_to_lock) {
      if (!lock) {
        const Unlocked unlocked;
        lock.lock();
      }
      // Only code that runs during a change in the same thread sees this, such as __del__.
      if (scene.changing_) throw Error("the scene is being changed: it can't be used until that is done");
    }
    std::unique_lock<std::recursive_mutex> lock;
  };

  /// Options of a document whose tables are reported to `progress`, which may change between its edits.
  static LoadOptions heard_by(TableProgress& progress, const LoadOptions& options) {
    progress = options.progress;
    LoadOptions own = options;
    own.progress = [&progress](const std::string& object, double part) {
      if (progress) progress(object, part);
    };
    return own;
  }
  void loaded_first() { remember_lights(document_.scene()); }

  // By a pointer: the address stays. Before the document, which calls it while it is built.
  const std::unique_ptr<TableProgress> progress_ = std::make_unique<TableProgress>();
  SceneDocument document_;
  std::recursive_mutex mutex_;
  bool changing_ = false;
};

}  // namespace aureole::python
