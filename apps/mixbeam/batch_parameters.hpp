/// The list "Batch": which cases a batch consists of and what is written of each.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/reading/variables.hpp"

#include <Teuchos_ParameterList.hpp>

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

}  // namespace mixbeam
