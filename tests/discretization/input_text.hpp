/// What the tests of the input share: a small valid scene, changes of it, and looking into error messages.
#pragma once

#include "discretization/reading/read_scene.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace mixbeam {

/// A shaft with a bow on top whose end "tip" is not declared: places in the tests below refer to this text.
inline const std::string kBowScene = R"yaml(Name: bow
Scene:
  Sections:
    steel: {EA: 1e4, GA2: 5e3, GA3: 5000, GIt: 2, EI2: 2, EI3: 2.5}
  Points:
    foot: [0, 0, 0]
    top: [10, 0, 0]
  Members:
    shaft: {Start: foot, End: top, Section: steel, Order: 3, Elements: 4, Second Axis: [0, 1, 0]}
    arch:
      Start: top
      End: tip
      Section: steel
      Curve: {Shape: arc, Center: [10, 5, 0], Axis: [0, 0, 2], Angle: 1.5707963267948966}
  Supports:
    clamp: {Point: foot}
  Point Loads:
    pull: {Point: tip, Force: [0, 1, 0]}
  Distributed Loads:
    weight: {Member: shaft, Force: [0, 0, -1], Stage: 2}
)yaml";

/// What the list "Scene" describes, whether supports hold it or not: read_scene without its last check.
inline Scene described_by(const XmlParameters& xml) {
  std::string loose;
  return read_scene(xml.list->sublist("Scene"), xml.source, {"Scene"}, {nullptr, &loose});
}

inline Scene scene_from(const std::string& text) { return described_by(parsed(text)); }

/// Message of the InputError that `action` throws; empty, and a failure, if it throws none.
template <typename Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace mixbeam
