// SPDX-License-Identifier: Apache-2.0
// Tables of scenes that are kept for the next start: every bit of a picture stays, each input counts, and notes are
// given again.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>

#include "aureole/core/image.h"
#include "aureole/core/parallel.h"
#include "aureole/core/table_cache.h"
#include "aureole/core/table_fields.h"
#include "aureole/loading/document.h"
#include "aureole/pigment/film_theory.h"
#include "aureole/render/job.h"
#include "aureole/render/part.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/test_plugins.h"

namespace aureole::test {
namespace {

/// A ball in front of a lit wall, 12 x 8 pixels.
std::string ball_scene(const std::string& content, const std::string& film = "") {
  return R"(<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="12"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="8"/>)" +
         film + R"(</film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><translate z="-2"/></transform><bsdf type="diffuse"/></shape>
<emitter type="point"><point name="position" x="2" y="2" z="3"/></emitter>
<emitter type="constant"><float name="radiance" value="0.5"/></emitter>
<shape type="sphere">)" +
         content + "</shape></scene>";
}

struct KeptCase {
  std::string name, table, content;
};

void PrintTo(const KeptCase& c, std::ostream* out) { *out << c.name; }

const KeptCase kCases[] = {
    {"layered", "stack of layers", R"(<bsdf type="layered">
<medium type="homogeneous"><float name="sigma_t" value="2e5"/><rgb name="albedo" value="0.95, 0.8, 0.4"/></medium>
<string name="thickness" value="20um"/><string name="int_ior" value="1.5"/><string name="alpha" value="0.3"/>
<integer name="wavelengths" value="3"/><integer name="directions" value="12"/><integer name="azimuths" value="8"/>
<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf></bsdf>)"},
    {"layered_open", "stack of layers", R"(<bsdf type="layered">
<medium type="homogeneous"><float name="sigma_t" value="2e5"/><float name="albedo" value="0.9"/></medium>
<string name="thickness" value="20um"/><string name="int_ior" value="1.5"/><string name="alpha" value="0.3"/>
<integer name="wavelengths" value="2"/><integer name="directions" value="12"/><integer name="azimuths" value="8"/></bsdf>)"},
    {"roughconductor", "energy loss of a rough surface",
     R"(<bsdf type="roughconductor"><float name="alpha_u" value="0.4"/>
<float name="alpha_v" value="0.2"/><boolean name="energy_preserving" value="true"/></bsdf>)"},
    {"roughdielectric", "energy loss of a rough interface", R"(<bsdf type="roughdielectric">
<string name="int_ior" value="bk7"/><texture name="alpha" type="checkerboard"><float name="color0" value="0.2"/>
<float name="color1" value="0.5"/></texture><boolean name="energy_preserving" value="true"/></bsdf>)"},
    {"roughplastic", "rough coatings",
     R"(<bsdf type="roughplastic"><float name="alpha" value="0.2"/></bsdf>)"},
    {"paint", "rough coating", R"(<bsdf type="paint"><string name="recipe" value="white: 1 + cold yellow: 1"/>
<float name="alpha" value="0.2"/></bsdf>)"},
    {"scatterers", "layer of scatterers",
     R"(<bsdf type="correlated_scatterers"><string name="radius" value="5um"/>
<texture name="area_fraction" type="checkerboard"><float name="color0" value="0.2"/><float name="color1" value="0.5"/></texture></bsdf>)"},
    {"triangles", "layer of scatterers",
     R"(<bsdf type="correlated_scatterers"><float name="area_fraction" value="0.3"/>
<aperture type="polygon"><string name="vertices" value="-4,-3 4,-3 0,4"/><string name="unit" value="1um"/></aperture></bsdf>)"},
    {"spheres", "layer of spheres", R"(<bsdf type="correlated_spheres"><string name="radius" value="1um"/>
<float name="area_fraction" value="0.3"/><string name="int_ior" value="water"/></bsdf>)"},
    {"caps", "layer of caps", R"(<bsdf type="correlated_caps"><string name="radius" value="6um"/>
<float name="area_fraction" value="0.4"/><float name="contact_angle" value="50"/><float name="int_ior" value="1.333"/></bsdf>)"},
    {"mie", "phase function",
     R"(<bsdf type="null"/><medium name="interior" type="homogeneous"><float name="sigma_t" value="1"/>
<float name="albedo" value="0.9"/><phase type="mie"><string name="radius" value="1um"/></phase></medium>)"},
    {"suspension", "mixture of particles", R"(<bsdf type="null"/><medium name="interior" type="suspension">
<float name="host" value="1.33"/><float name="host_density" value="1000"/><ingredient type="spheres">
<string name="radius" value="200nm"/><float name="int_ior" value="1.59"/><float name="mass_fraction" value="0.001"/>
<float name="density" value="1050"/></ingredient></medium>)"},
    {"kubelka_munk", "coefficients of a paint",
     R"(<bsdf type="null"/><medium name="interior" type="kubelka_munk">
<spectrum name="k" value="400:0.4, 700:0.1"/><float name="s" value="2"/></medium>)"},
    {"bssrdf", "coefficients of a translucent body", R"(<bssrdf type="dipole">
<medium type="homogeneous"><float name="sigma_t" value="30"/><float name="albedo" value="0.9"/></medium></bssrdf>)"},
};

LoadOptions with(const std::shared_ptr<TableCache>& cache) {
  LoadOptions options;
  options.tables = cache;
  return options;
}

RenderState rendered(const LoadedScene& scene) {
  RenderOptions options;
  options.end = 16;
  options.threads = 1;
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  job.run(stop, {});
  return job.state();
}

class KeptTables : public ::testing::Test {
protected:
  std::shared_ptr<TableCache> cache() const {
    return std::make_shared<TableCache>(folder.path / "tables", 0);
  }
  LoadedScene load(const std::string& text, const std::shared_ptr<TableCache>& tables) const {
    return load_scene_from_string(text, folder.path / "scene.xml", with(tables));
  }
  /// How many tables a program makes that loads this scene.
  std::uint64_t made(const std::string& text) const {
    const auto tables = cache();
    load(text, tables);
    return tables->tables_kept();
  }
  TemporaryFolder folder;
};

class KeptTablesOf : public KeptTables, public ::testing::WithParamInterface<KeptCase> {};

TEST_P(KeptTablesOf, EveryBitOfThePictureStays) {
  const std::string text = ball_scene(GetParam().content);
  const LoadedScene without = load(text, nullptr);
  const auto first = cache(), second = cache();
  const LoadedScene making = load(text, first), reading = load(text, second);
  EXPECT_GT(first->tables_kept(), 0u);
  EXPECT_EQ(first->tables_read(), 0u);
  EXPECT_EQ(second->tables_read(), first->tables_kept());
  EXPECT_EQ(second->tables_kept(), 0u);
  bool has_kind = false;
  for (const TableEntry& e : second->entries()) has_kind = has_kind || e.table == GetParam().table;
  EXPECT_TRUE(has_kind);
  EXPECT_EQ(reading.notes, without.notes);
  EXPECT_EQ(making.notes, without.notes);
  EXPECT_EQ(reading.hash, without.hash);
  const RenderState expected = rendered(without);
  EXPECT_TRUE(same_samples(rendered(making), expected));
  EXPECT_TRUE(same_samples(rendered(reading), expected));
  // A table that is written again after it was read has the same bytes: nothing is left out or not initialised.
  for (const TableEntry& e : second->entries()) {
    const std::string bytes = file_content(e.file);
    std::filesystem::remove(e.file);
    load(text, cache());
    const std::string again = file_content(e.file);
    EXPECT_EQ(again.size(), bytes.size()) << e.table;
  }
}

TEST_P(KeptTablesOf, DamagedTablesAreMadeAgain) {
  const std::string text = ball_scene(GetParam().content);
  const RenderState expected = rendered(load(text, cache()));
  for (const TableEntry& e : cache()->entries()) {
    std::string bytes = file_content(e.file);
    bytes[bytes.size() * 2 / 3] ^= 4;
    std::ofstream(e.file, std::ios::binary) << bytes;
  }
  const auto tables = cache();
  const LoadedScene again = load(text, tables);
  EXPECT_EQ(tables->tables_read(), 0u);
  EXPECT_GT(tables->tables_kept(), 0u);
  EXPECT_TRUE(same_samples(rendered(again), expected));
  std::size_t noted = 0;
  for (const std::string& note : again.notes) noted += note.find("computed again") != std::string::npos;
  EXPECT_EQ(noted, tables->tables_kept()) << ::testing::PrintToString(again.notes);
  EXPECT_EQ(made(text), 0u) << "they are whole again";
}

INSTANTIATE_TEST_SUITE_P(All, KeptTablesOf, ::testing::ValuesIn(kCases),
                         [](const auto& info) { return info.param.name; });

std::string mie(const std::string& parameters, const std::string& film = "") {
  return ball_scene(
      R"(<bsdf type="null"/><medium name="interior" type="homogeneous"><float name="sigma_t" value="1"/>
<phase type="mie">)" +
          parameters + "</phase></medium>",
      film);
}

