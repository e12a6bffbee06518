#include "apps/common/tables/convergence_table.hpp"

#include "apps/common/tables/formatted.hpp"

#include <cmath>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace mixbeam {

std::optional<double> observed_rate(const std::vector<int>& elements, const std::vector<double>& errors,
                                    double round_off) {
  std::size_t above = 0;
  while (above < errors.size() && errors[above] > round_off) ++above;
  if (above < 2) return {};
  const std::size_t fine = above - 1, coarse = above - 2;
  return std::log(errors[coarse] / errors[fine]) / std::log(static_cast<double>(elements[fine]) / elements[coarse]);
}

ConvergenceTable::ConvergenceTable(std::string title, std::vector<int> elements, double round_off)
    : title_(std::move(title)), elements_(std::move(elements)), round_off_(round_off) {}

void ConvergenceTable::add_group(const std::string& heading) { rows_.push_back({heading, 0, {}, {}}); }

std::optional<double> ConvergenceTable::add_row(int order, const std::vector<double>& errors) {
  if (errors.size() != elements_.size())
    throw std::invalid_argument("a row of the table '" + title_ + "' has the wrong number of errors");
  rows_.push_back({"", order, errors, observed_rate(elements_, errors, round_off_)});
  return rows_.back().rate;
}

void ConvergenceTable::print(std::ostream& stream) const {
  stream << title_ << "\n  k";
  for (int n : elements_) stream << formatted("%8d el", n);
  stream << "   rate\n";
  for (const Row& row : rows_) {
    stream << "  ";
    if (!row.heading.empty()) {
      stream << row.heading << "\n";
      continue;
    }
    stream << row.order;
    for (double error : row.errors) stream << formatted("%11.2e", error);
    stream << (row.rate ? formatted("%7.2f", *row.rate) : "      -") << "\n";
  }
  stream << "  rate: of the two finest meshes before the error falls below " << formatted("%.0e", round_off_) << "\n";
}

}  // namespace mixbeam
