#include "discretization/results/result_lock.hpp"

#include "discretization/results/disk_file.hpp"
#include "discretization/results/rank_agreement.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace mixbeam {

namespace {

bool is_without_locks(int error) {
  return error == ENOLCK || error == ENOTSUP || error == EOPNOTSUPP || error == ENOSYS || error == EINVAL;
}

/// Whether the locked file still has its name: the holder may have removed it between our opening and our locking it.
bool is_still_there(int descriptor, const std::filesystem::path& path) {
  struct stat mine {
  }, there{};
  return ::fstat(descriptor, &mine) == 0 && ::stat(path.c_str(), &there) == 0 && mine.st_ino == there.st_ino &&
         mine.st_dev == there.st_dev;
}

constexpr const char* kHolder = "process ";

/// Writes "process 123 on host", for messages only: a failure changes nothing.
void write_holder(int descriptor) {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '?';
  const std::string text = kHolder + std::to_string(::getpid()) + " on " + host.data();
  if (::ftruncate(descriptor, 0) == 0) [[maybe_unused]]
    const auto written = ::pwrite(descriptor, text.data(), text.size(), 0);
}

/// Reason why the file is not a lock of this program, and is left unchanged (it may be a second name of another file);
/// empty: it may be one.
std::string problem_with(int descriptor) {
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) return std::strerror(errno);
  if (!S_ISREG(facts.st_mode) || facts.st_nlink > 1) return "it is no file, or one with several names";
  std::array<char, 9> begin{};
  const bool is_lock =
      ::pread(descriptor, begin.data(), begin.size() - 1, 0) <= 0 || begin.data() == std::string(kHolder);
  return is_lock ? "" : "it is a file of another kind";
}

/// Name of the holder, which writes it a moment after it has taken the lock.
std::string holder(int descriptor) {
  constexpr int kTries = 100;
  constexpr useconds_t kMoment = 1000;  // microseconds
  std::array<char, 512> text{};
  for (int i = 0; i < kTries; ++i, ::usleep(kMoment))
    if (::pread(descriptor, text.data(), text.size() - 1, 0) > 0) return text.data();
  return "another process";
}

}  // namespace

ResultLock::ResultLock(const std::filesystem::path& file) : path_(hidden(file, "lock")) {
  const std::string prefix = "result file " + file.string() + ": ";
  constexpr mode_t kAsTheUserWants = 0666;  // less the user's mask
  for (;;) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, kAsTheUserWants);
    if (descriptor_ < 0) throw ResultFileError(prefix + "cannot create the file: " + std::strerror(errno));
    if (const std::string problem = problem_with(descriptor_); !problem.empty()) {
      ::close(std::exchange(descriptor_, -1));
      throw ResultFileError(prefix + "cannot be locked by " + path_.string() + ": " + problem);
    }
    const bool locked = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
    if (locked && is_still_there(descriptor_, path_)) break;
    const int error = locked ? EINTR : errno;
    if (!locked && error == EWOULDBLOCK) {
      const std::string other = holder(descriptor_);
      ::close(std::exchange(descriptor_, -1));
      throw ResultFileError(prefix + "is being written by " + other + "; it was left unchanged");
    }
    if (is_without_locks(error)) {
      warning_ = file.string() + ": its file system has no locks (" + std::strerror(error) +
                 "): make sure that no other run writes there";
      return;
    }
    ::close(std::exchange(descriptor_, -1));
    if (error != EINTR) throw ResultFileError(prefix + "cannot be locked: " + std::strerror(error));
  }
  write_holder(descriptor_);
}

ResultLock::~ResultLock() {
  if (descriptor_ < 0) return;
  if (is_still_there(descriptor_, path_)) ::unlink(path_.c_str());  // before the lock ends: then it is another run's
  ::close(descriptor_);
}

SharedResultLock lock_result(const std::filesystem::path& file, const Teuchos::Comm<int>& communicator) {
  SharedResultLock lock;
  const std::string problem = first_problem(communicator, [&] {
    if (communicator.getRank() == 0) lock = std::make_shared<const ResultLock>(file);
  });
  if (!problem.empty()) throw ResultFileError(problem);
  return lock;
}

}  // namespace mixbeam