TEST_F(KeptTables, EveryInputCounts) {
  const std::string radius = R"(<string name="radius" value="0.3um"/>)";
  EXPECT_EQ(made(mie(radius)), 1u);
  EXPECT_EQ(made(mie(radius)), 0u);
  EXPECT_EQ(made(mie(R"(<string name="radius" value="0.31um"/>)")), 1u);
  EXPECT_EQ(made(mie(radius + R"(<float name="int_ior" value="1.5"/>)")), 1u);
  EXPECT_EQ(made(mie(radius, R"(<float name="wavelength_max" value="700"/>)")), 1u) << "another grid";
  std::string shared = mie(radius);
  shared.replace(shared.find("<phase"), 6, R"(<phase id="droplets" name="phase")");
  EXPECT_EQ(made(shared), 0u) << "names and ids do not count";
}

TEST_F(KeptTables, FilesCountByTheirContent) {
  const auto text = [](const std::string& file) {
    return mie(
        R"(<string name="radius" value="0.3um"/><float name="int_ior" value="1.4"/><spectrum name="k" filename=")" +
        file + R"("/>)");
  };
  folder.write("a.spd", "400 0.01\n700 0.02\n");
  folder.write("b.spd", "400 0.01\n700 0.02\n");
  EXPECT_EQ(made(text("a.spd")), 1u);
  EXPECT_EQ(made(text("b.spd")), 0u) << "another file of the same content";
  folder.write("a.spd", "400 0.01\n700 0.03\n");
  EXPECT_EQ(made(text("a.spd")), 1u) << "another content of the same size";
}

