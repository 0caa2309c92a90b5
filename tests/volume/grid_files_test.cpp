// SPDX-License-Identifier: Apache-2.0
// Files of grids: what other programs read from them (tests/volume/data/make_heads.py), and files that are wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "aureole/loading/load.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "harness/paths.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

fs::path heads() { return source_dir() / "tests/volume/data/heads"; }

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

struct HeadLine {
  std::string file, parameters, judge, text;
  int index[4];
  double world_mm[3];
  float value;
};

std::vector<HeadLine> head_lines() {
  std::vector<HeadLine> lines;
  std::ifstream in(source_dir() / "tests/volume/data/heads.txt");
  for (std::string line; std::getline(in, line);) {
    const std::vector<std::string> parts = split(line, ';');
    HeadLine& l =
        lines.emplace_back(HeadLine{parts[0], parts[1], parts[2], line, {}, {}, std::stof(parts[5])});
    std::istringstream index(parts[3]), world(parts[4]);
    for (int& i : l.index) index >> i;
    for (double& x : l.world_mm) world >> x;
  }
  return lines;
}

std::array<double, 3> three(const std::string& text) {
  const std::vector<std::string> n = split(text, ',');
  return {std::stod(n[0]), std::stod(n[1]), std::stod(n[2])};
}

ScalarGridOptions options_of(const std::string& parameters) {
  ScalarGridOptions o;
  for (const std::string& word : split(parameters, ' ')) {
    const std::string value = word.substr(std::min(word.find('=') + 1, word.size()));
    if (word.starts_with("frame=")) o.frame = std::stoi(value);
    if (word.starts_with("array=")) o.array = value;
    if (word.starts_with("series=")) o.is_series = true;
    if (word.starts_with("spacing=")) o.spacing = three(value);
    if (word.starts_with("origin=")) o.origin = three(value);
  }
  return o;
}

std::string xml_of(const std::string& parameters) {
  std::string xml;
  for (const std::string& word : split(parameters, ' ')) {
    const std::string name = word.substr(0, word.find('='));
    const std::string value = word.substr(std::min(word.find('=') + 1, word.size()));
    const auto add = [&](const char* tag) {
      xml += std::string("<") + tag + " name=\"" + name + "\" value=\"" + value + "\"/>";
    };
    if (name == "frame") add("integer");
    if (name == "array") add("string");
    if (name == "series" || name == "raw") add("boolean");
    if (name == "spacing") add("vector");
    if (name == "origin") add("point");
  }
  return xml;
}

void expect_part(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
}

/// Distance of the corners of the grid of make_heads.py.
constexpr double kHeadSizeMm = 7;

// nibabel, pynrrd, SimpleITK, vtk and tifffile judge.
TEST(GridFiles, VoxelsLieAndCountAsOtherProgramsRead) {
  std::string last;
  ScalarGrid grid;
  int files = 0;
  for (const HeadLine& line : head_lines()) {
    if (const std::string key = line.file + line.parameters; key != last) {
      ASSERT_NO_THROW(grid = read_scalar_grid(heads() / line.file, options_of(line.parameters))) << line.text;
      last = key, ++files;
      EXPECT_EQ(grid.size, (std::array<int, 3>{5, 4, 3})) << line.text;
    }
    const auto& [i, j, k, c] = line.index;
    EXPECT_FLOAT_EQ(grid.value(i, j, k, c), line.value) << line.text;
    const Transform::Matrix m = grid.index_to_world(1e-3).matrix();
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(m[a][0] * i + m[a][1] * j + m[a][2] * k + m[a][3], line.world_mm[a], 1e-6 * kHeadSizeMm)
          << line.text;
  }
  EXPECT_EQ(files, 126);
}

