// SPDX-License-Identifier: Apache-2.0
// A camera with a lens by its elements: rays are refracted by every surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/parameter/lens/lens_file.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

using optics::LensRay;
using optics::LensSystem;

class LensSensor final : public Sensor {
public:
  explicit LensSensor(const Properties& p) : Sensor(p), clip_(p) {
    measures_irradiance_ = p.get_choice("measure", "radiance", {"radiance", "irradiance"}) == "irradiance";
    read_common(p, Measures::picture,
                measures_irradiance_ ? MeasuredKind::irradiance : MeasuredKind::radiance);
    to_world_ = rigid_transform(p, read_motion(p));
    to_camera_ = to_world_.inverse();
    diagonal_mm_ = p.get_float("film_diagonal", 43.266615305567875, {1e-3, 1e6});
    per_mm_ = 1e-3 / p.context().length_unit_m;
    // Pixels are square; the diagonal is that of the whole film.
    const double pixel_m = 1e-3 * diagonal_mm_ / std::hypot(double(film().width()), double(film().height()));
    if (film().measures_flux()) pixel_area_ = pixel_m * pixel_m;
    read_lens_parameters(p);
    if (lens_) find_pupils(p);
  }

  bool uses_lens() const override { return true; }
  /// Even where the glasses do not disperse, coatings depend on the wavelength.
  bool disperses() const override { return true; }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    return sample_dispersed_ray(at, film, lens, float(middle_nm_));
  }

  SensorRay sample_dispersed_ray(const PlacedSensor& at, Vec2 film, Vec2 lens, float nm) const override {
    // The picture is upside down on the film: camera space has x to the left and y up.
    const double x = -double(at.film_center.x - film.x) * at.pixel_size,
                 y = -double(at.film_center.y - film.y) * at.pixel_size, r = std::hypot(x, y);
    const Pupil& pupil = pupil_at(r);
    SensorRay blocked{{to_world_.point({0, 0, 0}), to_world_.vector({0, 0, 1}), 0}, 0};
    if (!(pupil.area() > 0)) return blocked;
    // The pupil of a point on the x axis, turned to that of this point.
    const double u = std::lerp(pupil.x0, pupil.x1, double(lens.x)),
                 v = std::lerp(-pupil.y1, pupil.y1, double(lens.y));
    const double cosine = r > 0 ? x / r : 1, sine = r > 0 ? y / r : 0;
    LensRay ray = ray_to_pupil({x, y}, {u * cosine - v * sine, u * sine + v * cosine});
    const double cos_film = -ray.d[2], distance = lens_->film() - pupil_z_;
    const auto transmittance = lens_->trace_back(ray, indices_at(nm), double(nm));
    if (!transmittance) return blocked;
    const double cos2 = cos_film * cos_film;
    double weight = pupil.area() * cos2 * cos2 / (distance * distance) * *transmittance;
    if (!measures_irradiance_) weight /= axial_angle_;
    weight *= pixel_area_;
    const Vec3 o{float(ray.o[0] * per_mm_), float(ray.o[1] * per_mm_), float(-ray.o[2] * per_mm_)};
    const Vec3 d{float(ray.d[0]), float(ray.d[1]), float(-ray.d[2])};
    // Rays of fish-eyes may run across the axis: there the planes are at distances along the ray.
    const float slope = std::max(d.z, 0.01f);
    const float to_near = std::max((clip_.near - std::max(o.z, 0.f)) / slope, 0.f),
                to_far = clip_.far / slope;
    return {{to_world_.point(o + d * to_near), normalize(to_world_.vector(d)), to_far - to_near},
            float(weight)};
  }

  void fit(PlacedSensor& at) const override {
    const double width = at.part.width, height = at.part.height;
    at.pixel_size = float(diagonal_mm_ / std::hypot(width, height));
    at.film_center = {float(at.part.left + 0.5 * width), float(0.5 * height)};
  }

  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    return clip_.note(properties(), to_camera_, shapes, clip_.far);
  }

