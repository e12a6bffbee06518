#include "apps/common/studies/study.hpp"

#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/formatted.hpp"
#include "mixbeam/version.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <ostream>
#include <sstream>
#include <thread>

namespace mixbeam {

namespace {

constexpr std::size_t kLeastWidth = 10, kNameWidth = 20;  ///< of a column, of the first column

/// A number with four digits, right-aligned; other text left-aligned, without quotes.
std::string shown_text(std::string text, std::size_t width) {
  text.erase(std::remove(text.begin(), text.end(), '"'), text.end());
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const int columns = static_cast<int>(width);
  const bool is_number = !text.empty() && *end == '\0';
  return is_number ? formatted("%*.4g", columns, number) : formatted("%-*s", columns, text.c_str());
}

/// The processor as Linux names it; "unknown" elsewhere.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// Year-month-day, UTC.
std::string today() {
  const std::time_t now = std::time(nullptr);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", std::gmtime(&now));
  return text.data();
}

}  // namespace

int run_study(int argc, char** argv, const std::string& name, const std::string& purpose, const ListSpec& study,
              const std::function<void(Application&)>& run) {
  ApplicationDefinition definition;
  definition.name = name;
  definition.purpose = purpose;
  definition.study = study;
  definition.run_study = run;
  return run_application(argc, argv, definition);
}

ParameterSpec count(const std::string& name, int by_default, double most, const std::string& meaning, int least) {
  return integer(name).at_least(least).at_most(most).by_default(by_default).means(meaning);
}

ParameterSpec counts(const std::string& name, const std::vector<int>& by_default, double most,
                     const std::string& meaning, int least) {
  const ParameterSpec numbers = array(name, ParameterType::integer_array).at_least(least).at_most(most);
  return numbers.by_default(Teuchos::Array<int>(by_default)).means(meaning);
}

ParameterSpec sizes(const std::string& name, const std::vector<double>& by_default, double most,
                    const std::string& meaning) {
  const ParameterSpec numbers = array(name, ParameterType::real_array).above(0.0).at_most(most);
  return numbers.by_default(Teuchos::Array<double>(by_default)).means(meaning);
}

std::vector<std::string> words(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) all.push_back(word);
  return all;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

StudyTable::StudyTable(const Application& app, const std::string& file, const std::vector<std::string>& columns,
                       std::size_t shown)
    : out_(app.out()) {
  if (app.writes_files() && !file.empty()) csv_.emplace(app.output / file, columns);
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

ComparedValue compared(Application& app, const std::string& name, double own, const std::string& printed,
                       const std::string& source) {
  if (printed.empty()) return {"", own, Agreement::informative};
  const bool agrees = app.summary.check_printed_digits(name, own, printed, source);
  return {printed, own, agrees ? Agreement::agrees : Agreement::differs};
}

std::array<std::string, 3> PaperTable::row(int order, int elements) const {
  for (const Row& one : rows) {
    if (one.order != order || one.elements != elements) continue;
    std::array<std::string, 3> texts = one.printed;
    for (std::string& number : texts)
      if (figures > 0) number = rounded_to_figures(number, figures);
    return texts;
  }
  return {};
}

std::vector<ComparedValue> compared(Application& app, const std::string& before, const std::string& after,
                                    const Vector3& own, const std::array<std::string, 3>& printed,
                                    const std::string& source) {
  std::vector<ComparedValue> values;
  for (std::size_t i = 0; i < own.size(); ++i)
    values.push_back(compared(app, before + std::to_string(i + 1) + after, own[i], printed[i], source));
  return values;
}

void require_point(const Application& app, const std::string& name) {
  for (const Point& point : app.scene.points)
    if (point.name == name) return;
  throw app.xml.source.error(
      {"Scene", "Points"}, "no point \"" + name + "\"; the study reports its displacement (--single takes any scene)");
}

Simulation solve_in_steps(Application& app, const Scene& scene, int steps, const RunObserver& observer) {
  return app.solve(scene, with_fixed_steps(app.solver, steps), "", observer);
}

void write_machine(const Application& app, const std::vector<std::pair<std::string, std::string>>& more) {
  StudyTable machine(app, "machine.csv", {"name", "value"}, 2);
  const std::vector<std::pair<std::string, std::string>> facts = {
      {"processor", processor_name()},
      {"cores", std::to_string(std::thread::hardware_concurrency())},
      {"version", kVersion},
      {"compiler", kCompiler},
      {"date", today()},
      {"flags", kFlags}};
  for (const auto& pairs : {facts, more})
    for (const auto& [name, value] : pairs) machine.add_row({name, value});
}

}  // namespace mixbeam
