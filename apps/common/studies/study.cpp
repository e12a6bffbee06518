#include "apps/common/studies/study.hpp"

#include "apps/common/session/machine_facts.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

constexpr std::size_t kLeastWidth = 10, kNameWidth = 20;  ///< of a column; of the first one

/// A number with four digits, right-aligned; a text as it is, without quotes.
std::string shown_text(std::string text, std::size_t width) {
  text.erase(std::remove(text.begin(), text.end(), '"'), text.end());
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  char line[200];
  if (!text.empty() && *end == '\0')
    std::snprintf(line, sizeof line, "%*.4g", static_cast<int>(width), number);
  else
    std::snprintf(line, sizeof line, "%-*s", static_cast<int>(width), text.c_str());
  return line;
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

StudyTable::StudyTable(const Application& app, const std::string& file, const std::vector<std::string>& columns,
                       std::size_t shown)
    : out_(app.out()) {
  if (app.writes_files()) csv_.emplace(app.output / file, columns);
  for (std::size_t i = 0; i < shown; ++i) {
    widths_.push_back(std::max(i == 0 ? kNameWidth : kLeastWidth, columns[i].size()));
    out_ << (i == 0 ? "\n" : "  ") << columns[i] << std::string(widths_[i] - columns[i].size(), ' ');
  }
  if (shown > 0) out_ << "\n";
}

void StudyTable::add_row(const std::vector<CsvCell>& cells) {
  if (csv_) csv_->add_row(cells);
  for (std::size_t i = 0; i < widths_.size(); ++i)
    out_ << (i == 0 ? "" : "  ") << shown_text(cells[i].text, widths_[i]);
  if (!widths_.empty()) out_ << std::endl;
}

void write_machine(const Application& app, const std::vector<std::pair<std::string, std::string>>& more) {
  StudyTable machine(app, "machine.csv", {"name", "value"}, 2);
  for (const auto& facts : {machine_facts(), more})
    for (const auto& [name, value] : facts) machine.add_row({name, value});
}

}  // namespace mixbeam
