/// Numbers that a user asks of a run by name, in every completed step, for tables, files, summaries, checks and limits.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Reduction of several places, or of all of a member.
enum class Take {
  each,         ///< one number (or vector) for each place
  sum,          ///< over the places
  largest,      ///< over the places, or along whole members
  smallest,     ///< likewise
  largest_size  ///< likewise: the one of largest absolute value, with its sign
};

/// One entry of the list "Quantities", as it was written.
struct Quantity {
  std::string name{};
  std::string kind{};   ///< "displacement", "material moment", ...
  std::string point{};  ///< a point, MEMBER@s, MEMBER@p%, or a pattern of either
  std::string other_point{}, corner{};
  std::string member{};              ///< a member or a pattern
  std::optional<double> position{};  ///< arc length over length, 0 to 1
  bool before_vertex = false;        ///< of the two elements that meet at a vertex, the one that ends there
  std::string component{};           ///< empty: all
  Take take = Take::each;
  std::string formula{};
  int mode = 0;                           ///< of vibrations, from 1
  std::optional<double> limit{};          ///< largest absolute value allowed in any completed step, ...
  std::optional<double> span{}, ratio{};  ///< ... or their quotient
  std::string load_case{};                ///< in which alone the limit counts, or a pattern; empty: in all
  std::optional<Stage> stage{};           ///< in whose steps alone it counts
  std::optional<Stage> relative_to{};     ///< at the end of which the value is zero for the limit; 0: before any load

  std::optional<double> allowed() const { return ratio ? *span / *ratio : limit; }
  bool is_limited_in(const std::string& one) const;
  /// Behind "the size": " since the end of stage 1".
  std::string since() const;
};

/// Declaration of the list "Quantities".
ListSpec quantities_spec();

/// Reads the list; whether points and members exist is the affair of QuantitySet. Throws InputError.
std::vector<Quantity> read_quantities(Teuchos::ParameterList& list, const ParameterSource& source,
                                      const ParameterPath& path = {"Quantities"});

/// Whether the cases and stages that limits name are in the scene. Throws InputError.
void check_limits(const std::vector<Quantity>& quantities, const Scene& scene, const InputPlace& place);

/// The quantity that a check of common_quantities() compares.
Quantity quantity_of(const ExpectedValue& expected);

}  // namespace mixbeam
