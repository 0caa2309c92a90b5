// SPDX-License-Identifier: Apache-2.0
// Tables of an object that are kept on disc (`Properties::shared_model`).
#include <bit>
#include <chrono>

#include "aureole/core/table_cache.h"
#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"

namespace aureole {

struct Properties::KeptTableOfObject::State {
  const Properties& properties;
  TableCache& cache;
  std::optional<TableKey> key;  ///< empty: what the table is made of is not known
  bool is_of_object = false;    ///< whether the table depends on all parameters of the object
  KeptTable found;
  std::vector<std::pair<std::string, std::string>> notes;
  std::size_t notes_before = 0;
  std::chrono::steady_clock::time_point begun{};

  std::size_t notes_now() const {
    const Diagnostics* diagnostics = properties.context().diagnostics;
    return diagnostics ? diagnostics->notes().size() : 0;
  }
  void pass_notes_on() const {
    for (const std::string& note : cache.take_notes())
      if (Diagnostics* diagnostics = properties.context().diagnostics) diagnostics->note({}, note);
  }
};

Properties::KeptTableOfObject::KeptTableOfObject(const Properties& p, const TableKind& kind,
                                                 const std::vector<double>* numbers)
    : state_(new State{p, *p.context().tables, {}, !numbers, {}, {}, 0, {}}) {
  std::optional<WideHashValue> inputs;
  if (numbers) {
    WideHash hash;
    hash.number(numbers->size());
    for (const double number : *numbers) hash.number(std::bit_cast<std::uint64_t>(number));
    inputs = hash.value();
  } else if (p.context().scene) {
    inputs = p.context().scene->inputs_of_object();
  }
  if (!inputs) return;
  const std::string family = p.plugin() ? p.plugin()->family + " " : "";
  state_->key = TableKey{kind.name, kind.version, *inputs, family + p.type()};
}

Properties::KeptTableOfObject::~KeptTableOfObject() {
  state_->properties.making_.notes = nullptr;
  state_->pass_notes_on();
}

std::optional<std::span<const char>> Properties::KeptTableOfObject::find() {
  if (!state_->key) return {};
  std::optional<KeptTable> found = state_->cache.find(*state_->key);
  if (!found) return {};
  state_->found = std::move(*found);
  return std::span<const char>(state_->found.bytes);
}

void Properties::KeptTableOfObject::accept() {
  // Equal objects have equal parameters in equal order.
  const std::vector<Entry>& entries = state_->properties.entries_;
  for (const std::uint32_t i : state_->found.reads)
    if (i < entries.size()) entries[i].used = true;
  for (const auto& [name, message] : state_->found.notes) state_->properties.note(name, message);
}

void Properties::KeptTableOfObject::refuse() { state_->cache.refuse(*state_->key); }

void Properties::KeptTableOfObject::begin() {
  state_->pass_notes_on();
  state_->notes_before = state_->notes_now();
  state_->properties.making_.notes = &state_->notes;
  state_->begun = std::chrono::steady_clock::now();
}

bool Properties::KeptTableOfObject::is_wanted() const {
  return state_->key && state_->notes_now() - state_->notes_before <= state_->notes.size();
}

void Properties::KeptTableOfObject::keep(std::vector<char> bytes) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - state_->begun;
  std::vector<std::uint32_t> reads;
  if (state_->is_of_object)
    for (std::size_t i = 0; i < state_->properties.entries_.size(); ++i)
      if (state_->properties.entries_[i].used) reads.push_back(std::uint32_t(i));
  state_->cache.keep(*state_->key, {std::move(bytes), std::move(reads), std::move(state_->notes)},
                     spent.count());
}

}  // namespace aureole
