// SPDX-License-Identifier: Apache-2.0
// `Properties`: the named, typed and located parameters from which a plug-in is made. Reading a parameter
// checks its type and range, marks it as used, and throws an `Error` that names the position in the scene
// file.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/random.h"
#include "aureole/core/table_fields.h"
#include "aureole/core/word_hash.h"
#include "aureole/math/motion.h"
#include "aureole/plugin/model_cache.h"
#include "aureole/plugin/object.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class TableCache;
struct ParameterDoc;
struct PluginInfo;

/// Gives an object under construction access to the other objects of the scene.
class SceneLookup {
public:
  virtual ~SceneLookup() = default;
  /// Returns the object with that id of a family ("bsdf"), building it if necessary; null if there is none.
  virtual ObjectPtr find(std::string_view family, const std::string& id) = 0;
  /// Declares a file that no parameter names, so that its content becomes part of the scene's hash.
  virtual void add_file(const std::filesystem::path& file) = 0;
  /// Returns a hash of all that the object under construction is made from, with the content of files that its
  /// parameters name; nothing where that is not known.
  virtual std::optional<WideHashValue> inputs_of_object() { return {}; }
};

/// Settings of a scene with which its objects are built.
struct BuildContext {
  SpectralGrid grid;           ///< wavelength grid of the sensor
  double length_unit_m = 1.0;  ///< metres per scene unit
  /// Default of the parameter `energy_preserving` of rough BSDFs; empty: the scene states none.
  std::optional<bool> energy_preserving;
  Diagnostics* diagnostics = nullptr;  ///< receives notes; may be null
  SceneLookup* scene = nullptr;        ///< null outside of a scene and after it is built
  std::shared_ptr<ModelCache> models;  ///< tables that equal objects share; null: nothing is shared
  std::shared_ptr<TableCache> tables;  ///< tables of earlier programs; null: none are kept
};

/// A spectrum as written in a scene file. The parameter for which it is given decides its meaning
/// (reflectance, emission).
struct SpectrumLiteral {
  enum class Kind { value, rgb, points } kind = Kind::value;
  double value = 0;                ///< value of Kind::value
  double rgb[3] = {0, 0, 0};       ///< value of Kind::rgb, linear sRGB
  std::vector<double> nm, values;  ///< points of Kind::points, with nm increasing
  /// for Kind::points, whether the unit of the wavelengths is stated instead of assumed
  bool unit_is_stated = false;
};

/// A closed or half-open interval that must contain a number.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;  ///< whether min itself is excluded

  static Range positive() { return {0, std::numeric_limits<double>::infinity(), true}; }
  static Range non_negative() { return {0}; }
  static Range unit() { return {0, 1}; }
};

/// A constant of type T that its copies share, so that a variant with a large alternative stays small.
template <class T>
class Shared {
public:
  Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}
  const T& operator*() const { return *value_; }

private:
  std::shared_ptr<const T> value_;
};

/// `Object` shares properties that a std::shared_ptr owns and copies others.
class Properties : public std::enable_shared_from_this<Properties> {
public:
  using Value = std::variant<bool, std::int64_t, double, std::string, Vec3, Shared<Transform>,
                             Shared<SpectrumLiteral>, ObjectPtr, Shared<Motion>>;
  /// Returns the value if it has that type, or null.
  static const Transform* transform_of(const Value& value) { return get_if_shared<Transform>(value); }
  static const Motion* motion_of(const Value& value) { return get_if_shared<Motion>(value); }
  static const SpectrumLiteral* spectrum_of(const Value& value) {
    return get_if_shared<SpectrumLiteral>(value);
  }
  struct Entry {
    std::string name;  ///< name of the parameter; empty for unnamed child objects
    Value value;
    SourceLocation where;
    mutable bool used = false;
  };

  Properties(std::string type, std::string id, SourceLocation where,
             std::shared_ptr<const BuildContext> context, const PluginInfo* plugin = nullptr);

  const std::string& type() const { return type_; }
  const std::string& id() const { return id_; }
  const SourceLocation& where() const { return where_; }
  const BuildContext& context() const { return *context_; }
  const std::shared_ptr<const BuildContext>& shared_context() const { return context_; }
  const PluginInfo* plugin() const { return plugin_; }
  /// Sets a hash of everything written for the object except its name and id; 0: unknown.
  void set_content(std::uint64_t hash) { content_ = hash; }
  /// Returns the hash set by `set_content`; 0 where it is not known.
  std::uint64_t content() const { return content_; }

  /// For a shape: sorted names of the attributes that textures on it use. The shape's reader keeps only
  /// these.
  const std::vector<std::string>& shown_attributes() const { return shown_attributes_; }
  void set_shown_attributes(std::vector<std::string> names) { shown_attributes_ = std::move(names); }

  /// Allocates memory for `count` parameters.
  void reserve(std::size_t count) { entries_.reserve(count); }
  /// Adds a parameter. Throws Error at `where` if the name is taken.
  void add(std::string name, Value value, SourceLocation where);
  const std::vector<Entry>& entries() const { return entries_; }