TEST_F(KeptTables, UnitsAndDefaultsOfTheSceneCount) {
  const auto text = [](const std::string& settings) {
    std::string t = ball_scene(kCases[0].content);
    return t.insert(t.find("<integrator"), settings);
  };
  EXPECT_EQ(made(text("")), 1u);
  EXPECT_EQ(made(text(R"(<string name="length_unit" value="mm"/>)")), 1u);
  EXPECT_EQ(made(text("")), 0u);
}

TEST_F(KeptTables, ScenesWithErrorsKeepNothing) {
  const auto tables = cache();
  EXPECT_THROW(load(mie(R"(<string name="radius" value="0.3um"/><float name="radios" value="1"/>)"), tables),
               ErrorList);
  EXPECT_THROW(load(mie(R"(<string name="radius" value="0.3um"/>)") + "<", tables), ErrorList);
}

/// A table whose computation notes something, and depends on an object of the program.
struct Noted {
  double value = 0;
  static constexpr TableKind kTable{"test table", 1};
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.value);
  }
};
struct NotedBsdf : Object {
  explicit NotedBsdf(const Properties& p) : Object(p) {
    p.find("part");
    const std::string say = p.get_string("text", "");
    const auto table = p.shared_model<Noted>([&] {
      ++made;
      if (say == "own") p.note("text", "this is noted"), p.note("", "and this");
      if (say == "other") p.context().diagnostics->note(p.where(), "noted by another object");
      return std::make_shared<const Noted>(Noted{4});
    });
    value = table ? table->value : 0;
  }
  double value = 0;
  static inline int made = 0;
};
const PluginRegistration kNoted(test_plugin<NotedBsdf>("bsdf", "test_noted", {"text", "part", "unread"}));

