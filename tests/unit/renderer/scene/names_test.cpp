// SPDX-License-Identifier: Apache-2.0
// Names that hold "::", places in error messages, prefixes of XML, and one warning for each kind.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string small_box =
    "<visual name=\"v\"><geometry><box><size>1 1 1</size></box></geometry></visual>";

std::string in_a_world(const std::string& content) {
  return "<sdf version=\"1.9\" xmlns:sonard=\"https://sonard.dev/sdf\">\n<world name=\"w\">\n" + content +
         "\n</world></sdf>";
}

World load_text(const std::string& content) {
  const test::TempFolder folder;
  return load_world(folder.write("w.sdf", in_a_world(content)), {});
}

std::vector<std::string> complaints(const std::filesystem::path& file) {
  try {
    load_world(file, {});
  } catch (const WorldError& error) {
    std::vector<std::string> lines{error.what()};
    lines.insert(lines.end(), error.more.begin(), error.more.end());
    return lines;
  }
  return {};
}

glm::dvec3 part_place(const World& world, std::size_t part) {
  const Body& body = world.bodies.at(0);
  return body.T_world_body * body.parts.at(part).T_body_part.position_m;
}

// A flattened model: "arm::tip" is one name. 6 + 1 m ahead of the rig, the ball 1 m to port of that.
TEST(FlattenedNames, AreOneName) {
  const World world = load_text(
      "<model name=\"rig\"><link name=\"arm::tip\"><pose>6 0 0 0 0 0</pose></link><frame name=\"arm::f\" "
      "attached_to=\"arm::tip\"><pose>1 0 0 0 0 0</pose></frame><link name=\"ball\"><pose "
      "relative_to=\"arm::f\">0 1 0 0 0 0"
      "</pose>" +
      small_box + "</link></model>");
  EXPECT_EQ(part_place(world, 0), glm::dvec3(7, 1, 0));
}

// The model "a::b" holds "c". The model "a" holds "b::d" and the model "x::y".
TEST(FlattenedNames, MayHoldModels) {
  const World world = load_text(
      "<model name=\"rig\"><model name=\"a::b\"><pose>10 0 0 0 0 0</pose><link name=\"c\"><pose>1 0 0 0 0 "
      "0</pose></link>"
      "</model><model name=\"a\"><pose>20 0 0 0 0 0</pose><link name=\"b::d\"><pose>2 0 0 0 0 0</pose></link>"
      "<model name=\"x::y\"><pose>0 0 3 0 0 0</pose><link name=\"l\"/></model></model>"
      "<link name=\"p\"><pose relative_to=\"a::b::c\"/>" +
      small_box + "</link><link name=\"q\"><pose relative_to=\"a::b::d\"/>" + small_box +
      "</link><link name=\"r\"><pose relative_to=\"a::x::y::l\"/>" + small_box + "</link></model>");
  EXPECT_EQ(part_place(world, 0), glm::dvec3(11, 0, 0));
  EXPECT_EQ(part_place(world, 1), glm::dvec3(22, 0, 0)) << "not in a::b, the longest, but in a";
  EXPECT_EQ(part_place(world, 2), glm::dvec3(20, 0, 3));
}

// A whole name takes precedence over its parts. gz sdf -p writes "arm::__model__" for the frame of a model
// that it flattens.
TEST(FlattenedNames, ComeBeforeNestedOnes) {
  const World world = load_text(
      "<model name=\"rig\"><frame name=\"arm::__model__\"><pose>4 0 0 0 0 0</pose></frame><link "
      "name=\"a\"><pose "
      "relative_to=\"arm::__model__\">0 0 1 0 0 0</pose>" +
      small_box +
      "</link><link name=\"n::l\"><pose>5 0 0 0 0 0</pose></link><model name=\"n\"><link "
      "name=\"l\"/></model><link name=\"b\">"
      "<pose relative_to=\"n::l\"/>" +
      small_box + "</link></model>");
  EXPECT_EQ(part_place(world, 0), glm::dvec3(4, 0, 1));
  EXPECT_EQ(part_place(world, 1), glm::dvec3(5, 0, 0));
}

