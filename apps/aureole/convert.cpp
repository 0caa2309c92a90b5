// SPDX-License-Identifier: Apache-2.0
// aureole convert: another format, exposure, crop, channel, false colours or the difference of two pictures.
#include <fmt/format.h>

#include <limits>

#include "aureole/core/error.h"
#include "aureole/instrument/picture/convert_picture.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct ConvertOptions {
  std::string input, output, difference, difference_kind = "absolute", tonemap, map;
  std::vector<double> crop;
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
  ConvertSettings settings;
};

int convert(ConvertOptions o) {
  ConvertSettings& s = o.settings;
  s.subtrahend = o.difference;
  s.difference = o.difference_kind == "absolute"   ? PictureDifference::absolute
                 : o.difference_kind == "relative" ? PictureDifference::relative
                                                   : PictureDifference::plain;
  if (o.difference.empty() && o.difference_kind != "absolute")
    tell("note: --difference-kind: has no effect without --difference\n");
  if (!o.crop.empty()) {
    std::array<int, 4>& window = s.crop.emplace();
    for (std::size_t i = 0; i < 4; ++i) {
      window[i] = int(o.crop[i]);
      if (double(window[i]) != o.crop[i])
        throw Error(fmt::format("--crop: expected whole pixels, got {:g}", o.crop[i]));
    }
  }
  if (!o.tonemap.empty()) try {
      s.tone = Tone::parse(o.tonemap);
    } catch (const Error& e) {
      throw Error("--tonemap " + e.message());
    }
  s.is_false_color = !o.map.empty();
  if (s.is_false_color) s.map = o.map;
  if (o.low == o.low) s.low = o.low;
  if (o.high == o.high) s.high = o.high;
  const Converted done = convert_picture(o.input, o.output, s);
  for (const std::string& note : done.notes) tell("note: {}\n", note);
  fmt::print("{}: {} x {} pixels, channels {}\n", o.output, done.width, done.height,
             fmt::join(done.channels, ", "));
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<ConvertOptions>();
  ConvertSettings& s = o->settings;
  options.add("input", o->input, "picture: EXR, HDR, PFM, PNG, JPEG, TIFF, TGA or BMP")
      .required()
      .names_replaceable_input();
  options
      .add("-o,--output", o->output,
           "picture to write; its extension tells the format: .exr .hdr .pfm .png .jpg .tif")
      .required()
      .names_output();
  options.add("--exposure", s.exposure, "multiply R, G, B and Y by 2 to this power")
      .between(-100, 100)
      .shows_default();
  options.add("--tonemap", o->tonemap, "tone mapping of formats with integers, see \"aureole render\"");
  options.add("--crop", o->crop, "keep X,Y,WIDTH,HEIGHT in pixels from the upper left corner")
      .takes(4)
      .separated_by(',');
  options.add("--channel", s.channel,
              "a layer (albedo for albedo.R, albedo.G, albedo.B) or a channel (depth.Y)");
  options.add("--false-color", o->map, "luminance, or the one channel, in colours of a map with a scale")
      .one_of(color_scale_maps());
  options.add("--low", o->low, "with --false-color: low end of the scale; by default the least value");
  options.add("--high", o->high, "with --false-color: high end of the scale; by default the largest value");
  options.add("--log", s.is_logarithmic, "with --false-color: a logarithmic scale");
  options.add("--contours", s.contours, "with --false-color: number of contours").between(0, 100);
  options.add("--difference", o->difference, "subtract this picture").names_input();
  options
      .add("--difference-kind", o->difference_kind,
           "absolute, relative (divided by the picture subtracted) or plain (with its sign)")
      .one_of({"absolute", "relative", "plain"})
      .shows_default();
  options.add("--bits", s.bits, "bits of a channel: PNG 8, 16; TIFF 8, 16, 32 (linear floats); EXR 16, 32")
      .between(8, 32);
  options.add("--quality", s.quality, "of a JPEG").between(1, 100).shows_default();
  return [o] { return convert(*o); };
}

AUREOLE_COMMAND("convert", "Change a picture's format, exposure, crop or channel; false colours; differences",
                declare);

}  // namespace
}  // namespace aureole
