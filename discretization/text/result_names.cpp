#include "discretization/text/result_names.hpp"

#include "discretization/text/message_text.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

// File systems allow names of 255 bytes, shared with the scene's own name and endings like "-monitor.csv".
constexpr std::size_t kLongestPartOfFileName = 100;

}  // namespace

bool is_own_time_series(const std::string& name) {
  return std::find(kOwnTimeSeries.begin(), kOwnTimeSeries.end(), name) != kOwnTimeSeries.end();
}

Problem result_name_problem(const std::string& name) {
  const bool is_folder = name.empty() || name == "." || name == "..";
  if (!is_folder && name.find('/') == std::string::npos) return "";
  return "\"" + excerpt(name) +
         R"(" cannot name an entry of the result file; allowed: names without "/", but not "",)" + R"( ".", "..")";
}

Problem file_name_problem(const std::string& name) {
  if (Problem problem = result_name_problem(name); !problem.empty()) return problem;
  const bool has_control = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127; });
  if (!has_control && name.size() <= kLongestPartOfFileName) return "";
  return "\"" + excerpt(name) + "\" cannot be part of the name of a file; allowed: up to " +
         std::to_string(kLongestPartOfFileName) + " bytes without control characters";
}

}  // namespace mixbeam