TEST(FlattenedNames, AreNamedWholeIfTheyAreNotThere) {
  const test::TempFolder folder;
  EXPECT_THAT(
      complaints(folder.write(
          "w.sdf",
          in_a_world("<model name=\"rig\"><model name=\"a::b\"><link name=\"c\"/></model>\n<link name=\"p\">"
                     "<pose relative_to=\"a::b::e\"/>" +
                     small_box + "</link></model>"))),
      ElementsAre(HasSubstr("w.sdf:4: there is no frame 'a::b::e' in model 'rig'")))
      << "and no complaint that follows from it";
}

class PlaceOfAnInclude : public testing::Test {
 protected:
  PlaceOfAnInclude() {
    folder_.write("models/post/model.sdf", "<sdf version=\"1.9\"><model name=\"post\">\n<link name=\"l\">" +
                                               small_box + "</link></model></sdf>");
    folder_.write(
        "models/quay_post/model.sdf",
        "<sdf version=\"1.9\"><model name=\"quay_post\">\n<pose relative_to=\"quay\">0 0 0 0 0 0</pose>"
        "<link name=\"l\">" +
            small_box + "</link></model></sdf>");
  }
  std::vector<std::string> complaints_of(const std::string& content) const {
    return complaints(folder_.write("w.sdf", in_a_world(content)));
  }
  test::TempFolder folder_;
};

TEST_F(PlaceOfAnInclude, IsNamedForANameThatIsTaken) {
  EXPECT_THAT(
      complaints_of("<include><uri>model://post</uri></include>\n<include><uri>model://post</uri></include>"),
      ElementsAre(EndsWith("w.sdf:4: another model is called 'post': give it a <name>")));
  EXPECT_THAT(
      complaints_of(
          "<model name=\"a\"><link name=\"l\"/></model>\n<include><uri>post</uri><name>a</name></include>"),
      ElementsAre(EndsWith("w.sdf:4: another model is called 'a': give it another <name>")));
  EXPECT_THAT(complaints_of(
                  "<model name=\"m\">\n<include><uri>post</uri></include>\n<include><uri>post</uri></include>"
                  "</model>"),
              ElementsAre(EndsWith("w.sdf:5: another part of m is called 'post': give it a <name>")));
  EXPECT_THAT(
      complaints_of(
          "<model name=\"m\"><link name=\"l\"/>\n<include merge=\"true\"><uri>post</uri></include></model>"),
      ElementsAre(testing::AllOf(HasSubstr("w.sdf:4: another part of m is called 'l': rename it at "),
                                 HasSubstr("models/post/model.sdf:1, or include without merge"))));
  EXPECT_THAT(
      complaints_of(
          "<model name=\"a\"><link name=\"l\"/></model>\n<model name=\"a\"><link name=\"l\"/></model>"),
      ElementsAre(EndsWith("w.sdf:4: another model is called 'a': rename one of them")));
}

TEST_F(PlaceOfAnInclude, IsNamedForAnEmptyName) {
  for (const char* name : {"<name/>", "<name> </name>"}) {
    EXPECT_THAT(
        complaints_of(std::string("\n<include><uri>model://post</uri>") + name + "</include>"),
        ElementsAre(EndsWith(
            "w.sdf:4: include of 'model://post': its <name> is empty; write a name, or remove <name>")));
  }
}

