// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfEnvmap.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "aureole/core/error.h"
#include "aureole/core/exr_header.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

class MemoryInput final : public Imf::IStream {
public:
  explicit MemoryInput(Bytes bytes) : IStream("image"), bytes_(bytes) {}
  bool read(char to[], int n) override {
    if (n < 0 || std::uint64_t(n) > bytes_.size() - position_) throw Error("the file is truncated");
    std::memcpy(to, bytes_.data() + position_, std::size_t(n));
    position_ += std::uint64_t(n);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override {
    if (position > bytes_.size()) throw Error("the file is truncated");
    position_ = position;
  }

private:
  Bytes bytes_;
  std::uint64_t position_ = 0;
};

class MemoryOutput final : public Imf::OStream {
public:
  MemoryOutput() : OStream("image") {}
  void write(const char from[], int n) override {
    if (position_ + std::uint64_t(n) > bytes.size()) bytes.resize(position_ + std::uint64_t(n));
    std::memcpy(bytes.data() + position_, from, std::size_t(n));
    position_ += std::uint64_t(n);
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }

  std::vector<char> bytes;

private:
  std::uint64_t position_ = 0;
};

void read_attributes(const Imf::Header& header, ExrAttributes& out) {
  for (auto i = header.begin(); i != header.end(); ++i) {
    const Imf::Attribute& a = i.attribute();
    if (const auto* s = dynamic_cast<const Imf::StringAttribute*>(&a)) out.strings[i.name()] = s->value();
    if (const auto* n = dynamic_cast<const Imf::IntAttribute*>(&a)) out.integers[i.name()] = n->value();
    if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(&a)) out.floats[i.name()] = f->value();
  }
}

bool is_near(const Imath::V2f& a, const Imath::V2f& b) {
  return std::abs(a.x - b.x) < 5e-4f && std::abs(a.y - b.y) < 5e-4f;
}

std::string text(const Imath::V2f& v) { return fmt::format("({:.4g}, {:.4g})", v.x, v.y); }

/// Sets the matrix from the file's primaries to sRGB. It preserves XYZ, as in Mitsuba and in the definition of the
/// format: colours are not adapted to another white point.
void read_chromaticities(const Imf::Header& header, Image& image) {
  if (!Imf::hasChromaticities(header)) return;
  const Imf::Chromaticities stored = Imf::chromaticities(header), srgb;
  image.primaries = "sRGB";
  if (is_near(stored.red, srgb.red) && is_near(stored.green, srgb.green) && is_near(stored.blue, srgb.blue) &&
      is_near(stored.white, srgb.white))
    return;
  const std::string names = fmt::format("red {}, green {}, blue {}, white {}", text(stored.red),
                                        text(stored.green), text(stored.blue), text(stored.white));
  image.primaries = names;
  // The Imath matrix multiplies row vectors from the right.
  const Imath::M44f m = Imf::RGBtoXYZ(stored, 1) * Imf::XYZtoRGB(srgb, 1);
  std::array<float, 9> rows;
  bool good = true;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      rows[std::size_t(3 * i + k)] = m[k][i];
      good &= std::isfinite(m[k][i]) && std::abs(m[k][i]) < 1e4f;
    }
  if (!good) throw Error("the chromaticities in the EXR are of no colour space: " + names);
  image.conversion = {rows,
                      {"colours are converted to sRGB from the primaries that the EXR states: " + names}};
}

void read_notes(const Imf::Header& header, int parts, Image& image) {
  if (image.channel("R") >= 0 && image.channel("G") >= 0 && image.channel("B") >= 0)
    read_chromaticities(header, image);
  if (Imf::hasEnvmap(header)) image.cube_map = Imf::envmap(header) == Imf::ENVMAP_CUBE;
  if (parts > 1) image.notes.push_back(fmt::format("the first of {} parts of the EXR is read", parts));
  if (const Imath::Box2i& data = header.dataWindow(), &display = header.displayWindow(); data != display)
    image.notes.push_back(fmt::format(
        "the picture is the data window of the EXR, {} x {} pixels at ({}, {}), not its display window of {} "
        "x {} at ({}, {})",
        image.width, image.height, data.min.x, data.min.y, display.size().x + 1, display.size().y + 1,
        display.min.x, display.min.y));
}

