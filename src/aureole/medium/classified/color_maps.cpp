// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/classified/color_maps.h"

namespace aureole {

namespace {

using Rgb = std::array<float, 3>;

// Maps of matplotlib (van der Walt & Smith 2015; CC0), every eighth of their 256 colours and the last one.
constexpr Rgb kViridis[] = {
    {0.2670f, 0.0049f, 0.3294f}, {0.2770f, 0.0503f, 0.3757f}, {0.2823f, 0.0950f, 0.4173f},
    {0.2829f, 0.1359f, 0.4534f}, {0.2788f, 0.1755f, 0.4834f}, {0.2706f, 0.2141f, 0.5071f},
    {0.2590f, 0.2515f, 0.5247f}, {0.2450f, 0.2877f, 0.5373f}, {0.2297f, 0.3224f, 0.5457f},
    {0.2143f, 0.3556f, 0.5512f}, {0.1994f, 0.3876f, 0.5546f}, {0.1856f, 0.4186f, 0.5568f},
    {0.1727f, 0.4488f, 0.5579f}, {0.1607f, 0.4785f, 0.5581f}, {0.1490f, 0.5081f, 0.5573f},
    {0.1378f, 0.5375f, 0.5549f}, {0.1276f, 0.5669f, 0.5506f}, {0.1211f, 0.5927f, 0.5446f},
    {0.1201f, 0.6222f, 0.5349f}, {0.1301f, 0.6514f, 0.5216f}, {0.1539f, 0.6802f, 0.5042f},
    {0.1911f, 0.7084f, 0.4823f}, {0.2394f, 0.7356f, 0.4557f}, {0.2965f, 0.7616f, 0.4242f},
    {0.3607f, 0.7860f, 0.3878f}, {0.4310f, 0.8085f, 0.3465f}, {0.5063f, 0.8288f, 0.3004f},
    {0.5857f, 0.8467f, 0.2499f}, {0.6681f, 0.8620f, 0.1963f}, {0.7519f, 0.8750f, 0.1432f},
    {0.8353f, 0.8860f, 0.1026f}, {0.9162f, 0.8961f, 0.1007f}, {0.9932f, 0.9062f, 0.1439f}};
constexpr Rgb kMagma[] = {
    {0.0015f, 0.0005f, 0.0139f}, {0.0137f, 0.0118f, 0.0687f}, {0.0396f, 0.0311f, 0.1335f},
    {0.0743f, 0.0520f, 0.2027f}, {0.1131f, 0.0655f, 0.2768f}, {0.1590f, 0.0684f, 0.3527f},
    {0.2117f, 0.0620f, 0.4186f}, {0.2654f, 0.0602f, 0.4618f}, {0.3167f, 0.0717f, 0.4854f},
    {0.3660f, 0.0903f, 0.4980f}, {0.4147f, 0.1104f, 0.5047f}, {0.4635f, 0.1299f, 0.5077f},
    {0.5128f, 0.1482f, 0.5076f}, {0.5629f, 0.1654f, 0.5047f}, {0.6136f, 0.1818f, 0.4985f},
    {0.6649f, 0.1981f, 0.4888f}, {0.7164f, 0.2150f, 0.4753f}, {0.7611f, 0.2312f, 0.4602f},
    {0.8109f, 0.2529f, 0.4393f}, {0.8578f, 0.2799f, 0.4155f}, {0.8996f, 0.3146f, 0.3910f},
    {0.9336f, 0.3588f, 0.3705f}, {0.9585f, 0.4113f, 0.3600f}, {0.9751f, 0.4689f, 0.3631f},
    {0.9857f, 0.5281f, 0.3794f}, {0.9922f, 0.5875f, 0.4063f}, {0.9958f, 0.6463f, 0.4414f},
    {0.9973f, 0.7046f, 0.4826f}, {0.9970f, 0.7624f, 0.5288f}, {0.9954f, 0.8199f, 0.5791f},
    {0.9928f, 0.8772f, 0.6331f}, {0.9898f, 0.9343f, 0.6902f}, {0.9871f, 0.9914f, 0.7495f}};
constexpr Rgb kInferno[] = {
    {0.0015f, 0.0005f, 0.0139f}, {0.0140f, 0.0112f, 0.0719f}, {0.0423f, 0.0281f, 0.1411f},
    {0.0820f, 0.0433f, 0.2153f}, {0.1293f, 0.0473f, 0.2908f}, {0.1834f, 0.0403f, 0.3550f},
    {0.2383f, 0.0366f, 0.3964f}, {0.2908f, 0.0456f, 0.4186f}, {0.3415f, 0.0623f, 0.4294f},
    {0.3915f, 0.0809f, 0.4331f}, {0.4412f, 0.0993f, 0.4316f}, {0.4910f, 0.1172f, 0.4256f},
    {0.5409f, 0.1347f, 0.4151f}, {0.5907f, 0.1526f, 0.4003f}, {0.6401f, 0.1714f, 0.3811f},
    {0.6887f, 0.1922f, 0.3576f}, {0.7357f, 0.2159f, 0.3302f}, {0.7751f, 0.2397f, 0.3035f},
    {0.8173f, 0.2710f, 0.2704f}, {0.8560f, 0.3070f, 0.2351f}, {0.8903f, 0.3480f, 0.1983f},
    {0.9199f, 0.3934f, 0.1601f}, {0.9443f, 0.4428f, 0.1204f}, {0.9634f, 0.4955f, 0.0791f},
    {0.9771f, 0.5508f, 0.0391f}, {0.9853f, 0.6084f, 0.0242f}, {0.9879f, 0.6677f, 0.0583f},
    {0.9849f, 0.7284f, 0.1208f}, {0.9761f, 0.7900f, 0.1960f}, {0.9625f, 0.8515f, 0.2855f},
    {0.9487f, 0.9105f, 0.3953f}, {0.9517f, 0.9606f, 0.5242f}, {0.9884f, 0.9984f, 0.6449f}};
constexpr Rgb kPlasma[] = {
    {0.0504f, 0.0298f, 0.5280f}, {0.1324f, 0.0223f, 0.5633f}, {0.1934f, 0.0184f, 0.5903f},
    {0.2480f, 0.0144f, 0.6129f}, {0.2999f, 0.0096f, 0.6316f}, {0.3502f, 0.0044f, 0.6463f},
    {0.3994f, 0.0009f, 0.6561f}, {0.4477f, 0.0021f, 0.6602f}, {0.4949f, 0.0120f, 0.6579f},
    {0.5406f, 0.0350f, 0.6486f}, {0.5844f, 0.0686f, 0.6328f}, {0.6260f, 0.1033f, 0.6113f},
    {0.6651f, 0.1386f, 0.5856f}, {0.7018f, 0.1740f, 0.5573f}, {0.7360f, 0.2094f, 0.5279f},
    {0.7681f, 0.2448f, 0.4985f}, {0.7982f, 0.2802f, 0.4695f}, {0.8231f, 0.3113f, 0.4448f},
    {0.8501f, 0.3470f, 0.4172f}, {0.8754f, 0.3833f, 0.3900f}, {0.8990f, 0.4204f, 0.3630f},
    {0.9207f, 0.4584f, 0.3362f}, {0.9403f, 0.4976f, 0.3092f}, {0.9575f, 0.5383f, 0.2821f},
    {0.9718f, 0.5804f, 0.2549f}, {0.9830f, 0.6241f, 0.2279f}, {0.9907f, 0.6696f, 0.2016f},
    {0.9943f, 0.7167f, 0.1772f}, {0.9935f, 0.7655f, 0.1569f}, {0.9876f, 0.8160f, 0.1444f},
    {0.9763f, 0.8680f, 0.1434f}, {0.9593f, 0.9214f, 0.1516f}, {0.9400f, 0.9752f, 0.1313f}};
constexpr Rgb kGray[] = {{0, 0, 0}, {1, 1, 1}};
constexpr ColorMap kMaps[] = {
    {"viridis", kViridis}, {"magma", kMagma}, {"inferno", kInferno}, {"plasma", kPlasma}, {"gray", kGray}};

using Color = std::array<double, 4>;
using Opacity = std::array<double, 2>;
// Hounsfield units: air -1000, fat -100, water 0, muscle 50, cancellous bone 300, compact bone above 700. Opacities are
// those of a layer of 1 mm, as are those of MR.
constexpr Color kBoneColors[] = {{-1000, 0.3, 0.1, 0.1},
                                 {150, 0.55, 0.25, 0.15},
                                 {350, 0.88, 0.6, 0.4},
                                 {700, 0.95, 0.88, 0.75},
                                 {2000, 1, 1, 0.98}};
constexpr Opacity kBoneOpacities[] = {{150, 0}, {300, 0.12}, {700, 0.5}, {1200, 0.8}};
constexpr Color kSoftColors[] = {{-1000, 0, 0, 0},     {-500, 0.8, 0.55, 0.45}, {-100, 0.93, 0.75, 0.6},
                                 {50, 0.8, 0.4, 0.32}, {300, 0.95, 0.85, 0.72}, {1500, 1, 1, 1}};
constexpr Opacity kSoftOpacities[] = {{-600, 0},  {-400, 0.1}, {-150, 0.15}, {-50, 0.02},
                                      {40, 0.08}, {150, 0.15}, {400, 0.6}};
constexpr Color kMrColors[] = {
    {0, 0, 0, 0}, {120, 0.4, 0.2, 0.15}, {350, 0.85, 0.65, 0.5}, {700, 1, 0.92, 0.8}, {1000, 1, 1, 1}};
constexpr Opacity kMrOpacities[] = {{20, 0}, {90, 0.05}, {350, 0.15}, {700, 0.4}, {1000, 0.6}};
constexpr Color kGenericColors[] = {{0, 0.23, 0.3, 0.75}, {0.5, 0.87, 0.87, 0.87}, {1, 0.71, 0.02, 0.15}};
constexpr Opacity kGenericOpacities[] = {{0, 0}, {1, 0.9}};
constexpr TransferPreset kPresets[] = {{"ct_bone", true, kBoneColors, kBoneOpacities},
                                       {"ct_soft_tissue", true, kSoftColors, kSoftOpacities},
                                       {"mr", true, kMrColors, kMrOpacities},
                                       {"generic", false, kGenericColors, kGenericOpacities}};

template <class List>
auto* find_named(const List& list, std::string_view name) {
  for (const auto& item : list)
    if (name == item.name) return &item;
  return static_cast<decltype(&list[0])>(nullptr);
}

template <class List>
std::vector<std::string> names_in(const List& list) {
  std::vector<std::string> names;
  for (const auto& item : list) names.emplace_back(item.name);
  return names;
}

}  // namespace

const ColorMap* find_color_map(std::string_view name) { return find_named(kMaps, name); }
std::vector<std::string> color_map_names() { return names_in(kMaps); }
const TransferPreset* find_transfer_preset(std::string_view name) { return find_named(kPresets, name); }
std::vector<std::string> transfer_preset_names() { return names_in(kPresets); }

}  // namespace aureole
