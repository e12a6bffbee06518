#include "apps/common/session/machine_facts.hpp"

#include "mixbeam/version.hpp"

#include <array>
#include <ctime>
#include <fstream>
#include <thread>

namespace mixbeam {

namespace {

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

std::vector<std::pair<std::string, std::string>> machine_facts() {
  return {{"processor", processor_name()},
          {"cores", std::to_string(std::thread::hardware_concurrency())},
          {"version", kVersion},
          {"compiler", kCompiler},
          {"date", today()},
          {"flags", kFlags}};
}

}  // namespace mixbeam
