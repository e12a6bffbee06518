/// What the kinds of quantities are in numbers.
#pragma once

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/quantities/quantity.hpp"
#include "discretization/state/sampling.hpp"

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

/// A scalar stands in the first entry, a vector in the first three; a triad is g1, g2, g3.
using Numbers = std::array<double, 9>;

/// What a kind of quantity is at one place of a member.
using Field = Vector3 (*)(const PointSample&, const MeshMember&);

/// Null for kinds that are no vectors along members.
Field field_of(const std::string& kind);

/// Where records hold a field as it is asked for; null where they do not.
std::vector<Vector3> MemberSamples::*recorded_field(const std::string& kind);

bool is_motion(const std::string& kind);
bool is_reaction(const std::string& kind);

/// Unit of a kind's numbers, by the names of those of length and force: "kN m". Empty where it has none that is known.
std::string unit_of(const std::string& kind, const std::string& length, const std::string& force);

/// Which of Numbers a quantity asks for; kNorm: the norm of the vector.
std::vector<int> numbers_of(const Quantity& quantity);
inline constexpr int kNorm = -1;

/// Behind the name of the quantity, of each of numbers_of().
std::vector<std::string> endings_of(const Quantity& quantity);

double picked(const Numbers& numbers, int which);
Numbers numbers_from(const Vector3& v);
/// The columns of a rotation matrix.
Numbers numbers_from(const Mat3<double>& axes);

}  // namespace mixbeam
