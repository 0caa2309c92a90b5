// SPDX-License-Identifier: Apache-2.0
// Stacks of TIFF: the pages of one file, or the first pages of numbered files. Rows lie along x, lines along y, pages
// along z. Integers are read as they are.
#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <cstring>

#include "aureole/core/memory.h"
#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

struct TiffBytes {
  std::span<const std::byte> bytes;
  std::size_t position = 0;
};
tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t n) {
  auto& m = *static_cast<TiffBytes*>(handle);
  const std::size_t count =
      std::min(m.bytes.size() - std::min(m.position, m.bytes.size()), std::size_t(std::max<tmsize_t>(n, 0)));
  std::memcpy(to, m.bytes.data() + m.position, count);
  m.position += count;
  return tmsize_t(count);
}
toff_t seek_bytes(thandle_t handle, toff_t offset, int whence) {
  auto& m = *static_cast<TiffBytes*>(handle);
  const std::size_t base = whence == SEEK_CUR ? m.position : whence == SEEK_END ? m.bytes.size() : 0;
  m.position = std::min(base + std::size_t(offset), m.bytes.size());
  return m.position;
}

struct Page {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG,
                photometric = PHOTOMETRIC_MINISBLACK, orientation = ORIENTATION_TOPLEFT;
  bool operator==(const Page&) const = default;
};

Page page_of(TIFF* tiff) {
  Page p;
  if (!TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &p.width) ||
      !TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &p.height))
    throw Error("is a damaged TIFF: a page has no size");
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &p.photometric);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &p.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &p.samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &p.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &p.planar);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &p.orientation);
  return p;
}

ScalarType tiff_type_of(const Page& p) {
  const bool is_real = p.format == SAMPLEFORMAT_IEEEFP, is_signed = p.format == SAMPLEFORMAT_INT;
  if (is_real && p.bits == 16) return ScalarType::float16;
  if (is_real && p.bits == 32) return ScalarType::float32;
  if (is_real && p.bits == 64) return ScalarType::float64;
  if (is_signed || p.format == SAMPLEFORMAT_UINT || p.format == SAMPLEFORMAT_VOID) {
    if (p.bits == 8) return is_signed ? ScalarType::int8 : ScalarType::uint8;
    if (p.bits == 16) return is_signed ? ScalarType::int16 : ScalarType::uint16;
    if (p.bits == 32) return is_signed ? ScalarType::int32 : ScalarType::uint32;
    if (p.bits == 64) return is_signed ? ScalarType::int64 : ScalarType::uint64;
  }
  throw Error(
      fmt::format("has samples of {} bits in the sample format {}; whole numbers of 8 to 64 bits and floats "
                  "of 16 to 64 are supported",
                  p.bits, p.format));
}

/// The pages of one file.
class TiffPages {
public:
  explicit TiffPages(const SharedBytes& file) : file_(file), bytes_{file.bytes} {
    // Silences libtiff, which would print messages to standard error.
    static const bool quiet = (TIFFSetErrorHandler(nullptr), TIFFSetWarningHandler(nullptr), true);
    (void)quiet;
    tiff_.reset(TIFFClientOpen(
        "stack", "rm", &bytes_, read_bytes, [](thandle_t, void*, tmsize_t) -> tmsize_t { return 0; },
        seek_bytes, [](thandle_t) { return 0; },
        [](thandle_t handle) -> toff_t { return static_cast<TiffBytes*>(handle)->bytes.size(); }, nullptr,
        nullptr));
    if (!tiff_) throw Error("is a damaged TIFF");
    first_ = page_of(tiff_.get());
    if (first_.photometric != PHOTOMETRIC_MINISBLACK && first_.photometric != PHOTOMETRIC_RGB)
      throw Error(
          fmt::format("has the photometric interpretation {}; 1 (black is zero) and 2 (RGB) are supported "
                      "in a stack",
                      first_.photometric));
    if (first_.orientation != ORIENTATION_TOPLEFT)
      throw Error(
          fmt::format("has the orientation {}; 1 (rows from the top, columns from the left) is supported in "
                      "a stack",
                      first_.orientation));
    if (first_.planar != PLANARCONFIG_CONTIG && first_.samples > 1)
      throw Error("has its channels in separate planes, which is not supported in a stack");
    type_ = tiff_type_of(first_);
    if (first_.samples < 1 || first_.samples > 64)
      throw Error(fmt::format("has {} numbers in a pixel; 1 to 64 are possible", first_.samples));
    row_bytes_ = std::uint64_t(first_.width) * first_.samples * bytes_of(type_);
  }

