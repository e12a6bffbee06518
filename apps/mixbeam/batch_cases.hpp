/// The cases of a batch: the list "Batch", the output of each case, and their scenes.
#pragma once

#include "apps/common/run/application.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/reading/variables.hpp"

#include <Teuchos_ParameterList.hpp>

#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

enum class BatchOutput {
  followed,   ///< motion of supported and loaded points, reactions of supports
  expected,   ///< the quantities of the list "Expected"
  quantities  ///< the list "Quantities"
};

/// A parameter that differs from case to case.
struct BatchColumn {
  std::string parameter;       ///< its path: "Point Loads/tip/Force[1]"
  Variables::Refusal refusal;  ///< at its place in the user's file
};

/// The cases, numbered from 1 for the user.
struct Batch {
  std::vector<BatchColumn> columns{};
  std::vector<double> values{};  ///< (case, column); NaN: an empty cell of the table, or a formula
  struct Formula {
    std::size_t index, column;  ///< case and column of the cell
    std::string text;           ///< "=2*L"
    Variables::Refusal refusal;
  };
  std::vector<Formula> formulas{};  ///< cells that CaseScenes evaluates, in the order of the table
  std::string table{};              ///< its path; empty for a grid
  std::vector<int> lines{};         ///< line of each case in the table
  BatchOutput output = BatchOutput::followed;
  std::size_t before = 0;    ///< number of earlier cases of the table or grid
  std::size_t unvaried = 0;  ///< number of cases without columns: the scene as it stands

  std::size_t size() const { return columns.empty() ? unvaried : values.size() / columns.size(); }
  double value(std::size_t index, std::size_t column) const { return values[index * columns.size() + column]; }
  /// Keeps only `count` cases from `first` on, with their numbers.
  void keep(std::size_t first, std::size_t count);
  /// "sweep.csv:3: case 2", "case 2".
  std::string name_of_case(std::size_t index) const;
};

/// Declaration of the list "Batch".
ListSpec batch_spec();

/// Reads the validated list and its table, whose path is relative to the folder of the scene. Throws InputError.
Batch read_batch(const Teuchos::ParameterList& list, const ParameterSource& source);

/// A solved simulation of several cases side by side (merged_scene.hpp), or of a single case.
struct SolvedCases {
  const Simulation& simulation;
  bool merged = false;                            ///< names are those of MergedScene::name_in_part
  std::vector<Reaction> reactions{};              ///< of all cases
  std::vector<StrainEnergy> energies{};           ///< of each case
  std::vector<std::size_t> first_support{};       ///< of each case
  std::vector<int> first_member{};                ///< of each case
  const std::vector<EndLayer>* layers = nullptr;  ///< see QuantityState
};

/// States in richer spaces for error estimates, as in with_errors().
struct RicherCases {
  std::vector<SolvedCases> states{};
  std::string not_estimated{};  ///< why there are none; empty: errors are not needed
};

/// Values of the list "Quantities" at ends of stages: (stage, case, column).
using References = std::map<Stage, std::vector<std::vector<double>>>;

/// Values of one case at the end of its path.
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
  /// Name of the member if a value is a member index, such as NAME.member of an extreme; empty otherwise.
  std::string member_of(std::size_t name, double value) const;
  /// A value of the list "Quantities" that has a limit, independent of the output.
  struct Limit {
    std::string name;
    double largest_size;   ///< limit in the scene file
    std::size_t quantity;  ///< index in the list "Quantities"
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
  /// Whether any limit is relative to a state before the end.
  bool needs_path() const;
  /// Whether limits are relative to this state: the end of a stage, or the start.
  bool is_reference(double load_factor) const;
  /// Values of the list "Quantities" in the current state, as references of limits.
  std::vector<double> asked_of(const SolvedCases& solved, int part) const;
  /// The expected values of names(); empty for other outputs.
  const std::vector<ExpectedValue>& expected() const { return expected_; }

 private:
  void take_followed(const Application& app);
  void take_expected(const Application& app, const std::string& load_case);

  std::vector<std::string> names_, members_;
  QuantitySet quantities_;
  QuantitySet asked_;                       ///< the list "Quantities", if its values are needed
  std::vector<std::size_t> asked_columns_;  ///< column of each name in asked_; kNotAsked: the next value of quantities_
  std::vector<Limit> limits_;
  std::vector<std::vector<double>> own_limits_;
  std::vector<bool> is_limited_;  ///< (column of the list "Quantities")
  std::vector<ExpectedValue> expected_;
};

class CaseScenes {
 public:
  static constexpr std::size_t kMostKept = 20'000;  ///< members, at one to two kilobytes with their points and loads

  /// Finds the parameters of the columns. Throws InputError with the place of the column and the nearest name.
  /// Application and batch must outlive this object; every case changes the application's parameters.
  CaseScenes(Application& app, Batch& batch, std::string load_case);

  /// Returns the scene of a case; caches those with mode imperfections, which are expensive. Throws InputError with the
  /// place of the case for values that the scene does not permit.
  Scene scene_of(std::size_t index);
  /// Stores a scene for the next call of scene_of(), up to a limit of memory.
  void keep(std::size_t index, Scene scene);

  /// An expected value that differs between cases; its name in the list "Expected".
  struct OwnExpectation {
    std::size_t column;  ///< kOfFormula: no column: a formula of variables
    std::string name;
  };
  static constexpr std::size_t kOfFormula = ~std::size_t{0};
  const std::vector<OwnExpectation>& own_expectations() const { return own_expectations_; }
  double expected(const OwnExpectation& own, std::size_t index) const;
  /// Limits (case, quantity) of the cases read so far, 0: none; empty: all cases have those of the file.
  const std::vector<std::vector<double>>& limits() const { return limits_; }

 private:
  /// A number in the parsed file.
  struct Place {
    Teuchos::ParameterEntry* entry = nullptr;
    int component = -1;  ///< of an array
  };
  /// A number outside the list "Scene" that depends on variables.
  struct OuterFormula {
    ParameterPath path;
    const Teuchos::ParameterEntry* entry;
    ParameterValue of_file;
    std::vector<double> values{};  ///< of each case
  };
  void find_formulas();
  void evaluate_cells(Batch& batch) const;
  void evaluate_formulas(std::size_t index);
  Place find(const BatchColumn& column, std::size_t index);
  Place find_in(Teuchos::ParameterList& list, const std::vector<std::string>& path, int component,
                const BatchColumn& column) const;
  void set(const Place& place, double value, std::size_t index, const BatchColumn& column) const;

  Application& app_;
  const Batch& batch_;
  std::string load_case_;
  std::vector<Place> places_;  ///< place of each column; no entry: an expected value
  std::vector<OwnExpectation> own_expectations_;
  std::vector<OuterFormula> formulas_;
  std::vector<std::vector<double>> limits_;
  std::map<std::size_t, Scene> kept_;
  std::map<std::size_t, Scene> imperfect_;  ///< on the mesh of their solution
};

}  // namespace mixbeam