TEST_F(PlaceOfAnInclude, IsNamedForFramesAroundIt) {
  EXPECT_THAT(complaints_of("\n<include><uri>model://quay_post</uri></include>"),
              ElementsAre(HasSubstr("/w.sdf:4: there is no frame 'quay' in world 'w'")));
  EXPECT_THAT(complaints_of("\n<include><uri>model://post</uri><pose relative_to=\"pier\"/></include>"),
              ElementsAre(HasSubstr("/w.sdf:4: there is no frame 'pier' in world 'w'")));
  EXPECT_THAT(
      complaints_of("\n<include><uri>model://post</uri><placement_frame>top</placement_frame></include>"),
      ElementsAre(HasSubstr("/w.sdf:4: there is no frame 'top' in model 'post'")));
  EXPECT_THAT(
      complaints_of(
          "<frame name=\"quay\" attached_to=\"quay_post\"/>\n<include><uri>quay_post</uri></include>"),
      Contains(HasSubstr("/w.sdf:4: the pose of model 'quay_post' is relative to itself")));
}

TEST_F(PlaceOfAnInclude, IsNotNamedForWhatTheModelAloneHasWrong) {
  folder_.write("models/bad/model.sdf",
                "<sdf version=\"1.9\"><model name=\"bad\">\n<link name=\"l\"><pose relative_to=\"nobody\"/>" +
                    small_box + "</link></model></sdf>");
  EXPECT_THAT(complaints_of("\n<include><uri>model://bad</uri></include>"),
              ElementsAre(HasSubstr("models/bad/model.sdf:2: there is no frame 'nobody' in model 'bad'")));
}

std::string own(const std::string& declarations, const std::string& prefix) {
  return "<sdf version=\"1.9\" " + declarations + "><world name=\"w\"><" + prefix + "water_surface_z>1.5</" +
         prefix + "water_surface_z><model name=\"m\">\n<link name=\"l\">" +
         "<visual name=\"v\"><geometry><box><size>1 1 1</size></box></geometry><" + prefix +
         "material>mud</" + prefix + "material></visual><sensor name=\"s\" type=\"custom\" " + prefix +
         "type=\"micron\"/></link></model></world></sdf>";
}

TEST(Prefix, IsFreeIfItIsBoundToOurNamespace) {
  for (const auto& [declarations, prefix] :
       {std::pair("xmlns:sonard=\"https://sonard.dev/sdf\"", "sonard:"),
        std::pair("xmlns:sonar=\"https://sonard.dev/sdf\"", "sonar:"),
        std::pair("xmlns:x='https://sonard.dev/sdf' xmlns:gz='http://gazebosim.org/schema'", "x:"),
        std::pair("xmlns:sonard=\"urn:sonard\"", "sonard:"), std::pair("xmlns:old=\"urn:sonard\"", "old:")}) {
    const test::TempFolder folder;
    const World world = load_world(folder.write("w.sdf", own(declarations, prefix)), {});
    EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "mud") << prefix;
    EXPECT_EQ(world.water_surface_z_m, 1.5) << prefix;
    ASSERT_EQ(world.sonars.size(), 1U) << prefix;
    EXPECT_EQ(world.sonars[0].type, "micron");
    EXPECT_THAT(world.warnings, IsEmpty()) << prefix;
  }
}

TEST(Prefix, MayBeBoundWhereItIsUsed) {
  const World world = load_text(
      "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><box/></geometry><s:material "
      "xmlns:s=\"https://sonard.dev/sdf\">mud</s:material></visual><visual name=\"w\"><geometry>"
      "<box/></geometry><material xmlns=\"https://sonard.dev/sdf\">rock</material></visual></link>"
      "</model>");
  EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "mud");
  EXPECT_EQ(world.bodies.at(0).parts.at(1).material.name, "rock");
}

TEST(Prefix, IsNamedIfItLooksLikeOurs) {
  for (const auto& [declarations, prefix] :
       {std::pair("", "sonar"), std::pair("xmlns:sonar=\"https://example.org\"", "sonar"),
        std::pair("", "gz")}) {
    const test::TempFolder folder;
    const World world = load_world(folder.write("w.sdf", own(declarations, std::string(prefix) + ":")), {});
    EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "default");
    EXPECT_THAT(world.warnings, testing::UnorderedElementsAre(
                                    HasSubstr("w.sdf:1: <" + std::string(prefix) +
                                              ":water_surface_z> is left out: its prefix is not sonard's; "
                                              "write <sonard:water_surface_z>, or declare xmlns:" +
                                              prefix + "=\"https://sonard.dev/sdf\""),
                                    HasSubstr("w.sdf:2: <" + std::string(prefix) + ":material> is left out"),
                                    HasSubstr("w.sdf:2: attribute " + std::string(prefix) +
                                              ":type of <sensor> is left out")));
  }
}

