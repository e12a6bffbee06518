#include "discretization/results/slab_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/vfs.h>
#include <unistd.h>

namespace mixbeam {

namespace {

[[noreturn]] void fail(const std::string& action) { throw SlabError("cannot " + action + ": " + std::strerror(errno)); }

/// A client of NFS may write whole pages of its cache where a program wrote a part, and so undo what another machine
/// wrote beside it. Of files that are written synchronously it sends the bytes that were written and no others (Linux,
/// nfs_can_extend_write).
bool may_write_neighbours(int descriptor) {
  constexpr long kNfs = 0x6969;  // NFS_SUPER_MAGIC, statfs(2)
  struct statfs system {};
  return ::fstatfs(descriptor, &system) == 0 && static_cast<long>(system.f_type) == kNfs;
}

int opened(const std::filesystem::path& path, SlabAccess access, bool shared) {
  const int mode = access == SlabAccess::read ? O_RDONLY : O_WRONLY;
  const int descriptor = ::open(path.c_str(), mode | O_CLOEXEC);
  if (descriptor < 0) fail("open the file");
  if (access == SlabAccess::read || !shared || !may_write_neighbours(descriptor)) return descriptor;
  ::close(descriptor);
  const int synchronous = ::open(path.c_str(), mode | O_CLOEXEC | O_DSYNC);
  if (synchronous < 0) fail("open the file");
  return synchronous;
}

}  // namespace

SlabFile::SlabFile(const std::filesystem::path& path, SlabAccess access, bool shared)
    : descriptor_(opened(path, access, shared)), buffer_(new std::byte[kSlabBytes]) {}

SlabFile::~SlabFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SlabFile::write(std::uint64_t offset, const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::pwrite(descriptor_, from, count, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write the file");
    from += written;
    offset += static_cast<std::uint64_t>(written);
    count -= static_cast<std::size_t>(written);
  }
}

void SlabFile::read(std::uint64_t offset, void* bytes, std::size_t count) {
  char* to = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, to, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("read the file");
    if (got == 0) throw SlabError("cannot read the file: it ends too early");
    to += got;
    offset += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

void SlabFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("complete the file");
}

}  // namespace mixbeam
