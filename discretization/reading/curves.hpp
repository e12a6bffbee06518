/// Undeformed centerlines of members: their parameters, and reading them.
#pragma once

#include "discretization/geometry/arc_construction.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// A curve as it was written; some follow only when the positions of their ends are known.
struct CurveDraft {
  Curve curve;
  std::optional<ArcDefinition> arc{};  ///< an arc without centre or angle
  bool is_polyline = false;
  std::vector<Vector3> corners{};           ///< polyline: positions of its inner corners ...
  std::vector<std::string> corner_names{};  ///< ... or their names
};

/// Parameters of the list "Curve".
const BoundList<CurveDraft>& curve_parameters();

/// Reads the validated list "Curve" that stands at `path`. Throws InputError for parameters that do not belong
/// together, and for formulas that are none.
CurveDraft read_curve(const Teuchos::ParameterList& list, const ParameterSource& source, const ParameterPath& path);

}  // namespace mixbeam