TEST_F(KeptTables, NotesAreGivenAgain) {
  const std::string text = "<bsdf type='test_noted'>\n<string name='text' value='own'/></bsdf>";
  const LoadedParts first = load_text(text, with(cache())), second = load_text(text, with(cache()));
  EXPECT_EQ(NotedBsdf::made, 1);
  EXPECT_EQ(first.notes, (std::vector<std::string>{"test.xml:3:1: and this", "test.xml:4:1: this is noted"}));
  EXPECT_EQ(second.notes, first.notes);
  // The place is the one where the parameter stands now.
  const LoadedParts moved = load_text("\n\n" + text, with(cache()));
  EXPECT_EQ(moved.notes, (std::vector<std::string>{"test.xml:5:1: and this", "test.xml:6:1: this is noted"}));
  EXPECT_EQ(NotedBsdf::made, 1);
}

TEST_F(KeptTables, ParametersWithoutUseAreErrorsAlsoWhereTheTableIsThere) {
  const std::string text =
      "<bsdf type='test_noted'><string name='text' value='x'/><string name='unread' value='y'/></bsdf>";
  NotedBsdf::made = 0;
  const std::string first = error_of(text, with(cache()));
  EXPECT_NE(first.find("unread"), std::string::npos) << first;
  EXPECT_EQ(NotedBsdf::made, 1);
  EXPECT_EQ(cache()->entries().size(), 1u);
  EXPECT_EQ(error_of(text, with(cache())), first);
  EXPECT_EQ(NotedBsdf::made, 1) << "the table was read";
}

TEST_F(KeptTables, ATableWhoseNotesAreOfOthersIsNotKept) {
  const std::string text = "<bsdf type='test_noted'><string name='text' value='other'/></bsdf>";
  NotedBsdf::made = 0;
  for (int i = 0; i < 2; ++i) EXPECT_EQ(load_text(text, with(cache())).notes.size(), 1u);
  EXPECT_EQ(NotedBsdf::made, 2);
  EXPECT_TRUE(cache()->entries().empty());
}

TEST_F(KeptTables, ObjectsOfTheProgramAreInNoHash) {
  LoadOptions options = with(cache());
  options.given["key"] =
      std::make_shared<TestObject>(Properties("x", "", {}, std::make_shared<BuildContext>()));
  const std::string text = "<bsdf type='test_noted'><given name='part' key='key'/></bsdf>";
  NotedBsdf::made = 0;
  for (int i = 0; i < 2; ++i) load_text(text, options);
  EXPECT_EQ(NotedBsdf::made, 2);
  EXPECT_TRUE(cache()->entries().empty());
}

TEST_F(KeptTables, AFolderThatCannotBeMadeIsNotedOnce) {
  folder.write("file", "x");
  const auto tables = std::make_shared<TableCache>(folder.path / "file", 0);
  const std::string text = ball_scene(kCases[0].content);
  const LoadedScene loaded = load(text, tables);
  std::size_t noted = 0;
  for (const std::string& note : loaded.notes) noted += note.find("tables are not kept") != std::string::npos;
  EXPECT_EQ(noted, 1u) << ::testing::PrintToString(loaded.notes);
  EXPECT_TRUE(same_samples(rendered(loaded), rendered(load(text, nullptr))));
  EXPECT_EQ(load(text, tables).notes, load(text, nullptr).notes) << "not with every scene";
}

TEST_F(KeptTables, EditsOfAnOpenSceneUseThem) {
  const std::string text = mie(R"(<string name="radius" value="0.3um"/>)");
  std::string named = text;
  named.replace(named.find("<phase"), 6, R"(<phase id="droplets")");
  EXPECT_EQ(made(mie(R"(<string name="radius" value="0.4um"/>)")), 1u);
  const auto tables = cache();
  SceneDocument document(named, folder.path / "scene.xml", with(tables));
  EXPECT_EQ(tables->tables_kept(), 1u);
  document.edit({{"droplets.radius", "<string value='0.4um'/>"}});
  EXPECT_EQ(tables->tables_read(), 1u);
  EXPECT_EQ(tables->tables_kept(), 1u);
}

