// SPDX-License-Identifier: Apache-2.0
// Parts of pictures from several machines. The public interface is in aureole/cluster.py.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <span>

#include "aureole/core/error.h"
#include "aureole/render/part.h"
#include "bindings.h"
#include "picture.h"

namespace aureole::python {

namespace {

std::span<const char> span_of(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }
nb::bytes bytes_of(const std::vector<char>& content) { return nb::bytes(content.data(), content.size()); }

const RenderState& state_of(const Picture& picture) {
  if (!picture.state) throw Error("picture: was not rendered here, so that it has no samples");
  return *picture.state;
}

/// A sum of parts with the first invalid samples of all parts, as `Picture` has them.
struct SumOfParts {
  explicit SumOfParts(const Picture& picture) : sum(state_of(picture)) {}

  PartSum sum;
  std::vector<std::array<std::int64_t, 4>> invalid;  ///< x, y, sample, replicate
};

}  // namespace

void bind_parts(nb::module_& m) {
  m.def(
      "packed_part",
      [](const Picture& picture) {
        const RenderState& state = state_of(picture);
        std::vector<char> packed;
        {
          const Unlocked release;
          packed = packed_part(state);
        }
        return bytes_of(packed);
      },
      nb::arg("picture"), "The samples of a picture, compressed for the journey to another machine.");
  nb::class_<SumOfParts>(m, "PartSum", "The sum of parts of a picture.")
      .def(nb::init<const Picture&>(), nb::arg("picture"))
      .def(
          "resume",
          [](SumOfParts& s, const nb::bytes& state, const std::string& where) {
            const std::span<const char> content = span_of(state);
            const Unlocked release;
            s.sum.resume(content, {where, 0, 0});
          },
          nb::arg("state"), nb::arg("where"), "Goes on from the content of a state file.")
      .def(
          "add",
          [](SumOfParts& s, const nb::bytes& packed, std::int64_t begin, std::int64_t end,
             const std::vector<std::array<std::int64_t, 4>>& invalid) {
            const std::span<const char> content = span_of(packed);
            const Unlocked release;
            s.sum.add(content, {begin, end});
            for (const auto& sample : invalid)
              if (s.invalid.size() < 16) s.invalid.push_back(sample);
          },
          nb::arg("packed"), nb::arg("begin"), nb::arg("end"), nb::arg("invalid"),
          "Adds a part that has the units from `begin` to `end` - 1. Throws Error for any other one.")
      .def(
          "check",
          [](const SumOfParts& s, const nb::bytes& packed, std::int64_t begin, std::int64_t end) {
            const std::span<const char> content = span_of(packed);
            const Unlocked release;
            s.sum.checked(content, {begin, end});
          },
          nb::arg("packed"), nb::arg("begin"), nb::arg("end"),
          "Throws Error where `add` does for a part alone.")
      .def(
          "unpacked",
          [](const SumOfParts& s, const nb::bytes& packed) {
            const std::span<const char> content = span_of(packed);
            auto picture = std::make_shared<Picture>();
            const Unlocked release;
            picture->state = std::make_shared<const RenderState>(s.sum.unpacked(content));
            return picture;
          },
          nb::arg("packed"), "A part to go on from, without pixels.")
      .def(
          "same_samples",
          [](const SumOfParts& s, const nb::bytes& a, const nb::bytes& b) {
            const std::span<const char> first = span_of(a), second = span_of(b);
            const Unlocked release;
            return same_samples(s.sum.unpacked(first), s.sum.unpacked(second));
          },
          nb::arg("a"), nb::arg("b"),
          "Whether two parts have the same bits, without the time that they took.")
      .def(
          "start",
          [](const SumOfParts& s) {
            std::vector<char> packed;
            {
              const Unlocked release;
              packed = packed_part(s.sum.start());
            }
            return bytes_of(packed);
          },
          "The picture without samples, compressed; densities of adaptive samples are kept.")
      .def(
          "state",
          [](const SumOfParts& s) {
            std::vector<char> content;
            {
              const Unlocked release;
              content = s.sum.state().to_bytes();
            }
            return bytes_of(content);
          },
          "The content of a state file.")
      .def("picture",
           [](const SumOfParts& s) {
             auto picture = std::make_shared<Picture>();
             const Unlocked release;
             picture->state = std::make_shared<const RenderState>(s.sum.state());
             picture->image = picture->state->picture();
             picture->invalid = s.invalid;
             return picture;
           })
      .def_prop_ro("units", [](const SumOfParts& s) { return s.sum.state().units(); })
      .def_prop_ro("is_adaptive",
                   [](const SumOfParts& s) { return s.sum.state().identity.adaptive != "none"; })
      .def_prop_ro("has_densities", [](const SumOfParts& s) { return !s.sum.state().density.empty(); })
      .def_prop_ro(
          "done",
          [](const SumOfParts& s) {
            std::vector<std::pair<std::int64_t, std::int64_t>> ranges;
            for (const UnitRanges::Range& r : s.sum.state().done.ranges())
              ranges.emplace_back(r.begin, r.end);
            return ranges;
          },
          "Ranges of the units that are done: the first, and one more than the last.");
}

}  // namespace aureole::python