TEST(Prefix, IsNamedWithTheNameIfTheirLettersAreCapital) {
  const std::string box = "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><box/></geometry>";
  const World world =
      load_text(box + "<Sonard:Material>mud</Sonard:Material><gz:MATERIAL/></visual></link></model>");
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(
                  HasSubstr("<Sonard:Material> is left out: prefix and name are not sonard's; write "
                            "<sonard:material>"),
                  HasSubstr("<gz:MATERIAL> is left out: prefix and name are not sonard's; write "
                            "<sonard:material>")));
  for (const std::string& warning : world.warnings) {
    EXPECT_THAT(warning, testing::Not(HasSubstr("declare"))) << "the name would still be wrong";
  }
  const test::TempFolder folder;
  EXPECT_THAT(
      complaints(folder.write("w.sdf", in_a_world(box + "<sonard:Material>mud</sonard:Material></visual>"
                                                        "</link></model>"))),
      Contains(HasSubstr("unknown element <sonard:Material>: write <sonard:material>")));
}

// The advice names only elements that sonard has.
TEST(Prefix, GetsTheMostSimilarNameAsAdvice) {
  const std::string box = "<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><box/></geometry>";
  const World world = load_text(
      box + "<sonar:materials>mud</sonar:materials><sonar:range>20</sonar:range></visual></link></model>");
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(
                  testing::EndsWith("<sonar:materials> is left out: prefix and name are not sonard's; write "
                                    "<sonard:material>"),
                  testing::EndsWith("<sonar:range> is left out: prefix and name are not sonard's; expected "
                                    "<sonard:material> or <sonard:water_surface_z>")));
  const test::TempFolder folder;
  EXPECT_THAT(
      complaints(folder.write(
          "w.sdf", in_a_world(box + "<sonard:materials>mud</sonard:materials></visual></link></model>"))),
      Contains(HasSubstr("unknown element <sonard:materials>: write <sonard:material>")));
}

// sonard reads nothing in a plugin. Other contents of it belong to the plugin.
TEST(Prefix, IsNamedInAPlugin) {
  const World world =
      load_text("<model name=\"m\"><link name=\"l\">" + small_box +
                "</link><plugin name=\"p\" filename=\"f\"><sonar:material>mud</sonar:material>"
                "<sonar:range>20</sonar:range><gz:material/></plugin></model>");
  EXPECT_THAT(world.warnings, ElementsAre(testing::EndsWith(
                                  "<sonar:material> in a <plugin> is left out: write "
                                  "<sonard:material> into one of: visual, collision, link, model")));
}

TEST(Prefix, IsMissedOfAMaterial) {
  const World world = load_text(
      "<model name=\"m\"><material>mud</material><link name=\"l\"><material>mud</material>"
      "<collision name=\"c\"><geometry><box/></geometry><material>mud</material></collision>"
      "<visual name=\"v\" acoustics:material=\"mud\" "
      "sonar:material=\"mud\"><geometry><box/></geometry><material>rock</material>"
      "</visual></link></model>");
  const auto unknown_in = [](const std::string& parent) {
    return testing::EndsWith("unknown element <material> in <" + parent +
                             ">: it is left out; for a sonar, write <sonard:material>");
  };
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(
                  unknown_in("model"), unknown_in("link"), unknown_in("collision"),
                  testing::EndsWith("<material> with a text in <visual> is left out: Gazebo's <material> has "
                                    "no text; write <sonard:material>rock</sonard:material> for a sonar"),
                  testing::EndsWith("attribute acoustics:material of <visual> is left out: a material is an "
                                    "element; write <sonard:material>...</sonard:material> into <visual>"),
                  testing::EndsWith("attribute sonar:material of <visual> is left out: a material is an "
                                    "element; write <sonard:material>...</sonard:material> into <visual>")));
}

