/// Expected answers that a scene file carries along, and the comparison with what was computed.
#pragma once

#include "discretization/parameter_source.hpp"
#include "discretization/parameter_spec.hpp"

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
  std::string quantity;               ///< displacement, position, rotation, or one of the application's own
  std::string point;                  ///< empty: the quantity belongs to no point
  std::string component;              ///< x, y, z, norm; empty: the quantity is a number
  std::optional<double> load_factor;  ///< none: at the end of the run
  double value = 0.0;
  double tolerance = 0.0;
  ToleranceKind kind = ToleranceKind::relative;
  std::string source;  ///< where the value comes from: paper and table, formula, program
};

struct ExpectationResult {
  bool pass = false;
  double difference = 0.0;  ///< actual - value, divided by |value| if the tolerance is relative
};

/// Quantities of a point that every application provides; each needs "Point" and "Component".
const std::vector<std::string>& point_quantities();

/// Declaration of the list "Expected"; `own_quantities` are those of the application besides point_quantities().
ListSpec expected_values_spec(const std::vector<std::string>& own_quantities = {});

/// Validates and reads the list. `path`: where it stands below the root of `source`.
std::vector<ExpectedValue> read_expected_values(Teuchos::ParameterList& list, const ParameterSource& source,
                                                const std::vector<std::string>& own_quantities = {},
                                                const ParameterPath& path = {"Expected"});

/// A value that is not a number never passes.
ExpectationResult compare(const ExpectedValue& expected, double actual);

}  // namespace mixbeam
