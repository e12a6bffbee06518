/// One pattern as it was written: what its copies are called, and where they go.
#pragma once

#include "discretization/geometry/isometry.hpp"
#include "discretization/parameters/binding.hpp"

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

enum class PatternKind { repeat, rotate, mirror };
enum class CopyScope { members, joints, all };

struct Pattern {
  std::vector<std::string> members{"*"};
  PatternKind kind = PatternKind::repeat;
  int count = 2;  // mirror: the original and its image
  Vector3 vector{}, center{}, axis{}, point{}, normal{};
  std::optional<double> angle{};
  CopyScope scope = CopyScope::members;  ///< what goes with the members: joints, supports, loads and eigenstrains
};

/// Parameters of one pattern.
const BoundList<Pattern>& pattern_parameters();

/// Of all copies, the original not counted. Throws std::invalid_argument where there is no such motion.
std::vector<Isometry> motions_of(const Pattern& pattern);

/// Where a copy comes from: its name is that of the original and the numbers of the copies on the way.
struct CopyLabel {
  std::string base;
  std::vector<int> numbers{};

  std::string name() const {
    std::size_t count = numbers.size();
    while (count > 0 && numbers[count - 1] == 0) --count;  // the original of this and all later patterns
    if (count == 0) return base;
    std::string text = base + " (";
    for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
    return text + ")";
  }
  CopyLabel copy(int number) const {
    CopyLabel label = *this;
    label.numbers.back() = number;
    return label;
  }
};

}  // namespace mixbeam
