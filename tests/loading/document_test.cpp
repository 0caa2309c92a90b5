// SPDX-License-Identifier: Apache-2.0
// Scenes that stay open: paths of parameters, what is kept, what is refused.
#include "aureole/loading/document.h"

#include <gtest/gtest.h>

#include <fstream>

#include "loading/pixels.h"

namespace aureole {
namespace {

using test::pixels_of;

const char* const kScene = R"(<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective" id="camera"><film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film></sensor>
  <bsdf type="diffuse" id="mat.001"><rgb name="reflectance" value="0.2, 0.3, 0.4"/></bsdf>
  <shape type="sphere" id="ball"><ref id="mat.001"/></shape>
  <shape type="cube"><bsdf type="twosided" id="inner"><bsdf type="diffuse"/></bsdf></shape>
  <shape type="rectangle" id="lamp"><emitter type="area"><float name="radiance" value="2"/></emitter></shape>
</scene>)";

std::vector<ShapePtr> shapes_of(const SceneDocument& d) {
  std::vector<ShapePtr> shapes;
  for (const Primitive& part : d.scene()->parts().surfaces) shapes.push_back(part.shape);
  return shapes;
}

std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(SceneDocument, FindsParametersByIdNameAndFamily) {
  SceneDocument d(kScene, "scene.xml");
  EXPECT_EQ(d.find("mat.001.reflectance")->get("value"), "0.2, 0.3, 0.4");
  EXPECT_EQ(d.find("ball.bsdf.reflectance"), d.find("mat.001.reflectance"));
  EXPECT_EQ(d.find("shape.bsdf.bsdf")->get("type"), "diffuse");
  EXPECT_EQ(d.find("inner.bsdf"), d.find("shape.bsdf.bsdf"));
  EXPECT_EQ(d.find("camera.film.width")->get("value"), "4");
  EXPECT_EQ(d.find("camera.fov"), nullptr) << "documented, but not written";
  EXPECT_EQ(d.owner("camera.fov").get("type"), "perspective");
}

TEST(SceneDocument, SaysWhatIsWrongWithAPath) {
  SceneDocument d(kScene, "scene.xml");
  EXPECT_NE(error_of([&] { d.find("ball.radios"); }).find("did you mean \"radius\""), std::string::npos);
  EXPECT_NE(error_of([&] { d.find("bal.radius"); }).find("did you mean"), std::string::npos);
  EXPECT_NE(error_of([&] { d.find(""); }).find("empty"), std::string::npos);
  EXPECT_NE(error_of([&] { d.find("ball.bsdf.reflectance.value"); }).find("has no \"value\""),
            std::string::npos);
  for (const char* path : {".", "..", "ball.", ".ball", "ball..bsdf", "ball.bsdf."})
    EXPECT_NE(error_of([&] { d.edit({{path, "<float value='1'/>"}}); }), "") << path;
}

TEST(SceneDocument, KeepsGeometryAndWhatItDoesNotTouch) {
  SceneDocument d(kScene, "scene.xml");
  const auto shapes = shapes_of(d);
  const RayTracer* tracer = &d.scene()->tracer();
  const ObjectPtr inner = d.object("inner");
  d.edit({{"mat.001.reflectance", "<rgb value='0.9, 0.1, 0.1'/>"},
          {"lamp.emitter.radiance", "<float value='3'/>"}});
  EXPECT_EQ(shapes_of(d), shapes);
  EXPECT_EQ(&d.scene()->tracer(), tracer);
  EXPECT_EQ(d.object("inner"), inner);
  EXPECT_EQ(d.scene()->parts().surfaces[0].bsdf, std::dynamic_pointer_cast<const Bsdf>(d.object("mat.001")));
  d.edit({{"ball.radius", "<float value='2'/>"}});
  EXPECT_NE(shapes_of(d)[0], shapes[0]);
  EXPECT_EQ(shapes_of(d)[1], shapes[1]);
  EXPECT_NE(&d.scene()->tracer(), tracer);
}

TEST(SceneDocument, IsUnchangedWhereAChangeFails) {
  SceneDocument d(kScene, "scene.xml");
  const std::string before = d.xml();
  const std::vector<float> picture = pixels_of(d.loaded());
  const std::vector<std::vector<std::pair<std::string, std::string>>> bad = {
      {{"ball.radius", "<float value='2'/>"}, {"ball.radiu", "<float value='2'/>"}},
      {{"mat.001.reflectance", "<float value='0.5'/>"}, {"mat.001.reflectance", "<float value='7'/>"}},
      {{"ball.radius", "<float value='2'"}},
      {{"ball.radius", "<float value='2'/><float value='3'/>"}},
      {{"camera", ""}},
      {{"mat.001", ""}},
      {{"ball.bsdf", "<ref id='nobody'/>"}},
      {{"mat.001", "<bsdf type='mask'><ref id='mat.001'/></bsdf>"}},
      {{"lamp.emitter.radiance", "<float value='1e38'/>"}, {"ball.radius", "<float value='1e30'/>"}},
  };
  for (const auto& changes : bad) {
    EXPECT_NE(error_of([&] { d.edit(changes); }), "") << changes.back().first;
    EXPECT_EQ(d.xml(), before);
    EXPECT_EQ(pixels_of(d.loaded()), picture);
  }
}

TEST(SceneDocument, ErrorsNameThePath) {
  SceneDocument d(kScene, "scene.xml");
  const std::string error = error_of([&] { d.edit({{"ball.radius", "<float value='-2'/>"}}); });
  EXPECT_TRUE(error.starts_with("[\"ball.radius\"]:")) << error;
}

TEST(SceneDocument, TakesGivenObjects) {
  SceneDocument d(kScene, "scene.xml");
  const ObjectPtr given = d.object("inner");
  d.edit({{"ball.bsdf", "<given key='k'/>"}}, {{"k", given}});
  EXPECT_EQ(d.scene()->parts().surfaces[0].bsdf, std::dynamic_pointer_cast<const Bsdf>(given));
  EXPECT_NE(error_of([&] { (void)d.xml(); }).find("given by a program"), std::string::npos);
  d.edit({{"inner", "<given key='k'/>"}});  // nested, found by its id alone
  EXPECT_EQ(d.owner("inner").get("id"), "");
  EXPECT_EQ(d.object("inner"), given);
  EXPECT_NE(error_of([&] {
              d.edit({{"ball.bsdf", "<given key='unknown'/>"}});
            }).find("knows no"),
            std::string::npos);
}

TEST(SceneDocument, SensorsOnShapesChange) {
  SceneDocument d(R"(<scene version="3.0.0"><integrator type="path"/>
    <shape type="sphere" id="ball"><sensor type="irradiancemeter" id="meter">
      <sampler type="independent"><integer name="sample_count" value="3"/></sampler></sensor></shape></scene>)",
                  "scene.xml");
  EXPECT_EQ(d.scene()->sensor().sampler().sample_count(), 3);
  d.edit({{"meter.sampler.sample_count", "<integer value='7'/>"}});
  EXPECT_EQ(d.scene()->sensor().sampler().sample_count(), 7);
  EXPECT_NE(error_of([&] { d.edit({{"meter", ""}}); }).find("no <sensor>"), std::string::npos);
  EXPECT_EQ(d.scene()->sensor().sampler().sample_count(), 7);
}

