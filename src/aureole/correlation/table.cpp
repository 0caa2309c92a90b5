// SPDX-License-Identifier: Apache-2.0
// A measured or computed arrangement: S'(q) or g(r) from a text, or S'(q) over the plane from a picture.
#include <algorithm>
#include <stdexcept>

#include "aureole/core/image.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/correlation/correlation.h"
#include "aureole/optics/two_columns.h"

namespace aureole {
namespace {

class Table final : public Correlation {
public:
  explicit Table(const Properties& p) : Correlation(p) {
    const bool pairs = p.get_choice("quantity", "structure_factor",
                                    {"structure_factor", "pair_correlation"}) == "pair_correlation";
    const double radius = p.get_float("radius", 1, Range::positive());
    const double extent = p.get_float("extent", 16, Range{1, 256});
    const auto file = p.get_file("filename");
    const std::string kind = lower_extension(file);
    try {
      if (kind == ".txt" || kind == ".csv" || kind == ".dat") {
        std::istringstream in = read_table_file(file);
        for (const auto& [x, y] : optics::read_two_columns(in)) {
          x_.push_back(pairs ? x / radius : x * radius);
          y_.push_back(y);
        }
        if (pairs)
          // throws an Error if the table is invalid
          optics::TabulatedStructureFactor::from_pair_correlation(x_, y_, 0.1);
        else
          factor_ = std::make_shared<optics::TabulatedStructureFactor>(x_, y_);
      } else {
        if (pairs) throw std::domain_error("a pair correlation is read from a text (.txt, .csv, .dat)");
        factor_ = from_picture(file, extent);
      }
    } catch (const std::domain_error& e) {
      throw p.error("filename", e.what());
    } catch (const Error& e) {
      throw p.error("filename", e.message());
    }
  }

  using Correlation::at;
  std::shared_ptr<const optics::StructureFactor> at(double area_fraction) const override {
    if (factor_) return factor_;
    return std::make_shared<optics::TabulatedStructureFactor>(
        optics::TabulatedStructureFactor::from_pair_correlation(x_, y_, area_fraction));
  }

private:
  static std::shared_ptr<const optics::StructureFactor> from_picture(const std::filesystem::path& file,
                                                                     double extent) {
    constexpr std::size_t kMaxPixels = 4096 * 4096;
    const Image image = read_image(file, nullptr, kMaxPixels);
    int channel = image.channel("Y");
    if (channel < 0) channel = image.channel("R");
    if (channel < 0) throw std::domain_error("the picture has neither a Y nor an R channel");
    std::vector<float> values;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) values.push_back(image.at(x, y, std::size_t(channel)));
    return std::make_shared<optics::MappedStructureFactor>(std::move(values), image.width, image.height,
                                                           extent);
  }

  std::vector<double> x_, y_;
  std::shared_ptr<const optics::StructureFactor> factor_;  ///< tabulated S'; null for a pair correlation
};

AUREOLE_PLUGIN(
    Table, "correlation", "table",
    PluginDoc{
        "A measured or computed arrangement: a text of two columns, u and S'(u) or r and g(r), or a picture "
        "of S' over the plane (positions without circular symmetry). Text is interpolated linearly; beyond "
        "it S' = 1, and g is tapered to 1 over the last half of its range.",
        "J.-P. Hansen & I. R. McDonald, Theory of Simple Liquids, 4th ed. 2013, section 4.1 (S from g)",
        {{"filename", "file", "", "required",
          "text (.txt, .csv, .dat), or an EXR, PFM or other picture whose channel Y or R contains S' "
          "without encoding"},
         {"quantity", "string", "", "structure_factor",
          "quantity in a text file: structure_factor or pair_correlation"},
         {"radius", "float", "", "1",
          "correlation radius in the unit of length of a text: 1 if the text has u = q a or r/a"},
         {"extent", "float", "", "16", "a picture covers ux and uy from -extent to extent, uy upward"}},
        {R"(<correlation type="table">
    <string name="filename" value="structure_factor.txt"/>
    <string name="quantity" value="structure_factor"/> <float name="radius" value="1"/>
    <float name="extent" value="16"/>
    <float name="stretch" value="1.3"/> <float name="stretch_direction" value="45"/>
</correlation>)"}});

}  // namespace
}  // namespace aureole
