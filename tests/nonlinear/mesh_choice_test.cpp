#include "nonlinear/accuracy/mesh_choice.hpp"

#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

/// Lines one behind the other.
Scene chain(int members) {
  Scene scene;
  scene.sections = {test::section(1.0, 1.0, 1.0, 1.0)};
  scene.points = {{"0", {0, 0, 0}}};
  for (int m = 0; m < members; ++m) {
    const std::string start = std::to_string(m), end = std::to_string(m + 1);
    scene.points.push_back({end, {m + 1.0, 0, 0}});
    scene.members.push_back(test::line("member " + end, start, end, Member().order, Member().elements));
  }
  return scene;
}

/// An estimate in which every element of a member has the same error; vertices have none.
ErrorEstimate estimate_of(const Mesh& mesh, const std::vector<double>& error_of_member) {
  ErrorEstimate estimate;
  estimate.vertex_displacement.resize(mesh.vertex_position.size());
  for (const MeshElement& element : mesh.elements) {
    const double error = error_of_member[element.member] / std::sqrt(mesh.members[element.member].elements);
    estimate.element_displacement.push_back(error);
    estimate.element_moment.push_back(error);
  }
  estimate.displacement.size = estimate.largest_displacement.size = 1.0;
  return estimate;
}

MeshChoice next(const Scene& scene, const MeshChoice& present, const std::vector<double>& errors, double aim) {
  const Scene meshed = on_mesh(scene, present);
  const Mesh mesh = build_mesh(meshed);
  return next_mesh(meshed, mesh, present, errors_of_members(meshed, mesh, estimate_of(mesh, errors)), aim);
}

TEST(MeshChoice, StartTakesHigherOrdersForMoreDigits) {
  const Scene scene = chain(1);
  const MemberMesh coarse = start_mesh(scene, 1e-2)[0], fine = start_mesh(scene, 1e-10)[0];
  EXPECT_LT(coarse.order, fine.order);
  EXPECT_LE(coarse.elements, fine.elements);
}

TEST(MeshChoice, StartIsCoarserForNumbersOfVertices) {
  const Scene scene = chain(1);
  const MemberMesh all = start_mesh(scene, 1e-8)[0], vertices = start_mesh(scene, 1e-8, true)[0];
  EXPECT_LT(vertices.order, all.order);
  EXPECT_LE(vertices.elements, all.elements);
}

TEST(MeshChoice, StartTakesMoreElementsWhereTheMemberTurns) {
  Scene scene = chain(1);
  const int straight = start_mesh(scene, 1e-6)[0].elements;
  scene.members[0].twist = 40.0;
  EXPECT_GT(start_mesh(scene, 1e-6)[0].elements, 2 * straight);
}

TEST(MeshChoice, StartHasAnElementBetweenTwoInnerPoints) {
  Scene scene = chain(1);
  for (int i = 1; i < 12; ++i) scene.members[0].inner_points.push_back({"inner " + std::to_string(i), i / 12.0});
  EXPECT_GE(start_mesh(scene, 1e-3)[0].elements, 12);
}

int work_of(const MemberMesh& mesh) { return (mesh.order + 1) * mesh.elements; }

// A force that bends a member far asks for more elements; a small one, and the moment of a small couple, do not.
TEST(MeshChoice, StartTakesMoreElementsUnderLargeLoads) {
  Scene scene = chain(1);
  scene.supports = {test::clamp("0")};
  const MeshChoice unloaded = start_mesh(scene, 1e-6);
  scene.point_loads = {test::dead_load("1", {0.0, 0.5, 0.0})};
  EXPECT_EQ(start_mesh(scene, 1e-6), unloaded);
  scene.point_loads[0].force = {0.0, 20.0, 0.0};
  EXPECT_GT(work_of(start_mesh(scene, 1e-6)[0]), work_of(unloaded[0]));
}

// With an order that is kept, the elements follow the rate h^(k+1).
TEST(MeshChoice, ElementsFollowTheRate) {
  Scene scene = chain(1);
  scene.members[0].keeps_order = true;
  scene.members[0].order = 3;
  const MeshChoice choice = next(scene, {{3, 10}}, {16e-6}, 1e-6);
  EXPECT_EQ(choice[0].order, 3);
  EXPECT_GE(choice[0].elements, 20);  // 16 times the accuracy: half of h at order 3
  EXPECT_LE(choice[0].elements, 25);  // and at most a quarter more, which costs as much
}

// (q h)^(k+1): 1e-4 with order 3 on 4 elements is q h = 0.1, and each order gives a digit.
TEST(MeshChoice, OrdersFollowTheRate) {
  Scene scene = chain(1);
  scene.members[0].keeps_elements = true;
  scene.members[0].elements = 4;
  EXPECT_EQ(next(scene, {{3, 4}}, {1e-4}, 1.01e-7)[0].order, 6);
  EXPECT_EQ(next(scene, {{3, 4}}, {1e-4}, 0.99e-7)[0].order, 7);  // the twin
}

TEST(MeshChoice, MembersThatContributeLittleStayCoarse) {
  const MeshChoice choice = next(chain(3), {{4, 4}, {4, 4}, {4, 4}}, {1e-4, 1e-12, 1e-4}, 1e-8);
  EXPECT_LE(work_of(choice[1]), work_of({4, 4}));
  EXPECT_GT(work_of(choice[0]), work_of({4, 4}));
  EXPECT_EQ(choice[0].order, choice[2].order);
  EXPECT_EQ(choice[0].elements, choice[2].elements);
}

TEST(MeshChoice, WhatMembersKeepStays) {
  Scene scene = chain(2);
  scene.members[0].keeps_order = scene.members[0].keeps_elements = true;
  scene.members[0].order = 2;
  scene.members[0].elements = 5;
  const MeshChoice start = start_mesh(scene, 1e-6);
  EXPECT_EQ(start[0], (MemberMesh{2, 5}));
  const MeshChoice choice = next(scene, start, {1e-3, 1e-3}, 1e-9);
  EXPECT_EQ(choice[0], (MemberMesh{2, 5}));
  EXPECT_EQ(doubled(scene, start)[0], (MemberMesh{2, 5}));
  EXPECT_EQ(on_mesh(scene, {{7, 9}, {7, 9}}).members[0].order, 2);
  EXPECT_EQ(on_mesh(scene, {{7, 9}, {7, 9}}).members[1].order, 7);
}

TEST(MeshChoice, TurningOfElements) {
  const Scene scene = on_mesh(chain(1), {{3, 4}});
  const Mesh mesh = build_mesh(scene);
  std::vector<double> rotation;
  for (int v = 0; v < mesh.vertices(); ++v) {  // a circle about e3, one radian from vertex to vertex
    const double half = 0.5 * mesh.vertex_position[v][0] * 4.0;
    rotation.insert(rotation.end(), {std::cos(half), 0.0, 0.0, std::sin(half)});
  }
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(element_turning(scene, mesh, rotation)[0], 1.0, kRounding);
  const double allowed = allowed_turning(3, 1e-6);
  EXPECT_EQ(mesh_for_turning(scene, {{3, 4}}, {1.0}, 1e-6)[0].elements, static_cast<int>(std::ceil(4.0 / allowed)));
  EXPECT_EQ(mesh_for_turning(scene, {{3, 4}}, {0.9 * allowed}, 1e-6)[0].elements, 4);
}

TEST(MeshChoice, ElementsGrowByABoundedFactor) {
  const Scene scene = chain(1);
  EXPECT_EQ(mesh_for_turning(scene, {{3, 4}}, {1e6}, 1e-6)[0].elements, 4 * kLargestRefinement);
  Scene kept = scene;
  kept.members[0].keeps_order = true;
  kept.members[0].order = 2;
  const int elements = next(kept, {{2, 10}}, {1e-2}, 1e-12)[0].elements;
  EXPECT_GT(elements, 2 * 10);
  EXPECT_LE(elements, kLargestRefinement * 10);
}

TEST(MeshChoice, RicherContainsWhatWasThere) {
  Scene scene = chain(3);
  scene.members[1].keeps_order = scene.members[2].keeps_order = scene.members[2].keeps_elements = true;
  const MeshChoice present = {{3, 4}, {3, 4}, {3, 4}};
  EXPECT_EQ(richer(scene, present), (MeshChoice{{4, 4}, {3, 8}, {3, 4}}));
  EXPECT_EQ(richer(scene, {{8, 4}, {3, 4}, {3, 4}})[0], (MemberMesh{8, 8}));
  EXPECT_TRUE(contains(richer(scene, present), present));
  EXPECT_FALSE(contains(present, richer(scene, present)));
}

// A displacement of rounding has an error of its own size; against the length of the structure it has none.
TEST(MeshChoice, ErrorsOfNoMotionAreMeasuredAgainstTheStructure) {
  constexpr double kLength = 40.0, kAccuracy = 1e-8;
  ErrorEstimate estimate;
  estimate.displacement = estimate.largest_displacement = {4e-12, 7e-12};
  EXPECT_GT(judged_error(estimate), 0.5);
  const double least = least_displacement(kLength, kAccuracy);
  EXPECT_LT(judged_error(with_least_displacement(estimate, least)), kAccuracy);
  // the twins: an error that is seen at this length, and a structure that moves
  estimate.displacement.error = 1e-7;
  EXPECT_GT(judged_error(with_least_displacement(estimate, least)), kAccuracy);
  estimate.displacement = {1e-3, 1.0};
  EXPECT_EQ(with_least_displacement(estimate, least).displacement.relative(), 1e-3);
  EXPECT_LT(least_displacement(kLength, 1e-3), 1e-6 * kLength);  // stiff structures keep their relative error
}

}  // namespace
}  // namespace mixbeam
