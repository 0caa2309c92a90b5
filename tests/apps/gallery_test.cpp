// SPDX-License-Identifier: Apache-2.0
// aureole gallery: the gallery of the repository is sound, a page grows figure by figure, what is done stays
// done, and mistakes in a gallery.json are errors with their line.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

#include "aureole/core/image.h"
#include "harness/paths.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Defines = std::vector<std::pair<std::string, std::string>>;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void add(Defines& out, const Json& defines) {
  for (const auto& [name, v] : defines.items()) {
    std::erase_if(out, [&](const auto& d) { return d.first == name; });
    out.emplace_back(name, v.is_string() ? v.get<std::string>() : v.dump());
  }
}

/// Every value of every axis, the other axes at their first values.
std::vector<Defines> variants(const Json& table) {
  Defines first;
  add(first, table.value("defines", Json::object()));
  std::vector<Json> axes;
  for (const char* side : {"rows", "columns"})
    for (const Json& axis : table.value(side, Json::array())) axes.push_back(axis.at("values"));
  for (const Json& values : axes) add(first, values.at(0).value("defines", Json::object()));
  std::vector<Defines> out{first};
  for (const Json& values : axes)
    for (std::size_t i = 1; i < values.size(); ++i) {
      out.push_back(first);
      add(out.back(), values[i].value("defines", Json::object()));
    }
  return out;
}

/// Loads a scene in a small size, which its film must take, and returns what it notes.
std::vector<std::string> load_small(const fs::path& scene, Defines defines) {
  defines.emplace_back("width", "12"), defines.emplace_back("height", "8");
  LoadOptions options;
  options.defines = defines;
  const LoadedScene loaded = load_scene(scene, options);
  const Film& film = loaded.scene->film();
  EXPECT_EQ(film.width(), 12) << "the scene does not take its size from $width";
  EXPECT_EQ(film.height(), 8);
  return loaded.notes;
}

TEST(CoronaGallery, EverySceneLoadsWithEveryValue) {
  const fs::path folder = source_dir() / "scenes" / "corona";
  const Json gallery = Json::parse(content(folder / "gallery.json"));
  std::vector<std::string> ids;
  int scenes = 0;
  for (const Json& figure : gallery.at("figures")) {
    ids.push_back(figure.at("id"));
    EXPECT_FALSE(figure.at("agreement").get<std::string>().empty()) << ids.back();
    for (const Json& table : figure.value("renders", Json::array()))
      for (const Defines& defines : variants(table)) {
        EXPECT_NO_THROW({
          const auto notes = load_small(folder / table.at("scene").get<std::string>(), defines);
          EXPECT_TRUE(notes.empty()) << notes.front();
        }) << ids.back();
        ++scenes;
      }
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"fig01", "fig04", "fig06", "fig07", "fig08", "fig09", "fig10",
                                           "fig11", "fig12", "fig13", "fig14"}));
  EXPECT_GT(scenes, 20);
}

TEST(MediaGallery, EverySceneLoads) {
  const fs::path folder = source_dir() / "scenes" / "media";
  const Json gallery = Json::parse(content(folder / "gallery.json"));
  std::vector<std::string> ids;
  for (const Json& figure : gallery.at("figures")) {
    ids.push_back(figure.at("id"));
    for (const Json& table : figure.at("renders")) {
      Defines defines = variants(table).front();
      // Tables of large spheres take minutes, which the figures of one scene need not spend here.
      for (auto& [name, value] : defines)
        if (name == "radius") value = "0.5um";
      EXPECT_NO_THROW(load_small(folder / table.at("scene").get<std::string>(), defines)) << ids.back();
    }
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"milk", "wine", "fog", "rainbow", "fogbow", "glory", "fire",
                                           "solids", "turbid", "powder", "sky"}));
}

