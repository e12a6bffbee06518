#include "discretization/results/disk_file.hpp"

#include "discretization/text/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

namespace mixbeam {

namespace {

[[noreturn]] void fail_on_disk(const std::string& action, int error = errno) {
  throw DiskError("cannot " + action + ": " + std::strerror(error));
}

/// Whether bytes beside those written may change. A client of NFS may write whole pages of its cache if a program wrote
/// a part, and so undo what another machine wrote beside it. For files written synchronously it sends only the bytes
/// that were written (Linux, nfs_can_extend_write).
bool may_write_neighbours(int descriptor) {
  constexpr long kNfs = 0x6969;  // NFS_SUPER_MAGIC, statfs(2)
  struct statfs system {};
  return ::fstatfs(descriptor, &system) == 0 && static_cast<long>(system.f_type) == kNfs;
}

int opened(const std::filesystem::path& path, DiskAccess access, bool shared) {
  constexpr mode_t kAsTheUserWants = 0666;  // less the user's mask
  int mode = (access == DiskAccess::read ? O_RDONLY : O_RDWR | O_NOFOLLOW) | O_CLOEXEC;
  if (access == DiskAccess::create) {
    mode |= O_CREAT | O_EXCL;
    require_no_input(path.string());
    ::unlink(path.c_str());  // left by a killed run, or a link put there by somebody
  }
  const std::string action = access == DiskAccess::create ? "create the file" : "open the file";
  const int descriptor = ::open(path.c_str(), mode, kAsTheUserWants);
  if (descriptor < 0) fail_on_disk(action);
  if (access == DiskAccess::read || !shared || !may_write_neighbours(descriptor)) return descriptor;
  ::close(descriptor);
  const int synchronous = ::open(path.c_str(), (mode & ~(O_CREAT | O_EXCL)) | O_DSYNC, kAsTheUserWants);
  if (synchronous < 0) fail_on_disk(action);
  return synchronous;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// Some file systems cannot sync folders, or need not.
bool is_unknown_to_the_system(int error) { return error == EINVAL || error == ENOTSUP || error == ENOSYS; }

/// Turns any error of an action into a FileError that names the file.
template <class Action>
auto naming(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const DiskError& error) {
    throw FileError("file " + path.string() + ": " + error.what());
  }
}

}  // namespace

std::filesystem::path hidden(const std::filesystem::path& path, const std::string& ending) {
  return path.parent_path() / ("." + path.filename().string() + "." + ending);
}

FileNumber file_number(const std::filesystem::path& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) return {};
  return {static_cast<std::uint64_t>(facts.st_dev), static_cast<std::uint64_t>(facts.st_ino)};
}

DiskFile::DiskFile(const std::filesystem::path& path, DiskAccess access, bool shared)
    : descriptor_(opened(path, access, shared)) {}

DiskFile::DiskFile(DiskFile&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

DiskFile::~DiskFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void DiskFile::write(std::uint64_t offset, const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::pwrite(descriptor_, from, count, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_on_disk("write the file");
    if (written == 0) fail_on_disk("write the file", EIO);  // would loop for ever
    from += written;
    offset += static_cast<std::uint64_t>(written);
    count -= static_cast<std::size_t>(written);
  }
}

void DiskFile::read(std::uint64_t offset, void* bytes, std::size_t count) const {
  char* to = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, to, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_on_disk("read the file");
    if (got == 0) throw DiskError("cannot read the file: it ends too early");
    to += got;
    offset += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

std::uint64_t DiskFile::size() const {
  struct stat facts {};
  if (::fstat(descriptor_, &facts) != 0) fail_on_disk("read the size of the file");
  return static_cast<std::uint64_t>(facts.st_size);
}

void DiskFile::resize(std::uint64_t bytes) {
  while (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0)
    if (errno != EINTR) fail_on_disk("write the file");
}

void DiskFile::reserve(std::uint64_t bytes) {
  const std::uint64_t there = size();
  if (bytes <= there) return;
  int error = EINTR;
  while (error == EINTR)
    error = ::posix_fallocate(descriptor_, static_cast<off_t>(there), static_cast<off_t>(bytes - there));
  if (error != 0 && !is_unknown_to_the_system(error)) fail_on_disk("get disk space", error);
}

void DiskFile::sync() {
  while (::fdatasync(descriptor_) != 0) {
    if (is_unknown_to_the_system(errno)) return;
    if (errno != EINTR) fail_on_disk("write the file");
  }
}

void DiskFile::close() {
  // Linux closes the file even where a signal interrupts; it must not be closed twice.
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail_on_disk("complete the file");
}

void sync_folder_of(const std::filesystem::path& path) {
  const int descriptor = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // folders that one may write to but not read cannot be synced
  int error = 0;
  while (::fsync(descriptor) != 0 && (error = errno) == EINTR) error = 0;
  ::close(descriptor);
  if (error != 0 && !is_unknown_to_the_system(error)) fail_on_disk("write the folder", error);
}

Replacement::Replacement(std::filesystem::path path) : path_(std::move(path)), hidden_(hidden(path_, "new")) {
  require_no_input(path_.string());
  require_no_input(hidden_.string());
}

Replacement::~Replacement() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove(hidden_, ignored);
}

void Replacement::publish(bool durable) {
  if (durable) {
    DiskFile file(hidden_, DiskAccess::write);
    file.sync();
    file.close();
  }
  std::error_code error;
  std::filesystem::rename(hidden_, path_, error);
  if (error) throw DiskError("cannot be renamed to its final name: " + error.message());
  published_ = true;
  if (durable) sync_folder_of(path_);
}

void replace_file(const std::filesystem::path& path, const std::string& text, bool durable) {
  replace_file(
      path, [&](const TextSink& sink) { sink(text); }, durable);
}

void replace_file(const std::filesystem::path& path, const std::function<void(const TextSink&)>& write, bool durable) {
  naming(path, [&] {
    Replacement replacement(path);
    DiskFile file(replacement.hidden_path(), DiskAccess::create);
    std::uint64_t size = 0;
    write([&](const std::string& piece) {
      file.write(size, piece.data(), piece.size());
      size += piece.size();
    });
    file.close();
    replacement.publish(durable);
  });
}

TextFile::TextFile(const std::filesystem::path& path, Appears when)
    : path_(path),
      replacement_(std::make_unique<Replacement>(path)),
      file_(naming(path, [&] { return DiskFile(replacement_->hidden_path(), DiskAccess::create); })) {
  if (when == Appears::when_closed) return;
  const bool durable = false;
  naming(path, [&] { replacement_->publish(durable); });
  replacement_.reset();
}

void TextFile::append(const std::string& text) {
  naming(path_, [&] {
    try {
      file_.write(size_, text.data(), text.size());
      size_ += text.size();
    } catch (const DiskError&) {
      try {
        file_.resize(size_);
      } catch (const DiskError&) {  // the first reason is reported
      }
      throw;
    }
  });
}

void TextFile::close() {
  naming(path_, [&] {
    file_.sync();
    file_.close();
    const bool durable = true;
    if (replacement_) replacement_->publish(durable);
  });
}

}  // namespace mixbeam