private:
  /// A rectangle in the plane of the last vertex [mm] that contains what light to a point of the film on the +x axis
  /// passes: [x0, x1] x [-y1, y1].
  struct Pupil {
    double x0 = 0, x1 = 0, y1 = 0;
    double area() const { return (x1 - x0) * 2 * y1; }
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.x0, self.x1, self.y1);
    }
    void extend(const Pupil& o) {
      if (!(o.area() > 0)) return;
      if (!(area() > 0)) *this = o;
      x0 = std::min(x0, o.x0), x1 = std::max(x1, o.x1), y1 = std::max(y1, o.y1);
    }
  };
  static constexpr int kRings = 64;  ///< of the film, each with its pupil
  struct Pupils {
    std::vector<Pupil> rings;
    double axial_angle = 0;

    static constexpr TableKind kTable{"pupils of a lens", 1};
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.rings, self.axial_angle);
    }
  };

  void read_lens_parameters(const Properties& p) {
    prescription_ = read_lens(p.get_file("filename"));
    for (const std::string& note : prescription_.notes) p.note("filename", note);
    const std::string coating = p.get_choice("coating", "file", {"file", "none", "mgf2", "ideal"});
    if (coating != "file")
      for (optics::LensSurface& s : prescription_.surfaces) {
        s.coating_index = coating == "none" ? 0 : coating == "ideal" ? 1 : 1.38;
        s.coating_nm = 550;
      }
    const SpectralGrid& grid = p.context().grid;
    for (const LensGlass& glass : prescription_.glasses)
      if (grid.min_nm < glass.min_nm() || grid.max_nm > glass.max_nm()) {
        p.note("filename",
               fmt::format("the glass {} is known from {:g} to {:g} nm: its index is constant beyond",
                           glass.name(), glass.min_nm(), glass.max_nm()));
        break;
      }
    middle_nm_ = std::clamp(587.56, grid.min_nm, grid.max_nm);
    // The indices of the grid's nodes: a look-up for a path, not a search.
    min_nm_ = grid.min_nm, per_cell_ = grid.cells / (grid.max_nm - grid.min_nm);
    for (int i = 0; i <= grid.cells; ++i) indices_.push_back(prescription_.indices(grid.node(i)));

    LensSystem lens(prescription_.surfaces);
    const int blades = int(p.get_int("blades", 0, {0, 100}));
    if (blades == 1 || blades == 2) throw p.error("blades", "a stop has at least 3 blades; 0 is round");
    lens.set_blades(blades, p.get_float("blade_angle", 0) * M_PI / 180);
    const optics::ParaxialLens open = lens.paraxial(prescription_.indices(middle_nm_));
    if (!(open.focal_length > 0))
      throw p.error("filename", fmt::format("the lens has a focal length of {:.4g} mm: it makes no picture",
                                            open.focal_length));
    if (p.has("f_number")) {
      const double number = p.get_float("f_number", {1e-2, 1e4});
      if (number < open.f_number() * (1 - 1e-3))
        throw p.error("f_number", fmt::format("wide open the lens has f/{:.4g}: the stop opens no wider",
                                              open.f_number()));
      lens.set_stop_semi_diameter(lens.surfaces()[lens.stop()].semi_diameter *
                                  std::min(1.0, open.f_number() / number));
    } else {
      p.find("f_number");
    }
    focus(p, lens);
    lens_.emplace(std::move(lens));
  }

  /// Moves the film where a distance of focus is stated.
  void focus(const Properties& p, LensSystem& lens) {
    const bool best = p.get_choice("focus", "best", {"best", "paraxial"}) == "best";
    if (!p.has("focus_distance")) {
      p.find("focus_distance");
      if (p.has("focus"))
        p.note("focus", "has no effect without a \"focus_distance\": the film is where the file has it");
      const double gap = lens.film() - lens.vertex(lens.surfaces().size() - 1);
      if (!(gap > 0))
        throw p.error(
            "filename",
            "the thickness behind the last surface is the distance of the film, which must be positive; "
            "or give a \"focus_distance\"");
      return;
    }
    const double mm = p.get_float("focus_distance", Range::positive()) / per_mm_;
    double z = 0;
    try {
      const auto& n = prescription_.indices(middle_nm_);
      z = best ? optics::best_focus(lens, n, middle_nm_, mm) : lens.paraxial_image(n, mm);
    } catch (const std::domain_error& e) {
      throw p.error("filename", e.what());
    }
    if (!(z > lens.vertex(lens.surfaces().size() - 1) && std::isfinite(z)))
      throw p.error("focus_distance",
                    fmt::format("the lens makes no picture on a film of what is {:.4g} mm before it: this is "
                                "nearer than its focal point",
                                mm));
    lens.set_film(z);
  }

  LensRay ray_to_pupil(const std::array<double, 2>& film, const std::array<double, 2>& pupil) const {
    LensRay ray{{film[0], film[1], lens_->film()},
                {pupil[0] - film[0], pupil[1] - film[1], pupil_z_ - lens_->film()}};
    const double scale = 1 / std::hypot(ray.d[0], ray.d[1], ray.d[2]);
    for (double& x : ray.d) x *= scale;
    return ray;
  }

  /// The part of the plane of the last vertex from which light reaches a point of the film at the radius r, at three wavelengths.
  Pupil pupil_of(double r) const {
    // A grid over all of the last surface, then one over what the first has found.
    constexpr int kCells = 48;
    const double reach = prescription_.surfaces.back().semi_diameter;
    Pupil found{-reach, reach, reach};
    for (int pass = 0; pass < 2 && found.area() > 0; ++pass) found = pupil_within(r, found, kCells);
    return found;
  }
  Pupil pupil_within(double r, const Pupil& within, int cells) const {
    const double dx = (within.x1 - within.x0) / cells, dy = 2 * within.y1 / cells;
    Pupil found;
    const SpectralGrid& grid = properties().context().grid;
    for (const double nm : {grid.min_nm, middle_nm_, grid.max_nm}) {
      if (nm != middle_nm_ && !prescription_.is_dispersive()) continue;
      const std::vector<double>& n = indices_at(nm);
      for (int j = 0; 2 * j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          const double x = within.x0 + dx * (i + 0.5), y = dy * (j + 0.5);
          LensRay ray = ray_to_pupil({r, 0}, {x, y});
          if (lens_->trace_back(ray, n, nm)) found.extend({x - dx, x + dx, y + dy});
        }
    }
    return found;
  }

  void find_pupils(const Properties& p) {
    pupil_z_ = lens_->vertex(lens_->surfaces().size() - 1);
    const auto pupils =
        p.shared_model<Pupils>([&] { return std::make_shared<const Pupils>(make_pupils(p)); });
    if (pupils) pupils_ = pupils->rings, axial_angle_ = pupils->axial_angle;
  }
  Pupils make_pupils(const Properties& p) const {
    Pupils made;
    std::vector<Pupil>& pupils = made.rings;
    constexpr int kAxialCells = 512;
    const double radius = 0.5 * diagonal_mm_;
    std::vector<Pupil> at_edges;
    for (int i = 0; i <= kRings; ++i) at_edges.push_back(pupil_of(radius * i / kRings));
    int dark = 0;
    for (int i = 0; i < kRings; ++i) {
      Pupil both = at_edges[std::size_t(i)];
      both.extend(at_edges[std::size_t(i + 1)]);
      pupils.push_back(both);
      dark += !(both.area() > 0);
    }
    if (!(pupils[0].area() > 0))
      throw p.error("filename", "no light passes the lens to the middle of the film");
    if (dark > 0)
      p.note("film_diagonal", fmt::format("the lens leaves the film dark beyond {:.3g} mm from its middle",
                                          radius * double(kRings - dark) / kRings));
    // The projected solid angle of the exit pupil from the middle of the film, without losses.
    const Pupil& axial = pupils[0];
    const double dx = (axial.x1 - axial.x0) / kAxialCells, dy = 2 * axial.y1 / kAxialCells,
                 distance = lens_->film() - pupil_z_;
    const std::vector<double>& n = indices_at(middle_nm_);
    for (int j = 0; j < kAxialCells; ++j)
      for (int i = 0; i < kAxialCells; ++i) {
        LensRay ray = ray_to_pupil({0, 0}, {axial.x0 + dx * (i + 0.5), -axial.y1 + dy * (j + 0.5)});
        const double cos2 = ray.d[2] * ray.d[2];
        if (lens_->trace_back(ray, n, middle_nm_))
          made.axial_angle += dx * dy * cos2 * cos2 / (distance * distance);
      }
    return made;
  }

  const Pupil& pupil_at(double r) const {
    const double ring = r / (0.5 * diagonal_mm_) * kRings;
    return pupils_[std::size_t(std::clamp(ring, 0.0, kRings - 1.0))];
  }
  const std::vector<double>& indices_at(double nm) const {
    const double cell = std::clamp((nm - min_nm_) * per_cell_, 0.0, double(indices_.size() - 1));
    return indices_[std::size_t(std::lround(cell))];
  }

  Transform to_world_, to_camera_;
  ClipPlanes clip_;
  LensPrescription prescription_;
  std::optional<LensSystem> lens_;
  std::vector<std::vector<double>> indices_;  ///< of all surfaces, for each node of the grid
  double min_nm_ = 360, per_cell_ = 1, middle_nm_ = 587.56;
  double diagonal_mm_ = 43.27, per_mm_ = 1e-3;  ///< of the film; scene units per mm
  bool measures_irradiance_ = false;
  std::vector<Pupil> pupils_;
  double pixel_area_ = 1;  ///< [m^2] where the film measures power, else 1
  double pupil_z_ = 0, axial_angle_ = 1;
};

