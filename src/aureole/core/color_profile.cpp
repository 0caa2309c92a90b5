// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/color_profile.h"

#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "aureole/core/error.h"

namespace aureole {
namespace {

/// A context of Little CMS that does not print messages.
using Context = std::unique_ptr<std::remove_pointer_t<cmsContext>, void (*)(cmsContext)>;
using IccProfile = std::unique_ptr<void, cmsBool (*)(cmsHPROFILE)>;
using IccTransform = std::unique_ptr<void, void (*)(cmsHTRANSFORM)>;

Context make_context() {
  Context context(cmsCreateContext(nullptr, nullptr), cmsDeleteContext);
  if (!context) throw Error("Little CMS cannot be started");
  cmsSetLogErrorHandlerTHR(context.get(), [](cmsContext, cmsUInt32Number, const char*) {});
  return context;
}

IccProfile owned(cmsHPROFILE profile) { return {profile, cmsCloseProfile}; }

IccProfile profile_with_curve(cmsContext context, const Primaries& p, double gamma) {
  const cmsCIExyY white{p[6], p[7], 1};
  const cmsCIExyYTRIPLE primaries{{p[0], p[1], 1}, {p[2], p[3], 1}, {p[4], p[5], 1}};
  cmsToneCurve* const curve = cmsBuildGamma(context, gamma);
  cmsToneCurve* const curves[3] = {curve, curve, curve};
  IccProfile profile = owned(cmsCreateRGBProfileTHR(context, &white, &primaries, curves));
  cmsFreeToneCurve(curve);
  return profile;
}

/// Makes a profile of sRGB, whose values are encoded for display or linear.
IccProfile make_srgb(cmsContext context, bool linear) {
  if (!linear) return owned(cmsCreate_sRGBProfileTHR(context));
  return profile_with_curve(context, kSrgbPrimaries, 1);
}

std::vector<unsigned char> saved(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  if (!profile || !cmsSaveProfileToMem(profile, nullptr, &size))
    throw Error("the colour profile cannot be made");
  std::vector<unsigned char> bytes(size);
  if (!cmsSaveProfileToMem(profile, bytes.data(), &size)) throw Error("the colour profile cannot be made");
  return bytes;
}

std::string name_of(cmsHPROFILE profile) {
  char name[128] = "";
  cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", name, sizeof name);
  std::string text(name);
  std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < 32; });
  return text.empty() ? "without a name" : "\"" + text + "\"";
}

/// Largest change of a colour, as a fraction of white, below which a profile counts as sRGB: half a step of 8 bits.
/// Profiles of sRGB by other makers differ from each other by their rounded primaries.
constexpr double kSame = 0.5 / 255;

bool changes_colors(cmsHTRANSFORM transform, int channels) {
  constexpr int kSteps = 6;
  for (int r = 0; r < kSteps; ++r)
    for (int g = 0; g < (channels == 1 ? 1 : kSteps); ++g)
      for (int b = 0; b < (channels == 1 ? 1 : kSteps); ++b) {
        const float in[3] = {float(r) / (kSteps - 1), float(g) / (kSteps - 1), float(b) / (kSteps - 1)};
        float out[3];
        cmsDoTransform(transform, in, out, 1);
        for (int k = 0; k < 3; ++k)
          if (!(std::abs(out[k] - in[channels == 1 ? 0 : k]) < kSame)) return true;
      }
  return false;
}

}  // namespace

const std::vector<unsigned char>& srgb_profile(bool linear) {
  static const auto make = [](bool is_linear) {
    const Context context = make_context();
    const IccProfile profile = make_srgb(context.get(), is_linear);
    if (!profile) throw Error("the colour profile cannot be made");
    cmsSetProfileVersion(profile.get(), 2.1);
    return saved(profile.get());
  };
  static const std::vector<unsigned char> encoded = make(false), straight = make(true);
  return linear ? straight : encoded;
}

std::vector<unsigned char> profile_of_primaries(const Primaries& p, double gamma) {
  const Context context = make_context();
  const bool good = gamma > 0.05 && gamma < 20 &&
                    std::all_of(p.begin(), p.end(), [](double v) { return std::isfinite(v); }) && p[1] > 0 &&
                    p[3] > 0 && p[5] > 0 && p[7] > 0;
  const IccProfile profile = good ? profile_with_curve(context.get(), p, gamma) : owned(nullptr);
  if (!profile) throw Error("the primaries that the file states span no colours");
  return saved(profile.get());
}

std::string convert_from_profile(Image& image, std::span<const unsigned char> bytes) {
  const Context context = make_context();
  const IccProfile from =
      owned(cmsOpenProfileFromMemTHR(context.get(), bytes.data(), cmsUInt32Number(bytes.size())));
  if (!from) return "the colour profile in the file is damaged: its colours are taken for sRGB";
  const int at[3] = {image.channel("R"), image.channel("G"), image.channel("B")};
  const bool is_grey = at[0] < 0 && image.channel("Y") >= 0;
  const cmsColorSpaceSignature space = cmsGetColorSpace(from.get());
  if (space != (is_grey ? cmsSigGrayData : cmsSigRgbData)) {
    // A grey picture with a colour profile: its grey counts as equal R, G and B.
    if (!(is_grey && space == cmsSigRgbData))
      return "the colour profile " + name_of(from.get()) +
             " in the file is not for its channels: its colours are taken for sRGB";
  }
  const bool through_rgb = space == cmsSigRgbData;
  const IccProfile to = make_srgb(context.get(), !image.srgb_encoded);
  const IccTransform transform(
      cmsCreateTransformTHR(context.get(), from.get(), through_rgb ? TYPE_RGB_FLT : TYPE_GRAY_FLT, to.get(),
                            TYPE_RGB_FLT, INTENT_RELATIVE_COLORIMETRIC,
                            cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE),
      cmsDeleteTransform);
  if (!transform)
    return "the colour profile " + name_of(from.get()) +
           " in the file cannot be converted: its colours are taken for sRGB";
  if (!changes_colors(transform.get(), through_rgb ? 3 : 1)) return {};

  const std::size_t channels = image.channel_count(), pixels = image.pixels.size() / channels;
  constexpr std::size_t kBlock = 4096;
  std::vector<float> in(kBlock * 3), out(kBlock * 3);
  const std::size_t grey = is_grey ? std::size_t(image.channel("Y")) : 0;
  for (std::size_t first = 0; first < pixels; first += kBlock) {
    const std::size_t count = std::min(kBlock, pixels - first);
    for (std::size_t i = 0; i < count; ++i) {
      const float* p = &image.pixels[(first + i) * channels];
      if (!through_rgb)
        in[i] = p[grey];
      else
        for (std::size_t k = 0; k < 3; ++k) in[3 * i + k] = is_grey ? p[grey] : p[std::size_t(at[k])];
    }
    cmsDoTransform(transform.get(), in.data(), out.data(), cmsUInt32Number(count));
    for (std::size_t i = 0; i < count; ++i) {
      float* p = &image.pixels[(first + i) * channels];
      if (is_grey)
        p[grey] = out[3 * i + 1];
      else
        for (std::size_t k = 0; k < 3; ++k) p[std::size_t(at[k])] = out[3 * i + k];
    }
  }
  return "colours are converted to sRGB from the file's colour profile " + name_of(from.get());
}

}  // namespace aureole
