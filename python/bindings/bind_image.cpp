// SPDX-License-Identifier: Apache-2.0
// Pictures. The public interface is in aureole/_image.py.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/lightfield/light_field.h"
#include "aureole/instrument/picture/convert_picture.h"
#include "aureole/render/output.h"
#include "aureole/render/sample_density.h"
#include "bindings.h"
#include "picture.h"
#include "text.h"

namespace aureole::python {

namespace {

constexpr std::uint64_t kMaxGridBytes = std::uint64_t(1) << 38;

using Pixels = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using PixelView = nb::ndarray<nb::numpy, const float, nb::ndim<3>, nb::c_contig>;

std::shared_ptr<Picture> from_array(const Pixels& pixels, const std::vector<std::string>& channels) {
  if (pixels.shape(2) != channels.size())
    throw Error("channels: expected " + std::to_string(pixels.shape(2)) + " names, got " +
                std::to_string(channels.size()));
  constexpr std::size_t kLargest = 1 << 24;
  if (pixels.shape(0) > kLargest || pixels.shape(1) > kLargest) throw Error("array: too large for a picture");
  auto picture = std::make_shared<Picture>();
  Image& image = picture->image;
  image.width = int(pixels.shape(1)), image.height = int(pixels.shape(0));
  image.channels = channels;
  image.pixels.assign(pixels.data(), pixels.data() + pixels.size());
  return picture;
}

/// R, G, B of the picture in linear sRGB: of a rendered picture by the film's colours, else of the channels
/// R, G, B or Y.
Image linear_rgb(const Picture& p) {
  if (p.state) return p.state->rgb_picture();
  Image rgb{p.image.width, p.image.height, {"R", "G", "B"}, {}, false};
  int from[3] = {p.image.channel("R"), p.image.channel("G"), p.image.channel("B")};
  if (from[0] < 0 || from[1] < 0 || from[2] < 0) from[0] = from[1] = from[2] = p.image.channel("Y");
  if (from[0] < 0) throw Error("a picture without the channels R, G, B or Y has no colours to show");
  rgb.pixels.reserve(std::size_t(rgb.width) * rgb.height * 3);
  for (int y = 0; y < rgb.height; ++y)
    for (int x = 0; x < rgb.width; ++x)
      for (const int c : from) {
        const float v = p.image.at(x, y, std::size_t(c));
        rgb.pixels.push_back(p.image.srgb_encoded ? srgb_decode(v) : v);
      }
  return rgb;
}

Image display(const Picture& p, double exposure) {
  Image rgb = linear_rgb(p);
  if (exposure != 0) {
    const float gain = float(std::exp2(exposure));
    for (float& v : rgb.pixels) v *= gain;
  }
  return display_picture(std::move(rgb));
}

/// Files order channels by name; colours come first here, as R, G, B, A.
Image in_order_of_colors(Image image) {
  std::vector<std::size_t> from;
  for (const char* name : {"R", "G", "B", "A"})
    if (const int c = image.channel(name); c >= 0) from.push_back(std::size_t(c));
  for (std::size_t c = 0; c < image.channel_count(); ++c)
    if (std::find(from.begin(), from.end(), c) == from.end()) from.push_back(c);
  Image ordered = image;
  for (std::size_t c = 0; c < from.size(); ++c) ordered.channels[c] = image.channels[from[c]];
  for (std::size_t i = 0; i < image.pixels.size(); i += from.size())
    for (std::size_t c = 0; c < from.size(); ++c) ordered.pixels[i + c] = image.pixels[i + from[c]];
  return ordered;
}

void save(const Picture& p, const std::filesystem::path& file, double exposure) {
  require_writable(file);
  const std::string extension = lower_extension(file);
  if (extension == ".png") return write_png(file, display(p, exposure));
  if (p.state) {
    require_format(p.state->development, p.state->identity.replicates, file);
    return write_picture(*p.state, p.image, file);
  }
  if (extension == ".exr") return write_exr(file, p.image, ExrPixel::float32, p.attributes);
  if (extension == ".hdr" || extension == ".rgbe") return write_hdr(file, linear_rgb(p));
  if (extension == ".pfm") return write_pfm(file, linear_rgb(p));
  throw Error("path: expected a file name that ends with .exr, .png, .hdr or .pfm, got \"" + file.string() +
              "\"");
}

/// A picture of other channels with the header of `of`, whose attribute aureole:edits says what was done.
std::shared_ptr<Picture> edited(const Picture& of, const Pixels& pixels,
                                const std::vector<std::string>& channels, const std::string& edit) {
  auto picture = from_array(pixels, channels);
  picture->attributes = of.state ? picture_attributes(*of.state) : of.attributes;
  std::string& edits = picture->attributes.strings["aureole:edits"];
  edits += (edits.empty() ? "" : "; ") + edit;
  picture->invalid = of.invalid;
  picture->image.notes = of.image.notes;
  return picture;
}

/// The pixels as an array that keeps the picture alive.
nb::object view(const Image& image, const nb::handle& owner) {
  const std::size_t shape[3] = {std::size_t(image.height), std::size_t(image.width), image.channel_count()};
  return nb::cast(PixelView(image.pixels.data(), 3, shape, owner));
}

/// An array of its own.
nb::object moved(Image image) {
  auto* kept = new Image(std::move(image));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Image*>(p); });
  return view(*kept, owner);
}

