// SPDX-License-Identifier: Apache-2.0
// Scenes that `dvr` can show, and notes on parts of them that it does not show or use.
#pragma once

#include <string>
#include <vector>

#include "aureole/integrator/dvr/settings.h"
#include "aureole/medium/classified/classified_medium.h"
#include "aureole/scene/scene.h"

namespace aureole {

std::vector<const ClassifiedMedium*> classified_media(const Scene& scene);

class DvrSceneChecks {
public:
  /// `properties` are those of the integrator.
  DvrSceneChecks(const Scene& scene, const Properties& properties, const DvrSettings& settings)
      : scene_(scene), properties_(properties), settings_(settings), media_(classified_media(scene)) {}

  /// Throws a located Error where the scene has no volume, or one that the method cannot show.
  void require() const;
  /// Appends notes, each with its place in the file.
  void note(std::vector<std::string>& notes) const;

private:
  /// Throws a located Error where the method cannot use a transfer function of two numbers or a mask.
  void require_classification(const Classification& classification) const;
  void note_unseen_isosurfaces(std::vector<std::string>& notes) const;
  /// Notes on lighting without lights, and on coefficients of lighting that is not chosen.
  void note_lighting(std::vector<std::string>& notes) const;
  /// Notes on light that single scattering leaves out.
  void note_unscattered(std::vector<std::string>& notes) const;
  /// Notes on shapes that hold the volume behind a surface at which "dvr" ends.
  void note_surface(const ClassifiedMedium& medium, std::vector<std::string>& notes) const;
  /// Notes that shapes do not enclose the volume, by their bounds.
  void note_shape(const ClassifiedMedium& medium, std::vector<std::string>& notes) const;

  const Scene& scene_;
  const Properties& properties_;
  const DvrSettings& settings_;
  std::vector<const ClassifiedMedium*> media_;
};

}  // namespace aureole
