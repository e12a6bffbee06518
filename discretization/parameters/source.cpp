#include "discretization/parameters/source.hpp"

#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace mixbeam {
namespace {

constexpr char kSeparator = '\x1f';  // cannot occur in XML 1.0, so joined names stay distinct

std::string key(const ParameterPath& path) {
  std::size_t size = path.size();
  for (const std::string& name : path) size += name.size();
  std::string joined;
  joined.reserve(size);
  for (const std::string& name : path) (joined += name) += kSeparator;
  return joined;
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Offset of the value of the attribute "value" or "name" in the tag that begins at `tag`; `tag` if there is none.
std::size_t offset_of_attribute(const std::string& text, std::size_t tag, bool of_value) {
  const std::size_t end = text.find('>', tag);
  for (const std::string quote : {"\"", "'"}) {
    const std::string attribute = (of_value ? "value=" : "name=") + quote;
    const std::size_t found = text.find(attribute, tag);
    if (found < end) return found + attribute.size();
  }
  return tag;
}

/// Offset of a key in YAML, or of its value if that is in the same line.
std::size_t offset_of_entry(const std::string& text, std::size_t key_begin, bool of_value) {
  if (!of_value || key_begin >= text.size()) return key_begin;
  const char quote = text[key_begin];
  const bool is_quoted = quote == '"' || quote == '\'';
  std::size_t at = is_quoted ? text.find(quote, key_begin + 1) : key_begin;
  at = std::min(text.find(':', at), text.size() - 1) + 1;
  while (at < text.size() && is_blank(text[at])) ++at;
  return at < text.size() && text[at] != '\n' ? at : key_begin;
}

/// `s and x`
std::string listed(const std::vector<std::string>& variables) {
  if (variables.empty()) return "numbers";
  std::string text;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (i > 0) text += i + 1 == variables.size() ? " and " : ", ";
    text += variables[i];
  }
  return text;
}

}  // namespace

std::string to_string(const ParameterPath& path) {
  std::string text;
  for (const std::string& name : path) text += (text.empty() ? "" : " / ") + excerpt(name);
  return text;
}

ParameterPath child(ParameterPath path, const std::string& name) {
  path.push_back(name);
  return path;
}

std::string name_of_file(const std::string& file) { return std::filesystem::path(file).stem().string(); }

ParameterSource::ParameterSource(std::string file, std::string root_name)
    : file_(std::move(file)), root_name_(std::move(root_name)) {}

void ParameterSource::record(const ParameterPath& path, int line, int column) {
  const auto [earlier, is_first] = positions_.try_emplace(key(path), Position{line, column});
  if (is_first) return;
  const std::string problem = "given twice in this list, in line " + std::to_string(earlier->second.line) +
                              " and again in line " + std::to_string(line);
  earlier->second = {line, column};
  throw error(path, problem);
}

void ParameterSource::record(const ParameterPath& path, const std::string& where) { elsewhere_[key(path)] = where; }

ParameterSource::Position ParameterSource::position(const ParameterPath& path) const {
  const auto found = positions_.find(key(path));
  return found == positions_.end() ? Position{} : found->second;
}

int ParameterSource::line(const ParameterPath& path) const { return position(path).line; }

ParameterSource::Position ParameterSource::position_around(std::string place) const {
  for (; !place.empty(); place.resize(place.find_last_of(kSeparator, place.size() - 2) + 1)) {
    const auto found = positions_.find(place);
    if (found != positions_.end()) return found->second;
    if (place.find(kSeparator) == std::string::npos) break;  // in a table: sorted behind those of the file
  }
  return place.empty() ? Position{} : Position{std::numeric_limits<int>::max(), 0};
}

std::string ParameterSource::text_of(const Position& position) const {
  const std::string line = file_ + ":" + std::to_string(position.line);
  return language_ == InputLanguage::yaml ? line + ":" + std::to_string(position.column) : line;
}

std::string ParameterSource::word(const std::array<const char*, 3>& by_language) const {
  return by_language[static_cast<std::size_t>(language_)];
}

std::string ParameterSource::where(const ParameterPath& path) const {
  if (file_.empty()) return "(parameters set by the program)";
  for (ParameterPath enclosing = path;; enclosing.pop_back()) {
    if (const auto other = elsewhere_.find(key(enclosing)); other != elsewhere_.end()) return other->second;
    const Position found = position(enclosing);
    if (found.line > 0 && language_ != InputLanguage::python) return text_of(found);
    if (enclosing.empty()) return language_ == InputLanguage::python ? "scene " + root_name_ : file_;
  }
}