/// Loads every scene of a gallery with every value and returns the names of its figures.
std::vector<std::string> load_figures(const char* name) {
  const fs::path folder = source_dir() / "scenes" / name;
  const Json gallery = Json::parse(content(folder / "gallery.json"));
  std::vector<std::string> ids;
  for (const Json& figure : gallery.at("figures")) {
    ids.push_back(figure.at("id"));
    if (figure.contains("needs") && !fs::exists(folder / figure["needs"].at("file").get<std::string>()))
      continue;
    for (const Json& table : figure.value("renders", Json::array()))
      for (const Defines& defines : variants(table))
        EXPECT_NO_THROW(load_small(folder / table.at("scene").get<std::string>(), defines)) << ids.back();
  }
  return ids;
}

TEST(PaintGallery, EverySceneLoads) {
  EXPECT_EQ(load_figures("paint"),
            (std::vector<std::string>{"chart", "glaze", "varnish", "rutile", "metamers"}));
}

TEST(LaboratoryGallery, EverySceneLoads) {
  EXPECT_EQ(load_figures("laboratory"),
            (std::vector<std::string>{"sphere", "goniometer", "balls", "instruments", "edge_loss", "lobes"}));
}

TEST(VolumesGallery, EverySceneLoads) {
  EXPECT_EQ(load_figures("volumes"),
            (std::vector<std::string>{"part", "orbital", "head", "forms", "steps", "edges"}));
}

TEST(DiffractionGallery, EverySceneLoads) {
  EXPECT_EQ(load_figures("diffraction"),
            (std::vector<std::string>{"edge_functions", "edge_amplitudes", "edge_approximation", "wedge",
                                      "openings", "double_slit", "field_maps", "star", "two_slits", "mesh",
                                      "comb", "razor", "fringes", "patterns", "block", "leaves", "window",
                                      "street", "street_polarised"}));
}

TEST(DiffractionGallery, TheSolversNumbersAreThoseOfTheTest) {
  const Json gallery = Json::parse(content(source_dir() / "scenes" / "diffraction" / "gallery.json"));
  std::vector<double> solver;
  for (const Json& figure : gallery.at("figures"))
    for (const Json& plot : figure.value("plots", Json::array()))
      if (plot.at("kind") == "slits_and_solver") plot.at("solver").get_to(solver);
  const std::string rows =
      content(source_dir() / "tests" / "optics" / "diffraction" / "references" / "bem_references.inc");
  std::vector<double> expected;
  const std::regex row(R"(\{"slits", \d+, ([^}]+)\})");
  for (auto i = std::sregex_iterator(rows.begin(), rows.end(), row); i != std::sregex_iterator(); ++i)
    expected.push_back(std::stod((*i)[1]));
  EXPECT_EQ(solver, expected);
}

struct Outcome {
  int exit_code;
  std::string output;  ///< stdout and stderr
};

