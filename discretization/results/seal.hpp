/// Checksums of a file: it is divided into blocks, and its content is followed by the list of their sums (XXH3, 64
/// bits). Every byte counts, those of the HDF5 library and those of the ranks alike; sums are listed in the order of
/// the blocks, so that zeros and bytes of an earlier version of the file are damage too. HDF5 ignores what follows its
/// own end of the file: other programs read sealed files as they are.
///
///     content | sum of block 0, 1, ... (8 bytes each) | SealEnd
#pragma once

#include "discretization/results/disk_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

namespace mixbeam {

/// Bytes differ from those that were written.
class DamageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Small blocks locate damage finely; large ones keep the list short (1/8192) where a step takes many megabytes.
inline constexpr std::size_t kSmallBlock = 4096, kLargeBlock = 65536;
/// Size of a step's tables from which blocks are large.
inline constexpr std::uint64_t kLargeStep = std::uint64_t{8} << 20;

std::uint64_t checksum(const void* bytes, std::size_t count);

struct BlockSum {
  std::uint64_t block = 0, sum = 0;
};

struct Seal {
  std::uint64_t bytes = 0;            ///< of the content
  std::uint64_t block = kSmallBlock;  ///< bytes of a block
  std::vector<std::uint64_t> sums{};  ///< of the blocks; the last one is taken as if zeros followed the content

  std::uint64_t blocks() const { return (bytes + block - 1) / block; }
  /// Bytes of a block that are in the file.
  std::size_t bytes_of(std::uint64_t number) const;
  /// Bytes of list and end.
  std::uint64_t bytes_behind() const;
  /// Changes the size; new blocks are zeros.
  void resize(std::uint64_t new_bytes);
  bool holds(std::uint64_t number, const void* block_bytes) const;
  /// Sums of all blocks.
  std::vector<BlockSum> all() const;
};

/// "bytes 4096 to 8191 are damaged".
std::string text_of_damage(std::uint64_t first, std::uint64_t end);

/// Seal of a file, if it has one. Throws DamageError when the list is not what was written.
std::optional<Seal> read_seal(const DiskFile& file);
/// Writes the seal behind the content and ends the file there.
void write_seal(DiskFile& file, const Seal& seal);

/// Reads a block, with zeros after the content.
void read_block(const DiskFile& file, const Seal& seal, std::uint64_t number, std::byte* bytes);

/// Seal for the content of a file.
Seal seal_of(const DiskFile& file, std::uint64_t bytes, std::uint64_t block);

/// Sums of the blocks that a sequence of writes covers. Consecutive writes count as one; a block is left out if another
/// part of it is written before or later.
class RunningSums {
 public:
  explicit RunningSums(std::uint64_t block);
  ~RunningSums();
  RunningSums(const RunningSums&) = delete;
  RunningSums& operator=(const RunningSums&) = delete;

  void add(std::uint64_t offset, const void* bytes, std::size_t count);
  const std::vector<BlockSum>& complete() const { return complete_; }

 private:
  std::uint64_t block_;
  std::uint64_t next_ = 0;  ///< offset at which a write would continue
  bool has_begin_ = false;  ///< of the block that next_ lies in
  void* state_ = nullptr;   ///< of the sum so far
  std::vector<BlockSum> complete_;
};

}  // namespace mixbeam
