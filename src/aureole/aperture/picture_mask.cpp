// SPDX-License-Identifier: Apache-2.0
// An aperture of any shape, given as a picture.
#include <stdexcept>

#include "aureole/aperture/aperture.h"
#include "aureole/optics/aperture/mask_aperture.h"
#include "aureole/plugin/image_parameter.h"

namespace aureole {
namespace {

optics::Mask read_mask(const Properties& p, bool invert) {
  constexpr std::size_t kMaxPixels = std::size_t(1) << 25;
  const auto [image, source] = read_image_parameter(p, ImageColors::srgb, kMaxPixels);
  const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B"), a = image.channel("A");
  const int y = image.channel_count() == 1 ? 0 : image.channel("Y");
  const bool color = r >= 0 && g >= 0 && b >= 0;
  if (!color && y < 0) throw p.error(source, "needs the channels R, G, B or Y");
  optics::Mask mask;
  mask.width = image.width;
  mask.height = image.height;
  mask.open.reserve(std::size_t(image.width) * std::size_t(image.height));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const auto channel = [&](int c) { return image.at(column, row, std::size_t(c)); };
      float v = color ? (channel(r) + channel(g) + channel(b)) / 3 : channel(y);
      if (a >= 0) v *= channel(a);
      mask.open.push_back(invert ? 1 - v : v);
    }
  return mask;
}

class MaskPlugin final : public Aperture {
public:
  explicit MaskPlugin(const Properties& p) : Aperture(p) {
    const optics::Mask mask = read_mask(p, p.get_bool("invert", false));
    const double pitch = get_aperture_length_m(p, "width") / mask.width;
    try {
      set_shape(std::make_shared<optics::MaskAperture>(mask, pitch, p.get_bool("centroid", true)));
    } catch (const std::domain_error& problem) {
      throw p.error(p.has("data") ? "data" : "filename", problem.what());
    }
    if (!(shape()->bounding_radius() >= 1e-9 && shape()->bounding_radius() <= 1))
      throw p.error("width", "the mask reaches " + std::to_string(shape()->bounding_radius()) +
                                 " m from its origin; it must be between 1nm and 1m");
  }
};

AUREOLE_PLUGIN(
    MaskPlugin, "aperture", "mask",
    PluginDoc{
        "A picture of the shape, such as a micrograph after thresholding: white is open, black is opaque, "
        "and grey pixels are partly open. Pixel values are used as they are, without decoding; a "
        "transparent pixel is black. Pixels limit the accuracy: diffraction at sines beyond wavelength/(2 "
        "pixels) shows the squares, not the shape. A black border is cropped; pictures still larger than "
        "1024 on a side are averaged over squares of pixels. The shape's transform is interpolated in a "
        "padded Fourier transform, to 1e-4 of the area.",
        "A. Dutt, V. Rokhlin, Fast Fourier transforms for nonequispaced data, SIAM J. Sci. Comput. 14, 1993",
        {image_file_doc("EXR, PNG, JPEG, TIFF, HDR, TGA or BMP, values in [0, 1]"),
         image_data_doc(),
         {"width", "length", "", "required", "width of the whole picture; pixels are square"},
         {"invert", "boolean", "", "false", "black is open, white is opaque"},
         {"centroid", "boolean", "", "true",
          "place the centroid at the scatterer's position; false: the centre of the picture"}},
        {R"(<aperture type="mask">
    <string name="filename" value="letter.png"/> <string name="width" value="12um"/>
    <boolean name="invert" value="true"/> <boolean name="centroid" value="false"/>
    <float name="rotation" value="15"/>
</aperture>)",
         R"(<aperture type="mask">
    <string name="filename" value="letter.png"/> <string name="width" value="8um"/>
    <float name="fraction" value="0.5"/> <boolean name="random_rotation" value="true"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