// Formats that can state where a grid lies, with one grid.
TEST(GridFiles, OneHeadLiesInOnePlaceInAllFormats) {
  const Transform::Matrix first = read_scalar_grid(heads() / "int16.nrrd").index_to_world(1e-3).matrix();
  for (const char* name : {"int16.mha", "int16.nii", "int16.vti", "qform.nii", "second.nii", "ras_gzip.nrrd",
                           "las_bzip2.nrrd", "extent.vti", "detached.mhd", "pair.hdr"}) {
    const ScalarGrid grid = read_scalar_grid(heads() / name);
    const Transform::Matrix m = grid.index_to_world(1e-3).matrix();
    for (const std::array<int, 3> at : {std::array{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 2}, {4, 3, 2}}) {
      double error = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        double difference = m[a][3] - first[a][3];
        for (std::size_t k = 0; k < 3; ++k) difference += (m[a][k] - first[a][k]) * at[k];
        error = std::max(error, std::abs(difference));
      }
      EXPECT_LT(error, 1e-6 * kHeadSizeMm) << name;
    }
  }
}

std::shared_ptr<BuildContext> millimetres(Diagnostics* diagnostics = nullptr) {
  auto context = std::make_shared<BuildContext>(*testing::make_context(360, 830, diagnostics));
  context->length_unit_m = 1e-3;
  return context;
}

// In a scene whose unit is the millimetre, the value at each centre is that of the voxel.
TEST(GridFiles, ScenesHaveThemWhereTheyLie) {
  std::string last;
  VolumePtr volume;
  for (const HeadLine& line : head_lines()) {
    if (const std::string key = line.file + line.parameters; key != last) {
      last = key;
      ASSERT_NO_THROW(volume = testing::build<Volume>(grid_xml(heads() / line.file, xml_of(line.parameters)),
                                                      millimetres()))
          << line.text;
    }
    const Vec3 p{float(line.world_mm[0]), float(line.world_mm[1]), float(line.world_mm[2])};
    std::vector<float> values(std::size_t(volume->channels()));
    volume->eval_channels(p, values.data());
    // Half a unit in the last place of a coordinate, times the gradient.
    EXPECT_NEAR(values[std::size_t(line.index[3])], line.value, 2e-3) << line.text;
  }
}

TEST(GridFiles, UnitsAndSpacesMayBeStatedInstead) {
  ScalarGridOptions o;
  o.unit_m = 1e-2;
  EXPECT_EQ(read_scalar_grid(heads() / "micron.nii", o).unit_m, 1e-2);
  EXPECT_EQ(read_scalar_grid(heads() / "micron.nii").unit_m, 1e-6);
  EXPECT_TRUE(read_scalar_grid(heads() / "micron.nii").unit_is_stated);
  EXPECT_FALSE(read_scalar_grid(heads() / "int8.vti").unit_is_stated);
  o.space = "LPS";
  const auto m = read_scalar_grid(heads() / "int8.vti", o).index_to_ras.matrix();
  EXPECT_NEAR(m[0][3], 31.5, 1e-12);
  EXPECT_NEAR(m[1][3], -12.25, 1e-12);
  EXPECT_NEAR(m[2][3], 77, 1e-12);
  // Boxes of .vol files are in the scene's unit, unless another is stated.
  VolumeFolder folder;
  VolFile vol = make_vol({2, 1, 1}, 1, {3, 5});
  vol.box = {0, 0, 0, 4, 1, 1};
  const auto file = write_bytes(folder.path() / "a.vol", vol.bytes());
  const std::string box = R"(<boolean name="use_grid_bbox" value="true"/>)";
  EXPECT_EQ(build_grid(file, box)->eval_scalar({2, .5f, .5f}), 4);
  EXPECT_FLOAT_EQ(build_grid(file, box + choice("file_unit", "1mm"))->eval_scalar({.002f, .5f, .5f}), 4);
  EXPECT_EQ(build_grid(file, choice("placement", "file"))->eval_scalar({2, .5f, .5f}), 4);
  expect_part(error_thrown_by([&] { build_grid(file, box + choice("placement", "unit_cube")); }),
              "contradicts");
  // The unit cube is filled whatever the file says: the first of 5 x 4 x 3 voxels is centred at 1/10, 1/8, 1/6.
  const VolumePtr cube = build_grid(heads() / "int16.nii", choice("placement", "unit_cube"));
  EXPECT_NEAR(cube->eval_scalar({.1f, .125f, 1.f / 6}), -100, 1e-3);
  const VolumePtr array = build_grid(heads() / "int16.npy");
  EXPECT_NEAR(array->eval_scalar({.1f, .125f, 1.f / 6}), -100, 1e-3);
}

