#include "discretization/scene/section_shape.hpp"
#include "scene_text.hpp"

#include <cmath>

namespace mixbeam {
namespace {

/// The parameters of the section of kBowScene; the section's list begins in line 5.
const std::string kSteel = "EA: 1e4, GA2: 5e3, GA3: 5000, GIt: 2, EI2: 2, EI3: 2.5";

std::string shape(const std::string& word) { return "Shape: " + word + ", "; }
std::string matrix(const std::string& values) { return "Matrix: " + values + ", "; }
std::string rigid(const std::string& name) { return name + ": true, "; }
std::string material(const std::string& inside = "E: 200, nu: 0.25") { return "Material: {" + inside + "}, "; }

Section section_from(const std::string& inside) {
  return scene_from(changed(kBowScene, kSteel, inside)).sections.at(0);
}

void expect_refused(const std::string& inside, const std::vector<std::string>& parts) {
  const std::string message = message_of([&] { section_from(inside); });
  expect_in(message, parts);
  expect_in(message, {"scene.yaml:", "YAML path \"Scene / Sections / steel"});
}

const std::string kRectangle = shape("rectangle") + "Width: 2, Height: 3, ";

TEST(SceneSections, ReadsEveryShape) {
  const std::string box = "Width: 2, Height: 3, ";
  const auto kind = [](const std::string& inside) { return section_from(material() + inside).shape->kind; };
  EXPECT_EQ(kind(shape("circle") + "Diameter: 2"), SectionShapeKind::circle);
  EXPECT_EQ(kind(shape("tube") + "Diameter: 2, Wall: 0.1"), SectionShapeKind::tube);
  EXPECT_EQ(kind(shape("rectangle") + box), SectionShapeKind::rectangle);
  EXPECT_EQ(kind(shape("ellipse") + box), SectionShapeKind::ellipse);
  EXPECT_EQ(kind(shape("box") + box + "Wall: 0.1"), SectionShapeKind::box);
  const Section i = section_from(shape("I") + box + "Flange: 0.3, Web: 0.2, " + material());
  EXPECT_EQ(i.shape->kind, SectionShapeKind::i_section);
  EXPECT_EQ(i.shape->size2, 2.0);
  EXPECT_EQ(i.shape->size3, 3.0);
  EXPECT_EQ(i.shape->wall, 0.3);
  EXPECT_EQ(i.shape->web, 0.2);
}

TEST(SceneSections, ShapesBecomeStiffnesses) {
  const Section s = section_from(kRectangle + material());
  EXPECT_EQ(s.name, "steel");
  EXPECT_DOUBLE_EQ(s.axial_stiffness, 200.0 * 6.0);
  EXPECT_DOUBLE_EQ(s.bending_stiffness[0], 200.0 * 2.0 * 27.0 / 12.0);
  EXPECT_DOUBLE_EQ(s.shear_stiffness[0], 12.5 / 14.75 * 80.0 * 6.0);  // Cowper: 10 (1 + nu) / (12 + 11 nu)
}

TEST(SceneSections, MaterialByShearModulus) {
  const Section s = section_from(kRectangle + material("E: 200, G: 80"));
  EXPECT_DOUBLE_EQ(s.shape->poisson_ratio, 0.25);
  EXPECT_DOUBLE_EQ(s.shear_stiffness[1], 12.5 / 14.75 * 80.0 * 6.0);
  const Section timber = section_from(kRectangle + material("E: 200, G: 10, nu: 0.4"));
  EXPECT_DOUBLE_EQ(timber.torsional_stiffness / s.torsional_stiffness, 10.0 / 80.0);
  expect_refused(kRectangle + material("E: 200, G: 10"), {"Material / nu", "missing", "E / (2 G) - 1 is 9"});
  expect_refused(kRectangle + material("E: 200"), {"Material / nu", "missing", "or \"G\""});
  expect_refused(kRectangle + material("nu: 0.3"), {"Material / E", "missing"});
  expect_refused(kRectangle + material("E: 200, nu: 0.6"), {"value 0.6", "<= 0.5"});
  expect_refused(kRectangle, {"steel / Material", "missing map"});
  expect_refused(kRectangle + material("E: 2, Nu: 0"), {"did you mean \"nu\"?"});
}

TEST(SceneSections, StrengthAndLargestStrain) {
  const Section plain = section_from(kRectangle + material());
  EXPECT_FALSE(plain.shape->strength.has_value());
  EXPECT_EQ(plain.largest_strain, 0.05);
  const std::string moduli = "E: 200, nu: 0.25, ";
  const Section s = section_from(kRectangle + material(moduli + "Strength: 3") + "Largest Strain: 0.2");
  EXPECT_EQ(s.shape->strength, 3.0);
  EXPECT_EQ(s.largest_strain, 0.2);
  expect_refused(kRectangle + material(moduli + "Strength: 0"), {"Material / Strength", "value 0"});
  expect_refused(kRectangle + material(moduli + "strength: 1"), {"did you mean \"Strength\"?"});
  expect_refused(kRectangle + material() + "Largest Strain: -1, ", {"Largest Strain", "value -1"});
  const std::string box = shape("box") + "Width: 2, Height: 3, ";
  expect_refused(box + material(), {"steel", "Wall"});
  expect_refused(box + "Wall: 1, " + material(), {"less than half of the smaller dimension 2"});
}

TEST(SceneSections, ShearCorrection) {
  const Section s = section_from(kRectangle + "Shear Correction: [1, 0.5], " + material());
  EXPECT_DOUBLE_EQ(s.shear_stiffness[0], 480.0);
  EXPECT_DOUBLE_EQ(s.shear_stiffness[1], 240.0);
  expect_refused(kRectangle + "Shear Correction: [1, 0], " + material(), {"value > 0"});
}

TEST(SceneSections, SwitchesHoldForShapesAndMatrices) {
  const Section s = section_from(kRectangle + material() + rigid("Inextensible") + rigid("Shear Rigid"));
  EXPECT_TRUE(std::isinf(s.axial_stiffness) && std::isinf(s.shear_stiffness[0]) && std::isinf(s.shear_stiffness[1]));
  EXPECT_GT(s.torsional_stiffness, 0.0);
  const std::string no_axial_row = "[0,0,0,0,0,0, 5,0,0,0,0, 6,0,0,0, 3,0,1, 4,0, 5]";
  const Section m = section_from(matrix(no_axial_row) + rigid("Inextensible"));
  EXPECT_TRUE(std::isinf(m.axial_stiffness));
  EXPECT_EQ(m.shear_stiffness[1], 6.0);
  expect_refused(matrix(no_axial_row), {"steel / Matrix", "EA is 0"});
}

TEST(SceneSections, RefusesWrongDimensions) {
  expect_refused(kRectangle + "Wall: 0.1, " + material(),
                 {"steel / Wall", "no meaning for \"Shape\" = \"rectangle\"", "\"Width\", \"Height\""});
  expect_refused(shape("tube") + "Diameter: 2, " + material(), {"steel / Wall", "missing", "\"tube\""});
  expect_refused(shape("tube") + "Diameter: 2, Wall: 1.5, " + material(),
                 {"steel / Shape", "the wall thickness is 1.5", "at most half"});
  expect_refused(shape("circel") + "Diameter: 2, " + material(), {"did you mean \"circle\"?"});
  expect_refused(shape("circle") + "Diameter: 1e90, " + material(), {"1e+90", "from 1e-30 to 1e30"});
}

TEST(SceneSections, ReadsMatrices) {
  const std::string triangle = "[10,0,0,0,0,1, 5,0,0,0,0, 6,0,0,0, 3,0.5,0, 4,0, 5]";
  const std::string full = "[10,0,0,0,0,1, 0,5,0,0,0,0, 0,0,6,0,0,0, 0,0,0,3,0.5,0, 0,0,0,0.5,4,0, 1,0,0,0,0,5]";
  const Section s = section_from(matrix(triangle));
  ASSERT_TRUE(s.matrix.has_value());
  EXPECT_EQ((*s.matrix)[0][5], 1.0);
  EXPECT_EQ((*s.matrix)[4][3], 0.5);
  EXPECT_EQ(s.bending_stiffness[0], 4.0);
  EXPECT_EQ(*s.matrix, *section_from(matrix(full)).matrix);
}

TEST(SceneSections, RefusesWrongMatrices) {
  expect_refused(matrix("[1, 2, 3]"), {"steel / Matrix", "3 entries", "36", "21"});
  expect_refused(matrix("[10,0,0,0,0,1, 0,5,0,0,0,0, 0,0,6,0,0,0, 0,0,0,3,0,0, 0,0,0,0,4,0, 1.1,0,0,0,0,5]"),
                 {"not symmetric", "row EA, column EI3 is 1,", "1.1"});
  expect_refused(matrix("[10,0,0,0,0,0, 5,0,0,0,0, 6,0,0,0, 3,4,0, 4,0, 5]"),
                 {"not positive definite", "first 5 elastic components"});
  expect_refused(matrix("[10,0,0,0,0,0, 5,0,0,0,0, 6,0,0,0, 3,0,0, -4,0, 5]"), {"EI2 is -4"});
  expect_refused(matrix("[10,0,0,0,0,0, 5,0,0,0,0, 6,0,0,0, 3,0,0, 4,0, inf]"), {"inf"});
}

TEST(SceneSections, OneWayOnly) {
  expect_refused(kSteel + ", " + kRectangle + material(), {"steel / EA", "beside \"Shape\""});
  expect_refused(kSteel + ", " + matrix("[1]"), {"steel / EA", "beside \"Matrix\""});
  expect_refused(kRectangle + matrix("[1]") + material(), {"steel / Matrix", "beside \"Shape\""});
  expect_refused(kSteel + ", Width: 2, ", {"steel / Width", "with \"Shape\" only"});
  expect_refused(kSteel + ", " + material(), {"steel / Material", "with \"Shape\" only"});
  expect_refused("", {"steel / EA", "missing", "\"Shape\" or \"Matrix\""});
  expect_refused(changed(kSteel, "GIt: 2, ", ""), {"steel / GIt", "missing"});
}

}  // namespace
}  // namespace mixbeam
