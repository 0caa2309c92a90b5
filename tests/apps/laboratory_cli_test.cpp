// SPDX-License-Identifier: Apache-2.0
// aureole spectrophotometer, goniometer and color as a user meets them: files out, files in again, and wrong input with its
// place, exit code 2 and nothing written.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

class LaboratoryCli : public ::testing::Test {
protected:
  LaboratoryCli() {
    write("m.xml", R"(<scene version="3.0.0">
      <bsdf type="diffuse" id="grey"><float name="reflectance" value="0.3"/></bsdf>
      <bsdf type="roughconductor" id="metal"><string name="material" value="none"/><float name="alpha" value="0.3"/></bsdf>
      <shape type="rectangle" id="flat"><medium type="homogeneous" name="interior"/></shape>
      <shape type="cube" id="slab"><transform name="to_world"><scale x="0.1" y="0.1" z="0.004"/></transform><bsdf type="null"/>
        <medium type="homogeneous" name="interior"><float name="sigma_t" value="2000"/><float name="albedo" value="0.99"/></medium></shape>
      </scene>)");
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder.path / name) << text; }
  /// Runs the program in the test's folder; its output is in `said`.
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    said = end.output;
    return end.exit_code;
  }
  void fails(const std::vector<std::string>& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << arguments[1];
    EXPECT_NE(said.find(message), std::string::npos) << said;
  }
  nlohmann::json json(const std::string& name) {
    return nlohmann::json::parse(file_content(folder.path / name));
  }

  TemporaryFolder folder;
  std::string said;
};

TEST_F(LaboratoryCli, ABeamThatIsStatedIsThatOfHaze) {
  write("pane.xml", R"(<scene version="3.0.0"><bsdf type="thindielectric" id="pane"/></scene>)");
  const auto haze = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{"spectrophotometer", "pane.xml#pane", "--haze", "2.5",
                                   "--theory",          "--paths",       "16384",  "--range",
                                   "550,550",           "--json",        "h.json"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(run(words), 0) << said;
    return json("h.json")["haze"]["haze"].get<double>();
  };
  // Clear glass spreads nothing: what passes by the port of 2.5 degrees is the lamp's own width.
  EXPECT_NEAR(haze({}), 0, 1e-6);
  EXPECT_GT(haze({"--lamp-angle", "3.5"}), 0.2);
  EXPECT_NEAR(haze({"--lamp-angle", "0.1"}), 0, 1e-6);
  EXPECT_NEAR(haze({"--aperture", "2mm", "--lit", "2mm"}), 0, 1e-6);
}

TEST_F(LaboratoryCli, NotesAreThoseOfTheMaterial) {
  write("two.xml", R"(<scene version="3.0.0">
      <bsdf type="Diffuse" id="first"/>
      <bsdf type="Plastic" id="second"/>
      </scene>)");
  for (const std::string command : {"layer", "spectrophotometer", "goniometer"})
    for (const auto& [id, own, other] :
         {std::tuple<std::string, std::string, std::string>("first", "\"Diffuse\" is read", "Plastic"),
          {"second", "\"Plastic\" is read", "Diffuse"}}) {
      std::vector<std::string> words{command, "two.xml#" + id};
      if (command != "layer") words.insert(words.end(), {"--paths", "16", "--range", "550,550"});
      if (command == "goniometer") words.insert(words.end(), {"--directions", "4"});
      ASSERT_EQ(run(words), 0) << said;
      EXPECT_NE(said.find(own), std::string::npos) << command << id << said;
      EXPECT_EQ(said.find(other), std::string::npos) << command << id << said;
    }
}

TEST_F(LaboratoryCli, SpectrophotometersFilesGoToThePigmentCommands) {
  ASSERT_EQ(run({"spectrophotometer",
                 "m.xml#grey",
                 "--geometry",
                 "di:8",
                 "--theory",
                 "--paths",
                 "4096",
                 "-o",
                 "a.csv",
                 "-o",
                 "a.cxf",
                 "-o",
                 "a.cgats",
                 "--json",
                 "a.json",
                 "--plot",
                 "a.svg",
                 "--noise",
                 "0.001",
                 "--standard-error",
                 "0.003"}),
            0)
      << said;
  const nlohmann::json a = json("a.json");
  ASSERT_EQ(a["values"].size(), 31u);
  for (const double v : a["values"]) EXPECT_NEAR(v, 0.3, 0.003);
  // The standard's uncertainty of 0.3 % is a cause of its own.
  EXPECT_NEAR(a["uncertainty"]["standard"][5].get<double>(), 0.0009, 1e-5);
  EXPECT_NE(said.find("D65, 10 degrees: Y "), std::string::npos) << said;
  for (const char* name : {"a.csv", "a.cxf", "a.cgats"}) {
    ASSERT_EQ(run({"color", name, "--json", "c.json"}), 0) << said;
    EXPECT_NEAR(json("c.json")["colours"][0]["xyz"][1].get<double>(), 30, 0.2) << name;
    ASSERT_EQ(run({"pigment", "colour", name}), 0) << name << said;
  }
}