TEST(GridFiles, ArraysOfAProgramHaveASpacing) {
  Diagnostics diagnostics;
  const PluginInfo* plugin = Registry::instance().find("volume", "gridvolume");
  const auto volume_of = [&](const char* placement) {
    Properties p("gridvolume", "", {}, millimetres(&diagnostics), plugin);
    p.add("data",
          ObjectPtr(std::make_shared<Array>(std::vector<std::size_t>{1, 2, 3},
                                            std::vector<double>{0, 1, 2, 3, 4, 5})),
          {});
    p.add("spacing", Vec3{2, 4, 8}, {"a.xml", 2, 1});
    p.add("origin", Vec3{10, 20, 30}, {"a.xml", 3, 1});
    p.add("placement", std::string(placement), {});
    return std::dynamic_pointer_cast<const Volume>(plugin->create(p));
  };
  EXPECT_EQ(volume_of("file")->eval_scalar({12, 24, 30}), 4);
  EXPECT_TRUE(diagnostics.notes().empty());
  // In the unit cube they have no effect, which is noted.
  EXPECT_EQ(volume_of("unit_cube")->eval_scalar({.5f, .75f, .5f}), 4);
  EXPECT_EQ(diagnostics.notes().size(), 2u);
}

TEST(GridFiles, RawNumbersBelowZeroByRoundingStay) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "a.nrrd",
                                "NRRD0001\ntype: float\ndimension: 3\nsizes: 2 1 1\nspacings: 1 1 1\n"
                                "encoding: ascii\n\n1 -1e-7\n");
  EXPECT_EQ(build_grid(file)->minimum(), 0);
  EXPECT_EQ(build_grid(file, R"(<boolean name="raw" value="true"/>)")->minimum(), -1e-7f);
}

// Numbers in a file that the scene does not name belong to it, too.
TEST(GridFiles, FurtherFilesBelongToTheHashOfTheScene) {
  VolumeFolder folder;
  for (const char* name : {"skip.nhdr", "skip.raw"}) fs::copy_file(heads() / name, folder.path() / name);
  const auto scene = write_bytes(
      folder.path() / "scene.xml",
      "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\"/><shape type=\"sphere\">"
      "<bsdf type=\"null\"/><medium type=\"heterogeneous\" name=\"interior\"><volume type=\"gridvolume\" "
      "name=\"sigma_t\"><string name=\"filename\" value=\"skip.nhdr\"/></volume></medium></shape></scene>");
  const std::uint64_t before = load_scene(scene).hash;
  EXPECT_EQ(load_scene(scene).hash, before);
  write_bytes(folder.path() / "skip.raw", "two\nlines\nxyz" + std::string(120, '\1'));
  EXPECT_NE(load_scene(scene).hash, before);
}

// A hole on the disc: opening must not read it, nor take its size in memory.
TEST(GridFiles, LargeFilesAreMapped) {
  VolumeFolder folder;
  const auto data = folder.path() / "large.raw";
  write_bytes(data, "\x07");
  fs::resize_file(data, std::uintmax_t(2) << 30);
  const auto file = write_bytes(folder.path() / "large.mhd",
                                "NDims = 3\nDimSize = 1024 1024 1024\nElementType = MET_USHORT\n"
                                "ElementSpacing = 1 1 1\nElementDataFile = large.raw\n");
  const ScalarGrid grid = read_scalar_grid(file);
  EXPECT_EQ(grid.numbers.size(), std::size_t(2) << 30);
  EXPECT_EQ(grid.value(0, 0, 0), 7);
  EXPECT_EQ(grid.value(1023, 1023, 1023), 0);
  EXPECT_EQ(grid.further_files, std::vector<fs::path>{data});
}

