/// The cases of a batch: the list "Batch" that says them, what is written of each, and their scenes.
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
  followed,   ///< motion of the points that are held or loaded, reactions of supports
  expected,   ///< the quantities of the list "Expected"
  quantities  ///< those of the list "Quantities"
};

/// A parameter that differs from case to case.
struct BatchColumn {
  std::string parameter;       ///< its path: "Point Loads/tip/Force[1]"
  Variables::Refusal refusal;  ///< at the place where the user named it
};

/// The cases, numbered from 1 for the user.
struct Batch {
  std::vector<BatchColumn> columns{};
  std::vector<double> values{};  ///< (case, column); NaN: an empty cell of the table, or a formula
  struct Formula {
    std::size_t index, column;  ///< of its case
    std::string text;           ///< "=2*L"
    Variables::Refusal refusal;
  };
  std::vector<Formula> formulas{};  ///< cells that CaseScenes gives values to, in the order of the table
  std::string table{};              ///< its path; of a grid: empty
  std::vector<int> lines{};         ///< of the table, of each case
  BatchOutput output = BatchOutput::followed;
  std::size_t before = 0;    ///< cases of the table or grid before these
  std::size_t unvaried = 0;  ///< cases of the scene as it stands, where there are no columns

  std::size_t size() const { return columns.empty() ? unvaried : values.size() / columns.size(); }
  double value(std::size_t index, std::size_t column) const { return values[index * columns.size() + column]; }
  /// Leaves out all cases but `count` from `first` on, which keep their numbers.
  void keep(std::size_t first, std::size_t count);
  /// "sweep.csv:3: case 2", "case 2".
  std::string name_of_case(std::size_t index) const;
};

/// Declaration of the list "Batch".
ListSpec batch_spec();

/// Reads the validated list, and the table that it names relative to the folder of the scene. Throws InputError.
Batch read_batch(const Teuchos::ParameterList& list, const ParameterSource& source);

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

class CaseScenes {
 public:
  static constexpr std::size_t kMostKept = 20'000;  ///< members: a kilobyte or two each, with their points and loads

  /// Finds the parameters that the columns name. Throws InputError, with the place of the column and the nearest name.
  /// Application and batch must outlive this object; the parameters of the application change with every case.
  CaseScenes(Application& app, Batch& batch, std::string load_case);

  /// Keeps those with imperfections by modes, which take time to find. Throws InputError, with the place of the case,
  /// for values that the scene does not permit.
  Scene scene_of(std::size_t index);
  /// Keeps a scene of scene_of() for its next call, which reads nothing then; keeps none beyond a limit of memory.
  void keep(std::size_t index, Scene scene);

  /// The expected value that a case has of its own, by the name in the list "Expected".
  struct OwnExpectation {
    std::size_t column;  ///< kOfFormula: none has it, its formula follows from variables
    std::string name;
  };
  static constexpr std::size_t kOfFormula = ~std::size_t{0};
  const std::vector<OwnExpectation>& own_expectations() const { return own_expectations_; }
  double expected(const OwnExpectation& own, std::size_t index) const;
  /// Of each case that was read, the limit of each quantity (0: none); empty: all have those of the file.
  const std::vector<std::vector<double>>& limits() const { return limits_; }

 private:
  /// A number in the parsed file.
  struct Place {
    Teuchos::ParameterEntry* entry = nullptr;
    int component = -1;  ///< of an array
  };
  /// A number outside of the list "Scene" that follows from variables.
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
  std::vector<Place> places_;  ///< of each column; without an entry: an expected value
  std::vector<OwnExpectation> own_expectations_;
  std::vector<OuterFormula> formulas_;
  std::vector<std::vector<double>> limits_;
  std::map<std::size_t, Scene> kept_;
  std::map<std::size_t, Scene> imperfect_;  ///< on the mesh that they are solved on
};

}  // namespace mixbeam
