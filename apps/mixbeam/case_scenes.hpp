/// The scenes of the cases of a batch: one scene with some of its numbers replaced.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/mixbeam/batch_parameters.hpp"

#include <map>

namespace mixbeam {

class CaseScenes {
 public:
  /// Finds the parameters that the columns name. Throws InputError, with the place of the column and the nearest name.
  /// Application and batch must outlive this object; the parameters of the application change with every case.
  CaseScenes(Application& app, Batch& batch, std::string load_case);

  /// Keeps those with imperfections by modes, which take time to find. Throws InputError, with the place of the case,
  /// for values that the scene does not permit.
  Scene scene_of(std::size_t index);

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
  std::map<std::size_t, Scene> imperfect_;  ///< on the mesh that they are solved on
};

}  // namespace mixbeam
