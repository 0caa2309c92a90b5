// SPDX-License-Identifier: Apache-2.0
// A material of a scene, or a measured file, as a file of another format of measured BSDFs.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "aureole/instrument/measured/scattering_probe.h"
#include "aureole/loading/load.h"

namespace aureole {

/// A BSDF with the wavelengths of its scene.
struct ConvertibleBsdf {
  std::shared_ptr<const Bsdf> bsdf;
  SpectralGrid grid;
  std::vector<std::string> notes;
};
/// Loads "scene.xml#id", or a measured file by the plug-in that reads it (.bsdf, .binary, .csv, .xml of WINDOW). `range` [nm] is
/// that of a measured file; empty: 360 to 830 nm. Throws Error.
ConvertibleBsdf load_convertible(const std::string& input, const LoadOptions& load,
                                 const std::vector<double>& range);

struct BsdfConversionSettings {
  std::string format;            ///< rgl, klems, tensor_tree, csv or zemax
  std::vector<double> range;     ///< first and last wavelength [nm]; empty: those of the BSDF
  double step = 0;               ///< largest step between wavelengths [nm]; 0: 20
  int angles = 0, azimuths = 0;  ///< of incidence; 0: as the format and the material need
  int resolution =
      0;  ///< rows and columns of spectra, or cells along each axis of a tree; 0: 32 and 64 (16 for rank 4)
  int normals = 128;           ///< nodes of the distribution of normals of .bsdf
  std::string basis = "full";  ///< Klems' angle basis: full, half or quarter
  int samples = 0;             ///< of the BSDF for each incident patch; 0: 1024, of trees 4096
  double tolerance = 0.05;     ///< of a tree: neighbours that differ by less are merged
  std::string description;     ///< name of the material in the file
  bool make_reciprocal = false;
  const std::atomic<bool>* stop = nullptr;
};
/// The format that a file's ending stands for: .bsdf rgl, .xml klems, .csv csv. Throws Error, located at the file.
std::string format_of_output(const std::string& file);

struct ConvertedBsdf {
  std::string content, type;  ///< of the file, and the plug-in of the BSDF
  ScatteringReport report;
  std::vector<std::string> notes;
};
/// `input` names the material in messages. Throws Error.
ConvertedBsdf convert_bsdf(const ConvertibleBsdf& material, const std::string& input,
                           const BsdfConversionSettings& settings);

}  // namespace aureole