  /// Whether the parameter is present; does not mark it as used.
  bool has(std::string_view name) const;
  /// Returns the entry and marks it as used, or null; for readers that accept several types (textures).
  const Entry* find(std::string_view name) const;

  // Typed readers. The two-argument forms have a default; the one-argument forms require the parameter.
  bool get_bool(std::string_view name, bool fallback) const;
  std::int64_t get_int(std::string_view name, std::int64_t fallback, Range range = {}) const;
  double get_float(std::string_view name, double fallback, Range range = {}) const;
  double get_float(std::string_view name, Range range) const;
  std::string get_string(std::string_view name, const std::string& fallback) const;
  std::string get_string(std::string_view name) const;
  /// Returns one of `allowed`; otherwise throws an Error that lists them.
  std::string get_choice(std::string_view name, const std::string& fallback,
                         const std::vector<std::string>& allowed) const;
  Vec3 get_vec3(std::string_view name, const Vec3& fallback) const;
  /// Returns the identity if absent; a singular transform is an Error.
  Transform get_transform(std::string_view name) const;
  /// Returns a transform or an animation; the identity if absent. Its key frames are invertible and keep the origin
  /// within the range of rays, otherwise there is an Error.
  Motion get_motion(std::string_view name) const;
  /// A physical length in metres. The file must give a string with a unit ("5um"); for a plain number an
  /// Error asks for the unit.
  double get_length_m(std::string_view name, double fallback_m, Range range = Range::positive()) const;
  /// The absolute path (the scene reader resolves it) of an existing, readable file.
  std::filesystem::path get_file(std::string_view name) const;

  /// Returns the object given under `name`, or null. An object of the wrong family is an Error.
  template <class T>
  std::shared_ptr<T> get_object(std::string_view name) const {
    const Entry* e = find(name);
    return e ? cast<T>(*e) : nullptr;
  }
  /// Returns all child objects of family T, in order and whatever their names, that no other reader has
  /// taken. `documented_name` is the row of the parameter table that describes them.
  template <class T>
  std::vector<std::shared_ptr<T>> get_children(std::string_view documented_name) const {
    require_documented(documented_name);
    std::vector<std::shared_ptr<T>> found;
    for (const Entry& e : entries_)
      if (!e.used && std::holds_alternative<ObjectPtr>(e.value))
        if (auto p = std::dynamic_pointer_cast<T>(std::get<ObjectPtr>(e.value)))
          e.used = true, found.push_back(p);
    return found;
  }

  /// Returns an Error located at the parameter, or at the object if the parameter is absent.
  [[nodiscard]] Error error(std::string_view name, const std::string& message) const;
  /// Emits a note to the user about a parameter that is accepted but has no effect here.
  void note(std::string_view name, const std::string& message) const;

  /// Returns tables that take long to compute and depend only on the parameters of the object, the
  /// wavelengths and the unit of length. They are shared with equal objects, or else made by `make`, which
  /// returns a std::shared_ptr<const T>. Null if the scene is known to have errors: nothing will be rendered,
  /// so that the user need not wait for tables. Tables with `kTable` (core/table_fields.h) are kept on disc, too; they must
  /// not depend on a file that no parameter names.
  template <class T, class Make>
  std::shared_ptr<const T> shared_model(Make&& make) const {
    if (!making_.problems.empty() || (context_->diagnostics && context_->diagnostics->has_errors()))
      return mark_documented_read(), nullptr;
    if (!context_->models || content_ == 0) return make();
    bool is_new = false;
    auto model = context_->models->get<T>(content_, [&] { return kept_or_made<T>({}, is_new, make); });
    if (!is_new) mark_documented_read();  // marks the parameters as read, as `make` did for the equal object
    return model;
  }

  /// Returns tables as the other `shared_model` does, for tables of type T that depend on the numbers of `key` alone:
  /// they are shared by objects that differ in their other parameters, such as colours.
  template <class T, class Make>
  std::shared_ptr<const T> shared_model(const std::vector<double>& key, Make&& make) const {
    if (!making_.problems.empty() || (context_->diagnostics && context_->diagnostics->has_errors()))
      return nullptr;
    if (!context_->models) return make();
    std::uint64_t content = key.size();
    for (const double number : key) content = combine_bits(content, std::bit_cast<std::uint64_t>(number));
    bool is_new = false;
    return context_->models->get<T>(content, [&] { return kept_or_made<T>(&key, is_new, make); });
  }

  /// Records that values of the parameter which are known only later, such as the values of a mesh attribute,
  /// must not exceed `maximum`. All copies of the properties share this record.
  void expect_at_most(std::string_view name, double maximum) const;
  /// The recorded maximum; infinite if there is none.
  double most_expected(std::string_view name) const;

