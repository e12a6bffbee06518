#include "apps/common/tables/table_printer.hpp"

#include "apps/common/tables/formatted.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace mixbeam {
namespace {

constexpr std::size_t kColumnsPerQuantity = 3;  // paper, mixbeam, difference
constexpr std::size_t kGapInQuantity = 2;
constexpr std::size_t kGapBeforeQuantity = 4;
constexpr int kOwnDigits = 10;  // of a value without a reference

std::string own_text(const ComparedValue& value) {
  if (value.paper.empty()) return std::isnan(value.own) ? "nan" : formatted("%.*g", kOwnDigits, value.own);
  return in_style_of(value.own, value.paper);
}

std::string difference_text(const ComparedValue& value) {
  if (value.paper.empty()) return "";
  const double difference = value.own - printed_value(value.paper);
  const char* mark = value.agreement == Agreement::differs ? " *" : "  ";
  return (difference == 0.0 ? "0" : std::isnan(difference) ? "nan" : formatted("%.1e", difference)) + mark;
}

std::string aligned(const std::string& text, std::size_t width) {
  return formatted("%*s", static_cast<int>(width), text.c_str());
}

std::string without_blanks_at_end(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

}  // namespace

TablePrinter::TablePrinter(std::string title, std::vector<std::string> labels, std::vector<std::string> quantities,
                           std::string reference)
    : title_(std::move(title)),
      labels_(std::move(labels)),
      quantities_(std::move(quantities)),
      reference_(std::move(reference)) {}

void TablePrinter::add_group(const std::string& heading) { rows_.push_back({heading, {}, false}); }

void TablePrinter::add_row(const std::vector<std::string>& labels, const std::vector<ComparedValue>& values) {
  if (labels.size() != labels_.size() || values.size() != quantities_.size()) {
    throw std::invalid_argument("a row of the table '" + title_ + "' has the wrong number of cells");
  }
  Row row{"", labels, false};
  for (const auto& value : values) {
    row.cells.push_back(value.paper.empty() ? "-" : value.paper);
    row.cells.push_back(own_text(value));
    row.cells.push_back(difference_text(value));
    row.differs = row.differs || value.agreement == Agreement::differs;
  }
  rows_.push_back(row);
}

std::vector<std::size_t> TablePrinter::column_widths() const {
  std::vector<std::string> heads = labels_;
  for (std::size_t i = 0; i < quantities_.size(); ++i)
    heads.insert(heads.end(), {reference_, "mixbeam", "difference  "});
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < heads.size(); ++column) {
    std::size_t width = heads[column].size();
    for (const auto& row : rows_) {
      if (row.heading.empty()) width = std::max(width, row.cells[column].size());
    }
    const bool starts_quantity = column >= labels_.size() && (column - labels_.size()) % kColumnsPerQuantity == 0;
    widths.push_back(width + (starts_quantity ? kGapBeforeQuantity : kGapInQuantity));
  }
  return widths;
}

void TablePrinter::print(std::ostream& stream) const {
  const auto widths = column_widths();
  const auto first_quantity = widths.begin() + static_cast<std::ptrdiff_t>(labels_.size());
  std::string names(std::accumulate(widths.begin(), first_quantity, std::size_t{0}), ' ');
  std::string heads;
  for (std::size_t i = 0; i < labels_.size(); ++i) heads += aligned(labels_[i], widths[i]);
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    const std::size_t column = labels_.size() + kColumnsPerQuantity * q;
    names += aligned(quantities_[q], widths[column] + widths[column + 1]);
    names += std::string(widths[column + 2], ' ');
    heads += aligned(reference_, widths[column]) + aligned("mixbeam", widths[column + 1]);
    heads += aligned("difference  ", widths[column + 2]);
  }
  stream << title_ << '\n' << without_blanks_at_end(names) << '\n' << without_blanks_at_end(heads) << '\n';
  for (const auto& row : rows_) {
    std::string line = row.heading.empty() ? "" : "  " + row.heading;
    for (std::size_t column = 0; column < row.cells.size(); ++column)
      line += aligned(row.cells[column], widths[column]);
    if (row.differs) line += "  <- differs";
    stream << without_blanks_at_end(line) << '\n';
  }
}

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
