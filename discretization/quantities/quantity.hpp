/// Named numbers requested of a run, in every completed step, for tables, files, summaries, checks and limits.
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

/// Reduction over several places, or over a whole member.
enum class Take {
  each,         ///< one number (or vector) for each place
  sum,          ///< over the places
  largest,      ///< over the places, or along whole members
  smallest,     ///< likewise
  largest_size  ///< likewise: the one of largest absolute value, with its sign
};

/// One entry of the list "Quantities", as written.
struct Quantity {
  std::string name{};
  std::string kind{};   ///< "displacement", "material moment", ...
  std::string point{};  ///< a point, MEMBER@s, MEMBER@p%, or a pattern of either
  std::string other_point{}, corner{};
  std::string member{};              ///< a member or a pattern
  std::optional<double> position{};  ///< arc length over length, 0 to 1
  bool before_vertex = false;        ///< at a vertex, takes the element that ends there, not the one that begins
  std::string component{};           ///< empty: all
  Take take = Take::each;
  std::string formula{};
  int mode = 0;                           ///< of vibrations, from 1
  std::optional<double> limit{};          ///< largest absolute value allowed in any completed step, ...
  std::optional<double> span{}, ratio{};  ///< ... or their quotient
  std::string load_case{};                ///< the only one in which the limit counts, or a pattern; empty: all
  std::optional<Stage> stage{};           ///< the only one in whose steps it counts
  std::optional<Stage> relative_to{};     ///< its end is the zero of the limited value; 0: before any load

  std::optional<double> allowed() const { return ratio ? *span / *ratio : limit; }
  bool is_limited_in(const std::string& one) const;
  /// Text behind "the size" in messages: " since the end of stage 1".
  std::string since() const;
};

/// Declaration of the list "Quantities".
const ListSpec& quantities_spec();

/// Reads the list; QuantitySet checks whether points and members exist. Throws InputError.
std::vector<Quantity> read_quantities(Teuchos::ParameterList& list, const ParameterSource& source,
                                      const ParameterPath& path = {"Quantities"});

/// Throws InputError if a limit names a case or stage that the scene does not have.
void check_limits(const std::vector<Quantity>& quantities, const Scene& scene, const InputPlace& place);

/// Quantity that a check of common_quantities() compares.
Quantity quantity_of(const ExpectedValue& expected);

}  // namespace mixbeam