TEST(SceneDocument, ShapesMayBeginToShine) {
  SceneDocument d(kScene, "scene.xml");
  const auto emitter = [](const char* radiance) {
    return std::string("<shape type='rectangle'><bsdf type='conductor'/>") + radiance + "</shape>";
  };
  for (const char* lamp : {"", "<emitter type='area'><float name='radiance' value='2'/></emitter>", ""}) {
    d.edit({{"lamp", emitter(lamp)}});
    EXPECT_EQ(d.scene()->parts().surfaces[2].emitter != nullptr, *lamp != 0);
    EXPECT_EQ(d.scene()->parts().surfaces[2].bsdf->properties().type(), "conductor");
    EXPECT_EQ(pixels_of(d.loaded()), pixels_of(SceneDocument(d.xml(), "scene.xml").loaded()));
  }
}

TEST(SceneDocument, ShapesOfGroupsStayTheirs) {
  SceneDocument d(R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/>
    <shape type="sphere"><bsdf type="diffuse"/></shape>
    <shape type="shapegroup" id="group"><shape type="sphere"><bsdf type="conductor"/></shape></shape>
    <shape type="instance"><ref id="group"/></shape></scene>)",
                  "scene.xml");
  for (const char* reflectance : {"0.1", "0.2", "0.3", "0.4"}) {
    d.edit({{"shape.bsdf.reflectance", std::string("<float value='") + reflectance + "'/>"}});
    EXPECT_EQ(d.scene()->parts().surfaces[0].bsdf,
              std::dynamic_pointer_cast<const Bsdf>(d.object("shape.bsdf")));
    const auto nested = std::dynamic_pointer_cast<Asset>(d.object("group.shape"));
    ASSERT_NE(nested, nullptr);
    EXPECT_EQ(nested->primitives()[0].bsdf->properties().type(), "conductor");
  }
}

