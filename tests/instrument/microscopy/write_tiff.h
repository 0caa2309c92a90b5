// SPDX-License-Identifier: Apache-2.0
// Grey TIFFs of 8 or 16 bits with the tags in which microscopes say how large a pixel is.
#pragma once

#include <tiffio.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "aureole/instrument/microscopy/micrograph.h"

namespace aureole::test {

struct TiffTags {
  std::string description;
  float resolution = 0;  ///< pixels per unit; 0: no tag
  int unit = RESUNIT_NONE;
};

inline void write_grey_tiff(const std::filesystem::path& file, const Micrograph& m, int bits,
                            const TiffTags& tags = {}) {
  TIFF* t = TIFFOpen(file.c_str(), "w");
  TIFFSetField(t, TIFFTAG_IMAGEWIDTH, m.width), TIFFSetField(t, TIFFTAG_IMAGELENGTH, m.height);
  TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, bits), TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  if (!tags.description.empty()) TIFFSetField(t, TIFFTAG_IMAGEDESCRIPTION, tags.description.c_str());
  if (tags.resolution > 0) {
    TIFFSetField(t, TIFFTAG_XRESOLUTION, tags.resolution),
        TIFFSetField(t, TIFFTAG_YRESOLUTION, tags.resolution);
    TIFFSetField(t, TIFFTAG_RESOLUTIONUNIT, tags.unit);
  }
  std::vector<std::uint8_t> row(size_t(m.width) * bits / 8);
  for (int y = 0; y < m.height; ++y) {
    for (int x = 0; x < m.width; ++x) {
      const float v = m.grey[size_t(y) * m.width + x];
      if (bits == 16)
        reinterpret_cast<std::uint16_t*>(row.data())[x] = std::uint16_t(v * 65535 + 0.5f);
      else
        row[size_t(x)] = std::uint8_t(v * 255 + 0.5f);
    }
    TIFFWriteScanline(t, row.data(), std::uint32_t(y), 0);
  }
  TIFFClose(t);
}

}  // namespace aureole::test
