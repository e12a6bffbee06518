#include "discretization/results/guarded_file.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace mixbeam {

namespace {

/// Most bytes held in memory: far more than HDF5 itself writes for a step, little beside a large model.
constexpr std::size_t kMostBytesHeld = std::size_t{64} << 20;

/// Seal of a file that has none: its size, and meaningless sums.
Seal unknown_sums(const DiskFile& file) {
  Seal seal;
  seal.resize(file.size());
  return seal;
}

}  // namespace

GuardedFile::Block& GuardedFile::block(std::uint64_t number) {
  const auto known = blocks_.find(number);
  if (known != blocks_.end()) return known->second;
  if ((blocks_.size() + 1) * seal_.block > kMostBytesHeld) make_room();
  Block block;  // kept only when complete: HDF5 asks again after a failed read
  block.bytes.resize(seal_.block);
  const std::uint64_t first = number * seal_.block;
  if (first < written_) {
    file_.read(first, block.bytes.data(), std::min(seal_.block, written_ - first));
    if (checked_ && !seal_.holds(number, block.bytes.data()))
      throw DamageError(text_of_damage(first, std::min(first + seal_.block, seal_.bytes)));
  }
  return blocks_.emplace(number, std::move(block)).first->second;
}

void GuardedFile::make_room() {
  flush();
  blocks_.clear();
}

void GuardedFile::read(std::uint64_t offset, void* bytes, std::size_t count) {
  char* to = static_cast<char*>(bytes);
  while (count > 0) {
    const std::uint64_t inside = offset % seal_.block;
    const std::size_t part = std::min<std::uint64_t>(count, seal_.block - inside);
    std::memcpy(to, block(offset / seal_.block).bytes.data() + inside, part);
    to += part;
    offset += part;
    count -= part;
  }
}

void GuardedFile::write(std::uint64_t offset, const void* bytes, std::size_t count) {
  if (offset + count > seal_.bytes) resize(offset + count);
  const char* from = static_cast<const char*>(bytes);
  while (count > 0) {
    const std::uint64_t inside = offset % seal_.block;
    const std::size_t part = std::min<std::uint64_t>(count, seal_.block - inside);
    Block& target = block(offset / seal_.block);
    std::memcpy(target.bytes.data() + inside, from, part);
    target.is_new = true;
    from += part;
    offset += part;
    count -= part;
  }
}

void GuardedFile::resize(std::uint64_t bytes) {
  const bool shrinks = bytes < seal_.bytes;
  const std::uint64_t last = bytes / seal_.block;
  if (shrinks && bytes % seal_.block != 0) {  // zeros after the end
    Block& cut = block(last);
    std::fill(cut.bytes.begin() + static_cast<std::ptrdiff_t>(bytes % seal_.block), cut.bytes.end(), std::byte{0});
    cut.is_new = true;
  }
  if (shrinks) {
    const std::uint64_t gone = bytes % seal_.block == 0 ? last : last + 1;
    blocks_.erase(blocks_.lower_bound(gone), blocks_.end());
    changed_.erase(changed_.lower_bound(gone), changed_.end());
    if (bytes < written_) file_.resize(written_ = bytes);
  }
  seal_.resize(bytes);
}

void GuardedFile::flush() {
  for (auto& [number, block] : blocks_) {
    if (!block.is_new) continue;
    file_.write(number * seal_.block, block.bytes.data(), seal_.bytes_of(number));
    seal_.sums[number] = checksum(block.bytes.data(), block.bytes.size());
    written_ = std::max(written_, number * seal_.block + seal_.bytes_of(number));
    changed_.insert(number);
    block.is_new = false;
  }
}

SealedFile::SealedFile(const std::filesystem::path& path)
    : disk_(path, DiskAccess::read),
      found_(read_seal(disk_)),
      seal_(found_ ? *found_ : unknown_sums(disk_)),
      content_(disk_, seal_, found_.has_value()) {}

}  // namespace mixbeam
