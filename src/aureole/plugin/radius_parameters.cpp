// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/radius_parameters.h"

#include <stdexcept>
#include <string>

#include "aureole/core/input_file.h"
#include "aureole/core/units.h"
#include "aureole/optics/two_columns.h"
#include "aureole/plugin/number_list.h"

namespace aureole {

namespace {

/// Throws an Error if a parameter is given that the distribution does not use.
void refuse(const Properties& p, const std::string& distribution, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (p.has(name)) throw p.error(name, "has no meaning for the distribution \"" + distribution + "\"");
}

/// Returns one of `allowed`, which has no default here, as a wrong guess changes the medium by orders of magnitude.
std::string required_choice(const Properties& p, const char* name, const std::vector<std::string>& allowed) {
  if (p.has(name)) return p.get_choice(name, allowed.front(), allowed);
  throw p.error(name, "a histogram needs \"" + std::string(name) + "\": \"" + allowed[0] + "\" or \"" +
                          allowed[1] + "\"");
}

/// Returns the length of one unit of the sizes, in metres.
double read_unit_m(const Properties& p) {
  if (!p.has("size_unit"))
    throw p.error("size_unit", "a histogram needs \"size_unit\", the unit of its sizes: nm, um, mm, ...");
  const std::string unit = p.get_string("size_unit");
  try {
    if (unit.find_first_of("0123456789.") == std::string::npos) return parse_length_m("1" + unit);
  } catch (const Error&) {
  }
  throw p.error("size_unit", "\"" + unit + "\" is not a unit of length: use nm, um, mm, cm, m or km");
}

/// Returns the rows of a histogram: radii in the unit of the file, and weights. `place` becomes the parameter
/// at which messages are located.
std::vector<std::pair<double, double>> read_rows(const Properties& p, bool edges, const char*& place) {
  const bool file = p.has("size_histogram");
  place = file ? "size_histogram" : "sizes";
  std::vector<std::pair<double, double>> rows;
  if (file) {
    for (const char* name : {"sizes", "weights"})
      if (p.has(name))
        throw p.error(name, "give \"sizes\" and \"weights\" or the file \"size_histogram\", not both");
    try {
      std::istringstream text = read_table_file(p.get_file("size_histogram"));
      rows = optics::read_two_columns(text);
    } catch (const Error& e) {
      throw e.where().line > 0 ? e : p.error(place, e.what());
    } catch (const std::domain_error& e) {
      throw p.error(place, e.what());
    }
    if (edges && !rows.empty() && rows.back().second != 0)
      throw p.error(
          place,
          "by \"edges\", each line has the lower edge of a class and its weight, and the last line the upper "
          "edge of the last class and the weight 0; the last weight is " +
              shown_number(rows.back().second));
  } else {
    for (const char* name : {"sizes", "weights"})
      if (!p.has(name))
        throw p.error(name, "a histogram needs \"sizes\" and \"weights\", or the file \"size_histogram\"");
    const std::vector<double> sizes = get_number_list(p, "sizes"), weights = get_number_list(p, "weights");
    if (sizes.size() != weights.size() + (edges ? 1 : 0))
      throw p.error("weights", std::to_string(sizes.size()) + (edges ? " edges" : " midpoints") +
                                   " do not go with " + std::to_string(weights.size()) + " weights: " +
                                   (edges ? "there is one edge more than weights" : "each has one"));
    for (std::size_t i = 0; i < sizes.size(); ++i)
      rows.emplace_back(sizes[i], i < weights.size() ? weights[i] : 0);
  }
  if (rows.size() < (edges ? 2 : 1)) throw p.error(place, "the histogram has no class");
  return rows;
}

optics::RadiusDistribution read_histogram(const Properties& p) {
  using optics::RadiusDistribution;
  refuse(p, "histogram", {"radius", "size_spread", "effective_variance", "alpha", "gamma"});
  const bool edges = p.get_choice("classes", "midpoints", {"midpoints", "edges"}) == "edges";
  const bool diameters = required_choice(p, "size_quantity", {"radius", "diameter"}) == "diameter";
  const auto by = required_choice(p, "weighting", {"number", "volume"}) == "volume"
                      ? optics::SizeWeighting::volume
                      : optics::SizeWeighting::number;
  const double unit = read_unit_m(p) * (diameters ? 0.5 : 1);
  const char* place = nullptr;
  const auto rows = read_rows(p, edges, place);
  std::vector<double> radii, weights;
  double total = 0;
  // The rows are checked here as well, so that messages have the user's numbers and not radii in metres.
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto [size, weight] = rows[i];
    const std::string where = ", at the size " + shown_number(size);
    if (!(size > 0 && size < 1e30))
      throw p.error(place, "a size must be positive, got " + shown_number(size));
    if (i > 0 && !(size > rows[i - 1].first)) throw p.error(place, "sizes must increase" + where);
    if (!(weight >= 0 && weight < 1e30))
      throw p.error(place, "a weight must not be negative, got " + shown_number(weight) + where);
    radii.push_back(size * unit), weights.push_back(weight), total += weight;
  }
  if (!(total > 0)) throw p.error(place, "all weights are 0");
  if (edges) weights.pop_back();
  try {
    return edges ? RadiusDistribution::histogram(radii, weights, by)
                 : RadiusDistribution::histogram_of_midpoints(radii, weights, by);
  } catch (const std::domain_error& e) {
    throw p.error(place, e.what());
  }
}

}  // namespace

