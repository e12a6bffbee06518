/// Expected answers that a scene file carries along, and the comparison with the computed ones.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Which difference the tolerance limits; never "either of the two".
enum class ToleranceKind {
  absolute,  ///< |actual - value|
  relative   ///< |actual - value| / |value|
};

struct ExpectedValue {
  std::string name;
  std::string quantity;               ///< one of common_quantities(), or one of the application's own
  std::string point;                  ///< empty: the quantity belongs to no point
  std::string component;              ///< x, y, z; 1, 2, 3 of the section; norm; empty: the quantity is a number
  std::optional<double> load_factor;  ///< none: at the end of the run
  double value = 0.0;
  double tolerance = 0.0;
  ToleranceKind kind = ToleranceKind::relative;
  std::string source;       ///< where the value comes from: paper and table, formula, program
  std::string member{};     ///< of a section's force or moment
  double position = 0.0;    ///< relative arc length along that member, 0 to 1
  std::string load_case{};  ///< in which it is compared; empty: the scene has none
  /// The value belongs to the n-th critical point of the path, from 1; none: to a step.
  std::optional<int> critical_point{};
  /// value of the quantity "stable": "true", "false", "neutral" or "unknown"; empty: a number is expected
  std::string word{};
  bool is_asked = false;  ///< `quantity` is a number of the list "Quantities"
};

struct ExpectationResult {
  bool pass = false;
  double difference = 0.0;  ///< actual - value, divided by |value| if the tolerance is relative
};

/// Name of the quantity whose value is a word: whether the state is stable.
inline constexpr const char* kStableName = "stable";

/// Quantities that every application provides: of a point (displacement, position, rotation, reaction force, reaction
/// moment; "Point" and a spatial "Component"), of a section (material force, material moment; "Member", "Position" and
/// a material "Component"), of the whole structure (strain energy), of the path (load factor, stable).
const std::vector<std::string>& common_quantities();

/// Declaration of the list "Expected"; `own_quantities` are those of the application besides common_quantities().
ListSpec expected_values_spec(const std::vector<std::string>& own_quantities = {});

/// Validates and reads the list. `path`: its place below the root of `source`; `asked`: names of the numbers in the
/// list "Quantities".
std::vector<ExpectedValue> read_expected_values(Teuchos::ParameterList& list, const ParameterSource& source,
                                                const std::vector<std::string>& own_quantities = {},
                                                const ParameterPath& path = {"Expected"},
                                                const std::vector<std::string>& asked = {});

/// Throws InputError for a value that no run of the scene could be compared with: a point, member or load case that it
/// does not have, a reaction where nothing is supported, a load factor beyond the end of its path.
void check_expected_values(const std::vector<ExpectedValue>& expected, const Scene& scene,
                           const ParameterSource& source, const ParameterPath& path = {"Expected"});

/// A value that is not a number never passes.
ExpectationResult compare(const ExpectedValue& expected, double actual);

}  // namespace mixbeam