TEST_F(LaboratoryCli, EqualSeedsReadEqualValues) {
  for (const char* name : {"a.json", "b.json"})
    ASSERT_EQ(run({"spectrophotometer", "m.xml#metal", "--geometry", "de:8", "--range", "500,600", "--step",
                   "50", "--paths", "2048", "--noise", "0.01", "--seed", "7", "--json", name, "--threads",
                   name[0] == 'a' ? "1" : "2"}),
              0)
        << said;
  EXPECT_EQ(json("a.json")["values"], json("b.json")["values"]);
}

TEST_F(LaboratoryCli, SlabsAreMeasuredWithTheirMedium) {
  const auto read = [&](const std::string& port, const std::string& viewed) {
    EXPECT_EQ(run({"spectrophotometer", "m.xml#slab", "--geometry", "de:8", "--theory", "--range", "550,550",
                   "--paths", "32768", "--port", port, "--aperture", viewed, "--sample-size", "150mm",
                   "--json", "s.json"}),
              0)
        << said;
    return json("s.json")["values"][0].get<double>();
  };
  EXPECT_LT(read("6mm", "4mm"), read("40mm", "8mm") - 0.01);
  // Half of the thickness lets more light through.
  const auto transmitted = [&](const std::string& thickness) {
    EXPECT_EQ(run({"spectrophotometer", "m.xml#slab", "--transmission", "--geometry", "di:0", "--theory",
                   "--range", "550,550", "--paths", "32768", "--thickness", thickness, "--json", "s.json"}),
              0)
        << said;
    return json("s.json")["values"][0].get<double>();
  };
  EXPECT_GT(transmitted("2mm"), transmitted("8mm") + 0.02);
}

TEST_F(LaboratoryCli, GoniometersTableIsAMaterialOfAScene) {
  ASSERT_EQ(run({"goniometer", "m.xml#metal", "--directions", "150",      "--range",
                 "500,600",    "--step",      "50",           "--paths",  "256",
                 "-o",         "t.csv",       "--fit",        "--models", "lambert,beckmann,ggx",
                 "--material", "best.xml",    "--json",       "f.json",   "--plot",
                 "t.svg"}),
            0)
      << said;
  const nlohmann::json fits = json("f.json")["fits"];
  EXPECT_EQ(fits[0]["model"], "beckmann");
  EXPECT_NEAR(fits[0]["parameters"]["alpha"]["value"].get<double>(), 0.3, 0.01);
  EXPECT_NE(file_content(folder.path / "best.xml").find("roughconductor"), std::string::npos);
  write(
      "again.xml",
      R"(<scene version="3.0.0"><bsdf type="tabulated" id="loop"><string name="filename" value="t.csv"/></bsdf></scene>)");
  ASSERT_EQ(
      run({"goniometer", "again.xml#loop", "--plan", "in_plane", "--directions", "11", "--range", "550,550"}),
      0)
      << said;
  // A table alone is fitted, too.
  ASSERT_EQ(run({"goniometer", "t.csv", "--models", "beckmann,ggx"}), 0) << said;
  EXPECT_LT(said.find("beckmann"), said.find("ggx")) << said;
}

TEST_F(LaboratoryCli, ReportsTellReflectances) {
  ASSERT_EQ(run({"goniometer", "m.xml#grey", "--report", "--range", "550,550", "--json", "r.json"}), 0)
      << said;
  EXPECT_NEAR(json("r.json")["report"]["rho_hh"]["value"].get<double>(), 0.3, 0.003);
  EXPECT_NE(said.find("isotropic"), std::string::npos);
}