class GalleryCommand : public ::testing::Test {
protected:
  void SetUp() override {
    std::string text = small_scene_text(12, 8);
    const auto replace = [&](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    replace("name=\"width\" value=\"12\"", "name=\"width\" value=\"$width\"");
    replace("name=\"height\" value=\"8\"", "name=\"height\" value=\"$height\"");
    replace("name=\"fov\" value=\"45\"", "name=\"fov\" value=\"$fov\"");
    replace("<integrator", "<default name=\"fov\" value=\"45\"/><integrator");
    folder.write("scenes/tiny/tiny.xml", text);
    write(figures());
  }
  static Json effort(int spp) { return {{"size", {12, 8}}, {"spp", spp}}; }
  static Json table(int spp = 16) {
    return {{"scene", "tiny.xml"}, {"preview", effort(spp)}, {"full", effort(2 * spp)}};
  }
  static Json figures() {
    Json one = table(), two = table();
    two["columns"] = {{{"values",
                        {{{"label", "wide"}, {"defines", {{"fov", 60}}}},
                         {{"label", "<narrow>"}, {"defines", {{"fov", "20"}}}}}}}};
    two["reference"] = {{"preview", {{"spp", 64}}}, {"full", {{"spp", 64}}}};
    two["tone"] = {{"exposure", 1}, {"compression", 5}};
    return {{{"id", "one"}, {"title", "One & only"}, {"caption", "c"}, {"renders", {one}}},
            {{"id", "two"},
             {"title", "Two"},
             {"caption", "c"},
             {"renders", {two}},
             {"plots", {{{"kind", "structure_map"}, {"u", 20}, {"highest", 2}}}}}};
  }
  void write(const Json& figures) { write_text(Json({{"title", "Tiny"}, {"figures", figures}}).dump(1)); }
  void write_text(const std::string& text) { folder.write("scenes/tiny/gallery.json", text); }

  pid_t start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {aureole_binary().string(), "gallery", "tiny", "--threads", "1", "--scenes",
                      (folder.path / "scenes").string(), "-o", out().string()});
    const pid_t pid = fork();
    if (pid == 0) {
      if (!freopen((folder.path / "log.txt").c_str(), "w", stdout) || dup2(1, 2) < 0) _exit(99);
      std::vector<char*> argv;
      for (const auto& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(98);
    }
    return pid;
  }
  Outcome wait(pid_t pid) {
    int status = 0;
    waitpid(pid, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(folder.path / "log.txt")};
  }
  Outcome run(const std::vector<std::string>& arguments = {}) { return wait(start(arguments)); }
  fs::path out() const { return folder.path / "page"; }
  std::string page() const { return content(out() / "index.html"); }