  /// Returns the value of `read`, or `fallback` if `read` throws an Error while a plug-in is being made
  /// (`make`). The constructor then continues, so that all problems of an object are found at once, and the
  /// object is discarded.
  template <class T, class Read>
  T tolerate(T fallback, Read&& read) const {
    if (!making_.now) return read();
    try {
      return read();
    } catch (const Error& e) {
      making_.problems.push_back(e);
      return fallback;
    }
  }
  /// Calls `create`, the constructor of a plug-in. Throws the first problem with the parameters;
  /// `further_problems` returns the others.
  ObjectPtr make(const std::function<ObjectPtr(const Properties&)>& create) const;
  const std::vector<Error>& further_problems() const { return making_.problems; }

  /// Marks as read every parameter that was read from `part`, a copy of some of these parameters, for
  /// `report_unused` and `queried`. Also takes over its problems.
  void take_reads(const Properties& part) const;
  /// Marks all parameters as read, for an object that is reused and not built again.
  void mark_all_read() const;

  /// Reports every unread entry as an error, with a suggestion.
  void report_unused(Diagnostics& diagnostics) const;
  /// Names of the parameters queried so far, present or not. With a plug-in all of them are documented.
  std::vector<std::string> queried() const;

private:
  /// Reads a table that an earlier program has kept, or makes it and keeps it. `key`: the numbers that it depends on;
  /// null: the inputs of the object. Sets `is_new`: the parameters that the computation reads are marked as read.
  template <class T, class Make>
  std::shared_ptr<const T> kept_or_made(const std::vector<double>* key, bool& is_new, Make&& make) const {
    if constexpr (KeepableTable<T>) {
      if (context_->tables) {
        KeptTableOfObject kept(*this, T::kTable, key);
        if (const std::optional<std::span<const char>> bytes = kept.find()) {
          auto table = std::make_shared<T>();
          TableReader reader(*bytes);
          T::fields(*table, reader);
          if (reader.is_complete()) return kept.accept(), is_new = true, table;
          kept.refuse();
        }
        is_new = true;
        kept.begin();
        std::shared_ptr<const T> made = make();
        bool is_keepable = made && kept.is_wanted();
        if constexpr (requires(const T& t) { t.is_keepable(); })
          is_keepable = is_keepable && made->is_keepable();
        if (is_keepable) {
          TableWriter writer;
          T::fields(*made, writer);
          kept.keep(std::move(writer.bytes()));
        }
        return made;
      }
    }
    return is_new = true, make();
  }
  /// The entry of one table in the cache, while an object is constructed.
  class KeptTableOfObject {
  public:
    KeptTableOfObject(const Properties& properties, const TableKind& kind, const std::vector<double>* key);
    ~KeptTableOfObject();
    KeptTableOfObject(const KeptTableOfObject&) = delete;
    KeptTableOfObject& operator=(const KeptTableOfObject&) = delete;
    std::optional<std::span<const char>> find();
    /// Gives the notes again that the computation of the table gave, and marks the parameters that it had read.
    void accept();
    void refuse();  ///< the bytes are no such table
    void begin();   ///< the computation begins
    /// Whether a table that was computed can be kept: all that was noted meanwhile was noted by this object.
    bool is_wanted() const;
    void keep(std::vector<char> bytes);

  private:
    struct State;
    std::unique_ptr<State> state_;
  };
  template <class T>
  static const T* get_if_shared(const Value& value) {
    const auto* shared = std::get_if<Shared<T>>(&value);
    return shared ? &**shared : nullptr;
  }
  template <class T>
  std::shared_ptr<T> cast(const Entry& e) const {
    if (const auto* object = std::get_if<ObjectPtr>(&e.value))
      if (auto p = std::dynamic_pointer_cast<T>(*object)) return p;
    throw wrong_type(e, T::kFamily);
  }
  Error wrong_type(const Entry& e, std::string_view expected) const;
  void mark_documented_read() const;
  void require_documented(std::string_view name) const;
  double checked(const Entry& e, double value, Range range) const;

  std::string type_, id_;
  SourceLocation where_;
  std::shared_ptr<const BuildContext> context_;
  const PluginInfo* plugin_;
  std::uint64_t content_ = 0;
  std::vector<Entry> entries_;
  std::vector<std::string> shown_attributes_;
  mutable std::vector<const ParameterDoc*> queried_;  ///< rows of the plug-in that were queried
  /// names that were queried, if there is no plug-in
  mutable std::vector<std::string> queried_without_plugin_;
  /// State of the constructor that is running with these parameters. A copy starts with an empty state.
  struct Making {
    bool now = false;
    std::vector<Error> problems;
    /// receives name and message of each note while a table is made that will be kept; null: none is made
    std::vector<std::pair<std::string, std::string>>* notes = nullptr;

    Making() = default;
    Making(const Making&) {}
    Making& operator=(const Making&) { return *this = Making(); }
    Making(Making&&) = default;
    Making& operator=(Making&&) = default;
  };
  mutable Making making_;
  /// record of `expect_at_most`, shared by all copies
  std::shared_ptr<std::vector<std::pair<std::string, double>>> most_expected_;
};

}  // namespace aureole