/// The message with which a file of that content fails.
std::string grid_error(const std::string& content, const ScalarGridOptions& options = {},
                       const std::string& name = "bad.file") {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / name, content);
  const std::string message = error_thrown_by([&] { read_scalar_grid(file, options); });
  const std::string start = file.string() + ":";
  EXPECT_TRUE(message.empty() || message.starts_with(start)) << message;
  return message.empty() ? "" : message.substr(start.size());
}
std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}
TEST(GridFiles, BadNrrd) {
  const std::string good =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 1\nspace: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
      "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n12345678";
  EXPECT_EQ(grid_error(good), "");
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    expect_part(grid_error(changed(good, from, to)), part);
  };
  expect("NRRD0004", "NRRD0009", "1: has \"NRRD0009\"");
  expect("short", "block", "2: has numbers of the type \"block\"");
  expect("dimension: 3", "dimension: 4", "4: has 3 sizes and the dimension 4");
  expect("2 2 1", "2 2 0", "4: has sizes 2 x 2 x 0");
  expect("2 2 1", "1000000 1000000 1000000", "is truncated");
  expect("2 2 1", "1048576 1048576 1048576", "need 2305843009213693952 bytes");
  expect("12345678", "1234567", "need 8 bytes, but there are 7");
  expect("(1,0,0)", "(0,0,0)", "6: has voxels at a distance of 0 along its axis x");
  expect("(1,0,0)", "(nan,0,0)", "6: has voxels at a distance of nan");
  expect("(1,0,0)", "(0,2,0)", "6: has axes in one plane");
  expect("(1,0,0)", "(1,0)", "where three numbers");
  expect("(1,0,0)", "none", "not exactly three axes of space");
  expect("(0,0,0)", "(0,inf,0)", "finite coordinates are expected");
  expect("LPS", "XYZ", "5: has the space \"XYZ\"");
  expect("little", "middle", "8: has the endian \"middle\"");
  expect("encoding: raw", "encoding: zrl", "9: has the encoding \"zrl\"");
  expect("encoding: raw", "encoding: gzip", "damaged data compressed");
  expect("encoding: raw", "encoding: bzip2", "damaged data compressed by bzip2");
  expect("encoding: raw", "encoding: hex", "is truncated");
  expect("encoding: raw", "encoding: ascii", "has \"12345678\" where a whole number from -32768 to 32767");
  expect("encoding: raw\n\n12345678", "encoding: ascii\n\n1 2 3 ", "is truncated");
  expect("encoding: raw", "encodign: raw", "did you mean \"encoding\"");
  expect("encoding: raw", "encoding: raw\nendian: big", "twice");
  expect("encoding: raw", "encoding: raw\nspace units: \"parsec\"", "unknown; \"file_unit\"");
  expect("encoding: raw", "encoding: raw\ndata file: gone.raw", "gone.raw: no such file");
  expect("encoding: raw", "encoding: raw\ndata file: a%s.raw 1 3 1", "needs one number");
  expect("encoding: raw", "encoding: raw\ndata file: a%d.raw 1 300000000 1", "files are possible");
  expect("space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)", "spacings: 1 0 1",
         "6: has voxels at a distance of 0 along its axis y");
  EXPECT_EQ(grid_error(changed(good, "encoding: raw", "encoding: raw\nbyte skip: -1")), "");
  // Without a distance, the parameters state it; where there is one, they are an error.
  ScalarGridOptions o;
  o.spacing = {1, 2, 3};
  expect_part(grid_error(good, o), "states the distance of its voxels itself");
  o.spacing = std::nullopt, o.frame = 1;
  expect_part(grid_error(good, o), "has no frame 1");
}

TEST(GridFiles, BadMetaImages) {
  const std::string good =
      "NDims = 3\nDimSize = 2 2 1\nElementType = MET_SHORT\nElementSpacing = 1 1 1\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n12345678";
  EXPECT_EQ(grid_error(good), "");
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    expect_part(grid_error(changed(good, from, to)), part);
  };
  expect("NDims = 3", "NDims = 2", "1: has 2 dimensions");
  expect("2 2 1", "2 2", "2: has 2 sizes for 3 dimensions");
  expect("2 2 1", "1000000 1000000 1000000", "is truncated");
  expect("MET_SHORT", "MET_STRING", "3: has numbers of the type \"MET_STRING\"");
  expect("= 1 1 1", "= 1 0 1", "4: has voxels at a distance of 0 along its axis y");
  expect("= 1 1 1", "= 1 nan 1", "4: has voxels at a distance of nan");
  expect("1 0 0 0 1 0", "1 0 0 1 0 0", "5: has axes in one plane");
  expect("12345678", "1", "need 8 bytes");
  expect("LOCAL", "gone.raw", "gone.raw: no such file");
  expect("LOCAL", "..", "not a regular file but a folder");
  expect("ElementDataFile", "CompressedData = True\nElementDataFile", "damaged data compressed");
  expect("ElementDataFile", "CompressedData = perhaps\nElementDataFile", "True or False");
}