// http://sdformat.org/spec?elem=material: its children are elements; a script of Gazebo classic has a slash.
TEST(Prefix, IsNotMissedOfAMaterialOfGazebo) {
  for (const char* const material :
       {"<material><ambient>1 0 0 1</ambient><diffuse>1 0 0 1</diffuse></material>",
        "<material><script><uri>file://media</uri><name>Gazebo/Grey</name></script></material>",
        "<material><pbr><metal><albedo_map>a.png</albedo_map></metal></pbr></material>", "<material/>",
        "<material>Gazebo/Grey</material>", "<material> </material>"}) {
    EXPECT_THAT(
        load_text("<model name=\"m\"><link name=\"l\"><visual name=\"v\"><geometry><box/></geometry>" +
                  std::string(material) + "</visual></link></model>")
            .warnings,
        IsEmpty())
        << material;
  }
}

TEST(Prefix, OfAnotherProgramIsItsOwnBusiness) {
  const World world = load_text("<model name=\"m\"><link name=\"l\">" + small_box +
                                "<gz:system_priority>5</gz:system_priority><drake:joint/></link></model>");
  EXPECT_THAT(world.warnings, IsEmpty());
}

TEST(Prefix, IsSeenInAnInclude) {
  const test::TempFolder folder;
  folder.write(
      "models/post/model.sdf",
      "<sdf version=\"1.9\" xmlns:sonard=\"x\"><model name=\"post\"><sonard:material>rock</sonard:material>"
      "<link name=\"l\">" +
          small_box + "</link></model></sdf>");
  const World world = load_world(
      folder.write(
          "w.sdf",
          in_a_world("<include><uri>post</uri><sonard:material>mud</sonard:material></include>"
                     "<include><uri>post</uri><name>q</name><sonar:material>mud</sonar:material></include>")),
      {});
  EXPECT_EQ(world.bodies.at(0).parts.at(0).material.name, "mud") << "in the place of the model's own";
  EXPECT_EQ(world.bodies.at(1).parts.at(0).material.name, "rock");
  EXPECT_THAT(world.warnings, ElementsAre(HasSubstr("w.sdf:3: <sonar:material> is left out")));
}

TEST(Include, NamesChildrenWithoutAnEffect) {
  const test::TempFolder folder;
  folder.write("models/post/model.sdf", "<sdf version=\"1.9\"><model name=\"post\"><link name=\"l\">" +
                                            small_box + "</link></model></sdf>");
  const auto include = [](const std::string& name, const std::string& content) {
    return "<include><name>" + name + "</name><uri>post</uri>\n" + content + "</include>\n";
  };
  const std::string params =
      "<experimental:params><visual element_id=\"l::v\" action=\"remove\"/></experimental:params>";
  const World world = load_world(
      folder.write("w.sdf", in_a_world(include("a", params) + include("b", params) +
                                       include("c", "<Pose>1 0 0 0 0 0</Pose>") +
                                       include("d", "<static>1</static><plugin name=\"p\"/><drake:weld/>"))),
      {});
  EXPECT_EQ(world.bodies.size(), 4U);
  EXPECT_THAT(
      world.warnings,
      testing::UnorderedElementsAre(
          testing::AllOf(HasSubstr("w.sdf:4: <experimental:params> of an include is not supported: its "
                                   "changes are not applied"),
                         EndsWith("(2): a, b")),
          testing::AllOf(HasSubstr("w.sdf:8: unknown element <Pose> in <include>: it is left out"),
                         EndsWith("(1): c"))));
}