/// The content of a picture for pickle: width, height, channels, pixels, whether they are encoded, the state as a
/// file or nothing, invalid samples, notes, and the attributes of the EXR that it was read from.
using PictureParts =
    std::tuple<int, int, std::vector<std::string>, nb::bytes, bool, nb::bytes,
               std::vector<std::array<std::int64_t, 4>>, std::vector<std::string>,
               std::map<std::string, std::string>, std::map<std::string, int>, std::map<std::string, float>>;

PictureParts parts_of(const Picture& p) {
  const std::vector<char> state = p.state ? p.state->to_bytes() : std::vector<char>();
  const auto* pixels = reinterpret_cast<const char*>(p.image.pixels.data());
  return {p.image.width,
          p.image.height,
          p.image.channels,
          nb::bytes(pixels, p.image.pixels.size() * sizeof(float)),
          p.image.srgb_encoded,
          nb::bytes(state.data(), state.size()),
          p.invalid,
          p.image.notes,
          p.attributes.strings,
          p.attributes.integers,
          p.attributes.floats};
}

Picture picture_of(const PictureParts& parts) {
  const auto& [width, height, channels, pixels, encoded, state, invalid, notes, strings, integers, floats] =
      parts;
  Picture p;
  const std::size_t count = pixels.size() / sizeof(float);
  const double expected = double(width) * double(height) * double(channels.size());
  if (width < 1 || height < 1 || channels.empty() || expected != double(count))
    throw Error("this is no pickled picture: its size is not that of its pixels");
  p.image = {width, height, channels, std::vector<float>(count), encoded};
  std::memcpy(p.image.pixels.data(), pixels.c_str(), count * sizeof(float));
  if (state.size() > 0)
    p.state = std::make_shared<const RenderState>(
        RenderState::from_bytes({state.c_str(), state.size()}, {"pickled picture", 0, 0}));
  p.invalid = invalid;
  p.image.notes = notes;
  p.attributes = {strings, integers, floats};
  return p;
}

}  // namespace

