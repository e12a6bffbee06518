/// What is written of each case of a batch.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/mixbeam/batch_parameters.hpp"

namespace mixbeam {

/// A simulation of cases side by side (merged_scene.hpp), or of one alone, where its solution stands.
struct SolvedCases {
  const Simulation& simulation;
  bool merged = false;                       ///< names are those of MergedScene::name_in_part
  std::vector<Reaction> reactions{};         ///< of all cases
  std::vector<StrainEnergy> energies{};      ///< of each case
  std::vector<std::size_t> first_support{};  ///< of each case
  std::vector<int> first_member{};           ///< of each case
};

class CaseQuantities {
 public:
  /// Throws InputError for expected values that do not belong to the end of the path.
  CaseQuantities(const Application& app, BatchOutput output, const std::string& load_case);

  /// "tip.displacement.x", "wall.reaction_force.y", or the names of expected values or quantities.
  const std::vector<std::string>& names() const { return names_; }
  std::vector<double> of(const SolvedCases& solved, int part) const;
  /// The expected values behind the names; empty when other quantities are written.
  const std::vector<ExpectedValue>& expected() const { return expected_; }

 private:
  void take_followed(const Application& app);
  void take_expected(const Application& app, const std::string& load_case);

  std::vector<std::string> names_;
  QuantitySet quantities_;
  std::vector<ExpectedValue> expected_;
};

}  // namespace mixbeam