TEST_F(LaboratoryCli, ReportsOfStatedLightAndCones) {
  ASSERT_EQ(run({"goniometer", "m.xml#grey", "--incident-light", "0:1,60:0.5,90:0.1", "--cones",
                 "45,5,0,10,0,5,60,10", "--range", "550,550", "--json", "r.json"}),
            0)
      << said;
  const nlohmann::json r = json("r.json")["report"];
  EXPECT_NEAR(r["of_incident_light"]["value"].get<double>(), 0.3, 0.003);
  ASSERT_EQ(r["cones"].size(), 2u);
  EXPECT_NEAR(r["cones"][0]["factor"].get<double>(), 0.3, 0.003);
  EXPECT_NE(said.find("of the stated light "), std::string::npos) << said;
  fails({"goniometer", "m.xml#grey", "--cones", "45,5,0"}, "four numbers for each pair of cones");
  fails({"goniometer", "m.xml#grey", "--cones", "85,10,0,5"}, "--cones 85,10,0,5");
  fails({"goniometer", "m.xml#grey", "--incident-light", "0:1,0:2"}, "increasing angles");
  fails({"goniometer", "m.xml#grey", "--incident-light", "sky.exr"}, "sky.exr");
}

TEST_F(LaboratoryCli, SpreadOfASlab) {
  ASSERT_EQ(run({"goniometer", "m.xml#slab", "--spread", "point", "--distances", "1,2", "--aperture", "1mm",
                 "--range", "550,550", "-o", "s.csv", "--json", "s.json", "--plot", "s.svg"}),
            0)
      << said;
  const nlohmann::json s = json("s.json");
  EXPECT_EQ(s["kind"], "point");
  EXPECT_GT(s["readings"][0]["values"][0].get<double>(), s["readings"][1]["values"][0].get<double>());
  EXPECT_GT(s["readings"][0]["diffusion"][0].get<double>(), 0);
  EXPECT_NE(file_content(folder.path / "s.csv").find("distance_mm,550nm,u(550nm),diffusion(550nm)"),
            std::string::npos);
  EXPECT_NE(file_content(folder.path / "s.svg").find("<svg"), std::string::npos);
  fails({"goniometer", "m.xml#grey", "--spread", "line"}, "is no slab");
  fails({"goniometer", "m.xml#slab", "--spread", "line", "--distances", "90"}, "is not over the sample");
}

// Clear glass is a slab where its shape has a depth; a flat one is the surface of a body, however it is turned.
TEST_F(LaboratoryCli, FlatGlassIsNoSlab) {
  const auto pane = [](const char* id, const char* type, const char* turned) {
    return std::string("<shape type=\"") + type + "\" id=\"" + id + "\"><transform name=\"to_world\">" +
           turned + "</transform><bsdf type=\"dielectric\"/></shape>";
  };
  write("g.xml", "<scene version=\"3.0.0\">" + pane("flat", "rectangle", "") +
                     pane("upright", "rectangle", "<rotate x=\"1\" angle=\"90\"/>") +
                     pane("tilted", "rectangle", "<rotate x=\"1\" angle=\"30\"/>") +
                     pane("round", "disk", "<rotate y=\"1\" angle=\"50\"/>") +
                     pane("block", "cube", "<scale x=\"0.1\" y=\"0.1\" z=\"0.002\"/>") + "</scene>");
  const auto transmittance = [](const char* id) -> std::vector<std::string> {
    return {"spectrophotometer",
            std::string("g.xml#") + id,
            "--transmission",
            "--geometry",
            "0:0",
            "--range",
            "550,550",
            "--paths",
            "1024"};
  };
  for (const char* id : {"flat", "upright", "tilted", "round"})
    fails(transmittance(id), "is the surface of a body of index");
  ASSERT_EQ(run(transmittance("block")), 0) << said;
  EXPECT_NE(said.find("is measured as a clear slab of 4 mm"), std::string::npos) << said;
  fails({"goniometer", "g.xml#block", "--spread", "line"}, "is no slab, in which light could spread");
}

TEST_F(LaboratoryCli, PooledSpheresAndPredictedEdgeLoss) {
  ASSERT_EQ(run({"spectrophotometer", "m.xml#grey", "--geometry", "di:8", "--pooled", "--paths", "8192",
                 "--step", "50", "--json", "p.json"}),
            0)
      << said;
  const auto pooled = json("p.json");
  for (const double v : pooled["values"]) EXPECT_NEAR(v, 0.3, 0.01);
  ASSERT_EQ(run({"spectrophotometer", "m.xml#slab", "--geometry", "45a:0", "--range", "550,550", "--paths",
                 "1024", "--json", "e.json"}),
            0)
      << said;
  EXPECT_NE(said.find("edge loss: diffusion predicts"), std::string::npos) << said;
  const double loss = json("e.json")["predicted_edge_loss"][0];
  EXPECT_GT(loss, 0.01);
  EXPECT_LT(loss, 0.6);
  ASSERT_EQ(run({"spectrophotometer", "m.xml#grey", "--pooled", "--range", "550,550"}), 0) << said;
  EXPECT_NE(said.find("here that has no effect"), std::string::npos) << said;
}