TEST_F(KeptTables, PupilsOfALens) {
  const auto load_lens = [&](const std::shared_ptr<TableCache>& tables) {
    LoadOptions options = with(tables);
    options.defines = {{"width", "12"}, {"height", "8"}};
    return load_scene(source_dir() / "scenes/light/double_gauss.xml", options);
  };
  const RenderState expected = rendered(load_lens(nullptr));
  const auto first = cache(), second = cache();
  EXPECT_TRUE(same_samples(rendered(load_lens(first)), expected));
  EXPECT_EQ(first->tables_kept(), 1u);
  EXPECT_TRUE(same_samples(rendered(load_lens(second)), expected));
  EXPECT_EQ(second->tables_read(), 1u);
}

TEST_F(KeptTables, FilmsByStreams) {
  const pigment::StreamsSettings settings{.index = 1.5, .g = 0.3, .geometry = pigment::Geometry::diffuse_8};
  const pigment::StreamsTables made = pigment::streams_tables(settings, for_ranges);
  TableWriter writer;
  pigment::StreamsTables::fields(made, writer);
  pigment::StreamsTables read;
  TableReader reader(writer.bytes());
  pigment::StreamsTables::fields(read, reader);
  ASSERT_TRUE(reader.is_complete());
  const auto expected = pigment::streams_theory(settings, for_ranges),
             found = pigment::streams_theory(settings, read);
  for (const double ln_k : {-9.0, -2.0, 1.0})
    for (const double ln_s : {-3.0, 0.5, 4.0}) {
      const pigment::FilmLayer layer{ln_k, ln_s, 0};
      EXPECT_EQ(found->over(layer, 0.4).value, expected->over(layer, 0.4).value);
      EXPECT_EQ(found->opaque_value(layer), expected->opaque_value(layer));
      EXPECT_EQ(found->light(layer).inside, expected->light(layer).inside);
    }
  EXPECT_EQ(found->card(0.6), expected->card(0.6));
}

TEST_F(KeptTables, TheProgramHasTheOption) {
  const auto scene = folder.write("scene.xml", mie(R"(<string name="radius" value="8um"/>)"));
  const std::string tables = (folder.path / "tables").string();
  const auto render = [&](const std::string& choice, const std::string& output) {
    return run_program(folder.path, {"render", scene.string(), "--spp", "16", "-q", "--threads", "1", "-o",
                                     output, "--cache", choice});
  };
  ASSERT_EQ(render("off", "off.exr").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(tables));
  ASSERT_EQ(render(tables, "first.exr").exit_code, 0);
  EXPECT_EQ(cache()->entries().size(), 1u);
  ASSERT_EQ(render(tables, "second.exr").exit_code, 0);
  const auto pixels = [&](const char* name) { return read_image(folder.path / name).pixels; };
  EXPECT_EQ(pixels("first.exr"), pixels("off.exr"));
  EXPECT_EQ(pixels("second.exr"), pixels("off.exr"));

  const ProgramEnd list = run_program(folder.path, {"cache", "list", "--cache", tables});
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.output.find("phase function"), std::string::npos) << list.output;
  EXPECT_NE(list.output.find("phase mie"), std::string::npos) << list.output;
  EXPECT_NE(list.output.find("1 table,"), std::string::npos) << list.output;
  EXPECT_NE(run_program(folder.path, {"cache", "limit", "500MB", "--cache", tables})
                .output.find("at most 500.0 MB"),
            std::string::npos);
  EXPECT_NE(run_program(folder.path, {"cache", "size", "--cache", tables}).output.find("of 500.0 MB"),
            std::string::npos);
  const ProgramEnd wrong = run_program(folder.path, {"cache", "limit", "many", "--cache", tables});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.output.find("no number of bytes"), std::string::npos) << wrong.output;
  EXPECT_NE(run_program(folder.path, {"cache", "clear", "--cache", tables}).output.find("1 table removed"),
            std::string::npos);
  EXPECT_TRUE(cache()->entries().empty());
  const ProgramEnd off = run_program(folder.path, {"cache", "list", "--cache", "off"});
  EXPECT_EQ(off.exit_code, 2);
  EXPECT_NE(off.output.find("the cache is off"), std::string::npos) << off.output;
}

}  // namespace
}  // namespace aureole::test