  /// The page is complete, and all files that it refers to exist.
  void expect_good_page() const {
    const std::string text = page();
    EXPECT_TRUE(text.starts_with("<!doctype html>"));
    EXPECT_TRUE(text.ends_with("</html>\n"));
    EXPECT_EQ(text.find("http"), std::string::npos) << "not self-contained";
    const std::regex link("(src|href)=\"([^\"]*)\"");
    for (auto i = std::sregex_iterator(text.begin(), text.end(), link); i != std::sregex_iterator(); ++i) {
      const std::string target = (*i)[2];
      if (!target.starts_with("#")) {
        EXPECT_TRUE(fs::is_regular_file(out() / target)) << target;
      }
    }
    for (const char* tag : {"section", "figure", "div", "p", "a", "table", "tr", "td", "details", "pre"}) {
      const auto count = [&](const std::string& what) {
        const std::regex r(what);
        return std::distance(std::sregex_iterator(text.begin(), text.end(), r), std::sregex_iterator());
      };
      EXPECT_EQ(count(std::string("<") + tag + "[ >]"), count(std::string("</") + tag + ">")) << tag;
    }
  }
  void refused(const Json& figures, const std::string& message) {
    write(figures);
    refused_file(message);
  }
  void refused_file(const std::string& message, const std::vector<std::string>& arguments = {}) {
    const Outcome o = run(arguments);
    EXPECT_EQ(o.exit_code, 2) << o.output;
    EXPECT_NE(o.output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << o.output;
    EXPECT_FALSE(fs::exists(out())) << "something was written";
  }
  TemporaryFolder folder;
};

TEST_F(GalleryCommand, MakesAPageAndKeepsWhatIsDone) {
  Outcome o = run();
  ASSERT_EQ(o.exit_code, 0) << o.output;
  expect_good_page();
  EXPECT_EQ(page().find("not rendered yet"), std::string::npos);
  EXPECT_NE(page().find("One &amp; only"), std::string::npos);
  EXPECT_NE(page().find("&lt;narrow&gt;"), std::string::npos);
  EXPECT_NE(page().find("-D width=12 -D height=8 -D fov=20 --spp 16 -o two-2.exr"), std::string::npos);
  for (const char* name : {"one", "two-1", "two-2", "two-reference"}) {
    const Image png = read_image(out() / (std::string(name) + ".png"));
    EXPECT_EQ(png.width, 12) << name;
    EXPECT_EQ(png.height, 8) << name;
  }
  const Json results = Json::parse(content(out() / "results.json"));
  EXPECT_EQ(results["pictures"]["two-1"]["samples"], 16);
  EXPECT_EQ(results["pictures"]["two-reference"]["samples"], 64);
  // The reference has the field of view 45; the others do not.
  EXPECT_GT(results["pictures"]["two-1"]["relative_rmse"].get<double>(), 0.05);
  EXPECT_FALSE(results["pictures"]["one"].contains("relative_rmse"));

  // Again: nothing is rendered.
  const std::string exr = (out() / "exr" / "one.exr").string();
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(exr, old);
  o = run();
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(o.output.find("One & only: was done already"), std::string::npos) << o.output;
  EXPECT_NE(o.output.find("Two: was done already"), std::string::npos) << o.output;
  EXPECT_EQ(fs::last_write_time(exr), old);
  EXPECT_EQ(Json::parse(content(out() / "results.json")), results);

  // Rendered again only with --again, or if the scene changes, which the page shows at once.
  o = run({"--again", "--only", "one"});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(fs::last_write_time(exr), old);
  fs::last_write_time(exr, old);
  std::string scene = content(folder.path / "scenes/tiny/tiny.xml");
  scene.replace(scene.find("0.05, 0.07, 0.1"), 15, "0.06, 0.07, 0.1");
  folder.write("scenes/tiny/tiny.xml", scene);
  o = run({"--only", "two"});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_EQ(o.output.find("was done already"), std::string::npos) << o.output;
  EXPECT_NE(page().find("not rendered yet"), std::string::npos);
  o = run();
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(fs::last_write_time(exr), old);
  EXPECT_EQ(page().find("not rendered yet"), std::string::npos);
}

TEST_F(GalleryCommand, LeavesOutFiguresWhoseDataAreMissing) {
  Json all = figures();
  all[0]["needs"] = {{"file", "head.nrrd"}, {"how", "some program makes it"}};
  all[1].erase("plots");
  write(all);
  Outcome o = run();
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(o.output.find("the figure one is left out: "), std::string::npos) << o.output;
  EXPECT_NE(o.output.find("head.nrrd is missing: some program makes it"), std::string::npos) << o.output;
  expect_good_page();
  EXPECT_NE(page().find("Not rendered: "), std::string::npos);
  EXPECT_FALSE(fs::exists(out() / "one.png"));
  EXPECT_TRUE(fs::exists(out() / "two-1.png"));
  o = run({"--only", "one"});
  EXPECT_EQ(o.exit_code, 2) << o.output;
  folder.write("scenes/tiny/head.nrrd", "present");
  o = run();
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_TRUE(fs::exists(out() / "one.png")) << o.output;
  all[0]["needs"].erase("how");
  write(all);
  o = run();
  EXPECT_EQ(o.exit_code, 2) << o.output;
  EXPECT_NE(o.output.find("\"how\" is missing"), std::string::npos) << o.output;
}

TEST_F(GalleryCommand, MakesThePlotsOfDiffraction) {
  const Json gallery = Json::parse(content(source_dir() / "scenes" / "diffraction" / "gallery.json"));
  // Each plot has a file for each member of a list.
  const std::map<std::string, const char*> lists{{"edge_waves", "b"},
                                                 {"edge_amplitude", "ratios"},
                                                 {"edge_profile", "pieces"},
                                                 {"wedge", "n"},
                                                 {"opening", "fresnel_numbers"}};
  Json figures = Json::array();
  std::map<std::string, std::size_t> files;
  for (const Json& figure : gallery.at("figures")) {
    if (!figure.contains("plots")) continue;
    EXPECT_TRUE(figure.contains("counterpart")) << figure["id"];
    figures.push_back(figure);
    for (const Json& plot : figure["plots"]) {
      const std::string kind = plot["kind"];
      const auto list = lists.find(kind);
      files[kind] += kind == "field_maps" ? 6 : list == lists.end() ? 1 : plot.at(list->second).size();
    }
  }
  EXPECT_EQ(figures.size(), 7u);
  EXPECT_EQ(files.size(), lists.size() + 2);
  write(figures);
  const Outcome o = run();
  ASSERT_EQ(o.exit_code, 0) << o.output;
  expect_good_page();
  const Json results = Json::parse(content(out() / "results.json"));
  const std::regex error("([Oo]ff|error of|straight on)[^;]* [+-]?[0-9]+[.][0-9e+-]+");
  for (const auto& [name, plot] : results["plots"].items()) {
    const std::string key = plot["key"];
    for (auto& [kind, missing] : files)
      if (key.find(" " + kind + " ") != std::string::npos) missing -= plot["files"].size();
    for (const Json& file : plot["files"]) {
      const std::string path = file["file"], caption = file["caption"];
      EXPECT_TRUE(std::regex_search(caption, error)) << name << ": " << caption;
      EXPECT_EQ(caption.find("nan"), std::string::npos) << caption;
      if (path.ends_with(".png")) {
        const Image picture = read_image(out() / path);
        const auto [low, high] = std::minmax_element(picture.pixels.begin(), picture.pixels.end());
        EXPECT_GT(*high, *low + 0.5f) << path << " is of one colour";
      } else {
        const std::string text = content(out() / path);
        EXPECT_TRUE(text.starts_with("<svg")) << path;
        EXPECT_EQ(text.find("nan"), std::string::npos) << path;
        EXPECT_EQ(text.find("inf"), std::string::npos) << path;
      }
    }
  }
  for (const auto& [kind, missing] : files) EXPECT_EQ(missing, 0u) << kind;
}

// The plot of the machine part: premultiplied and Taylor's steps converge with first order.
TEST_F(GalleryCommand, PlotsStepsAgainstError) {
  const fs::path volumes = source_dir() / "scenes" / "volumes";
  fs::copy_file(volumes / "part.nrrd", folder.path / "scenes/tiny/part.nrrd");
  folder.write("scenes/tiny/part_forms.xml", content(volumes / "part_forms.xml"));
  const Json plot = {{"kind", "step_errors"}, {"scene", "part_forms.xml"}, {"steps", {0.25, 0.5, 1}}};
  const Json figure = {{"id", "steps"}, {"title", "Steps"}, {"caption", "c"}, {"plots", {plot}}};
  write(Json::array({figure}));
  Outcome o = run();
  ASSERT_EQ(o.exit_code, 0) << o.output;
  expect_good_page();
  const Json results = Json::parse(content(out() / "results.json"));
  const Json file = results["plots"]["steps-plot1"]["files"][0];
  const std::string caption = file["caption"], path = file["file"];
  EXPECT_TRUE(content(out() / path).starts_with("<svg"));
  for (const char* form : {"premultiplied", "taylor"}) {
    std::istringstream text(caption.substr(caption.find(form) + std::string(form).size()));
    double errors[3];
    char comma;
    text >> errors[0] >> comma >> errors[1] >> comma >> errors[2];
    for (int k = 1; k < 3; ++k) {
      EXPECT_GT(errors[k], 1.6 * errors[k - 1]) << form << ": " << caption;
      EXPECT_LT(errors[k], 2.4 * errors[k - 1]) << form << ": " << caption;
    }
  }
  o = run();
  EXPECT_NE(o.output.find("Steps: was done already"), std::string::npos) << o.output;
  // Another scene makes another plot.
  std::string scene = content(volumes / "part_forms.xml");
  scene.replace(scene.find("100 0.12"), 8, "100 0.22");
  folder.write("scenes/tiny/part_forms.xml", scene);
  o = run();
  EXPECT_EQ(o.output.find("Steps: was done already"), std::string::npos) << o.output;
  fs::remove_all(out());
  Json wrong = figure;
  wrong["plots"][0]["scene"] = "none.xml";
  refused(Json::array({wrong}), "there is no file ");
  wrong["plots"][0]["scene"] = 7;
  refused(Json::array({wrong}), "needs \"scene\", the name of a file");
}

TEST_F(GalleryCommand, FullPicturesServeAsPreviewsButNotTheOtherWay) {
  ASSERT_EQ(run({"--only", "one"}).exit_code, 0);
  Outcome o = run({"--only", "one", "--size", "full"});
  EXPECT_EQ(o.output.find("was done already"), std::string::npos) << o.output;
  const Json results = Json::parse(content(out() / "results.json"));
  EXPECT_EQ(results["pictures"]["one"]["samples"], 32);
  o = run({"--only", "one"});
  EXPECT_NE(o.output.find("was done already"), std::string::npos) << o.output;
  expect_good_page();
}

TEST_F(GalleryCommand, TimeEndsAPicture) {
  Json f = figures();
  f[0]["renders"][0]["preview"] = {{"size", {12, 8}}, {"time", 0.2}};
  write(f);
  const Outcome o = run({"--only", "one"});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  const Json r = Json::parse(content(out() / "results.json"))["pictures"]["one"];
  EXPECT_GE(r["seconds"].get<double>(), 0.2);
  EXPECT_GE(r["samples"].get<int>(), 16);
  EXPECT_LT(r["samples"].get<int>(), 65536);
  EXPECT_NE(page().find("--spp 65536 --time 0.2"), std::string::npos);
}

TEST_F(GalleryCommand, AnInterruptedRunLeavesAPage) {
  Json f = figures();
  f[1]["renders"][0]["preview"]["spp"] = 500'000'000;
  write(f);
  const pid_t pid = start({});
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (content(folder.path / "log.txt").find("One & only") == std::string::npos &&
         std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  // By now the reference of the second figure is done, or one of its endless pictures is under way.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  expect_good_page();
  kill(pid, SIGINT);
  Outcome o = wait(pid);
  EXPECT_EQ(o.exit_code, 1) << o.output;
  EXPECT_NE(o.output.find("interrupted in two"), std::string::npos) << o.output;
  expect_good_page();
  EXPECT_NE(page().find("src=\"one.png\""), std::string::npos);
  EXPECT_NE(page().find("not rendered yet"), std::string::npos);
  write(figures());
  o = run();
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_NE(o.output.find("One & only: was done already"), std::string::npos) << o.output;
  EXPECT_EQ(page().find("not rendered yet"), std::string::npos);
}

TEST_F(GalleryCommand, APictureThatWasStoppedGoesOn) {
  Json f = figures();
  f[0]["renders"][0]["preview"]["spp"] = 20000;
  write(f);
  const pid_t pid = start({"--only", "one"});
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!fs::exists(out() / "index.html") && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(pid, SIGINT);
  ASSERT_EQ(wait(pid).exit_code, 1);
  const fs::path state = out() / "exr" / "one.state";
  EXPECT_TRUE(fs::exists(state));
  Outcome o = run({"--only", "one"});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  EXPECT_FALSE(fs::exists(state));
  const Image pieces = read_image(out() / "exr" / "one.exr");
  EXPECT_EQ(Json::parse(content(out() / "results.json"))["pictures"]["one"]["samples"], 20000);
  o = run({"--only", "one", "--again"});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  EXPECT_EQ(read_image(out() / "exr" / "one.exr").pixels, pieces.pixels);

  // A damaged state file left by another run does not stop the gallery.
  f[0]["renders"][0]["preview"]["spp"] = 16;
  write(f);
  folder.write("page/exr/one.state", "damaged");
  o = run({"--only", "one", "--again"});
  EXPECT_EQ(o.exit_code, 0) << o.output;
  EXPECT_EQ(Json::parse(content(out() / "results.json"))["pictures"]["one"]["samples"], 16);
  const Image beside_it = read_image(out() / "exr" / "one.exr");
  o = run({"--only", "one", "--again"});
  ASSERT_EQ(o.exit_code, 0) << o.output;
  EXPECT_EQ(read_image(out() / "exr" / "one.exr").pixels, beside_it.pixels);
}

TEST_F(GalleryCommand, MistakesInTheFileAreErrorsWithTheirLine) {
  write_text("{\n \"title\": \"x\",\n \"figures\": [,]\n}\n");
  refused_file("gallery.json:3:");
  refused_file("valid JSON");
  write_text("{\n \"title\": \"x\",\n \"figures\": [\n  {\n   \"id\": \"a\",\n   \"title\": 7\n  }\n ]\n}\n");
  refused_file("gallery.json:6:");
  refused_file("\"title\": expected a text");
  write_text("");
  refused_file("gallery.json:1:1");
  write_text("[]");
  refused_file("expected an object");
  fs::remove(folder.path / "scenes/tiny/gallery.json");
  refused_file("gallery.json: no such file");

  const auto changed = [](const auto& change) {
    Json f = figures();
    change(f);
    return f;
  };
  refused(Json::array(), "there are none");
  refused(changed([](Json& f) { f[1]["id"] = "one"; }), "there is another figure \"one\"");
  refused(changed([](Json& f) { f[0]["id"] = "../x"; }), "small letters");
  refused(changed([](Json& f) { f[0]["titel"] = "x"; }), "\"titel\" here; did you mean \"title\"?");
  refused(changed([](Json& f) { f[0].erase("renders"); }), "needs \"renders\" or \"plots\"");
  refused(changed([](Json& f) { f[0]["renders"][0]["scene"] = "none.xml"; }), "there is no file");
  refused(changed([](Json& f) { f[0]["renders"][0]["full"].erase("spp"); }), "either \"spp\" or \"time\"");
  refused(changed([](Json& f) { f[0]["renders"][0]["full"]["size"] = {0, 4}; }), "[width, height]");
  refused(changed([](Json& f) { f[0]["renders"][0]["full"]["spp"] = 1.5; }), "whole number");
  refused(changed([](Json& f) { f[1]["renders"][0]["columns"][0]["values"] = Json::array(); }),
          "needs values");
  refused(changed([](Json& f) { f[1]["plots"][0]["kind"] = "structure_mop"; }),
          "did you mean \"structure_map\"?");
  refused(changed([](Json& f) { f[1]["plots"][0]["u"] = "x"; }), "needs \"u\", a number from 1 to 200");
  refused(changed([](Json& f) { f[1]["plots"][0]["v"] = 1; }), "has no member \"v\"");
  const auto field_maps = [&](const std::vector<double>& blocks, const std::vector<double>& map) {
    return changed([&](Json& f) {
      f[1]["plots"][0] = {
          {"kind", "field_maps"}, {"degrees", 0}, {"blocks", blocks}, {"map", map}, {"range_db", {-30, 5}}};
    });
  };
  refused(field_maps({0, 0, 1}, {0, 0, 1, 1}), "four numbers for each block");
  refused(field_maps({0, 0, 1, 1, 2, 0, 2, 1}, {0, 0, 1, 1}), "the block 2 has not");
  refused(field_maps({-90, -90, 90, 90}, {0, 0, 1, 1}), "may be 300 wavelengths long, not 720");
  refused(field_maps({0, 0, 1, 1}, {0, 0, 1, 0}), "x0 < x1 and y0 < y1");
  refused(changed([](Json& f) {
            f[0]["renders"][0]["defines"] = {{"fov", Json::array()}};
          }),
          "text or a number");
  // Errors in a scene are found before anything is rendered.
  refused(changed([](Json& f) { f[0]["renders"][0]["defines"] = {{"fow", 3}}; }), "fow");
}

TEST_F(GalleryCommand, WrongArguments) {
  refused_file("there is no such figure; did you mean \"one\"?", {"--only", "ono"});
  refused_file("write preview or full", {"--size", "large"});
  folder.write("page/letter.txt", "mine");
  const Outcome o = run();
  EXPECT_EQ(o.exit_code, 2) << o.output;
  EXPECT_NE(o.output.find("a folder of something else"), std::string::npos) << o.output;
  EXPECT_EQ(content(out() / "letter.txt"), "mine");
  EXPECT_FALSE(fs::exists(out() / "index.html"));
}

}  // namespace
}  // namespace aureole::test
