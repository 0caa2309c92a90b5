// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/object_pool.h"

#include <algorithm>
#include <filesystem>

#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// A number, made from size and time, that changes when the file is modified.
std::uint64_t stamp(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::uint64_t(std::filesystem::file_size(file, ignored)) * 0x9e3779b97f4a7c15u +
         std::uint64_t(std::filesystem::last_write_time(file, ignored).time_since_epoch().count());
}

}  // namespace

/// Provides the geometry of one element.
class ObjectPool::Source final : public GeometrySource {
public:
  Source(ObjectPool& pool, std::uint64_t key) : pool_(pool), key_(key) {}

  ObjectPtr geometry(const PluginInfo& plugin, const Properties& properties) override {
    if (take(properties, [](const Entry& e) { return e.shape != nullptr; })) {
      properties.mark_all_read();
      return std::const_pointer_cast<Shape>(entry_->shape);
    }
    ObjectPtr made = plugin.create(properties);
    entry_ = &pool_.add_entry(key_, properties.shown_attributes());
    entry_->shape = std::dynamic_pointer_cast<const Shape>(made);
    return made;
  }
  std::shared_ptr<const MeshParts> parts(const Properties& geometry) override {
    return take(geometry, [](const Entry& e) { return e.parts != nullptr; }) ? entry_->parts : nullptr;
  }
  void keep(const Properties&, const std::shared_ptr<const MeshParts>& parts) override {
    entry_->parts = parts, entry_->shape = nullptr;
  }
  std::shared_ptr<const AreaSampler> area_sampler(const ShapePtr& shape, AreaUse use) override {
    auto& kept = entry_->samplers[use == AreaUse::emitter ? 0 : 1];
    if (!kept) kept = shape->make_area_sampler(use);
    return kept;
  }
  BsdfPtr material(const Properties& geometry, const std::string& name,
                   const MtlMaterial& material) override {
    Material& kept = entry_->materials[name];
    std::vector<std::uint64_t> files;
    for (const MtlMap* map : material.maps()) files.push_back(stamp(map->file));
    if (!kept.bsdf || !(kept.made_of == material) || kept.files != files)
      kept = {material, files, GeometrySource::material(geometry, name, material)};
    return kept.bsdf;
  }

private:
  template <class Accept>
  bool take(const Properties& properties, const Accept& accept) {
    const auto found = pool_.shapes_.find(key_);
    if (found == pool_.shapes_.end()) return false;
    auto& [entries, taken] = found->second;
    while (taken < entries.size() && entries[taken]->taken) ++taken;
    for (std::size_t i = taken; i < entries.size(); ++i)
      if (Entry& e = *entries[i]; !e.taken && e.attributes == properties.shown_attributes() && accept(e)) {
        entry_ = &e;
        return entry_->taken = true;
      }
    return false;
  }

  ObjectPool& pool_;
  const std::uint64_t key_;
  Entry* entry_ = nullptr;
};

bool ObjectPool::keeps(const std::string& family) {
  const FamilyInfo* info = Registry::instance().family(family);
  return info && info->is_reusable;
}

void ObjectPool::begin(const BuildContext& context) {
  if (!(context.grid == grid_) || context.length_unit_m != length_unit_m_ ||
      context.energy_preserving != energy_preserving_)
    objects_.clear(), shapes_.clear();
  grid_ = context.grid, length_unit_m_ = context.length_unit_m;
  energy_preserving_ = context.energy_preserving;
  for (auto& [key, equal] : shapes_) {
    equal.taken = 0;
    for (const auto& e : equal.entries) e->taken = false;
  }
}

ObjectPtr ObjectPool::find(std::uint64_t key) const {
  const auto found = objects_.find(key);
  return found == objects_.end() ? nullptr : found->second;
}

std::unique_ptr<GeometrySource> ObjectPool::geometry_source(std::uint64_t key) {
  return std::make_unique<Source>(*this, key);
}

ObjectPool::Entry& ObjectPool::add_entry(std::uint64_t key, const std::vector<std::string>& attributes) {
  Entry& entry = *shapes_[key].entries.emplace_back(std::make_unique<Entry>());
  entry.attributes = attributes;
  return entry;
}

bool ObjectPool::Entry::is_unused() const {
  if (!parts) return shape.use_count() <= 1;
  return std::all_of(parts->shapes.begin(), parts->shapes.end(),
                     [](const ShapePtr& part) { return part.use_count() <= 1; });
}

void ObjectPool::trim() {
  for (auto& [key, equal] : shapes_) {
    equal.taken = 0;
    std::erase_if(equal.entries, [](const auto& e) { return e->is_unused(); });
    for (const auto& e : equal.entries) {
      for (auto& sampler : e->samplers)
        if (sampler.use_count() == 1) sampler = nullptr;
      std::erase_if(e->materials, [](const auto& m) { return m.second.bsdf.use_count() <= 1; });
    }
  }
  std::erase_if(shapes_, [](const auto& keyed) { return keyed.second.entries.empty(); });
  // Releasing one object may release others of the pool: repeats until nothing changes.
  while (std::erase_if(objects_, [](const auto& e) { return e.second.use_count() == 1; }) > 0) {
  }
}

}  // namespace aureole
