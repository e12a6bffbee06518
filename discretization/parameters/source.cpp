#include "discretization/parameters/source.hpp"

#include "discretization/text/message_text.hpp"

#include <filesystem>
#include <utility>

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
  throw InputError(text_of({line, column}) + ": " + language_ + " path \"" + to_string(path) +
                   "\": given twice in this list, in line " + std::to_string(earlier->second.line) +
                   " and again in line " + std::to_string(line));
}

void ParameterSource::record(const ParameterPath& path, const std::string& where) { elsewhere_[key(path)] = where; }

ParameterSource::Position ParameterSource::position(const ParameterPath& path) const {
  const auto found = positions_.find(key(path));
  return found == positions_.end() ? Position{} : found->second;
}

int ParameterSource::line(const ParameterPath& path) const { return position(path).line; }

std::string ParameterSource::text_of(const Position& position) const {
  const std::string line = file_ + ":" + std::to_string(position.line);
  return position.column > 0 ? line + ":" + std::to_string(position.column) : line;
}

std::string ParameterSource::where(const ParameterPath& path) const {
  if (file_.empty()) return "(parameters set by the program)";
  for (ParameterPath enclosing = path;; enclosing.pop_back()) {
    if (const auto other = elsewhere_.find(key(enclosing)); other != elsewhere_.end()) return other->second;
    if (const Position found = position(enclosing); found.line > 0) return text_of(found);
    if (enclosing.empty()) return file_;
  }
}

std::string ParameterSource::message(const ParameterPath& path, const std::string& remark) const {
  const std::string name = path.empty() ? excerpt(root_name_) : to_string(path);
  return where(path) + ": " + language_ + " path \"" + name + "\": " + remark;
}

InputError ParameterSource::error(const ParameterPath& path, const std::string& problem) const {
  return InputError{message(path, problem)};
}

}  // namespace mixbeam