TEST(SceneDocument, InstancesFollowMaterialsOfFiles) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "aureole-document-test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "two.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl wood\nf 1 2 3\nusemtl iron\nf 2 4 3\n";
  const std::string text = R"(<scene version="3.0.0"><integrator type="path"/>
    <sensor type="perspective"><transform name="to_world"><lookat origin="0.5, 0.5, 2" target="0.5, 0.5, 0" up="0, 1, 0"/></transform>
      <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
    <emitter type="constant"/>
    <bsdf type="diffuse" id="wood"><float name="reflectance" value="0.2"/></bsdf><bsdf type="diffuse" id="iron"/>
    <shape type="shapegroup" id="group"><shape type="obj"><string name="filename" value="two.obj"/></shape></shape>
    <shape type="instance"><ref id="group"/></shape></scene>)";
  SceneDocument d(text, folder / "scene.xml");
  d.edit({{"wood.reflectance", "<float value='0.9'/>"}});
  EXPECT_EQ(pixels_of(d.loaded()), pixels_of(SceneDocument(d.xml(), folder / "scene.xml").loaded()));
  // An edit while a file is missing fails and changes nothing.
  std::filesystem::rename(folder / "two.obj", folder / "away.obj");
  const auto scene = d.scene();
  EXPECT_NE(error_of([&] {
              d.edit({{"wood.reflectance", "<float value='0.5'/>"}});
            }).find("no such file"),
            std::string::npos);
  EXPECT_EQ(d.scene(), scene);
  std::filesystem::rename(folder / "away.obj", folder / "two.obj");
  d.edit({{"wood.reflectance", "<float value='0.5'/>"}});
  EXPECT_EQ(pixels_of(d.loaded()), pixels_of(SceneDocument(d.xml(), folder / "scene.xml").loaded()));
  std::filesystem::remove_all(folder);
}

TEST(SceneDocument, ARemovedIntegratorIsTheDefaultOne) {
  SceneDocument d(kScene, "scene.xml");
  d.edit({{"integrator", "<integrator type='direct'/>"}});
  EXPECT_EQ(d.loaded().integrator->properties().type(), "direct");
  d.edit({{"integrator", ""}});
  ASSERT_NE(d.loaded().integrator, nullptr);
  EXPECT_EQ(d.loaded().integrator->properties().type(), "path");
}

TEST(SceneDocument, NotesStay) {
  SceneDocument d(R"(<scene version="0.6.0"><integrator type="path"/><sensor type="perspective"/>
    <shape type="sphere" id="ball"><float name="silhouette_sampling_weight" value="2"/></shape>
    <emitter type="sky"/></scene>)",
                  "scene.xml");
  const std::vector<std::string> notes = d.loaded().notes;
  EXPECT_GE(notes.size(), 2u) << ::testing::PrintToString(notes);
  d.edit({{"sensor.fov", "<float value='30'/>"}});
  EXPECT_EQ(d.loaded().notes, notes);
}

}  // namespace
}  // namespace aureole