  const Page& first() const { return first_; }
  ScalarType type() const { return type_; }
  bool is_swapped() const { return TIFFIsByteSwapped(tiff_.get()); }
  std::uint64_t page_bytes() const { return row_bytes_ * first_.height; }

  /// Returns the number of slices that follow one page, as ImageJ writes stacks of more than 4 GB; else 0.
  int slices_behind() const {
    const std::string_view text = description();
    return text.starts_with("ImageJ=") ? int(whole_number_behind(text, "\nimages=")) : 0;
  }
  /// The axes of a stack that its pages are, as a description by ImageJ or OME says, the fastest first: 'z' for slices,
  /// 't' for channels and instants, which are grids of their own. Empty where the first page has no such description.
  std::vector<GridAxis> described_axes() const {
    const std::string_view text = description();
    std::vector<GridAxis> axes;
    if (text.starts_with("ImageJ=")) {
      for (const char* key : {"\nchannels=", "\nslices=", "\nframes="})
        axes.push_back(
            {std::max<std::int64_t>(1, whole_number_behind(text, key)), key[1] == 's' ? 'z' : 't'});
      // Without these keys all images are slices.
      if (axes[0].size * axes[1].size * axes[2].size == 1) axes.clear();
    } else if (const std::size_t pixels = text.find("<Pixels");
               text.find("<OME") != text.npos && pixels != text.npos) {
      const std::string_view element = text.substr(pixels, text.find('>', pixels) - pixels);
      const std::string_view order = attribute_of(element, "DimensionOrder");
      if (order.size() != 5 || !order.starts_with("XY")) return {};
      for (const char axis : order.substr(2)) {
        std::int64_t size = 1;
        if (axis == 'C') size = whole_number_behind(element, " SizeC=\"") / first_.samples;
        if (axis == 'Z') size = whole_number_behind(element, " SizeZ=\"");
        if (axis == 'T') size = whole_number_behind(element, " SizeT=\"");
        axes.push_back({std::max<std::int64_t>(1, size), axis == 'Z' ? 'z' : 't'});
      }
    }
    return axes;
  }
  /// The size of a voxel that a description by ImageJ or OME states, as text; empty where there is none.
  std::string described_voxel() const {
    const std::string_view text = description();
    if (text.find("<OME") != text.npos) {
      std::string sizes;
      for (const char* name : {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"})
        if (const std::string_view size = attribute_of(text, name); !size.empty())
          sizes += (sizes.empty() ? "" : " x ") + std::string(size.substr(0, 20));
      return sizes;
    }
    constexpr std::string_view kKey = "\nspacing=";
    const std::size_t at = text.starts_with("ImageJ=") ? text.find(kKey) : text.npos;
    if (at == text.npos) return {};
    const auto line_behind = [&](std::size_t from) {
      return std::string(text.substr(from, std::min<std::size_t>(text.find('\n', from) - from, 20)));
    };
    float x = 0, y = 0;
    TIFFGetField(tiff_.get(), TIFFTAG_XRESOLUTION, &x), TIFFGetField(tiff_.get(), TIFFTAG_YRESOLUTION, &y);
    const std::size_t unit = text.find("\nunit=");
    return fmt::format("{:.6g} x {:.6g} x {}{}", x > 0 ? 1 / x : 1, y > 0 ? 1 / y : 1,
                       line_behind(at + kKey.size()), unit == text.npos ? "" : " " + line_behind(unit + 6));
  }

  /// Returns the bytes of `count` slices that follow the first pixel without gaps, mapped; in the file's order.
  SharedBytes contiguous(std::uint64_t count) const {
    std::uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_COMPRESSION, &compression);
    if (compression != COMPRESSION_NONE) throw Error("has one page of a compressed stack of ImageJ");
    const std::uint64_t at = TIFFGetStrileOffset(tiff_.get(), 0);
    return decode(file_, Encoding::raw, std::int64_t(std::min<std::uint64_t>(at, file_.size())),
                  count * page_bytes() / bytes_of(type_), type_);
  }

  /// Appends the pages of full size to `out`, in the machine's order of bytes; at most `most` of them.
  std::size_t append(std::vector<std::byte>& out, std::size_t most) {
    std::size_t pages = 0;
    const std::size_t before = out.size();
    do {
      std::uint32_t kind = 0;
      TIFFGetFieldDefaulted(tiff_.get(), TIFFTAG_SUBFILETYPE, &kind);
      if (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) continue;
      if (page_of(tiff_.get()) != first_)
        throw Error(fmt::format("has a page {} of another size or type than its first", pages));
      require_content(double(out.size() - before) + double(page_bytes()), double(file_.size()), 1100);
      read_page(out);
      if (++pages > kMaxFiles) throw Error(fmt::format("has more than {} pages", kMaxFiles));
    } while (pages < most && TIFFReadDirectory(tiff_.get()));
    return pages;
  }

private:
  /// The description of the page that was read last.
  std::string_view description() const {
    const char* text = nullptr;
    return TIFFGetField(tiff_.get(), TIFFTAG_IMAGEDESCRIPTION, &text) && text ? text : "";
  }
  /// The whole number that follows a key in a text, at most 10^9; 0 where there is none.
  static std::int64_t whole_number_behind(std::string_view text, std::string_view key) {
    const std::size_t at = text.find(key);
    if (at == text.npos) return 0;
    std::int64_t number = 0;
    for (const char c : text.substr(at + key.size())) {
      if (c < '0' || c > '9') break;
      number = std::min<std::int64_t>(number * 10 + (c - '0'), 1000000000);
    }
    return number;
  }
  /// The value of an attribute in an element of XML; empty where there is none.
  static std::string_view attribute_of(std::string_view element, std::string_view name) {
    const std::string key = fmt::format(" {}=\"", name);
    const std::size_t at = element.find(key);
    if (at == element.npos) return {};
    const std::size_t begin = at + key.size();
    return element.substr(begin, element.find('"', begin) - begin);
  }

  void read_page(std::vector<std::byte>& out) {
    const bool is_tiled = TIFFIsTiled(tiff_.get());
    std::uint32_t width = first_.width, height = 1;
    if (is_tiled) {
      TIFFGetField(tiff_.get(), TIFFTAG_TILEWIDTH, &width);
      TIFFGetField(tiff_.get(), TIFFTAG_TILELENGTH, &height);
    }
    const std::uint64_t pixel = std::uint64_t(first_.samples) * bytes_of(type_);
    const tmsize_t found = is_tiled ? TIFFTileSize(tiff_.get()) : TIFFScanlineSize(tiff_.get());
    if (width == 0 || height == 0 || width > (1u << 20) || height > (1u << 20) ||
        double(found) < double(width) * height * double(pixel) ||
        double(found) > double(page_bytes()) * 8 + (1 << 26))
      throw Error("is a damaged TIFF: impossible tiles");
    std::vector<std::byte> piece(std::size_t(found), std::byte{});
    const std::size_t begin = out.size();
    for (std::uint32_t y0 = 0; y0 < first_.height; y0 += height)
      for (std::uint32_t x0 = 0; x0 < first_.width; x0 += width) {
        const auto got = is_tiled ? TIFFReadTile(tiff_.get(), piece.data(), x0, y0, 0, 0)
                                  : TIFFReadScanline(tiff_.get(), piece.data(), y0, 0);
        if (got < 0) throw Error("is truncated or a damaged TIFF");
        // Memory is allocated as rows are read, so that stated sizes alone allocate nothing.
        const std::uint32_t rows = std::min(first_.height - y0, height);
        const std::size_t wanted = begin + std::size_t(row_bytes_ * (y0 + rows));
        if (out.size() < wanted) out.resize(wanted);
        const std::size_t part = std::size_t(std::min(first_.width - x0, width) * pixel);
        for (std::uint32_t y = 0; y < rows; ++y)
          std::memcpy(&out[begin + std::size_t(row_bytes_ * (y0 + y) + x0 * pixel)],
                      &piece[std::size_t(y * width * pixel)], part);
      }
  }

  SharedBytes file_;
  TiffBytes bytes_;
  struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
  };
  std::unique_ptr<TIFF, Close> tiff_;
  Page first_;
  ScalarType type_ = ScalarType::uint8;
  std::uint64_t row_bytes_ = 0;
};

}  // namespace

