// SPDX-License-Identifier: Apache-2.0
// An aperture with straight edges, given inline or by a drawing.
#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "aureole/aperture/aperture.h"
#include "aureole/aperture/svg/svg.h"
#include "aureole/core/units.h"
#include "aureole/optics/aperture/polygon_aperture.h"

namespace aureole {
namespace {

/// Parses "x,y x,y x,y; x,y ...": the vertices of rings.
std::vector<optics::Ring> parse_rings(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  std::vector<optics::Ring> rings;
  while (!text.empty()) {
    const std::size_t end = text.find(';');
    std::string_view points = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    optics::Ring ring;
    for (;;) {
      points.remove_prefix(std::min(points.find_first_not_of(kBlank), points.size()));
      if (points.empty()) break;
      const std::string_view word = points.substr(0, points.find_first_of(kBlank));
      const std::size_t comma = word.find(',');
      if (comma == std::string_view::npos)
        throw Error("\"" + std::string(word) + "\" is not a vertex: write x,y with blanks between vertices");
      ring.push_back({parse_number(word.substr(0, comma)), parse_number(word.substr(comma + 1))});
      points.remove_prefix(word.size());
    }
    if (!ring.empty()) rings.push_back(std::move(ring));
  }
  return rings;
}

class Polygon final : public Aperture {
public:
  explicit Polygon(const Properties& p) : Aperture(p) {
    if (p.has("vertices") == p.has("filename"))
      throw p.error("vertices", "give either \"vertices\" or \"filename\"");
    const std::string source = p.has("vertices") ? "vertices" : "filename";
    const optics::PolygonRegion region = read_region(p, source);
    const double scale = p.has("vertices")
                             ? get_aperture_length_m(p, "unit")
                             : get_aperture_length_m(p, "width") / (region.upper().x - region.lower().x);
    const bool centroid = p.get_bool("centroid", true);
    const auto shape = std::make_shared<optics::PolygonAperture>(
        region.placed(centroid ? region.centroid() : optics::PlanePoint{}, scale));
    if (!(shape->bounding_radius() >= 1e-9 && shape->bounding_radius() <= 1))
      throw p.error(source, "the shape reaches " + std::to_string(shape->bounding_radius()) +
                                " m from its origin; it must be between 1nm and 1m");
    set_shape(shape);
  }

private:
  static optics::PolygonRegion read_region(const Properties& p, const std::string& source) {
    const std::filesystem::path file = source == "filename" ? p.get_file(source) : "";
    try {
      return optics::PolygonRegion::even_odd(file.empty() ? parse_rings(p.get_string(source))
                                                          : read_svg_rings(file));
    } catch (const std::domain_error& problem) {
      throw p.error(source, std::string("the polygon ") + problem.what());
    } catch (const Error& problem) {
      throw p.error(source, problem.message());
    }
  }
};

AUREOLE_PLUGIN(
    Polygon, "aperture", "polygon",
    PluginDoc{
        "A shape with straight edges, of any number of rings in either orientation. By the even-odd rule, "
        "points inside an odd number of rings are open: a ring in a ring is a hole, and the overlap of two "
        "rings is opaque. A ring must not touch itself. An SVG file gives the outlines of all its shapes "
        "(path, polygon, polyline, rect, circle, ellipse, and what use repeats; fill and stroke are ignored), in any "
        "absolute unit or in percent. Curves become "
        "polygons, accurate to 1e-4 of the picture's size. At most 10000 vertices.",
        "S.-W. Lee, R. Mittra, Fourier transform of a polygonal shape function and its application in "
        "electromagnetics, IEEE Trans. Antennas Propag. 31, 1983",
        {{"vertices", "string", "", "none",
          "x,y of the vertices, separated by blanks; a semicolon ends a ring"},
         {"unit", "length", "", "required with vertices", "unit of length of the vertices, such as 1um"},
         {"filename", "file", "", "none", "an SVG file, instead of vertices"},
         {"width", "length", "", "required with filename", "width of the bounding box of the file's shapes"},
         {"centroid", "boolean", "", "true",
          "place the centroid at the scatterer's position; false: the origin of vertices or file"}},
        {R"(<aperture type="polygon">
    <string name="vertices" value="-4,-3 4,-3 0,4; -1,-1 1,-1 0,1"/> <string name="unit" value="1um"/>
    <float name="rotation" value="90"/>
</aperture>)",
         R"(<aperture type="polygon">
    <string name="filename" value="leaf.svg"/> <string name="width" value="8um"/>
    <boolean name="centroid" value="true"/>
    <float name="fraction" value="0.5"/> <boolean name="random_rotation" value="true"/>
    <string name="size_histogram" value="sizes.csv"/>
</aperture>)"}});

}  // namespace
}  // namespace aureole