optics::RadiusDistribution read_radii(const Properties& p) {
  using optics::RadiusDistribution;
  using optics::SizeWeighting;
  const std::string distribution =
      p.get_choice("distribution", "log_normal", {"log_normal", "gamma", "modified_gamma", "histogram"});
  if (distribution == "histogram") return read_histogram(p);
  refuse(p, distribution, {"size_histogram", "sizes", "weights", "size_unit", "size_quantity", "classes"});
  if (!p.has("radius"))
    throw p.error("radius", "the parameter \"radius\" is required, a length such as \"5um\"");
  const double radius = p.get_length_m("radius", 0);
  if (distribution == "gamma") {
    refuse(p, distribution, {"size_spread", "weighting", "alpha", "gamma"});
    const double variance = p.get_float("effective_variance", 0.1, Range{0, 0.49, true});
    return RadiusDistribution::gamma(radius, variance);
  }
  if (distribution == "modified_gamma") {
    refuse(p, distribution, {"size_spread", "weighting", "effective_variance"});
    return RadiusDistribution::modified_gamma(radius, p.get_float("alpha", 6, Range{0, 100, true}),
                                              p.get_float("gamma", 1, Range{0, 20, true}));
  }
  refuse(p, distribution, {"effective_variance", "alpha", "gamma"});
  const double spread = p.get_float("size_spread", 0, Range{0, 1.5});
  const bool by_volume = p.get_choice("weighting", "number", {"number", "volume"}) == "volume";
  if (spread == 0) return RadiusDistribution::monodisperse(radius);
  return RadiusDistribution::log_normal(radius, spread,
                                        by_volume ? SizeWeighting::volume : SizeWeighting::number);
}

std::vector<ParameterDoc> radius_docs() {
  return {
      {"radius", "length", "", "required but for histogram",
       "radius of the spheres, such as 5um. log_normal: the median; gamma: the effective radius <r^3>/<r^2>; "
       "modified_gamma: the mode"},
      {"distribution", "string", "", "log_normal",
       "distribution of the radii: log_normal, gamma (Hansen 1971), modified_gamma (Deirmendjian 1969) or histogram "
       "(measured classes of sizes)"},
      {"size_spread", "float", "", "0",
       "log_normal: standard deviation of ln(radius), up to 1.5; 0: one radius"},
      {"weighting", "string", "", "number",
       "number or volume. log_normal: the quantity whose distribution over the radius is log-normal; histogram, which "
       "has no default: the quantity that the weights are fractions of"},
      {"effective_variance", "float", "", "0.1", "gamma: effective variance, below 0.5"},
      {"alpha", "float", "", "6", "modified_gamma: the number grows as radius^alpha at small radii"},
      {"gamma", "float", "", "1",
       "modified_gamma: the number falls as exp(-(alpha/gamma) (radius/mode)^gamma) at large radii"},
      {"size_histogram", "file", "", "none",
       "histogram: text file with two columns, size and weight in any unit, by increasing size; instead of sizes and "
       "weights"},
      {"sizes", "string", "", "none", "histogram: increasing sizes, separated by commas or blanks"},
      {"weights", "string", "", "none",
       "histogram: the number or volume of the spheres in each class, in any unit"},
      {"size_unit", "string", "", "required for histogram",
       "histogram: unit of length of the sizes, such as um"},
      {"size_quantity", "string", "", "required for histogram",
       "histogram: quantity that the sizes state, radius or diameter"},
      {"classes", "string", "", "midpoints",
       "histogram: midpoints: a size in each class, whose edges are the geometric means of neighbouring sizes; edges: the "
       "edges of the classes, one more than weights; a file then has the lower edge of each class, and on its last line "
       "the upper edge of the last class and the weight 0. Within a class, the weight is spread evenly over ln(size)"}};
}

}  // namespace aureole