/// Returns the sample types of the channels and the compression, in words.
std::string format_text(const Imf::Header& header) {
  std::string types;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const char* type = c.channel().type == Imf::HALF    ? "16-bit float"
                       : c.channel().type == Imf::FLOAT ? "32-bit float"
                                                        : "32-bit integer";
    if (types.find(type) == std::string::npos) types += (types.empty() ? "" : " and ") + std::string(type);
  }
  constexpr const char* kNames[] = {"no",    "RLE", "ZIPS", "ZIP",  "PIZ",
                                    "PXR24", "B44", "B44A", "DWAA", "DWAB"};
  const auto method = std::size_t(header.compression());
  return "EXR, " + types + ", " + (method < std::size(kNames) ? kNames[method] : "unknown") + " compression";
}

}  // namespace

Image read_exr(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels) try {
  // The library allocates memory based on the header alone, so the header is checked first.
  const int parts = check_exr_header(bytes, max_pixels);
  MemoryInput stream(bytes);
  Imf::InputFile file(stream, 0);
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  Image image;
  image.width = window.max.x - window.min.x + 1, image.height = window.max.y - window.min.y + 1;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw Error("channel \"" + std::string(c.name()) + "\" is subsampled, which is not supported");
    image.channels.push_back(c.name());
  }
  if (image.channels.empty()) throw Error("the EXR has no channels");
  image.pixels.resize(std::size_t(image.width) * image.height * image.channels.size());
  Imf::FrameBuffer frame;
  const std::size_t stride = sizeof(float) * image.channels.size();
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    frame.insert(image.channels[c],
                 Imf::Slice::Make(Imf::FLOAT, image.pixels.data() + c, window, stride, stride * image.width));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  if (attributes) read_attributes(header, *attributes);
  image.format = format_text(header);
  read_notes(header, parts, image);
  return image;
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& e) {
  throw Error(std::string("damaged or truncated EXR: ") + e.what());
}

std::vector<char> encode_exr(const Image& image, ExrPixel pixel, const ExrAttributes& attributes) try {
  if (image.width <= 0 || image.height <= 0 || image.channels.empty()) throw Error("the image has no pixels");
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, value] : attributes.strings) header.insert(name, Imf::StringAttribute(value));
  for (const auto& [name, value] : attributes.integers) header.insert(name, Imf::IntAttribute(value));
  for (const auto& [name, value] : attributes.floats) header.insert(name, Imf::FloatAttribute(value));
  if (image.channel("R") >= 0 && image.channel("G") >= 0 && image.channel("B") >= 0)
    // written although the default, Rec. 709 with D65, equals sRGB
    Imf::addChromaticities(header, Imf::Chromaticities());

  const bool as_half = pixel == ExrPixel::half;
  std::vector<half> halves;
  if (as_half) {
    halves.reserve(image.pixels.size());
    // Finite values out of range become the largest half instead of infinity.
    for (const float v : image.pixels)
      halves.emplace_back(std::isfinite(v) ? std::clamp(v, -65504.f, 65504.f) : v);
  }
  const std::size_t stride = (as_half ? sizeof(half) : sizeof(float)) * image.channels.size();
  char* const base = as_half ? reinterpret_cast<char*>(halves.data())
                             : reinterpret_cast<char*>(const_cast<float*>(image.pixels.data()));
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
    header.channels().insert(image.channels[c], Imf::Channel(type));
    frame.insert(image.channels[c],
                 Imf::Slice(type, base + c * (stride / image.channels.size()), stride, stride * image.width));
  }
  MemoryOutput stream;
  {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }  // the destructor writes the table of line offsets here
  return std::move(stream.bytes);
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& e) {
  throw Error(std::string("the EXR cannot be made: ") + e.what());
}

}  // namespace aureole::codec
