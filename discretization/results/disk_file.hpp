/// The only way to a file of results: every open, write, sync, rename and close is checked, and an incomplete one
/// leaves nothing behind. HDF5 writes through it as well (guarded_file.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

namespace mixbeam {

/// A system call on a file failed; the message has the call and the system's answer, not the name of the file.
class DiskError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file could not be written by the rank that writes it; the message names the file and the reason.
class FileError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file of results could not be written; the message names the file and the reason. Thrown on every rank.
class ResultFileError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Hidden name beside a file: `.run.h5.ending` for `run.h5`.
std::filesystem::path hidden(const std::filesystem::path& path, const std::string& ending);

/// Identifies a file, whatever its name.
struct FileNumber {
  std::uint64_t device = 0, inode = 0;
  bool operator==(const FileNumber& other) const { return device == other.device && inode == other.inode; }
};
/// Zeros if there is no file of that name.
FileNumber file_number(const std::filesystem::path& path);

enum class DiskAccess { read, write, create };

/// An open file. `create` makes a new one that replaces an existing one; nothing is written through a link. Throws
/// DiskError, and InputError if the new one would replace an input of this process.
class DiskFile {
 public:
  /// `shared`: other ranks, perhaps on other machines, write to other bytes of it at the same time.
  DiskFile(const std::filesystem::path& path, DiskAccess access, bool shared = false);
  ~DiskFile();
  DiskFile(DiskFile&& other) noexcept;
  DiskFile& operator=(DiskFile&&) = delete;

  void write(std::uint64_t offset, const void* bytes, std::size_t count);
  void read(std::uint64_t offset, void* bytes, std::size_t count) const;
  std::uint64_t size() const;
  /// Sets the size; new bytes are zeros.
  void resize(std::uint64_t bytes);
  /// Lengthens the file to this size and reserves disk space for it, so that a full disk is noticed before anything is
  /// written.
  void reserve(std::uint64_t bytes);
  /// Waits until the bytes are on the disk: they survive a power cut.
  void sync();
  /// Closes the file, reporting errors that the file system finds only now (quota, NFS).
  void close();

 private:
  int descriptor_;
};

/// Makes renames and removals in the folder of a file survive a power cut. Throws DiskError.
void sync_folder_of(const std::filesystem::path& path);

/// A file that is written under a hidden name and takes its own when it is complete. Otherwise it is removed, and an
/// existing file of that name stays.
class Replacement {
 public:
  /// Throws InputError if it would replace an input of this process.
  explicit Replacement(std::filesystem::path path);
  ~Replacement();
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Path to write to.
  const std::filesystem::path& hidden_path() const { return hidden_; }
  /// Moves the file, which is complete or grows under its name, to that name. `durable`: first waits until it is on the
  /// disk, and then until its name is. Throws DiskError.
  void publish(bool durable);

 private:
  std::filesystem::path path_, hidden_;
  bool published_ = false;
};

/// Replaces a file by `text`, atomically. Throws FileError.
void replace_file(const std::filesystem::path& path, const std::string& text, bool durable);

/// Receives the next piece of a text.
using TextSink = std::function<void(const std::string&)>;
/// Replaces a file by a text that is too long to be held in memory: `write` hands it over piece by piece.
void replace_file(const std::filesystem::path& path, const std::function<void(const TextSink&)>& write, bool durable);

/// When a file replaces an existing one of its name.
enum class Appears { at_once, when_closed };

/// A text that grows line by line; each line reaches the file at once. Throws FileError.
class TextFile {
 public:
  /// A file that appears when it is closed is removed if it is never closed.
  TextFile(const std::filesystem::path& path, Appears when);
  /// After an error the file ends behind the last text that fitted.
  void append(const std::string& text);
  /// Waits until it is on the disk.
  void close();

 private:
  std::filesystem::path path_;
  std::unique_ptr<Replacement> replacement_;
  DiskFile file_;
  std::uint64_t size_ = 0;
};

}  // namespace mixbeam
