/// The lists "Identification" and "Design": numbers of a scene that are found from what its quantities shall be.
#pragma once

#include "apps/common/run/number_path.hpp"
#include "discretization/parameters/spec.hpp"
#include "nonlinear/sensitivity/least_squares.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

class Application;

/// A number of the scene that is searched for, from the value that the scene has.
struct SearchedNumber {
  std::string name{};
  std::string path{};                                    ///< as written; in SearchParameters::numbers one number
  std::optional<double> at_least{}, at_most{}, scale{};  ///< as written; there all known, perhaps infinite
  NumberPath place{};
  double start = 0.0, value = 0.0;
  double deviation = 0.0;  ///< NaN: a bound holds it, or there are no measurements; infinite: not told by these
  bool is_held = false;    ///< by a bound
};

/// What a quantity shall be at the end of the path: a measured value, or one between bounds.
struct WantedQuantity {
  std::string name{}, quantity{}, load_case{};
  double value = 0.0, deviation = 0.0;
  std::optional<double> at_least{}, at_most{};
  bool is_largest = false;  ///< of an objective: the largest value is looked for
};

struct SearchParameters {
  std::string list{};      ///< "Identification", "Design"
  bool is_design = false;  ///< the first of the wanted quantities is the objective, all others are constraints
  std::vector<SearchedNumber> numbers{};
  std::vector<WantedQuantity> wanted{};
};

/// Declarations of the lists "Identification" and "Design".
ListSpec identification_spec();
ListSpec design_spec();

/// Reads the list of either name, if the scene has one, and looks for all that it names. Throws InputError.
std::optional<SearchParameters> read_search(const Application& app);

struct FoundScene {
  std::vector<SearchedNumber> numbers{};
  std::vector<double> covariance{};  ///< (number, number); empty without measurements
  std::vector<double> values{};      ///< of the wanted quantities
  std::vector<double> sizes{};       ///< of these, at the start
  std::vector<SearchStep> steps{};   ///< with the numbers of the scene as unknowns
  SearchEnd end = SearchEnd::found;
  std::string failure{};               ///< why the search has not come to its end
  std::vector<std::string> remarks{};  ///< what should be known of the numbers
  std::string xml{};                   ///< the scene with them, without the list
};

/// `root`: declaration of the file; `report` is called for each step. Throws InputError, ConvergenceError where the
/// scene as it stands has no equilibrium.
FoundScene search_scene(Application& app, const ListSpec& root, const std::function<void(const SearchStep&)>& report);

}  // namespace mixbeam