/// A header of NIfTI-1 of int16 with numbers behind it.
std::string nifti(const std::vector<std::int16_t>& dim, std::size_t numbers = 4) {
  std::string s(352, '\0');
  const auto put = [&](std::size_t at, auto v) { std::memcpy(&s[at], &v, sizeof v); };
  put(0, std::int32_t(348));
  for (std::size_t i = 0; i < dim.size(); ++i) put(40 + 2 * i, dim[i]);
  put(70, std::int16_t(4)), put(72, std::int16_t(16));
  for (std::size_t i = 0; i < 4; ++i) put(76 + 4 * i, 1.f);
  put(108, 352.f);
  std::memcpy(&s[344], "n+1", 4);
  return s + std::string(2 * numbers, '\1');
}
template <class T>
std::string with(std::string s, std::size_t at, T v) {
  std::memcpy(&s[at], &v, sizeof v);
  return s;
}

TEST(GridFiles, BadNifti) {
  const std::string good = nifti({3, 2, 2, 1});
  EXPECT_EQ(grid_error(good), "");
  expect_part(grid_error(good.substr(0, 300)), "too short");
  expect_part(grid_error(nifti({2, 2, 2})), "has 2 dimensions");
  expect_part(grid_error(nifti({3, 2, -2, 1})), "has sizes 2 x -2 x 1");
  expect_part(grid_error(nifti({3, 32767, 32767, 32767})), "is truncated");
  expect_part(grid_error(nifti({3, 2, 2, 1}, 3)), "need 8 bytes, but there are 6");
  expect_part(grid_error(with(good, 70, std::int16_t(32))), "has numbers of the type 32");
  expect_part(grid_error(with(good, 108, NAN)), "vox_offset");
  expect_part(grid_error(with(good, 108, 8.f)), "lies in the header");
  expect_part(grid_error(with(good, 80, 0.f)), "distance of 0 along its axis x");
  expect_part(grid_error(with(good, 80, NAN)), "distance of nan along its axis x");
  expect_part(grid_error(with(good, 254, std::int16_t(1))),
              "distance of 0 along its axis x");  // a sform of 0
  expect_part(grid_error(with(with(good, 252, std::int16_t(1)), 256, 3.f)), "quaternion");
  expect_part(grid_error(with(good, 123, std::uint8_t(5))), "unit of length 5");
  expect_part(grid_error(with(good, 345, 'x')), "ANALYZE");
  expect_part(grid_error(with(good, 345, 'i')), "does not end in .hdr");
  expect_part(grid_error(with(good, 345, 'i'), {}, "bad.hdr"), "bad.img: no such file");
  expect_part(grid_error(with(good, 345, 'i'), {}, "bad.HDR"), "bad.img: no such file");
  expect_part(grid_error(with(good, 345, 'i'), {}, "bad.Hdr.GZ"), "bad.img: no such file");
  expect_part(grid_error("\x1f\x8b\x08 nothing"), "gzip");
}

