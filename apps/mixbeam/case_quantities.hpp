/// What is written of each case of a batch.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/mixbeam/batch_parameters.hpp"

#include <cmath>
#include <map>

namespace mixbeam {

/// A simulation of cases side by side (merged_scene.hpp), or of one alone, where its solution stands.
struct SolvedCases {
  const Simulation& simulation;
  bool merged = false;                            ///< names are those of MergedScene::name_in_part
  std::vector<Reaction> reactions{};              ///< of all cases
  std::vector<StrainEnergy> energies{};           ///< of each case
  std::vector<std::size_t> first_support{};       ///< of each case
  std::vector<int> first_member{};                ///< of each case
  const std::vector<EndLayer>* layers = nullptr;  ///< see QuantityState
};

/// What their errors are estimated with, as in with_errors().
struct RicherCases {
  std::vector<SolvedCases> states{};
  std::string not_estimated{};  ///< why there are none; empty: errors do not count
};

/// Numbers of the list "Quantities" at ends of stages: (stage, case, column).
using References = std::map<Stage, std::vector<std::vector<double>>>;

/// Numbers of one case at the end of its path.
struct CaseValues {
  std::vector<double> written{};          ///< in the order of CaseQuantities::names()
  std::vector<EstimatedValue> limited{};  ///< in the order of CaseQuantities::limits()
};

class CaseQuantities {
 public:
  /// Throws InputError for expected values that do not belong to the end of the path.
  CaseQuantities(const Application& app, BatchOutput output, const std::string& load_case);

  /// "tip.displacement.x", "wall.reaction_force.y", or the names of expected values or quantities.
  const std::vector<std::string>& names() const { return names_; }
  CaseValues of(const SolvedCases& solved, const RicherCases& richer, int part, const References& references) const;
  /// Name of the member whose index a number is, as NAME.member of an extreme; empty for other numbers.
  std::string member_of(std::size_t name, double value) const;
  /// Numbers of the list "Quantities" that have a limit, whatever is written.
  struct Limit {
    std::string name;
    double largest_size;   ///< that of the file
    std::size_t quantity;  ///< in the list "Quantities"
    std::optional<Stage> relative_to{};
  };
  const std::vector<Limit>& limits() const { return limits_; }
  double largest_size(const Limit& limit, std::size_t index) const {
    return own_limits_.empty() ? limit.largest_size : own_limits_[index][limit.quantity];
  }
  bool is_kept(const EstimatedValue& one, const Limit& limit, std::size_t index) const {  // false for NaN
    return one.not_estimated.empty() && std::abs(one.value) + one.error <= largest_size(limit, index);
  }
  /// See CaseScenes::limits().
  void take_limits(const std::vector<std::vector<double>>& limits) { own_limits_ = limits; }
  /// Whether some limit is relative to a state before the end.
  bool needs_path() const;
  /// Whether a limit counts from this state on: the end of a stage, or the start.
  bool is_reference(double load_factor) const;
  /// What limits are relative to, where the simulation stands: of the list "Quantities".
  std::vector<double> asked_of(const SolvedCases& solved, int part) const;
  /// The expected values of the names; empty when other quantities are written.
  const std::vector<ExpectedValue>& expected() const { return expected_; }

 private:
  void take_followed(const Application& app);
  void take_expected(const Application& app, const std::string& load_case);

  std::vector<std::string> names_, members_;
  QuantitySet quantities_;
  QuantitySet asked_;                       ///< the list "Quantities", where numbers of it are needed
  std::vector<std::size_t> asked_columns_;  ///< of each name; kNotAsked: the next number of quantities_
  std::vector<Limit> limits_;
  std::vector<std::vector<double>> own_limits_;
  std::vector<bool> is_limited_;  ///< (column of the list "Quantities")
  std::vector<ExpectedValue> expected_;
};

}  // namespace mixbeam
