/// Plain reading and writing of bytes at given places of a file, by several ranks side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>

namespace mixbeam {

/// A file could not be read or written; the message says what the system said.
class SlabError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Bytes of a file that are held in memory at a time: large enough for the speed of single large writes, small beside
/// anything else that a rank holds.
inline constexpr std::size_t kSlabBytes = std::size_t{1} << 20;

enum class SlabAccess { read, write };

/// An existing file. Ranks may write to it together as long as no byte belongs to two of them.
class SlabFile {
 public:
  /// `shared`: other ranks write to it at the same time. Throws SlabError.
  SlabFile(const std::filesystem::path& path, SlabAccess access, bool shared);
  ~SlabFile();
  SlabFile(const SlabFile&) = delete;
  SlabFile& operator=(const SlabFile&) = delete;

  void write(std::uint64_t offset, const void* bytes, std::size_t count);
  void read(std::uint64_t offset, void* bytes, std::size_t count);
  /// Reports what a file system finds out only now.
  void close();

  /// Room for kSlabBytes that are about to be written or have been read.
  std::byte* buffer() { return buffer_.get(); }

 private:
  int descriptor_;
  std::unique_ptr<std::byte[]> buffer_;
};

/// Writes rows of a table: rows that follow one another are collected in the buffer of the file. One at a time for each
/// file.
template <class Number>
class RowWriter {
 public:
  /// `offset`: of the first row in the file. A row has `columns` numbers.
  RowWriter(SlabFile& file, std::uint64_t offset, std::size_t columns)
      : file_(file), offset_(offset), columns_(columns), most_rows_(kSlabBytes / (columns * sizeof(Number))) {}

  /// Room for the numbers of a row, to be filled before the next call.
  Number* row(std::size_t number) {
    if (number != first_ + rows_ || rows_ == most_rows_) {
      finish();
      first_ = number;
    }
    return reinterpret_cast<Number*>(file_.buffer()) + columns_ * rows_++;
  }

  /// Writes what is left. Called at the end.
  void finish() {
    if (rows_ == 0) return;
    const std::size_t bytes_of_row = columns_ * sizeof(Number);
    file_.write(offset_ + first_ * bytes_of_row, file_.buffer(), rows_ * bytes_of_row);
    rows_ = 0;
  }

 private:
  SlabFile& file_;
  std::uint64_t offset_;
  std::size_t columns_, most_rows_;
  std::size_t first_ = 0, rows_ = 0;  ///< collected
};

}  // namespace mixbeam
