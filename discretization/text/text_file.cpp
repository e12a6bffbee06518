#include "discretization/text/text_file.hpp"

#include "discretization/text/errors.hpp"

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace mixbeam {
namespace {

constexpr std::size_t kMaximumBytes = std::size_t{256} << 20U;

}  // namespace

std::string text_of_file(const std::string& path, const std::string& kind) {
  std::error_code unreadable;
  const auto status = std::filesystem::status(path, unreadable);
  if (!std::filesystem::exists(status)) throw InputError(path + ": no such file");
  if (std::filesystem::is_directory(status)) throw InputError(path + ": is a directory; allowed: " + kind);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  std::string text;
  for (char block[1U << 16U]; stream.read(block, sizeof block), stream.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaximumBytes)
      throw InputError(path + ": larger than " + std::to_string(kMaximumBytes >> 20U) + " MiB");
  }
  // A stream keeps quiet about a disk that fails in the middle: the rest would be missing without a word.
  if (stream.bad()) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  return text;
}

}  // namespace mixbeam
