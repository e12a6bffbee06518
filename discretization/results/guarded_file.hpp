/// A file as the HDF5 library sees it: its reads have been checked against the seal, and its writes stay in memory
/// until they are written out in whole blocks, checked. So the library never sees damaged bytes, nor a full disk, both
/// of which may crash it.
#pragma once

#include "discretization/results/seal.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace mixbeam {

class GuardedFile {
 public:
  /// `seal`: of `file`; both must outlive this. `checked`: false for files that were never sealed, whose seal has no
  /// sums.
  GuardedFile(DiskFile& file, Seal& seal, bool checked = true) : file_(file), seal_(seal), checked_(checked) {}

  std::uint64_t size() const { return seal_.bytes; }
  void resize(std::uint64_t bytes);
  /// Throws DiskError, or DamageError that names the bytes.
  void read(std::uint64_t offset, void* bytes, std::size_t count);
  void write(std::uint64_t offset, const void* bytes, std::size_t count);

  /// Writes new blocks to the file, and their sums to the seal.
  void flush();
  /// Blocks that were written since the beginning.
  const std::set<std::uint64_t>& changed() const { return changed_; }

 private:
  struct Block {
    std::vector<std::byte> bytes{};
    bool is_new = false;
  };

  Block& block(std::uint64_t number);
  void make_room();

  DiskFile& file_;
  Seal& seal_;
  bool checked_;
  std::uint64_t written_ = seal_.bytes;  ///< content of the file itself; what follows is zeros
  std::map<std::uint64_t, Block> blocks_;
  std::set<std::uint64_t> changed_;
};

/// An existing file, to be read. Throws DiskError, and DamageError when its seal is damaged.
class SealedFile {
 public:
  explicit SealedFile(const std::filesystem::path& path);
  SealedFile(const SealedFile&) = delete;
  SealedFile& operator=(const SealedFile&) = delete;

  /// False for files of versions that wrote no checksums, and for files that lost them.
  bool is_sealed() const { return found_.has_value(); }
  const Seal& seal() const { return seal_; }
  const DiskFile& disk() const { return disk_; }
  GuardedFile& content() { return content_; }

 private:
  DiskFile disk_;
  std::optional<Seal> found_;
  Seal seal_;
  GuardedFile content_;
};

}  // namespace mixbeam
