#include "discretization/text/text_file.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <libxml/xmlstring.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <utility>

#include <sys/stat.h>

namespace mixbeam {
namespace {

constexpr std::size_t kMaximumBytes = std::size_t{256} << 20U;

using FileKey = std::pair<dev_t, ino_t>;

/// Device and inode; zeros if there is no such file.
FileKey key_of(const std::string& path) {
  struct stat facts {};
  return ::stat(path.c_str(), &facts) == 0 ? FileKey{facts.st_dev, facts.st_ino} : FileKey{};
}

/// Files read so far. A host of the library may read any number, on several threads.
struct Inputs {
  std::mutex mutex;
  std::map<FileKey, std::string> names;  ///< absolute: the working directory may change
};
Inputs& inputs() {
  static Inputs all;
  return all;
}

void remember_input(const std::string& path) {
  const std::string name = std::filesystem::absolute(path).lexically_normal().string();
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  inputs().names[key_of(path)] = name;
}

/// Refuses unprintable file names: results and their pages carry the name of the scene.
void require_text(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  const bool has_control = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127; });
  if (has_control || xmlCheckUTF8(reinterpret_cast<const xmlChar*>(name.c_str())) == 0)
    throw InputError("\"" + excerpt(path) +
                     "\": the name of this file; allowed: text in UTF-8 without control characters");
}

}  // namespace

std::string text_of_file(const std::string& path, const std::string& kind) {
  std::error_code unreadable;
  const auto status = std::filesystem::status(path, unreadable);
  if (!std::filesystem::exists(status)) throw InputError(path + ": no such file");
  if (std::filesystem::is_directory(status)) throw InputError(path + ": is a directory; allowed: " + kind);
  if (!std::filesystem::is_regular_file(status))
    throw InputError(path + ": is a pipe or a device, not a file; allowed: " + kind);
  require_text(path);
  remember_input(path);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  std::string text;
  for (char block[1U << 16U]; stream.read(block, sizeof block), stream.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaximumBytes)
      throw InputError(path + ": larger than " + std::to_string(kMaximumBytes >> 20U) + " MiB");
  }
  // A stream does not throw if the disk fails in the middle: the rest would be missing silently.
  if (stream.bad()) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  return text;
}

void require_no_input(const std::string& output) {
  std::error_code unreadable;
  const auto status = std::filesystem::status(output, unreadable);
  if (!std::filesystem::exists(status)) return;
  if (!std::filesystem::is_regular_file(status))
    throw InputError(output + ": cannot be written: it is a " +
                     (std::filesystem::is_directory(status) ? "directory" : "pipe or a device"));
  const FileKey key = key_of(output);
  const std::lock_guard<std::mutex> lock(inputs().mutex);
  const auto found = inputs().names.find(key);
  if (found != inputs().names.end() && key_of(found->second) == key)  // otherwise deleted, its inode reused
    throw InputError(output + ": cannot be written: it is the input " + found->second +
                     "; allowed: another name or folder of results");
}

}  // namespace mixbeam