AUREOLE_PLUGIN(
    LensSensor, "sensor", "lens",
    PluginDoc{
        "Camera with a lens by its elements. Every ray is refracted by all surfaces, so that the picture has the lens' "
        "aberrations, its dispersion, its vignetting and the fall of cos^4 towards the corners. The camera looks along "
        "its local +z axis, and the vertex of the first surface is its origin. The prescription is a table (radius, "
        "thickness, glass, diameter; see the page on cameras) or the sequential part of a .zmx file. Light that surfaces "
        "reflect is lost: there are no ghosts. Paths have one wavelength where the glasses disperse.",
        "Kolb, Mitchell & Hanrahan 1995, \"A realistic camera model for computer graphics\", section 3",
        camera_parameters(
            {{"to_world", "transform", "", "identity",
              "camera to world; must not scale. An `<animation>` of key frames moves the camera"},
             {"filename", "file", "", "required", "the prescription of the lens"},
             {"film_diagonal", "float", "mm", "43.267", "diagonal of the film"},
             {"f_number", "float", "", "wide open",
              "stops the lens down to this ratio of focal length and diameter of the entrance pupil"},
             {"focus_distance", "float", "scene units", "from the file",
              "distance from the first vertex that is in focus: moves the film. Without it the film is where the "
              "prescription has it"},
             {"focus", "string", "", "best",
              "with a focus distance, of the line d (587.56 nm): best, the smallest root mean square spot on the axis; "
              "paraxial"},
             {"measure", "string", "", "radiance",
              "radiance: that of a uniform scene in the middle of the film, if the lens lost no light; irradiance: that on "
              "the film, in W/m^2"},
             {"coating", "string", "", "file",
              "of all surfaces: file, as the prescription says, none where it says nothing; none; mgf2, a quarter wave of "
              "550 nm of index 1.38; ideal, nothing is reflected"},
             {"blades", "integer", "", "0",
              "number of blades of the stop, whose corners lie on its circle; 0: round"},
             {"blade_angle", "float", "degrees", "0", "turns the stop"}}),
        {R"(<sensor type="lens">
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <string name="filename" value="double_gauss.lens"/>
    <float name="film_diagonal" value="43.27"/> <float name="f_number" value="4"/>
    <float name="focus_distance" value="5"/> <string name="focus" value="best"/>
    <string name="measure" value="radiance"/> <string name="coating" value="mgf2"/>
    <integer name="blades" value="7"/> <float name="blade_angle" value="10"/>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <film type="hdrfilm"/> <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole
