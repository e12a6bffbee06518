/// Everything that acts on a structure, kind by kind. Code that scales, rotates, copies, renames, checks or counts
/// loads visits the kinds here, so that a new one needs its struct and list (scene.hpp), its description here, its
/// reader (reading/conditions), its terms in the equations and its picture (state/acting.cpp).
#pragma once

#include "discretization/scene/scene.hpp"

#include <algorithm>
#include <type_traits>

namespace mixbeam {

using Formulas = std::array<std::string, 3>;  ///< of components, of s and x along a member; empty: constants

inline bool is_given(const Formulas& formula) {
  return std::any_of(formula.begin(), formula.end(), [](const std::string& text) { return !text.empty(); });
}

/// Meaning of a vector. Vectors of rotations are axial: they keep their sign where a reflection reverses others, and
/// vice versa.
enum class VectorRole { force, moment, displacement, rotation, strain, curvature };
constexpr bool is_axial(VectorRole role) {
  return role == VectorRole::moment || role == VectorRole::rotation || role == VectorRole::curvature;
}

/// Stands for formulas of vectors that are always constant.
template <class Load>
inline constexpr std::conditional_t<std::is_const_v<Load>, const Formulas*, Formulas*> kConstant = nullptr;

/// One kind: its list in the scene and the name of that list, words for messages, the point or member that it acts on,
/// whether it acts along a member, deforms the structure without a force, and stays in a scene in which it does not
/// act. For one load: its vectors, by visit(vector, formulas or null, role); whether its components refer to a triad
/// that rotates with the structure; the range of relative arc lengths along a member; and whether it acts.
template <class Load>
struct ActingKind;

/// Defaults for most kinds.
template <class Load>
struct UsualKind {
  static constexpr bool along_member = false, deforms = false, stays = false;
  static bool is_in_triad(const Load& load) { return load.frame == LoadFrame::follower; }
  static bool acts(const Load&) { return true; }
};

template <>
struct ActingKind<PointLoad> : UsualKind<PointLoad> {
  static constexpr auto list = &Scene::point_loads;
  static constexpr const char *name = "Point Loads", *words = "the load at point";
  static constexpr auto target = &PointLoad::point;
  template <class Load, class Visit>
  static void for_each_vector(Load& load, const Visit& visit) {
    visit(load.force, kConstant<Load>, VectorRole::force);
    visit(load.moment, kConstant<Load>, VectorRole::moment);
  }
};

template <>
struct ActingKind<DistributedLoad> : UsualKind<DistributedLoad> {
  static constexpr auto list = &Scene::distributed_loads;
  static constexpr const char *name = "Distributed Loads", *words = "the line load on member";
  static constexpr auto target = &DistributedLoad::member;
  static constexpr bool along_member = true;
  template <class Load, class Visit>
  static void for_each_vector(Load& load, const Visit& visit) {
    visit(load.force, &load.force_formula, VectorRole::force);
    visit(load.couple, &load.couple_formula, VectorRole::moment);
  }
  static std::array<double, 2> range(const DistributedLoad& load) { return load.range; }
};

template <>
struct ActingKind<Eigenstrain> : UsualKind<Eigenstrain> {
  static constexpr auto list = &Scene::eigenstrains;
  static constexpr const char *name = "Eigenstrains", *words = "the eigenstrain of member";
  static constexpr auto target = &Eigenstrain::member;
  static constexpr bool along_member = true, deforms = true;
  template <class Load, class Visit>
  static void for_each_vector(Load& load, const Visit& visit) {
    visit(load.strain, &load.strain_formula, VectorRole::strain);
    visit(load.curvature, &load.curvature_formula, VectorRole::curvature);
    for (auto& turn : load.end_turns) visit(turn, kConstant<Load>, VectorRole::curvature);
  }
  static bool is_in_triad(const Eigenstrain&) { return true; }
  static std::array<double, 2> range(const Eigenstrain&) { return {0.0, 1.0}; }
};

/// The prescribed motions of a support, along its axes.
template <>
struct ActingKind<Support> : UsualKind<Support> {
  static constexpr auto list = &Scene::supports;
  static constexpr const char *name = "Supports", *words = "the prescribed motion of point";
  static constexpr auto target = &Support::point;
  static constexpr bool deforms = true, stays = true;
  template <class Load, class Visit>
  static void for_each_vector(Load& support, const Visit& visit) {
    visit(support.prescribed_displacement, kConstant<Load>, VectorRole::displacement);
    visit(support.prescribed_rotation, kConstant<Load>, VectorRole::rotation);
  }
  static bool is_in_triad(const Support&) { return true; }
  static bool acts(const Support& support) {
    return !vector_algebra::is_zero(support.prescribed_displacement) ||
           !vector_algebra::is_zero(support.prescribed_rotation);
  }
};

/// Not copied by patterns: all copies are in it.
template <>
struct ActingKind<RotatingFrame> : UsualKind<RotatingFrame> {
  static constexpr auto list = &Scene::rotating_frames;
  static constexpr const char *name = "Rotating Frame", *words = "the list";
  static constexpr auto target = &RotatingFrame::name;
  static constexpr bool stays = true;
  template <class Load, class Visit>
  static void for_each_vector(Load& frame, const Visit& visit) {
    visit(frame.velocity, kConstant<Load>, VectorRole::rotation);
  }
  static bool is_in_triad(const RotatingFrame&) { return false; }
  static bool acts(const RotatingFrame& frame) { return !vector_algebra::is_zero(frame.velocity); }
};

/// Bodies are read and copied like loads at points, but act by their weight alone: for_each_kind() omits them.
template <>
struct ActingKind<PointMass> {
  static constexpr auto list = &Scene::point_masses;
  static constexpr const char* name = "Point Masses";
  static constexpr auto target = &PointMass::point;
  static constexpr bool along_member = false;
};

/// Calls visit(kind) for each of them.
template <class Visit>
void for_each_kind(const Visit& visit) {
  visit(ActingKind<PointLoad>{});
  visit(ActingKind<DistributedLoad>{});
  visit(ActingKind<Eigenstrain>{});
  visit(ActingKind<Support>{});
  visit(ActingKind<RotatingFrame>{});
}

/// Calls visit(load, its kind) for each load, strain and support of a scene.
template <class AnyScene, class Visit>
void for_each_acting(AnyScene& scene, const Visit& visit) {
  for_each_kind([&](auto kind) {
    for (auto& load : scene.*kind.list) visit(load, kind);
  });
}

/// Whether anything acts on a scene.
inline bool anything_acts(const Scene& scene) {
  bool acts = false;
  for_each_acting(scene, [&](const auto& load, auto kind) { acts = acts || kind.acts(load); });
  return acts;
}
/// Whether strains or prescribed motions deform the structure without a force.
inline bool imposes_deformation(const Scene& scene) {
  bool deforms = false;
  for_each_acting(scene, [&](const auto& load, auto kind) { deforms = deforms || (kind.deforms && kind.acts(load)); });
  return deforms;
}

}  // namespace mixbeam