void bind_image(nb::module_& m) {
  m.def(
      "read_file",
      [](const std::filesystem::path& file) {
        std::string content;
        {
          const Unlocked release;
          content = read_text_file(file, kMaxGridBytes);
        }
        return nb::bytes(content.data(), content.size());
      },
      nb::arg("file"));
  m.def(
      "write_file",
      [](const std::filesystem::path& file, const nb::bytes& content) {
        const std::span<const char> bytes(content.c_str(), content.size());
        const Unlocked release;
        require_writable(file);
        write_file_atomically(file, bytes);
      },
      nb::arg("file"), nb::arg("content"));
  nb::class_<Picture>(m, "Picture", "Pixels, and what a render of them continues from.")
      .def_static("from_array", from_array, nb::arg("pixels"), nb::arg("channels"))
      .def_static(
          "read",
          [](const std::filesystem::path& file) {
            auto picture = std::make_shared<Picture>();
            {
              const Unlocked release;
              picture->image = in_order_of_colors(read_image(file, &picture->attributes));
            }
            for (const std::string& name : picture->image.channels)
              if (!is_utf8(name))
                throw Error({file.string(), 0, 0}, "the name of the channel " + name + " is not UTF-8");
            return picture;
          },
          nb::arg("file"))
      .def("edited", edited, nb::arg("pixels"), nb::arg("channels"), nb::arg("edit"))
      .def("__getstate__", parts_of)
      .def("__setstate__", [](Picture& p, const PictureParts& parts) { new (&p) Picture(picture_of(parts)); })
      .def_prop_ro("array",
                   [](nb::handle_t<Picture> self) { return view(nb::cast<Picture&>(self).image, self); })
      .def_prop_ro("channels", [](const Picture& p) { return p.image.channels; })
      .def_prop_ro("srgb_encoded", [](const Picture& p) { return p.image.srgb_encoded; })
      .def_prop_ro("meanings",
                   [](const Picture& p) {
                     nb::dict d;
                     const std::string attribute = p.channel_meanings();
                     for (const std::string& name : p.image.channels)
                       if (const std::string meaning = channel_meaning(attribute, name); !meaning.empty())
                         d[decoded(name)] = decoded(meaning);
                     return d;
                   })
      .def_prop_ro("light_field",
                   [](const Picture& p) { return decoded(p.file_attribute(kLightFieldAttribute)); })
      .def_prop_ro("notes", [](const Picture& p) { return p.image.notes; })
      .def_prop_ro("invalid", [](const Picture& p) { return p.invalid; })
      .def_prop_ro("facts",
                   [](const Picture& p) {
                     nb::dict d;
                     if (!p.state) return d;
                     const RenderState& s = *p.state;
                     d["scene"] = file_name(s.identity.scene);
                     d["scene_hash"] = s.identity.scene_hash;
                     d["seed"] = s.identity.seed;
                     d["sampler"] = s.identity.sampler;
                     d["adaptive"] = s.identity.adaptive;
                     d["mean_density"] = mean_density(s.density);
                     d["integrator"] = s.identity.integrator;
                     d["version"] = s.identity.version;
                     d["replicates"] = s.identity.replicates;
                     d["samples"] = s.samples_everywhere();
                     d["samples_asked"] = s.end - s.begin;
                     d["part"] = double(s.units_done()) / double(s.units());
                     d["invalid_samples"] = s.invalid_samples;
                     d["seconds"] = s.seconds;
                     d["approximations"] = s.approximations;
                     return d;
                   })
      .def("rgb", [](const Picture& p) { return moved(linear_rgb(p)); })
      .def(
          "display", [](const Picture& p, double exposure) { return moved(display(p, exposure)); },
          nb::arg("exposure"))
      .def(
          "png",
          [](const Picture& p, double exposure) {
            const std::vector<char> bytes = encode_png(display(p, exposure));
            return nb::bytes(bytes.data(), bytes.size());
          },
          nb::arg("exposure"))
      .def(
          "save",
          [](const Picture& p, const std::filesystem::path& file, double exposure) {
            const Unlocked release;
            save(p, file, exposure);
          },
          nb::arg("file"), nb::arg("exposure"));

  m.def(
      "convert_picture",
      [](const std::filesystem::path& file, const std::filesystem::path& output,
         const std::string& subtrahend, const std::string& kind, const std::string& channel,
         const std::optional<std::array<int, 4>>& crop, double exposure, const std::string& tone,
         const std::string& map, std::optional<double> low, std::optional<double> high, bool is_logarithmic,
         int contours, int bits, int quality) {
        const Unlocked release;
        ConvertSettings s;
        s.subtrahend = subtrahend;
        s.difference = kind == "plain"      ? PictureDifference::plain
                       : kind == "relative" ? PictureDifference::relative
                                            : PictureDifference::absolute;
        s.channel = channel, s.crop = crop, s.exposure = exposure;
        if (!tone.empty()) s.tone = Tone::parse(tone);
        s.is_false_color = !map.empty(), s.map = map;
        s.low = low, s.high = high, s.is_logarithmic = is_logarithmic, s.contours = contours;
        s.bits = bits, s.quality = quality;
        return convert_picture(file, output, s).notes;
      },
      nb::arg("file"), nb::arg("output"), nb::arg("subtrahend"), nb::arg("kind"), nb::arg("channel"),
      nb::arg("crop").none(), nb::arg("exposure"), nb::arg("tone"), nb::arg("map"), nb::arg("low").none(),
      nb::arg("high").none(), nb::arg("is_logarithmic"), nb::arg("contours"), nb::arg("bits"),
      nb::arg("quality"));
  m.def("color_scale_maps", &color_scale_maps);
}

}  // namespace aureole::python