TEST(GridFiles, BadVti) {
  const std::string good =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\">\n"
      "<ImageData WholeExtent=\"0 1 0 1 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\" Direction=\"1 0 0 0 1 0 0 0 1\">\n"
      "<Piece Extent=\"0 1 0 1 0 0\">\n<PointData Scalars=\"a\">\n"
      "<DataArray type=\"Int16\" Name=\"a\" format=\"ascii\">\n1 2 3 4</DataArray>\n"
      "</PointData></Piece></ImageData></VTKFile>\n";
  EXPECT_EQ(grid_error(good), "");
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    expect_part(grid_error(changed(good, from, to)), part);
  };
  expect("ImageData\"", "PolyData\"", "2: holds \"PolyData\"");
  expect("LittleEndian", "PDP", "2: has the byte_order");
  expect("LittleEndian\"", "LittleEndian\" compressor=\"vtkOtherCompressor\"", "2: is compressed by");
  expect("Spacing=\"1 1 1\"", "Spacing=\"1 0 1\"", "3: has the spacing 0");
  expect("Spacing=\"1 1 1\"", "Spacing=\"1 1\"", "3: has 2 numbers");
  expect("1 0 0 0 1 0 0 0 1", "1 1 0 0 0 0 0 0 1", "3: has axes in one plane");
  expect("Piece Extent=\"0 1", "Piece Extent=\"0 9", "4: has a piece that is not the whole");
  expect("Int16", "String", "6: has numbers of the type \"String\"");
  expect("3 4<", "3<", "6: is truncated");
  expect("3 4<", "3 four<", "6: has \"four\"");
  expect("ascii", "binary", "6: ");
  expect("ascii", "appended", "6: is appended");
  expect("</PointData>", "", "is no well-formed XML");
  ScalarGridOptions o;
  o.array = "b";
  expect_part(grid_error(good, o), "has no array \"b\"");
  std::string large = good;
  for (int i = 0; i < 2; ++i) large = changed(large, "0 1 0 1 0 0", "0 999999 0 999999 0 9999");
  expect_part(grid_error(large), "is truncated");
}

TEST(GridFiles, BadArraysAndPictures) {
  const auto npy = [](std::string dictionary, const std::string& numbers) {
    dictionary += '\n';
    return std::string("\x93NUMPY\x01\x00", 8) + char(dictionary.size()) + '\0' + dictionary + numbers;
  };
  const std::string good = "{'descr': '<u2', 'fortran_order': False, 'shape': (1, 2, 2), }";
  EXPECT_EQ(grid_error(npy(good, "12345678")), "");
  expect_part(grid_error(npy(good, "1234567")), "is truncated");
  expect_part(grid_error(npy(changed(good, "<u2", "|O"), "12345678")), "has numbers of the type \"|O\"");
  expect_part(grid_error(npy(changed(good, "(1, 2, 2)", "(4,)"), "12345678")), "has an array of 1 axes");
  expect_part(grid_error(npy(changed(good, "(1, 2, 2)", "(99999, 99999, 99999)"), "12345678")),
              "is truncated");
  expect_part(grid_error(npy(changed(good, "'shape'", "'form'"), "12345678")), "has no \"shape\"");
  expect_part(grid_error(std::string("II*\0\x08\0\0\0", 8)), "TIFF");
  ScalarGridOptions o;
  o.is_series = true;
  expect_part(grid_error(npy(good, "12345678"), o), "only slices in TIFF");
  VolumeFolder folder;
  for (const char* number : {"1", "2", "4"})
    fs::copy_file(heads() / "series8.tif", folder.path() / (std::string("s") + number + ".tif"));
  expect_part(error_thrown_by([&] { read_scalar_grid(folder.path() / "s1.tif", o); }),
              "a gap or a number twice");
}

/// The notes of a grid of a scene, a line each.
std::string notes_of_grid(const fs::path& file, const std::string& parameters = "") {
  Diagnostics diagnostics;
  testing::build<Volume>(grid_xml(file, parameters), millimetres(&diagnostics));
  std::string all;
  for (const std::string& note : diagnostics.notes()) all += note + "\n";
  return all;
}

