#include "discretization/parameters/source.hpp"

#include "discretization/text/message_text.hpp"

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

ParameterSource::ParameterSource(std::string file, std::string root_name)
    : file_(std::move(file)), root_name_(std::move(root_name)) {}

void ParameterSource::record(const ParameterPath& path, int line) { lines_[key(path)] = line; }

int ParameterSource::line(const ParameterPath& path) const {
  const auto found = lines_.find(key(path));
  return found == lines_.end() ? 0 : found->second;
}

std::string ParameterSource::where(const ParameterPath& path) const {
  if (file_.empty()) return "(parameters set by the program)";
  for (ParameterPath enclosing = path;; enclosing.pop_back()) {
    if (const int found = line(enclosing)) return file_ + ":" + std::to_string(found);
    if (enclosing.empty()) return file_;
  }
}

std::string ParameterSource::message(const ParameterPath& path, const std::string& remark) const {
  const std::string name = path.empty() ? excerpt(root_name_) : to_string(path);
  return where(path) + ": XML path \"" + name + "\": " + remark;
}

InputError ParameterSource::error(const ParameterPath& path, const std::string& problem) const {
  return InputError{message(path, problem)};
}

}  // namespace mixbeam
