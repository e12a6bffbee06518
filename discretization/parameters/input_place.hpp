/// A place in what a user wrote: a list or a parameter, which errors point to and formulas stand at.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/text/expression.hpp"

#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// The source must outlive it.
class InputPlace {
 public:
  InputPlace(const ParameterSource& source, ParameterPath path) : source_(&source), path_(std::move(path)) {}

  const ParameterSource& source() const { return *source_; }
  /// One level deeper.
  InputPlace operator[](const std::string& name) const { return {*source_, child(path_, name)}; }
  InputError error(const std::string& problem) const { return source_->error(path_, problem); }
  /// As that of the source. A mistake is not kept where the entry that stands here has one already: it may follow from
  /// that.
  template <class Action>
  bool attempt(const Action& action) const {
    if (source_->is_full()) return false;
    try {
      action();
      return true;
    } catch (const InputError& mistake) {
      if (!source_->has_mistake(path_)) source_->keep(mistake, path_);
      return false;
    }
  }

 private:
  const ParameterSource* source_;
  ParameterPath path_;
};

/// The formula that a parameter holds. Throws InputError for a text that is none, or that uses other names than
/// `variables`.
Expression checked_formula(const std::string& text, const std::vector<std::string>& variables, const InputPlace& place);

/// Throws InputError unless the formula has a finite value at each of the `samples` (one value per variable each). A
/// sample can miss a pole; it finds the slips that matter: a division by s at the start, a root of 1 - x that should
/// have been one of x - 1.
void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const InputPlace& place);

}  // namespace mixbeam
