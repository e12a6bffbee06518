/// The lists "Identification" and "Design": find numbers of a scene from required values of its quantities.
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

/// An unknown number of the scene; its value in the scene is the initial guess.
struct SearchedNumber {
  std::string name{};
  std::string path{};                                    ///< as written; in SearchParameters of one number
  std::optional<double> at_least{}, at_most{}, scale{};  ///< as written; there all set, possibly infinite
  NumberPath place{};
  double start = 0.0, value = 0.0;
  double deviation = 0.0;  ///< NaN: at a bound, or no measurements; infinite: not determined by these
  bool is_held = false;    ///< at a bound
};

/// Required value of a quantity at the end of the path: a measurement, or bounds.
struct WantedQuantity {
  std::string name{}, quantity{}, load_case{};
  double value = 0.0, deviation = 0.0;
  std::optional<double> at_least{}, at_most{};
  bool is_largest = false;  ///< objective is maximized
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

/// Reads either list, if the scene has one, and checks that all names in it exist. Throws InputError.
std::optional<SearchParameters> read_search(const Application& app);

struct FoundScene {
  std::vector<SearchedNumber> numbers{};
  std::vector<double> covariance{};  ///< (number, number); empty without measurements
  std::vector<double> values{};      ///< of the wanted quantities
  std::vector<double> sizes{};       ///< their absolute values at the start
  std::vector<SearchStep> steps{};   ///< steps of the search, in numbers of the scene
  SearchEnd end = SearchEnd::found;
  std::string failure{};               ///< why the search failed
  std::vector<std::string> remarks{};  ///< remarks on the numbers
  std::string xml{};                   ///< the scene with the found numbers, without the list
};

/// Runs the search. `root`: declaration of the file; `report` is called for each step. Throws InputError, and
/// ConvergenceError if the initial scene has no equilibrium.
FoundScene search_scene(Application& app, const ListSpec& root, const std::function<void(const SearchStep&)>& report);

}  // namespace mixbeam