TEST_F(LaboratoryCli, TensorTreesAreWrittenAndRead) {
  ASSERT_EQ(run({"convert-bsdf", "m.xml#metal", "tree.xml", "--format", "tensor_tree", "--resolution", "16"}),
            0)
      << said;
  EXPECT_NE(file_content(folder.path / "tree.xml").find("TensorTree3"), std::string::npos);
  ASSERT_EQ(run({"convert-bsdf", "tree.xml", "again.csv", "--angles", "3"}), 0) << said;
  fails({"convert-bsdf", "m.xml#metal", "t.xml", "--format", "tensor_tree", "--resolution", "20"},
        "a power of two");
}

TEST_F(LaboratoryCli, ColoursAndTheirDifferences) {
  ASSERT_EQ(run({"color", "#ff0000", "lab(50, 20, -10)", "--json", "c.json"}), 0) << said;
  const nlohmann::json c = json("c.json")["colours"];
  EXPECT_NEAR(c[0]["lab"][0].get<double>(), 53.24, 0.02);
  EXPECT_NEAR(c[0]["dominant_wavelength"]["nm"].get<double>(), 611.4, 0.5);
  EXPECT_NEAR(c[1]["lab"][2].get<double>(), -10, 1e-6);
  ASSERT_EQ(
      run({"color", "lab(50, 2.6772, -79.7751)", "--standard", "lab(50, 0, -82.7485)", "--json", "d.json"}),
      0)
      << said;
  // The first pair of Sharma, Wu and Dalal (2005).
  EXPECT_NEAR(json("d.json")["colours"][0]["difference"]["ciede2000"].get<double>(), 2.0425, 1e-4);
}

TEST_F(LaboratoryCli, WrongInputIsToldWithItsPlace) {
  fails({"spectrophotometer", "m.xml#grey", "--geometry", "45:0"}, "there are 45a:0, 45x:0");
  fails({"spectrophotometer", "m.xml#gray"}, "did you mean");
  fails({"spectrophotometer", "m.xml"}, "name a material of the scene");
  fails({"spectrophotometer", "m.xml#flat"}, "--thickness says how thick");
  fails({"spectrophotometer", "m.xml#grey", "--thickness", "1mm"}, "has no medium inside");
  fails({"spectrophotometer", "m.xml#grey", "--aperture", "8 apples"}, "--aperture 8 apples");
  fails({"spectrophotometer", "m.xml#grey", "--geometry", "di:8", "--port", "200mm"},
        "does not fit a sphere of 150 mm");
  fails({"spectrophotometer", "m.xml#grey", "--sample-size", "3mm"}, "is smaller than the spot");
  fails({"spectrophotometer", "m.xml#grey", "-o", "x.doc"}, "the ending says what is written");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "x.doc"));
  ASSERT_EQ(run({"spectrophotometer", "m.xml#grey", "--transmission", "--geometry", "0:0", "--range",
                 "550,550", "--paths", "256"}),
            0);
  EXPECT_NE(said.find("\"grey\" lets no light pass"), std::string::npos) << said;
  fails({"goniometer", "m.xml#grey", "--incident", "95"}, "an angle of incidence of 95 degrees");
  fails({"goniometer", "m.xml#grey", "--models", "gxg"}, "did you mean");
  // Lists name their empty entries; the command line's library leaves them out.
  fails({"spectrophotometer", "m.xml#grey", "--gloss", "20,,60"}, "--gloss: entry 2 of \"20,,60\" is empty");
  fails({"spectrophotometer", "m.xml#grey", "--gloss=20,60,"}, "--gloss: entry 3 of \"20,60,\" is empty");
  fails({"goniometer", "m.xml#grey", "--incident", ",30"}, "--incident: entry 1 of \",30\" is empty");
  fails({"pigment", "colour", "x.csv", "--others", "A,,F11"}, "--others: entry 2 of \"A,,F11\" is empty");
  fails({"color", "no_colour"}, "is no colour");
  write("bad.csv", "theta_i,theta_o,550nm\n0,ten,1\n");
  fails({"goniometer", "bad.csv"}, "bad.csv:2:");
}

}  // namespace
}  // namespace aureole::test