// Contents of a file that are not read are noted.
TEST(GridFiles, WhatIsNotReadIsNoted) {
  const std::string frame = R"(<integer name="frame" value="0"/>)";
  expect_part(notes_of_grid(heads() / "frames.nii"),
              "has 2 grids, of which the first is read; \"frame\" chooses");
  EXPECT_EQ(notes_of_grid(heads() / "frames.nii", frame).find("grids"), std::string::npos);
  expect_part(notes_of_grid(heads() / "named.vti"), "\"two\"");
  expect_part(notes_of_grid(heads() / "named.vti"), "is read; \"array\" chooses another");
  EXPECT_EQ(notes_of_grid(heads() / "named.vti", choice("array", "two")), "");
  EXPECT_EQ(notes_of_grid(heads() / "int16.vti"), "");
  // The stack states 2 and 4 pixels, and 1/2.5 slices, in a micrometre.
  expect_part(notes_of_grid(heads() / "hyper.tif", frame),
              "states voxels of 0.5 x 0.25 x 2.5 um, which is not used");
  EXPECT_EQ(notes_of_grid(heads() / "hyper.tif", frame + R"(<vector name="spacing" x="1" y="1" z="1"/>)"),
            "");
  EXPECT_EQ(notes_of_grid(heads() / "int16.nrrd"), "");
  EXPECT_EQ(notes_of_grid(heads() / "detached.mhd"), "");
  VolumeFolder folder;
  const std::string
      nrrd = "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nspacings: 1 1 1\nencoding: raw\n\n1234",
      mha =
          "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\n"
          "ElementDataFile = LOCAL\n1234";
  for (const std::string& header : {nrrd, mha}) {
    const fs::path file = folder.path() / "a.grid";
    EXPECT_EQ(notes_of_grid(write_bytes(file, header)), "");
    EXPECT_EQ(notes_of_grid(write_bytes(file, header + "\r\n")), "");
    expect_part(notes_of_grid(write_bytes(file, header + std::string(12, '5'))),
                "has 12 bytes more than its 4 numbers of the type uint8 need");
  }
}

// Channels and instants of a stack are grids, which its pages may not contradict.
TEST(GridFiles, StacksOfSeveralGrids) {
  EXPECT_EQ(read_scalar_grid(heads() / "hyper.tif").frames, 4);
  EXPECT_EQ(read_scalar_grid(heads() / "several.ome.tif").frames, 4);
  EXPECT_EQ(read_scalar_grid(heads() / "imagej.tif").frames, 1);
  const auto content = [](const char* name) {
    std::ifstream in(heads() / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  expect_part(grid_error(changed(content("hyper.tif"), "channels=2", "channels=3")),
              "has 12 pages, but describes 6 grids (channels, instants) of 3 slices");
  expect_part(grid_error(changed(content("several.ome.tif"), "SizeT=\"2\"", "SizeT=\"9\"")),
              "describes 18 grids");
  // Pages of one slice each stay a stack, with a note.
  VolumeFolder folder;
  const std::string flat =
      changed(changed(content("hyper.tif"), "slices=3", "slices=1"), "frames=2", "frames=6");
  const ScalarGrid grid = read_scalar_grid(write_bytes(folder.path() / "flat.tif", flat));
  EXPECT_EQ(grid.size[2], 12);
  EXPECT_EQ(grid.frames, 1);
  ASSERT_FALSE(grid.notes.empty());
  expect_part(grid.notes.back(), "12 channels or instants of one slice, which are read as slices");
}

TEST(GridFiles, OtherFormatsAreNamed) {
  expect_part(grid_error(std::string(128, '\0') + "DICM" + std::string(64, '\1')), "is DICOM");
  expect_part(grid_error("# vtk DataFile Version 3.0\n"), "save its grid as .vti");
  expect_part(grid_error(std::string("PK\x03\x04", 4) + "array"), ".npz");
  expect_part(grid_error("\x89HDF\r\n"), "is HDF5");
  expect_part(grid_error(""), "is empty");
}

TEST(GridFiles, NumbersThatAreNotFiniteAreErrorsOfTheScene) {
  VolumeFolder folder;
  const auto file = write_bytes(folder.path() / "nan.nrrd",
                                "NRRD0001\ntype: float\ndimension: 3\nsizes: 2 2 1\nspacings: 1 1 1\n"
                                "encoding: ascii\n\n1 2 nan 4\n");
  const std::string message = error_thrown_by([&] { build_grid(file); });
  expect_part(message, "nan.nrrd: holds nan at x = 0, y = 1, z = 0");
  expect_part(message, "snippet:1");
  expect_part(error_thrown_by([&] { build_grid(write_bytes(folder.path() / "a.bin", "nothing known")); }),
              "as no format of volumes does");
}

}  // namespace
}  // namespace aureole::test