TEST(GroupedWarnings, AreOneLineForEachKind) {
  const test::TempFolder folder;
  folder.write("paint.mtl", "newmtl RedPaint\nKd 1 0 0\nnewmtl Blue\nKd 0 0 1\n");
  folder.write("hull.obj",
               "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl RedPaint\nf 1 2 3\nusemtl "
               "Blue\nf 1 2 4\n");
  std::string models;
  for (int i = 0; i < 10; ++i) {
    models +=
        "<model name=\"m" + std::to_string(i) +
        "\"><link name=\"l\">\n<visual name=\"v\"><geometry><mesh><uri>hull.obj"
        "</uri></mesh></geometry></visual><visual name=\"r\"><geometry><box/></geometry><laser_retro>4000"
        "</laser_retro></visual></link></model>";
  }
  const World world = load_world(folder.write("w.sdf", in_a_world(models)), {});
  EXPECT_THAT(world.warnings,
              testing::UnorderedElementsAre(
                  testing::AllOf(
                      HasSubstr("w.sdf:4: mesh materials are not acoustic materials, so 'default' is used"),
                      HasSubstr("(20): "), HasSubstr("'RedPaint' (m0::l::v)"), HasSubstr("'Blue' (m0::l::v)"),
                      EndsWith(", ...")),
                  testing::AllOf(HasSubstr("w.sdf:4: laser_retro is far above the usual 0 to 2.5"),
                                 HasSubstr("(10): "), HasSubstr("4000 (m0::l::r), 4000 (m1::l::r), "),
                                 EndsWith(", ..."))));
}

bool is_one_printable_line(const std::string& line) {
  return std::ranges::none_of(line,
                              [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7f'; }) &&
         line.find("\xC2\x9B") == std::string::npos;
}

const std::string forged = "m&#27;[2J&#10;2026-11-28 12:00:00 [error] forged&#155;31m";

// A body's name appears in the log, on the page and in the status.
TEST(NamesOfAWorld, HoldNoLineOfTheirOwnAndSteerNoTerminal) {
  const World world = load_text("<model name=\"" + forged + "\"><link name=\"l\">" + small_box +
                                "</link></model>\n<light name=\"" + forged + "\"/>");
  EXPECT_EQ(world.bodies.at(0).name, "m\\x1b[2J 2026-11-28 12:00:00 [error] forged\\x9b31m");
  for (const std::string& line : world.left_out) {
    EXPECT_TRUE(is_one_printable_line(line)) << line;
  }
}

TEST(NamesOfAWorld, AreOneLineOfAComplaint) {
  const test::TempFolder folder;
  folder.write("hull.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl st\x1b[2Jeel\nf 1 2 3\n");
  folder.write("models/wreck/model.config", "<model><sdf>gone&#27;[2J\nerror: forged</sdf></model>");
  const auto in_model = [](const std::string& name, const std::string& content) {
    return "<model name=\"" + name + "\"><link name=\"l\"><visual name=\"" + forged + "\">" + content +
           "</visual></link></model>\n";
  };
  const std::string mesh = "<geometry><mesh><uri>hull.obj</uri></mesh></geometry>";
  const World world = load_world(folder.write("w.sdf", in_a_world(in_model("a", mesh))), {});
  EXPECT_THAT(world.warnings, Contains(HasSubstr("'st\\x1b[2Jeel'")));
  std::vector<std::string> lines = world.warnings;
  for (const std::string& line : complaints(folder.write(
           "w.sdf", in_a_world(in_model("a", "<geometry><mesh><uri>no&#27;\nfile</uri></mesh></geometry>") +
                               in_model(forged, "<sonard:material>" + forged + "</sonard:material>" + mesh) +
                               "<include><uri>model://wreck</uri></include>")))) {
    lines.push_back(line);
  }
  EXPECT_GE(lines.size(), 4U);
  for (const std::string& line : lines) {
    EXPECT_TRUE(is_one_printable_line(line)) << line;
  }
}

}  // namespace
}  // namespace sonard::render
