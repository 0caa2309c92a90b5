// SPDX-License-Identifier: Apache-2.0
// Prescriptions of lenses as files: a table of surfaces, or the sequential part of a .zmx file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/optics/lens/lens_system.h"
#include "aureole/spectrum/refractive_index.h"

namespace aureole {

/// The medium behind a surface: a material of `refractive_index_names`, a constant index, or a glass of which the index at
/// the d line and the Abbe number are known, n = a + b/lambda^2.
class LensGlass {
public:
  static LensGlass air() { return LensGlass("air", 1); }
  static LensGlass of_index(double index);
  /// Throws Error for values that no glass has.
  static LensGlass of_abbe_number(double nd, double abbe_number);
  /// A material by its name; nothing if it is unknown.
  static std::optional<LensGlass> named(std::string_view name);

  const std::string& name() const { return name_; }
  bool is_dispersive() const { return b_ != 0 || (table_ && table_->is_dispersive()); }
  double index(double nm) const;
  /// Wavelengths [nm] for which the index is known; 0 and infinity without a limit.
  double min_nm() const { return table_ ? table_->min_nm() : 0; }
  double max_nm() const;

private:
  LensGlass(std::string name, double a, double b = 0) : name_(std::move(name)), a_(a), b_(b) {}

  std::string name_;
  double a_ = 1, b_ = 0;  ///< b in nm^2
  std::optional<RefractiveIndex> table_;
};

struct LensPrescription {
  std::string name;
  std::filesystem::path file;  ///< from which it was read
  std::vector<optics::LensSurface> surfaces;
  std::vector<LensGlass> glasses;  ///< behind each surface
  std::vector<std::string> notes;  ///< what was read otherwise than the file says, for the user

  /// The indices behind each surface at a wavelength.
  std::vector<double> indices(double nm) const;
  bool is_dispersive() const;
};

/// Reads a prescription; the content decides about the format. Throws Error located in the file.
///
/// Table: one surface a line, from the object to the film: radius of curvature [mm] ("0", "inf" and "plane" are planes),
/// thickness behind it [mm], what lies behind it ("air", a glass by its name, an index, or nd/Vd), and diameter [mm]. The
/// word "stop" in the place of the radius, or an index of 0, is the aperture stop. Then, in any order: k=conic constant,
/// a4= to a20= aspheric coefficients, coat=index@nm, coat=none or coat=ideal, stop. "#" begins a comment, and a line
/// "name ..." names the lens. The lens files of PBRT are such tables.
///
/// .zmx: surfaces STANDARD and EVENASPH with CURV, CONI, DISZ, GLAS, DIAM, PARM, STOP; the first one is the object and the
/// last one the image.
LensPrescription read_lens(const std::filesystem::path& file);
/// Reads the text of a file of that name.
LensPrescription parse_lens(std::string text, const std::filesystem::path& file);

}  // namespace aureole