ScalarGrid read_tiff_stack(const Path& file, const SharedBytes& bytes, const ScalarGridOptions& options) {
  ScalarGrid grid;
  grid.format = "TIFF";
  std::vector<Path> files = {file};
  if (options.is_series) files = files_of_series(file);
  std::vector<std::byte> numbers;
  std::optional<Page> first;
  std::int64_t pages = 0;
  std::vector<GridAxis> axes;
  for (const Path& slice : files) {
    try {
      TiffPages stack(slice == file ? bytes : map_file(slice));
      if (!first) {
        first = stack.first();
        grid.type = stack.type();
        count_of({first->width, first->height, first->samples}, grid.type);
        if (!options.is_series) axes = stack.described_axes();
        if (const std::string voxel = stack.described_voxel(); !voxel.empty() && !options.spacing)
          grid.notes.push_back("states voxels of " + voxel +
                               ", which is not used: give \"spacing\" and \"file_unit\"");
      } else if (stack.first() != *first)
        throw Error("has another size or type than the first slice, " + files[0].filename().string());
      const int behind = options.is_series ? 0 : stack.slices_behind();
      if (behind > 1) {
        // The slices are those behind one page, or pages that are read one by one.
        std::vector<std::byte> read;
        const std::size_t found = stack.append(read, kMaxFiles);
        if (found == 1) {
          TiffPages again(bytes);
          grid.numbers = again.contiguous(std::uint64_t(behind));
          grid.is_swapped = again.is_swapped();
          pages = behind;
          break;
        }
        numbers = std::move(read), pages = std::int64_t(found);
        break;
      }
      pages += std::int64_t(stack.append(numbers, options.is_series ? 1 : kMaxFiles));
    } catch (const Error& problem) {
      if (slice == file || !problem.where().file.empty()) throw;
      throw Error({slice.string(), 0, 0}, problem.message());
    }
    if (slice != file) grid.further_files.push_back(slice);
  }
  count_of({first->samples, first->width, first->height, pages}, grid.type);
  if (grid.numbers.size() == 0) grid.numbers = shared(std::move(numbers));
  double slices = 1, grids = 1;
  for (const GridAxis& axis : axes) (axis.role == 'z' ? slices : grids) *= double(axis.size);
  if (grids > 1 && slices * grids != double(pages))
    throw Error(fmt::format("has {} pages, but describes {:.0f} grids (channels, instants) of {:.0f} slices",
                            pages, grids, slices));
  if (grids > 1 && slices == 1)
    grid.notes.push_back(
        fmt::format("describes {} channels or instants of one slice, which are read as slices", pages));
  if (grids == 1 || slices == 1) axes = {{pages, 'z'}};
  std::vector<GridAxis> all = {{first->samples, 'c'}, {first->width, 'x'}, {first->height, 'y'}};
  all.insert(all.end(), axes.begin(), axes.end());
  arrange(grid, all, options);
  place_by_options(grid, options);
  return grid;
}

}  // namespace aureole::grid_reader