/// Marked line of `loads.csv:12:7`, a place in a table whose text is among the files that the input names.
std::string ParameterSource::marked_in_table(const std::string& place) const {
  const std::size_t last = place.rfind(':'), before = place.rfind(':', last - 1);
  for (const auto& [name, text] : files_)
    if ((std::filesystem::path(file_).parent_path() / name).string() == place.substr(0, before))
      return marked_line(text, offset_of(text, std::stoi(place.substr(before + 1)), std::stoi(place.substr(last + 1))));
  return "";
}

std::string ParameterSource::marked(ParameterPath path, const std::string& problem) const {
  bool at_value = problem.rfind("value", 0) == 0 || problem.rfind("in an array", 0) == 0;
  for (;; path.pop_back(), at_value = false) {
    if (const auto other = elsewhere_.find(key(path)); other != elsewhere_.end()) return marked_in_table(other->second);
    const Position found = position(path);
    if (found.line > 0 && language_ == InputLanguage::xml && !text_.empty())
      return marked_line(text_, offset_of_attribute(text_, static_cast<std::size_t>(found.column), at_value));
    if (found.line > 0 && language_ == InputLanguage::yaml && !text_.empty())
      return marked_line(text_, offset_of_entry(text_, offset_of(text_, found.line, found.column), at_value));
    if (path.empty()) return "";
  }
}

void ParameterSource::keep(const InputError& mistake, const ParameterPath& path) const {
  if (std::string(mistake.what()).empty()) return;  // thrown by require_mended()
  const std::string place = mistake.place().empty() ? key(path) : mistake.place();
  const auto covers = [&](const Kept::Mistake& earlier) {
    const std::string& other = earlier.error.place();
    const std::size_t common = std::min(place.size(), other.size());
    return common > 0 && place.compare(0, common, other, 0, common) == 0;
  };
  if (std::any_of(kept_->mistakes.begin(), kept_->mistakes.end(), covers)) return;
  kept_->mistakes.push_back({InputError(mistake.what(), place), position_around(place)});
}

bool ParameterSource::has_mistake(const ParameterPath& path) const {
  return std::any_of(kept_->mistakes.begin(), kept_->mistakes.end(), [place = key(path)](const Kept::Mistake& mistake) {
    return mistake.error.place().rfind(place, 0) == 0;
  });
}

void ParameterSource::throw_kept() const {
  constexpr std::size_t kMostTold = 20;
  if (kept_->depth > 1 || !has_mistakes()) return;
  const bool was_full = is_full();
  std::vector<Kept::Mistake> mistakes = std::exchange(kept_->mistakes, {});
  kept_->is_mended = true;
  if (mistakes.size() == 1) throw InputError(mistakes.front().error);
  std::stable_sort(mistakes.begin(), mistakes.end(), [](const Kept::Mistake& a, const Kept::Mistake& b) {
    return std::tie(a.position.line, a.position.column) < std::tie(b.position.line, b.position.column);
  });
  std::string text = std::to_string(mistakes.size()) + (was_full ? " or more" : "") + " mistakes:";
  for (std::size_t i = 0; i < std::min(mistakes.size(), kMostTold); ++i)
    text += std::string("\n") + mistakes[i].error.what();
  if (mistakes.size() > kMostTold)
    text += "\nand " + (was_full ? "others" : std::to_string(mistakes.size() - kMostTold) + " more");
  throw InputError(text);
}

std::string ParameterSource::message(const ParameterPath& path, const std::string& remark) const {
  const std::string name = path.empty() ? excerpt(root_name_) : to_string(path);
  return where(path) + ": " + word({"XML path \"", "YAML path \"", "\""}) + name + "\": " + remark;
}

InputError ParameterSource::error(const ParameterPath& path, const std::string& problem) const {
  return InputError(message(path, problem) + marked(path, problem), key(path));
}

Expression checked_formula(const std::string& text, const std::vector<std::string>& variables,
                           const InputPlace& place) {
  try {
    return Expression(text, variables);
  } catch (const std::invalid_argument& error) {
    throw place.error("value \"" + excerpt(text) + "\" is no formula: " + excerpt(error.what()) +
                      "; allowed: a formula of " + listed(variables) +
                      " with + - * / ^ ( ), pi, e, sin, cos, tan, exp, ln, sqrt, abs, min, max, ...");
  }
}

void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const InputPlace& place) {
  for (const std::vector<double>& sample : samples) {
    const double value = formula(sample);
    if (std::isfinite(value)) continue;
    std::string at;
    for (std::size_t i = 0; i < variables.size(); ++i)
      at += (i == 0 ? "" : ", ") + variables[i] + " = " + shortest(sample[i]);
    throw place.error("value \"" + excerpt(formula.text()) + "\" is " + shortest(value) + " at " + at +
                      "; allowed: a formula that is finite everywhere");
  }
}

}  // namespace mixbeam
